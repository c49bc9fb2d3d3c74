//! Start-up of drives: checks, planned moves, confirmation and homing.

use super::agreed::{Asked, allowance, homing_speeds, moves};
use super::interrupt::Interrupt;
use super::{APPROACH, outputs, tell_not_stopped};
use crate::approach::{FollowError, follow, lifting_axis};
use crate::attached::Attached;
use crate::check::Outcome;
use crate::command::Failure;
use crate::command::drive::consent::Consent;
use crate::command::following::lost_answers;
use crate::hardware::{Guarded, Hardware};
use crate::real;
use crate::startup;
use crate::startup::{Check, Homed, Looked, Needs, Verdict};
use indicatif::ProgressBar;
use std::time::Duration;
use twin_drives::Increments;
use twin_drives::family::Emulator;
use twin_kinematics::AxisVector;
use twin_machine::{Axis, Machine};

/// How real drives are started up. Positions of devices are compared to two and a half increments, as the guide says.
#[derive(Clone, Debug, clap::Args)]
pub(super) struct StartUpOptions {
    #[command(flatten)]
    consent: Consent,

    /// With --drives real: home all axes first, or these, one after the other
    #[arg(long, value_name = "AXIS,AXIS", num_args = 0..=1, value_delimiter = ',', require_equals = true)]
    home: Option<Vec<String>>,

    /// With --drives real: the axes are homed, also those whose devices do not report it
    #[arg(long)]
    homed: bool,

    /// With --drives real: also print what one lost answer of a drive would cost
    #[arg(short, long)]
    verbose: bool,
}

impl StartUpOptions {
    /// Refuses what has no effect without real drives.
    pub(super) fn without_real(&self) -> Result<(), Failure> {
        let given = [
            ("--yes", self.consent.given()),
            ("--home", self.home.is_some()),
            ("--homed", self.homed),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((name, _)) => {
                Err(Failure::Usage(format!("{name} has no effect without --drives real")))
            }
            None => Ok(()),
        }
    }

    /// The axes that are to be homed first, in this order, by their places in the machine file.
    fn to_home(&self, machine: &Machine) -> Result<Vec<usize>, Failure> {
        let driven = |axis: &Axis| axis.drive.is_some();
        let Some(names) = &self.home else { return Ok(Vec::new()) };
        if names.is_empty() {
            let axes = machine.axes.iter().enumerate().filter(|(_, axis)| driven(axis));
            return Ok(lifting_first(machine, axes.map(|(index, _)| index)));
        }
        let find = |name: &String| {
            let found = machine.axes.iter().position(|axis| axis.name == *name && driven(axis));
            found.ok_or_else(|| {
                let known: Vec<_> = machine.axes.iter().filter(|axis| driven(axis)).collect();
                let known: Vec<_> = known.iter().map(|axis| axis.name.as_str()).collect();
                let known = known.join(", ");
                Failure::Usage(format!("--home: no axis `{name}` has a drive; {known} have"))
            })
        };
        names.iter().map(find).collect()
    }
}

/// The axes in the order in which they are homed: those that lift the tool and do nothing else first.
fn lifting_first(machine: &Machine, axes: impl Iterator<Item = usize>) -> Vec<usize> {
    let lifting = lifting_axis(machine, &machine.middle());
    let (mut first, others): (Vec<_>, Vec<_>) = axes.partition(|axis| Some(*axis) == lifting);
    first.extend(others);
    first
}

/// Real drives that may move.
pub(super) struct Ready {
    drives: Vec<Attached>,
    /// Axes to be homed first.
    to_home: Vec<usize>,
}

/// Bases predictions on the real drives, and reports drives whose response time is not known.
pub(super) fn expect_real(machine: &mut Machine) {
    for device in &mut machine.drives {
        if !device.expect_real() {
            stderr!(
                "note: device `{}` is assumed to answer after {} ms; set `turnaround_ms` in the machine file to the time it takes",
                device.name,
                f64::from(device.expected_response_us()) * 1e-3
            );
        }
    }
}

