//! Programmed feed along the path under the override, and its relaxation while the path brakes.

use crate::blended_path::BlendedElement;
use std::ops::Range;
use std::sync::Arc;

/// Accuracy with which solvers keep bounds.
const EXACT: f64 = 4e-4;

/// The override, and where it cannot be kept yet because the path has to brake first.
#[derive(Clone, Debug)]
pub(super) struct Feeds {
    factor: f64,
    braking: Vec<Braking>,
}

impl Default for Feeds {
    fn default() -> Self {
        Self::new(1.0)
    }
}

/// u̇² on an element while braking.
#[derive(Clone, Debug)]
struct Braking {
    element: Arc<BlendedElement>,
    /// At some places, m: what braking comes to, and what more is allowed. Linear in between.
    bounds: Vec<(f64, [f64; 2])>,
}

impl Feeds {
    /// Every programmed velocity times `factor`.
    pub(super) fn new(factor: f64) -> Self {
        Self { factor, braking: Vec::new() }
    }

    /// The same with another factor, and no less where the path brakes; if it is no smaller.
    pub(super) fn raised(&self, factor: f64) -> Option<Self> {
        (factor >= self.factor).then(|| Self { factor, ..self.clone() })
    }

    /// Up to a u̇² in any case, and more where that is above what is programmed, on a part of `element`: both at its two ends. Parts
    /// come in their order along the path.
    pub(super) fn brake(
        &mut self,
        element: &Arc<BlendedElement>,
        part: Range<f64>,
        [start, end]: [[f64; 2]; 2],
    ) {
        let end = (part.end, end);
        match self.braking.last_mut() {
            Some(last) if Arc::ptr_eq(&last.element, element) => last.bounds.push(end),
            _ => {
                let bounds = vec![(part.start, start), end];
                self.braking.push(Braking { element: Arc::clone(element), bounds });
            }
        }
    }

    /// Kinks of the bound: places where the braking velocity falls below the programmed one, or rises above it.
    pub(super) fn kinks(&self) -> Vec<(Arc<BlendedElement>, f64)> {
        let mut kinks = Vec::new();
        for Braking { element, bounds } in &self.braking {
            for pair in bounds.windows(2) {
                let [(from, [start, _]), (to, [end, _])] = pair else { continue };
                let scale = element.at(from.midpoint(*to)).first.norm();
                let feed = self.factor * element.feed() / if scale > 0.0 { scale } else { 1.0 };
                let v2 = feed * feed / (1.0 + EXACT);
                if (*start > v2) != (*end > v2) {
                    let part = (start - v2) / (start - end);
                    kinks.push((Arc::clone(element), from + part * (to - from)));
                }
            }
        }
        kinks
    }

    /// True if the bound is not the same all along `element`.
    pub(super) fn brakes_on(&self, element: &BlendedElement) -> bool {
        let mut braking = self.braking.iter();
        braking.any(|braking| std::ptr::eq(Arc::as_ptr(&braking.element), element))
    }

    /// The bound on u̇² at `s` of `element`, where `v2` is what is programmed.
    pub(super) fn bound(&self, element: &BlendedElement, s: f64, v2: f64) -> f64 {
        let v2 = self.factor * self.factor * v2;
        let here = self
            .braking
            .iter()
            .find(|braking| std::ptr::eq(Arc::as_ptr(&braking.element), element));
        let braking = here.and_then(|braking| {
            let index = braking.bounds.partition_point(|(at, _)| *at < s).max(1);
            let [(from, start), (to, end), ..] = braking.bounds.get(index - 1..)? else {
                return None;
            };
            let part = ((s - from) / (to - from)).max(0.0);
            let [b, more] = [0, 1].map(|i: usize| {
                let ends = [start.get(i), end.get(i)].map(|end| end.copied().unwrap_or_default());
                ends[0] + part * (ends[1] - ends[0])
            });
            Some([b, more])
        });
        let braking = braking.map(|[b, more]| b * (1.0 + EXACT) + (b - v2).clamp(0.0, more));
        braking.map_or(v2, |braking| v2.max(braking))
    }
}
