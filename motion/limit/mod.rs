//! Feed limiting: what the axes can give.

pub mod emergency;
