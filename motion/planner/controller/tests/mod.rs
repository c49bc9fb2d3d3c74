//! Tests of the interpolator, and the programs that they share.

#![expect(clippy::float_cmp, reason = "given, or to be the same bit for bit")]
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "counts of set-points and elements: thousands"
)]

mod absurd;
mod by_position;
mod control;
mod extra;
mod heading;
mod interpolator;
mod look_ahead;
mod modes;
mod profile;
mod program;
mod random;
mod stop;
mod two_way;
mod wiring;
