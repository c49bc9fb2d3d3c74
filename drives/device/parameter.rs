//! Parameters of a device: number, name, values.

use std::fmt;

/// Number of a parameter of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ParameterId {
    /// Address of the drive on its bus; 0 where a device is one unit.
    pub address: u8,
    /// Number in the manual.
    pub number: u16,
}

impl fmt::Display for ParameterId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.address {
            0 => write!(f, "parameter {}", self.number),
            address => write!(f, "parameter {} at address {address}", self.number),
        }
    }
}

/// Values that a parameter takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Values {
    /// All from the first to the second.
    Between(i64, i64),
    /// These.
    OneOf(Vec<i64>),
}

impl Values {
    /// Whether a value is among them.
    pub fn contain(&self, value: i64) -> bool {
        match self {
            Self::Between(low, high) => (*low..=*high).contains(&value),
            Self::OneOf(values) => values.contains(&value),
        }
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Between(low, high) => write!(f, "{low} to {high}"),
            Self::OneOf(values) => {
                let values: Vec<_> = values.iter().map(ToString::to_string).collect();
                f.write_str(&values.join(", "))
            }
        }
    }
}

/// Description of a parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// Number of the parameter.
    pub id: ParameterId,
    /// Name as in the manual, where it has one.
    pub name: String,
    /// Axis it belongs to, index of the arrays; `None` if it belongs to all or to an axis that is not in use.
    pub axis: Option<usize>,
    /// Unit, empty if there is none.
    pub unit: &'static str,
    /// Values that it takes.
    pub values: Values,
    /// Whether it can be set.
    pub writable: bool,
    /// Whether a new value acts only after the device has been restarted.
    pub needs_restart: bool,
    /// Whether another value makes the device deaf to the driver as it is set: address, speed and parity of the line.
    pub of_the_line: bool,
}

impl ParameterInfo {
    /// A parameter that can be set, acts at once and has nothing to do with the line.
    pub fn new(id: ParameterId, name: String, values: Values) -> Self {
        Self {
            id,
            name,
            axis: None,
            unit: "",
            values,
            writable: true,
            needs_restart: false,
            of_the_line: false,
        }
    }
}
