//! Page layout (rerun blueprint): the arrangement of 3D views, plots and text, so that no user has to arrange anything.
//!
//! Left: machine with path and trails, below it a close-up of the tool, the program and the names. Right: tool
//! error, axis errors, clearance, signals, speed; motors in a tab. A layout is a recording (a blueprint); rerun's
//! Rust interface does not reach cameras and time ranges, so archetypes are logged one by one.

use nalgebra::Vector3;
use rerun::blueprint::components as parts;
use rerun::external::re_sdk_types::blueprint::archetypes as layout;
use rerun::{AsComponents, components, datatypes};

use crate::bounds::Bounds;
use crate::error::{Result, VizError};
use crate::frame::{Axis, AxisUnit};
use crate::motor_plot::MotorPlot;
use crate::recorder::Recorder;
use crate::timeline::{Playback, TIME};
use crate::units::{f32_of, mm, mm_f32, point_mm, vector_mm};

/// Half the height of the camera's view, rad: rerun's camera sees 55° from top to bottom.
const HALF_VIEW: f64 = 0.48;
/// From where the machine is looked at: from the front right, above.
const FROM: [f64; 3] = [0.45, -1.0, 1.1];

/// From where the tool is looked at, close up.
const ABOVE: [f64; 3] = [0.0, -0.35, 0.94];
/// A machine does not fill the sphere around it: the camera may go this much closer than the sphere asks for.
const CLOSER: f64 = 0.88;

/// Parameters of the layout.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// The axes, which may need one plot for degrees and one for mm.
    pub(crate) axes: Vec<Axis>,
    /// Plots of the motors; empty if the motors are not known.
    pub(crate) motors: Vec<MotorPlot>,
    /// True if the clearance is measured.
    pub(crate) has_clearance: bool,
    /// Signals are switched along the way.
    pub(crate) has_signals: bool,
    /// Height of what the close-up shows, m.
    pub(crate) close_up: f64,
}

/// Sends the layout with the recording.
pub(crate) fn send(
    recording: &mut Recorder,
    layout: &Layout,
    bounds: &Bounds,
    playback: Playback,
) -> Result<()> {
    send_page(recording, playback, |page| page.everything(layout, bounds))
}

/// Sends the layout of a workspace: machine and section, with their description.
pub(crate) fn send_workspace(recording: &mut Recorder, bounds: &Bounds) -> Result<()> {
    send_page(recording, Playback::FromStart, |page| {
        let contents = ["+ /machine/**", "+ /surroundings/**", "+ /workspace/**"];
        let scene = page.scene("Machine and workspace", &contents, bounds)?;
        let about = page.text("What is shown", "about")?;
        page.row(&[scene, about], &[3.0, 1.0])
    })
}

/// Sends the layout that `arrange` makes.
fn send_page(
    recording: &mut Recorder,
    playback: Playback,
    arrange: impl FnOnce(&mut Page) -> Result<Part, VizError>,
) -> Result<()> {
    let mut page = Page { stream: recording.layout(), last_id: 0 };
    let root = arrange(&mut page)?;
    page.panels(playback)?;
    let viewport = layout::ViewportBlueprint::new()
        .with_root_container(root.uuid())
        .with_auto_layout(false)
        .with_auto_views(false);
    page.stream.log("viewport", &viewport)?;
    recording.send_layout(page.stream)
}

/// A container or a view of the page.
#[derive(Clone, Copy, Debug)]
struct Part {
    kind: &'static str,
    id: u8,
}

impl Part {
    fn uuid(self) -> datatypes::Uuid {
        let mut bytes = *b"twin-layout-\0\0\0\0";
        bytes[15] = self.id;
        datatypes::Uuid { bytes }
    }

