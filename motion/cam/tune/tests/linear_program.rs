//! Small linear programs.

use super::super::linear_program::Program;
use clarabel::solver::SolverStatus;

/// The place of least −x on x − y = 1 with x ≤ ½ and y ≤ 8.
#[test]
fn equations_and_limits() {
    let mut program = Program::new(vec![-1.0, 0.0]);
    program.most([(0, 1.0)], 0.5);
    program.equal([(0, 1.0), (1, -1.0)], 1.0);
    program.most([(1, 1.0)], 8.0);
    let found = program.solved().expect("a solution");
    assert!((found[0] - 0.5).abs() < 1e-7 && (found[1] + 0.5).abs() < 1e-7, "{found:?}");
}

#[test]
fn what_contradicts_itself_is_reported() {
    let mut program = Program::new(vec![1.0]);
    program.most([(0, 1.0)], -1.0);
    program.most([(0, -1.0)], -1.0);
    assert_eq!(program.solved().expect_err("none"), SolverStatus::PrimalInfeasible);
}
