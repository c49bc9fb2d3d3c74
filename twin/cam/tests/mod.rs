//! Files of cams, their checks and what is found in runs.

#![expect(clippy::float_cmp, reason = "given, or to be the same bit for bit")]

mod drawn;
mod files;
mod found;
mod hostile;
mod outputs;
mod passages;
mod random;
mod round_trips;
mod sampled;
mod shown;
mod starts;
mod tappet_shift;
mod tuned;
mod unwrap;
mod words;
