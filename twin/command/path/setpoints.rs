//! Interpolator set-points per cycle, with inputs that change on the way (manual 6.2.9, 6.6).

use super::output::stdio;
use super::{Job, jsonl};
use crate::command::Failure;
use crate::command::options::InputOptions;
use crate::command::options::unreadable;
use crate::finding::{Finding, Rule, Severity};
use crate::m_function::Acknowledgement;
use crate::program::ProgramItem;
use crate::program::inputs::{InputAt, InputChange, Workpiece};
use std::io::Write;
use std::num::NonZeroUsize;
use std::task::Poll;
use twin_path::prepare::CheckError;
use twin_path::{PathElement, Place};
use twin_planner::controller::{
    DEFAULT_CYCLE_NS, Inputs, IpoError, Override, ToolSetpoint, TwoWayInterpolator, TwoWayPath,
    XAmbiguity, XInterpolator,
};

/// A path that nothing moves any more is not followed for longer than this, ns.
const PATIENCE_NS: i64 = 10_000_000_000;

/// Elements that a path for both ways may have.
const CAPACITY: usize = 1_000_000;

/// What happens on the way.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Set-points (--format setpoints)")]
pub(super) struct SetpointOptions {
    #[command(flatten)]
    inputs: InputOptions,

    /// Forwards and backwards (`SMC_Interpolator2Dir`): an override below 0 leads back
    #[arg(long, conflicts_with = "by_position")]
    both_ways: bool,
}

/// The inputs as the events leave them.
struct Schedule {
    events: std::vec::IntoIter<InputAt>,
    inputs: Inputs,
    /// With its sign.
    factor: f64,
}

impl Schedule {
    fn new(options: &SetpointOptions, inputs: Inputs) -> Self {
        let mut events = options.inputs.changes.clone();
        events.sort_by_key(|event| event.time_ns);
        Self { events: events.into_iter(), factor: inputs.override_factor.factor(), inputs }
    }

    /// Brings the inputs to `now_ns`.
    fn advance(&mut self, now_ns: i64) -> Result<(), IpoError> {
        while let Some(event) = self.events.as_slice().first().filter(|e| e.time_ns <= now_ns) {
            match event.change {
                InputChange::Override(factor) => {
                    self.factor = factor;
                    // Backwards, and less than the least, only the interpolator for both ways understands.
                    self.inputs.override_factor = Override::new(factor.abs())?;
                }
                change => change.apply(&mut self.inputs)?,
            }
            self.events.next();
        }
        Ok(())
    }

    fn is_over(&self) -> bool {
        self.events.as_slice().is_empty()
    }
}

/// Writes the set-points of the path.
pub(super) fn write(
    job: &mut Job<'_>,
    options: &SetpointOptions,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    if let Some(workpiece) = options.inputs.workpiece()? {
        return by_position(job, &workpiece, out);
    }
    let schedule = Schedule::new(options, job.program.settings().inputs);
    if options.both_ways {
        both_ways(job, schedule, out)
    } else {
        let back = |event: &InputAt| matches!(event.change, InputChange::Override(f) if f < Override::LEAST);
        if options.inputs.changes.iter().any(back) {
            let message = "an override below 0.01 is for --both-ways";
            return Err(Failure::Usage(message.to_owned()));
        }
        forwards(job, schedule, out)
    }
}

fn forwards(job: &mut Job<'_>, mut schedule: Schedule, out: &mut dyn Write) -> Result<(), Failure> {
    let failed = |source| unreadable(job.program.path(), source);
    let setpoints = job.program.setpoints(job.conditions, None, Acknowledgement::default());
    let mut setpoints = setpoints.map_err(failed)?;
    let mut rest = Rest::default();
    loop {
        schedule.advance(rest.next_ns).map_err(usage)?;
        setpoints.set_inputs(schedule.inputs);
        match setpoints.next() {
            Some(ProgramItem::Setpoint(setpoint)) => {
                jsonl::write_setpoint(out, &setpoint).map_err(stdio)?;
                if rest.has_lasted(&setpoint) && schedule.is_over() {
                    stderr!("the path stays at rest: no event of --at starts it again");
                    break;
                }
            }
            Some(ProgramItem::Diagnostic(finding)) => job.findings.push(finding),
            Some(ProgramItem::Io(source)) => return Err(failed(source)),
            None => break,
        }
    }
    job.elements = setpoints.elements();
    job.left_out = setpoints.left_out();
    Ok(())
}

