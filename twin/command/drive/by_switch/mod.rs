//! Homing by a switch that the drive only shows, as SoftMotion's `SMC_Homing` does it.

mod index;
mod way;
mod words;

use super::consent::Consent;
use crate::clock::Clock;
use crate::command::Failure;
use crate::command::run::Interrupt;
use crate::startup::Still;
use twin_drives::homing::{
    Direction, HomingMode, HomingOptions, HomingRun, Switch, home_by_switch,
};
use twin_drives::{Drive, DriveError, MAX_DRIVE_AXES, SetpointStream};
use words::Search;

/// How an axis is homed by a switch.
#[derive(Clone, Copy, Debug, clap::Args)]
#[expect(clippy::struct_excessive_bools, reason = "options of a command, each given or not")]
pub(super) struct BySwitch {
    /// Home one axis by looking at a switch and moving the axis, not by the drive's own homing, in this mode of `SMC_Homing`: 0
    /// fast onto the switch, slowly back off it, where it opens is home; 1 as 0, but where the axis then stops is home; 4 and 5
    /// as 0 and 1, but slowly on over the switch; 2 and 6 as 0 and 4, but the next index pulse is home (--index-input)
    #[arg(long = "by-switch", id = "by_switch", value_name = "MODE", value_parser = mode)]
    mode: Option<HomingMode>,

    /// The switch is at this input, IN1 first; of a SmartDRIVE 1 is GO, 2 DIR, 3 OFF, 4 LIMP, 5 LIMN, and it has to be given
    /// [default: the home switch that the drive knows]
    #[arg(long, value_name = "N", requires = "by_switch", value_parser = clap::value_parser!(u8).range(1..=64))]
    input: Option<u8>,

    /// The input is off while the switch is pressed
    #[arg(long, requires = "input")]
    normally_closed: bool,

    /// The home switch is the limit switch in the direction of the search, which does not end homing then
    #[arg(long, requires = "by_switch", conflicts_with = "input")]
    on_limit: bool,

    /// Limit switches do not end homing (`bIgnoreHWLimit`); not in modes 4, 5 and 6, which go on in their direction
    #[arg(long, requires = "by_switch")]
    ignore_limits: bool,

    /// Modes 2 and 6: the index pulse is at this input, which has to be on for longer than one look takes: at 100 looks a second
    /// and --slow 200, 2 increments and more
    #[arg(long, value_name = "N", requires = "by_switch", value_parser = clap::value_parser!(u8).range(1..=64))]
    index_input: Option<u8>,

    /// The index input is off during the pulse
    #[arg(long, requires = "index_input")]
    index_low: bool,

    /// Delay of the switch's signal, ms (`fSignalDelay`): home is where the axis was that long before
    #[arg(long, value_name = "MS", default_value_t = 0.0, requires = "by_switch", value_parser = delay_ms)]
    signal_delay: f64,

    /// Go to position 0 at the end, at the fast speed (`bReturnToZero`)
    #[arg(long, requires = "by_switch")]
    return_to_zero: bool,

    /// Look for the switch towards larger positions
    #[arg(long, requires = "by_switch")]
    positive: bool,

    /// Speed towards the switch, steps/s; of a SmartDRIVE or a BIM2AX µsteps/s, as everything that follows is in µsteps. So far as
    /// it goes in half a second it goes on where this program or its wire fails
    #[arg(long, value_name = "PER_S", default_value_t = 2000, requires = "by_switch", value_parser = clap::value_parser!(u32).range(1..))]
    fast: u32,

    /// Speed off the switch, steps/s
    #[arg(long, value_name = "PER_S", default_value_t = 200, requires = "by_switch", value_parser = clap::value_parser!(u32).range(1..))]
    slow: u32,

    /// Longest way to the switch, steps; so far the axis goes where the switch never comes [default: 100000, and no farther than
    /// the drive's own limits]
    #[arg(long, value_name = "STEPS", requires = "by_switch", value_parser = clap::value_parser!(u32).range(1..))]
    max_way: Option<u32>,

    /// Longest way off the switch, steps
    #[arg(long, value_name = "STEPS", default_value_t = 10_000, requires = "by_switch", value_parser = clap::value_parser!(u32).range(1..))]
    max_slow_way: u32,

