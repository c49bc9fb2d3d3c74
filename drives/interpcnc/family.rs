//! The family as the list of families takes it: keys of a board, and the way to a drive, an emulator and a prediction.

use std::time::Duration;

use crate::{
    Assumptions, AxisOptions, BoardAxis, EncoderOptions, Following, InterpCncDrive,
    InterpCncOptions, Line, Parity, board_prediction,
    emulator::{Bench, BoardOptions, EmulatedBoard, EmulatorOptions, EncoderLink, Wire},
    protocol::registers::{MAX_SPEED_HZ, OUTPUTS},
};
use twin_drives::{
    Drive, DriveError, Prediction,
    family::{
        Abilities, AxisDemand, ConnectError, Connected, Device, DeviceClock, EMULATED_DEADLINE,
        Family, Keys, assumptions, choice, counted, is_assumed_otherwise, microseconds,
        required_integer,
    },
};

/// A board may take so long to store a parameter.
const LONGEST_STORING: Duration = Duration::from_secs(10);
/// Encoder and counter may be no farther apart than this, whatever the file says.
const MOST_TOLERANCE: i64 = 1_000_000;
/// Axes of a board by their names in a machine file.
const AXES: [(&str, BoardAxis); 5] = [
    ("X", BoardAxis::X),
    ("Y", BoardAxis::Y),
    ("Z", BoardAxis::Z),
    ("A", BoardAxis::A),
    ("B", BoardAxis::B),
];

/// InterpCNC boards.
#[derive(Clone, Copy, Debug)]
pub struct InterpCncFamily;

impl Family for InterpCncFamily {
    fn kind(&self) -> &'static str {
        "interpcnc"
    }

    fn title(&self) -> &'static str {
        "InterpCNC"
    }

    fn axis(&self, keys: &dyn Keys) -> Option<usize> {
        keys.word("drive_axis", &AXES.map(|(name, _)| name))
    }

    fn axis_name(&self, index: usize) -> String {
        AXES.get(index).map_or("?", |(name, _)| name).to_owned()
    }

    fn outputs(&self, _axes: usize) -> u32 {
        OUTPUTS.into()
    }

    fn has_encoders(&self) -> bool {
        true
    }

    fn misplaced_address(&self, key: &str) -> Option<(String, String)> {
        (key != "station").then(|| {
            (
                format!("`{key}` does not belong here: the Modbus address of a board is `station`"),
                "write `station = …`, 1 to 247".to_owned(),
            )
        })
    }

    fn is_assumed_otherwise(&self, name: &str, value: &str) -> bool {
        is_assumed_otherwise::<Assumptions>(name, value)
    }

    fn read(&self, keys: &dyn Keys) -> Option<Box<dyn Device>> {
        InterpCncEntry::read(keys).map(|entry| Box::new(entry) as Box<dyn Device>)
    }
}

/// A board as a machine file describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InterpCncEntry {
    /// Modbus address.
    pub address: u8,
    /// Bits per second.
    pub baud: u32,
    /// Parity on the wire.
    pub parity: Parity,
    /// Time an emulated board takes to answer, µs.
    pub turnaround_us: u32,
    /// Start and stop frequency of its ramps, steps/s.
    pub start_stop_hz: u16,
    /// Acceleration and deceleration of its ramps, thousand steps/s².
    pub acceleration_khz_per_s: u16,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// Method by which the board follows a plan.
    pub following: Following,
    /// True if the adapter of the real board hears what it sends.
    pub echo: bool,
    /// Its encoder, from V2.1D on.
    pub encoder: Option<EncoderOptions>,
}

impl InterpCncEntry {
    fn read(keys: &dyn Keys) -> Option<Self> {
        let address = keys.integer("station", 1..=247).unwrap_or(1);
        let baud = keys.integer("baud", 4800..=256_000).unwrap_or(115_200);
        let parities = [("none", Parity::None), ("even", Parity::Even), ("odd", Parity::Odd)];
        let parity = choice(keys, "parity", &parities).unwrap_or(Parity::None);
        let turnaround_us = microseconds(keys, "emulated_turnaround_ms", 2.0);
        let start_stop = keys.integer("start_stop_hz", 1..=65_535).unwrap_or(200);
        let acceleration = keys.integer("acceleration_khz_per_s", 1..=65_535).unwrap_or(2000);
        let echo = keys.flag("echo").unwrap_or(false);
        let start_stop_hz = u16::try_from(start_stop).ok()?;
        let acceleration_khz_per_s = u16::try_from(acceleration).ok()?;
        let buffered = Following::Buffered { start_stop_hz, acceleration_khz_per_s };
        let ways = [("retargeted", Following::Retargeted), ("buffered", buffered)];
        let following = choice(keys, "following", &ways).unwrap_or_default();
        Some(Self {
            address: u8::try_from(address).ok()?,
            baud: u32::try_from(baud).ok()?,
            parity,
            turnaround_us,
            start_stop_hz,
            acceleration_khz_per_s,
            assumptions: assumptions(keys),
            following,
            echo,
            encoder: keys.table("encoder").and_then(|table| encoder(&*table)),
        })
    }

    /// Its line.
    pub fn line(&self) -> Line {
        Line { baud: self.baud, parity: self.parity }
    }

