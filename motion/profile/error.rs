//! Errors of profiles: motions that cannot be planned.

/// A motion that cannot be planned.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// A position, velocity or acceleration is infinite or not a number.
    #[error("the {quantity} is {value}; it must be a finite number")]
    NotFinite {
        /// The quantity.
        quantity: &'static str,
        /// As given.
        value: f64,
    },
    /// A limit is not a positive number.
    #[error("the largest {quantity} is {value}; it must be a positive, finite number")]
    NotPositive {
        /// Of what.
        quantity: &'static str,
        /// As given.
        value: f64,
    },
    /// The velocity asked for at the end is larger than the limit.
    #[error("the velocity at the end is {velocity} u/s, the largest is {limit} u/s")]
    EndVelocity {
        /// As asked for, u/s.
        velocity: f64,
        /// Largest speed, u/s.
        limit: f64,
    },
    /// Times or positions on the way are too large for a number.
    #[error("the way to {target} with these limits is too large for a number")]
    TooLarge {
        /// The position (u) or the velocity (u/s) to go to.
        target: f64,
    },
    /// A table has no points or too many.
    #[error("the table has {count} points; it must have 1 to {most}")]
    Points {
        /// Number found.
        count: usize,
        /// Largest number allowed.
        most: usize,
    },
    /// The times of a table do not grow.
    #[error("point {point} comes {step} s after the one before; it must come later")]
    TimeStep {
        /// Its number, from 1.
        point: usize,
        /// As given, s.
        step: f64,
    },
    /// The first point of a table asks for a step.
    #[error("the first point has the {quantity} {asked}, where the axis has {is}")]
    Jump {
        /// The quantity that would step.
        quantity: &'static str,
        /// At the start.
        is: f64,
        /// In the table.
        asked: f64,
    },
}
