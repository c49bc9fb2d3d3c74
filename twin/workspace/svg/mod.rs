//! A section as a picture: the singularity measure in colours, what bounds the workspace, and the machine.

mod page;

use super::Example;
use super::region::{Region, Vertex};
use super::scale::{BEYOND, Scale};
use super::section::{Cut, Section, Short};
use super::silhouette::{clip, silhouette, surroundings};
use super::space::State;
use super::survey::Workspace;
use crate::page::{FAINT, GRID, INK, MARK, color, fine, font, stroke};
use crate::physics::ObstacleKind;
use nalgebra::{Point2, Point3, Vector2};
use page::{NUMBERS, Page, Sign, cross};
use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Bends of lines that are not seen, pixels.
const UNSEEN: f64 = 0.15;
/// How strong the colours of axes beyond their limits are: where there are two, both are seen.
const TINT: f64 = 0.3;
/// Arrows of the machine frame are this long, pixels.
const ARROW: f64 = 34.0;

type Failure = DrawingAreaErrorKind<std::io::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Legend = Vec<(Sign, String)>;

/// A picture that could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the picture cannot be drawn: {0}")]
pub struct PictureError(#[from] Failure);

/// Draws a section as SVG.
///
/// # Errors
/// What plotters says.
pub fn picture(
    workspace: &Workspace<'_>,
    section: &Section<'_>,
    example: Option<&Example>,
) -> Result<String, PictureError> {
    let page = Page::new(section);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, page.size()).into_drawing_area();
        root.fill(&WHITE)?;
        let [left, top, right, bottom] = page.margins();
        let mut chart = ChartBuilder::on(&root)
            .margin_top(fine(top))
            .margin_right(fine(right))
            .margin_bottom(fine(bottom - NUMBERS))
            .set_label_area_size(LabelAreaPosition::Left, fine(left))
            .set_label_area_size(LabelAreaPosition::Bottom, fine(NUMBERS))
            .build_cartesian_2d(page.range(0), page.range(1))?;
        let drawing = Drawing { page, workspace, section };
        let scale = Scale::up_to(section.best.map_or(0.0, |best| best.measure));
        drawing.grid(&mut chart)?;
        let mut legend = drawing.beyond(&mut chart)?;
        drawing.measure(&mut chart, scale)?;
        drawing.surroundings(&mut chart, &mut legend)?;
        drawing.machine(&mut chart, &mut legend)?;
        drawing.boundaries(&mut chart, &mut legend)?;
        drawing.frame(&mut chart)?;
        drawing.marks(&mut chart, example, &mut legend)?;
        let (title, below) = drawing.words();
        Page::title(&root, &title, &below)?;
        page.sides(
            &root,
            match section.cut {
                Cut::Horizontal { .. } => ["x (mm)", "y (mm)"],
                Cut::Vertical { .. } => ["along the section (mm)", "z (mm)"],
            },
        )?;
        page.scale(&root, scale)?;
        page.legend(&root, &legend)?;
        root.present()?;
    }
    Ok(page.resized(&text))
}

/// The colour of a solid, red, green, blue and how much is seen of it, each up to 1.
fn of_solid([red, green, blue, _]: [f64; 4]) -> RGBColor {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    let byte = |part: f64| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
    RGBColor(byte(red), byte(green), byte(blue))
}

fn number(value: f64) -> String {
    Short(value).to_string()
}

/// A point as the chart counts, mm.
fn mm(at: &Point2<f64>) -> (f64, f64) {
    (at.x * 1e3, at.y * 1e3)
}

/// A picture being drawn.
struct Drawing<'a, 'm> {
    page: Page,
    workspace: &'a Workspace<'m>,
    section: &'a Section<'m>,
}

impl Drawing<'_, '_> {
    fn words(&self) -> (String, String) {
        let name = &self.workspace.space.machine().name;
        let direction = if self.workspace.turns_tool {
            format!(", tool at {}°", Short(self.section.space.direction().to_degrees()))
        } else {
            String::new()
        };
        let which = self.section.cut;
        let area = self.section.within.area();
        let measure = match (self.section.worst, self.section.best) {
            (Some(worst), Some(best)) if best.measure - worst.measure < 1e-6 => {
                format!(", measure {} everywhere", number(best.measure))
            }
            (Some(worst), Some(best)) => {
                format!(", measure {:.2} to {:.2}", worst.measure, best.measure)
            }
            _ => String::new(),
        };
        (
            format!("Workspace of {name}"),
            format!(
                "{which}{direction}; {:.0} cm² within the software limits{measure}",
                area * 1e4
            ),
        )
    }

