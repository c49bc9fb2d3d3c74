//! A section as a picture: the singularity measure in colours, the edge of the workspace, and the machine.

use super::Example;
use super::region::Region;
use super::scale::{BEYOND, Scale};
use super::section::{Cut, Section};
use super::silhouette::{silhouette, surroundings};
use super::space::State;
use super::survey::Workspace;
use nalgebra::{Point2, Point3};
use std::collections::BTreeMap;
use twin_physics::ObstacleKind;

use twin_plot::{Color, FAINT, INK, Legend, MARK, Map, Paint, Sheet, Sign, Stroke, short};

/// Largest size of the section on the page, pixels.
const LARGEST: twin_plot::Point = (690.0, 620.0);
/// Opacity of the colours of axes beyond their limits: where there are two, both are seen.
const TINT: f64 = 0.3;
/// Arrows of the machine frame are this long, pixels.
const ARROW: f64 = 36.0;
const MACHINE: Color = Color::rgb(60, 66, 78);

/// A polygon and its paint.
type Body = (Vec<twin_plot::Point>, Paint);

/// Draws a section as SVG.
pub fn picture(
    workspace: &Workspace<'_>,
    section: &Section<'_>,
    example: Option<&Example>,
) -> String {
    let machine = workspace.space.machine();
    let scale = Scale::up_to(section.best.map_or(0.0, |best| best.measure));
    let beyond = beyond(workspace, section);
    let reach = section.region_by_state(&|state| state != State::OutOfReach).lines();
    let around = around(workspace, section);

    let mut legend = Legend::new();
    legend.extend(beyond.iter().map(|(name, tint, _)| (Sign::Patch(*tint), name.clone())));
    legend.extend(around.iter().map(|(word, (fill, _))| (Sign::Patch(*fill), (*word).to_owned())));
    legend.push((Sign::Patch(MACHINE.with_opacity(0.16)), "machine".to_owned()));
    let edges = [
        (Stroke::solid(INK, 2.0), "edge of the workspace", true),
        (
            Stroke { dash: Some([5.0, 3.0]), ..Stroke::solid(FAINT, 1.4) },
            "edge of the reach",
            !reach.is_empty(),
        ),
    ];
    let shown = edges.into_iter().filter(|(.., is_shown)| *is_shown);
    legend.extend(shown.map(|(stroke, word, _)| (Sign::Line(stroke), word.to_owned())));
    let marks = [
        (workspace.start, Sign::Ring(MARK), "start of programs"),
        (example.map(|example| example.position), Sign::Plus(MARK), "worked example"),
    ];
    let known = marks.iter().filter(|(at, ..)| at.is_some());
    legend.extend(known.map(|(_, sign, word)| (*sign, (*word).to_owned())));

    let mut map = Map::new(&Sheet {
        title: &format!("Workspace of {}", machine.name),
        subtitle: &subtitle(workspace, section),
        names: match section.cut {
            Cut::Horizontal { .. } => ["x (mm)", "y (mm)"],
            Cut::Vertical { .. } => ["along the section (mm)", "z (mm)"],
        },
        range: [section.grid.min, section.grid.max()].map(|corner| mm(&corner)),
        largest: LARGEST,
        scale: Some(twin_plot::Scale {
            name: "singularity measure".to_owned(),
            colors: (0..scale.bands()).map(|band| scale.color(band)).collect(),
            step: scale.least(1),
        }),
        legend: &legend,
    });
    for (_, tint, region) in &beyond {
        map.area("beyond", &loops(region), *tint);
    }
    measure(&mut map, section, scale);
    let bodies = around.into_values().flat_map(|(_, bodies)| bodies);
    for (outline, paint) in bodies.chain(bodies_of_machine(workspace, section)) {
        map.area("body", &[outline], paint);
    }
    let line = |line: Vec<Point2<f64>>| line.iter().map(mm).collect::<Vec<_>>();
    let [(inner, ..), (outer, ..)] = edges;
    for edge in reach {
        map.line("reach", &line(edge), outer);
    }
    for edge in section.within.lines() {
        map.line("edge", &line(edge), inner);
    }
    frame(&mut map, section);
    for (at, sign, _) in marks {
        if let Some(at) = at {
            map.sign(mm(&section.plane.project(&at)), sign);
        }
    }
    map.finish(&legend)
}

fn mm(at: &Point2<f64>) -> twin_plot::Point {
    (at.x * 1e3, at.y * 1e3)
}

fn loops(region: &Region) -> Vec<Vec<twin_plot::Point>> {
    region.loops.iter().map(|one| one.iter().map(|vertex| mm(&vertex.at)).collect()).collect()
}

