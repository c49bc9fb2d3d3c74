//! Assignment of transform outputs and coordinates to the axes of a machine.

use super::design::Kind;
use crate::additional_axis;
use crate::axis::AxisEntry;
use crate::axis_kind::AxisKind;
use crate::section::Section;
use twin_kinematics::{AxisSource, Coordinate};

/// Source of each axis; complains where the assignment is not one to one.
pub(super) fn sources(
    root: &Section<'_>,
    kind: &Kind,
    axes: &[AxisEntry],
) -> Option<Vec<AxisSource>> {
    let mut complete = true;
    let outputs = kind.outputs;
    let mut sources = Vec::new();
    for (index, entry) in axes.iter().enumerate() {
        let (name, role) = (&entry.axis.name, &entry.role);
        let complain = |message| root.complain_over(&entry.role_span, message);
        let output = outputs.iter().position(|(output, _)| output == role);
        let expected = match output {
            Some(output) => {
                sources.push(AxisSource::Transform(output));
                outputs.get(output).map(|(_, kind)| *kind)
            }
            None if let Some(number) = additional_axis::number(role) => {
                sources.push(AxisSource::Additional(number));
                // In degrees or mm, as the machine has it.
                None
            }
            None if role == "Z" && !kind.moves_z => {
                sources.push(AxisSource::Coordinate(Coordinate::Z));
                Some(AxisKind::Linear)
            }
            None => {
                complete = false;
                complain(format!(
                    "axis \"{name}\" has the role \"{role}\"; of a {} axes move {}, or P Q U V W in addition",
                    kind.name,
                    kind.roles().join(", ")
                ));
                continue;
            }
        };
        if let Some(expected) = expected.filter(|expected| *expected != entry.axis.kind) {
            let (is, should) = (format!("{:?}", entry.axis.kind), format!("{expected:?}"));
            let (is, should) = (is.to_lowercase(), should.to_lowercase());
            complete = false;
            complain(format!(
                "axis \"{name}\" is {is}; what moves {role} of a {} is {should}",
                kind.name
            ));
        }
        if axes.iter().take(index).any(|other| other.role == *role) {
            complete = false;
            complain(format!(
                "axis \"{name}\" has the role \"{role}\", which another axis has already"
            ));
        }
    }
    for (output, _) in outputs {
        if !axes.iter().any(|entry| entry.role == *output) {
            complete = false;
            root.complain_at("axes", format!("no axis moves {output} of the {}", kind.name));
        }
    }
    complete.then_some(sources)
}
