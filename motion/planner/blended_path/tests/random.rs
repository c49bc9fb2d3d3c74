//! Random paths of all shapes: the invariants at every joint.

use super::*;
use crate::blended_path::width::SLIVER;
use nalgebra::Vector2;
use proptest::prelude::*;
use std::f64::consts::TAU;
use twin_path::{AxisMask, Cubic, Ellipse};

/// One more element from where the path is.
#[derive(Clone, Debug)]
struct Step {
    form: Form,
    /// Goes on in the direction in which the path arrives, where its form can.
    straight_on: bool,
    /// How far P and Q move, u.
    extra: [f64; 2],
    s_profile: AxisMask,
}

#[derive(Clone, Copy, Debug)]
enum Form {
    Line { way: [f64; 3] },
    Arc { plane: Plane, to_center: [f64; 2], sweep: f64, rise: f64 },
    Ellipse { axes: [f64; 2], turn: f64, from: f64, sweep: f64, rise: f64 },
    Cubic { way: [f64; 3], start: [f64; 2], end: [f64; 2] },
}

fn form() -> impl Strategy<Value = Form> {
    let way = || -0.1..0.1;
    let pair = move || [way(), way()];
    let triple = || [-0.1..0.1, -0.1..0.1, -0.02..0.02];
    let sweep = || prop_oneof![-1.9 * PI..-0.05, 0.05..1.9 * PI];
    let plane = prop_oneof![Just(Plane::Xy), Just(Plane::Zx), Just(Plane::Yz)];
    prop_oneof![
        3 => triple().prop_map(|way| Form::Line { way }),
        3 => (plane, pair(), sweep(), prop_oneof![Just(0.0), -0.02..0.02])
            .prop_map(|(plane, to_center, sweep, rise)| Form::Arc { plane, to_center, sweep, rise }),
        1 => ([0.01..0.1, 0.005..0.1], 0.0..TAU, 0.0..TAU, sweep(), -0.02..0.02).prop_map(
            |(axes, turn, from, sweep, rise)| Form::Ellipse { axes, turn, from, sweep, rise }
        ),
        2 => (triple(), pair(), pair())
            .prop_map(|(way, start, end)| Form::Cubic { way, start, end }),
    ]
}

fn step() -> impl Strategy<Value = Step> {
    let masks = [AxisMask::default(), AxisMask::extra(0), AxisMask::Z];
    let s_profile = prop_oneof![4 => Just(masks[0]), 1 => Just(masks[1]), 1 => Just(masks[2])];
    let extra = prop_oneof![Just([0.0; 2]), [-9.0..9.0, -9.0..9.0]];
    (form(), any::<bool>(), extra, s_profile).prop_map(|(form, straight_on, extra, s_profile)| {
        Step { form, straight_on, extra, s_profile }
    })
}

impl Form {
    /// From `at`; `along` is the direction it shall take, if any.
    fn shape(self, at: Point3<f64>, along: Option<Vector3<f64>>) -> Shape {
        match self {
            Self::Line { way } => {
                let way = Vector3::from(way);
                let way = along.map_or(way, |along| along * way.norm());
                Shape::Line { start: at, end: at + way }
            }
            Self::Arc { plane, to_center, sweep, rise } => {
                let spoke = Vector2::from(to_center);
                let across = along.and_then(|along| {
                    let [x, y, _] = plane.split(&along);
                    Vector2::new(-y, x).try_normalize(1e-3)
                });
                let spoke = across.map_or(spoke, |across| across * (spoke.norm() * sweep.signum()));
                let [x, y, z] = plane.split(&at.coords);
                arc(plane, [x, y, z], [x + spoke.x, y + spoke.y], sweep, rise).shape
            }
            Self::Ellipse { axes: [major, minor], turn, from, sweep, rise } => {
                let along = Vector2::new(turn.cos(), turn.sin());
                let left = Vector2::new(-along.y, along.x);
                let spoke =
                    |angle: f64| along * (major * angle.cos()) + left * (minor * angle.sin());
                let center = at.xy() - spoke(from);
                let end = center + spoke(from + sweep);
                let end = Point3::new(end.x, end.y, at.z + rise);
                let made = Ellipse::new(at, end, center, along * major, minor, sweep);
                Shape::Ellipse(Box::new(made))
            }
            Self::Cubic { way, start, end } => {
                let begins = Vector2::from(start);
                let begins = along
                    .and_then(|along| along.xy().try_normalize(1e-3))
                    .map_or(begins, |along| along * begins.norm());
                let to = at + Vector3::from(way);
                Shape::Cubic(Box::new(Cubic::hermite(at, to, begins, end.into())))
            }
        }
    }
}