fn subtitle(workspace: &Workspace<'_>, section: &Section<'_>) -> String {
    let direction = if workspace.turns_tool {
        format!(", tool at {}°", short(section.space.direction().to_degrees()))
    } else {
        String::new()
    };
    let measure = match (section.worst, section.best) {
        (Some(worst), Some(best)) if best.measure - worst.measure < 1e-6 => {
            format!(", measure {} everywhere", short(best.measure))
        }
        (Some(worst), Some(best)) => {
            format!(", measure {:.2} to {:.2}", worst.measure, best.measure)
        }
        _ => String::new(),
    };
    format!(
        "{}{direction}; {:.0} cm² within the software limits{measure}",
        section.cut,
        section.within.area() * 1e4
    )
}

/// Where axes are beyond their software limits.
fn beyond(workspace: &Workspace<'_>, section: &Section<'_>) -> Vec<(String, Color, Region)> {
    let axes = workspace.space.machine().axes.iter().enumerate().zip(BEYOND);
    let regions = axes.map(|((index, axis), tint)| {
        let is_beyond = |state| matches!(state, State::Beyond(axes) if axes.contains(index));
        let name = format!("{} beyond its limits", axis.name);
        (name, tint.with_opacity(TINT), section.region_by_state(&is_beyond))
    });
    regions.filter(|(.., region)| !region.loops.is_empty()).collect()
}

/// The measure within the limits: every band over the one below, so that nothing shows between them.
fn measure(map: &mut Map, section: &Section<'_>, scale: Scale) {
    let lowest = scale.band(section.worst.map_or(0.0, |worst| worst.measure));
    map.area("measure", &loops(&section.within), scale.color(lowest));
    for band in lowest + 1..scale.bands() {
        let least = scale.least(band);
        let region = section.region(&|sample| sample.is_within() && sample.measure >= least);
        if !region.loops.is_empty() {
            map.area("measure", &loops(&region), scale.color(band));
        }
    }
}

/// Obstacles and stock, by what they are called.
fn around(
    workspace: &Workspace<'_>,
    section: &Section<'_>,
) -> BTreeMap<&'static str, (Color, Vec<Body>)> {
    let mut around = BTreeMap::new();
    let Some(collision) = &workspace.space.machine().collision else { return around };
    for (kind, [red, green, blue, _], outline) in surroundings(collision, &section.plane) {
        let color = Color::from_parts([red, green, blue]);
        let word = match kind {
            ObstacleKind::Fixture => "obstacles",
            ObstacleKind::Stock => "stock",
        };
        let fill = color.with_opacity(0.35);
        let (_, bodies) = around.entry(word).or_insert_with(|| (fill, Vec::new()));
        bodies.push(body(section, &outline, fill, color.with_opacity(0.9)));
    }
    around
}

/// The machine where programs start.
fn bodies_of_machine(workspace: &Workspace<'_>, section: &Section<'_>) -> Vec<Body> {
    let model = &workspace.space.machine().model;
    let outlines = silhouette(model, &workspace.stance(), &section.plane);
    let [fill, edge] = [0.16, 0.75].map(|opacity| MACHINE.with_opacity(opacity));
    outlines.iter().map(|outline| body(section, outline, fill, edge)).collect()
}

/// A solid seen from a side. What lies under everything, as the table of a portal, is shown by its edges.
fn body(section: &Section<'_>, outline: &[Point2<f64>], fill: Color, edge: Color) -> Body {
    let (min, max) = (section.grid.min, section.grid.max());
    let inside: Vec<_> = outline.iter().map(|point| point.sup(&min).inf(&max)).collect();
    let sides = inside.iter().zip(inside.iter().cycle().skip(1));
    let double = sides.map(|(one, other)| one.coords.perp(&other.coords)).sum::<f64>();
    let fills_it = double / 2.0 > 0.5 * (max - min).product().min(section.within.area());
    let paint = Paint { fill: (!fills_it).then_some(fill), edge: Some(Stroke::solid(edge, 0.8)) };
    (outline.iter().map(mm).collect(), paint)
}

/// The machine frame, where it is on the map.
fn frame(map: &mut Map, section: &Section<'_>) {
    let origin = section.plane.project(&Point3::origin());
    if origin.inf(&section.grid.max()) != origin || origin.sup(&section.grid.min) != origin {
        return;
    }
    let axes = [
        ("x", Point3::new(1.0, 0.0, 0.0), Color::rgb(200, 30, 30)),
        ("y", Point3::new(0.0, 1.0, 0.0), Color::rgb(20, 130, 40)),
        ("z", Point3::new(0.0, 0.0, 1.0), Color::rgb(30, 70, 200)),
    ];
    for (name, end, color) in axes {
        let way = section.plane.project(&end) - origin;
        if way.norm() > 0.5 {
            map.arrow(mm(&origin), (way.x, way.y), ARROW * way.norm(), color, name);
        }
    }
}
