//! Machines of the machine files, with the benchmark's curves within their reach.

use crate::curves::{self, Curve, Jet};
use crate::path::{Limits, Path, Rates, equal};
use nalgebra::{SVector, Vector2, Vector3};
use std::cell::RefCell;
use std::f64::consts::FRAC_PI_2;
use twin_kinematics::gantry::{BeltLayout, Gantry3, GantryH2};
use twin_kinematics::scara::{Elbow, Scara2, Scara3};
use twin_kinematics::transform::{Differential, Transform};
use twin_kinematics::tripod::{Tripod, TripodDimensions};

/// The axes' rates for a moving tool, near where they were for the one before.
type Follow = Box<dyn FnMut(&Jet) -> Rates>;

/// A machine with the curves it is to follow.
pub struct Machine {
    pub name: &'static str,
    limits: Vec<Limits>,
    follow: fn() -> Follow,
    pub curves: Vec<Curve>,
}

impl Machine {
    /// The rates of the axes along a curve.
    pub fn rates<'a>(&self, curve: &'a Curve) -> impl Fn(f64) -> Rates + use<'a> {
        let follow = RefCell::new((self.follow)());
        move |s| (follow.borrow_mut())(&curve.at(s))
    }

    /// A curve in equal cells of its parameter.
    pub fn path(&self, curve: &Curve, cells: usize) -> Path {
        Path::new(self.limits.clone(), equal(curve.end, cells), self.rates(curve))
    }
}

fn linear(velocity_mm: f64, acceleration_mm: f64, jerk_mm: f64) -> Limits {
    Limits {
        velocity: velocity_mm * 1e-3,
        acceleration: acceleration_mm * 1e-3,
        jerk: jerk_mm * 1e-3,
    }
}

fn rotary(velocity_deg: f64, acceleration_deg: f64, jerk_deg: f64) -> Limits {
    Limits {
        velocity: velocity_deg.to_radians(),
        acceleration: acceleration_deg.to_radians(),
        jerk: jerk_deg.to_radians(),
    }
}

/// The limits of `machines`, and jerks that reach the acceleration within 40 to 50 ms.
pub fn all() -> Vec<Machine> {
    let at = Vector3::new;
    let scara = |name, limits, follow, curves| Machine { name, limits, follow, curves };
    let [arm_a, arm_b, arm_c] = [
        rotary(240.0, 1500.0, 30_000.0),
        rotary(300.0, 2500.0, 50_000.0),
        rotary(720.0, 8000.0, 160_000.0),
    ];
    let quill = linear(300.0, 3000.0, 60_000.0);
    vec![
        Machine {
            name: "gantry3",
            limits: vec![
                linear(400.0, 3000.0, 60_000.0),
                linear(400.0, 3000.0, 60_000.0),
                linear(200.0, 2000.0, 40_000.0),
            ],
            follow: gantry3,
            curves: four(at(0.3, 0.1, 0.0), 0.08),
        },
        Machine {
            name: "gantry_h2",
            limits: vec![
                linear(600.0, 6000.0, 150_000.0),
                linear(600.0, 6000.0, 150_000.0),
                linear(100.0, 1500.0, 30_000.0),
            ],
            follow: gantry_h2,
            curves: four(at(0.0, 0.0, 0.0), 0.08),
        },
        scara(
            "scara2",
            vec![arm_a, arm_b, quill],
            scara2,
            // Arms of 250 and 200 mm: they reach from 50 to 450 mm.
            [
                four(at(0.3, 0.05, 0.0), 0.06),
                vec![
                    named("stretched", curves::circle(at(0.36, 0.0, 0.0), 0.085)),
                    named("folded", curves::circle(at(0.14, 0.0, 0.0), 0.08)),
                ],
            ]
            .into_iter()
            .flatten()
            .collect(),
        ),
        scara("scara3", vec![arm_a, arm_b, arm_c, quill], scara3, four(at(0.3, 0.05, 0.0), 0.06)),
        Machine {
            name: "tripod",
            limits: vec![linear(500.0, 8000.0, 200_000.0); 3],
            follow: tripod,
            curves: [
                four(at(0.0, 0.0, 0.0), 0.1),
                vec![named("wide", curves::circle(at(0.0, 0.0, 0.0), 0.18))],
            ]
            .into_iter()
            .flatten()
            .collect(),
        },
    ]
}

