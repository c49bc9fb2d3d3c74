//! Machine description as text for people.

use super::{Facts, motors};
use crate::check::wire_rates;
use crate::command::{following, show};
use crate::workspace::{Cut, Example, MeasureAt, Section};
use comfy_table::{Cell, CellAlignment};
use nalgebra::Point3;
use std::io::{self, Write};
use twin_bim2ax::Bim2AxEntry;
use twin_drives::Axes;
use twin_interpcnc::EncoderOptions;
use twin_interpcnc::InterpCncEntry;
use twin_kinematics::{AxisVector, Branch, Kinematics, ReachOf};
use twin_machine::{
    Axis, Collision, DriveFamily, GripperSignal, Machine, VelocityLimit, VelocitySource,
};
use twin_number::{fixed, significant};
use twin_physics::Part;

pub(super) fn describe(out: &mut impl Write, facts: &Facts<'_>) -> io::Result<()> {
    file(out, facts.machine)?;
    writeln!(out)?;
    workspace(out, facts)?;
    if let Some(example) = &facts.example {
        writeln!(out)?;
        worked(out, facts.machine, example)?;
    }
    Ok(())
}

/// Pose of the work frame; nothing if it is the machine frame.
fn work_frame(out: &mut impl Write, machine: &Machine) -> io::Result<()> {
    let [origin, turned] = machine.work_frame();
    if origin.iter().chain(&turned).all(|value| *value == 0.0) {
        return Ok(());
    }
    let [x, y, z] = origin.map(|value| fixed(value * 1e3, 3));
    let [roll, pitch, yaw] = turned.map(|value| fixed(value.to_degrees(), 4));
    writeln!(
        out,
        "work frame: origin at ({x}, {y}, {z}) mm in the machine frame, roll {roll}, pitch {pitch}, yaw {yaw} deg"
    )
}

/// What the file says.
fn file(out: &mut impl Write, machine: &Machine) -> io::Result<()> {
    writeln!(out, "{}: {} with {} axes", machine.name, machine.kind, machine.axes.len())?;
    let mut table = show::table();
    table.set_header([
        "axis",
        "kind",
        "limits",
        "velocity",
        "acceleration",
        "jerk",
        "drive",
        "increments",
    ]);
    for axis in &machine.axes {
        let unit = axis.unit();
        let drive = axis.drive.as_ref().and_then(|drive| {
            let device = machine.drives.get(drive.device)?;
            Some((
                format!("{} {}", device.name, device.axis_name(drive.index)),
                format!("{} per {} {unit}", drive.ratio.increments, drive.ratio.per_units),
            ))
        });
        let (drive, increments) = drive.unwrap_or_else(|| ("–".to_owned(), "–".to_owned()));
        let row = [
            axis.name.clone(),
            format!("{:?}", axis.kind).to_lowercase(),
            format!("{} {unit}", show::limits(axis)),
            velocity(axis),
            acceleration(axis),
            axis.max_jerk
                .map_or("–".to_owned(), |jerk| format!("{:.1} {unit}/s³", axis.from_si(jerk))),
            drive,
            increments,
        ];
        table.add_row(aligned(row, 2..6));
    }
    writeln!(out, "{table}")?;
    let mass = machine.moving_mass();
    motors::write(out, machine)?;
    writeln!(out, "moving mass {mass:.2} kg in {} links", machine.model.links.len())?;
    for coupling in &machine.couplings {
        writeln!(out, "{}", coupling.describe(&machine.axes))?;
    }
    in_the_way(out, machine)?;
    drives(out, machine)?;
    let [x, y, z] = machine.conditions.start.map(|value| significant(value * 1e3, 9));
    write!(out, "start of programs without a start of their own: X{x} Y{y} Z{z}")?;
    match machine.start_axes() {
        Some(axes) => {
            write!(out, " = {}", positions(machine, &axes))?;
            let beyond = machine.axes.iter().zip(axes.iter()).filter(|(axis, position)| {
                let [low, high] = axis.position_limits;
                !(low..=high).contains(*position)
            });
            let beyond: Vec<_> = beyond.map(|(axis, _)| axis.name.as_str()).collect();
            if !beyond.is_empty() {
                write!(out, ", beyond the limits of {}", beyond.join(", "))?;
            }
            writeln!(out)?;
        }
        None => {
            writeln!(out, ", which the machine cannot reach: such programs must begin with G92")?;
        }
    }
    work_frame(out, machine)?;
    let zero = AxisVector::zeros(machine.axes.len());
    if let Ok(pose) = machine.kinematics.forward(&zero) {
        let tip = pose.position * 1e3;
        let [x, y, z] = [tip.x, tip.y, tip.z].map(|value| fixed(value, 3));
        writeln!(out, "tool tip with all axes at 0: ({x}, {y}, {z}) mm in the machine frame")?;
    }
    Ok(())
}

