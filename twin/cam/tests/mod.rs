//! Files of cams, their checks and what is found in runs.

mod files;
mod found;
