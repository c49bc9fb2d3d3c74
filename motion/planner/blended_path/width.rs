//! Width of a blend: as wide as the tolerance allows.

use super::deviation::{Check, completed};
use super::element::SAME_PLACE;
use super::joint::{SLOWEST, Steps};
use super::{Blend, BlendOptions, BlendedPoint, Order};
use nalgebra::SVector;
use twin_path::prepare::CheckedElement;

/// The part of an element that each of its two blends may take.
const SHARE: f64 = 0.5;
/// Between two blends there is nothing, or more than this part of the narrower one: in less the third derivative would come and go
/// within microseconds.
pub(super) const SLIVER: f64 = 0.06;
/// No blend is narrower on either side, m.
const NARROWEST: f64 = 1e-15;
/// Nor than this multiple of the error of the coordinates.
const DIGITS: f64 = 1e3;

/// Deviation of blends from the path, for each half width d.
#[derive(Clone, Copy, Debug)]
struct Form {
    /// For a step of the first derivative of 1, by d: of two lines, in the middle. For lines that turn by θ the step is
    /// 2·sin(θ/2).
    tangent: f64,
    /// For a step of the second derivative of 1, by d².
    curvature: f64,
    /// For a step of the third derivative of 1, by d³.
    rate: f64,
    /// For a circle of curvature 1, by d to the [`Self::power`]: the interpolation error.
    circle: f64,
    power: i32,
}

/// Quintics. The second is a quarter of the largest 3x/8 + 3x³/4 − x⁵/8 − x², which is at x = 0.27, the last 1/6!.
const QUINTIC: Form = Form {
    tangent: 3.0 / 16.0,
    curvature: 0.010_74,
    // Such steps stay.
    rate: 0.0,
    circle: 1.0 / 720.0,
    power: 6,
};
/// Septics. The second is at x = ±0.23, the third in the middle, the last 1/8!.
const SEPTIC: Form = Form {
    tangent: 5.0 / 32.0,
    curvature: 0.007_55,
    rate: 1.0 / 192.0,
    circle: 1.0 / 40_320.0,
    power: 8,
};

impl Form {
    fn of(order: Order) -> &'static Self {
        if order == Order::Jerk { &SEPTIC } else { &QUINTIC }
    }
}
/// Curvatures beyond this one (1/m) count as it; their powers stay finite.
const SHARPEST: f64 = 1e30;

/// Deviations that are found are within the tolerance by this part of it, at most and at least aimed at.
const AIM: f64 = 0.98;
const ENOUGH: f64 = 0.9;
/// Largest number of widths tried after the first one that fits. One or two are the rule.
const TRIALS: u32 = 12;
/// Largest number of widths tried until then: halved that often the longest element is as short as the shortest.
const MOST_TRIALS: u32 = 100;
/// Largest number of widths that the deviations may prove too wide.
const PATIENCE: u32 = 3;
/// Number of intervals on each side in which deviations are sampled.
const INTERVALS: u8 = 8;

/// Reason why a joint is not blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoBlend {
    /// All blends nearly stand still somewhere.
    Folds,
    /// There is no room for one within the tolerance.
    TooShort,
}

/// The widest blend between two elements, of which the first begins with one that reaches to `head`, m: at most half of
/// either, and if it is narrower than that, the tolerance is used up to a tenth, or one that is wider by a tenth is not
/// within it, folds, or lets the path bend by about 2 rad beside it. It is a little narrower where next to nothing would be
/// left between the two.
pub(super) fn widest(
    from: &CheckedElement,
    to: &CheckedElement,
    head: f64,
    steps: &Steps,
    options: &BlendOptions,
) -> Result<Blend, NoBlend> {
    let blend = widest_alone(from, to, steps, options)?;
    let (width, free) = (blend.half_width(), from.path_length() - head);
    let between = SLIVER * width.min(head);
    if free - width > SAME_PLACE * from.path_length() && free - width < between {
        let trial = Trial::new(from, to, steps, options, free - between);
        if let (true, Some(narrower)) = (trial.fits(), trial.blend) {
            return Ok(narrower);
        }
    }
    Ok(blend)
}

