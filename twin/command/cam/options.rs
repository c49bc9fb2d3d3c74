//! Options of the `twin cam` commands: reading and use of the cam, motion of the master, limits of the slave.

use crate::cam::check::{AxisLimits, CamUse};
use crate::command::Failure;
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use twin_cam::{Interpolation, MasterMotion, SlaveLimits};
use twin_machine::cam_file::unit_fits;
use twin_machine::cam_file::{CamFile, CamRemark, Coupling, no_scaling};
use twin_machine::{Axis, Machine};

/// A finite number.
pub(in crate::command) fn number(text: &str) -> Result<f64, String> {
    let number = at_most(text)?;
    if number == 0.0 || number.abs() >= 1e-15 {
        Ok(number)
    } else {
        Err(format!("`{text}` is nearer to 0 than ±1e-15; 0 is written `0`"))
    }
}

fn at_most(text: &str) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().ok().ok_or_else(|| format!("`{text}` is not a number"))?;
    if number.abs() <= 1e15 { Ok(number) } else { Err(format!("`{text}` is beyond ±1e15")) }
}

/// A number that is greater than 0.
pub(in crate::command) fn positive(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if number > 0.0 { Ok(number) } else { Err(format!("{number} is not greater than 0")) }
}

/// A number that is not negative.
pub(in crate::command) fn magnitude(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if number >= 0.0 { Ok(number) } else { Err(format!("{number} is less than 0")) }
}

/// How fast the master goes.
fn velocity(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if number > 0.0 {
        Ok(number)
    } else if number < 0.0 {
        let message = "give the master's velocity without its sign; --master-scaling with the other sign reverses it";
        Err(format!("{number} is less than 0: {message}"))
    } else {
        Err("0 is not greater than 0: a master at rest moves nothing".to_owned())
    }
}

/// A factor that is not next to 0.
fn factor(text: &str) -> Result<f64, String> {
    let number = at_most(text)?;
    no_scaling("the scaling", number).map_or(Ok(number), Err)
}

/// How tables go on between their points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::command) enum Between {
    /// Straight lines
    Linear,
    /// Cubics with continuous velocity
    Cubic,
}

impl From<Between> for Interpolation {
    fn from(between: Between) -> Self {
        match between {
            Between::Linear => Self::Linear,
            Between::Cubic => Self::Cubic,
        }
    }
}

/// Reads a cam.
pub(in crate::command) fn load(path: &Path, between: Option<Between>) -> Result<CamFile, Failure> {
    let file = read(path, between)?;
    if between.is_some()
        && let Some(why) = file.no_interpolation()
    {
        let message =
            format!("{}: {why}; --interpolation is for tables in .csv and .asc", path.display());
        return Err(Failure::Usage(message));
    }
    Ok(file)
}

/// As [`load`], where the interpolation is also used for something else.
pub(super) fn read(path: &Path, between: Option<Between>) -> Result<CamFile, Failure> {
    let interpolation = between.map_or(Interpolation::Linear, Interpolation::from);
    let file = CamFile::load(path, interpolation).map_err(Box::new)?;
    for CamRemark { text, is_note } in &file.remarks {
        stderr!("{}{}: {text}", if *is_note { "note: " } else { "" }, path.display());
    }
    Ok(file)
}

/// How a cam is used: offsets and scalings of `MC_CamIn`. The default is the cam's `[coupling]`.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Coupling (MC_CamIn); default: [coupling] of the cam")]
pub(in crate::command) struct UseOptions {
    /// Added to the master's position behind its scaling (`MasterOffset`)
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = number)]
    master_offset: Option<f64>,

    /// Factor of the master's position (`MasterScaling`)
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = factor)]
    master_scaling: Option<f64>,

    /// Added to the slave's position behind its scaling (`SlaveOffset`)
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = number)]
    slave_offset: Option<f64>,

    /// Factor of the slave's position (`SlaveScaling`)
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = factor)]
    slave_scaling: Option<f64>,

    /// The cam is put end to end (Periodic), whatever its file says
    #[arg(long, conflicts_with = "once")]
    end_to_end: bool,

    /// The slave stays where the cam ends, whatever its file says
    #[arg(long)]
    once: bool,

    /// Between the points of tables read from .csv and .asc [default: linear]
    #[arg(long, value_enum)]
    pub(in crate::command) interpolation: Option<Between>,
}

impl UseOptions {
    fn coupling(&self, file: &CamFile) -> Coupling {
        let mut coupling = file.coupling;
        let input = &mut coupling.input;
        for (slot, given) in [
            (&mut input.master_offset, self.master_offset),
            (&mut input.master_scaling, self.master_scaling),
            (&mut input.slave_offset, self.slave_offset),
            (&mut input.slave_scaling, self.slave_scaling),
        ] {
            *slot = given.unwrap_or(*slot);
        }
        coupling
    }

    /// Use of `file` with a master and limits.
    pub(in crate::command) fn using(
        &self,
        file: &CamFile,
        master: MasterMotion,
        limits: AxisLimits,
    ) -> CamUse {
        let repeated = if self.once { false } else { self.end_to_end || file.repeated };
        CamUse { master, coupling: self.coupling(file), repeated, limits, start: None }
    }
}

