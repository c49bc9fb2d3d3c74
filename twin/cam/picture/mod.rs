//! Pictures of cams: position, velocity, acceleration and jerk over the master, and the tappets below.

mod bars;
mod lines;
mod ramp;

use bars::alternates;
pub(super) use bars::on_stretches;
pub(crate) use ramp::{RampPicture, ramp_chart};

use super::check::CamUse;
use super::sample::{at, reach as reached, reaches};
use lines::line_of;
use twin_cam::SlaveLimits;
use twin_machine::cam_file::CamFile;
use twin_number::beside;
use twin_plot::{
    Across, BACK, Chart, Color, Legend, MARK, Point, Row, Shape, Sign, Strip, Stroke, reach,
};

/// Height of a row of curves, pixels.
const HEIGHT: f64 = 150.0;
/// Of tappets whose signal has a period of two passes.
const OTHER_WAY_ROUND: &str = " in the first pass; the next one is the other way round";
/// Colour of what the slave may reach while its master accelerates and jerks.
const SIDES: usize = 3;

const QUANTITIES: [(&str, &str); 4] =
    [("position", ""), ("velocity", "/s"), ("acceleration", "/s²"), ("jerk", "/s³")];

#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown<'a> {
    pub(crate) file: &'a CamFile,
    /// How it is used; its limits are drawn where they are of the last one.
    pub(crate) using: &'a CamUse,
    /// What it is called in the legend.
    pub(crate) name: &'a str,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Recorded {
    /// Master, on the scale of the picture, and slave.
    pub(crate) points: Vec<Point>,
    /// Master and error of the slave, before and after.
    pub(crate) errors: [Vec<Point>; 2],
}

/// A chart of cams over each other, the last one in front.
pub(crate) fn cam_chart(
    heading: &str,
    below: &str,
    cams: &[Shown<'_>],
    recorded: &Recorded,
) -> Chart {
    let ends = cams.iter().flat_map(|shown| {
        let curve = shown.file.cam.curve();
        [curve.start(), curve.end()].map(|place| shown.using.master_at(place))
    });
    let ends = ends.chain(recorded.points.iter().map(|(master, _)| *master));
    let range = reach(ends).unwrap_or([0.0, 1.0]);
    let [master, slave] =
        cams.last().map_or(["u"; 2], |shown| [shown.file.master.unit(), shown.file.slave.unit()]);
    let quantities = 0..QUANTITIES.len();
    let mut rows: Vec<_> = quantities.map(|index| quantity(cams, recorded, index, slave)).collect();
    let has_sides = rows.iter().any(|row| row.shapes.iter().any(is_side));
    let has_limits = rows.iter().any(Row::shows_limit);
    if recorded.errors.iter().any(|errors| !errors.is_empty()) {
        rows.push(errors(recorded, slave));
    }
    let last = cams.last();
    let mut groups: Vec<_> =
        last.iter().flat_map(|shown| shown.file.cam.tappets()).map(|tappet| tappet.group).collect();
    groups.sort_unstable();
    groups.dedup();

    let solid = |color| Sign::Line(Stroke::solid(color, 2.2));
    let mut legend: Legend = cams
        .iter()
        .enumerate()
        .map(|(index, shown)| (solid(shade(index, cams.len())), shown.name.to_owned()))
        .collect();
    if !recorded.points.is_empty() {
        legend.push((Sign::Dot(MARK), "recorded".to_owned()));
    }
    if has_sides {
        let what = "least and greatest while the master accelerates and jerks";
        legend.push((solid(Color::series(SIDES)), what.to_owned()));
    }
    if has_limits {
        legend.push((Sign::Line(Stroke::dashed(MARK, 1.4)), "limit".to_owned()));
    }
    let mut strips = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        let Some(shown) = last else { continue };
        let color = Color::series(index + 1).with_opacity(0.75);
        strips.push(bar(shown, *group, color));
        let which = if groups.len() > 1 { format!(" of group {group}") } else { String::new() };
        let when = if alternates(shown, *group) { OTHER_WAY_ROUND } else { "" };
        legend.push((Sign::Patch(color), format!("tappets{which} that are on{when}")));
    }
    Chart {
        title: heading.to_owned(),
        subtitle: below.to_owned(),
        across: Across::new(range, format!("master ({master})")),
        rows,
        strips,
        legend,
    }
}

