//! What `motion/limit` is asked for: the one file of this benchmark that knows it.

use crate::path::Path;

/// One way to limit a path.
#[derive(Clone, Copy)]
pub struct Method {
    pub name: &'static str,
    /// Whether jerk is limited, too.
    pub jerk: bool,
    /// The method that does the same in one window over the whole path.
    pub whole: Option<&'static str>,
    /// Duration of the profile, s, from rest to rest.
    pub duration: fn(&Path) -> Option<f64>,
}

/// All that are compared.
pub const METHODS: [Method; 0] = [];