/// The same, whatever is before.
fn widest_alone(
    from: &CheckedElement,
    to: &CheckedElement,
    steps: &Steps,
    options: &BlendOptions,
) -> Result<Blend, NoBlend> {
    let most = SHARE * from.path_length().min(to.path_length());
    let least = NARROWEST.max(DIGITS * steps.blur);
    if most < least {
        return Err(NoBlend::TooShort);
    }
    let form = Form::of(options.order);
    let expected = [
        Expected::in_space(steps, form, AIM * options.tolerance, most),
        Expected::of_extra_axes(steps, form, AIM * options.extra_tolerance, most),
    ];
    let highest = f64::from(form.power);
    let first = expected.iter().fold(most, |width, expected| width.min(expected.width));
    let mut half_width = first.max(least);
    let mut good: Option<(f64, Blend)> = None;
    // The smallest that was too wide, and what the last trials found.
    let (mut too_wide, mut folds) = (f64::INFINITY, false);
    let mut last: Option<[f64; 2]> = None;
    for count in 0..MOST_TRIALS {
        if good.is_some() && count >= TRIALS {
            break;
        }
        let trial = Trial::new(from, to, steps, options, half_width);
        // By which power of the width the deviation grows: as between the last two trials, or as expected.
        let power = last
            .map(|[width, deviation]| {
                (trial.deviation / deviation).ln() / (half_width / width).ln()
            })
            .filter(|power| power.is_finite())
            .unwrap_or_else(|| expected.iter().map(|e| e.power(half_width)).fold(highest, f64::min))
            .clamp(1.0, highest);
        last = Some([half_width, trial.deviation]);
        let by = (AIM / trial.deviation).powf(power.recip());
        let fits = trial.fits();
        folds = trial.folds;
        if let (true, Some(blend)) = (fits, trial.blend) {
            let used_up = trial.deviation >= ENOUGH || half_width >= most;
            good = Some((half_width, blend));
            if used_up || half_width * 1.1 >= too_wide {
                break;
            }
        } else {
            too_wide = half_width;
            if half_width <= least {
                break;
            }
        }
        // Where the path bends much the deviation says nothing about that of other widths: half as wide.
        let known = fits || trial.deviation.is_finite() && !trial.folds && !trial.coarse;
        let patient = good.is_some() || fits || count < PATIENCE;
        let wanted = half_width * if known && patient { by } else { by.clamp(0.1, 0.5) };
        let widest_good = good.as_ref().map_or(least, |(width, _)| *width);
        // Between a width that will do and one that is too wide, some way from both: the bounds close in.
        let between = |part: f64| widest_good * (too_wide / widest_good).powf(part);
        half_width = if good.is_some() && too_wide.is_finite() {
            wanted.max(between(0.25)).min(between(0.75))
        } else {
            wanted.max(widest_good).min(16.0 * half_width).min(most)
        };
    }
    match good {
        Some((_, blend)) => Ok(blend),
        None if folds => Err(NoBlend::Folds),
        None => Err(NoBlend::TooShort),
    }
}

/// The deviation in powers of the half width d: `tangent`·d + `curvature`·d² + `rate`·d³ + `circle`·dⁿ, and the `width` at
/// which it is as large as allowed.
#[derive(Clone, Copy, Debug)]
struct Expected {
    tangent: f64,
    curvature: f64,
    rate: f64,
    circle: f64,
    /// n.
    power: i32,
    width: f64,
}

impl Expected {
    fn in_space(steps: &Steps, form: &Form, tolerance: f64, most: f64) -> Self {
        let joint = steps.joint();
        let bend = steps.before.second.norm().max(steps.after.second.norm()).min(SHARPEST);
        let jumps = [joint.tangent_jump, joint.curvature_jump, joint.curvature_rate_jump];
        Self::new(form, jumps, bend.powi(form.power - 1), tolerance, most)
    }

    fn of_extra_axes(steps: &Steps, form: &Form, tolerance: f64, most: f64) -> Self {
        let joint = steps.joint();
        let jumps = [joint.extra_slope_jump, joint.extra_curvature_jump, 0.0];
        Self::new(form, jumps, 0.0, tolerance.max(rounding(steps)), most)
    }

