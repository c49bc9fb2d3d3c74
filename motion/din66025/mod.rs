//! SoftMotion's DIN 66025 dialect (manual 3.2): text to path elements.
