//! Tests of the reference SCARA against pinocchio 4.1 (articulated-body algorithm, RK4 with 100 µs).
//!
//! Halving that step moves pinocchio's tip by 3e-15 m. The numbers are rows of its two runs, copied as facts.

use std::f64::consts::TAU;

use nalgebra::Vector2;
use twin_kinematics::Transform;
use twin_kinematics::scara::{Elbow, Scara2};
use twin_kinematics::transform::Motion;

use super::*;

/// Two revolute axes about +z, 0.4 m and 0.3 m apart, and a slide along +z; masses of uniform boxes.
pub(super) fn scara() -> Model {
    chain([
        (
            JointKind::Revolute,
            Vector3::z(),
            Isometry3::identity(),
            Some(uniform_box(8.0, [0.2, 0.0, 0.0], [0.4, 0.1, 0.08])),
        ),
        (
            JointKind::Revolute,
            Vector3::z(),
            Isometry3::translation(0.4, 0.0, 0.0),
            Some(uniform_box(4.0, [0.15, 0.0, 0.0], [0.3, 0.08, 0.06])),
        ),
        (
            JointKind::Prismatic,
            Vector3::z(),
            Isometry3::translation(0.3, 0.0, 0.0),
            Some(uniform_box(2.0, [0.0, 0.0, -0.02], [0.04, 0.04, 0.2])),
        ),
    ])
}

fn transform() -> Scara2 {
    Scara2::new([0.4, 0.3], [0.0; 2], Elbow::Low).unwrap()
}

/// Joint motion on a circle of 0.1 m about (0.45, 0) at 0.5 m/s, z = 0.02·sin(2πt).
pub(super) fn circle(t: f64) -> [JointVector; 3] {
    let ((sin, cos), (up, along)) = ((5.0 * t).sin_cos(), (TAU * t).sin_cos());
    let tool = Motion {
        position: Vector2::new(0.45 + 0.1 * cos, 0.1 * sin),
        velocity: Vector2::new(-0.5 * sin, 0.5 * cos),
        acceleration: Vector2::new(-2.5 * cos, -2.5 * sin),
    };
    let arms = transform().axis_motion(&tool, &Vector2::zeros()).unwrap();
    [
        (arms.position, 0.02 * up),
        (arms.velocity, 0.02 * TAU * along),
        (arms.acceleration, -0.02 * TAU * TAU * up),
    ]
    .map(|(arms, z)| joints([arms.x, arms.y, z]))
}

pub(super) fn tip(q: &JointVector) -> Vector3<f64> {
    transform().to_tool(&q.fixed_rows::<2>(0).into()).unwrap().push(q[2] - 0.12)
}

/// Cycle, `tau_ff` of that cycle: inverse dynamics half a cycle ahead (`scara_circle.csv`).
pub(super) const FEED_FORWARD: [(u32, [f64; 3]); 6] = [
    (0, [-3.135_973_326_919_322, 1.785_836_656_586_677_5, 19.615_039_003_891_674]),
    (100, [-5.601_531_892_777_208, 0.956_656_077_830_836, 18.687_797_784_218_347]),
    (500, [-5.064_228_138_827_286, -1.988_900_794_408_700_3, 19.624_960_996_108_328]),
    (2000, [9.068_645_238_827_404, -1.574_633_442_673_348_4, 19.615_039_003_891_67]),
    (3500, [6.769_164_471_756_556_4, 2.221_269_747_584_585, 19.624_960_996_108_328]),
    (4250, [-5.699_283_707_054_434, -1.873_913_397_421_414_8, 18.040_871_088_546_577]),
];

