//! Machine description as JSON: one object on one line.

use super::{Facts, devices};
use crate::workspace::{Cut, Example, MeasureAt, Section};
use nalgebra::{Isometry3, Point3};
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use twin_kinematics::AxisVector;
use twin_machine::{Axis, Collision, CoupledBy, Coupling, GripperControl, GripperSignal, Machine};
use twin_physics::{Body, Gripper, Obstacle, ObstacleKind, Part};
use twin_urdf::{Solid, SolidShape};

pub(super) fn describe(out: &mut impl Write, facts: &Facts<'_>) -> io::Result<()> {
    let (machine, workspace) = (facts.machine, &facts.workspace);
    let extent = workspace.extent;
    let dimensions = serde_json::to_value(&machine.dimensions)?;
    let object = json!({
        "machine": machine.name,
        "file": machine.path.display().to_string(),
        "kind": machine.kind,
        "kinematics": dimensions,
        "axes": machine.axes.iter().map(|one| axis(machine, one)).collect::<Vec<_>>(),
        "drives": devices::drives(machine),
        "couplings": machine.couplings.iter().map(|one| coupling(machine, one)).collect::<Vec<_>>(),
        "payload": devices::payload(machine),
        "moving_mass_kg": machine.moving_mass(),
        "links": machine.model.links.iter().map(|link| &link.name).collect::<Vec<_>>(),
        "collision": machine.collision.as_ref().map(|collision| self::collision(machine, collision)),
        "start": {
            "position_mm": millimetres(machine.conditions.start),
            "axes": machine.start_axes().map(|axes| positions(machine, &axes)),
        },
        "work_frame": work_frame(machine),
        "reach_mm": workspace.reach.map(|reach| millimetres(reach.distances)),
        "extent_mm": {
            "x": millimetres([extent.min.x, extent.max.x]),
            "y": millimetres([extent.min.y, extent.max.y]),
            "z": millimetres([extent.min.z, extent.max.z]),
        },
        "length_scale_mm": machine.length_scale * 1e3,
        "direction_deg": workspace.turns_tool.then(|| workspace.space.direction().to_degrees()),
        "horizontal": section(&facts.horizontal),
        "vertical": facts.vertical.as_ref().map(section),
        "example": facts.example.as_ref().map(|example| worked(machine, example)),
    });
    writeln!(out, "{object}")
}

/// Pose of the work frame, as `translation_mm` and `rotation_deg` of a machine file give it.
fn work_frame(machine: &Machine) -> Value {
    let [origin, turned] = machine.work_frame();
    json!({ "translation_mm": millimetres(origin), "rotation_deg": turned.map(f64::to_degrees) })
}

/// An axis that follows another one.
fn coupling(machine: &Machine, coupling: &Coupling) -> Value {
    let name = |index: usize| machine.axes.get(index).map(|axis| &axis.name);
    let (ratio, cam) = match &coupling.by {
        CoupledBy::Gear(numerator, denominator) => {
            (Some([i64::from(*numerator), i64::from(*denominator)]), None)
        }
        CoupledBy::Cam(selection) => (None, Some(selection.table.cam.name())),
    };
    json!({
        "kind": coupling.name(),
        "axis": name(coupling.axis),
        "master": name(coupling.master),
        "ratio": ratio,
        "cam": cam,
    })
}

/// What is looked for in the way of the machine.
fn collision(machine: &Machine, collision: &Collision) -> Value {
    let around = &collision.surroundings;
    let pair = |parts: &[Part; 2]| json!(parts.map(|part| machine.part_name(part)));
    let obstacle = |(index, one): (usize, &Obstacle)| {
        let kind = match one.kind {
            ObstacleKind::Fixture => "fixture",
            ObstacleKind::Stock => "stock",
        };
        json!({
            "name": machine.part_name(Part::Obstacle(index)),
            "kind": kind,
            "belt_mm_per_s": millimetres(one.surface.velocity.into()),
            "solids": solids(&one.solids),
        })
    };
    let body = |body: &Body| {
        let (position, rotation) = place(&body.pose);
        json!({
            "name": body.name,
            "mass_kg": body.inertial.mass,
            "position_mm": position,
            "rotation_deg": rotation,
            "clamp_n": body.clamp,
            "solids": solids(&body.solids),
        })
    };
    let gripper = |(gripper, control): (&Gripper, &GripperControl)| {
        let (close, open, switch) = match control.signal {
            GripperSignal::MFunctions([close, open]) => (Some(close), Some(open), None),
            GripperSignal::Switch(switch) => (None, None, Some(switch)),
        };
        json!({
            "name": gripper.name,
            "kind": control.kind.name(),
            "link": machine.part_name(Part::Link(gripper.link)),
            "point_mm": point(&gripper.point),
            "reach_mm": gripper.reach * 1e3,
            "force_n": gripper.force,
            "moment_nm": finite(gripper.moment),
            "close_m": close,
            "open_m": open,
            "switch": switch,
            "delay_ms": control.delay_ns / 1_000_000,
        })
    };
    let open = machine.open_meshes().into_iter();
    json!({
        "obstacles": around.obstacles.iter().enumerate().map(obstacle).collect::<Vec<_>>(),
        "bodies": around.bodies.iter().map(body).collect::<Vec<_>>(),
        "grippers": around.grippers.iter().zip(&collision.controls).map(gripper).collect::<Vec<_>>(),
        "self_collision": around.among_links,
        "left_out": around.left_out.iter().map(pair).collect::<Vec<_>>(),
        "overlapping": collision.overlapping.iter().map(pair).collect::<Vec<_>>(),
        "clearance_mm": collision.clearance * 1e3,
        "stiffness_n_per_mm": around.stiffness * 1e-3,
        "tool_diameter_mm": machine.model.tool_diameter().map(|diameter| diameter * 1e3),
        "open_edges": open.map(|(name, edges)| (name, json!(edges))).collect::<Map<_, _>>(),
    })
}