#[expect(clippy::indexing_slicing, reason = "of four quantities, two of which have sides")]
fn quantity(cams: &[Shown<'_>], recorded: &Recorded, index: usize, unit: &str) -> Row {
    let (name, per) = QUANTITIES[index];
    let value = |shown: &Shown<'_>, place: f64| at(shown.file, shown.using, place)[index + 1];
    let curves: Vec<_> = cams.iter().map(|shown| line_of(shown, |at| value(shown, at))).collect();
    // What the last one may reach while its master accelerates and jerks either way.
    let mut sides = Vec::new();
    let last = cams.last().filter(|shown| reaches(shown.using));
    if let (Some(shown), Some(derivative)) = (last, index.checked_sub(2)) {
        let both = |place: f64| reached(shown.file, shown.using, place)[derivative];
        sides = (0..2).map(|side| line_of(shown, |place| both(place)[side])).collect();
    }
    let limits = cams.last().map_or([f64::INFINITY; 2], |shown| {
        let SlaveLimits { velocity, acceleration, jerk } = shown.using.limits.motion;
        match index {
            0 => shown.using.limits.position,
            1 => [-velocity, velocity],
            2 => [-acceleration, acceleration],
            _ => [-jerk, jerk],
        }
    });
    let run = if index == 0 { recorded.points.as_slice() } else { &[] };
    let values = curves.iter().chain(&sides).flatten().chain(run).map(|(_, value)| *value);
    let mut row = Row::fitted(name, &format!("{unit}{per}"), HEIGHT, reach(values), &limits);
    row.shapes.push(Shape::Dots(run.to_vec(), MARK.with_opacity(0.55)));
    let thin = Stroke::solid(Color::series(SIDES), 0.9);
    row.shapes.extend(sides.into_iter().map(|side| Shape::Line(side, thin)));
    with_curves(row, curves)
}

fn is_side(shape: &Shape) -> bool {
    matches!(shape, Shape::Line(_, stroke) if stroke.color == Color::series(SIDES))
}

/// How far a recorded slave is from its cam.
fn errors(recorded: &Recorded, unit: &str) -> Row {
    let values = recorded.errors.iter().flatten().map(|(_, error)| *error);
    let values = reach(values.chain([0.0]));
    let mut row = Row::fitted("error of the slave", unit, HEIGHT, values, &[]);
    row.shapes.push(Shape::Level(0.0, Stroke::dashed(MARK, 1.1)));
    with_curves(row, recorded.errors.to_vec())
}

/// Adds curves, the last one in front, and what each of them reaches.
fn with_curves(mut row: Row, curves: Vec<Vec<Point>>) -> Row {
    let (count, scale) = (curves.len(), row.scale());
    for (index, curve) in curves.into_iter().enumerate() {
        let color = shade(index, count);
        if let Some([low, high]) = reach(curve.iter().map(|(_, value)| value / scale)) {
            let size = low.abs().max(high.abs());
            let [low, high] = [low, high].map(|value| beside(value, size, 4));
            row.notes.push((format!("{low} … {high}"), color));
        }
        row.shapes.push(Shape::Line(curve, Stroke::solid(color, 1.6)));
    }
    row
}

/// When the bit of a group is on, while the master goes forwards at its velocity.
fn bar(shown: &Shown<'_>, group: i16, color: Color) -> Strip {
    let master = |place| shown.using.master_at(place);
    let parts = on_stretches(shown, group).into_iter();
    let parts = parts.map(|[begin, end]| (master(begin), master(end), color));
    let tappets = shown.file.cam.tappets().iter().filter(|tappet| tappet.group == group);
    Strip {
        parts: parts.collect(),
        marks: tappets.map(|tappet| master(tappet.master)).collect(),
        ..Strip::new(&format!("tappets of group {group}"))
    }
}

/// Earlier curves are paler.
fn shade(index: usize, count: usize) -> Color {
    if index + 1 < count { BACK } else { Color::series(0) }
}
