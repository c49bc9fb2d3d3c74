//! Variables of the controller that replace numbers in a program (manual 3.2.3, 3.2.8 and 10.2).

use super::error::DecodeError;
use std::collections::BTreeMap;

/// Type of a variable (`SMC_SingleVar.eVarType`, manual 10.2): its name, its range, and whether it is whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Type {
    name: &'static str,
    min: f64,
    max: f64,
    whole: bool,
}

const fn whole(name: &'static str, min: f64, max: f64) -> Type {
    Type { name, min, max, whole: true }
}

/// The type of the implicit variable (manual 3.2.8).
pub(super) const INT: Type = whole("INT", -32_768.0, 32_767.0);
const REAL: Type = Type { name: "REAL", min: f32::MIN as f64, max: f32::MAX as f64, whole: false };
const LREAL: Type = Type { name: "LREAL", min: f64::MIN, max: f64::MAX, whole: false };

const TYPES: [Type; 11] = [
    INT,
    whole("BYTE", 0.0, 255.0),
    whole("WORD", 0.0, 65_535.0),
    whole("DINT", -2_147_483_648.0, 2_147_483_647.0),
    whole("DWORD", 0.0, 4_294_967_295.0),
    REAL,
    whole("SINT", -128.0, 127.0),
    whole("USINT", 0.0, 255.0),
    whole("UINT", 0.0, 65_535.0),
    whole("UDINT", 0.0, 4_294_967_295.0),
    LREAL,
];

impl Type {
    /// Value of a variable of this type after `value` is assigned to it: whole types round to the nearest number,
    /// halves away from zero.
    ///
    /// # Errors
    /// [`DecodeError::VariableOverflow`].
    pub(super) fn hold(self, value: f64) -> Result<f64, DecodeError> {
        let Self { name: kind, min, max, whole } = self;
        let held = if whole {
            value.round()
        } else if kind == REAL.name {
            #[expect(clippy::cast_possible_truncation, reason = "that is what a REAL does")]
            f64::from(value as f32)
        } else {
            value
        };
        if held >= min && held <= max {
            Ok(held)
        } else {
            Err(DecodeError::VariableOverflow { kind, value, min, max })
        }
    }
}

/// Variables by name: what `SMC_VARLIST` gives a program from a file. Case does not matter.
#[doc(alias = "SMC_VARLIST")]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variables {
    numbers: BTreeMap<String, Number>,
    structures: BTreeMap<String, [f64; 8]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Number {
    kind: Type,
    value: f64,
}

impl Variables {
    /// Sets a variable of type LREAL.
    pub fn set(&mut self, name: &str, value: f64) {
        self.numbers.insert(name.to_uppercase(), Number { kind: LREAL, value });
    }

    /// Sets a variable of the IEC 61131-3 type `kind`: INT BYTE WORD DINT DWORD REAL SINT USINT UINT UDINT or LREAL, in
    /// any case. G36 and G37 then round and refuse as that type does. False, and nothing is set, if there is no such
    /// type or it cannot hold `value`.
    #[doc(alias = "SMC_SingleVar")]
    #[must_use]
    pub fn set_typed(&mut self, name: &str, kind: &str, value: f64) -> bool {
        let kind = TYPES.into_iter().find(|known| known.name.eq_ignore_ascii_case(kind));
        let number = kind.and_then(|kind| Some(Number { kind, value: kind.hold(value).ok()? }));
        number.map(|number| self.numbers.insert(name.to_uppercase(), number)).is_some()
    }

    /// Assigns `value` to a variable, or adds it; none if there is no variable of that name.
    pub(super) fn change(
        &mut self,
        name: &str,
        add: bool,
        value: f64,
    ) -> Option<Result<(), DecodeError>> {
        let number = self.numbers.get_mut(&name.to_uppercase())?;
        let sum = if add { number.value + value } else { value };
        Some(number.kind.hold(sum).map(|held| number.value = held))
    }

    /// Sets the parameters of an M function that `O$name$` hands over (`SMC_M_PARAMETERS`, dP1 to dP8); those named
    /// `gSMC_MParameters` go with every M function that has no O.
    pub fn set_parameters(&mut self, name: &str, parameters: [f64; 8]) {
        self.structures.insert(name.to_uppercase(), parameters);
    }

    /// The value of a variable, if there is one of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.numbers.get(&name.to_uppercase()).map(|number| number.value)
    }

    /// The parameters of that name.
    pub fn parameters(&self, name: &str) -> Option<[f64; 8]> {
        self.structures.get(&name.to_uppercase()).copied()
    }

    /// Names and values, in order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.numbers.iter().map(|(name, number)| (name.as_str(), number.value))
    }
}