/// Opens the ports of the machine file, looks whether everything is as it must be, shows what will move, and asks. Nothing moves.
pub(super) fn real(
    options: &StartUpOptions,
    machine: &Machine,
    (outcome, start): (&Outcome, &AxisVector),
    approach: f64,
) -> Result<Ready, Failure> {
    let to_home = options.to_home(machine)?;
    let needs = needs(outcome, |index| {
        if to_home.contains(&index) {
            Homed::First
        } else if options.homed {
            Homed::Said
        } else {
            Homed::Unknown
        }
    });
    let mut drives = Vec::new();
    let mut positions = Vec::new();
    let mut checks = Vec::new();
    let mut doubtful = Vec::new();
    for (index, entry) in machine.drives.iter().enumerate() {
        if machine.axes_of(index).next().is_none() {
            continue;
        }
        let Looked { checks: found, position, doubtful: of_device } =
            match real::open(machine, (index, entry)) {
                Ok(drive) => {
                    stderr!("device `{}`: {}", entry.name, drive.describe());
                    let mut attached = Attached { device: index, drive };
                    let looked = startup::look(machine, &mut attached, &needs);
                    drives.push(attached);
                    looked
                }
                Err(error) => {
                    let check = Check::failed(error.to_string(), error.advice());
                    Looked { checks: vec![check], ..Looked::default() }
                }
            };
        for check in &found {
            stderr!("  {check}");
        }
        positions.push((index, position));
        checks.extend(found);
        doubtful.extend(of_device);
    }
    refuse_failed(&checks)?;
    if drives.is_empty() {
        let path = machine.path.display();
        return Err(Failure::Usage(format!("{path}: no axis has a drive: nothing can move")));
    }
    let ways = check_ways(machine, &positions, &to_home, (outcome, start))?;
    let homing = homing_speeds(machine, &mut drives, &to_home);
    let asked = Asked { outcome, start, approach, homing };
    stderr!("{}", moves(machine, &positions, &to_home, &asked));
    for way in ways {
        stderr!("  {way}");
    }
    stderr!("{}", allowance());
    for output in outputs::switched(machine, &drives, outcome) {
        stderr!("{output}");
    }
    if options.verbose
        && let Some(note) = lost_answers(machine, outcome)
    {
        stderr!("{note}");
    }
    if !doubtful.is_empty() {
        let axes = doubtful.join(", ");
        options.consent.ask(&format!(
            "take the positions of {axes}, which count 0, for true, as the axes were homed and are at their zero now"
        ))?;
    }
    let what = if to_home.is_empty() {
        "move these axes to the start of the program, and run it"
    } else {
        "home axes, move all to the start of the program, and run it"
    };
    options.consent.ask(what)?;
    Ok(Ready { drives, to_home })
}

/// The ways of the axes before the program, as they are planned now: that of homing, from where the axes count that they are,
/// and that to the start. Nothing may be in the way.
fn check_ways(
    machine: &Machine,
    positions: &[(usize, Option<Increments>)],
    to_home: &[usize],
    (outcome, start): (&Outcome, &AxisVector),
) -> Result<Vec<Check>, Failure> {
    let mut from = AxisVector::zeros(machine.axes.len());
    let read = positions.iter().filter_map(|(device, found)| Some((*device, (*found)?)));
    for (device, found) in read {
        startup::include(machine, device, &found, &mut from);
    }
    let (mut ways, tool) = (Vec::new(), outcome.start_tool.as_ref());
    if !to_home.is_empty() {
        ways.push(startup::homing_way(machine, tool, &mut from, to_home));
    }
    match startup::plan_way(machine, tool, [&from, start], APPROACH, true) {
        Ok(way) => ways.push(startup::describe_way(machine, &way)),
        Err(check) => ways.push(check),
    }
    for check in ways.iter().filter(|check| check.has_failed()) {
        stderr!("  {check}");
    }
    refuse_failed(&ways)?;
    Ok(ways)
}

/// What the program asks of every axis.
fn needs(outcome: &Outcome, homed: impl Fn(usize) -> Homed) -> Vec<Needs> {
    let peaks = outcome.peaks.iter().enumerate();
    peaks.map(|(index, peak)| Needs { range: peak.position, homed: homed(index) }).collect()
}

/// All failures have been reported, each.
fn refuse_failed(checks: &[Check]) -> Result<(), Failure> {
    let failed = checks.iter().filter(|check| check.has_failed()).count();
    if failed == 0 {
        return Ok(());
    }
    let plural = if failed == 1 { "check has" } else { "checks have" };
    Err(Failure::Usage(format!("{failed} start-up {plural} failed: nothing has moved")))
}

/// The same checks of emulated drives, which are reported only if they fail. How many there are.
fn emulated(
    machine: &Machine,
    attached: &mut Attached,
    outcome: &Outcome,
) -> Result<usize, Failure> {
    let needs = needs(outcome, |_| Homed::Emulated);
    let looked = startup::look(machine, attached, &needs);
    for check in looked.checks.iter().filter(|check| check.has_failed()) {
        stderr!("  {check}");
    }
    refuse_failed(&looked.checks)?;
    let passed = |check: &&Check| check.verdict == Verdict::Passed;
    Ok(looked.checks.iter().filter(passed).count())
}

