//! Encoder check of a module: compares counter and encoder of each axis (2.2.4, 2.2.5, 3.1.14 to 3.1.19).
//!
//! An axis whose parameters declare an encoder (definition bit 0) is watched. After each reading of counters and
//! messages the driver reads the encoder positions, in steps, with one more exchange, and compares both
//! ([`twin_drives::encoder_check`]). If they differ it reads the counters once more, to know how far the axis moved meanwhile. The
//! bus has no check sums, so two readings in a row have to agree.
//!
//! The first readings of counter and encoder at rest are taken as the reference; so are those after homing or after
//! another change of zero. The module sets both to 0 when an axis is homed or its position is declared (5.1, 6.2). It
//! corrects programmed moves by the encoder position, so before a homed axis moves, both must be equal, whoever homed
//! it. If they differ, the axis does not count as homed, whatever the module reports. The exception is a counter that
//! is assumed to count on through homing. An absolute encoder keeps its own zero through homing (5.1): both are equal
//! once its offset is stored at home (parameters $30 and $31, by `zero` or a preset).
//!
//! Message bit 4 reports that a programmed move needed a correction, which the module has made itself. If encoder and
//! counter agree afterwards, the axis is at its target and there is no fault. Modules read the bit of the plug, which
//! can identify the motor, only when they start or on request. It is a fault only if it was clear before, because many
//! modules have no plugs.

use super::{
    AXES, Action, Bim2AxDrive, BusStamp, Clock, DriveError, ModuleAxis, Positions, no_clock,
};
use crate::{
    AxisSettings, Fault,
    protocol::{
        bits::{definition, encoder_message, message},
        parameter::{AxisParameter, Parameter},
    },
};
use twin_drives::{
    encoder_check::{Apart, EncoderCheck, EncoderLimits, Passed},
    ramp::seconds,
};

/// A rotor comes to rest at every fourth full step of the same current in its windings, and slips beyond two: what is farther
/// away than this has lost its place, and what is nearer has not.
const FULL_STEPS: u32 = 3;
/// "Peut être différente de celle du moteur de 1 ou 2 pas" (3.1.15); one of them is the point of the encoder.
const ROUNDING: u32 = 1;
/// What encoder messages say is wrong in any case.
const FAULTS: u16 = encoder_message::DIVISOR_ZERO | encoder_message::FAULT | encoder_message::ALARM;
/// What kind of encoder a module recognises; none of them without one.
const KINDS: u16 = encoder_message::INCREMENTAL | encoder_message::SSI | encoder_message::ENDAT;

/// The encoder of an axis.
#[derive(Clone, Copy, Debug)]
struct Watched {
    shaft: EncoderCheck,
    /// The axis was homed when it was seen last.
    homed: bool,
    /// There has to be one: the user has said so.
    wanted: bool,
    /// The bit of the plug when two looks at the axis at rest showed the same first.
    plug: Option<bool>,
}

/// The encoders of the axes in use, in their order.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Encoders([Option<Watched>; AXES]);

impl Encoders {
    /// Whether any axis is watched.
    pub(super) fn any(&self) -> bool {
        self.0.iter().any(Option::is_some)
    }

    /// Counters, encoders or shafts have been put elsewhere.
    pub(super) fn forget(&mut self) {
        self.0.iter_mut().flatten().for_each(|watched| watched.shaft.forget());
    }
}

/// Bit of an axis in its messages.
fn has(seen: &Positions, axis: ModuleAxis, bit: u16) -> bool {
    seen.messages.get(axis.index()).is_some_and(|word| word & bit != 0)
}

fn at(seen: &Positions, axis: ModuleAxis) -> i32 {
    seen.positions.get(axis.index()).copied().unwrap_or(0)
}

