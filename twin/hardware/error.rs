//! Why drives cannot go on.

use twin_drives::DriveError;

/// Why the drives cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum HardwareError {
    /// The device or its wire.
    #[error("{0}")]
    Drive(#[from] DriveError),
    /// An axis position does not fit the counters.
    #[error("axis {axis} at {position} {unit} is beyond what its drive can count")]
    Range {
        /// The axis.
        axis: String,
        /// The position, in `unit`.
        position: f64,
        /// "mm" or "deg".
        unit: &'static str,
    },
    /// The axes stand still where they should not.
    #[error(
        "device `{device}`: the axes stopped moving at {position:?} on their way to {target:?} increments"
    )]
    Stuck {
        /// Which.
        device: String,
        /// Where the axes are.
        position: Vec<i64>,
        /// Where they should be.
        target: Vec<i64>,
    },
    /// A device may keep silent for less time than it usually does.
    #[error(
        "{file}: device `{device}`: longest_silence_ms = {said_ms} is too short: a round of its axes takes {round_ms} ms on \
         its wire; at least {least_ms}"
    )]
    Impatient {
        /// The machine file.
        file: String,
        /// Which.
        device: String,
        /// `longest_silence_ms`.
        said_ms: u32,
        /// Its least.
        least_ms: u32,
        /// Every axis gets a command and is seen, ms.
        round_ms: u32,
    },
    /// The axes go on although the device has confirmed that it stops.
    #[error(
        "device `{device}`: its axes still move {waited_s} s after a stop that it has confirmed, by what it says"
    )]
    Moves {
        /// Which.
        device: String,
        /// Since the stop, s.
        waited_s: u64,
    },
    /// More outputs are to be switched than the device keeps up with.
    #[error(
        "device `{device}`: output {output} cannot be switched: {waiting} others wait for it already"
    )]
    Outputs {
        /// Which.
        device: String,
        /// The output, from 1.
        output: u8,
        /// How many wait.
        waiting: usize,
    },
    /// The plan ended before the program did: whoever plans was kept waiting.
    #[error(
        "device `{device}`: the set-points came {late_ms} ms late; the axes were braked where they were"
    )]
    Starved {
        /// Which.
        device: String,
        /// Behind the last planned instant, ms.
        late_ms: i64,
    },
    /// The device does not answer while its axes are to move. Its driver goes on asking.
    #[error(
        "device `{device}` has not answered for {silent_ms} ms while its axes move (longest_silence_ms = {limit_ms}){}",
        then.as_ref().map_or(String::new(), |then| format!("; then: {then}"))
    )]
    Silent {
        /// Which.
        device: String,
        /// For how long, ms.
        silent_ms: i64,
        /// How long it may, ms.
        limit_ms: u32,
        /// What its driver has said in the end.
        then: Option<Box<HardwareError>>,
    },
    /// An axis is not where its set-points are.
    #[error(
        "following-error: axis {axis} is {error:.4} {unit} from its set-point; at most {limit:.4} {unit} is allowed \
         (max_following_error_{unit})"
    )]
    TooFar {
        /// The axis.
        axis: String,
        /// How far, in `unit`.
        error: f64,
        /// How far it may be, in `unit`.
        limit: f64,
        /// "mm" or "deg".
        unit: &'static str,
        /// When, ns.
        time_ns: i64,
    },
    /// The driver has failed in a way that nobody has foreseen; the device was stopped all the same.
    #[error("device `{device}`: its driver has panicked; the axes were braked where they were")]
    Panicked {
        /// Which.
        device: String,
    },
    /// The device's thread ended without saying why.
    #[error("device `{device}`: its thread ended unexpectedly")]
    Gone {
        /// Which.
        device: String,
    },
    /// The device's thread could not be started.
    #[error("device `{device}`: its thread cannot be started: {source}")]
    Thread {
        /// Which.
        device: String,
        /// Why.
        source: std::io::Error,
    },
}