/// Position, mm, and rotation, roll, pitch and yaw in degrees.
fn place(pose: &Isometry3<f64>) -> (Vec<f64>, [f64; 3]) {
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    (millimetres(pose.translation.vector.into()), [roll, pitch, yaw].map(f64::to_degrees))
}

fn solids(solids: &[Solid]) -> Vec<Value> {
    let solids = solids.iter().map(|solid| {
        let (position, rotation) = place(&solid.origin);
        json!({
            "shape": shape(&solid.shape),
            "position_mm": position,
            "rotation_deg": rotation,
        })
    });
    solids.collect()
}

/// Sizes in the machine frame's unit, mm.
fn shape(shape: &SolidShape) -> Value {
    match shape {
        SolidShape::Box { size } => json!({ "box_mm": millimetres((*size).into()) }),
        SolidShape::Cylinder { radius, length } => {
            json!({ "cylinder_mm": millimetres([2.0 * radius, *length]) })
        }
        SolidShape::Sphere { radius } => json!({ "sphere_mm": 2e3 * radius }),
        SolidShape::Capsule { radius, length } => {
            json!({ "capsule_mm": millimetres([2.0 * radius, *length]) })
        }
        SolidShape::Mesh { mesh, .. } => json!({ "mesh": mesh.file() }),
    }
}

fn millimetres<const N: usize>(metres: [f64; N]) -> Vec<f64> {
    metres.map(|value| value * 1e3).to_vec()
}

fn axis(machine: &Machine, axis: &Axis) -> Value {
    json!({
        "name": axis.name,
        "kind": format!("{:?}", axis.kind).to_lowercase(),
        "unit": axis.unit(),
        "limits": axis.limited.then(|| axis.position_limits.map(|limit| axis.from_si(limit))),
        "period": axis.period.map(|period| axis.from_si(period)),
        "velocity": axis.from_si(axis.max_velocity),
        "velocity_limited_by": axis.velocity_limit().source.name(),
        "headroom_percent": (axis.headroom * 1e4).round() / 1e2,
        "acceleration": axis.from_si(axis.max_acceleration),
        "deceleration": axis.from_si(axis.max_deceleration),
        "jerk": axis.max_jerk.map(|jerk| axis.from_si(jerk)),
        "motor": devices::motor(axis),
        "drive": devices::of_axis(machine, axis),
    })
}

/// Values by the name of their axis, in its unit.
fn positions(machine: &Machine, axes: &AxisVector) -> Value {
    let axes = machine.axes.iter().zip(axes.iter());
    let entries = axes.map(|(axis, value)| (axis.name.clone(), json!(axis.from_si(*value))));
    Value::Object(entries.collect::<Map<_, _>>())
}

fn point(at: &Point3<f64>) -> Vec<f64> {
    millimetres([at.x, at.y, at.z])
}

fn section(section: &Section<'_>) -> Value {
    let mut object = match section.cut {
        Cut::Horizontal { height } => json!({ "height_mm": height * 1e3 }),
        Cut::Vertical { through, azimuth } => json!({
            "through_mm": millimetres([through.x, through.y]),
            "azimuth_deg": azimuth.to_degrees(),
        }),
    };
    let names = match section.cut {
        Cut::Horizontal { .. } => ["x_mm", "y_mm"],
        Cut::Vertical { .. } => ["along_mm", "z_mm"],
    };
    let extent = section.within.extent();
    let measure = |found: Option<MeasureAt>| {
        found.map(|at| json!({ "value": at.measure, "at_mm": point(&at.position) }))
    };
    let [along, up] = names;
    let more = [
        (along, json!(extent.map(|[low, high]| millimetres([low.x, high.x])))),
        (up, json!(extent.map(|[low, high]| millimetres([low.y, high.y])))),
        ("area_mm2", json!(section.within.area() * 1e6)),
        ("measure", json!({ "worst": measure(section.worst), "best": measure(section.best) })),
    ];
    if let Value::Object(object) = &mut object {
        object.extend(more.map(|(key, value)| (key.to_owned(), value)));
    }
    object
}

fn worked(machine: &Machine, example: &Example) -> Value {
    let ways = example.ways.iter().map(|way| {
        // Of the tool: mm/s, or deg/s of its direction.
        let scale = if way.turns() { 1f64.to_radians() } else { 1e-3 };
        let rates = AxisVector::from_values(way.rates.iter().map(|rate| rate * scale));
        let fastest = way.fastest.and_then(|(axis, speed)| {
            let name = &machine.axes.get(axis)?.name;
            Some(json!({ "speed": speed / scale, "axis": name }))
        });
        let value = json!({ "axis_rates": positions(machine, &rates), "fastest": fastest });
        (way.name.to_owned(), value)
    });
    json!({
        "position_mm": point(&example.position),
        "branch": example.branch.to_string(),
        "to_edge_mm": finite(example.margins.boundary * 1e3),
        "to_other_branch_mm": finite(example.margins.branch * 1e3),
        "axes": positions(machine, &example.axes),
        "ways": Value::Object(ways.collect::<Map<_, _>>()),
    })
}

/// JSON has no infinity: what is nowhere is null.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
