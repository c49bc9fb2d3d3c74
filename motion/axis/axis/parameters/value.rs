//! Parameter description: number, name, value type and access.

/// A parameter of an axis (manual 2.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its number, from 1000.
    pub number: u16,
    /// Its number in the PLCopen standard, 0 where it has none.
    pub plcopen: u16,
    /// Its name in `AXIS_REF`.
    pub name: &'static str,
    /// Description, with its unit.
    pub about: &'static str,
    /// Value and type of a new axis. Where the manual names the configuration, that of [`AxisConfig`] replaces it.
    ///
    /// [`AxisConfig`]: crate::AxisConfig
    pub initial: Value,
    /// Access of a program.
    pub access: Access,
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// `BOOL`.
    Bool(bool),
    /// `BYTE`, `WORD`, `DWORD`, `INT` and enumerations.
    Integer(i64),
    /// `REAL`.
    Real(f64),
}

/// Access of a program to a parameter. The choice is ours: the manual only says that some are read-only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// States, set-points and what the drive says.
    Read,
    /// Limits, factors, gains and what is confirmed by writing.
    Write,
}

/// A type that a field of the table may have.
pub(super) trait Slot: Sized {
    /// The field's value, if `value` fits.
    fn take(value: Value) -> Option<Self>;
}

impl Slot for bool {
    fn take(value: Value) -> Option<Self> {
        if let Value::Bool(value) = value { Some(value) } else { None }
    }
}

impl Slot for f64 {
    fn take(value: Value) -> Option<Self> {
        if let Value::Real(value) = value { value.is_finite().then_some(value) } else { None }
    }
}

impl Slot for i64 {
    fn take(value: Value) -> Option<Self> {
        /// Whole numbers up to here are exact in an f64, and a `DWORD` fits.
        const LARGEST: f64 = 4_294_967_296.0;
        let Value::Real(value) = value else { return None };
        let whole = value.fract() == 0.0 && value.abs() < LARGEST;
        #[expect(clippy::cast_possible_truncation, reason = "a whole number of at most 32 bits")]
        whole.then_some(value as i64)
    }
}