impl Ready {
    /// Homes the requested axes. The drives are then ready to move to the start of the program.
    pub(super) fn home(
        self,
        machine: &Machine,
        interrupt: &Interrupt,
    ) -> Result<Vec<Attached>, Failure> {
        let Self { mut drives, to_home } = self;
        for index in to_home {
            let Some(axis) = machine.axes.get(index) else { continue };
            let bar = ProgressBar::new_spinner();
            bar.enable_steady_tick(Duration::from_millis(100));
            bar.set_message(format!("homing axis {}", axis.name));
            stderr!("homing axis {}", axis.name);
            let homed = startup::home(machine, &mut drives, &[index], &|| interrupt.count() > 0);
            bar.finish_and_clear();
            homed?;
            stderr!("axis {} is home", axis.name);
        }
        Ok(drives)
    }
}

/// Powers up the emulated drives of the machine file and lets their drivers bring the axes to the start.
pub(super) fn connect(
    machine: &Machine,
    (outcome, start): (&Outcome, &AxisVector),
    interrupt: &Interrupt,
) -> Result<(Hardware, Vec<Box<dyn Emulator>>), Failure> {
    ask_for_priority();
    let mut connected = crate::emulated::connect(machine)?;
    for (emulator, attached) in &mut connected {
        let (described, place) = (attached.drive.describe(), emulator.place());
        let count = emulated(machine, attached, outcome)?;
        stderr!("emulated {described} on {place}: {count} start-up checks passed");
    }
    let (emulators, drives): (_, Vec<_>) = connected.into_iter().unzip();
    let hardware = go_to_start(machine, drives, (outcome, start), Guarded::Emulated, interrupt)?;
    Ok((hardware, emulators))
}

/// Homes the requested axes and moves all axes to the start.
pub(super) fn start_real(
    ready: Ready,
    machine: &Machine,
    (outcome, start): (&Outcome, &AxisVector),
    interrupt: &Interrupt,
) -> Result<Hardware, Failure> {
    ask_for_priority();
    let drives = ready.home(machine, interrupt)?;
    go_to_start(machine, drives, (outcome, start), Guarded::Real, interrupt)
}

/// Plans the way from where the axes are now, and lets the drives follow it to the start of the program.
fn go_to_start(
    machine: &Machine,
    mut drives: Vec<Attached>,
    (outcome, start): (&Outcome, &AxisVector),
    whose: Guarded,
    interrupt: &Interrupt,
) -> Result<Hardware, Failure> {
    let from = startup::positions(machine, &mut drives)?;
    let (tool, is_real) = (outcome.start_tool.as_ref(), whose == Guarded::Real);
    let way = match startup::plan_way(machine, tool, [&from, start], APPROACH, is_real) {
        Ok(way) => way,
        Err(check) => {
            stderr!("  {check}");
            return Err(Failure::Usage(
                "no way to the start of the program is clear: the axes were not moved there"
                    .to_owned(),
            ));
        }
    };
    let ready = |drives, position: &AxisVector| {
        let hardware = Hardware::start(machine, drives, position, machine.cycle_ns, APPROACH)?;
        wait_until_ready(hardware.guarded(machine, whose), interrupt)
    };
    if !way.is_empty() {
        stderr!("{}", startup::describe_way(machine, &way).message);
        let mut hardware = ready(drives, way.from())?;
        let bar = ProgressBar::new_spinner();
        bar.set_message("the drives move to the start of the program");
        bar.enable_steady_tick(Duration::from_millis(100));
        let followed = follow(&mut hardware, machine, &way, &|| interrupt.count() > 0);
        bar.finish_and_clear();
        drives = followed.map_err(|error| {
            tell_not_stopped(hardware.not_stopped());
            match error {
                FollowError::Interrupted => Failure::StoppedOnTheWay,
                FollowError::Drives(error) => error.into(),
            }
        })?;
    }
    ready(drives, start)
}

fn ask_for_priority() {
    if crate::priority::real_time().is_err() {
        stderr!(
            "note: this user may not run the drives with real-time priority; on a busy computer they lag behind"
        );
    }
}

/// Waits until the drives are enabled and at rest where they are to be.
fn wait_until_ready(mut hardware: Hardware, interrupt: &Interrupt) -> Result<Hardware, Failure> {
    let failure = loop {
        if interrupt.count() > 0 {
            break Failure::StoppedOnTheWay;
        }
        match hardware.ready() {
            Ok(true) => return Ok(hardware),
            Ok(false) => std::thread::sleep(Duration::from_millis(2)),
            Err(error) => break error.into(),
        }
    };
    hardware.abandon();
    tell_not_stopped(hardware.not_stopped());
    Err(failure)
}
