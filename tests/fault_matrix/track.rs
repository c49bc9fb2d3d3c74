//! Tracking check: compares the motion of an axis with the plan it follows, as seen from the device.
//!
//! A driver that loses a set-point unnoticed believes that the axis moves while it is at rest. So the axis may differ
//! from the plan by its usual tracking error, plus the plan's motion while the driver waits for the device: outage ×
//! speed. For a while after an outage the axis catches up; the cost of another outage during that time is added. Then
//! the tracking error must be as small as before.

/// Time that an axis may take to catch up after an outage, ns of the device, and a fourth of the outage, as it moves at least
/// five times as fast as the plan.
const CATCHING_UP_NS: i64 = 2_000_000_000;
const CATCHING_UP_PART: i64 = 4;

/// Pauses between looks that are so many times as long as the middle one of all are outages.
const OUTAGE: i64 = 3;

/// One look at the device.
#[derive(Clone, Copy, Debug)]
struct Look {
    time_ns: i64,
    /// Since the look before, ns.
    gap_ns: i64,
    /// Away from the plan, increments.
    off: f64,
}

/// The way of an axis.
#[derive(Debug, Default)]
pub(crate) struct Track(Vec<Look>);

impl Track {
    /// The device was seen at `counter` at some instant between these, at which the plan was between those positions.
    pub(crate) fn note(&mut self, (from_ns, to_ns): (i64, i64), plan: (f64, f64), counter: f64) {
        let off = (plan.0 - counter).max(counter - plan.1).max(0.0);
        let gap_ns = self.0.last().map_or(0, |last| to_ns - last.time_ns);
        debug_assert!(from_ns <= to_ns);
        self.0.push(Look { time_ns: to_ns, gap_ns, off });
    }

    /// Largest distance from the plan beyond what outages explain, increments.
    pub(crate) fn usual(&self, speed: f64) -> f64 {
        let outages = self.0.iter().zip(self.outages(speed));
        outages.map(|(look, outage)| look.off - outage).fold(0.0, f64::max)
    }

    /// Fails if it was ever farther away than twice what is usual and what outages explain.
    pub(crate) fn check(&self, usual: f64, speed: f64) -> Result<(), String> {
        for (look, outage) in self.0.iter().zip(self.outages(speed)) {
            let allowed = 2.0 * usual + outage;
            if look.off > allowed {
                return Err(format!(
                    "{:.0} off the plan at {} ms, {allowed:.0} would be the outage",
                    look.off,
                    look.time_ns / 1_000_000
                ));
            }
        }
        Ok(())
    }

    /// For each look the way of the plan during the outages of late, and once more during the longest pause: what was
    /// decided before it is acted on during it, and made good with the exchange after it, which knows the device as late.
    fn outages(&self, speed: f64) -> impl Iterator<Item = f64> {
        let mut gaps: Vec<i64> = self.0.iter().map(|look| look.gap_ns).collect();
        gaps.sort_unstable();
        let middle_ns = gaps.get(gaps.len() / 2).copied().unwrap_or(0);
        (0..self.0.len()).map(move |place| {
            let now_ns = self.0[place].time_ns;
            let of_late = self.0[..=place].iter().filter(|look| {
                now_ns - look.time_ns < CATCHING_UP_NS + look.gap_ns / CATCHING_UP_PART
            });
            let (mut longest_ns, mut sum_ns) = (0, 0);
            for look in of_late {
                longest_ns = longest_ns.max(look.gap_ns);
                if look.gap_ns > OUTAGE * middle_ns {
                    sum_ns += look.gap_ns;
                }
            }
            #[expect(clippy::cast_precision_loss, reason = "seconds")]
            let seconds = (longest_ns + sum_ns.max(longest_ns)) as f64 * 1e-9;
            speed * seconds
        })
    }
}

#[test]
fn a_set_point_that_is_lost_shows_and_an_outage_is_allowed_for() {
    const MS: i64 = 1_000_000;
    // 1000 increments/s, 10 off as usual, looked at every 10 ms; from 1 s on the axis stands for 300 ms.
    let track = |outage: bool| {
        let mut track = Track::default();
        for time_ms in (0_i64..3000).step_by(10) {
            let stands = (1000..1300).contains(&time_ms);
            if !(outage && stands) {
                let plan = f64::from(u32::try_from(time_ms).expect("small"));
                let counter = if stands { 990.0 } else { plan - 10.0 };
                track.note((time_ms * MS, time_ms * MS), (plan, plan), counter);
            }
        }
        track
    };
    assert!(track(true).check(10.0, 1000.0).is_ok(), "the driver was waiting");
    let lost = track(false).check(10.0, 1000.0).unwrap_err();
    assert!(lost.starts_with("50 off the plan at 1040 ms"), "{lost}");
    // 300 when it goes on, of which 20 are explained by looks every 10 ms.
    assert!((track(false).usual(1000.0) - 280.0).abs() < 1e-9);
}

#[test]
fn an_axis_catches_up_in_a_fourth_of_a_long_outage() {
    const MS: i64 = 1_000_000;
    // 1000 increments/s, looked at every 10 ms but for an outage of 8 s from 1 s on: 2 s and a fourth of it to catch up.
    let track = |until_ms: i64| {
        let mut track = Track::default();
        for time_ms in (0_i64..1000).chain(9000..15_000).step_by(10) {
            let plan = f64::from(u32::try_from(time_ms).expect("small"));
            let behind = if (9000..until_ms).contains(&time_ms) { 5000.0 } else { 0.0 };
            track.note((time_ms * MS, time_ms * MS), (plan, plan), plan - behind);
        }
        track
    };
    assert!(track(12_900).check(10.0, 1000.0).is_ok());
    assert!(track(13_100).check(10.0, 1000.0).is_err());
}

#[test]
fn outages_in_a_row_add_up() {
    const MS: i64 = 1_000_000;
    // 1000 increments/s, looked at every 10 ms but for two pauses of 100 ms, after each of which the axis is so much farther
    // behind than before.
    let track = |first: f64, second: f64| {
        let mut track = Track::default();
        for time_ms in (0_i64..3000).step_by(10) {
            let pauses = (1000..1100).contains(&time_ms) || (1200..1300).contains(&time_ms);
            if !pauses {
                let plan = f64::from(u32::try_from(time_ms).expect("small"));
                let behind = f64::from(u8::from((1100..2000).contains(&time_ms))) * first
                    + f64::from(u8::from((1300..2000).contains(&time_ms))) * second;
                track.note((time_ms * MS, time_ms * MS), (plan, plan), plan - behind);
            }
        }
        track
    };
    assert!(track(100.0, 100.0).check(10.0, 1000.0).is_ok());
    // Both pauses of 110 ms, the longest once more, and twice what is usual: 350.
    assert!(track(100.0, 249.0).check(10.0, 1000.0).is_ok());
    assert!(track(100.0, 251.0).check(10.0, 1000.0).is_err());
    // The second was not yet when the first had been.
    assert!(track(241.0, 0.0).check(10.0, 1000.0).is_err());
}