/// What is looked for in the way of the machine, and what is odd about it.
fn in_the_way(out: &mut impl Write, machine: &Machine) -> io::Result<()> {
    if let Some(collision) = &machine.collision {
        let around = &collision.surroundings;
        let names: Vec<_> = around.obstacles.iter().map(|one| one.name.as_str()).collect();
        let names = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        let links =
            if around.among_links { "; links are looked at against each other" } else { "" };
        let wanted = collision.clearance * 1e3;
        writeln!(out, "in the way: {names}{links}; wanted clearance {wanted} mm")?;
        let links: Vec<_> = machine.model.links.iter().map(|link| link.name.as_str()).collect();
        writeln!(out, "links: {}", links.join(", "))?;
        handled(out, machine, collision)?;
        if let Some(diameter) = machine.model.tool_diameter() {
            let diameter = significant(diameter * 1e3, 6);
            writeln!(out, "tool: {diameter} mm in diameter, for collisions")?;
        }
    }
    for (name, edges) in machine.open_meshes() {
        writeln!(
            out,
            "warning: the mesh of {name} is open at {edges} edges; its volume and mass are uncertain"
        )?;
    }
    for [one, other] in machine.collision.iter().flat_map(|collision| &collision.overlapping) {
        let [one, other] = [one, other].map(|part| machine.part_name(*part));
        writeln!(
            out,
            "warning: {one} and {other} are in each other with every axis in the middle of its travel; they are not looked at for \
             collisions"
        )?;
    }
    for warning in &machine.urdf_warnings {
        writeln!(out, "warning: {warning}")?;
    }
    Ok(())
}

/// Loose bodies and grippers.
fn handled(out: &mut impl Write, machine: &Machine, collision: &Collision) -> io::Result<()> {
    let around = &collision.surroundings;
    let number = |value: f64| significant(value, 6);
    for body in &around.bodies {
        let place = point(&body.pose.translation.vector.into());
        let clamp = body.clamp.map(|force| format!(", clamped with {} N", number(force)));
        let (name, mass) = (&body.name, number(body.inertial.mass));
        writeln!(out, "body {name}: {mass} kg at {place}{}", clamp.unwrap_or_default())?;
    }
    for (gripper, control) in around.grippers.iter().zip(&collision.controls) {
        let link = machine.part_name(Part::Link(gripper.link));
        let by = match control.signal {
            GripperSignal::MFunctions([close, open]) => format!("M{close} closes, M{open} opens"),
            GripperSignal::Switch(switch) => format!("closed while switch H{switch} is on"),
        };
        let moment = Some(gripper.moment).filter(|moment| moment.is_finite());
        let moment = moment.map(|moment| format!(" and {} Nm", number(moment)));
        writeln!(
            out,
            "gripper {}: {} on {link}, holds {} N{} within {} mm; {by}",
            gripper.name,
            control.kind.name(),
            number(gripper.force),
            moment.unwrap_or_default(),
            number(gripper.reach * 1e3)
        )?;
    }
    Ok(())
}

/// The encoders with which a device is compared.
fn encoder(out: &mut impl Write, family: DriveFamily<'_>) -> io::Result<()> {
    match family {
        DriveFamily::InterpCnc(InterpCncEntry { encoder: Some(encoder), .. }) => {
            let axis = Axes::Letters(encoder.axis.mask().bits());
            let EncoderOptions { points, increments, tolerance, .. } = encoder;
            write!(
                out,
                ", encoder on {axis}: {points} points for {increments} increments, {tolerance} apart at most"
            )
        }
        DriveFamily::Bim2Ax(Bim2AxEntry { encoder: Some(encoder), .. }) => {
            let mask = encoder.axes.iter().fold(0, |mask, axis| mask | 1 << axis.index());
            let (points, increments) = (encoder.points_per_turn, encoder.increments_per_turn);
            let axes = Axes::Numbers(mask);
            write!(out, ", encoder on {axes}: {points} points for {increments} increments")?;
            encoder.tolerance.map_or(Ok(()), |apart| write!(out, ", {apart} apart at most"))
        }
        _ => Ok(()),
    }
}

