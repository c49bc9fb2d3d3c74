//! Tests of the two passes against the limits, and of their sensitivities against finite differences.

use super::sensitivities;
use crate::time_optimal::bound::{AxisLimits, Cap, CapSource, Constraint, Disc, Rates, Row};
use crate::time_optimal::grid::{CellEnd, End, Grid};
use crate::time_optimal::reachable;
use proptest::prelude::*;
use std::collections::BTreeMap;
use twin_kinematics::AxisVector;

/// A path of axes that swing, with whatever limits it.
#[derive(Clone, Debug)]
struct Case {
    /// Per axis: slope, and amplitude, frequency and phase of two waves.
    waves: Vec<[f64; 7]>,
    limits: Vec<AxisLimits>,
    cells: u32,
    /// Largest acceleration of the tool, whose coordinates are the first axes, in parts of what they could give.
    tool: Option<f64>,
    /// Largest ü, and −ü, in parts of what the first axis could give.
    along: Option<[f64; 2]>,
    feed: Option<f64>,
}

impl Case {
    fn rates(&self, u: f64) -> Rates {
        let order = |order: i32| {
            AxisVector::from_values(self.waves.iter().map(|[slope, waves @ ..]| {
                let wave = |amplitude: f64, frequency: f64, phase: f64| {
                    let turn =
                        frequency * u + phase + f64::from(order) * std::f64::consts::FRAC_PI_2;
                    amplitude * frequency.powi(order) * turn.sin()
                };
                let [a, f, p, a2, f2, p2] = *waves;
                let slope = if order == 1 { *slope } else { 0.0 };
                slope + wave(a, f, p) + wave(a2, f2, p2)
            }))
        };
        Rates { first: order(1), second: order(2), third: order(3) }
    }

