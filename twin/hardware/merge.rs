//! Interpolation of axis positions that several devices measured at different times, to one common time.
//!
//! A merged sample has the time of one device's own sample. The positions of the other devices are interpolated between
//! their samples before and after. The interpolation is that of their deviation from the plan, which is then added to
//! the planned position. Its error is therefore that of the drives' deviation, not of their motion.

use std::collections::VecDeque;
use twin_drives::MAX_DRIVE_AXES;

/// Positions of the axes of a device, m or rad.
pub(super) type Positions = [f64; MAX_DRIVE_AXES];

/// A sample of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// ns.
    pub(super) time_ns: i64,
    /// Axis positions.
    pub(super) position: Positions,
    /// Deviation from the plan.
    pub(super) deviation: Positions,
}

/// Samples of one device that others wait for, or that wait for others.
#[derive(Debug, Default)]
pub(super) struct Track {
    /// In order of time. The first ones have been reported; they are kept for those of others.
    samples: VecDeque<Measured>,
    /// Number of samples that have been reported.
    reported: usize,
    /// There will be no more: it stays where it was last.
    pub(super) ended: bool,
    /// True if the device has failed: the positions of its axes since then are not known.
    pub(super) lost: bool,
}

impl Track {
    pub(super) fn push(&mut self, sample: Measured) {
        // Two samples at one time say no more than one.
        if self.samples.back().is_none_or(|last| last.time_ns < sample.time_ns) {
            self.samples.push_back(sample);
        }
    }

    /// The next sample that has not been reported.
    fn next(&self) -> Option<&Measured> {
        self.samples.get(self.reported)
    }

    /// What is known of an instant.
    fn at(&self, time_ns: i64) -> Known<'_> {
        let after = self.samples.iter().position(|sample| sample.time_ns >= time_ns);
        match after {
            None if self.lost => Known::Never,
            None if self.ended => match self.samples.back() {
                Some(last) => Known::Between(last, last),
                None => Known::Never,
            },
            None => Known::NotYet,
            Some(after) => {
                let to = self.samples.get(after);
                let from = match to {
                    Some(to) if to.time_ns == time_ns => Some(to),
                    _ => after.checked_sub(1).and_then(|before| self.samples.get(before)),
                };
                from.zip(to).map_or(Known::Never, |(from, to)| Known::Between(from, to))
            }
        }
    }

    /// Forgets what no instant from `time_ns` on asks for.
    fn forget(&mut self, time_ns: i64) {
        while self.reported > 0 && self.samples.get(1).is_some_and(|next| next.time_ns <= time_ns) {
            self.samples.pop_front();
            self.reported -= 1;
        }
    }
}

/// What a device knows of an instant.
enum Known<'a> {
    /// It has not come so far.
    NotYet,
    /// It was not there yet, or is lost.
    Never,
    /// It has measured before and after, or just then.
    Between(&'a Measured, &'a Measured),
}

/// The next instant at which all axis positions are known, with these positions; `planned` gives the planned positions
/// of a device.
pub(super) fn next(
    tracks: &mut [Track],
    planned: impl Fn(usize, i64) -> Positions,
) -> Option<(i64, Vec<Positions>)> {
    loop {
        let waiting = tracks.iter().enumerate();
        let waiting = waiting.filter_map(|(unit, track)| Some((track.next()?.time_ns, unit)));
        let (time_ns, unit) = waiting.min()?;
        let mut found = Vec::with_capacity(tracks.len());
        let mut never = false;
        for (index, track) in tracks.iter().enumerate() {
            match track.at(time_ns) {
                Known::NotYet => return None,
                Known::Never => never = true,
                Known::Between(from, to) if from.time_ns == to.time_ns && index == unit => {
                    found.push(from.position);
                }
                Known::Between(from, to) => {
                    found.push(between(from, to, time_ns, planned(index, time_ns)));
                }
            }
        }
        if let Some(track) = tracks.get_mut(unit) {
            track.reported += 1;
        }
        for track in tracks.iter_mut() {
            track.forget(time_ns);
        }
        if !never {
            return Some((time_ns, found));
        }
    }
}

