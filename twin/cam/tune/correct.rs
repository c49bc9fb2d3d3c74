//! From what a slave did to the coupling with which it does what is wanted.

use super::super::CamFile;
use super::super::check::CamUse;
use super::same;
use twin_motion::cam::file::clean;
use twin_motion::cam::tune::{Estimate, Fit};

/// A deviation that is smaller than this part of what it is measured against is rounding, whatever its interval says.
const ROUNDING: f64 = 1e-9;

/// What the slave is to do: the coupling that the cam's file says is `wanted_…`, or else the coupling as it stands.
pub fn wanted(using: &CamUse) -> CamUse {
    let mut wanted = *using;
    if let Some(values) = using.coupling.wanted {
        let input = &mut wanted.coupling.input;
        [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling] =
            values;
    }
    wanted
}

/// What was fitted, as a use of the cam.
pub fn as_fitted(using: &CamUse, fit: &Fit) -> CamUse {
    let mut fitted = *using;
    let input = &mut fitted.coupling.input;
    input.master_offset = fit.master_offset.value;
    input.master_scaling = fit.master_scaling.value;
    input.slave_offset = fit.slave_offset.value;
    input.slave_scaling = fit.slave_scaling.value;
    fitted
}

/// How a slave that was measured deviates from what it is told: it is where a line has it of where it should be, γ · p + d, and
/// sees the master so, too, κ · m + c: gain, shift and, at one velocity of the master, lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The coupling that was in effect: `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
    told: [f64; 4],
    /// The coupling that the slave did.
    did: [f64; 4],
    /// How well that is known: the half widths of the 95 % intervals.
    known: [f64; 4],
}

impl Deviation {
    /// What was in effect and what came of it. What deviates from what is wanted by no more than its interval does not.
    fn new(file: &CamFile, using: &CamUse, fit: &Fit) -> Self {
        let curve = file.cam.curve();
        let (width, rise) = (curve.end() - curve.start(), curve.rise());
        let height = curve.extremes().position;
        let height = (height.max - height.min).abs();
        let target = wanted(using).coupling.input;
        let mut did = *fit;
        if using.repeated && width > 0.0 {
            // Whole passes are the same cam, up to what it gains.
            let passes = ((did.master_offset.value - target.master_offset) / width).round();
            if rise == 0.0 || did.slave_offset.half_width > 0.0 {
                did.master_offset.value -= passes * width;
                did.slave_offset.value += did.slave_scaling.value * passes * rise;
            }
        }
        let seen = |found: Estimate, wanted: f64, scale: f64| {
            let by = (found.value - wanted).abs();
            if by <= found.half_width.max(ROUNDING * scale) { wanted } else { found.value }
        };
        let did = [
            seen(did.master_offset, target.master_offset, width),
            seen(did.master_scaling, target.master_scaling, 1.0),
            seen(did.slave_offset, target.slave_offset, height),
            seen(did.slave_scaling, target.slave_scaling, 1.0),
        ];
        let known = [fit.master_offset, fit.master_scaling, fit.slave_offset, fit.slave_scaling];
        Self { told: of_coupling(using), did, known: known.map(|found| found.half_width) }
    }

    /// What the slave is to be told so that it does `target`.
    fn undone(&self, target: [f64; 4]) -> [f64; 4] {
        let ([offset, scaling, shift, factor], did) = (self.told, self.did);
        let (by, gain) = (target[1] / did[1], factor / did[3]);
        [
            target[0] - by * (did[0] - offset),
            scaling * by,
            shift + (target[2] - did[2]) * gain,
            target[3] * gain,
        ]
    }

    /// How well what it is to be told so that it does `target` is known, half widths. Those of gain and shift, which what is
    /// told combines, are added: so they hold, however the two go together.
    fn told_within(&self, target: [f64; 4]) -> [f64; 4] {
        let ([offset, scaling, _, factor], did, known) = (self.told, self.did, self.known);
        let (by, gain) = ((target[1] / did[1]).abs(), (factor / did[3]).abs());
        let parts = [known[1] / did[1].abs(), known[3] / did[3].abs()];
        [
            by * (known[0] + (did[0] - offset).abs() * parts[0]),
            scaling.abs() * by * parts[0],
            gain * (known[2] + (target[2] - did[2]).abs() * parts[1]),
            target[3].abs() * gain * parts[1],
        ]
    }

