//! The motion of one axis as the module makes it: a state machine of time and orders.
//!
//! It is pure and deterministic. What happens between two calls (a cam reached, a limit, the end of a ramp) happens
//! at the nanosecond at which the profile gets there, whenever it is asked. An axis never has more than one order:
//! it has no queue and no change of target on the way, so every leg starts from rest and goes in one direction.
//!
//! Positions are µsteps of the counter ("position théorique"). The shaft of the motor has whole µsteps of its own,
//! which the switches of the [`Bench`] see: shaft = offset ± counter; zeroing the counter changes the offset, not the
//! shaft.
//!
//! Source: manual rev. D, chapters 5 to 7. Where it is silent the axis behaves by its [`Assumptions`]. Beyond those: A soft limit or an end switch with ramp is overrun by the ramp. An order for a target
//! beyond ±4194303, for the forbidden preset, or to zero and to force at once, is refused with message bit 14.
//! Distances of parameters are µsteps of the drive mode. A full turn of the encoder brings one index.

mod bench;
mod encoder;
mod events;
mod legs;
mod orders;
#[cfg(test)]
mod tests;

pub use bench::{Bench, Contact};
pub(crate) use encoder::Encoder;
pub use encoder::{EncoderBench, EncoderKind};
pub(crate) use orders::AxisOrder;

use crate::{
    Assumptions, AxisSettings, Corrections,
    protocol::bits::{coefficient, message, uc},
};
use twin_drives::ramp::{Motion, State};

/// What the motion under way is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    Rest,
    Homing(Homing),
    Programmed(Programmed),
    Manual,
    ToSwitch,
}

/// Where homing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Homing {
    /// Against the direction of homing, off the cam.
    Leaving,
    /// The same direction, on by the hysteresis.
    Clearing,
    /// In the direction of homing, over the cam to its other edge.
    Crossing,
    /// In the direction of homing, to the edge of the cam (or the index of the encoder).
    Seeking,
    /// On by the "arrêt origine".
    Stopping,
}

/// A programmed move: where it ends and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Programmed {
    target: i32,
    speed: u16,
    /// Reference position it goes to, or 0.
    reference: u32,
    /// The leg under way overshoots; another returns to the target.
    overshooting: bool,
    /// Corrections made after what the encoder showed.
    corrections: u8,
}

/// One axis at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    now_ns: i64,
    settings: AxisSettings,
    bench: Bench,
    encoder: Encoder,
    motion: Motion,
    task: Task,
    /// The leg under way has been cut short: it brakes to rest and nothing follows.
    braking: bool,
    /// Sense of the leg under way in counter coordinates, ±1.
    sense: i64,
    /// Shaft when the counter is 0.
    offset: i64,
    /// Position of a stalled shaft.
    held: Option<i64>,
    /// Axis messages that stay until something clears them.
    latched: u16,
    /// The last programmed move needed a correction.
    corrected: bool,
    ack_uc: u16,
    ack_bloc: u32,
    /// Programmed moves to come that are acknowledged and not carried out.
    ignored_moves: u32,
    /// "Dernière cote mémorisée": the counter at the end of the last move.
    stored: i32,
    /// Ends of moves so far.
    ends: u64,
    assumptions: Assumptions,
    corrections: Corrections,
}

impl Axis {
    /// An axis at power-up or after RESET: phases off, homing not done; its shaft is at `shaft`, its counter
    /// shows `position` and `stored` was stored last.
    pub(crate) fn power_up(
        now_ns: i64,
        settings: &AxisSettings,
        bench: &Bench,
        shaft: i64,
        position: i32,
        stored: i32,
    ) -> Self {
        let mut axis = Self {
            now_ns,
            settings: *settings,
            bench: *bench,
            encoder: Encoder::default(),
            motion: Motion::at_rest(f64::from(position)),
            task: Task::Rest,
            braking: false,
            sense: 1,
            offset: 0,
            held: None,
            latched: message::PHASES_OFF,
            corrected: false,
            ack_uc: 0,
            ack_bloc: 0,
            ignored_moves: 0,
            stored,
            ends: 0,
            assumptions: Assumptions::default(),
            corrections: Corrections::default(),
        };
        axis.offset = shaft - axis.direction() * i64::from(position);
        if bench.stalled {
            axis.held = Some(shaft);
        }
        axis
    }

