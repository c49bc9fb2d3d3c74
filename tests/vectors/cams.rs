//! Cam curves and tables, bounds, tappets (manual 4, 5.4, 5.5).

use super::vector::{Vector, check};
use std::sync::Arc;
use twin_cam::{
    Action, Cam, CamCoupling, CamInput, CamTable, Curve, Derivatives, Equidistant, Factors,
    Interpolation, Knot, MasterMotion, PairTable, Passage, Shape, TableScale, Tappet, VariableType,
    quintic,
};
use twin_profile::State;

fn knot(vector: &Vector, name: &str) -> Knot {
    let [master, slave, velocity, acceleration] = vector.numbers(name)[..] else { panic!("XYVA") };
    Knot { master, slave, velocity, acceleration }
}

fn ends(vector: &Vector) -> [Knot; 2] {
    ["p0", "p1"].map(|name| knot(vector, name))
}

fn curve(ends: &[Knot]) -> Curve {
    Curve::polynomial(ends).expect("a curve")
}

/// Position, velocity and acceleration at every `x`.
fn expect_yva(vector: &Vector, curve: &Curve) {
    let found = vector.numbers("x").into_iter().flat_map(|master| {
        let Derivatives { position, velocity, acceleration, .. } = curve.at(master);
        [position, velocity, acceleration]
    });
    vector.expect("yva", found);
}

#[test]
pub(crate) fn rest_to_rest() {
    check("cam-rest-rest", |vector| {
        let ends = ends(vector);
        let curve = curve(&ends);
        vector.expect("coeff", quintic(&ends[0], &ends[1]));
        expect_yva(vector, &curve);
        let extremes = curve.extremes();
        vector.expect("peak_v", [extremes.velocity.max]);
        vector.expect("peak_a", [extremes.acceleration.max]);
        // The same curve from the other end.
        vector.expect("peak_a", [-extremes.acceleration.min]);
    });
}

#[test]
pub(crate) fn general() {
    check("cam-general", |vector| {
        let ends = ends(vector);
        vector.expect("coeff", quintic(&ends[0], &ends[1]));
        expect_yva(vector, &curve(&ends));
    });
}

#[test]
pub(crate) fn line() {
    check("cam-line", |vector| {
        let ends = ends(vector);
        assert_eq!(quintic(&ends[0], &ends[1])[2..], [0.0; 4]);
        expect_yva(vector, &curve(&ends));
    });
}

#[test]
pub(crate) fn equidistant_table() {
    check("cam-table-equi", |vector| {
        assert_eq!(vector.word("mode"), "linear");
        let at = |periodic, master| {
            let values = vector.numbers("table");
            let (variable, interpolation) = (VariableType::Int, Interpolation::Linear);
            let (start, end, slave) = (0.0, 360.0, TableScale::IDENTITY);
            let table =
                Equidistant { variable, start, end, periodic, slave, interpolation, values };
            table.curve().expect("a curve").at(master).position
        };
        let [first, second] = vector.numbers("x")[..] else { panic!("two places") };
        vector.expect("y", [at(true, first), at(false, second)]);
    });
}

#[test]
pub(crate) fn table_scaling() {
    check("cam-table-scaling", |vector| {
        let scale = TableScale { min: 0.0, max: 360.0, table_min: 0.0, table_max: 65_536.0 };
        let [master, slave] = vector.numbers("pair")[..] else { panic!("a pair") };
        let table = PairTable {
            variable: VariableType::Uint,
            master: scale,
            slave: scale,
            periodic: false,
            interpolation: Interpolation::Linear,
            pairs: vec![[0.0, 0.0], [master, slave], [65_535.0, 65_535.0]],
        };
        let curve = table.curve().expect("a curve");
        let joints: Vec<_> = curve.joints().collect();
        vector.expect("master", [joints[1]]);
        vector.expect("slave", [curve.at(joints[1]).position]);
    });
}

