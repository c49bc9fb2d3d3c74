//! Check of a plan by its pieces, for commands that plan themselves: the peaks and findings of `twin check`.

use super::checker::free_axes;
use super::findings::Findings;
use super::messages::leave_out_consequences;
use super::pieces::PieceCheck;
use super::{rapids, slack};
use crate::finding::Finding;
use crate::limit::Limits;
use crate::messages::add_moves;
use crate::peak::AxisPeak;
use crate::program::ProgramFile;
use std::collections::HashSet;
use twin_machine::Machine;
use twin_planner::planned_motion::PlannedPiece;

/// Checker of the pieces of a plan.
#[derive(Debug)]
pub(crate) struct PlanCheck<'m> {
    pieces: PieceCheck<'m>,
    findings: Findings,
    rapids: Option<f64>,
    free: Vec<bool>,
}

impl<'m> PlanCheck<'m> {
    /// Of a plan of `program` within `limits`.
    pub(crate) fn new(machine: &'m Machine, program: &ProgramFile, limits: Limits) -> Self {
        let free = free_axes(machine, false);
        let pieces = PieceCheck::new(machine, machine.middle(), slack(limits), free.clone());
        let rapids = rapids(machine, program);
        Self { pieces, findings: Findings::default(), rapids, free }
    }

    /// Axes that do not follow the path; they are not checked.
    pub(crate) fn free(&self) -> &[bool] {
        &self.free
    }

    /// Takes the next piece.
    pub(crate) fn take(&mut self, piece: &PlannedPiece, peaks: &mut [AxisPeak]) {
        self.pieces.take(piece, peaks, &mut self.findings, self.rapids);
    }

    /// Ends the check: adds its findings to `findings`, in place of those from set-points for the same line, rule and axis.
    pub(crate) fn finish(&mut self, peaks: &mut [AxisPeak], findings: &mut Vec<Finding>) {
        self.pieces.finish(peaks, &mut self.findings, self.rapids);
        let (found, _) = std::mem::take(&mut self.findings).into_list();
        let about = |finding: &Finding| (finding.place().key(), finding.rule, finding.axis.clone());
        let exact: HashSet<_> = found.iter().map(about).collect();
        findings.retain(|one| !exact.contains(&about(one)));
        findings.extend(found);
        leave_out_consequences(findings);
        add_moves(self.pieces.machine, findings);
    }
}
