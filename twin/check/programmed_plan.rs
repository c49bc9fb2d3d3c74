//! Warning about a controller that plans by F and E alone, for programs that are planned within the limits of the axes.

use super::checker::Checker;
use super::{CONTROLLER, CheckFailure, messages};
use crate::finding::{self, Finding, Rule};
use crate::limit::Limits;
use crate::m_function::Acknowledgement;
use crate::planning::Planning;
use crate::program::ProgramFile;
use crate::setpoint_source::PlanItem;
use twin_kinematics::AxisVector;
use twin_machine::Machine;

/// The worst overload of an axis by a plan of F and E alone, as one warning; none if there is none.
pub(super) fn warning(
    machine: &Machine,
    program: &ProgramFile,
    rules: Acknowledgement,
    continues: Option<AxisVector>,
) -> Result<Option<Finding>, CheckFailure> {
    let mut items = Planning::new(machine, program, Limits::Programmed, rules)?;
    let mut checker = Checker::new(machine, None, CONTROLLER, false).without_feeds();
    checker.continue_from(continues);
    checker.begin(&mut items, false);
    while let Some(item) = items.next() {
        checker.pieces(&mut items);
        match item {
            PlanItem::Tool(tool) => {
                if let Some(bridge) = checker.bridge(&tool) {
                    items.bridge(bridge, &tool);
                } else {
                    checker.tool(&tool, None);
                }
            }
            PlanItem::Bridging(instant) => drop(checker.bridging(&instant)),
            PlanItem::Io(error) => return Err(error.into()),
            // The plan within the limits of the axes reports what is wrong with the text.
            PlanItem::Axes(_) | PlanItem::Diagnostic(_) => {}
        }
    }
    checker.pieces(&mut items);
    let findings = checker.finish().findings;
    let overload = |finding: &Finding| {
        let rules = [Rule::AxisVelocity, Rule::AxisAcceleration, Rule::AxisVelocityStep];
        rules.contains(&finding.rule)
    };
    let overloads: Vec<_> = findings.into_iter().filter(overload).collect();
    Ok(finding::worst(&overloads).map(messages::overloaded_as_programmed))
}
