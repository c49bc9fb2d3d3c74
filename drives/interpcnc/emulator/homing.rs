//! Commands 71 and 78: fast to the switch, brake, slowly off it, then the counter is set.
//!
//! Command 78 says everything itself and shows in the extended status, axis by axis. Command 71 takes direction,
//! switch and speeds from parameters and shows in B10 and B11; its strokes are ways, their sign does not count.
//!
//! Beyond the manual: an axis that is on its switch already starts with the slow way off it; arguments without sense
//! fail at once; whatever else stops or moves the axis fails its homing; the way off the switch is at most the stroke.

use std::collections::VecDeque;

use super::{Board, bench::input_bit};
use crate::{
    AxisValues, MoveProfile,
    protocol::{
        parameters,
        registers::{AXES, AxisMask, BoardAxis},
    },
};

/// A homing run of one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Homing {
    pub(super) axis: BoardAxis,
    /// Bit of the switch's input; 0 if there is none.
    pub(super) input: u32,
    /// Level of the input on the switch.
    pub(super) level: bool,
    /// Way to the switch, with sign.
    pub(super) stroke: i32,
    /// Towards the switch; its target does not count.
    pub(super) profile: MoveProfile,
    /// Speed off the switch, steps/s.
    pub(super) slow_hz: u32,
    /// Counter at the end.
    pub(super) last: Option<i32>,
    /// Of command 71.
    pub(super) machine: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Seek,
    Brake,
    Release,
}

/// All homing of the board.
#[derive(Clone, Debug, Default)]
pub(super) struct Homings {
    active: [Option<(Homing, Step)>; AXES],
    /// Axes of command 71 that have to wait for others.
    waiting: VecDeque<Homing>,
    /// Extended B19, B21 …: the last command 78 has failed.
    failed: [bool; AXES],
    /// B11.
    machine_failed: bool,
}

impl Homings {
    /// B10.
    pub(super) fn machine_in_progress(&self) -> bool {
        !self.waiting.is_empty() || self.active.iter().flatten().any(|(homing, _)| homing.machine)
    }

    /// B11.
    pub(super) fn machine_failed(&self) -> bool {
        self.machine_failed
    }

    /// Command 66 b1.
    pub(super) fn clear_failure(&mut self) {
        self.machine_failed = false;
        self.failed = [false; AXES];
    }

    /// Extended B18 to B27.
    pub(super) fn extended_bits(&self) -> u32 {
        let bits = |place: usize, bit: bool| if bit { 1_u32 << place } else { 0 };
        self.active.iter().zip(self.failed).enumerate().fold(0, |all, (axis, (active, failed))| {
            let under_way = active.as_ref().is_some_and(|(homing, _)| !homing.machine);
            all | bits(18 + 2 * axis, under_way) | bits(19 + 2 * axis, failed)
        })
    }

    pub(super) fn any(&self) -> bool {
        self.active.iter().any(Option::is_some) || !self.waiting.is_empty()
    }

    /// Bit of the input of an axis' home switch while it homes.
    pub(super) fn input_of(&self, axis: BoardAxis) -> u32 {
        let active = self.active.get(axis.index()).and_then(Option::as_ref);
        active.map_or(0, |(homing, _)| homing.input)
    }

    fn fail(&mut self, axis: BoardAxis, machine: bool) {
        if machine {
            self.machine_failed = true;
            self.waiting.clear();
        } else if let Some(failed) = self.failed.get_mut(axis.index()) {
            *failed = true;
        }
    }
}

impl Board {
    /// Command 71.
    pub(super) fn home_machine(&mut self, strokes: &AxisValues) {
        // A homing of these axes that is under way ends with this one, which clears B11.
        for (axis, _) in BoardAxis::ALL.into_iter().zip(strokes).filter(|(_, way)| way.is_some()) {
            self.abandon_homing(axis.mask());
        }
        self.homings.machine_failed = false;
        self.homings.waiting.clear();
        let value = |number: u16| self.memory.parameter(number);
        let narrow = |value: u32| u16::try_from(value).unwrap_or(u16::MAX);
        let mut wanted = VecDeque::new();
        for (axis, stroke) in BoardAxis::ALL.into_iter().zip(strokes) {
            let Some(stroke) = stroke.map(i32::saturating_abs) else { continue };
            let rate = narrow(value(parameters::home_acceleration(axis)));
            let profile = MoveProfile {
                start_stop_hz: narrow(value(parameters::HOME_START_STOP)),
                acceleration_khz_per_s: rate,
                speed_hz: value(parameters::home_speed(axis)),
                deceleration_khz_per_s: rate,
                target: 0,
            };
            let closed = value(parameters::HOME_POLARITY) & u32::from(axis.mask().bits()) != 0;
            wanted.push_back(Homing {
                axis,
                input: input_bit(value(parameters::home_input(axis))),
                level: !closed,
                stroke: if value(parameters::home_direction(axis)) == 1 { stroke } else { -stroke },
                profile,
                slow_hz: value(parameters::HOME_SLOW_SPEED),
                last: (value(parameters::ZERO_AFTER_HOMING) == 1).then_some(0),
                machine: true,
            });
        }
        if self.assumptions.home_one_by_one {
            self.homings.waiting = wanted;
        } else {
            for homing in wanted {
                self.start_homing(&homing);
            }
        }
    }

