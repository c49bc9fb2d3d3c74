//! Command 6: interpolated moves that wait in a buffer and are carried out one after the other.
//!
//! The speed is that of the axis with the longest way; the others go in proportion. Every segment starts and ends at
//! the start frequency (parameter 5) and ramps with the default acceleration (parameter 4): segments do not blend
//! (published sources: "Absolute move with accel and decel ramp").

use std::collections::VecDeque;

use super::{Board, rtu::Refusal};
use crate::{
    AxisValues,
    protocol::registers::{AXES, AxisMask, BoardAxis, MAX_SPEED_HZ},
};
use twin_drives::ramp::Ramp;

/// A segment that waits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) speed_hz: u32,
    pub(super) targets: AxisValues,
}

impl Segment {
    fn axes(&self) -> AxisMask {
        let named = BoardAxis::ALL.into_iter().zip(&self.targets);
        let chosen = named.filter(|(_, target)| target.is_some());
        chosen.fold(AxisMask::NONE, |mask, (axis, _)| mask.union(axis.mask()))
    }
}

/// The command buffer.
#[derive(Clone, Debug, Default)]
pub(super) struct Buffer {
    waiting: VecDeque<Segment>,
    /// A segment is being carried out.
    busy: bool,
    /// The first segment waits for an axis that moves independently.
    held: bool,
}

impl Buffer {
    /// B5: nothing waits.
    pub(super) fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Nothing waits and nothing is carried out.
    pub(super) fn is_idle(&self) -> bool {
        self.waiting.is_empty() && !self.busy
    }

    /// B6, as far as the board brings it about.
    pub(super) fn is_held(&self) -> bool {
        self.held
    }

    /// The last target of an axis that waits.
    pub(super) fn last_target(&self, axis: BoardAxis) -> Option<i32> {
        let mut latest = self.waiting.iter().rev();
        latest.find_map(|segment| segment.targets.get(axis.index()).copied().flatten())
    }

    pub(super) fn clear(&mut self) {
        self.waiting.clear();
        self.held = false;
    }
}

/// What makes of ways, one per axis, an interpolated move: the ramp of each axis that moves.
pub(crate) fn segment_ramps(
    from: [f64; AXES],
    targets: &AxisValues,
    speed_hz: u32,
    start_stop: f64,
    rate: f64,
) -> [Option<Ramp>; AXES] {
    let mut ways = [0.0; AXES];
    for ((way, target), from) in ways.iter_mut().zip(targets).zip(from) {
        *way = target.map_or(0.0, |target| f64::from(target) - from);
    }
    let longest = ways.iter().fold(0.0_f64, |longest, way| longest.max(way.abs()));
    let speed = f64::from(speed_hz.min(MAX_SPEED_HZ));
    let mut ramps = [None; AXES];
    for ((ramp, way), target) in ramps.iter_mut().zip(ways).zip(targets) {
        let part = way.abs() / longest;
        let Some(target) = target.filter(|_| part > 0.0) else { continue };
        *ramp = Some(Ramp {
            start_stop: start_stop * part,
            acceleration: rate * part,
            speed: speed * part,
            deceleration: rate * part,
            target: f64::from(target),
        });
    }
    ramps
}

impl Board {
    /// Segments that wait in the buffer; the one that is carried out is not in it.
    pub fn waiting_segments(&self) -> usize {
        self.buffer.waiting.len()
    }

    /// Takes a segment into the buffer.
    pub(super) fn queue_segment(&mut self, segment: Segment) -> Result<(), Refusal> {
        if segment.speed_hz == 0 {
            return Err(Refusal::Value);
        }
        if self.buffer.waiting.len() >= usize::from(self.assumptions.buffer_segments) {
            return Err(Refusal::Failure);
        }
        self.buffer.waiting.push_back(segment);
        Ok(())
    }

    /// Goes on to the next segment where the one before has ended; true if something happened.
    pub(super) fn step_buffer(&mut self) -> bool {
        let now = self.now_ns;
        if self.buffer.busy {
            if self.axes.iter().any(|axis| axis.interpolating(now)) {
                return false;
            }
            self.buffer.busy = false;
            return true;
        }
        let Some(segment) = self.buffer.waiting.front().copied() else {
            self.buffer.held = false;
            return false;
        };
        let moving = AxisMask::from_bits(self.axis_bits(|axis| axis.moving(now)));
        self.buffer.held = !segment.axes().intersection(moving).is_empty();
        if self.buffer.held || self.is_frozen() || self.locked {
            return false;
        }
        self.buffer.waiting.pop_front();
        let start_stop =
            f64::from(self.memory.parameter(self.assumptions.segment_start_stop).max(1));
        let rate =
            1e3 * f64::from(self.memory.parameter(self.assumptions.segment_acceleration).max(1));
        let from = self.axes.each_ref().map(|axis| axis.state(now).position);
        let ramps = segment_ramps(from, &segment.targets, segment.speed_hz, start_stop, rate);
        for (axis, ramp) in BoardAxis::ALL.into_iter().zip(ramps) {
            if let Some(ramp) = ramp {
                self.for_axes(axis.mask(), |axis| axis.start_segment(now, &ramp));
                self.buffer.busy = true;
            }
        }
        true
    }
}
