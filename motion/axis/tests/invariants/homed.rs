//! Random homing by the drive.

use super::alone::way;
use super::called::{Called, limited};
use super::checker::Promise;
use crate::Home;

/// Homing by the drive.
pub(super) fn all() -> Vec<Box<dyn Called>> {
    vec![limited(
        |_, _| Promise::Nothing,
        |random, _, _| Home { position: way(random), deceleration: random.one_of(&[0.0, 50.0]) },
    )]
}