/// What the master does at most.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Master")]
#[expect(clippy::struct_field_names, reason = "the names of the options")]
pub(in crate::command) struct MasterOptions {
    /// Its velocity, u/s; a master that goes backwards has a negative --master-scaling [default: 1]
    #[arg(long, value_name = "U/S", allow_hyphen_values = true, value_parser = velocity)]
    master_velocity: Option<f64>,

    /// Its acceleration and deceleration, u/s² [default: 0]
    #[arg(long, value_name = "U/S2", value_parser = magnitude)]
    master_acceleration: Option<f64>,

    /// Its jerk, u/s³; counts for the jerk of the slave only
    #[arg(long, value_name = "U/S3", default_value = "0", value_parser = magnitude)]
    master_jerk: f64,
}

impl MasterOptions {
    pub(in crate::command) fn motion(&self) -> MasterMotion {
        self.motion_or(MasterMotion::default())
    }

    /// The given values, and those of `shown` for the others.
    pub(in crate::command) fn motion_or(&self, shown: MasterMotion) -> MasterMotion {
        MasterMotion {
            velocity: self.master_velocity.unwrap_or(shown.velocity),
            acceleration: self.master_acceleration.unwrap_or(shown.acceleration),
            jerk: self.master_jerk,
        }
    }
}

/// What the slave can do.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Limits of the slave")]
pub(in crate::command) struct LimitOptions {
    /// Machine file with the slave's axis; degrees and mm
    #[arg(long, short, value_name = "FILE", requires = "axis")]
    machine: Option<PathBuf>,

    /// Name of the slave's axis in the machine file
    #[arg(long, value_name = "NAME", requires = "machine")]
    axis: Option<String>,

    /// Largest velocity, u/s; in place of that of the machine file, as what follows
    #[arg(long, value_name = "U/S", value_parser = positive)]
    max_velocity: Option<f64>,

    /// Largest acceleration, u/s²
    #[arg(long, value_name = "U/S2", value_parser = positive)]
    max_acceleration: Option<f64>,

    /// Largest jerk, u/s³
    #[arg(long, value_name = "U/S3", value_parser = positive)]
    max_jerk: Option<f64>,

    /// Least position, u
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = number)]
    position_min: Option<f64>,

    /// Greatest position, u
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = number)]
    position_max: Option<f64>,
}

impl LimitOptions {
    /// The machine file, if there is one.
    pub(in crate::command) fn machine_file(&self) -> Option<&Path> {
        self.machine.as_deref()
    }

    /// The limits for the slave of `file`.
    pub(in crate::command) fn limits(&self, file: &CamFile) -> Result<AxisLimits, Failure> {
        let mut limits = match (&self.machine, &self.axis) {
            (Some(path), Some(name)) => of_machine(path, name, file)?,
            _ => AxisLimits::NONE,
        };
        let motion = &mut limits.motion;
        let [low, high] = &mut limits.position;
        for (slot, given) in [
            (&mut motion.velocity, self.max_velocity),
            (&mut motion.acceleration, self.max_acceleration),
            (&mut motion.jerk, self.max_jerk),
            (low, self.position_min),
            (high, self.position_max),
        ] {
            *slot = given.unwrap_or(*slot);
        }
        let [low, high] = limits.position;
        if low >= high {
            let message = format!("--position-min {low} is not less than --position-max {high}");
            return Err(Failure::Usage(message));
        }
        Ok(limits)
    }
}

fn of_machine(path: &Path, name: &str, file: &CamFile) -> Result<AxisLimits, Failure> {
    let machine = Machine::load(path)?;
    let axis = machine.axes.iter().find(|axis| axis.name == name);
    let Some(axis) = axis else {
        let names: Vec<_> = machine.axes.iter().map(|axis| axis.name.as_str()).collect();
        let message =
            format!("{}: unknown axis {name}; the axes are {}", path.display(), names.join(", "));
        return Err(Failure::Usage(message));
    };
    if !unit_fits(&file.slave, axis.kind) {
        let message = format!(
            "{}: the slave is in {}, axis {name} in {}",
            file.path.display(),
            file.slave.unit(),
            axis.unit()
        );
        return Err(Failure::Usage(message));
    }
    Ok(slave_limits(axis))
}

/// Limits of an axis of a machine as those of a slave, in degrees or mm.
fn slave_limits(axis: &Axis) -> AxisLimits {
    AxisLimits {
        position: if axis.limited {
            axis.position_limits.map(|limit| axis.from_si(limit))
        } else {
            AxisLimits::NONE.position
        },
        motion: SlaveLimits {
            velocity: axis.from_si(axis.max_velocity),
            acceleration: axis.from_si(axis.smallest_acceleration()),
            jerk: axis.max_jerk.map_or(f64::INFINITY, |jerk| axis.from_si(jerk)),
        },
        period: axis.period.map(|period| axis.from_si(period)),
    }
}