/// The devices on the wires.
fn drives(out: &mut impl Write, machine: &Machine) -> io::Result<()> {
    let rates = wire_rates(machine);
    for (index, device) in machine.drives.iter().enumerate() {
        let port = device.port.as_deref().unwrap_or("no port given");
        write!(out, "drive {}: {} on {port}", device.name, device.family_name())?;
        match device.family() {
            DriveFamily::InterpCnc(board) => {
                write!(out, ", address {}, {} baud", board.address, board.baud)?;
            }
            DriveFamily::SmartDrive(bus) => {
                write!(out, ", {} µsteps per turn", bus.turn.get())?;
            }
            DriveFamily::Bim2Ax(module) => {
                write!(out, ", {} microsteps per step", module.mode.microsteps())?;
            }
            DriveFamily::Other => {}
        }
        encoder(out, device.family())?;
        writeln!(
            out,
            "{}",
            if device.in_loop { ", in the loop of the simulated machine" } else { "" }
        )?;
        if let Some((_, rates)) = rates.iter().find(|(of, _)| *of == index) {
            writeln!(out, "  its wire carries {} at most", following::rates(rates))?;
        }
    }
    Ok(())
}

/// The largest acceleration, and the largest deceleration where it is another one.
fn acceleration(axis: &Axis) -> String {
    let unit = axis.unit();
    let acceleration = format!("{:.1} {unit}/s²", axis.from_si(axis.max_acceleration));
    axis.own_deceleration().map_or_else(
        || acceleration.clone(),
        |own| format!("{acceleration}, braking {:.1}", axis.from_si(own)),
    )
}

/// The largest velocity of an axis, and what keeps it from more if that is not the axis.
fn velocity(axis: &Axis) -> String {
    let VelocityLimit { value, source } = axis.velocity_limit();
    let shown = format!("{:.1} {}/s", axis.from_si(value), axis.unit());
    match source {
        VelocitySource::Axis => shown,
        source => format!("{shown} ({})", source.name()),
    }
}

/// Cells of a row, those of some columns to the right.
fn aligned<const N: usize>(
    row: [String; N],
    right: std::ops::Range<usize>,
) -> impl Iterator<Item = Cell> {
    row.into_iter().enumerate().map(move |(column, text)| {
        let side = if right.contains(&column) { CellAlignment::Right } else { CellAlignment::Left };
        Cell::new(text).set_alignment(side)
    })
}

fn positions(machine: &Machine, axes: &AxisVector) -> String {
    let axes = machine.axes.iter().zip(axes.iter());
    let axes: Vec<_> = axes
        .map(|(axis, position)| {
            format!("{} {} {}", axis.name, fixed(axis.from_si(*position), 3), axis.unit())
        })
        .collect();
    axes.join(", ")
}

/// A dimension of the machine file. Deviations from nominal are shown only where there are any.
fn message(value: &toml::Value) -> Option<toml::Value> {
    fn is_zero(value: &toml::Value) -> bool {
        match value {
            toml::Value::Array(values) => values.iter().all(is_zero),
            value => value.as_float() == Some(0.0) || value.as_integer() == Some(0),
        }
    }
    let toml::Value::Table(table) = value else { return Some(value.clone()) };
    let deviations: toml::Table = table
        .iter()
        .filter(|(_, value)| !is_zero(value))
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect();
    (!deviations.is_empty()).then_some(toml::Value::Table(deviations))
}

