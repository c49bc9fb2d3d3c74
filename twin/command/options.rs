//! Command-line options that several commands share.

use super::Failure;
use crate::limit::Limits;
use crate::m_function::Acknowledge;
use crate::program::inputs::{InputAt, InputChange, Workpiece};
use crate::program::settings;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use crate::session::override_factor;
use crate::setpoint_source::MOST_OVERRIDE;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::io::BufRead;
use std::net::{Ipv4Addr, SocketAddr, ToSocketAddrs};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use twin_gcode::din66025::{DEFAULT_JUMPS, Variables};
use twin_gcode::rs274::{Control, FlowLimits, LengthUnit, ToolTable};
use twin_machine::{Machine, Scenario, ToolTableFileError, limited_read, load_tool_table};
use twin_planner::controller::XDirection;
use twin_planner::controller::{DEFAULT_WINDOW, Inputs, Override, VelocityMode};

/// The machine.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct MachineOption {
    /// Machine file (TOML); machines/*.toml are commented examples
    #[arg(long, short, value_name = "FILE")]
    pub(super) machine: PathBuf,
}

impl MachineOption {
    pub(super) fn path(&self) -> &Path {
        &self.machine
    }

    pub(super) fn load(&self) -> Result<Machine, Failure> {
        Ok(Machine::load(&self.machine)?)
    }
}

/// Surroundings of the machine for one job.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct SceneOption {
    /// Scene file (TOML): [[bodies]], [[obstacles]], [[friction]] and [[grippers]], added to those of the machine file
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
}

impl SceneOption {
    /// The machine with what the scene adds.
    pub(super) fn apply(&self, machine: &mut Machine) -> Result<(), Failure> {
        if let Some(path) = &self.scene {
            machine.add_scene(path)?;
        }
        Ok(())
    }

    pub(super) fn file(&self) -> Option<&Path> {
        self.scene.as_deref()
    }
}

/// Plan of the velocity along the path.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct LimitsOption {
    /// Plan of the velocity: within the limits of every axis, or by F and E alone as SoftMotion's own plan, whose overloads are
    /// errors [default: `plan` of [controller] in the machine file, which is axes unless it says otherwise; programmed with
    /// --profile, --look-ahead, --at, --by-position and an --override above 200]
    #[arg(long, value_enum)]
    limits: Option<Limits>,
}

impl LimitsOption {
    /// Plan of `program` on `machine`.
    pub(super) fn of(self, machine: &Machine, program: &ProgramFile) -> Result<Limits, Failure> {
        let given = self.limits;
        let limits = given.unwrap_or(if machine.plans_as_programmed {
            Limits::Programmed
        } else {
            Limits::Axes
        });
        match within_axes(program) {
            _ if limits == Limits::Programmed => Ok(limits),
            Ok(()) => Ok(limits),
            Err(_) if given.is_none() => Ok(Limits::Programmed),
            Err(message) => Err(Failure::Usage(message.to_owned())),
        }
    }
}

/// What happens to the simulated machine.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct SimulationOptions {
    /// Let things go wrong on the simulated machine, as a scenario file (TOML) says: axes that jam, lost steps, loose belts, power
    /// losses, each at a time or a line of the program
    #[arg(long, value_name = "FILE.toml")]
    faults: Option<PathBuf>,

    /// Seed of the noise of encoders and axes ([axes.physics.noise] in the machine file): the same seed, the same run [default: 0]
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,

    #[command(flatten)]
    pub(super) in_loop: InLoopOption,
}

/// What the motors of the simulated machine get.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct InLoopOption {
    /// Feed the simulated motors from the drives' own profile generators instead of the set-points, at the rate that the wires
    /// allow. For all drives of the machine file; `in_loop = true` there does it for one drive
    #[arg(long = "drives-in-loop")]
    drives_in_loop: bool,
}

impl InLoopOption {
    /// True if the option was given.
    pub(super) fn given(self) -> bool {
        self.drives_in_loop
    }

    pub(super) fn apply(self, machine: &mut Machine) -> Result<(), Failure> {
        if self.drives_in_loop {
            if machine.drives.is_empty() {
                let path = machine.path.display();
                let message = format!("--drives-in-loop: {path} names no [[drives]]");
                return Err(Failure::Usage(message));
            }
            machine.put_drives_in_loop();
        }
        Ok(())
    }
}

