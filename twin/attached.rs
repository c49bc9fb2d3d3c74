//! Device of the machine file together with its opened driver.

use twin_drives::Drive;

/// A device of the machine file and its driver. The axes of its arrays are the machine axes that it drives, in the
/// order of the machine file.
pub struct Attached {
    /// Index into [`Machine::drives`](twin_machine::Machine::drives).
    pub device: usize,
    /// The driver.
    pub drive: Box<dyn Drive>,
}

impl std::fmt::Debug for Attached {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({})", self.drive.describe(), self.device)
    }
}