    fn path(self) -> String {
        // As rerun writes UUIDs: 8-4-4-4-12 hexadecimal digits.
        let number = u128::from_be_bytes(self.uuid().bytes);
        let group = |shift: u32, digits: u32| (number >> shift) & ((1 << (4 * digits)) - 1);
        format!(
            "{}/{:08x}-{:04x}-{:04x}-{:04x}-{:012x}",
            self.kind,
            group(96, 8),
            group(80, 4),
            group(64, 4),
            group(48, 4),
            group(0, 12)
        )
    }
}

struct Page {
    stream: Recorder,
    last_id: u8,
}

impl Page {
    fn everything(&mut self, layout: &Layout, bounds: &Bounds) -> Result<Part> {
        let contents = [
            "+ /machine/**",
            "+ /surroundings/**",
            "+ /nearest/**",
            "+ /program/**",
            "+ /trail/**",
            "+ /tool/**",
        ];
        let scene = self.scene("Machine and paths", &contents, bounds)?;
        self.keep_trails(scene)?;
        let close_up = self.close_up(layout)?;
        let here = self.text("Program", "program/here")?;
        let about = self.text("What is shown", "about")?;
        let words = self.column(&[here, about], &[1.1, 1.0])?;
        let below = self.row(&[close_up, words], &[1.0, 1.25])?;
        let left = self.column(&[scene, below], &[1.75, 1.0])?;

        // The higher a plot, the more often the numbers of its axis find room: those of the errors matter most.
        let mut plots = vec![self.plot("Tool error (mm)", "error/tool")?];
        let mut shares = vec![1.5];
        for (unit, name, origin) in [
            (AxisUnit::Rotary, "Axis errors (degrees)", "error/axis_deg"),
            (AxisUnit::Linear, "Axis errors (mm)", "error/axis_mm"),
        ] {
            if layout.axes.iter().any(|axis| axis.unit == unit) {
                plots.push(self.plot(name, origin)?);
                shares.push(1.25);
            }
        }
        if layout.has_clearance {
            plots.push(self.plot("Clearance (mm)", "clearance")?);
            shares.push(1.0);
        }
        if layout.has_signals {
            plots.push(self.plot("Switched (low: off, high: on)", "switched")?);
            shares.push(0.75);
        }
        plots.push(self.plot("Speed along the path (mm/s)", "speed")?);
        shares.push(0.75);
        let errors = self.column(&plots, &shares)?;
        let right = self.beside_motors(errors, &layout.motors)?;
        self.row(&[left, right], &[3.0, 2.0])
    }

    /// The errors, and in a tab behind them what the motors do, if anything is known of them.
    fn beside_motors(&mut self, errors: Part, motors: &[MotorPlot]) -> Result<Part> {
        if motors.is_empty() {
            return Ok(errors);
        }
        let mut plots = Vec::with_capacity(motors.len());
        for plot in motors {
            plots.push(self.plot(plot.title(), plot.entity())?);
        }
        let motors = self.column(&plots, &vec![1.0; plots.len()])?;
        self.tabs(&[(errors, "Errors and speed"), (motors, "Motors")])
    }

    fn panels(&mut self, playback: Playback) -> Result<()> {
        let collapsed = layout::PanelBlueprint::new().with_state(parts::PanelState::Collapsed);
        self.stream.log("blueprint_panel", &collapsed)?;
        self.stream.log("selection_panel", &collapsed)?;
        let play_state = match playback {
            Playback::FromStart => parts::PlayState::Playing,
            Playback::Follow => parts::PlayState::Following,
        };
        let time = layout::TimePanelBlueprint::new()
            .with_state(parts::PanelState::Collapsed)
            .with_timeline(TIME)
            .with_play_state(play_state)
            .with_loop_mode(parts::LoopMode::Off);
        self.stream.log("time_panel", &time)?;
        Ok(())
    }