/// Where the tool gets, and how well the axes move it there.
fn workspace(out: &mut impl Write, facts: &Facts<'_>) -> io::Result<()> {
    let workspace = &facts.workspace;
    let dimensions: Vec<_> = facts
        .machine
        .dimensions
        .iter()
        .filter_map(|(key, value)| Some(format!("{key} = {}", message(value)?)))
        .collect();
    writeln!(out, "kinematics {}: {}", facts.machine.kind, dimensions.join(", "))?;
    if let Some(reach) = workspace.reach {
        let what = if reach.of == ReachOf::Wrist { "the wrist gets to" } else { "reach:" };
        let [nearest, farthest] = reach.distances.map(|distance| distance * 1e3);
        writeln!(
            out,
            "{what} the ring from {nearest:.3} to {farthest:.3} mm around the axis of the first arm"
        )?;
    }
    let (min, max) = (workspace.extent.min * 1e3, workspace.extent.max * 1e3);
    writeln!(
        out,
        "within the software limits: x {}, y {}, z {} mm (tool tip, machine frame)",
        range(min.x, max.x),
        range(min.y, max.y),
        range(min.z, max.z)
    )?;
    if workspace.turns_tool {
        let direction = workspace.space.direction().to_degrees();
        writeln!(out, "what follows is with the tool pointing to {direction:.3}°")?;
    }
    for section in [Some(&facts.horizontal), facts.vertical.as_ref()].into_iter().flatten() {
        writeln!(out, "{}", sentence(section))?;
    }
    if let (Some(worst), Some(best)) = (facts.horizontal.worst, facts.horizontal.best) {
        let length = facts.machine.length_scale * 1e3;
        let values = if best.measure - worst.measure < 1e-6 {
            format!("{:.3} everywhere", best.measure)
        } else {
            let place = |at: MeasureAt| format!("{:.3} at {}", at.measure, point(&at.position));
            format!("from {} to {}", place(worst), place(best))
        };
        writeln!(out, "singularity measure in the horizontal section: {values}")?;
        writeln!(
            out,
            "  smallest singular value of the Jacobian, with a radian counted as {length:.1} mm: how fast the tool goes in its\n  \
             slowest direction for 1 of all axes together; 0 where there is a direction in which they cannot move it"
        )?;
    }
    Ok(())
}

fn sentence(section: &Section<'_>) -> String {
    let extent = section.within.extent().map_or_else(String::new, |[low, high]| {
        let (along, up) = match section.cut {
            Cut::Horizontal { .. } => ("x", "y"),
            Cut::Vertical { .. } => ("along it", "z"),
        };
        format!(
            ", {along} {}, {up} {} mm",
            range(low.x * 1e3, high.x * 1e3),
            range(low.y * 1e3, high.y * 1e3)
        )
    });
    format!("{}: {:.1} cm²{extent}", section.cut, section.within.area() * 1e4)
}

fn point(at: &Point3<f64>) -> String {
    let [x, y, z] = [at.x, at.y, at.z].map(|value| fixed(value * 1e3, 1));
    format!("X{x} Y{y} Z{z}")
}

fn range(low: f64, high: f64) -> String {
    format!("{} … {}", fixed(low, 1), fixed(high, 1))
}

/// Slower than this an axis stands, degrees or mm per second: rounding.
const RATE: f64 = 1e-9;

/// What the axes do at one pose.
fn worked(out: &mut impl Write, machine: &Machine, example: &Example) -> io::Result<()> {
    let at = point(&example.position);
    writeln!(out, "for example, the tool is at {at} with {}", positions(machine, &example.axes))?;
    if example.branch != Branch::Only {
        write!(out, "  {}, {:.1} mm", example.branch, example.margins.boundary * 1e3)?;
        write!(out, " from where its mechanism ends")?;
        if example.margins.branch > example.margins.boundary {
            write!(
                out,
                ", {:.1} mm from where it would lose its hold",
                example.margins.branch * 1e3
            )?;
        }
        writeln!(out)?;
    }
    let mut table = show::table();
    let costs = |axis: &Axis| format!("costs {}", axis.name);
    let header = std::iter::once("the tool at".to_owned()).chain(machine.axes.iter().map(costs));
    table.set_header(header.chain(["fastest".to_owned()]));
    for way in &example.ways {
        let (unit, scale) = if way.turns() { ("deg/s", 1f64.to_radians()) } else { ("mm/s", 1e-3) };
        let rates = machine.axes.iter().zip(way.rates.iter()).map(|(axis, rate)| {
            let rate = axis.from_si(*rate * scale);
            if rate.abs() < RATE {
                "–".to_owned()
            } else {
                format!("{rate:.4} {}/s", axis.unit())
            }
        });
        let fastest = way.fastest.and_then(|(axis, speed)| {
            let axis = machine.axes.get(axis)?;
            Some(format!(
                "{:.1} {unit} ({} at its {:.1} {}/s)",
                speed / scale,
                axis.name,
                axis.from_si(axis.max_velocity),
                axis.unit()
            ))
        });
        let first = format!("1 {unit} in {}", way.name);
        let row = std::iter::once(first).chain(rates).chain([fastest.unwrap_or("–".to_owned())]);
        table.add_row(row.enumerate().map(|(column, text)| {
            let side = if column == 0 { CellAlignment::Left } else { CellAlignment::Right };
            Cell::new(text).set_alignment(side)
        }));
    }
    writeln!(out, "{table}")
}