impl SimulationOptions {
    pub(super) fn scenario(&self, machine: &Machine) -> Result<Scenario, Failure> {
        let scenario = match &self.faults {
            Some(path) => Scenario::load(path, machine)?,
            None => Scenario::default(),
        };
        Ok(Scenario { seed: self.seed.unwrap_or(0), ..scenario })
    }

    pub(super) fn faults_file(&self) -> Option<&Path> {
        self.faults.as_deref()
    }

    /// Refuses what says nothing where nothing is simulated.
    pub(super) fn without_physics(&self) -> Result<(), Failure> {
        let given = [
            ("--faults", self.faults.is_some()),
            ("--seed", self.seed.is_some()),
            ("--drives-in-loop", self.in_loop.given()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => {
                Err(Failure::Usage(format!("{name} has no effect without --physics")))
            }
            None => Ok(()),
        }
    }
}

/// How the program is read.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct ReadOptions {
    /// Language of the program [default: by its ending and first lines; the choice is printed]
    #[arg(long, value_enum)]
    pub(super) dialect: Option<Dialect>,

    /// Leave out blocks that begin with `/`
    #[arg(long)]
    pub(super) skip_suppressed: bool,

    /// Value of a variable that the program names as $NAME$; may be given several times
    #[arg(long = "var", value_name = "NAME=NUMBER")]
    variables: Vec<String>,

    /// File with variables (TOML): NAME = NUMBER, or NAME = [up to 8 numbers] for M functions with O$NAME$
    #[arg(long = "variables", value_name = "FILE")]
    variables_file: Option<PathBuf>,

    /// Jumps (G20; loops and calls of RS274) after which a program counts as endless
    #[arg(long, value_name = "COUNT", default_value_t = DEFAULT_JUMPS)]
    max_jumps: u32,

    /// Subroutines of RS274 that may call each other in a row; LinuxCNC allows 9
    #[arg(long, value_name = "COUNT", default_value_t = FlowLimits::default().depth)]
    max_depth: usize,

    /// Control that an RS274 program is meant for: what it refuses, passes over or reads differently is a finding
    /// [default: `control` of [rs274] in the machine file]
    #[arg(long = "for", value_name = "CONTROL", value_parser = controls())]
    control: Option<Control>,

    /// Refuse what LinuxCNC refuses in an RS274 program, also where shops run it: no M2, no F, coordinates before a motion word,
    /// M words of other controls
    #[arg(long)]
    strict: bool,

    /// Folder with subroutines of RS274 (`NAME.ngc` for `o<NAME> call`), searched after that of the program; may be given several times
    #[arg(long, value_name = "DIR")]
    subroutines: Vec<PathBuf>,

    /// Tool table of an RS274 program, in place of the machine file's: TOML (`.toml`), or LinuxCNC's format with lengths in the
    /// machine file's unit
    #[arg(long, value_name = "FILE")]
    tool_table: Option<PathBuf>,

    /// Path elements that the planner knows in advance (size of the queue): with too few, short elements do not reach their feed
    #[arg(long, value_name = "COUNT", default_value_t = DEFAULT_WINDOW)]
    look_ahead: NonZeroUsize,

    /// Percent of all programmed velocities, 1 at least (dOverride)
    #[arg(long = "override", value_name = "PERCENT", default_value = "100", hide_default_value = true, value_parser = factor)]
    factor: Override,

    /// How the velocity goes from one value to another (iVelMode)
    #[arg(long, value_enum, default_value = "trapezoid")]
    profile: Profile,

    /// Largest change of the acceleration along the path, for --profile jerk-limited
    #[arg(long, value_name = "MM/S3", value_parser = jerk, required_if_eq("profile", "jerk-limited"))]
    jerk: Option<f64>,
}

/// Inputs of the interpolator while the program runs.
#[derive(Clone, Debug, Default, clap::Args)]
pub(super) struct InputOptions {
    /// Change an input of the interpolator at a time, s; may be given several times. INPUT=VALUE is one of
    /// override=PERCENT, slow-stop, emergency-stop, wait-at-next-stop, single-step and abort, each =on or =off
    #[arg(long = "at", value_name = "TIME:INPUT=VALUE")]
    pub(super) changes: Vec<InputAt>,

    /// Along X as a workpiece was measured (`SMC_XInterpolator`): a file with its position in every cycle, mm, one a line
    #[arg(long, value_name = "FILE")]
    pub(super) by_position: Option<PathBuf>,