    /// The machine and what belongs to it, in space.
    fn scene(&mut self, title: &str, contents: &[&str], bounds: &Bounds) -> Result<Part> {
        let (center, radius) = bounds.sphere().unwrap_or_default();
        let spacing = grid_spacing(mm(radius));
        let name = format!("{title} (grid {spacing} mm)");
        let view = self.view("3D", &name, "/", contents)?;
        let eye = center + Vector3::from(FROM).normalize() * (radius / HALF_VIEW.sin() * CLOSER);
        let camera = layout::EyeControls3D::new()
            .with_kind(parts::Eye3DKind::Orbital)
            .with_position(point_mm(&eye))
            .with_look_target(point_mm(&center))
            .with_eye_up([0.0, 0.0, 1.0]);
        self.property(view, "EyeControls3D", &camera)?;
        self.property(view, "Background", &background())?;
        let floor = components::Plane3D::from(datatypes::Plane3D::new(
            [0.0, 0.0, 1.0],
            mm_f32(bounds.floor().unwrap_or_default()),
        ));
        let grid = layout::LineGrid3D::new()
            .with_visible(true)
            .with_spacing(spacing)
            .with_plane(floor)
            .with_stroke_width(1.0)
            .with_color(components::Color::from_rgb(48, 53, 60));
        self.property(view, "LineGrid3D", &grid)?;
        Ok(view)
    }

    /// The surroundings of the set-point, moving with it: deviations of a hundredth of a millimetre are seen here.
    fn close_up(&mut self, layout: &Layout) -> Result<Part> {
        let width = mm(layout.close_up);
        let name = format!("At the tool ({width} mm high)");
        let contents = [
            "+ /program/cuts/**",
            "+ /program/rapids/**",
            "+ /program/prepared/**",
            "+ /trail/**",
            "+ /tool/**",
        ];
        let view = self.view("3D", &name, "/tool/set-point", &contents)?;
        // From above, a little tilted: straight from above, a tool that moves up or down would hit the camera.
        let eye = Vector3::from(ABOVE).normalize() * (layout.close_up / 2.0 / HALF_VIEW.tan());
        let camera = layout::EyeControls3D::new()
            .with_kind(parts::Eye3DKind::Orbital)
            .with_position(vector_mm(&eye))
            .with_look_target([0.0_f32; 3])
            .with_eye_up([0.0, 0.0, 1.0]);
        self.property(view, "EyeControls3D", &camera)?;
        self.property(view, "Background", &background())?;
        self.property(view, "LineGrid3D", &layout::LineGrid3D::new().with_visible(false))?;
        self.keep_trails(view)?;
        Ok(view)
    }

    /// Trails come in pieces; all up to the cursor are shown, not only the newest.
    fn keep_trails(&mut self, view: Part) -> Result<()> {
        let range = datatypes::VisibleTimeRange {
            timeline: TIME.into(),
            range: datatypes::TimeRange {
                start: datatypes::TimeRangeBoundary::Infinite,
                end: datatypes::TimeRangeBoundary::AT_CURSOR,
            },
        };
        for trail in ["set-point", "twin", "drives", "switched"] {
            let path = format!("{}/ViewContents/overrides/trail/{trail}/visualizers", view.path());
            self.stream.log(path, &layout::VisibleTimeRanges::new([range.clone()]))?;
        }
        Ok(())
    }

    fn plot(&mut self, name: &str, origin: &str) -> Result<Part> {
        let view = self.view("TimeSeries", name, origin, &["+ $origin/**"])?;
        let legend =
            layout::PlotLegend::new().with_visible(true).with_corner(parts::Corner2D::RightTop);
        self.property(view, "PlotLegend", &legend)?;
        Ok(view)
    }

    fn text(&mut self, name: &str, entity: &str) -> Result<Part> {
        self.view("TextDocument", name, entity, &["+ $origin"])
    }

    fn view(&mut self, class: &str, name: &str, origin: &str, contents: &[&str]) -> Result<Part> {
        let view = self.part("view");
        let contents = contents.iter().map(|query| parts::QueryExpression((*query).into()));
        self.stream
            .log(format!("{}/ViewContents", view.path()), &layout::ViewContents::new(contents))?;
        let blueprint =
            layout::ViewBlueprint::new(class).with_display_name(name).with_space_origin(origin);
        self.stream.log(view.path(), &blueprint)?;
        Ok(view)
    }

