//! What all families offer alike, asked of the real drivers and their emulators in real time.

mod backup;
mod bench;
mod device;
mod group;
mod homing;
