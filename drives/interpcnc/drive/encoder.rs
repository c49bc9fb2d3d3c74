//! Encoder check of the board: compares counter and encoder of the one axis that has an encoder.
//!
//! A board from V2.1D on has one encoder, whose position (registers 4218 and 4219) cannot be set over Modbus. The first
//! readings of counter and encoder at rest are the reference. It is taken anew after homing, another change of zero, or
//! a stop that may lose steps.
//!
//! Reading the encoder costs an exchange. During motion it is therefore read after one in [`EVERY`] looks, and compared
//! with what the counter passes up to the next look ([`twin_drives::encoder_check`]). When its axis comes to rest it is read at once,
//! and with every look while the whole board rests.

use super::{BoardState, InterpCncDrive, Stamp, counter, no_clock};
use crate::{
    BoardAxis, EncoderOptions, Exception, Following, InterpCncOptions, protocol::registers::Status,
};
use twin_drives::{
    Action, Axes, Clock, DriveError,
    encoder_check::{Apart, EncoderCheck, EncoderLimits, Passed},
    ramp::seconds,
};

/// Looks at an axis on its way for each reading of its encoder.
pub(crate) const EVERY: u32 = 8;

/// A reading on the way, until the next look at the counter.
#[derive(Clone, Copy, Debug)]
struct Reading {
    counter: i64,
    sent_ns: i64,
    points: i32,
}

/// The axis with the encoder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    options: EncoderOptions,
    shaft: EncoderCheck,
    reading: Option<Reading>,
    /// Looks since the encoder was read.
    looks: u32,
    /// The axis rested when it was seen last.
    rested: bool,
    /// It is being homed, and its end has not been seen.
    homing: bool,
}

impl Watched {
    /// None where the board is said to have none.
    pub(super) fn new(options: &InterpCncOptions) -> Option<Self> {
        let encoder = options.encoder?;
        let axis = options.axes.iter().find(|axis| axis.axis == encoder.axis)?;
        // Segments have ramps of their own.
        let (rate, start_stop) = match options.following {
            Following::Buffered { start_stop_hz, acceleration_khz_per_s } => {
                (acceleration_khz_per_s, start_stop_hz)
            }
            Following::Retargeted => (0, 0),
        };
        let rate = rate.max(axis.acceleration_khz_per_s).max(axis.deceleration_khz_per_s);
        let watching = EncoderLimits {
            points: encoder.points,
            increments: encoder.increments,
            tolerance: encoder.tolerance,
            rounding: 1,
            rate: 1e3 * f64::from(rate),
            start_stop: axis.start_stop_hz.max(start_stop).into(),
            fastest: axis.max_speed_hz.into(),
        };
        let shaft = EncoderCheck::new(&watching);
        let (reading, looks, rested, homing) = (None, 0, false, false);
        Some(Self { options: encoder, shaft, reading, looks, rested, homing })
    }

    pub(super) fn axis(&self) -> BoardAxis {
        self.options.axis
    }

    /// Something else than following moves or stops the axis: earlier readings are not compared with later ones.
    pub(super) fn restart(&mut self) {
        self.reading = None;
        self.rested = false;
    }

    /// Counter, encoder or shaft are elsewhere from now on.
    pub(super) fn forget(&mut self) {
        self.restart();
        self.shaft.forget();
        self.homing = false;
    }

    /// It is about to home.
    pub(super) fn homes(&mut self) {
        self.restart();
        self.homing = true;
    }
}

impl InterpCncDrive {
    /// Fails where a board that is said to have an encoder has no registers for it.
    pub(super) fn find_encoder(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        if self.encoder.is_none() {
            return Ok(());
        }
        match self.points(clock) {
            // Such an address does not exist ("Traitement des erreurs").
            Err(error) if Exception::code_of(&error) == Some(2) => {
                let what = "encoder: boards have one from V2.1D on";
                Err(DriveError::Unsupported { at: error.at().clone(), what })
            }
            answered => answered.map(drop),
        }
    }

    fn points(&mut self, clock: &dyn Clock) -> Result<i32, DriveError> {
        self.runtime.block_on(self.board.encoder_position(clock))
    }

    /// Holds a look at the board against the encoder, which is read where it is time to.
    ///
    /// # Errors
    /// [`DriveError::EncoderDiffers`]; or if the board does not answer.
    pub(super) fn watch_encoder(
        &mut self,
        (state, stamp): (&BoardState, &Stamp),
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let Some(mut watched) = self.encoder else { return Ok(()) };
        let axis = watched.options.axis;
        let now = i64::from(counter(state, axis));
        if let Some(Reading { counter, sent_ns, points }) = watched.reading.take() {
            let duration = seconds(stamp.answered_ns.saturating_sub(sent_ns)).max(0.0);
            let passed = Passed { before: counter, after: now, duration };
            let apart = if watched.homing {
                watched.shaft.apart_homing(&passed, points)
            } else {
                watched.shaft.apart(&passed, points)
            };
            if let Some(apart) = apart {
                return Err(self.displaced(apart, points));
            }
        }
        let (all_rest, rests) = self.rest(state, &watched);
        watched.looks = watched.looks.saturating_add(1);
        let due = watched.looks >= EVERY || all_rest || rests && !watched.rested;
        watched.rested = rests;
        self.encoder = Some(watched);
        if !due {
            return Ok(());
        }
        if rests {
            return self.watch_at_rest((state, stamp), clock);
        }
        let points = self.points(clock)?;
        watched.looks = 0;
        watched.reading = Some(Reading { counter: now, sent_ns: stamp.sent_ns, points });
        self.encoder = Some(watched);
        Ok(())
    }