    /// Measured position at which the workpiece's zero lies at the path's (dXOffset)
    #[arg(long, value_name = "MM", default_value = "0", requires = "by_position", allow_hyphen_values = true, value_parser = place)]
    position_offset: f64,

    /// The workpiece moves against X (eDirection)
    #[arg(long, requires = "by_position")]
    against_x: bool,
}

/// Farthest position of a workpiece, mm.
const FARTHEST: f64 = 1e6;

fn place(text: &str) -> Result<f64, String> {
    let number: f64 =
        text.trim().parse().ok().ok_or_else(|| format!("`{text}` is not a number"))?;
    if number.abs() <= FARTHEST {
        Ok(number)
    } else {
        Err(format!("{number} is not between {} and {FARTHEST}", -FARTHEST))
    }
}

impl InputOptions {
    /// The workpiece that the path follows, if there is one.
    pub(super) fn workpiece(&self) -> Result<Option<Workpiece>, Failure> {
        let Some(file) = &self.by_position else { return Ok(None) };
        let failed = |source| unreadable(file, source);
        let lines = limited_read::read(file).map_err(failed)?;
        let mut positions = Vec::new();
        for (number, line) in (1..).zip(lines.lines()) {
            let line: String = line.map_err(failed)?;
            let position = place(&line).map_err(|what| {
                Failure::Usage(format!("{}: line {number}: {what}", file.display()))
            })?;
            positions.push(position * 1e-3);
        }
        let direction = if self.against_x { XDirection::Negative } else { XDirection::Positive };
        let offset = self.position_offset * 1e-3;
        Ok(Some(Workpiece { positions: positions.into(), offset, direction }))
    }

    /// Adds the inputs of a program that a machine shall follow to its `settings`.
    fn complete(&self, settings: &mut ReadSettings) -> Result<(), Failure> {
        let usage = |message: &str| Err(Failure::Usage(message.to_owned()));
        let mut changes = self.changes.clone();
        changes.sort_by_key(|change| change.time_ns);
        let mut inputs = settings.inputs;
        for InputAt { change, .. } in &changes {
            if let InputChange::EmergencyStop(_) | InputChange::Abort(_) = change {
                return usage(
                    "--at emergency-stop and abort stop the set-point within a cycle, which no axis can follow; take slow-stop",
                );
            }
            change.apply(&mut inputs).map_err(|error| Failure::Usage(error.to_string()))?;
        }
        if inputs.slow_stop || inputs.wait_at_next_stop {
            return usage("the last of --at leaves the path waiting for ever; add one with =off");
        }
        settings.workpiece = self.workpiece()?;
        if settings.workpiece.is_some() && !changes.is_empty() {
            return usage(
                "--at has no effect with --by-position, where the workpiece sets the speed of the path",
            );
        }
        settings.changes = changes;
        Ok(())
    }
}

/// How the velocity goes from one value to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Profile {
    /// With constant acceleration
    Trapezoid,
    /// Along sin², in the same time, with up to π/2 times the acceleration
    Sigmoid,
    /// With an acceleration that changes by no more than --jerk
    JerkLimited,
}

fn factor(text: &str) -> Result<Override, String> {
    let factor = override_factor(text).ok_or_else(|| format!("`{text}` is not a number"))?;
    Override::new(factor)
        .map_err(|error| format!("{error}; give percent, at least 1, like 50 for half the feed"))
}

fn jerk(text: &str) -> Result<f64, String> {
    let jerk: f64 = text.parse().ok().ok_or_else(|| format!("`{text}` is not a number"))?;
    if (1e-3..=1e12).contains(&jerk) {
        Ok(jerk * 1e-3)
    } else {
        Err(format!("{jerk} is not between 0.001 and 1e12"))
    }
}

/// Who acknowledges M functions.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct AcknowledgeOption {
    /// Who confirms that an M function is done: no one (auto), how long each takes (like 500ms or 2s), or you, with
    /// the Enter key (prompt). M functions in the machine file's `[[m_functions]]` are done when the drives have switched
    /// their outputs and their time is over
    #[arg(long = "m-ack", value_name = "auto|DURATION|prompt", default_value = "auto")]
    pub(super) acknowledge: Acknowledge,
}

impl ReadOptions {
    /// The file with variables, if there is one.
    pub(super) fn variables_file(&self) -> Option<&Path> {
        self.variables_file.as_deref()
    }

