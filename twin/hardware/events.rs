//! Events from the device threads, and their effect in the session.

use super::merge::Measured;
use super::unit::Unit;
use super::{Hardware, HardwareError};
use twin_drives::Sample;

/// Events from a device's thread to the session.
#[derive(Debug)]
pub(super) enum Event {
    /// Enabled, and the axes are at the start of the program.
    Ready,
    Sample(Sample),
    /// The device has confirmed an output, so much after it was due.
    Switched {
        late_ns: i64,
    },
    /// Outputs that could not be switched off at an early end.
    LeftOn(Vec<u8>),
    /// The device has not confirmed that it stops.
    NotStopped(HardwareError),
    /// After it had failed it was looked at again: it is as after a restart. Whether only a restart makes it so.
    Restarted(bool),
    /// After it had failed, its counters do not show the positions of its axes.
    Displaced(HardwareError),
    /// Finished or stopped: the axes are at rest.
    AtRest,
}

impl Hardware {
    /// Takes what the devices have said.
    pub(super) fn listen(&mut self) {
        let heard = self.heard.iter_mut().zip(&mut self.last).zip(&mut self.switched);
        let tracks = self.tracks.iter_mut().zip(heard);
        for (unit, (track, ((of_unit, last), switched))) in self.units.iter_mut().zip(tracks) {
            loop {
                match unit.event() {
                    Ok(Some(Event::Sample(sample))) => {
                        let measured = measured(unit, &sample);
                        if self.clock.is_some() {
                            of_unit.include(sample.time_ns);
                            *last = Some((measured.time_ns, measured.position));
                        }
                        let heard = (sample.time_ns, sample.moving);
                        self.failures.extend(unit.guard.heard(heard, &measured.deviation));
                        track.push(measured);
                    }
                    Ok(Some(Event::Ready)) => unit.ready = true,
                    Ok(Some(Event::LeftOn(outputs))) => self.left_on.extend(outputs),
                    Ok(Some(Event::NotStopped(error))) => {
                        self.not_stopped.push(error.to_string());
                    }
                    Ok(Some(Event::Displaced(error))) => self.restarted.push(error.to_string()),
                    Ok(Some(Event::Restarted(certain))) => {
                        self.restarted.push(restarted(&unit.device, certain));
                    }
                    Ok(Some(Event::Switched { late_ns })) => {
                        self.switching = self.switching.saturating_sub(1);
                        switched.include(late_ns);
                    }
                    Ok(Some(Event::AtRest)) => {
                        unit.ended = true;
                        track.ended = true;
                    }
                    Ok(None) => break,
                    Err(error) => {
                        track.lost = true;
                        // Whether it could be stopped comes after that.
                        self.failures.push_back(error);
                    }
                }
            }
            of_unit.lost_answers = unit.lost_answers();
            if let Some(clock) = self.clock {
                self.failures.extend(unit.silence(clock.now_ns()));
            }
        }
    }
}

/// A sample in m and rad, and its deviation from the plan.
fn measured(unit: &Unit, sample: &Sample) -> Measured {
    let position = unit.measured(sample);
    let mut deviation = position;
    for (deviation, planned) in deviation.iter_mut().zip(unit.planned(sample.time_ns)) {
        *deviation -= planned;
    }
    Measured { time_ns: sample.time_ns, position, deviation }
}

/// What was found of a device, in words.
fn restarted(device: &str, certain: bool) -> String {
    let found = format!(
        "device `{device}` answers again, at position 0 and not enabled: it has been restarted"
    );
    if certain { found } else { format!("{found}, or the stop has switched it off") }
}