    fn wire(&self) -> Wire {
        let turnaround = Duration::from_micros(self.turnaround_us.into());
        Wire { line: self.line(), turnaround }
    }

    /// Settings of a client that moves these axes.
    pub fn options(&self, axes: &[AxisDemand]) -> InterpCncOptions {
        let axes = axes.iter().filter_map(|demand| {
            let (_, axis) = AXES.get(demand.index)?;
            Some(AxisOptions {
                start_stop_hz: self.start_stop_hz,
                acceleration_khz_per_s: self.acceleration_khz_per_s,
                deceleration_khz_per_s: self.acceleration_khz_per_s,
                max_speed_hz: counted(demand.speed.floor(), MAX_SPEED_HZ),
                ..AxisOptions::new(*axis)
            })
        });
        InterpCncOptions {
            address: self.address,
            line: self.line(),
            following: self.following,
            encoder: self.encoder,
            assumptions: self.assumptions,
            ..InterpCncOptions::new(axes.collect())
        }
    }

    /// Settings of an emulator of it.
    pub fn emulator_options(&self) -> EmulatorOptions {
        EmulatorOptions {
            board: BoardOptions {
                address: self.address,
                line: self.line(),
                assumptions: self.assumptions,
                ..BoardOptions::default()
            },
            bench: Bench { encoder: self.encoder.map(link), ..Bench::default() },
            wire: self.wire(),
            ..EmulatorOptions::default()
        }
    }
}

/// The encoder of a board; `[[axes]]` of the machine gives its axis.
fn encoder(table: &dyn Keys) -> Option<EncoderOptions> {
    table.require("axis");
    let axis = choice(table, "axis", &AXES);
    let points = required_integer(table, "points", -1_000_000_000..=1_000_000_000);
    if points == Some(0) {
        let message = "`points` is 0; an encoder that never counts shows nothing".to_owned();
        table.complain("points", message);
    }
    let increments = required_integer(table, "per_increments", 1..=1_000_000_000);
    let tolerance = required_integer(table, "tolerance_increments", 0..=MOST_TOLERANCE);
    table.finish();
    Some(EncoderOptions {
        axis: axis?,
        points: i32::try_from(points?).ok().filter(|points| *points != 0)?,
        increments: u32::try_from(increments?).ok()?,
        tolerance: u32::try_from(tolerance?).ok()?,
    })
}

/// The encoder as the axis turns it.
fn link(encoder: EncoderOptions) -> EncoderLink {
    let EncoderOptions { axis, points: counts, increments: steps, .. } = encoder;
    EncoderLink { axis, counts, steps, counts_per_revolution: 0 }
}

impl Device for InterpCncEntry {
    fn family(&self) -> &'static dyn Family {
        &InterpCncFamily
    }

    fn copied(&self) -> Box<dyn Device> {
        Box::new(self.clone())
    }

    /// A quarter of its largest velocity, with which the start of a program is approached, must be a speed too, and 200
    /// kHz is the most the board makes.
    fn abilities(&self) -> Abilities {
        Abilities {
            speeds: 4.0..=f64::from(MAX_SPEED_HZ),
            counts: f64::from(i32::MAX),
            start_stop: Some(f64::from(self.start_stop_hz)),
        }
    }

    fn response_us(&self) -> u32 {
        self.turnaround_us
    }

    fn expect_response_us(&mut self, response_us: u32) {
        self.turnaround_us = response_us;
    }

    fn waits(&self, said: Option<Duration>) -> [Duration; 2] {
        // It is asked again at once.
        [said.unwrap_or(InterpCncOptions::new(Vec::new()).deadline), Duration::ZERO]
    }

    fn open(
        &self,
        port: &str,
        axes: &[AxisDemand],
        [deadline, _]: [Duration; 2],
    ) -> Result<Box<dyn Drive>, DriveError> {
        let echo = self.echo;
        let options = InterpCncOptions { deadline, echo, ..self.options(axes) };
        Ok(Box::new(InterpCncDrive::open(port, &options)?))
    }

    fn emulate(&self, axes: &[AxisDemand], clock: DeviceClock) -> Result<Connected, ConnectError> {
        let board = EmulatedBoard::start(&self.emulator_options(), clock)?;
        let port = board.path().display().to_string();
        let options = InterpCncOptions { deadline: EMULATED_DEADLINE, ..self.options(axes) };
        let mut drive = InterpCncDrive::open(&port, &options)?;
        if let Following::Buffered { start_stop_hz, acceleration_khz_per_s } = options.following {
            // The ramps of segments are parameters, which a real board has been given.
            let assumed = options.assumptions;
            for (number, value) in [
                (assumed.segment_acceleration, acceleration_khz_per_s),
                (assumed.segment_start_stop, start_stop_hz),
            ] {
                let (board, runtime) = drive.board();
                let set = board.set_parameter(number, value.into(), LONGEST_STORING, &|| 0);
                runtime.block_on(set)?;
            }
        }
        Ok((Box::new(board), Box::new(drive)))
    }

    fn prediction(&self, axes: &[AxisDemand]) -> Box<dyn Prediction> {
        let options = self.options(axes);
        board_prediction(&options.axes, &self.wire(), options.following, options.encoder)
    }
}
