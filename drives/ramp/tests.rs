//! Motions against closed forms, and under random retargets.