/// Cycle, q, v under the reference's controller (`scara_circle.csv`).
const CLOSED_LOOP: [(u32, [f64; 3], [f64; 3]); 9] = [
    (
        1,
        [-0.560_341_926_873_680_5, 1.350_267_869_165_776_3, 0.000_125_662_465_894_564_62],
        [0.905_392_799_324_915_8, 0.009_607_651_600_974_322, 0.125_661_225_645_537_56],
    ),
    (
        2,
        [-0.559_438_389_214_622_6, 1.350_282_279_958_087_6, 0.000_251_319_972_678_484_7],
        [0.901_683_014_058_099_1, 0.019_214_980_514_512_904, 0.125_653_787_922_302_47],
    ),
    (
        100,
        [-0.490_222_513_285_094_86, 1.397_080_442_344_864_8, 0.011_755_697_435_901_803],
        [0.502_216_515_159_302_5, 0.912_660_522_201_297_1, 0.101_664_434_758_503_44],
    ),
    (
        500,
        [-0.632_336_028_449_084_5, 2.045_054_716_955_356, 8.675_802_907_633_77e-9],
        [-1.244_008_902_613_064_5, 1.261_350_496_978_131_7, -0.125_664_113_185_100_6],
    ),
    (
        1250,
        [-0.567_363_625_395_702_8, 1.350_474_651_125_280_8, 0.019_999_998_985_049_033],
        [0.933_330_280_869_791_9, -0.063_752_002_791_716_92, 5.451_186_112_424_258_5e-8],
    ),
    (
        2000,
        [-0.944_242_894_261_650_9, 2.061_109_141_819_579_7, -8.675_802_911_062_614e-9],
        [-0.730_497_466_838_947_1, -1.156_266_643_288_142_5, 0.125_664_113_185_100_9],
    ),
    (
        2750,
        [-0.461_152_721_137_332_5, 1.585_459_342_233_669_4, -0.019_999_998_985_049_03],
        [-0.074_117_875_205_443_05, 1.736_405_907_581_435_8, -5.451_186_121_970_658_6e-8],
    ),
    (
        3500,
        [-0.873_618_011_341_746_4, 1.644_824_038_374_924_6, 8.675_802_917_521_882e-9],
        [1.068_607_198_266_105_8, -1.834_327_520_544_726_5, -0.125_664_113_185_100_62],
    ),
    (
        5000,
        [-0.586_645_284_121_513_3, 1.353_642_622_663_298, -8.675_802_916_256_348e-9],
        [1.002_501_165_413_457_2, -0.254_128_058_040_142_3, 0.125_664_113_185_099_82],
    ),
];

/// Cycle, q, v without torque and gravity from q = (0, 1, 0), v = (3, −2, 0) (`scara_free.csv`).
pub(super) const FREE: [(usize, [f64; 2], [f64; 2]); 6] = [
    (
        1,
        [0.003_001_502_865_915_360_8, 0.997_991_201_395_600_2],
        [3.003_006_291_880_184, -2.017_601_014_547_441_5],
    ),
    (
        500,
        [1.714_852_492_022_293_6, -1.060_916_055_124_191_6],
        [2.891_861_486_754_337_7, -1.377_302_941_889_792_4],
    ),
    (
        1500,
        [3.617_327_226_511_616_5, 0.721_567_801_010_169_4],
        [3.340_483_066_349_476_4, -3.850_514_362_212_109],
    ),
    (
        2500,
        [5.894_931_598_232_819, 0.816_650_178_551_034_5],
        [1.460_788_020_685_348_7, 3.298_561_888_230_653],
    ),
    (
        3500,
        [8.827_637_042_893_121, -1.018_193_938_140_644_4],
        [2.046_839_715_468_586_5, 1.834_025_313_781_984_6],
    ),
    (
        5000,
        [12.304_602_326_926_238, -0.757_156_929_654_801_5],
        [1.312_750_586_903_465_5, 3.649_412_506_891_395_4],
    ),
];

/// `tau_ff` of cycle `k`.
fn feed_forward(dynamics: &mut Dynamics, cycle: u32) -> JointVector {
    let [q, v, a] = circle((f64::from(cycle) + 0.5) * 1e-3);
    dynamics.inverse_dynamics(&q, &v, &a)
}

#[test]
fn inverse_dynamics_is_pinocchios() {
    let mut dynamics = Dynamics::new(&scara(), 3, down(), JointVector::zeros()).unwrap();
    for (cycle, expected) in FEED_FORWARD {
        let effort = feed_forward(&mut dynamics, cycle);
        assert!(
            (effort - joints(expected)).amax() < 1e-13,
            "cycle {cycle}: {effort} is not {expected:?}"
        );
    }
}