    fn grid(&self, chart: &mut Chart<'_, '_>) -> Result<(), Failure> {
        let sides = self.page.max - self.page.min;
        let labels = |side: f64| {
            let part = side / sides.max();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "3 to 11")]
            let count = (part * 11.0).clamp(3.0, 11.0) as usize;
            count
        };
        chart
            .configure_mesh()
            .x_labels(labels(sides.x))
            .y_labels(labels(sides.y))
            .x_label_formatter(&|value| number(*value))
            .y_label_formatter(&|value| number(*value))
            .label_style(font(14.5, INK))
            .axis_style(FAINT.stroke_width(stroke(0.8)))
            .bold_line_style(GRID.stroke_width(stroke(0.8)))
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(fine(4.0))
            .draw()
    }

    /// Where axes are beyond their software limits.
    fn beyond(&self, chart: &mut Chart<'_, '_>) -> Result<Legend, Failure> {
        let mut legend = Legend::new();
        for ((index, axis), tint) in
            self.workspace.space.machine().axes.iter().enumerate().zip(BEYOND)
        {
            let is_beyond = |state| matches!(state, State::Beyond(axes) if axes.contains(index));
            let region = self.section.region_by_state(&is_beyond);
            if !region.loops.is_empty() {
                let tint = color(tint).mix(TINT);
                self.fill(chart, &region, &tint)?;
                legend.push((Sign::Patch(tint), format!("{} beyond its limits", axis.name)));
            }
        }
        Ok(legend)
    }

    /// The measure within the limits: every band over the one below, so that nothing shows between them.
    fn measure(&self, chart: &mut Chart<'_, '_>, scale: Scale) -> Result<(), Failure> {
        let lowest = scale.band(self.section.worst.map_or(0.0, |worst| worst.measure));
        self.fill(chart, &self.section.within, &color(scale.color(lowest)))?;
        for band in lowest + 1..scale.bands() {
            let least = scale.least(band);
            let region =
                self.section.region(&|sample| sample.is_within() && sample.measure >= least);
            self.fill(chart, &region, &color(scale.color(band)))?;
        }
        Ok(())
    }

    /// What bounds reach and workspace.
    fn boundaries(&self, chart: &mut Chart<'_, '_>, legend: &mut Legend) -> Result<(), Failure> {
        let reach = self.section.region_by_state(&|state| state != State::OutOfReach);
        let lines = reach.lines();
        for line in &lines {
            let line = self.visible(line);
            let style = FAINT.stroke_width(stroke(1.4));
            let (dash, gap) = (fine(5.0), fine(3.0));
            chart.plotting_area().draw(&DashedPathElement::new(line, dash, gap, style))?;
        }
        for line in self.section.within.lines() {
            let line = self.visible(&line);
            let style = INK.stroke_width(stroke(2.0));
            chart.plotting_area().draw(&PathElement::new(line, style))?;
        }
        legend.push((Sign::Line(INK, 2.0), "edge of the workspace".to_owned()));
        if !lines.is_empty() {
            legend.push((Sign::Dashes(FAINT), "edge of the reach".to_owned()));
        }
        Ok(())
    }

    /// The machine where programs start.
    fn machine(&self, chart: &mut Chart<'_, '_>, legend: &mut Legend) -> Result<(), Failure> {
        let machine = self.workspace.space.machine();
        let axes = self.workspace.stance();
        let color = RGBColor(60, 66, 78);
        let (fill, edge) = (color.mix(0.16), color.mix(0.75));
        for outline in silhouette(&machine.model, &axes, &self.section.plane) {
            self.body(chart, &outline, [fill, edge])?;
        }
        legend.push((Sign::Patch(fill), "machine".to_owned()));
        Ok(())
    }

    /// What is around the machine.
    fn surroundings(&self, chart: &mut Chart<'_, '_>, legend: &mut Legend) -> Result<(), Failure> {
        let Some(collision) = &self.workspace.space.machine().collision else { return Ok(()) };
        for (kind, shade, outline) in surroundings(collision, &self.section.plane) {
            let shade = of_solid(shade);
            let (fill, edge) = (shade.mix(0.35), shade.mix(0.9));
            self.body(chart, &outline, [fill, edge])?;
            let word = match kind {
                ObstacleKind::Fixture => "obstacles",
                ObstacleKind::Stock => "stock",
            };
            if !legend.iter().any(|(_, known)| known == word) {
                legend.push((Sign::Patch(fill), word.to_owned()));
            }
        }
        Ok(())
    }

    /// Something seen from a side.
    fn body(
        &self,
        chart: &mut Chart<'_, '_>,
        outline: &[Point2<f64>],
        [fill, edge]: [RGBAColor; 2],
    ) -> Result<(), Failure> {
        let outline = clip(outline, &self.page.min, &self.page.max);
        if outline.len() < 3 {
            return Ok(());
        }
        let mut points: Vec<_> = outline.iter().map(mm).collect();
        // What lies under everything, as the table of a portal, is told by its edges.
        if !self.page.is_filled_by(&outline, self.section.within.area()) {
            chart.plotting_area().draw(&Polygon::new(points.clone(), fill))?;
        }
        points.extend(points.first().copied());
        chart.plotting_area().draw(&PathElement::new(points, edge.stroke_width(stroke(0.8))))
    }

    /// The machine frame.
    fn frame(&self, chart: &mut Chart<'_, '_>) -> Result<(), Failure> {
        let plane = &self.section.plane;
        let length = self.page.metres(ARROW);
        let axes = [
            ("x", [length, 0.0, 0.0], RGBColor(200, 30, 30)),
            ("y", [0.0, length, 0.0], RGBColor(20, 130, 40)),
            ("z", [0.0, 0.0, length], RGBColor(30, 70, 200)),
        ];
        let origin = plane.project(&Point3::origin());
        if origin.coords.inf(&self.page.max.coords) != origin.coords
            || origin.coords.sup(&self.page.min.coords) != origin.coords
        {
            return Ok(());
        }
        for (name, end, color) in axes {
            let end = plane.project(&Point3::from(end));
            let way = end - origin;
            if way.norm() < length / 2.0 {
                continue;
            }
            let (along, aside) = (way.normalize(), Vector2::new(-way.y, way.x).normalize());
            let barb =
                |side: f64| end - (along * 7.0 + aside * side).map(|px| self.page.metres(px));
            let line = [origin, end, barb(3.5), end, barb(-3.5)];
            let style = color.stroke_width(stroke(1.8));
            let line: Vec<_> = line.iter().map(mm).collect();
            chart.plotting_area().draw(&PathElement::new(line, style))?;
            let style = font(15.0, color).pos(Pos::new(HPos::Center, VPos::Center));
            let word = end + along * self.page.metres(9.0);
            chart.plotting_area().draw(&Text::new(name, mm(&word), style))?;
        }
        Ok(())
    }

    /// Where programs start, and the example.
    fn marks(
        &self,
        chart: &mut Chart<'_, '_>,
        example: Option<&Example>,
        legend: &mut Legend,
    ) -> Result<(), Failure> {
        if let Some(start) = &self.workspace.start {
            let at = self.section.plane.project(start);
            let ring = MARK.stroke_width(stroke(2.0));
            chart.plotting_area().draw(&Circle::new(mm(&at), stroke(5.5), ring))?;
            legend.push((Sign::Ring, "start of programs".to_owned()));
        }
        if let Some(example) = example {
            let at = self.section.plane.project(&example.position);
            for line in cross((0.0, 0.0)) {
                let line = line.map(|(x, y)| {
                    mm(&(at + Vector2::new(self.page.metres(x), self.page.metres(y))))
                });
                let style = MARK.stroke_width(stroke(2.0));
                chart.plotting_area().draw(&PathElement::new(line.to_vec(), style))?;
            }
            legend.push((Sign::Cross, "worked example".to_owned()));
        }
        Ok(())
    }

    fn fill(
        &self,
        chart: &mut Chart<'_, '_>,
        region: &Region,
        color: &impl Color,
    ) -> Result<(), Failure> {
        let mut outline: Vec<(f64, f64)> = Vec::new();
        for one in &region.loops {
            // One polygon for all: there and back between the loops nothing is filled, and holes go the other way round.
            let corners: Vec<_> =
                one.iter().chain(one.first()).map(|Vertex { at, .. }| *at).collect();
            let back = outline.first().copied();
            outline.extend(self.visible(&corners));
            outline.extend(back);
        }
        if outline.len() < 3 {
            return Ok(());
        }
        chart.plotting_area().draw(&Polygon::new(outline, color.filled()))
    }

    /// A line without what is not seen of its bends, mm.
    fn visible(&self, line: &[Point2<f64>]) -> Vec<(f64, f64)> {
        let mut kept = Vec::new();
        if let [first, .., last] = line {
            kept.push(mm(first));
            straighten(line, self.page.metres(UNSEEN), &mut kept);
            kept.push(mm(last));
        }
        kept
    }
}

/// Adds what must be kept between the ends of a line for no point to be farther than `tolerance` from it (Douglas and
/// Peucker 1973).
fn straighten(line: &[Point2<f64>], tolerance: f64, kept: &mut Vec<(f64, f64)>) {
    let [first, between @ .., last] = line else { return };
    let chord = last - first;
    let length = chord.norm();
    let off = |point: &Point2<f64>| {
        let way = point - first;
        if length > tolerance { chord.perp(&way).abs() / length } else { way.norm() }
    };
    let farthest =
        between.iter().map(off).enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
    let Some((index, _)) = farthest.filter(|(_, distance)| *distance > tolerance) else {
        return;
    };
    let (before, after) = (line.get(..index + 2), line.get(index + 1..));
    straighten(before.unwrap_or_default(), tolerance, kept);
    kept.extend(between.get(index).map(mm));
    straighten(after.unwrap_or_default(), tolerance, kept);
}
