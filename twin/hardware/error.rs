//! Errors of the drives during a run.

use crate::troubleshooting::{STANDSTILL, advice_in_run};
use twin_drives::DriveError;
use twin_machine::{Axis, DriveFamily, Machine};

/// Errors of the drives during a run.
#[derive(Debug, thiserror::Error)]
pub enum HardwareError {
    /// A device or its wire, on the way out of its thread.
    #[error("{0}")]
    WithoutUnit(#[from] DriveError),
    /// The same, by the names of the machine file.
    #[error("{whose}: {source}{}", if *in_row > 1 { format!(", {in_row} times in a row") } else { String::new() })]
    Drive {
        /// Which device, and which of its axes.
        whose: String,
        /// What.
        source: Box<DriveError>,
        /// Answers in a row that were lost, where it is about a lost answer.
        in_row: u32,
    },
    /// An axis position does not fit the counters.
    #[error(
        "device `{device}`: axis {axis} at {position} {unit} is beyond what its drive counts: at most {most} increments, \
         which are {farthest} {unit}, either way"
    )]
    Range {
        /// Which.
        device: String,
        /// The axis.
        axis: String,
        /// The position, in `unit`.
        position: f64,
        /// The largest count of the device.
        most: i64,
        /// The same, in `unit`.
        farthest: f64,
        /// "mm" or "deg".
        unit: &'static str,
    },
    /// The axes rest where they should not.
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
    #[error("device `{device}`: it has confirmed a stop, and reports motion {waited_s} s later")]
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
    /// The planned set-points ended before the motion did, in a run or on the way to its start.
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

/// Names of a device and its axes in the machine file.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    /// The device.
    pub(super) device: String,
    /// Its axes: which one of the device each is (its address, on a bus), and its name.
    pub(super) axes: Vec<(usize, String)>,
    /// True if each has an address of its own.
    pub(super) bus: bool,
}

impl Names {
    /// Of a device by its place in the machine file.
    pub(super) fn of(machine: &Machine, device: usize) -> Self {
        let entry = machine.drives.get(device);
        let place = |axis: &Axis| axis.drive.as_ref().map_or(0, |drive| drive.index);
        Self {
            device: entry.map(|entry| entry.name.clone()).unwrap_or_default(),
            axes: machine
                .axes_of(device)
                .map(|(_, axis)| (place(axis), axis.name.clone()))
                .collect(),
            bus: entry.is_some_and(|entry| matches!(entry.family(), DriveFamily::SmartDrive(_))),
        }
    }

    /// An error of a driver with the device and the axes that it is about; all of them where it does not say which.
    pub(super) fn attribute(&self, source: DriveError, in_row: u32) -> HardwareError {
        let about = |place: usize| {
            let axes = source.axes();
            if self.bus {
                source.at().address == 0 || usize::from(source.at().address) == place
            } else {
                axes.is_none_or(|axes| axes.contains(place))
            }
        };
        let concerned: Vec<&str> = self
            .axes
            .iter()
            .filter(|(place, _)| about(*place))
            .map(|(_, name)| name.as_str())
            .collect();
        let device = &self.device;
        let whose = match *concerned {
            [] => format!("device `{device}`"),
            [axis] => format!("device `{device}`, axis {axis}"),
            _ => format!("device `{device}`, axes {}", concerned.join(", ")),
        };
        HardwareError::Drive { whose, source: Box::new(source), in_row }
    }
}

impl HardwareError {
    /// Hint after an error of the drives of a run.
    pub(crate) fn advice(&self) -> Option<&'static str> {
        match self {
            Self::WithoutUnit(error) => advice_in_run(error),
            Self::Drive { source, .. } => advice_in_run(source),
            Self::Starved { .. } => Some(STANDSTILL),
            Self::Silent { .. } => Some(
                "look at its cable and its supply. When it answers again, `status` shows whether it has been off or locked: then its \
                 axes have to be homed (--home); if it has not, its positions still hold, and the program can be run again. A slow \
                 adapter needs larger `answer_deadline_ms` and `longest_silence_ms` of its [[drives]]",
            ),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use twin_drives::{Action, Axes, Exchange};

    fn names(text: &str, device: usize) -> Names {
        let machine = Machine::parse(Path::new("machine.toml"), text).unwrap();
        Names::of(&machine, device)
    }

    fn at(address: u8) -> Exchange {
        Exchange { port: "/dev/ttyUSB0".into(), address, action: Action::ReadState }
    }

    #[test]
    fn errors_of_drivers_name_device_and_axes_of_the_machine_file() {
        let board = names(include_str!("../../machines/gantry3.toml"), 0);
        let message = board.attribute(DriveError::Locked { at: at(1) }, 0).to_string();
        assert_eq!(
            message,
            "device `board`, axes X, Y, Z: /dev/ttyUSB0, address 1: reading status and positions: the board is locked"
        );
        let lost =
            DriveError::Timeout { at: at(1), deadline: std::time::Duration::from_millis(31) };
        let message = board.attribute(lost, 10).to_string();
        assert!(message.ends_with("no answer within 31 ms, 10 times in a row"), "{message}");
        let switch = DriveError::LimitSwitch { at: at(1), axes: Axes::Letters(0b10) };
        assert!(
            board.attribute(switch, 0).to_string().starts_with("device `board`, axis Y: /dev/")
        );
        // On a bus every axis has its address.
        let bus = Names {
            device: "line".to_owned(),
            axes: vec![(3, "X".to_owned()), (7, "Y".to_owned())],
            bus: true,
        };
        let message =
            |address| bus.attribute(DriveError::Stalled { at: at(address) }, 0).to_string();
        assert!(message(7).starts_with("device `line`, axis Y: "), "{}", message(7));
        assert!(message(0).starts_with("device `line`, axes X, Y: "), "{}", message(0));
        assert!(message(9).starts_with("device `line`: "), "{}", message(9));
        // A module says which of its axes, from 1.
        let module =
            Names { bus: false, axes: vec![(0, "A".to_owned()), (1, "B".to_owned())], ..bus };
        let fault = twin_bim2ax::Fault::AxisMessages { axis: 2, messages: 1 };
        let message = module.attribute(DriveError::device(at(0), fault), 0);
        assert!(message.to_string().starts_with("device `line`, axis B: "), "{message}");
    }
}