fn walk(steps: Vec<Step>, origin: f64) -> Vec<PathElement> {
    let mut at = Point3::new(origin, origin, 0.0);
    let (mut direction, mut extra) = (None, [0.0; 5]);
    let mut path = Vec::new();
    for Step { form, straight_on, extra: way, s_profile } in steps {
        let shape = form.shape(at, direction.filter(|_| straight_on));
        // Too short to have a direction that means anything.
        if shape.length() < 1e-4 {
            continue;
        }
        let start = extra;
        extra = [extra[0] + way[0], extra[1] + way[1], 0.0, 0.0, 0.0];
        let extra = Some(ExtraAxes { start, end: extra });
        let mut next = element(ElementKind::Cut, shape);
        next.details = Some(Box::new(Details { extra, s_profile, ..Details::default() }));
        at = next.end();
        direction = next.end_tangent().try_normalize(0.0);
        path.push(next);
    }
    path
}

pub(super) fn path() -> impl Strategy<Value = Vec<PathElement>> {
    let origin = prop_oneof![Just(0.0), -2.0..2.0];
    (prop::collection::vec(step(), 2..8), origin).prop_map(|(steps, origin)| walk(steps, origin))
}

pub(super) fn options() -> impl Strategy<Value = BlendOptions> {
    let exponent = || -7.0..-2.0;
    let order = prop_oneof![Just(Order::Velocity), Just(Order::Acceleration), Just(Order::Jerk)];
    (exponent(), exponent(), order).prop_map(|(space, extra, order)| BlendOptions {
        tolerance: 10_f64.powf(space),
        extra_tolerance: 1e3 * 10_f64.powf(extra),
        order,
        turning: false,
    })
}

/// How far a position and its derivatives may be apart by rounding: those of a quintic of this `width`, m, are made of
/// positions of this `size` and of these derivatives.
fn rounding(size: f64, [first, second, third]: [f64; 3], width: f64) -> [f64; 4] {
    let slope = 1e-12 * (first + second * width + third * width * width) + 1e-13 * size / width;
    [1e-14 * size, slope, slope / width, 10.0 * slope / (width * width)]
}

/// The derivatives up to the `order`-th are the same on both sides.
fn same(a: &BlendedPoint, b: &BlendedPoint, width: f64, order: usize) -> Result<(), TestCaseError> {
    let (space, extra) = steps(a, b);
    let norms = |p: &BlendedPoint| [p.first.norm(), p.second.norm(), p.third.norm()];
    let norms_u = |p: &BlendedPoint| {
        let extra = p.extra.unwrap_or_default();
        [extra.first, extra.second, extra.third].map(|value| SVector::from(value).amax())
    };
    let larger = |[a, b]: [[f64; 3]; 2]| [0, 1, 2].map(|order| f64::max(a[order], b[order]));
    let size = 1.0 + a.position.coords.amax();
    let size_u = 1.0 + SVector::from(a.extra.unwrap_or_default().position).amax();
    let allowed = rounding(size, larger([norms(a), norms(b)]), width);
    let allowed_u = rounding(size_u, larger([norms_u(a), norms_u(b)]), width);
    for derivative in 0..=order {
        prop_assert!(space[derivative] <= allowed[derivative], "{derivative}: {a:?} {b:?}");
        prop_assert!(extra[derivative] <= allowed_u[derivative], "{derivative}: {a:?} {b:?}");
    }
    Ok(())
}

/// Weights of the central difference of eighth order.
pub(super) const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];