    /// Homing counts as done.
    pub(crate) fn set_homed(&mut self) {
        self.latch(message::HOMED, true);
    }

    /// Has it behave otherwise where the manual says nothing.
    pub(crate) fn set_assumptions(&mut self, assumptions: Assumptions) {
        self.assumptions = assumptions;
    }

    /// Has it correct its moves otherwise.
    pub(crate) fn set_corrections(&mut self, corrections: Corrections) {
        self.corrections = corrections;
    }

    /// Lets time pass up to `time_ns`, never backwards.
    pub(crate) fn advance(&mut self, time_ns: i64) {
        while let Some((at_ns, event)) = self.next_event() {
            if at_ns > time_ns {
                break;
            }
            self.now_ns = self.now_ns.max(at_ns);
            self.happen(event);
        }
        self.now_ns = self.now_ns.max(time_ns);
    }

    /// The time, ns.
    #[cfg(test)]
    pub(crate) fn now_ns(&self) -> i64 {
        self.now_ns
    }

    /// Position and velocity between the µsteps, µsteps and µsteps/s.
    pub(crate) fn state(&self) -> State {
        self.motion.at(self.now_ns)
    }

    /// "Position théorique", µsteps.
    pub(crate) fn counter(&self) -> i32 {
        saturated(self.count(self.now_ns))
    }

    /// True while an order is being carried out.
    pub(crate) fn moving(&self) -> bool {
        self.task != Task::Rest
    }

    /// "Acquittement ordre UC".
    pub(crate) fn ack_uc(&self) -> u16 {
        self.ack_uc
    }

    /// "Acquittement ordre bloc".
    pub(crate) fn ack_bloc(&self) -> u32 {
        self.ack_bloc
    }

    /// "Messages axe".
    pub(crate) fn messages(&self) -> u16 {
        let counter = self.count(self.now_ns);
        let homed = self.is(message::HOMED);
        let bits = [
            (message::PLUS_SWITCH, self.on_switch(1)),
            (message::MINUS_SWITCH, self.on_switch(-1)),
            (message::PLUS_LIMIT, homed && counter >= self.settings.soft_plus.into()),
            (message::MINUS_LIMIT, homed && counter <= self.settings.soft_minus.into()),
            (message::MOVING, self.moving()),
            (message::POWER_ABSENT, !self.bench.power),
            (message::ON_CAM, self.on_cam()),
        ];
        let seen = bits.into_iter().filter(|(_, set)| *set);
        seen.fold(self.latched, |word, (bit, _)| word | bit)
    }

    /// True if one of these latched messages is there.
    fn is(&self, bits: u16) -> bool {
        self.latched & bits != 0
    }

    /// Latches messages or clears them.
    fn latch(&mut self, bits: u16, set: bool) {
        self.latched = if set { self.latched | bits } else { self.latched & !bits };
    }

    /// True if the last programmed move needed a correction.
    pub(crate) fn corrected(&self) -> bool {
        self.corrected
    }

    /// "Dernière cote mémorisée".
    pub(crate) fn stored(&self) -> i32 {
        self.stored
    }

    /// Ends of moves so far; the module stores positions then.
    pub(crate) fn ends(&self) -> u64 {
        self.ends
    }

    /// The whole µstep at which the shaft is.
    pub(crate) fn shaft(&self) -> i64 {
        self.shaft_at(self.now_ns)
    }

    /// The encoder.
    pub(crate) fn encoder(&self) -> &Encoder {
        &self.encoder
    }