    /// The program at `path`; `unit` is that of a tool table.
    pub(super) fn program(&self, path: &Path, unit: LengthUnit) -> Result<ProgramFile, Failure> {
        self.program_with(path, unit, &InputOptions::default())
    }

    /// As [`Self::program`], with inputs that change while it runs.
    pub(super) fn program_with(
        &self,
        path: &Path,
        unit: LengthUnit,
        inputs: &InputOptions,
    ) -> Result<ProgramFile, Failure> {
        let mut settings = self.settings(unit)?;
        inputs.complete(&mut settings)?;
        let dialect = self.dialect_of(path)?;
        self.check_for(dialect)?;
        self.check_control(path, dialect)?;
        if dialect == Some(Dialect::Job)
            && (!settings.changes.is_empty() || settings.workpiece.is_some())
        {
            let message = "--at and --by-position are for paths: a job has no interpolator";
            return Err(Failure::Usage(message.to_owned()));
        }
        Ok(ProgramFile::new(path, dialect, settings)?)
    }

    /// An option that says nothing in this dialect is a mistake.
    pub(super) fn check_for(&self, dialect: Option<Dialect>) -> Result<(), Failure> {
        let variables = !self.variables.is_empty() || self.variables_file.is_some();
        let (what, whose) = match dialect {
            Some(Dialect::Rs274 | Dialect::Job | Dialect::Dxf) if variables => {
                ("--var and --variables", "DIN 66025")
            }
            Some(Dialect::Din66025 | Dialect::Job | Dialect::Dxf) if self.tool_table.is_some() => {
                ("--tool-table", "RS274")
            }
            Some(Dialect::Din66025 | Dialect::Job | Dialect::Dxf)
                if !self.subroutines.is_empty() =>
            {
                ("--subroutines", "RS274")
            }
            Some(Dialect::Din66025 | Dialect::Job | Dialect::Dxf) if self.strict => {
                ("--strict", "RS274")
            }
            Some(Dialect::Job | Dialect::Dxf) if self.skip_suppressed => {
                ("--skip-suppressed", "DIN 66025 and RS274")
            }
            Some(Dialect::Job) if self.factor.factor() > 1.0 => (
                "--override above 100 %",
                "DIN 66025 and RS274; blocks of a job say themselves how fast",
            ),
            Some(Dialect::Job) if self.profile != Profile::Trapezoid => {
                ("--profile", "DIN 66025 and RS274; a job has its `ramp`")
            }
            _ => return Ok(()),
        };
        Err(Failure::Usage(format!("{what} is for programs in {whose}, which this is not")))
    }

    /// Programs in other dialects than RS274 are not for controls that read it.
    fn check_control(&self, path: &Path, dialect: Option<Dialect>) -> Result<(), Failure> {
        let Some(control) = self.control.filter(|control| *control != Control::SoftMotion) else {
            return Ok(());
        };
        let path = path.display();
        match dialect {
            Some(Dialect::Job) => Err(Failure::Usage(format!(
                "--for {} is for programs, and {path} is a job",
                control.name()
            ))),
            Some(Dialect::Din66025) => Err(Failure::Usage(format!(
                "{control} does not read DIN 66025; `twin path {path} --for {} --format rs274` makes a program of it",
                control.name()
            ))),
            _ => Ok(()),
        }
    }

    /// The given dialect, or else the guessed one.
    pub(super) fn dialect_of(&self, path: &Path) -> Result<Option<Dialect>, Failure> {
        match self.dialect {
            Some(dialect) => Ok(Some(dialect)),
            None => Dialect::guess(path).map_err(|source| unreadable(path, source)),
        }
    }

