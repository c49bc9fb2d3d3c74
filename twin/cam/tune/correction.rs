//! Correction of a deviation: the coupling with which a measured slave does the wanted motion.

use super::super::check::CamUse;
use super::same;
use twin_cam::file::clean;
use twin_cam::tune::{Estimate, Fit};
use twin_machine::cam_file::CamFile;

/// A deviation that is smaller than this part of what it is measured against is rounding, whatever its interval says.
const ROUNDING: f64 = 1e-9;

/// What the slave is to do: the coupling that the cam's file says is `wanted_…`, or else the coupling in effect.
pub(crate) fn wanted(using: &CamUse) -> CamUse {
    using.coupling.wanted.map_or(*using, |values| with_exactly(using, values))
}

/// What was fitted, as a use of the cam.
pub(crate) fn as_fitted(using: &CamUse, fit: &Fit) -> CamUse {
    with_exactly(using, fit.estimates.map(|found| found.value))
}

/// Deviation of a measured slave from its set-point p: it is at γ · p + d and sees the master m at κ · m + c. That is gain, shift and,
/// at one velocity of the master, lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deviation {
    /// The coupling that was in effect: `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    commanded: [f64; 4],
    /// The coupling that the slave did.
    did: [f64; 4],
    /// How well that is known: the half widths of the 95 % intervals.
    known: [f64; 4],
}

impl Deviation {
    /// The coupling in effect and the measured one. A deviation within its interval does not count.
    fn new(file: &CamFile, using: &CamUse, fit: &Fit) -> Self {
        let curve = file.cam.curve();
        let (width, rise) = (curve.end() - curve.start(), curve.rise());
        let height = curve.extremes().position;
        let height = (height.max - height.min).abs();
        let target = of_coupling(&wanted(using));
        let mut did = fit.estimates;
        if using.repeated && width > 0.0 {
            // Whole passes are the same cam, up to what it gains.
            let passes = ((did[0].value - target[0]) / width).round();
            if rise == 0.0 || did[2].half_width > 0.0 {
                did[0].value -= passes * width;
                did[2].value += did[3].value * passes * rise;
            }
        }
        let scales = [width, 1.0, height, 1.0];
        let did = [0, 1, 2, 3].map(|index: usize| {
            let Estimate { value, half_width } = did[index];
            let by = (value - target[index]).abs();
            if by <= half_width.max(ROUNDING * scales[index]) { target[index] } else { value }
        });
        let known = fit.estimates.map(|found| found.half_width);
        Self { commanded: of_coupling(using), did, known }
    }

    /// The coupling to command so that the slave does `target`.
    fn undone(&self, target: [f64; 4]) -> [f64; 4] {
        let ([offset, scaling, shift, factor], did) = (self.commanded, self.did);
        let (by, gain) = (target[1] / did[1], factor / did[3]);
        [
            target[0] - by * (did[0] - offset),
            scaling * by,
            shift + (target[2] - did[2]) * gain,
            target[3] * gain,
        ]
    }

    /// Half widths of [`Self::undone`]. Those of gain and shift are added, so they hold however the two correlate.
    fn commanded_within(&self, target: [f64; 4]) -> [f64; 4] {
        let ([offset, scaling, _, factor], did, known) = (self.commanded, self.did, self.known);
        let (by, gain) = ((target[1] / did[1]).abs(), (factor / did[3]).abs());
        let parts = [known[1] / did[1].abs(), known[3] / did[3].abs()];
        [
            by * (known[0] + (did[0] - offset).abs() * parts[0]),
            scaling.abs() * by * parts[0],
            gain * (known[2] + (target[2] - did[2]).abs() * parts[1]),
            target[3].abs() * gain * parts[1],
        ]
    }

    /// The coupling that the slave does with a commanded one.
    pub(super) fn done(&self, commanded: [f64; 4]) -> [f64; 4] {
        let ([offset, scaling, shift, factor], did) = (self.commanded, self.did);
        let (by, gain) = (commanded[1] / scaling, did[3] / factor);
        [
            commanded[0] + by * (did[0] - offset),
            did[1] * by,
            did[2] + (commanded[2] - shift) * gain,
            commanded[3] * gain,
        ]
    }

    /// Where the slave has the master that is at `master`, as far as the coupling in effect is concerned.
    pub(super) fn sees(&self, master: f64) -> f64 {
        (self.did[1] * master + self.did[0] - self.commanded[0]) / self.commanded[1]
    }

    /// The set-point of a slave that was measured at `position`.
    pub(super) fn commanded_at(&self, position: f64) -> f64 {
        self.commanded[2] + (position - self.did[2]) * self.commanded[3] / self.did[3]
    }
}

/// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
pub(super) fn of_coupling(using: &CamUse) -> [f64; 4] {
    let input = &using.coupling.input;
    [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling]
}

/// The same with other values; those that are as before stay to the last bit.
pub(super) fn with_values(using: &CamUse, values: [f64; 4]) -> CamUse {
    let old = of_coupling(using);
    let value = |index: usize| {
        if same(old[index], values[index]) { old[index] } else { clean(values[index]) }
    };
    with_exactly(using, [0, 1, 2, 3].map(value))
}

/// The same, with every value as it is.
pub(crate) fn with_exactly(using: &CamUse, values: [f64; 4]) -> CamUse {
    let mut new = *using;
    let input = &mut new.coupling.input;
    [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling] = values;
    new
}

/// The coupling with which a slave does the wanted motion, and its deviation; `fit` is of a run with `using` in effect.
///
/// The coupling in effect and the measured one determine gain, shift and lag; the new coupling undoes them. So the same machine with the
/// new coupling shows no deviation, and another run changes nothing. What deviates by no more than its interval stays as it is.
pub(crate) fn corrected(file: &CamFile, using: &CamUse, fit: &Fit) -> (CamUse, Deviation) {
    let deviation = Deviation::new(file, using, fit);
    let target = of_coupling(&wanted(using));
    let [offset, scaling, shift, factor] =
        [0, 1, 2, 3].map(|index: usize| same(deviation.did[index], target[index]));
    let stays = [scaling && offset, scaling, shift, factor];
    let (old, undone) = (of_coupling(using), deviation.undone(target));
    let value = |index: usize| {
        let proposed = Estimate { value: undone[index], ..fit.estimates[index] };
        if stays[index] { old[index] } else { super::rounded(proposed) }
    };
    let mut new = with_exactly(using, [0, 1, 2, 3].map(value));
    if new.coupling.input != using.coupling.input {
        new.coupling.wanted = Some(target);
    }
    (new, deviation)
}

/// What undoes a deviation, of `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`, with its half widths.
pub(crate) fn within(deviation: &Deviation, target: &CamUse, new: &CamUse) -> [Estimate; 4] {
    let (values, half) = (of_coupling(new), deviation.commanded_within(of_coupling(target)));
    [0, 1, 2, 3].map(|index: usize| Estimate { value: values[index], half_width: half[index] })
}
