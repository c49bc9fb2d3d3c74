//! Probing (G38.2 to G38.5): the probing move, and the surroundings that a probe can touch.

use super::block::{Block, Letter};
use super::error::{DecodeError, Problem};
use super::options::Position;
use super::output::Output;
use super::state::State;
use super::tool_table::ToolTable;
use super::word::FeedMode;
use std::fmt;
use std::sync::Arc;
use twin_path::Place;
use twin_path::{ElementKind, MParameters, ProbeOutcome, ProbeTrip, Probing};

/// A probing move as it is programmed: straight from `start` to `end`, all axes in step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbePath {
    /// The block it comes from.
    pub place: Place,
    /// Start, in the frame of the path, of the point whose path it is ([`super::DecoderOptions::reference`]).
    pub start: Position,
    /// End unless the probe trips.
    pub end: Position,
    /// From the tip of the tool in force (G43) to the point whose path it is, m: what to take off both positions for
    /// those of the tip.
    pub point_from_tip: [f64; 3],
    /// Number of the tool in the spindle, 0 = none.
    pub tool: u32,
    /// Velocity along the path, m/s, or a thousandth of degrees/s where only rotary axes move.
    pub feed: f64,
    /// Trip that ends it.
    pub trips: ProbeTrip,
}

/// Target of a probe: the knowledge of the tool's surroundings.
///
/// The questions come in the order of the program, one for each probing move that is carried out. Where a move trips
/// the path ends, and the next one begins there, to within rounding: touching after [`ProbeTrip::Touch`], free after
/// [`ProbeTrip::Release`]. A target must not make something else of that rounding.
pub trait ProbeTarget: fmt::Debug {
    /// Place where the probe trips, as a part of the way from the start (0) to the end (1): 0 if it is at the start
    /// already as the move wants it. None, or a number outside that range, if it does not trip.
    fn trip(&mut self, path: &ProbePath) -> Option<f64>;
}

/// Surroundings of the tool, for every decoder that reads the program: each asks a [`ProbeTarget`] of its own, so that
/// all of them get the same answers.
#[derive(Clone)]
pub struct Surroundings(Arc<Maker>);

/// Makes the target of a program with these tools.
type Maker = dyn Fn(&ToolTable) -> Box<dyn ProbeTarget> + Send + Sync;

impl Surroundings {
    /// Those that the targets of `make` know, as they are at the beginning of a program with these tools.
    pub fn new<T: ProbeTarget + 'static>(
        make: impl Fn(&ToolTable) -> T + Send + Sync + 'static,
    ) -> Self {
        Self(Arc::new(move |tools| Box::new(make(tools))))
    }

    /// A target as it is at the beginning of a program with `tools`.
    pub fn target(&self, tools: &ToolTable) -> Box<dyn ProbeTarget> {
        (self.0)(tools)
    }
}

impl fmt::Debug for Surroundings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // To look around only for this would be too much.
        f.debug_struct("Surroundings").finish_non_exhaustive()
    }
}

/// Clones are equal; others may be whatever they are.
impl PartialEq for Surroundings {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl State {
    /// G38.2 to G38.5.
    ///
    /// # Errors
    /// Besides those of other moves, what `probing` does not allow. The tool is where the error leaves it then.
    #[expect(clippy::float_cmp, reason = "the same number or another one")]
    pub(super) fn probe(
        &mut self,
        probing: Probing,
        block: &Block,
        out: &mut Output,
    ) -> Result<(), Problem> {
        let mut from = self.location;
        from.machine = self.tool_position();
        let mut to = self.target(block, self.relative)?;
        if self.feed_mode == FeedMode::PerRevolution {
            self.location = to;
            return Err(DecodeError::ProbePerRevolution.into());
        }
        let stays = from.program == to.program;
        let shape = self.line_to(&to);
        let Some(feed) = self.feed_for(&shape, &to, block.get(Letter::F))? else { return Ok(()) };
        if probing.required && stays {
            return Err(DecodeError::ProbeNowhere(probing).into());
        }
        let Some(target) = &mut self.probe_target else {
            out.warning(None, DecodeError::ProbeUnknown(probing));
            let kind = ElementKind::Probe { probing, outcome: ProbeOutcome::Unknown };
            self.go(kind, shape, feed, to, out);
            self.keep_result(ProbeOutcome::Unknown);
            self.settle(out);
            return Ok(());
        };
        let path = ProbePath {
            place: out.place,
            start: from.machine,
            end: to.machine,
            point_from_tip: self.offsets.point_from_tip(),
            tool: self.tool,
            feed,
            trips: probing.trips,
        };
        let part = target.trip(&path).filter(|part| *part <= 1.0);
        let (shape, outcome) = match part {
            Some(part) if part <= 0.0 && probing.required => {
                return Err(DecodeError::ProbeTripped(probing).into());
            }
            Some(part) => {
                to = from.toward(&to, part, &self.offsets, self.units);
                (self.line_to(&to), ProbeOutcome::Tripped)
            }
            None => (shape, ProbeOutcome::NotTripped),
        };
        self.go(ElementKind::Probe { probing, outcome }, shape, feed, to, out);
        self.keep_result(outcome);
        if probing.required && outcome == ProbeOutcome::NotTripped {
            return Err(DecodeError::ProbeNotTripped(probing).into());
        }
        self.settle(out);
        Ok(())
    }

    /// Sets #5061 to #5070. An unknown outcome counts as a trip: programs stop at others.
    fn keep_result(&mut self, outcome: ProbeOutcome) {
        for (number, value) in (5061..).zip(self.location.program) {
            self.parameters.set(number, value);
        }
        let tripped = outcome != ProbeOutcome::NotTripped;
        self.parameters.set(5070, if tripped { 1.0 } else { 0.0 });
    }

    /// Waits for drives that are on their way to where the probing move has ended.
    fn settle(&mut self, out: &mut Output) {
        if self.probe_settle_ns > 0 {
            let kind = ElementKind::Dwell { time_ns: self.probe_settle_ns };
            self.stand(kind, MParameters::default(), out);
        }
    }
}