/// Where axes were at an instant between two samples of them.
#[expect(clippy::cast_precision_loss, reason = "spans of milliseconds")]
fn between(from: &Measured, to: &Measured, time_ns: i64, planned: Positions) -> Positions {
    let span = (to.time_ns - from.time_ns).max(1) as f64;
    let part = ((time_ns - from.time_ns) as f64 / span).clamp(0.0, 1.0);
    let mut position = planned;
    for (position, (from, to)) in position.iter_mut().zip(from.deviation.iter().zip(to.deviation)) {
        *position += from + (to - from) * part;
    }
    position
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan of 3 m/s for every axis.
    fn planned(time_ns: i64) -> Positions {
        [3.0 * twin_number::seconds(time_ns); MAX_DRIVE_AXES]
    }

    /// A sample that is off the plan.
    fn off(time_ns: i64, deviation: f64) -> Measured {
        let position = planned(time_ns).map(|planned| planned + deviation);
        Measured { time_ns, position, deviation: [deviation; MAX_DRIVE_AXES] }
    }

    fn drain(tracks: &mut [Track]) -> Vec<(i64, Vec<f64>)> {
        std::iter::from_fn(|| next(tracks, |_, time_ns| planned(time_ns)))
            .map(|(time_ns, found)| {
                let off = found.iter().map(|axes| axes[0] - planned(time_ns)[0]);
                (time_ns, off.map(|off| (off * 1e9).round() / 1e9).collect())
            })
            .collect()
    }

    #[test]
    fn one_device_is_reported_as_it_comes() {
        let mut tracks = [Track::default()];
        for time_ns in [5, 5, 9] {
            tracks[0].push(off(time_ns, 0.25));
        }
        assert_eq!(drain(&mut tracks), [(5, vec![0.25]), (9, vec![0.25])]);
        assert_eq!(tracks[0].samples.len(), 1, "reported samples are forgotten");
    }

    #[test]
    fn others_are_where_they_were_between_their_samples() {
        let mut tracks = [Track::default(), Track::default()];
        tracks[0].push(off(10, 0.5));
        tracks[1].push(off(14, 0.1));
        // Where the second one was at 10 nobody knows; where the first is at 14 is not known yet.
        assert_eq!(drain(&mut tracks), []);
        tracks[0].push(off(18, 0.9));
        assert_eq!(drain(&mut tracks), [(14, vec![0.7, 0.1])]);
        tracks[1].push(off(24, 0.3));
        assert_eq!(drain(&mut tracks), [(18, vec![0.9, 0.18])]);
        // At the same time nothing is between.
        tracks[0].push(off(24, 1.5));
        assert_eq!(drain(&mut tracks), [(24, vec![1.5, 0.3]), (24, vec![1.5, 0.3])]);
    }

    #[test]
    fn a_device_that_has_ended_stays_off_the_plan_as_it_was() {
        let mut tracks = [Track::default(), Track::default()];
        tracks[0].push(off(10, 0.5));
        tracks[1].push(off(10, 0.1));
        tracks[1].push(off(20, 0.2));
        tracks[0].ended = true;
        assert_eq!(
            drain(&mut tracks),
            [(10, vec![0.5, 0.1]), (10, vec![0.5, 0.1]), (20, vec![0.5, 0.2])]
        );
    }

    /// Unknown positions are not reported: of the others only what was known while all were.
    #[test]
    fn a_device_that_is_lost_is_nowhere() {
        let mut tracks = [Track::default(), Track::default()];
        tracks[0].push(off(10, 0.5));
        tracks[0].push(off(15, 0.7));
        tracks[1].push(off(10, 0.1));
        tracks[1].push(off(20, 0.2));
        tracks[0].lost = true;
        let reported = drain(&mut tracks);
        assert_eq!(reported, [(10, vec![0.5, 0.1]), (10, vec![0.5, 0.1]), (15, vec![0.7, 0.15])]);
    }
}