    /// Starts with one axis: command 78, or the turn of an axis in command 71.
    pub(super) fn start_homing(&mut self, homing: &Homing) {
        let axis = homing.axis;
        self.abandon_homing(axis.mask());
        self.abandon_probe(axis);
        if !homing.machine
            && let Some(failed) = self.homings.failed.get_mut(axis.index())
        {
            *failed = false;
        }
        let MoveProfile { acceleration_khz_per_s, speed_hz, deceleration_khz_per_s, .. } =
            homing.profile;
        let sense = homing.input != 0
            && homing.stroke != 0
            && speed_hz != 0
            && homing.slow_hz != 0
            && acceleration_khz_per_s != 0
            && deceleration_khz_per_s != 0;
        let now = self.now_ns;
        let from = self.axes.get(axis.index()).map_or(0, |axis| axis.counter(now));
        let Some(target) = from.checked_add(homing.stroke).filter(|_| sense) else {
            self.homings.fail(axis, homing.machine);
            return;
        };
        let step = if self.is_on(homing) {
            self.for_axes(axis.mask(), |axis| axis.ramp_stop(now));
            Step::Brake
        } else {
            let profile = MoveProfile { target, ..homing.profile };
            self.for_axes(axis.mask(), |axis| axis.start(now, &profile));
            Step::Seek
        };
        if let Some(active) = self.homings.active.get_mut(axis.index()) {
            *active = Some((*homing, step));
        }
    }

    fn is_on(&self, homing: &Homing) -> bool {
        (self.memory.inputs & homing.input != 0) == homing.level
    }

    /// Something else stops or moves these axes: their homing has failed.
    pub(super) fn abandon_homing(&mut self, axes: AxisMask) {
        for axis in axes.axes() {
            let active = self.homings.active.get_mut(axis.index()).and_then(Option::take);
            if let Some((homing, _)) = active {
                self.homings.fail(axis, homing.machine);
            }
        }
        if axes == AxisMask::ALL && !self.homings.waiting.is_empty() {
            self.homings.waiting.clear();
            self.homings.machine_failed = true;
        }
    }

    /// Goes on with every homing whose axis has come to where something changes; true if something happened.
    pub(super) fn step_homing(&mut self) -> bool {
        let mut changed = false;
        for axis in BoardAxis::ALL {
            let active = self.homings.active.get(axis.index()).copied().flatten();
            if let Some((homing, step)) = active {
                changed |= self.step_axis_homing(&homing, step);
            }
        }
        let busy = self.homings.active.iter().flatten().any(|(homing, _)| homing.machine);
        if !busy && let Some(next) = self.homings.waiting.pop_front() {
            self.start_homing(&next);
            changed = true;
        }
        changed
    }

    fn step_axis_homing(&mut self, homing: &Homing, step: Step) -> bool {
        let now = self.now_ns;
        let (axis, on) = (homing.axis, self.is_on(homing));
        let Some(state) = self.axes.get(axis.index()).copied() else { return false };
        let moving = state.moving(now);
        let next = match step {
            Step::Seek if on => {
                self.for_axes(axis.mask(), |axis| axis.ramp_stop(now));
                Some(Step::Brake)
            }
            Step::Brake if !moving => {
                let slow_hz = u16::try_from(homing.slow_hz).unwrap_or(u16::MAX);
                let target = state.counter(now).saturating_sub(homing.stroke);
                // The slow way has no ramp.
                let speed_hz = homing.slow_hz;
                let profile =
                    MoveProfile { target, start_stop_hz: slow_hz, speed_hz, ..homing.profile };
                self.for_axes(axis.mask(), |axis| axis.start(now, &profile));
                Some(Step::Release)
            }
            Step::Release if !on => {
                self.for_axes(axis.mask(), |axis| axis.stop(now));
                if let Some(counter) = homing.last {
                    self.for_axes(axis.mask(), |axis| axis.write_counter(now, counter));
                }
                None
            }
            Step::Seek | Step::Release if !moving => {
                self.homings.fail(axis, homing.machine);
                None
            }
            _ => return false,
        };
        if let Some(active) = self.homings.active.get_mut(axis.index()) {
            *active = next.map(|step| (*homing, step));
        }
        true
    }
}