    /// Read settings of a program; `unit` is that of a tool table.
    pub(super) fn settings(&self, unit: LengthUnit) -> Result<ReadSettings, Failure> {
        let mut variables = Variables::default();
        if let Some(file) = &self.variables_file {
            settings::read_variables(file, &mut variables)?;
        }
        for definition in &self.variables {
            settings::define(definition, &mut variables)?;
        }
        let mode = match (self.profile, self.jerk) {
            (Profile::Trapezoid, _) => VelocityMode::Trapezoid,
            (Profile::Sigmoid, _) => VelocityMode::Sigmoid,
            (Profile::JerkLimited, jerk) => {
                VelocityMode::JerkLimited { jerk: jerk.unwrap_or_default() }
            }
        };
        if self.jerk.is_some() && self.profile != Profile::JerkLimited {
            let message = "--jerk has no effect without --profile jerk-limited";
            return Err(Failure::Usage(message.to_owned()));
        }
        let inputs = Inputs { override_factor: self.factor, mode, ..Inputs::default() };
        Ok(ReadSettings {
            inputs,
            look_ahead: self.look_ahead,
            skip_suppressed: self.skip_suppressed,
            variables,
            jumps: self.max_jumps,
            depth: self.max_depth,
            subroutines: self.subroutines.clone(),
            control: self.control,
            strict: self.strict,
            tools: self.tool_table.as_deref().map(|path| tools(path, unit)).transpose()?,
            ..ReadSettings::default()
        })
    }
}

/// The names of controls.
pub(super) fn controls() -> impl TypedValueParser<Value = Control> {
    let names = PossibleValuesParser::new(Control::ALL.map(Control::name));
    names.try_map(|name| {
        Control::ALL.into_iter().find(|control| control.name() == name).ok_or("no such control")
    })
}

fn tools(path: &Path, unit: LengthUnit) -> Result<ToolTable, Failure> {
    load_tool_table(path, unit).map_err(|error| match error {
        ToolTableFileError::Toml(error) => Failure::Machine(error),
        error @ ToolTableFileError::Lines { .. } => Failure::Usage(error.to_string()),
    })
}

/// Refuses jobs where an option or command is about paths.
pub(super) fn expect_path(program: &ProgramFile) -> Result<(), Failure> {
    if program.dialect() == Dialect::Job {
        return Err(Failure::Usage(format!(
            "{} is a job: its blocks move axes and say how fast, there is no path to plan; `twin check` and `twin run` take it",
            program.path().display()
        )));
    }
    Ok(())
}

/// Refuses inputs of the controller for a plan within the limits of the axes.
pub(super) fn plans_without_inputs(program: &ProgramFile) -> Result<(), Failure> {
    expect_path(program)?;
    within_axes(program).map_err(|message| Failure::Usage(message.to_owned()))
}

/// Refuses programs that cannot be planned within the limits of the axes: such plans have no profile, and no override above
/// the largest.
fn within_axes(program: &ProgramFile) -> Result<(), &'static str> {
    let Inputs { override_factor, mode, .. } = program.settings().inputs;
    Err(if mode != VelocityMode::default() {
        "--profile is for the plan by F and E alone (--limits programmed)"
    } else if override_factor.factor() > MOST_OVERRIDE {
        "within the limits of the axes --override is 200 at most"
    } else if program.settings().look_ahead != DEFAULT_WINDOW {
        "--look-ahead is for the plan by F and E alone (--limits programmed)"
    } else if !program.settings().changes.is_empty() || program.settings().workpiece.is_some() {
        "--at and --by-position are for the plan by F and E alone (--limits programmed)"
    } else if program.dialect() == Dialect::Job {
        "a job has no path to plan: --limits is for programs"
    } else {
        return Ok(());
    })
}

/// The failure to read a program.
pub(super) fn unreadable(path: &Path, source: std::io::Error) -> Failure {
    Failure::Program { path: path.display().to_string(), source }
}

/// Default address of a page.
pub(super) const DEFAULT_ADDRESS: &str = "127.0.0.1:9090";

/// An address to serve a page at: `PORT` on this computer only, or `HOST:PORT`.
pub(super) fn address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(port) = text.parse::<u16>() {
        return Ok(SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    }
    let mut found =
        text.to_socket_addrs().map_err(|error| format!("{error}; expected PORT or HOST:PORT"))?;
    found.next().ok_or_else(|| "unknown host; expected PORT or HOST:PORT".to_owned())
}

#[cfg(test)]
mod tests {
    use super::{DEFAULT_ADDRESS, address};

    #[test]
    fn a_port_alone_stays_on_this_computer() {
        let address = |text| address(text).map(|address| address.to_string());
        assert_eq!(address("9999").as_deref(), Ok("127.0.0.1:9999"));
        assert_eq!(address(DEFAULT_ADDRESS).as_deref(), Ok(DEFAULT_ADDRESS));
        assert_eq!(address("0.0.0.0:80").as_deref(), Ok("0.0.0.0:80"));
        assert!(address("examples/plate.cnc").is_err());
        assert!(address("70000").is_err());
        assert!(address("").is_err());
    }
}