    /// The encoder, to be changed.
    pub(crate) fn encoder_mut(&mut self) -> &mut Encoder {
        &mut self.encoder
    }

    /// The settings that hold.
    pub(crate) fn settings(&self) -> &AxisSettings {
        &self.settings
    }

    /// Puts parameters into force that need no RESET.
    pub(crate) fn set_settings(&mut self, settings: &AxisSettings) {
        self.settings = *settings;
    }

    /// What is mounted around it.
    pub(crate) fn bench(&self) -> &Bench {
        &self.bench
    }

    /// Changes what is mounted around it: a switch pressed by hand, a fault. Power lost in motion is a hard stop
    /// (7.8); homing is lost with it (7.3).
    pub(crate) fn set_bench(&mut self, bench: &Bench) {
        let shaft = self.shaft();
        self.bench = *bench;
        if bench.stalled {
            self.held = Some(self.held.unwrap_or(shaft));
        } else if let Some(held) = self.held.take() {
            // The motor takes hold of the shaft where that is.
            self.offset = held - self.direction() * self.count(self.now_ns);
        }
        if !bench.power {
            if self.moving() {
                self.stop_hard();
            }
            self.latch(message::HOMED, false);
        }
    }

    /// Phases on, by writing the holding current (7.6).
    pub(crate) fn energise(&mut self) {
        self.latch(message::PHASES_OFF, false);
        if self.ack_uc == uc::PHASES_OFF {
            self.ack_uc = 0;
        }
    }

    /// Declares the present position to be `position`; the axis rests.
    fn declare(&mut self, position: i32) {
        let shaft = self.shaft();
        self.motion = Motion::at_rest(f64::from(position));
        self.offset = shaft - self.direction() * i64::from(position);
    }

    /// Counter at an instant, whole µsteps.
    fn count(&self, time_ns: i64) -> i64 {
        whole(self.motion.at(time_ns).position)
    }

    fn shaft_at(&self, time_ns: i64) -> i64 {
        self.held.unwrap_or_else(|| self.offset + self.direction() * self.count(time_ns))
    }

    /// Sense of the shaft where the counter counts up.
    fn direction(&self) -> i64 {
        if self.settings.has(coefficient::REVERSE) { -1 } else { 1 }
    }

    /// The contact on the input that counts as the end switch in the sense `sense` of the counter.
    fn switch(&self, sense: i64) -> Option<Contact> {
        let swapped = self.settings.has(coefficient::SWAP_SWITCHES);
        if (sense > 0) == swapped { self.bench.minus } else { self.bench.plus }
    }

    /// True on the end switch in the sense `sense`.
    fn on_switch(&self, sense: i64) -> bool {
        let closes = self.settings.has(coefficient::SWITCHES_CLOSE);
        !self.settings.has(coefficient::IGNORE_SWITCHES)
            && self.closed(self.switch(sense)) == closes
    }

    fn on_cam(&self) -> bool {
        self.closed(self.bench.cam) == self.settings.has(coefficient::CAM_CLOSES)
    }

    fn closed(&self, contact: Option<Contact>) -> bool {
        contact.is_some_and(|contact| contact.closed(self.shaft()))
    }

    /// True if a soft limit forbids to go in the sense `sense`.
    fn on_limit(&self, sense: i64) -> bool {
        let counter = self.count(self.now_ns);
        self.is(message::HOMED)
            && if sense > 0 {
                counter >= self.settings.soft_plus.into()
            } else {
                counter <= self.settings.soft_minus.into()
            }
    }
}

/// The µstep nearest to a position.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounded; positions are far below the limits of 64 bits, and a float cast saturates"
)]
pub(crate) fn whole(position: f64) -> i64 {
    position.round() as i64
}

/// A count as a register of 32 bits holds it.
pub(crate) fn saturated(count: i64) -> i32 {
    i32::try_from(count).unwrap_or(if count > 0 { i32::MAX } else { i32::MIN })
}
