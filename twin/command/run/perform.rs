//! Execution of a checked program: open drives and view, run, and bring everything to rest.

use super::axis_watch::AxisWatch;
use super::deadline::Deadline;
use super::interrupt::Interrupt;
use super::prompt::Prompt;
use super::summary::Report;
use super::watcher::{Watcher, open_keys};
use super::{APPROACH, Arguments, Drives, startup};
use crate::clock::Clock;
use crate::command::progress::ProgressLines;
use crate::command::{Failure, show};
use crate::finding::Finding;
use crate::hardware::Heard;
use crate::limit::Limits;
use crate::live_view::Picture;
use crate::messages::recording_ended;
use crate::program::Dialect;
use crate::report::AxisMaximaReport;
use crate::session::{Ending, Session};
use crate::simulated::Simulated;
use twin_kinematics::AxisVector;
use twin_machine::DeviceEntry;
use twin_number::seconds;
use twin_viz::{Playback, SceneOptions, VizError};

/// A run that has come to its end, wherever that was.
pub(super) struct Done<'m> {
    pub(super) ending: Ending,
    pub(super) samples: Heard,
    /// Of the axes, if they are wanted.
    pub(super) maxima: Option<Vec<(String, AxisMaximaReport)>>,
    /// On the wall clock, s.
    pub(super) took: f64,
    /// Still open: its page is served as long as it lives.
    pub(super) picture: Picture<'m>,
    /// Result of view and recording.
    pub(super) shown: Result<(), Failure>,
    /// Recordings and logs that ended before the run.
    pub(super) ended: Vec<Finding>,
    /// Of what follows, once all drives are at rest.
    pub(super) deadline: Option<Deadline>,
}

/// Opens view and drives, runs the program, and brings everything to rest. Also Ctrl-C, which is caught from the
/// moment on that something needs an orderly end, unless it has been caught for the program before.
pub(super) fn perform<'m>(
    arguments: &Arguments,
    about: &Report<'m>,
    (start, continues): (&AxisVector, Option<AxisVector>),
    caught: Option<Interrupt>,
) -> Result<(Done<'m>, Interrupt), Failure> {
    let (machine, program, outcome) = (about.machine, about.program, about.outcome);
    let emulated = arguments.drives == Drives::Emulated && !machine.drives.is_empty();
    let has_drives = emulated || arguments.drives == Drives::Real;
    let paced = arguments.realtime || has_drives;
    let axes = arguments.axis_watch.open(machine, has_drives, paced)?;
    // Until here Ctrl-C ends everything, and so it does while the user is asked.
    let real = (arguments.drives == Drives::Real)
        .then(|| startup::real(&arguments.start_up, machine, (outcome, start), APPROACH))
        .transpose()?;
    let scene = SceneOptions {
        record: arguments.record.clone(),
        serve: arguments.serve,
        // A page that plays at its own pace keeps up with the many samples of drives also where it is drawn without a
        // graphics card, and one that is opened late shows the whole run.
        playback: Playback::FromStart,
        is_paced: paced,
        number: (!paced).then(|| arguments.number(machine, outcome)),
    };
    let mut families: Vec<_> = machine.drives.iter().map(DeviceEntry::family_name).collect();
    families.dedup();
    let families = families.join(" and ");
    let named = match arguments.drives {
        Drives::Emulated if emulated => Some(format!("{families}, emulated")),
        Drives::Real => Some(families),
        Drives::Emulated | Drives::None => None,
    };
    let mut picture = Picture::open(&scene, machine, program, start, named.as_deref())?;
    if let Some(url) = picture.url() {
        stderr!("live view: {url}");
    }
    let interrupt = match caught {
        Some(caught) => caught,
        None if real.is_some() => Interrupt::catch_for_drives()?,
        None => Interrupt::catch()?,
    };
    if arguments.drives == Drives::Emulated && !emulated {
        stderr!("{} names no drives; the simulated machine runs alone", machine.path.display());
    }
    let scenario = arguments.simulation.scenario(machine)?;
    let twin =
        Simulated::with_spindle(machine, start, program.spindle(machine))?.in_scenario(&scenario);
    let drives = if let Some(ready) = real {
        Some((startup::start_real(ready, machine, (outcome, start), &interrupt)?, Vec::new()))
    } else if emulated {
        Some(startup::connect(machine, (outcome, start), &interrupt)?)
    } else {
        None
    };
    // They live until the drives have come to rest.
    let (hardware, emulators) = drives.unzip();

    let bar = show::progress(
        u64::try_from(about.outcome.duration_ns / 1_000_000).unwrap_or(0),
        "{elapsed_precise} {bar:30} {percent:>3} %  {msg}",
    );
    let acknowledge = arguments.m_functions.acknowledge;
    let realtime = arguments.realtime;
    let limits = arguments.limits.of(machine, program)?;
    let overrides = &arguments.override_at;
    let stepping = limits == Limits::Programmed
        && program.dialect() != Dialect::Job
        && program.settings().workpiece.is_none();
    let session = Session {
        machine,
        program,
        continues,
        twin,
        hardware,
        limits,
        acknowledge,
        overrides,
        realtime,
    };
    let mut watcher = Watcher {
        picture: &mut picture,
        bar: &bar,
        axes,
        lines: ProgressLines::new(format!("running {}", program.path().display())),
        last_shown_ns: i64::MIN,
        drive_error: None,
        samples: Heard::default(),
        prompt: Prompt::default(),
        keys: if paced { open_keys(program, stepping) } else { None },
        stepping,
    };
    let clock = Clock::start();
    let ending = session
        .run(&mut watcher, &|| interrupt.count())
        .map_err(|failure| Failure::check(program, failure.into()))?;
    let took = seconds(clock.now_ns());
    // Drives that have not confirmed their stop are still being asked, and that must not end.
    let deadline = ending.stopping.is_none().then(Deadline::set).transpose()?;
    let samples = watcher.samples;
    drop(watcher.keys.take());
    let mut axes = watcher.axes;
    let (ended, shown) = complete(&mut picture, &mut axes);
    bar.finish_and_clear();
    drop(emulators);
    let maxima = axes.maxima();
    Ok((Done { ending, samples, maxima, took, picture, shown, ended, deadline }, interrupt))
}

/// Completes recording and logs, all within a second; those that ended before the run, and other errors of the view.
fn complete(
    picture: &mut Picture<'_>,
    axes: &mut AxisWatch<'_>,
) -> (Vec<Finding>, Result<(), Failure>) {
    axes.close();
    let closed = Clock::start();
    let (mut ended, mut shown) = (Vec::new(), Ok(()));
    match picture.finish() {
        Ok(()) => {}
        Err(VizError::Write { path, ended: by }) => {
            ended.push(recording_ended("recording", &path, &by));
        }
        Err(error) => shown = Err(error.into()),
    }
    ended.extend(axes.finish(closed));
    (ended, shown)
}
