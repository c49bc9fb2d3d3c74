//! Map from axis names to values in the order of the machine file, for reports as JSON.

use serde::ser::{Serialize, SerializeMap, Serializer};

/// A map from axis names to values, in machine-file order.
#[derive(Clone, Debug)]
pub struct PerAxis<T>(pub Vec<(String, T)>);

impl<T> PerAxis<T> {
    /// True if it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl<T: Serialize> Serialize for PerAxis<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, value) in &self.0 {
            map.serialize_entry(name, value)?;
        }
        map.end()
    }
}
