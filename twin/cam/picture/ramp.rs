//! The picture of a start with a ramp: what the slave does before and after over the time, next to its cam.

use twin_cam::tune::{RampError, RampIn, RampMoment, RampShown, RampWish, on_cam, ramp_shown};
use twin_number::{beside, significant};
use twin_plot::{Across, BACK, Chart, Color, Legend, MARK, Point, Row, Shape, Sign, Stroke, reach};
use twin_profile::State;

/// Height of a row of curves, pixels.
const HEIGHT: f64 = 190.0;
/// Behind the end of the ramp the slave is shown on its cam for this part of the time.
const BEHIND: f64 = 0.12;
/// A ramp before that takes longer than this many times the one after is shown as far as that.
const LONGEST: f64 = 4.0;
/// Points of the cam's curve.
const POINTS: u32 = 600;

const CAM: Color = Color::rgb(44, 140, 80);

const QUANTITIES: [(&str, &str); 3] =
    [("position", ""), ("velocity", "/s"), ("acceleration", "/s²")];

#[derive(Debug)]
pub(crate) struct RampPicture<'a> {
    pub(crate) wish: &'a RampWish,
    /// The ramp that the cam's file has; none if it has no values for one.
    pub(crate) before: Option<RampIn>,
    pub(crate) after: RampIn,
    pub(crate) units: [&'a str; 2],
}

/// A chart of a start.
/// If there is no such start.
pub(crate) fn ramp_chart(
    heading: &str,
    below: &str,
    picture: &RampPicture<'_>,
) -> Result<Chart, RampError> {
    let RampPicture { wish, units, .. } = *picture;
    let after = ramp_shown(wish, &picture.after)?;
    let before = picture.before.as_ref().map(|ramp| ramp_shown(wish, ramp)).transpose()?;
    let longer = before.as_ref().map_or(0.0, |before| before.duration_s);
    let longest = longer.min(LONGEST * after.duration_s).max(after.duration_s);
    // A slave that is on its cam already is shown for a second.
    let end_s = if longest > 0.0 { longest * (1.0 + BEHIND) } else { 1.0 };
    let start = Start { wish, end_s, cam: cam(wish, end_s, &after)? };
    let duration = before.as_ref().map(|it| it.duration_s);
    let ramps = [(before, BACK), (Some(after), Color::series(0))];
    let rows = QUANTITIES.into_iter().enumerate();
    let rows: Vec<_> = rows
        .map(|(index, (name, per))| start.row(name, &format!("{}{per}", units[1]), &ramps, index))
        .collect();

    let on_cam = |duration: Option<f64>| match duration {
        Some(seconds) => {
            format!("with the ramp, on its cam after {} s", significant(seconds, 4))
        }
        None => "without a ramp, a jump".to_owned(),
    };
    let line = |color| Sign::Line(Stroke::solid(color, 2.2));
    let mut legend: Legend = vec![(Sign::Line(Stroke::dashed(CAM, 1.4)), "cam".to_owned())];
    legend.push((line(BACK), format!("before: {}", on_cam(duration))));
    let [_, (after, color)] = &ramps;
    let after = after.as_ref().map(|it| it.duration_s);
    legend.push((line(*color), format!("after: {}", on_cam(after))));
    if rows.iter().any(Row::shows_limit) {
        legend.push((Sign::Line(Stroke::dashed(MARK, 1.4)), "limit".to_owned()));
    }
    let name = format!(
        "time (s); the master goes on from {} {1} with {2} {1}/s",
        significant(wish.master.position, 6),
        units[0],
        significant(wish.master.velocity, 6)
    );
    Ok(Chart {
        title: heading.to_owned(),
        subtitle: below.to_owned(),
        across: Across::new([0.0, end_s], name),
        rows,
        strips: Vec::new(),
        legend,
    })
}