#[test]
pub(crate) fn bounds() {
    check("cam-bounds", |vector| {
        assert_eq!(vector.word("cam"), "cam-rest-rest");
        let curve = curve(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(180.0, 100.0)]);
        let velocity = vector.number("v");
        let bounds = |acceleration| {
            let master = MasterMotion { velocity, acceleration, ..MasterMotion::default() };
            curve.bounds(&master, Factors::default())
        };
        let found = bounds(vector.number("a"));
        vector.expect("dMinPos", [found.position.min]);
        vector.expect("dMaxPos", [found.position.max]);
        vector.expect("dMinVel", [found.velocity.min]);
        vector.expect("dMaxVel", [found.velocity.max]);
        vector.expect("dMaxAccDec", [found.acceleration.max]);
        vector.expect("dMaxAccDec", [-found.acceleration.min]);
        vector.expect("dMaxAccDec_a0", [bounds(0.0).acceleration.max]);
    });
}

fn cam(knots: &[Knot]) -> Arc<Cam> {
    Arc::new(Cam::new("cam", Shape::Polynomial(knots.to_vec()), Vec::new()).expect("a cam"))
}

fn at(position: f64) -> State {
    State { position, ..State::default() }
}

#[test]
pub(crate) fn scaling() {
    check("cam-camin-scaling", |vector| {
        let cam = cam(&[Knot::at_rest(0.0, 0.0), Knot::at_rest(100.0, 50.0)]);
        let input = CamInput {
            master_scaling: vector.number("ms"),
            master_offset: vector.number("mo"),
            slave_scaling: vector.number("ss"),
            slave_offset: vector.number("so"),
            ..CamInput::default()
        };
        let master = at(vector.number("master"));
        let coupling = CamCoupling::start(CamTable::new(cam), input, &master, &at(0.0), 0);
        let coupling = coupling.expect("a start");
        vector.expect("x", [coupling.place()]);
        vector.expect("y", [coupling.output().slave.position]);
    });
}

#[test]
pub(crate) fn periodic_offsets() {
    check("cam-periodic-offsets", |vector| {
        let (width, span) = (vector.number("width"), vector.number("slave_span"));
        let velocity = span / width;
        let line = |master: f64| Knot { velocity, ..Knot::at_rest(master, master * velocity) };
        let table = CamTable::new(cam(&[line(0.0), line(width)]));
        let start = CamCoupling::start(table, CamInput::default(), &at(0.0), &at(0.0), 0);
        let mut coupling = start.expect("a start");
        let found = *coupling.step(&at(vector.number("master")), 1_000_000).expect("somewhere");
        let (master, slave) = coupling.offsets();
        vector.expect("Offset1", [master]);
        vector.expect("Offset2", [slave]);
        vector.expect("y", [found.slave.position]);
        assert!(found.end_of_profile);
    });
}

/// The farthest tappet that acts in the cycle in which the master comes from 0 to its place.
#[test]
pub(crate) fn dead_time() {
    check("cam-register-deadtime", |vector| {
        let input = CamInput {
            master_scaling: vector.number("ms"),
            master_offset: vector.number("mo"),
            tappet_dead_time_s: vector.number("dt"),
            ..CamInput::default()
        };
        let moving = |place| State { velocity: vector.number("v"), ..at(place) };
        let (here, there) = (moving(0.0), moving(vector.number("master")));
        let acts = |master: f64| {
            let knots = vec![Knot::at_rest(0.0, 0.0), Knot::at_rest(360.0, 0.0)];
            let tappet = Tappet { group: 1, master, passage: Passage::Every, action: Action::On };
            let cam = Cam::new("cam", Shape::Polynomial(knots), vec![tappet]).expect("a cam");
            let table = CamTable::new(Arc::new(cam));
            let start = CamCoupling::start(table, input, &here, &at(0.0), 0);
            let mut coupling = start.expect("a start");
            let shown = coupling.step(&there, 400_000_000).expect("somewhere");
            shown.tappets.triggers().count() == 1
        };
        let (mut farthest, mut beyond) = (50.0, 350.0);
        assert!(acts(farthest) && !acts(beyond));
        for _ in 0..50 {
            let middle = f64::midpoint(farthest, beyond);
            *if acts(middle) { &mut farthest } else { &mut beyond } = middle;
        }
        vector.expect("x", [farthest]);
    });
}