/// Under the controller of the reference (held over each cycle) the machine does what pinocchio's does: within a
/// picometre after 5 s.
#[test]
fn the_closed_loop_is_pinocchios() {
    let mut dynamics = Dynamics::new(&scara(), 3, down(), JointVector::zeros()).unwrap();
    let [start, velocity, _] = circle(0.0);
    let mut machine = started(&scara(), &[SLACK; 3], down(), &axis_vector(&start, 3));
    machine.start_moving(velocity);

    let w = TAU * 15.0;
    let kp = joints([2.0, 0.3, 2.0]) * (w * w);
    let kd = joints([2.0, 0.3, 2.0]) * (2.0 * w);
    let mut worst = 0.0_f64;
    let mut compared = 0;
    for cycle in 0..5000 {
        let [q, v, _] = circle(f64::from(cycle) * 1e-3);
        let JointState { position, velocity } = machine.joints.axes;
        let effort = feed_forward(&mut dynamics, cycle)
            + kp.component_mul(&(q - position))
            + kd.component_mul(&(v - velocity));
        machine.step_with_efforts(&axis_vector(&effort, 3)).unwrap();
        for (_, q, v) in CLOSED_LOOP.iter().filter(|(at, ..)| *at == cycle + 1) {
            worst = worst.max((tip(&machine.joints.axes.position) - tip(&joints(*q))).norm());
            assert!((machine.joints.axes.velocity - joints(*v)).amax() < 1e-10, "cycle {cycle}");
            compared += 1;
        }
    }
    assert_eq!(compared, CLOSED_LOOP.len());
    assert!(worst < 1e-12, "the tip is {worst} m off");
    // It went somewhere: the circle is 5 / (2π/5) ≈ 4 turns.
    assert!((tip(&machine.joints.axes.position) - tip(&start)).norm() > 0.005);
}

/// The circle for drives.
pub(super) fn motion(t: f64) -> AxisMotion {
    let [position, velocity, acceleration] = circle(t).map(|values| axis_vector(&values, 3));
    AxisMotion { position, velocity, acceleration }
}

/// The largest distance of the tip from the circle, m, of drives with `limits` (N or Nm) that `servo` makes of the inertia of
/// an axis at the start, between 0.5 s and 2 s.
fn off_the_circle(limits: [f64; 3], servo: impl Fn(f64, f64) -> ServoParameters) -> f64 {
    let (model, start) = (scara(), motion(0.0));
    let inertia = axis_inertia(&model, &start.position).unwrap();
    let drives =
        [0, 1, 2].map(|axis| AxisDriveParameters::servo(servo(inertia[axis], limits[axis])));
    let mut machine = started(&model, &drives, down(), &start.position);
    machine.start_moving(circle(0.0)[1]);
    machine.setpoint.acceleration = start.acceleration;
    let mut worst = 0.0_f64;
    for cycle in 1..=2000 {
        let set = motion(f64::from(cycle) * 1e-3);
        let state = machine.step(&set).unwrap();
        assert!(state.effort.iter().zip(limits).all(|(effort, limit)| effort.abs() <= limit));
        assert_eq!(state.saturated, [false; MAX_AXES]);
        if cycle > 500 {
            let [found, set] = [&state.position, &set.position]
                .map(|axes| tip(&joint_vector(axes.iter().copied())));
            worst = worst.max((found - set).norm());
        }
    }
    worst
}

/// The drives themselves, tuned by rule for one pose, keep the tip near the circle. Coupling of the arms is a disturbance to
/// drives that know one inertia each: not zero, but small.
#[test]
fn the_drives_follow_the_circle() {
    let tuned = |inertia, limit| {
        ServoParameters::tuned(inertia, ServoParameters::DEFAULT_BANDWIDTH_HZ, limit)
    };
    let worst = off_the_circle([60.0, 30.0, 80.0], tuned);
    assert!(worst < 1e-3, "{worst} m");
    assert!(worst > 1e-7, "no real drive is that good: {worst} m");
}

/// Fed forward the machine's own dynamics, the drives have little left to do.
#[test]
fn dynamic_feed_forward_leaves_micrometres() {
    let worst = off_the_circle([100.0; 3], |inertia, limit| ServoParameters {
        effort_feed_forward: EffortFeedForward::Dynamics(1.0),
        ..ServoParameters::tuned(inertia, 50.0, limit)
    });
    assert!(worst < 0.1e-6, "{worst} m");
}