/// The cam over the time, on the turn of a rotary slave on which the ramp comes onto it.
fn cam(wish: &RampWish, end_s: f64, after: &RampShown) -> Result<Vec<(f64, State)>, RampError> {
    let last = after.stretches.last().and_then(|stretch| stretch.last());
    let by = match last {
        Some(last) => last.cam.position - on_cam(wish, last.time_s)?.position,
        None => 0.0,
    };
    let times = (0..=POINTS).map(|index| end_s * f64::from(index) / f64::from(POINTS));
    let state = |time_s: f64| {
        let mut state = on_cam(wish, time_s)?;
        state.position += by;
        Ok((time_s, state))
    };
    times.map(state).collect()
}

#[expect(clippy::indexing_slicing, reason = "of three quantities")]
fn part(state: &State, quantity: usize) -> f64 {
    [state.position, state.velocity, state.acceleration][quantity]
}

/// A start that is being drawn.
struct Start<'a> {
    wish: &'a RampWish,
    end_s: f64,
    cam: Vec<(f64, State)>,
}

impl Start<'_> {
    fn row(
        &self,
        name: &str,
        unit: &str,
        ramps: &[(Option<RampShown>, Color)],
        quantity: usize,
    ) -> Row {
        let cam: Vec<Point> =
            self.cam.iter().map(|(time, state)| (*time, part(state, quantity))).collect();
        let lines: Vec<_> = ramps
            .iter()
            .map(|(ramp, _)| match ramp {
                Some(ramp) => self.slave(ramp, quantity),
                // Without a ramp it jumps at once.
                None => [&[(0.0, part(&self.wish.slave, quantity))], cam.as_slice()].concat(),
            })
            .collect();
        let (velocity, acceleration) = (self.wish.limits.velocity, self.wish.limits.acceleration);
        let limits = match quantity {
            0 => self.wish.position,
            1 => [-velocity, velocity],
            _ => [-acceleration, acceleration],
        };
        let values = lines.iter().flatten().chain(&cam).map(|(_, value)| *value);
        let mut row = Row::fitted(name, unit, HEIGHT, reach(values), &limits);
        let scale = row.scale();
        for (line, (ramp, color)) in lines.into_iter().zip(ramps) {
            // From here on the slave is on its cam.
            let duration = ramp.as_ref().map(|ramp| ramp.duration_s);
            if let Some(end) = duration.filter(|end| *end <= self.end_s) {
                let thin = Stroke::solid(color.with_opacity(0.6), 0.9);
                row.shapes.push(Shape::Upright(end, thin));
            }
            if let Some([low, high]) = reach(line.iter().map(|(_, value)| value / scale)) {
                let [low, high] = [low, high].map(|value| beside(value, high - low, 4));
                row.notes.push((format!("{low} … {high}"), *color));
            }
            row.shapes.push(Shape::Line(line, Stroke::solid(*color, 1.8)));
        }
        row.shapes.push(Shape::Line(cam, Stroke::dashed(CAM, 1.2)));
        row
    }

    /// What the slave does: the ramp, and its cam behind it.
    fn slave(&self, shown: &RampShown, quantity: usize) -> Vec<Point> {
        let moments = shown.stretches.iter().flatten();
        let moments = moments.filter(|moment: &&RampMoment| moment.time_s <= self.end_s);
        let mut line: Vec<_> = vec![(0.0, part(&self.wish.slave, quantity))];
        line.extend(moments.map(|moment| (moment.time_s, part(&moment.slave, quantity))));
        // A ramp before may come onto its cam a turn away.
        let last = shown.stretches.last().and_then(|stretch| stretch.last());
        let by = last.filter(|_| quantity == 0).map_or(0.0, |last| {
            let near = self.cam.iter().min_by(|one, other| {
                (one.0 - last.time_s).abs().total_cmp(&(other.0 - last.time_s).abs())
            });
            let period = self.wish.table.slave_period.filter(|period| *period > 0.0);
            match (near, period) {
                (Some((_, state)), Some(period)) => {
                    ((last.slave.position - state.position) / period).round() * period
                }
                _ => 0.0,
            }
        });
        let behind = self.cam.iter().filter(|(time, _)| *time > shown.duration_s);
        line.extend(behind.map(|(time, state)| (*time, part(state, quantity) + by)));
        line
    }
}
