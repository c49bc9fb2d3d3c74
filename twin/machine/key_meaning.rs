//! Meanings of the keys of machine files, for the reference and `twin explain`.

/// Meaning and default of a key in a table of machine files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyMeaning {
    /// Path of the table: `axes.physics`; empty: the file as a whole.
    pub table: &'static str,
    /// The key.
    pub key: &'static str,
    /// Value without the key, or when it is required; empty: always required.
    pub default: &'static str,
    /// Meaning, in one line.
    pub meaning: &'static str,
}

impl KeyMeaning {
    /// All of them, in the order of the reference.
    pub fn all() -> impl Iterator<Item = Self> {
        // The first line names the columns.
        include_str!("keys.tsv").lines().skip(1).filter_map(|line| {
            let mut cells = line.split('\t');
            let [table, key, default, meaning] = std::array::from_fn(|_| cells.next());
            Some(Self { table: table?, key: key?, default: default?, meaning: meaning? })
        })
    }
}