    fn new(
        form: &Form,
        [tangent, curvature, rate]: [f64; 3],
        circle: f64,
        tolerance: f64,
        most: f64,
    ) -> Self {
        let [tangent, curvature, rate, circle] = [
            tangent * form.tangent,
            curvature * form.curvature,
            rate * form.rate,
            circle * form.circle,
        ];
        let power = f64::from(form.power);
        // Each term alone: at most four times the tolerance, and from above Newton's method comes down to it.
        let alone = [
            tolerance / tangent,
            (tolerance / curvature).sqrt(),
            (tolerance / rate).cbrt(),
            (tolerance / circle).powf(power.recip()),
        ];
        let mut width = alone.into_iter().fold(most, f64::min);
        for _ in 0..3 {
            let bent = width.powi(form.power - 1);
            let square = width * width;
            let beyond =
                (tangent + curvature * width + rate * square + circle * bent) * width - tolerance;
            let slope =
                tangent + 2.0 * curvature * width + 3.0 * rate * square + power * circle * bent;
            if !(beyond > 0.0 && slope > 0.0) {
                break;
            }
            width -= beyond / slope;
        }
        Self { tangent, curvature, rate, circle, power: form.power, width }
    }

    /// The power of the width by which the deviation grows there; n if there is none.
    fn power(&self, width: f64) -> f64 {
        let most = f64::from(self.power);
        let [one, two, three, last] = [
            self.tangent,
            self.curvature * width,
            self.rate * width * width,
            self.circle * width.powi(self.power - 1),
        ];
        let power = (one + 2.0 * two + 3.0 * three + most * last) / (one + two + three + last);
        if power.is_finite() { power } else { most }
    }
}

/// Rounding of the extra axes, u, which does not count as a deviation.
fn rounding(steps: &Steps) -> f64 {
    let far =
        |at: &BlendedPoint| at.extra.map_or(0.0, |extra| SVector::from(extra.position).amax());
    16.0 * f64::EPSILON * far(&steps.before).max(far(&steps.after))
}

/// A blend compared with the path that it replaces.
struct Trial {
    /// None if it leads to what is not a number.
    blend: Option<Blend>,
    /// Its largest deviation, as a part of what is allowed.
    deviation: f64,
    /// It is too slow somewhere.
    folds: bool,
    /// The path bends too much between the points at which the deviation was looked at.
    coarse: bool,
}

impl Trial {
    fn new(
        from: &CheckedElement,
        to: &CheckedElement,
        steps: &Steps,
        options: &BlendOptions,
        half_width: f64,
    ) -> Self {
        let length = from.path_length();
        let start = completed(BlendedPoint::of(from, length - half_width), &steps.before);
        let end = completed(BlendedPoint::of(to, half_width), &steps.after);
        let none = Self { blend: None, deviation: f64::INFINITY, folds: false, coarse: false };
        let Some(blend) = Blend::new(half_width, steps.after.position, &start, &end, options.order)
        else {
            return none;
        };
        let mut check = Check {
            blend: &blend,
            tolerance: options.tolerance,
            extra_tolerance: options.extra_tolerance.max(rounding(steps)),
            deviation: 0.0,
            slowest: [f64::INFINITY; 2],
            coarse: false,
        };
        let step = half_width / f64::from(INTERVALS);
        let way = |count: u8| step * f64::from(count);
        let inner = || 1..INTERVALS;
        let before = inner().rev().map(|count| {
            let point = BlendedPoint::of(from, length - way(count));
            (-way(count), completed(point, &steps.before))
        });
        check.side([(-half_width, start)].into_iter().chain(before).chain([(0.0, steps.before)]));
        let after = inner()
            .map(|count| (way(count), completed(BlendedPoint::of(to, way(count)), &steps.after)));
        check.side([(0.0, steps.after)].into_iter().chain(after).chain([(half_width, end)]));
        let Check { deviation, slowest: [blended, original], coarse, .. } = check;
        let folds = blended < SLOWEST * original;
        // Without a number it must not fit.
        let deviation = if deviation.is_nan() { f64::INFINITY } else { deviation };
        Self { blend: Some(blend), deviation, folds, coarse }
    }

    fn fits(&self) -> bool {
        self.blend.is_some() && self.deviation <= 1.0 && !self.folds && !self.coarse
    }
}