    fn property(&mut self, view: Part, name: &str, value: &impl AsComponents) -> Result<()> {
        self.stream.log(format!("{}/{name}", view.path()), value)?;
        Ok(())
    }

    fn row(&mut self, parts: &[Part], shares: &[f32]) -> Result<Part> {
        let row = layout::ContainerBlueprint::new(parts::ContainerKind::Horizontal)
            .with_col_shares(shares.iter().copied().map(parts::ColumnShare::from));
        self.container(&row, parts)
    }

    fn column(&mut self, parts: &[Part], shares: &[f32]) -> Result<Part> {
        let column = layout::ContainerBlueprint::new(parts::ContainerKind::Vertical)
            .with_row_shares(shares.iter().copied().map(parts::RowShare::from));
        self.container(&column, parts)
    }

    /// One behind the other, the first in front, with their names.
    fn tabs(&mut self, parts: &[(Part, &str)]) -> Result<Part> {
        for (part, name) in parts {
            let named = layout::ContainerBlueprint::update_fields().with_display_name(*name);
            self.stream.log(part.path(), &named)?;
        }
        let parts: Vec<_> = parts.iter().map(|(part, _)| *part).collect();
        let mut tabs = layout::ContainerBlueprint::new(parts::ContainerKind::Tabs);
        if let Some(first) = parts.first() {
            tabs = tabs.with_active_tab(first.path().as_str());
        }
        self.container(&tabs, &parts)
    }

    fn container(
        &mut self,
        container: &layout::ContainerBlueprint,
        parts: &[Part],
    ) -> Result<Part> {
        let part = self.part("container");
        let contents = parts.iter().map(|part| parts::IncludedContent(part.path().into()));
        self.stream.log(part.path(), &container.clone().with_contents(contents))?;
        Ok(part)
    }

    fn part(&mut self, kind: &'static str) -> Part {
        self.last_id += 1;
        Part { kind, id: self.last_id }
    }
}

/// Dark, regardless of the theme of the browser: the colours of the paths are chosen for it.
fn background() -> layout::Background {
    layout::Background::new(parts::BackgroundKind::SolidColor)
        .with_color(components::Color::from_rgb(24, 27, 32))
}

/// A round number of mm (1, 2 or 5 times a power of ten) of which some ten fit the scene.
fn grid_spacing(radius_mm: f64) -> f32 {
    let wanted = (radius_mm / 5.0).max(0.1);
    let decade = 10.0_f64.powf(wanted.log10().floor());
    let round =
        [1.0, 2.0, 5.0, 10.0].into_iter().find(|step| step * decade >= wanted).unwrap_or(10.0);
    f32_of(round * decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_ten_round_steps_fit_the_scene() {
        for (radius_mm, spacing) in
            [(5.0, 1.0), (6.0, 2.0), (24.0, 5.0), (26.0, 10.0), (400.0, 100.0), (1200.0, 500.0)]
        {
            assert!(
                (grid_spacing(radius_mm) - spacing).abs() < 1e-6 * spacing,
                "{radius_mm}: {}",
                grid_spacing(radius_mm)
            );
        }
        // A machine without extent still gets a grid.
        assert!((grid_spacing(0.0) - 0.1).abs() < 1e-6);
    }

    #[test]
    fn parts_have_paths_that_rerun_takes_for_ids() {
        let part = Part { kind: "view", id: 0xab };
        let path = part.path();
        let (kind, id) = path.split_once('/').unwrap();
        assert_eq!(kind, "view");
        let groups: Vec<usize> = id.split('-').map(str::len).collect();
        assert_eq!(groups, [8, 4, 4, 4, 12]);
        // "twin-layout-" in ASCII, then the number of the part.
        assert_eq!(id.replace('-', ""), "7477696e2d6c61796f75742d000000ab");
    }
}