    /// Whether all axes of the board rest and no segment waits, and whether that with the encoder does.
    fn rest(&self, state: &BoardState, watched: &Watched) -> (bool, bool) {
        let BoardState { status, .. } = state;
        let homes = status.has(Status::HOMING_IN_PROGRESS);
        let all = status.stopped(self.board.options().mask()) && !homes;
        let axis = watched.options.axis;
        let moves = status.moving().contains(axis);
        (all, !moves && !homes && (self.buffered.is_none() || all))
    }

    /// Reads the encoder of an axis at rest. One that turns round may look so (firmware before 5.31): where both are apart,
    /// and before they are said to belong together, the counter is looked at once more.
    fn watch_at_rest(
        &mut self,
        (state, first): (&BoardState, &Stamp),
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let Some(mut watched) = self.encoder else { return Ok(()) };
        let points = self.points(clock)?;
        watched.looks = 0;
        let before = i64::from(counter(state, watched.options.axis));
        if watched.homing {
            // It has ended, with another counter.
            watched.homing = false;
            watched.shaft.forget();
        }
        self.encoder = Some(watched);
        let known = watched.shaft.is_known();
        if known && watched.shaft.apart(&Passed::at_rest(before), points).is_none() {
            return Ok(());
        }
        let (again, stamp) = self.state(clock)?;
        let after = i64::from(counter(&again, watched.options.axis));
        let (_, rests) = self.rest(&again, &watched);
        if !known {
            if rests && before == after {
                watched.shaft.refer(points, after);
            }
            self.encoder = Some(watched);
            return Ok(());
        }
        let stood = rests && before == after;
        // Without a clock it is not known how far it can have come.
        if !stood && stamp.answered_ns == first.sent_ns {
            return Ok(());
        }
        let duration = seconds(stamp.answered_ns.saturating_sub(first.sent_ns)).max(0.0);
        let duration = if stood { 0.0 } else { duration };
        let apart = watched.shaft.apart(&Passed { before, after, duration }, points);
        apart.map_or(Ok(()), |apart| Err(self.displaced(apart, points)))
    }

    /// Reads the encoder of an axis that is about to be sent somewhere, where it is not known yet what belongs together.
    pub(super) fn refer_encoder(&mut self) -> Result<(), DriveError> {
        let known = self.encoder.is_none_or(|watched| watched.shaft.is_known() && !watched.homing);
        if known {
            return Ok(());
        }
        self.look_at_rest(&no_clock)
    }

    /// Reads the encoder of an axis that has been stopped or is to be at rest.
    pub(super) fn look_at_rest(&mut self, clock: &dyn Clock) -> Result<(), DriveError> {
        let Some(watched) = self.encoder else { return Ok(()) };
        let (state, stamp) = self.state(clock)?;
        let (_, rests) = self.rest(&state, &watched);
        if rests { self.watch_at_rest((&state, &stamp), clock) } else { Ok(()) }
    }

    /// Reads the encoder of an axis that has been stopped, where it is known what it is to show.
    pub(super) fn check_stopped(&mut self) -> Result<(), DriveError> {
        let known = self.encoder.is_some_and(|watched| watched.shaft.is_known() && !watched.homing);
        if known { self.look_at_rest(&no_clock) } else { Ok(()) }
    }

    /// The shaft is elsewhere: the axis is not home any more, and watched anew from where it rests next.
    fn displaced(&mut self, apart: Apart, points: i32) -> DriveError {
        self.restart();
        let action = Action::Read {
            what: "encoder position",
            address: crate::protocol::registers::ENCODER,
            count: 2,
        };
        let at = self.board.at(action);
        let Apart { counter, encoder } = apart;
        let (mut axes, mut tolerance) = (Axes::Letters(0), 0);
        if let Some(watched) = &mut self.encoder {
            axes = Axes::Letters(watched.options.axis.mask().bits());
            tolerance = watched.shaft.tolerance();
            watched.forget();
            self.homing.lose_axis(watched.options.axis);
        }
        let (unit, points) = ("steps", Some(points));
        DriveError::EncoderDiffers { at, axis: axes, counter, encoder, unit, tolerance, points }
    }
}
