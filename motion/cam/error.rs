//! Errors of cams: invalid points, tables or elements.

use super::knot::MOST;
use twin_number::Short;

/// Reason why points, tables or elements make no cam.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CamError {
    /// Too few points.
    #[error("a cam needs 2 points, there are {found}")]
    TooFewPoints {
        /// Number found.
        found: usize,
    },
    /// Points, elements or table values are more than can be counted here.
    #[error("{found} points are more than the {limit} a cam may have")]
    TooManyPoints {
        /// Number found.
        found: usize,
        /// The most there may be.
        limit: usize,
    },
    /// Values are so large that other numbers which follow from them would not be finite.
    #[error(
        "element {index}: master, slave, or a derivative of the slave up to it is beyond ±{MOST:e}; \
         correct the element, or move it away from the one before"
    )]
    Beyond {
        /// Number of the point or line, from 1.
        index: usize,
    },
    /// A point or line does not lie behind the one before it.
    #[error("element {index}: master {} does not lie behind {} of the element before", Short(*.master), Short(*.before))]
    NotAscending {
        /// Number of the point or line, from 1.
        index: usize,
        /// Its master position.
        master: f64,
        /// That of the one before.
        before: f64,
    },
    /// Two elements meet with different values: the curve would not be twice continuously differentiable.
    #[error(
        "element {index}: {what} {} at master {} where the element before ends with {}",
        Short(*.value), Short(*.master), Short(*.before)
    )]
    Kink {
        /// Number of the element, from 1.
        index: usize,
        /// What differs: slave, velocity or acceleration.
        what: &'static str,
        /// Its place, master.
        master: f64,
        /// The value.
        value: f64,
        /// That of the element before.
        before: f64,
    },
    /// Something lies beyond the scale of the master.
    #[error(
        "{what} {index}: master {} lies outside {} to {}",
        Short(*.master), Short(*.min), Short(*.max)
    )]
    OutsideScale {
        /// Element or tappet.
        what: &'static str,
        /// Its number, from 1.
        index: usize,
        /// Its master position.
        master: f64,
        /// Begin of the scale.
        min: f64,
        /// End of the scale.
        max: f64,
    },
    /// The elements do not begin or end with the scale of the master ("both ends are always included", manual 4.7).
    #[error("the elements {what} at master {}, the scale at {}", Short(*.master), Short(*.scale))]
    EndMissing {
        /// Begin or end.
        what: &'static str,
        /// Master position of the elements.
        master: f64,
        /// Master position of the scale.
        scale: f64,
    },
    /// A value does not fit the type of a table's variables.
    #[error("value {index}: {} does not fit {kind} ({} to {})", Short(*.value), Short(*.min), Short(*.max))]
    OutsideType {
        /// Number of the value, from 1.
        index: usize,
        /// The value, in units of the table.
        value: f64,
        /// The type's name.
        kind: &'static str,
        /// Its least value.
        min: f64,
        /// Its greatest.
        max: f64,
    },
    /// A value has a fraction where the type of a table's variables has whole numbers only.
    #[error("value {index}: {value} is not a whole number, as {kind} needs it")]
    Fraction {
        /// Number of the value, from 1.
        index: usize,
        /// The value, in units of the table.
        value: f64,
        /// The type's name.
        kind: &'static str,
    },
    /// The scaling of a table maps nothing or everything onto a point (error 628, `SMC_CI_SCALING_INCORRECT`).
    #[error("scaling of the {axis}: {} to {} cannot stand for {} to {} (error 628)",
        Short(*.table_min), Short(*.table_max), Short(*.min), Short(*.max))]
    Scaling {
        /// Master or slave.
        axis: &'static str,
        /// Begin, u.
        min: f64,
        /// End, u.
        max: f64,
        /// Begin in units of the table.
        table_min: f64,
        /// End in units of the table.
        table_max: f64,
    },
    /// A tappet's times are negative or no numbers.
    #[error("tappet {index}: {what} of {} ns is less than 0", .value)]
    TappetTime {
        /// Its number, from 1.
        index: usize,
        /// Delay or duration.
        what: &'static str,
        /// The time, ns.
        value: i64,
    },
}