impl Bim2AxDrive {
    /// Looks which axes have encoders, by their parameters.
    ///
    /// # Errors
    /// [`DriveError::Setting`] if one is to have one and does not, or its divisor is 0.
    pub(super) fn find_encoders(&mut self, settings: &[AxisSettings]) -> Result<(), DriveError> {
        let mut encoders = Encoders::default();
        let axes = self.options.axes.clone();
        for ((slot, axis), settings) in encoders.0.iter_mut().zip(axes).zip(settings) {
            let wanted = self.options.encoder_axes.contains(&axis);
            let declared = self.encoder_parameter(AxisParameter::EncoderDefinition, axis)?;
            if declared & u32::from(definition::PRESENT) == 0 {
                if wanted {
                    let setting = "presence of the encoder, definition bit 0";
                    let at = self.module.at(Action::Identify);
                    return Err(DriveError::Setting { at, setting, value: 0, low: 1, high: 1 });
                }
                continue;
            }
            let dividend = self.encoder_parameter(AxisParameter::Dividend, axis)?;
            let divisor = self.encoder_parameter(AxisParameter::Divisor, axis)?;
            if divisor == 0 {
                let setting = "points of the encoder per turn, divisor";
                let at = self.module.at(Action::Identify);
                return Err(DriveError::Setting { at, setting, value: 0, low: 1, high: 65_535 });
            }
            let microsteps = u32::from(settings.mode.microsteps());
            let watching = EncoderLimits {
                points: 1,
                increments: 1,
                tolerance: self.options.encoder_tolerance.unwrap_or(FULL_STEPS * microsteps),
                rounding: dividend.div_ceil(divisor).saturating_add(ROUNDING),
                rate: settings.rate(),
                start_stop: settings.start_stop(),
                fastest: settings.speed(u16::MAX),
            };
            let shaft = EncoderCheck::new(&watching);
            *slot = Some(Watched { shaft, homed: false, wanted, plug: None });
        }
        self.encoders = encoders;
        Ok(())
    }

    fn encoder_parameter(
        &mut self,
        parameter: AxisParameter,
        axis: ModuleAxis,
    ) -> Result<u32, DriveError> {
        let asked = self.module.parameter(Parameter::Axis(parameter, axis), &no_clock);
        self.runtime.block_on(asked)
    }

    /// Holds a look at the counters against the encoders, which are looked at now. `clock` is that of the look.
    ///
    /// # Errors
    /// [`DriveError::EncoderDiffers`], [`Fault::Encoder`]; or if the module does not answer.
    pub(super) fn watch_encoders(
        &mut self,
        (seen, stamp): &(Positions, BusStamp),
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        if !self.encoders.any() {
            return Ok(());
        }
        let (shown, _) = self.runtime.block_on(self.module.encoder_steps(clock))?;
        let axes = self.options.axes.clone();
        let (mut doubtful, mut referred) = (false, [None; AXES]);
        let watching = self.encoders.0.iter_mut().zip(&mut referred).zip(&axes);
        for ((watched, referred), axis) in watching {
            let Some(watched) = watched else { continue };
            let messages = shown.messages.get(axis.index()).copied().unwrap_or(0);
            // Where none is recognised there is nothing to watch, unless there has to be one.
            if messages & KINDS == 0 && !watched.wanted {
                watched.shaft.forget();
                continue;
            }
            let plug = messages & encoder_message::PLUG != 0;
            let unplugged = plug && watched.plug == Some(false);
            if messages & FAULTS != 0 || messages & KINDS == 0 || unplugged {
                let axis = u8::try_from(axis.number()).unwrap_or(0);
                let at = self.module.at(Action::ReadState);
                return Err(Fault::Encoder { axis, messages }.at(at));
            }
            let (counter, encoder) = (at(seen, *axis), at(&shown, *axis));
            let homed = has(seen, *axis, message::HOMED);
            if homed && !watched.homed {
                // Both have just been made 0 or what was declared.
                watched.shaft.forget();
            }
            watched.homed = homed;
            if !watched.shaft.is_known() && !has(seen, *axis, message::MOVING) {
                watched.shaft.refer(encoder, counter.into());
                *referred = Some(plug);
            }
            doubtful |= watched.shaft.apart(&Passed::at_rest(counter.into()), encoder).is_some();
        }
        if referred.iter().any(Option::is_some) {
            self.confirm(referred)?;
        }
        if doubtful { self.bracket(seen, stamp, &shown, clock) } else { Ok(()) }
    }

    /// Looks once more at axes whose reference has just been noted, in addition to the bit of the plug: either look may
    /// have been spoilt.
    fn confirm(&mut self, referred: [Option<bool>; AXES]) -> Result<(), DriveError> {
        let (seen, _) = self.look(&no_clock)?;
        let (shown, _) = self.runtime.block_on(self.module.encoder_steps(&no_clock))?;
        let watching = self.encoders.0.iter_mut().zip(referred).zip(&self.options.axes);
        for ((watched, referred), axis) in watching {
            let (Some(watched), Some(plug)) = (watched, referred) else { continue };
            if has(&shown, *axis, encoder_message::PLUG) == plug {
                watched.plug.get_or_insert(plug);
            }
            let passed = Passed::at_rest(at(&seen, *axis).into());
            let moves = has(&seen, *axis, message::MOVING);
            if moves || watched.shaft.apart(&passed, at(&shown, *axis)).is_some() {
                watched.shaft.forget();
            }
        }
        Ok(())
    }