    /// With the limits of what is raised multiplied.
    fn grid(&self, raised: Option<(Constraint, f64)>) -> Grid {
        let factor = |constraint: Constraint| match raised {
            Some((which, factor)) if which == constraint => factor,
            _ => 1.0,
        };
        let limits = self.limits.iter().zip(0..).map(|(limits, axis)| AxisLimits {
            velocity: limits.velocity * factor(Constraint::Velocity(CapSource::AxisVelocity(axis))),
            acceleration: limits.acceleration * factor(Constraint::AxisAcceleration(axis)),
            deceleration: limits.deceleration * factor(Constraint::AxisAcceleration(axis)),
            jerk: None,
        });
        let mut grid = Grid::new(limits.collect(), self.along.map_or(0, |_| 2), 0.0);
        let cap = self.feed.map_or(Cap::NONE, |feed| {
            let feed = feed * factor(Constraint::Velocity(CapSource::Feed));
            Cap { v2: feed * feed, source: CapSource::Feed }
        });
        let along = self.along.unwrap_or_default();
        let rows = [
            Row { a: 1.0 / along[0] / factor(Constraint::Further(0)), b: 0.0 },
            Row { a: -1.0 / along[1] / factor(Constraint::Further(1)), b: 0.0 },
        ];
        let rows = if self.along.is_some() { &rows[..] } else { &[] };
        let end = |node: u32| {
            let rates = self.rates(f64::from(node) / f64::from(self.cells));
            let part = |values: &AxisVector, limit: f64| {
                std::array::from_fn(|axis| values.get(axis).map_or(0.0, |value| value / limit))
            };
            let disc = self.tool.map(|limit| {
                let limit = limit * factor(Constraint::ToolAcceleration);
                Disc { a: part(&rates.first, limit), b: part(&rates.second, limit) }
            });
            CellEnd { rates, cap, rows, disc }
        };
        for node in 0..self.cells {
            grid.push(1.0 / f64::from(self.cells), &end(node), &end(node + 1));
        }
        grid
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let wave = (-1.0..1.0, 0.0..0.3, 1.0..20.0, 0.0..6.3, 0.0..0.1, 1.0..30.0, 0.0..6.3)
        .prop_map(|(a, b, c, d, e, f, g)| [a, b, c, d, e, f, g]);
    let share = prop_oneof![Just(1.0), 0.2..5.0];
    let limits = (0.1..2.0, 0.5..10.0, share).prop_map(|(velocity, acceleration, share)| {
        AxisLimits { velocity, acceleration, deceleration: share * acceleration, jerk: None }
    });
    let axes = prop::collection::vec((wave, limits), 1..5);
    let further = (
        prop::option::of(0.5..10.0),
        prop::option::of((0.5..5.0, 0.5..5.0).prop_map(|(up, down)| [up, down])),
        prop::option::of(0.1..2.0),
    );
    (axes, 60_u32..240, further).prop_map(|(axes, cells, (tool, along, feed))| {
        let (waves, limits) = axes.into_iter().unzip();
        Case { waves, limits, cells, tool, along, feed }
    })
}

/// The largest part of a limit in a cell, and over the cells.
fn activity(grid: &Grid, cell: usize, b: &[f64]) -> f64 {
    let a = 0.5 * (b[cell + 1] - b[cell]) / grid.length(cell);
    let ends = End::BOTH.into_iter().zip([b[cell], b[cell + 1]]);
    ends.fold(0.0, |most, (end, b)| {
        let part = |row: &Row| row.a * a + row.b * b;
        let (axes, further) = grid.rows(cell, end);
        let axes = axes.iter().map(|row| part(row).abs());
        let disc = grid.disc(cell, end).map_or(0.0, |Disc { a: with, b: along }| {
            (0..3).map(|at| (with[at] * a + along[at] * b).powi(2)).sum::<f64>().sqrt()
        });
        axes.chain(further.iter().map(part)).fold(disc.max(most), f64::max)
    })
}

fn worst(grid: &Grid, b: &[f64]) -> f64 {
    let rows = (0..grid.cells()).map(|cell| activity(grid, cell, b));
    let caps = b.iter().zip(grid.caps()).map(|(b, cap)| b / cap.v2);
    rows.chain(caps).fold(0.0, f64::max)
}

fn passes(grid: &Grid) -> Vec<f64> {
    reachable::fastest(grid, 0..grid.cells(), 0.0, 0.0)
}

fn time(grid: &Grid, b: &[f64]) -> f64 {
    reachable::duration(grid, 0..grid.cells(), b)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// The limits hold to rounding, and no b can be more without breaking one.
    #[test]
    fn nothing_can_be_raised(case in cases()) {
        let grid = case.grid(None);
        let found = passes(&grid);
        let worst = worst(&grid, &found);
        prop_assert!(worst <= 1.0 + 1e-9, "{worst}");
        for node in 1..grid.cells() {
            let mut b = found.clone();
            b[node] = 1.02 * b[node] + 1e-9;
            let capped = b[node] > grid.caps()[node].v2;
            let active = activity(&grid, node - 1, &b).max(activity(&grid, node, &b));
            prop_assert!(capped || active > 1.0, "node {node} of {}", case.cells);
        }
    }

    /// All times go with 1/√k where accelerations go with k and velocities with √k: what limits cost adds up to the whole.
    #[test]
    fn what_limits_cost_adds_up(case in cases()) {
        let grid = case.grid(None);
        let b = passes(&grid);
        let sum: f64 = sensitivities(&grid, &b).iter().map(|gain| match gain.constraint {
            Constraint::Velocity(_) => gain.time,
            _ => 2.0 * gain.time,
        }).sum();
        let time = time(&grid, &b);
        prop_assert!((sum - time).abs() <= 1e-5 * time, "{sum} s of {time} s");
    }

    /// What each limit costs is what raising it a little saves.
    #[test]
    fn what_a_limit_costs_is_what_raising_it_saves(case in cases()) {
        let solve = |raised| {
            let grid = case.grid(raised);
            let b = passes(&grid);
            (time(&grid, &b), sensitivities(&grid, &b))
        };
        let (time, gains) = solve(None);
        let mut costs = BTreeMap::<Constraint, f64>::new();
        for gain in &gains {
            *costs.entry(gain.constraint).or_default() += gain.time;
        }
        for (constraint, cost) in costs.into_iter().filter(|(_, cost)| cost.abs() > 0.002 * time) {
            // To both sides: where what holds b changes, one of them is not the other.
            let by = 1e-5;
            let saved = [1.0 + by, 1.0 - by].map(|factor| (time - solve(Some((constraint, factor))).0) / (factor - 1.0));
            let room = 2e-3 * cost.abs() + 5e-5 * time;
            let (least, most) = (saved[0].min(saved[1]) - room, saved[0].max(saved[1]) + room);
            prop_assert!((least..=most).contains(&cost), "{constraint:?}: {cost} s, {saved:?} of {time}");
        }
    }
}
