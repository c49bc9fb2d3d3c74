//! Losses of a conversion: the data of a cam that another file form cannot hold.

use twin_cam::{Element, Interpolation, Shape, Source, VariableType};
use twin_machine::cam_file::{AxisScale, CamFile};

/// What `from` says that `to`, read again from its file, does not: a line for each.
pub(crate) fn lost(from: &CamFile, to: &CamFile) -> Vec<String> {
    let mut lines = Vec::new();
    if from.cam.name() != to.cam.name() {
        lines.push(format!(
            "the name \"{}\" (read again it is \"{}\")",
            from.cam.name(),
            to.cam.name()
        ));
    }
    for (which, one, other) in
        [("master", &from.master, &to.master), ("slave", &from.slave, &to.slave)]
    {
        scale(&mut lines, which, one, other);
    }
    match (from.period, to.period) {
        (Some(period), None) => lines.push(format!("the slave's period, {period}")),
        (Some(period), Some(other)) if period.to_bits() != other.to_bits() => {
            lines.push(format!("the slave's period, {period} (read again it is {other})"));
        }
        _ => {}
    }
    if from.repeated != to.repeated {
        let message = |repeated: bool| if repeated { "put end to end" } else { "once" };
        lines.push(format!(
            "that the cam is {} (read again it is {})",
            message(from.repeated),
            message(to.repeated)
        ));
    }
    elements(&mut lines, from, to);
    table(&mut lines, from.cam.shape(), to.cam.shape());
    coupling(&mut lines, from, to);
    lines
}

fn scale(lines: &mut Vec<String>, which: &str, one: &AxisScale, other: &AxisScale) {
    // Degrees have two names.
    let unit = |scale: &AxisScale| scale.unit.replace('°', "deg");
    if unit(one) != unit(other) {
        lines.push(format!("the unit of the {which}, {}", one.unit()));
    }
    let same = |one: f64, other: f64| (one - other).abs() <= 1e-12 * one.abs().max(other.abs());
    if !(same(one.min, other.min) && same(one.max, other.max)) {
        lines.push(format!(
            "the scale of the {which}, {} to {} (read again it is {} to {})",
            one.min, one.max, other.min, other.max
        ));
    } else if !same(one.step, other.step) {
        lines.push(format!("the step of the {which}'s scale, {}", one.step));
    }
}

/// Lines and points, and tappets.
fn elements(lines: &mut Vec<String>, from: &CamFile, to: &CamFile) {
    let straight = |file: &CamFile| {
        let all = file.source.iter().flat_map(|Source { elements, .. }| elements);
        all.filter(|element| matches!(element, Element::Line { .. })).count()
    };
    let (before, after) = (straight(from), straight(to));
    if before > after {
        lines.push(format!(
            "that {} of its elements are straight lines: they are points now",
            before - after
        ));
    }
    let (before, after) = (from.cam.tappets().len(), to.cam.tappets().len());
    if before > after {
        lines.push(format!(
            "this form has no tappets; {} of {} are left behind (.toml has them)",
            before - after,
            from.path.display()
        ));
    }
}

fn table(lines: &mut Vec<String>, from: &Shape, to: &Shape) {
    let said = |shape: &Shape| match shape {
        Shape::Equidistant(table) => Some((table.variable, table.interpolation, "equidistant")),
        Shape::Pairs(table) => Some((table.variable, table.interpolation, "pairs")),
        Shape::Polynomial(_) => None,
    };
    match (said(from), said(to)) {
        (None, Some(_)) => lines.push(
            "the polynomials between its points: velocity and acceleration of the points"
                .to_owned(),
        ),
        (Some((variable, between, kind)), Some((other_variable, other_between, other_kind))) => {
            if variable != other_variable && variable != VariableType::Lreal {
                lines.push(format!("the type of its numbers, {}", variable.name()));
            }
            if between != other_between && between == Interpolation::Cubic {
                lines.push(
                    "cubics between its points (--interpolation cubic reads them so)".to_owned(),
                );
            }
            if kind != other_kind {
                lines.push(format!("that its points are {kind}: they are {other_kind} now"));
            }
        }
        _ => {}
    }
}

/// Inputs of `MC_CamIn`.
fn coupling(lines: &mut Vec<String>, from: &CamFile, to: &CamFile) {
    let pairs = from.coupling.numbers().into_iter().zip(to.coupling.numbers());
    for ((key, _, value), (_, _, other)) in pairs {
        if value.to_bits() != other.to_bits() {
            lines.push(format!("[coupling] {key} = {value}"));
        }
    }
    let mode = from.coupling.start_mode();
    if mode != to.coupling.start_mode() {
        lines.push(format!("[coupling] start_mode = \"{mode}\""));
    }
    if let Some(wanted) =
        from.coupling.wanted.filter(|_| from.coupling.wanted != to.coupling.wanted)
    {
        for (key, value) in twin_machine::cam_file::WANTED.into_iter().zip(wanted) {
            lines.push(format!("[coupling] {key} = {value}"));
        }
    }
}
