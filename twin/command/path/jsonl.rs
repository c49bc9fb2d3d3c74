//! Path elements and set-points as JSON, one object per line.

use crate::finding::file_name;
use nalgebra::{Point3, Vector3};
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::io::{self, Write};
use twin_kinematics::WorkFrame;
use twin_number::significant;
use twin_path::{AxisMask, EXTRA_AXES, ElementKind, FilePath, PathElement, ProbeOutcome, Shape};
use twin_planner::controller::{Status, ToolSetpoint};

/// Digits of the numbers written; a double is preserved by 17, and 12 are a picometre on a metre.
const DIGITS: usize = 12;

#[derive(serde::Serialize)]
struct Row {
    line: u32,
    /// The subroutine file that has the line.
    #[serde(serialize_with = "file_name", skip_serializing_if = "Option::is_none")]
    file: Option<FilePath>,
    /// Line of the program that calls it.
    #[serde(skip_serializing_if = "Option::is_none")]
    called_from: Option<u32>,
    block: Option<u32>,
    kind: &'static str,
    start_mm: [Number; 3],
    end_mm: [Number; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    center_mm: Option<[Number; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    normal: Option<[Number; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sweep_deg: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    m: Option<u16>,
    #[serde(skip_serializing_if = "Option::is_none")]
    k: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    l: Option<Number>,
    /// dP1 to dP8 of an M function.
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<[Number; 8]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dwell_s: Option<Number>,
    #[serde(skip_serializing_if = "Option::is_none")]
    probe: Option<ProbeRow>,
    /// Start and end of the extra axes that move, u.
    #[serde(skip_serializing_if = "Option::is_none")]
    extra: Option<BTreeMap<char, [Number; 2]>>,
    /// Axes that move with the S profile.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    s_profile: Vec<char>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    switches: Vec<SwitchRow>,
    length_mm: Number,
    feed_mm_per_s: Number,
    end_velocity_mm_per_s: Number,
}

/// What a probing move is.
#[derive(serde::Serialize)]
struct ProbeRow {
    /// Its G word.
    word: String,
    /// Whether it ends where the probe trips; null if nobody knows what it could touch.
    tripped: Option<bool>,
}

/// A switch and where along its element (0 to 1) it is.
#[derive(serde::Serialize)]
struct SwitchRow {
    number: u8,
    on: bool,
    at: Number,
}

type Number = Box<RawValue>;

fn number(value: f64) -> Number {
    let text = significant(value, DIGITS);
    // JSON has no infinity and no NaN: null.
    RawValue::from_string(text).unwrap_or_else(|_| RawValue::NULL.to_owned())
}

fn millimetres(point: &Point3<f64>) -> [Number; 3] {
    [number(point.x * 1e3), number(point.y * 1e3), number(point.z * 1e3)]
}

/// Writes an element in the machine frame.
pub(super) fn write(
    out: &mut dyn Write,
    frame: &WorkFrame,
    element: &PathElement,
) -> io::Result<()> {
    let kind = match (element.kind, &element.shape) {
        (ElementKind::Rapid, _) => "rapid",
        (ElementKind::Jump, _) => "jump",
        (ElementKind::MFunction { .. }, _) => "m",
        (ElementKind::Dwell { .. }, _) => "dwell",
        (ElementKind::Cut | ElementKind::Probe { .. }, Shape::Line { .. }) => "line",
        (ElementKind::Cut | ElementKind::Probe { .. }, Shape::Arc(_)) => "arc",
        (ElementKind::Cut | ElementKind::Probe { .. }, Shape::Ellipse(_)) => "ellipse",
        (ElementKind::Cut | ElementKind::Probe { .. }, Shape::Cubic(cubic)) => {
            if cubic.is_parabola() { "parabola" } else { "spline" }
        }
    };
    let machine = |point: &Point3<f64>| millimetres(&frame.point_to_machine(point));
    let turning = match &element.shape {
        Shape::Arc(arc) => Some((arc.center(), arc.plane().normal(), arc.sweep())),
        Shape::Ellipse(ellipse) => {
            let center = ellipse.center();
            let center = Point3::new(center.x, center.y, ellipse.start().z);
            Some((center, Vector3::z(), ellipse.sweep()))
        }
        Shape::Line { .. } | Shape::Cubic(_) => None,
    };
    let upright = |normal: &Vector3<f64>| {
        let normal = frame.vector_to_machine(normal);
        [number(normal.x), number(normal.y), number(normal.z)]
    };
    let details = element.details.as_deref();
    let extra = element.extra().map(|extra| {
        let moving = extra.start.iter().zip(extra.end).zip(EXTRA_AXES);
        moving
            .filter(|((start, end), _)| start.to_bits() != end.to_bits())
            .map(|((start, end), letter)| (letter, [number(*start), number(end)]))
            .collect::<BTreeMap<_, _>>()
    });
    let switches = element.switches().iter().map(|switch| SwitchRow {
        number: switch.number,
        on: switch.on,
        at: number(switch.at),
    });
    let row = Row {
        line: element.place.line_in_file(),
        file: element.place.file(),
        called_from: element.place.called_from(),
        block: element.place.block,
        kind,
        start_mm: machine(&element.shape.start()),
        end_mm: machine(&element.shape.end()),
        center_mm: turning.as_ref().map(|(center, ..)| machine(center)),
        normal: turning.as_ref().map(|(_, normal, _)| upright(normal)),
        sweep_deg: turning.map(|(.., sweep)| number(sweep.to_degrees())),
        m: match element.kind {
            ElementKind::MFunction { number } => Some(number),
            _ => None,
        },
        k: details.and_then(|details| details.parameters.k).map(number),
        l: details.and_then(|details| details.parameters.l).map(number),
        parameters: details.and_then(|details| details.parameters.o).map(|all| all.map(number)),
        dwell_s: match element.kind {
            ElementKind::Dwell { time_ns } => Some(number(twin_number::seconds(time_ns))),
            _ => None,
        },
        probe: match element.kind {
            ElementKind::Probe { probing, outcome } => Some(ProbeRow {
                word: probing.to_string(),
                tripped: match outcome {
                    ProbeOutcome::Unknown => None,
                    ProbeOutcome::Tripped => Some(true),
                    ProbeOutcome::NotTripped => Some(false),
                },
            }),
            _ => None,
        },
        extra: extra.filter(|extra| !extra.is_empty()),
        s_profile: details.map(|details| smooth_axes(details.s_profile)).unwrap_or_default(),
        switches: switches.collect(),
        length_mm: number(element.tool_length() * 1e3),
        feed_mm_per_s: number(element.feed * 1e3),
        end_velocity_mm_per_s: number(if element.end_velocity.is_finite() {
            element.end_velocity * 1e3
        } else {
            0.0
        }),
    };
    serde_json::to_writer(&mut *out, &row)?;
    writeln!(out)
}

fn smooth_axes(axes: AxisMask) -> Vec<char> {
    let extra = EXTRA_AXES.into_iter().enumerate();
    let extra = extra.map(|(index, letter)| (letter, AxisMask::extra(index)));
    let all = std::iter::once(('Z', AxisMask::Z)).chain(extra);
    all.filter(|(_, axis)| axes.contains(*axis)).map(|(letter, _)| letter).collect()
}

/// A set-point; the names are those of the manual's outputs in our spelling.
#[derive(serde::Serialize)]
struct SetpointRow {
    time_s: Number,
    line: u32,
    #[serde(serialize_with = "file_name", skip_serializing_if = "Option::is_none")]
    file: Option<FilePath>,
    #[serde(skip_serializing_if = "Option::is_none")]
    called_from: Option<u32>,
    block: Option<u32>,
    status: &'static str,
    position_mm: [Number; 3],
    velocity_mm_per_s: Number,
    tangent: [Number; 3],
    way_mm: Number,
    #[serde(skip_serializing_if = "is_zero")]
    switches: u32,
    #[serde(skip_serializing_if = "is_zero")]
    last_switch: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    m: Option<u16>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    extra: BTreeMap<char, Number>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde wants it")]
fn is_zero(number: &u32) -> bool {
    *number == 0
}

/// Writes a set-point in the frame of the program.
pub(super) fn write_setpoint(out: &mut dyn Write, setpoint: &ToolSetpoint) -> io::Result<()> {
    let extra = EXTRA_AXES.into_iter().zip(setpoint.extra.position);
    let tangent = setpoint.tangent();
    let row = SetpointRow {
        time_s: number(twin_number::seconds(setpoint.time_ns)),
        line: setpoint.place.line_in_file(),
        file: setpoint.place.file(),
        called_from: setpoint.place.called_from(),
        block: setpoint.place.block,
        status: match setpoint.status {
            Status::Init => "init",
            Status::Accelerating => "accelerating",
            Status::Constant => "constant",
            Status::Decelerating => "decelerating",
            Status::Finished => "finished",
            Status::Waiting => "waiting",
        },
        position_mm: millimetres(&setpoint.position),
        velocity_mm_per_s: number(setpoint.path_velocity * 1e3),
        tangent: [number(tangent.x), number(tangent.y), number(tangent.z)],
        way_mm: number(setpoint.way * 1e3),
        switches: setpoint.switches,
        last_switch: setpoint.last_switch.into(),
        m: setpoint.m_function,
        extra: extra
            .filter(|(_, position)| *position != 0.0)
            .map(|(letter, position)| (letter, number(position)))
            .collect(),
    };
    serde_json::to_writer(&mut *out, &row)?;
    writeln!(out)
}