proptest! {
    /// One value on either side of every joint that is blended and at both ends of every blend, up to the second
    /// derivative, or the third if that is asked for; in the middle of a blend the third in any case. What is not blended has
    /// no step but what it says.
    #[test]
    fn twice_continuously_differentiable(path in path(), options in options()) {
        let course = course(path, options);
        for pair in course.windows(2) {
            let [a, b] = pair else { unreachable!() };
            let (before, after) = (a.at(a.length()), b.at(0.0));
            if let Some(blend) = a.tail() {
                let d = blend.half_width();
                same(&before, &after, d, 3)?;
                let order = if options.order == Order::Jerk { 3 } else { 2 };
                same(&a.at(a.length() - d), &original(a, a.length() - d), d, order)?;
                same(&b.at(d), &original(b, d), d, order)?;
                prop_assert_eq!(a.joint(), Joint::default());
                // From beside, not by the formulas of the blend: the third derivative times the distance at most.
                for (element, s) in [(a, a.length() - d), (b, d)] {
                    let h = 1e-6 * d;
                    let [left, right] = [s - h, s + h].map(|s| element.at(s));
                    let jump = (right.second - left.second).norm();
                    let third = left.third.norm() + right.third.norm();
                    prop_assert!(jump <= 1.1 * h * third + 1e-8 * (left.second.norm() + 1.0 / d));
                }
            } else if !a.joint().stop {
                let joint = a.joint();
                let (space, extra) = steps(&before, &after);
                let said = |said: f64, step: f64, small: f64| said == step || said == 0.0 && step < small;
                let shorter = a.length().min(b.length());
                prop_assert!(said(joint.tangent_jump, space[1], 1e-8));
                prop_assert!(said(joint.extra_slope_jump, extra[1], 1e-6 / shorter));
                let bend = before.second.norm().max(after.second.norm()) + 1.0 / shorter;
                prop_assert!(said(joint.curvature_jump, space[2], 1e-8 * bend));
                if options.order != Order::Velocity {
                    prop_assert!(joint.curvature_jump == 0.0, "{joint:?}");
                }
                prop_assert!(joint.curvature_rate_jump == 0.0, "{joint:?}");
                prop_assert!(joint.tangent_jump == 0.0 && joint.extra_slope_jump == 0.0);
            }
        }
    }

    /// Between the points at which the width was chosen, too; and no half reaches beyond the middle of its element.
    #[test]
    fn within_the_tolerance(path in path(), options in options()) {
        let course = course(path, options);
        let [space, extra] = deviation(&course, 300);
        prop_assert!(space <= options.tolerance * (1.0 + 1e-9), "{space}");
        prop_assert!(extra <= options.extra_tolerance * (1.0 + 1e-9), "{extra}");
        for element in &course {
            let width = |blend: Option<&std::sync::Arc<Blend>>| {
                blend.map_or(0.0, |blend| blend.half_width())
            };
            let (head, tail) = (width(element.head()), width(element.tail()));
            prop_assert!(head <= 0.5 * element.length() && tail <= 0.5 * element.length());
            let breaks: Vec<_> = element.breaks().collect();
            prop_assert!(breaks.windows(2).all(|pair| pair[0] < pair[1]), "{breaks:?}");
            prop_assert_eq!((breaks[0], *breaks.last().unwrap()), (0.0, element.length()));
            let inner = [head, element.length() - tail];
            let near = |s: &f64| breaks.iter().any(|at| (at - s).abs() <= 1e-9 * element.length());
            prop_assert!(inner.iter().all(near), "{breaks:?} {inner:?}");
            for blend in [element.head(), element.tail()].into_iter().flatten() {
                let d = blend.half_width();
                let slowest = (0..=100).map(|part| blend.at(d * (f64::from(part) * 0.02 - 1.0)).first.norm());
                prop_assert!(slowest.fold(f64::INFINITY, f64::min) > 0.0);
            }
        }
    }

    /// A blend is as wide as half of the shorter element, or uses the tolerance up, or would be off by more than that if
    /// it were a tenth wider; or the path bends too much, or the blend is slow already; or it leaves as little between itself and
    /// the blend before as may be left at least.
    #[test]
    fn as_wide_as_it_may_be(path in path(), options in options()) {
        let course = course(path, options);
        for pair in course.windows(2) {
            let [a, b] = pair else { unreachable!() };
            let Some(blend) = a.tail() else { continue };
            let d = blend.half_width();
            let most = 0.5 * a.length().min(b.length());
            let beside = |way: f64| {
                if way < 0.0 { original(a, a.length() + way) } else { original(b, way) }
            };
            let wide = 1.1 * d;
            let ends = [beside(-wide), beside(wide)];
            let wider = Blend::new(wide, b.at(0.0).position, &ends[0], &ends[1], options.order).unwrap();
            let [mut used, mut beyond] = [0.0_f64; 2];
            let (mut bend, mut slowest, mut last) = (0.0, f64::INFINITY, None::<Vector3<f64>>);
            for part in 0..=400 {
                let part = f64::from(part) / 200.0 - 1.0;
                for (blend, used) in [(&**blend, &mut used), (&wider, &mut beyond)] {
                    let way = part * blend.half_width();
                    let (space, extra) = steps(&blend.at(way), &beside(way));
                    let parts = [space[0] / options.tolerance, extra[0] / options.extra_tolerance];
                    *used = used.max(parts[0]).max(parts[1]);
                }
                slowest = slowest.min(blend.at(part * d).first.norm());
                let first = beside(part * wide).first;
                bend += last.replace(first).map_or(0.0, |from| (first - from).norm());
            }
            let step = (b.element().start_tangent() - a.element().end_tangent()).norm();
            let limited = used > 0.85 || beyond > 0.85 || bend - step > 0.3 || slowest < 0.2;
            let (head, rounding) = (a.head_end(), 1.0 + 1e-9);
            let beside_head = head > 0.0
                && a.length() - head - d <= SLIVER * most.min(head) * rounding;
            let wide = d == most || limited || beside_head;
            prop_assert!(wide, "{d} of {most}, {used}, {beyond}, {bend}, {slowest}, {head}");
        }
    }

    /// Each derivative is that of the one before, by differences that are exact for a polynomial of its degree.
    #[test]
    fn derivatives_are_differences(path in path(), options in options(), part in -0.9..0.9) {
        let course = course(path, options);
        for element in &course {
            let Some(blend) = element.tail() else { continue };
            let d = blend.half_width();
            let (way, h) = (part * d, 0.02 * d);
            let here = blend.at(way);
            let mut found = [Vector3::zeros(); 3];
            let mut found_u = [SVector::<f64, 5>::zeros(); 3];
            let mut fourth = Vector3::zeros();
            for (weight, step) in WEIGHTS.iter().zip(1..) {
                let by = h * f64::from(step);
                let [right, left] = [way + by, way - by].map(|way| blend.at(way));
                let [of, off] = [&right, &left].map(|p| [p.position.coords, p.first, p.second]);
                let [of_u, off_u] = [right, left].map(|p| p.extra.unwrap_or_default())
                    .map(|p| [p.position, p.first, p.second].map(SVector::from));
                fourth += (right.third - left.third) * (weight / h);
                for order in 0..3 {
                    found[order] += (of[order] - off[order]) * (weight / h);
                    found_u[order] += (of_u[order] - off_u[order]) * (weight / h);
                }
            }
            let [first, second, third] = found;
            let differences = BlendedPoint { position: here.position, first, second, third, ..here };
            let [first, second, third] = found_u.map(Into::into);
            let extra = here.extra.map(|at| twin_path::ExtraPoint { first, second, third, ..at });
            same(&here, &BlendedPoint { extra, ..differences }, 0.003 * d, 3)?;
            let size = here.first.norm() + (here.second.norm() + here.third.norm() * d) * d + 1.0;
            let off = (blend.fourth(way) - fourth.xy()).norm();
            prop_assert!(off <= 1e-8 * (size / d / d / d + fourth.norm()), "{off} of {}", fourth.norm());
        }
    }
}