    /// The same, but only where it is known already what the encoders are to show: for axes that have been stopped.
    pub(super) fn watch_known(&mut self, seen: &(Positions, BusStamp)) -> Result<(), DriveError> {
        let known = self.encoders.0.iter().flatten().any(|watched| watched.shaft.is_known());
        if known { self.watch_encoders(seen, &no_clock) } else { Ok(()) }
    }

    /// Looks at the counters once more: what they passed meanwhile accounts for some difference.
    fn bracket(
        &mut self,
        before: &Positions,
        stamp: &BusStamp,
        shown: &Positions,
        clock: &dyn Clock,
    ) -> Result<(), DriveError> {
        let (after, then) = self.look(clock)?;
        let duration = seconds(then.answered_ns.saturating_sub(stamp.sent_ns)).max(0.0);
        let axes = (0_u8..).zip(self.options.axes.clone());
        for (watched, (place, axis)) in self.encoders.0.iter_mut().zip(axes) {
            let Some(watched) = watched else { continue };
            if has(&after, axis, message::HOMED) && !watched.homed {
                // Homing has ended between the two looks.
                watched.shaft.forget();
                continue;
            }
            let moves = has(before, axis, message::MOVING) || has(&after, axis, message::MOVING);
            // Without a clock it is not known how far one can have come.
            if moves && then.answered_ns == stamp.sent_ns {
                continue;
            }
            let [before, after] = [before, &after].map(|seen| i64::from(at(seen, axis)));
            let duration = if moves { duration } else { 0.0 };
            let passed = Passed { before, after, duration };
            if let Some(apart) = watched.shaft.apart(&passed, at(shown, axis)) {
                return Err(self.differs(place, apart));
            }
        }
        Ok(())
    }

    /// The counters and encoders of axes at rest belong together from now on, whatever they show: they are about to home.
    pub(super) fn refer_encoders(&mut self) -> Result<(), DriveError> {
        if !self.encoders.any() {
            return Ok(());
        }
        self.encoders.forget();
        let seen = self.look(&no_clock)?;
        self.watch_encoders(&seen, &no_clock)?;
        // As soon as they are home both are made 0, also where that takes no longer than a look.
        self.encoders.0.iter_mut().flatten().for_each(|watched| watched.homed = false);
        Ok(())
    }

    /// Axes in use at rest that the module calls home although their encoders show them elsewhere than their counters: both have
    /// been made 0 together. Nothing of one whose counter is assumed to count on through homing.
    pub(super) fn displaced(
        &mut self,
        seen: &Positions,
    ) -> Result<[Option<Apart>; AXES], DriveError> {
        let mut displaced = [None; AXES];
        let keeps = self.options.driver.assumptions.homing_keeps_position;
        if !self.encoders.any() || keeps || self.moving(seen) != 0 {
            return Ok(displaced);
        }
        let (shown, _) = self.runtime.block_on(self.module.encoder_steps(&no_clock))?;
        let axes = self.encoders.0.iter().zip(&self.options.axes);
        for (slot, (watched, axis)) in displaced.iter_mut().zip(axes) {
            let there = has(&shown, *axis, KINDS) && !has(&shown, *axis, FAULTS);
            if let Some(Watched { mut shaft, .. }) = *watched
                && there
                && has(seen, *axis, message::HOMED)
            {
                shaft.refer(0, 0);
                *slot = shaft.apart(&Passed::at_rest(at(seen, *axis).into()), at(&shown, *axis));
            }
        }
        Ok(displaced)
    }

    /// Fails for the first of them.
    pub(super) fn check_homes(&mut self, seen: &Positions) -> Result<(), DriveError> {
        let displaced = self.displaced(seen)?;
        let first = (0_u8..).zip(displaced).find_map(|(place, apart)| Some((place, apart?)));
        first.map_or(Ok(()), |(place, apart)| Err(self.differs(place, apart)))
    }

    /// Error of the axis at a place among those in use.
    pub(super) fn differs(&self, place: u8, apart: Apart) -> DriveError {
        let watched = self.encoders.0.get(usize::from(place)).copied().flatten();
        DriveError::EncoderDiffers {
            at: self.module.at(Action::ReadState),
            axis: self.names(1 << place),
            counter: apart.counter,
            encoder: apart.encoder,
            unit: "µsteps",
            tolerance: watched.map_or(0, |watched| watched.shaft.tolerance()),
            points: None,
        }
    }
}