    /// What the slave does when it is told this.
    pub(super) fn done(&self, told: [f64; 4]) -> [f64; 4] {
        let ([offset, scaling, shift, factor], did) = (self.told, self.did);
        let (by, gain) = (told[1] / scaling, did[3] / factor);
        [
            told[0] + by * (did[0] - offset),
            did[1] * by,
            did[2] + (told[2] - shift) * gain,
            told[3] * gain,
        ]
    }

    /// Where the slave has the master that is at `master`, as far as the coupling in effect is concerned.
    pub(super) fn sees(&self, master: f64) -> f64 {
        (self.did[1] * master + self.did[0] - self.told[0]) / self.told[1]
    }

    /// Where the slave was told to be when it was measured at `position`.
    pub fn told_at(&self, position: f64) -> f64 {
        self.told[2] + (position - self.did[2]) * self.told[3] / self.did[3]
    }
}

/// `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`.
pub(super) fn of_coupling(using: &CamUse) -> [f64; 4] {
    let input = &using.coupling.input;
    [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling]
}

/// The same with other values; those that are as before stay to the last bit.
pub(super) fn with_values(using: &CamUse, values: [f64; 4]) -> CamUse {
    let mut new = *using;
    let input = &mut new.coupling.input;
    let slots = [
        &mut input.master_offset,
        &mut input.master_scaling,
        &mut input.slave_offset,
        &mut input.slave_scaling,
    ];
    for (slot, value) in slots.into_iter().zip(values) {
        if !same(*slot, value) {
            *slot = clean(value);
        }
    }
    new
}

/// The same, with every value as it is.
pub fn with_exactly(using: &CamUse, values: [f64; 4]) -> CamUse {
    let mut new = *using;
    let input = &mut new.coupling.input;
    [input.master_offset, input.master_scaling, input.slave_offset, input.slave_scaling] = values;
    new
}

/// The coupling with which a slave that did what `fit` says, with `using` in effect, does what is wanted, and how it deviates.
///
/// What was in effect and what came of it tell gain, shift and lag; the new coupling undoes them. So the same machine with the
/// new coupling shows no deviation, and another run changes nothing. What deviates by no more than its interval stays as it is.
pub fn corrected(file: &CamFile, using: &CamUse, fit: &Fit) -> (CamUse, Deviation) {
    let deviation = Deviation::new(file, using, fit);
    let target = of_coupling(&wanted(using));
    let same = |one: f64, other: f64| one.to_bits() == other.to_bits();
    let [offset, scaling, shift, factor] = [0, 1, 2, 3].map(|index: usize| {
        let of = |values: &[f64; 4]| values.get(index).copied().unwrap_or_default();
        same(of(&deviation.did), of(&target))
    });
    let stays = [scaling && offset, scaling, shift, factor];
    let mut new = *using;
    let old = using.coupling.input;
    let input = &mut new.coupling.input;
    let slots = [
        (&mut input.master_offset, fit.master_offset),
        (&mut input.master_scaling, fit.master_scaling),
        (&mut input.slave_offset, fit.slave_offset),
        (&mut input.slave_scaling, fit.slave_scaling),
    ];
    for (((slot, found), value), stays) in
        slots.into_iter().zip(deviation.undone(target)).zip(stays)
    {
        if !stays {
            *slot = super::rounded(Estimate { value, ..found });
        }
    }
    if *input != old {
        new.coupling.wanted = Some(target);
    }
    (new, deviation)
}

/// What undoes a deviation, of `MasterOffset`, `MasterScaling`, `SlaveOffset` and `SlaveScaling`, with its half widths.
pub fn within(deviation: &Deviation, target: &CamUse, new: &CamUse) -> [Estimate; 4] {
    let [one, two, three, four] = of_coupling(new);
    let [a, b, c, d] = deviation.told_within(of_coupling(target));
    [(one, a), (two, b), (three, c), (four, d)]
        .map(|(value, half_width)| Estimate { value, half_width })
}

/// What is wanted of a slave that deviates so, where its coupling is changed from `before` to `after`: what it does with that.
pub fn wants(deviation: &Deviation, before: &CamUse, after: &CamUse) -> Option<[f64; 4]> {
    let mut wanted = before.coupling.wanted?;
    let pairs = of_coupling(before).into_iter().zip(of_coupling(after));
    let does = deviation.done(of_coupling(after));
    let known = does.into_iter().zip(deviation.known);
    for ((slot, (before, after)), (value, half_width)) in wanted.iter_mut().zip(pairs).zip(known) {
        if before.to_bits() != after.to_bits() {
            *slot = super::rounded(Estimate { value, half_width });
        }
    }
    Some(wanted)
}
