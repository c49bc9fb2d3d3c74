//! Tests of cams against closed forms and dense sampling.

#![expect(clippy::float_cmp, reason = "given, or exact in binary fractions")]

mod bounds;
mod by_program;
mod coupling;
mod curve;
mod files;
mod source;
mod tappet_starts;
mod tappets;

use super::{
    Action, Cam, CamCoupling, CamInput, CamTable, Curve, Knot, Passage, Shape, Tappet, TappetBit,
};
use proptest::prelude::*;
use std::sync::Arc;
use twin_profile::State;

/// A cycle of 1 ms.
const CYCLE_NS: i64 = 1_000_000;

fn cam(knots: &[Knot], tappets: Vec<Tappet>) -> Arc<Cam> {
    Arc::new(Cam::new("cam", Shape::Polynomial(knots.to_vec()), tappets).expect("a cam"))
}

/// A slave that stays at 0 over a turn of the master.
fn still(tappets: Vec<Tappet>) -> Arc<Cam> {
    cam(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(360.0, 0.0)], tappets)
}

fn tappet(group: i16, master: f64, passage: Passage, action: Action) -> Tappet {
    Tappet { group, master, passage, action }
}

fn at(position: f64) -> State {
    State::resting(position)
}

fn moving(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

/// A slave on its cam at time 0.
fn started(table: CamTable, input: CamInput, master: State, slave: State) -> CamCoupling {
    CamCoupling::start(table, input, &master, &slave, 0).expect("a start")
}

/// The bit of group 1 of a slave on its cam.
#[derive(Clone)]
struct Switched {
    table: CamTable,
    input: CamInput,
    coupling: Option<CamCoupling>,
    bit: TappetBit,
}

impl Switched {
    fn new(table: CamTable, input: CamInput) -> Self {
        Self { table, input, coupling: None, bit: TappetBit::default() }
    }

    /// Of a slave that stays where it is.
    fn by(tappets: Vec<Tappet>, input: CamInput) -> Self {
        Self::new(CamTable::new(still(tappets)), input)
    }

    /// A cycle, the first of which is the start: the bit, and the number of tappets that acted.
    fn step(&mut self, master: State, now_ns: i64) -> (bool, usize) {
        let acted = match &mut self.coupling {
            Some(coupling) => coupling.step(&master, now_ns).expect("somewhere").tappets,
            none => {
                let coupling = started(self.table.clone(), self.input, master, at(0.0));
                none.insert(coupling).output().tappets
            }
        };
        for trigger in acted.triggers().filter(|trigger| trigger.group == 1) {
            self.bit.take(trigger);
        }
        (self.bit.at(now_ns), acted.triggers().count())
    }
}

/// Points of any cam, with widths that differ a thousandfold.
fn knots() -> impl Strategy<Value = Vec<Knot>> {
    let step = (-3.0..3.0_f64, -50.0..50.0_f64, -2.0..2.0_f64, -0.1..0.1_f64);
    (-500.0..500.0_f64, prop::collection::vec(step, 2..12)).prop_map(|(start, steps)| {
        let mut master = start;
        steps
            .into_iter()
            .map(|(power, slave, velocity, acceleration)| {
                master += 10.0_f64.powf(power / 2.0 + 0.5);
                Knot { master, slave, velocity, acceleration }
            })
            .collect()
    })
}

fn curve(knots: &[Knot]) -> Curve {
    Curve::polynomial(knots).expect("a curve")
}

/// Master positions all over the range, joints included.
fn samples(curve: &Curve, per_piece: u32) -> Vec<f64> {
    let joints: Vec<_> = curve.joints().collect();
    let between = joints.windows(2).flat_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        (0..per_piece).map(move |i| from + (to - from) * f64::from(i) / f64::from(per_piece))
    });
    between.chain([curve.end()]).collect()
}
