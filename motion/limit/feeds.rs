//! The velocity along the path that the program asks for, under the override.

use super::course::CourseElement;
use std::sync::Arc;

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

/// Bounds of u̇² on an element while braking.
#[derive(Clone, Debug)]
struct Braking {
    element: Arc<CourseElement>,
    /// Each up to a place, m, from that of the one before.
    bounds: Vec<(f64, f64)>,
}

impl Feeds {
    /// Every programmed velocity times `factor`.
    pub(super) fn new(factor: f64) -> Self {
        Self { factor, braking: Vec::new() }
    }

    /// Up to u̇² = `b` in any case as far as the place `to` of `element`, from that of the one before. Places come in their order
    /// along the path.
    pub(super) fn brake(&mut self, element: &Arc<CourseElement>, to: f64, b: f64) {
        let bound = (to, b);
        match self.braking.last_mut() {
            Some(last) if Arc::ptr_eq(&last.element, element) => last.bounds.push(bound),
            _ => self
                .braking
                .push(Braking { element: Arc::clone(element), bounds: vec![bound] }),
        }
    }

    /// The bound on u̇² at `s` of `element`, where `v2` is what is programmed.
    pub(super) fn bound(&self, element: &CourseElement, s: f64, v2: f64) -> f64 {
        let v2 = self.factor * self.factor * v2;
        let here = self.braking.iter().find(|braking| std::ptr::eq(&*braking.element, element));
        let braking = here.and_then(|braking| {
            let index = braking.bounds.partition_point(|(to, _)| *to < s);
            braking.bounds.get(index)
        });
        braking.map_or(v2, |(_, least)| v2.max(*least))
    }
}
