//! Assumption about the device where its manual is silent.

use std::time::Duration;
use twin_drives::assumptions;
use twin_drives::assumptions::Microseconds;

assumptions! {
    /// Assumptions that client and emulator share.
    pub struct Assumptions {
        watchdog: Duration = Duration::from_millis(100), Microseconds(1000..=1_000_000),
            (0, "After which silence of its master does a moving device brake?",
                "1 ms to 1 s", "sends more often");
    }
    others {}
}