fn both_ways(
    job: &mut Job<'_>,
    mut schedule: Schedule,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let elements = collected(job)?;
    let elements = elements.into_iter().map(Ok::<_, Trouble>);
    let capacity = NonZeroUsize::new(CAPACITY).unwrap_or(NonZeroUsize::MIN);
    let path = TwoWayPath::new(elements, job.conditions.angle_tolerance, capacity);
    let path = path.map_err(|error| Failure::Usage(error.to_string()))?;
    let mut interpolator = TwoWayInterpolator::new(path, DEFAULT_CYCLE_NS);
    let mut rest = Rest::default();
    loop {
        // Whatever its sign and size, the interpolator understands it.
        schedule.advance(rest.next_ns).unwrap_or_default();
        let Some(setpoint) = interpolator.cycle(&schedule.inputs, schedule.factor) else { break };
        jsonl::write_setpoint(out, &setpoint).map_err(stdio)?;
        let over = interpolator.end_of_path() || rest.has_lasted(&setpoint);
        rest.next_ns = setpoint.time_ns + i64::from(DEFAULT_CYCLE_NS.get());
        if over && schedule.is_over() {
            break;
        }
    }
    Ok(())
}

fn by_position(
    job: &mut Job<'_>,
    workpiece: &Workpiece,
    out: &mut dyn Write,
) -> Result<(), Failure> {
    let elements = collected(job)?;
    let Workpiece { positions, offset, direction } = workpiece;
    for element in &elements {
        let ambiguity = XAmbiguity::of(element, *direction);
        job.findings.extend(ambiguity.map(|ambiguity| ambiguous(element.place, ambiguity)));
    }
    let elements = elements.into_iter().map(Ok::<_, Trouble>);
    let mut interpolator = XInterpolator::new(elements, DEFAULT_CYCLE_NS, *direction, *offset);
    for position in positions.iter() {
        match interpolator.poll_cycle(*position, false) {
            Poll::Ready(Some(Ok(setpoint))) => {
                jsonl::write_setpoint(out, &setpoint).map_err(stdio)?;
            }
            Poll::Ready(Some(Err(error))) => return Err(Failure::Usage(error.to_string())),
            Poll::Ready(None) | Poll::Pending => break,
        }
    }
    Ok(())
}

/// A place at which the set-point jumps.
fn ambiguous(place: Place, ambiguity: XAmbiguity) -> Finding {
    let message = match ambiguity {
        XAmbiguity::Back(way) => format!(
            "X goes back by {:.3} mm here: the path has more than one point for these X, and the set-point jumps",
            way * 1e3
        ),
        XAmbiguity::Step(way) => format!(
            "X stays here while the path goes on by {:.3} mm, so that the set-point jumps; let X change a little",
            way * 1e3
        ),
        XAmbiguity::Jump(way) => {
            format!(
                "G92 sets the position anew here, and the set-point jumps by {:.3} mm",
                way * 1e3
            )
        }
    };
    let finding = Finding::error(Rule::AmbiguousPosition, place, message);
    Finding { severity: Severity::Warning, ..finding }
}

/// The path as a whole.
fn collected(job: &mut Job<'_>) -> Result<Vec<PathElement>, Failure> {
    let mut elements = Vec::new();
    job.each(|element| {
        elements.push(element);
        Ok(())
    })?;
    Ok(elements)
}

/// How long the path has rested.
#[derive(Default)]
struct Rest {
    since_ns: i64,
    next_ns: i64,
}

impl Rest {
    fn has_lasted(&mut self, setpoint: &ToolSetpoint) -> bool {
        self.next_ns = setpoint.time_ns + i64::from(DEFAULT_CYCLE_NS.get());
        if setpoint.path_velocity > 0.0 {
            self.since_ns = setpoint.time_ns;
        }
        setpoint.time_ns - self.since_ns > PATIENCE_NS
    }
}

/// What keeps a path from being gone both ways, or by position.
#[derive(Debug, thiserror::Error)]
enum Trouble {
    #[error(transparent)]
    Check(#[from] CheckError),
    #[error(transparent)]
    Ipo(#[from] IpoError),
}

fn usage(error: IpoError) -> Failure {
    Failure::Usage(error.to_string())
}