    /// Position of the home, steps
    #[arg(
        long,
        value_name = "STEPS",
        default_value_t = 0,
        allow_negative_numbers = true,
        requires = "by_switch"
    )]
    home_position: i32,
}

/// Why more than one axis is not homed by a switch.
pub(super) fn one_at_a_time() -> Failure {
    Failure::Usage("home --by-switch homes one axis at a time".to_owned())
}

fn mode(text: &str) -> Result<HomingMode, String> {
    let mode = text.parse().ok().and_then(HomingMode::from_number);
    mode.ok_or_else(|| "the modes are 0, 1, 2, 4, 5 and 6".to_owned())
}

/// Up to a second: what is older says nothing about where an axis is.
fn delay_ms(text: &str) -> Result<f64, String> {
    let delay = text.parse().ok().filter(|delay| (0.0..=1000.0).contains(delay));
    delay.ok_or_else(|| "expected 0 to 1000 ms".to_owned())
}

impl BySwitch {
    /// Whether it is wanted.
    pub(super) fn is_wanted(&self) -> bool {
        self.mode.is_some()
    }

    /// The fastest it goes, increments/s.
    pub(super) fn fastest(&self) -> f64 {
        f64::from(self.fast.max(self.slow))
    }

    /// Enables the drive and homes its only axis in use; what it is called, and what its increments are.
    pub(super) fn carry_out(
        &self,
        drive: &mut dyn Drive,
        named: (&str, &'static str),
        consent: Consent,
    ) -> Result<(), Failure> {
        let (said, _) = self.find(drive, named, consent, "")?;
        say!("{said}");
        Ok(())
    }

    /// The same of a drive whose own counter can only be made 0: `keep` does that, at 0.
    pub(super) fn carry_out_at_zero<D: Drive>(
        &self,
        drive: &mut D,
        (name, unit): (&str, &'static str),
        consent: Consent,
        keep: impl FnOnce(&mut D) -> Result<(), DriveError>,
    ) -> Result<(), Failure> {
        let most = i64::from(self.max_slow_way);
        if i64::from(self.home_position).abs() > most {
            return Err(Failure::Usage(format!(
                "{name} can only set its counter to 0 at its present position: from its home at {} it would go to 0, \
                 which is beyond --max-slow-way ({most} {unit})",
                self.home_position
            )));
        }
        let (said, interrupt) =
            self.find(drive, (name, unit), consent, ", then to 0, where its counter becomes 0")?;
        if let Err(failed) = self.return_to_zero(drive, &interrupt) {
            let stopped = drive.soft_stop().err();
            let stopped = stopped.map_or(String::new(), |error| {
                format!("; and the axis could not be stopped: {error}; use the emergency stop")
            });
            let message =
                format!("{name} has found its home, but its counter is not set: {failed}{stopped}");
            return Err(Failure::Usage(message));
        }
        keep(drive)?;
        say!("{said}; it is at 0, and so is its counter");
        Ok(())
    }

    /// Moves the axis to position 0, slowly.
    fn return_to_zero(&self, drive: &mut dyn Drive, interrupt: &Interrupt) -> Result<(), Failure> {
        let stream = Still::new(Clock::start());
        let mut speed = [0.0; MAX_DRIVE_AXES];
        speed.iter_mut().take(1).for_each(|speed| *speed = f64::from(self.slow));
        drive.move_to(&[0; MAX_DRIVE_AXES], &speed)?;
        loop {
            let sample = drive.sample(&stream)?;
            if interrupt.count() > 0 {
                return Err(Failure::Usage(format!("stopped by {}", interrupt.name())));
            }
            let at = sample.position.first().copied().unwrap_or(0);
            if !sample.moving && at == 0 {
                return Ok(());
            }
            if !sample.moving {
                return Err(Failure::Usage(format!("it is at {at} instead of 0")));
            }
        }
    }

    /// Which signal of the drive the switch is.
    fn switch(&self) -> Switch {
        match self.input {
            Some(number) => Switch::Input { number, pressed: !self.normally_closed },
            None if self.on_limit && self.positive => Switch::PositiveLimit,
            None if self.on_limit => Switch::NegativeLimit,
            None => Switch::Home,
        }
    }

    /// What homing is to be like, with the longest way to the switch.
    fn options(&self, mode: HomingMode, most: u32) -> Result<HomingOptions, Failure> {
        let (slow, fast) = (f64::from(self.slow), f64::from(self.fast));
        let options = HomingOptions {
            home_position: f64::from(self.home_position),
            velocity_fast: fast,
            direction: if self.positive { Direction::Positive } else { Direction::Negative },
            mode,
            signal_delay: self.signal_delay * 1e-3,
            return_to_zero: self.return_to_zero,
            ignore_hardware_limit: self.ignore_limits || self.on_limit,
            // Ramps are the drive's.
            ..HomingOptions::new(slow, fast, f64::from(most), f64::from(self.max_slow_way))
        };
        options.check().map_err(|error| Failure::Usage(words::axis_error(&error)))?;
        Ok(options)
    }

    /// Finds the home; what there is to say of it.
    fn find(
        &self,
        drive: &mut dyn Drive,
        (name, unit): (&str, &'static str),
        consent: Consent,
        afterwards: &str,
    ) -> Result<(String, Interrupt), Failure> {
        let mode = self.mode.unwrap_or(HomingMode::FastBslowSStop);
        let stream = Still::new(Clock::start());
        let from = drive.probe(&stream)?.position.first().copied().unwrap_or(0);
        let signals = drive.signals(&|| stream.now_ns())?;
        let mut index = self.index(&signals, mode)?;
        // Mistakes of the words come before missing abilities of the drive.
        self.options(mode, 1)?;
        let switch = self.switch();
        if switch.pressed(&signals, 0).is_none() {
            return Err(Failure::Usage(words::no_switch(switch, &signals)));
        }
        let (most, kept) = self.way(drive, from, unit)?;
        let options = self.options(mode, most)?;
        let search = Search { name, unit, switch, leg: options.longest_leg() };
        let sign = if self.positive { '+' } else { '-' };
        let afterwards = match self.index_input {
            Some(input) => format!(" until the index pulse comes at input {input}{afterwards}"),
            None => afterwards.to_owned(),
        };
        let returns = if self.return_to_zero { ", then to 0" } else { "" };
        let at = search.place();
        let Self { fast, slow, .. } = self;
        consent.ask(&format!(
            "home {name} from {from} towards {sign} until {at} says so, {most} {unit} at most{kept}, at {fast} {unit}/s, and off it at \
             {slow} {unit}/s{afterwards}{returns}; if this program or its wire fails, the axis does not see the switch and stops \
             within {} {unit}",
            search.leg
        ))?;
        let interrupt = Interrupt::catch_for_drives()?;
        drive.enable()?;
        // A drive that was off counts from 0 now.
        let now = drive.probe(&stream)?.position.first().copied().unwrap_or(0);
        let options = if now == from {
            options
        } else {
            self.options(mode, most.min(self.way(drive, now, unit)?.0))?
        };
        let run = HomingRun { axis: 0, switch, options };
        let stopped = || interrupt.count() > 0;
        let ended = home_by_switch(
            drive,
            &run,
            &stream,
            &mut |signals, position| index.seen(signals, position),
            &stopped,
        );
        let report = ended.map_err(|error| search.failure(&error, drive, &interrupt))?;
        let position = drive.sample(&stream)?.position.first().copied().unwrap_or(0);
        #[expect(clippy::cast_precision_loss, reason = "milliseconds")]
        let looks_s = report.longest_look_ns as f64 * 1e-9;
        let said = format!(
            "{name} is home, at {position}; the switch was at {:.1}, known to {:.1} {unit}",
            report.reference,
            options.uncertainty(looks_s)
        );
        Ok((said, interrupt))
    }
}

#[cfg(test)]
mod tests {
    use super::{delay_ms, mode};
    use twin_drives::homing::HomingMode;

    #[test]
    fn all_six_modes_can_be_said() {
        let said = ["0", "1", "2", "4", "5", "6"].map(|text| mode(text).ok());
        assert_eq!(said, HomingMode::ALL.map(Some));
        assert!(mode("3").is_err() && mode("7").is_err() && mode("").is_err());
        assert_eq!((delay_ms("12.5"), delay_ms("-1").is_err()), (Ok(12.5), true));
        assert!(delay_ms("1001").is_err() && delay_ms("nan").is_err());
    }
}
