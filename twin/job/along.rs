//! Axes that follow a program in a job, and a virtual axis that goes with its path length (`SMC_Interpolator` with `dWayPos`,
//! manual 6.2.9): the master of cams over the path.
//!
//! The manual wires it so: the interpolator gives set-points and `dWayPos`, transform and axes take the set-points, and a
//! virtual axis takes the way. Any axis may then follow that axis on a cam.

use super::block::{Called, With};
use crate::finding::Severity;
use crate::m_function::{Acknowledge, Acknowledgement};
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile, ProgramItem};
use crate::setpoint::Transformer;
use std::path::Path;
use std::sync::Arc;
use twin_axis::{Axis, Block, Follow, Outputs};
use twin_machine::Machine;
use twin_number::seconds;

/// Longest program, in set-points: an hour of milliseconds. A job holds all of them.
const MOST_SETPOINTS: usize = 3_600_000;

/// Least motion of an axis in a program that moves it, m or rad.
const UNMOVED: f64 = 1e-9;

/// Positions and velocities in every cycle, in the unit of the axis.
type Track = Arc<[[f64; 2]]>;

/// The motion of a program.
#[derive(Debug)]
pub(super) struct Motion {
    /// Path length, mm.
    pub(super) way: Track,
    /// Axes of the machine that it moves, by their numbers.
    pub(super) axes: Vec<(usize, Track)>,
}

impl Motion {
    /// The motion of the program at `path` on `machine`, as the controller plans it.
    ///
    /// # Errors
    /// In words, if it cannot be read or is not fit.
    pub(super) fn of(machine: &Machine, path: &Path) -> Result<Self, String> {
        let about = |what: &dyn std::fmt::Display| format!("{}: {what}", path.display());
        let dialect = Dialect::guess(path).map_err(|error| about(&error))?;
        if dialect == Some(Dialect::Job) {
            return Err(about(&"it is a job; a path is needed"));
        }
        let program = ProgramFile::new(path, dialect, ReadSettings::default())
            .map_err(|error| error.to_string())?;
        let rules = Acknowledgement::for_check(machine, Acknowledge::Auto);
        let setpoints = program.open(machine, rules).map_err(|error| about(&error))?;
        let mut transformer = Transformer::new(machine);
        let mut way = Vec::new();
        let mut axes: Vec<Vec<[f64; 2]>> = vec![Vec::new(); machine.axes.len()];
        for item in setpoints {
            let tool = match item {
                ProgramItem::Setpoint(tool) => tool,
                ProgramItem::Diagnostic(finding) if finding.severity == Severity::Error => {
                    return Err(about(&format_args!("line {}: {}", finding.line, finding.message)));
                }
                ProgramItem::Diagnostic(_) => continue,
                ProgramItem::Io(error) => return Err(about(&error)),
            };
            if way.len() >= MOST_SETPOINTS {
                let hours = "it takes more than an hour, which is the limit in a job";
                return Err(about(&hours));
            }
            let setpoint = transformer.axes(&tool, None);
            let setpoint =
                setpoint.map_err(|error| about(&format_args!("{}: {error}", tool.place)))?;
            way.push([tool.way * 1e3, tool.path_velocity * 1e3]);
            let motion = setpoint.axes.position.iter().zip(setpoint.axes.velocity.iter());
            for ((track, axis), (position, velocity)) in
                axes.iter_mut().zip(&machine.axes).zip(motion)
            {
                track.push([axis.from_si(*position), axis.from_si(*velocity)]);
            }
        }
        if way.is_empty() {
            return Err(about(&"nothing of it moves"));
        }
        let slave = |index| machine.couplings.iter().any(|coupling| coupling.axis == index);
        let moved = machine.axes.iter().zip(axes).enumerate().filter(|(index, (axis, track))| {
            let first = track.first().map_or(0.0, |[position, _]| *position);
            let least = axis.from_si(UNMOVED);
            !slave(*index) && track.iter().any(|[position, _]| (position - first).abs() > least)
        });
        let axes = moved.map(|(index, (_, track))| (index, Track::from(track))).collect();
        Ok(Self { way: way.into(), axes })
    }
}

/// Follows a track, a place a cycle.
#[derive(Debug)]
struct Along {
    block: Block<Follow>,
    track: Track,
    next: usize,
    cycle: f64,
}

impl Called for Along {
    fn call(&mut self, execute: bool, axis: &mut Axis, _with: With<'_>) -> Outputs {
        let last = self.track.len().saturating_sub(1);
        let Some([position, velocity]) = self.track.get(self.next.min(last)).copied() else {
            return Outputs::default();
        };
        let ended = self.next >= last;
        self.next += 1;
        self.block.inputs = Follow::PositionVelocity(position, velocity);
        let shown = self.block.call(execute, axis);
        // The block itself has no end: it is done at the end of the program.
        Outputs { done: shown.busy && ended, ..shown }
    }

    fn lasts(&self) -> Option<f64> {
        // No track is longer than an hour.
        u32::try_from(self.track.len()).ok().map(|count| f64::from(count) * self.cycle)
    }
}

/// A block that has its axis follow `track`.
pub(super) fn along(track: &Track, machine: &Machine) -> Box<dyn Called> {
    let [position, velocity] = track.first().copied().unwrap_or_default();
    Box::new(Along {
        block: Block::new(Follow::PositionVelocity(position, velocity)),
        track: Arc::clone(track),
        next: 0,
        cycle: seconds(machine.cycle_ns),
    })
}
