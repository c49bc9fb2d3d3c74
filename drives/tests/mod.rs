//! What all families offer alike, asked of the real drivers and their emulators in real time.

mod bench;
mod device;