/// The long one: 5 m on a SCARA.
pub fn long() -> (Machine, Curve) {
    let machine = all().swap_remove(2);
    (machine, curves::rosette(Vector3::new(0.3, 0.05, 0.0), 0.06, 5.0))
}

fn four(centre: Vector3<f64>, radius: f64) -> Vec<Curve> {
    [curves::circle, curves::lissajous, curves::spiral, curves::spline]
        .map(|curve| curve(centre, radius))
        .into()
}

fn named(name: &'static str, curve: Curve) -> Curve {
    Curve { name, ..curve }
}

/// The rates of the axes of a transform, and of further ones that move as given.
fn through<T: Transform<N>, const N: usize>(
    machine: &T,
    tool: [SVector<f64, N>; 4],
    near: &mut SVector<f64, N>,
    further: Option<[f64; 3]>,
) -> Rates {
    let [position, velocity, acceleration, jerk] = tool;
    let (axes, differential) = machine.at_tool(&position, near).expect("within reach");
    *near = axes;
    let rates = differential.follow_jerk(&[velocity, acceleration, jerk]);
    let mut rates =
        rates.expect("not singular").map(|rate| rate.iter().copied().collect::<Vec<_>>());
    if let Some(further) = further {
        for (rate, value) in rates.iter_mut().zip(further) {
            rate.push(value);
        }
    }
    rates
}

fn heights(jet: &Jet) -> [f64; 3] {
    let [_, first, second, third] = jet;
    [first.z, second.z, third.z]
}

fn gantry3() -> Follow {
    let machine = Gantry3::new([0.0; 3]).expect("a gantry");
    let mut near = Vector3::zeros();
    Box::new(move |jet| through(&machine, *jet, &mut near, None))
}

fn gantry_h2() -> Follow {
    let layout = BeltLayout { coordinates_exchanged: true, drives_exchanged: false };
    let machine = GantryH2::new([0.0; 2], layout).expect("a gantry");
    let mut near = Vector2::zeros();
    Box::new(move |jet| through(&machine, jet.map(|of| of.xy()), &mut near, Some(heights(jet))))
}

fn scara2() -> Follow {
    let machine = Scara2::new([0.25, 0.2], [0.0; 2], Elbow::Low).expect("a SCARA");
    let mut near = Vector2::zeros();
    Box::new(move |jet| through(&machine, jet.map(|of| of.xy()), &mut near, Some(heights(jet))))
}

/// The hand turns with x, by 5 rad per metre.
fn scara3() -> Follow {
    let machine = Scara3::new([0.25, 0.2, 0.04], [0.0; 3], Elbow::Low).expect("a SCARA");
    let mut near = Vector3::zeros();
    Box::new(move |jet| {
        let tool = jet.map(|of| Vector3::new(of.x, of.y, 5.0 * of.x));
        let tool = [tool[0] - Vector3::new(0.0, 0.0, 1.5), tool[1], tool[2], tool[3]];
        through(&machine, tool, &mut near, Some(heights(jet)))
    })
}

fn tripod() -> Follow {
    let dimensions = TripodDimensions {
        inner_radius: 0.06,
        outer_radius: 0.26,
        rod_length: 0.4,
        rod_distance: 0.05,
        rotation: FRAC_PI_2,
    };
    let machine = Tripod::new(dimensions, [0.0; 3]).expect("a tripod");
    let mut near = Vector3::zeros();
    Box::new(move |jet| through(&machine, *jet, &mut near, None))
}
