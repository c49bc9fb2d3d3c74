//! Expectations are closed forms: areas and lengths of circles, rings and boxes, and of what two arms sweep.

mod machines;
mod region;
mod svg;
