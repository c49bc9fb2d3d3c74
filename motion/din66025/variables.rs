//! Variables of the controller that a program may name in place of numbers (manual 3.2.3, 3.2.8 and 10.2).

use std::collections::BTreeMap;

/// Variables by name: what `SMC_VARLIST` gives a program from a file. Case does not matter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variables {
    numbers: BTreeMap<String, f64>,
    structures: BTreeMap<String, [f64; 8]>,
}

impl Variables {
    /// Sets a variable.
    pub fn set(&mut self, name: &str, value: f64) {
        self.numbers.insert(name.to_uppercase(), value);
    }

    /// Sets the parameters of an M function that `O$name$` hands over (`SMC_M_PARAMETERS`, dP1 to dP8).
    pub fn set_parameters(&mut self, name: &str, parameters: [f64; 8]) {
        self.structures.insert(name.to_uppercase(), parameters);
    }

    /// The value of a variable, if there is one of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.numbers.get(&name.to_uppercase()).copied()
    }

    /// The parameters of that name.
    pub fn parameters(&self, name: &str) -> Option<[f64; 8]> {
        self.structures.get(&name.to_uppercase()).copied()
    }

    /// Names and values, in order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.numbers.iter().map(|(name, value)| (name.as_str(), *value))
    }
}
