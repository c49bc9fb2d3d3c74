//! Emitter of path elements: the last steps that need the next element, such as ends of preparation, splines and
//! switches.

use super::block::{Request, SwitchPlace};
use super::error::DecodeError;
use super::output::Output;
use nalgebra::Vector2;
use twin_path::{
    Cubic, Details, ElementKind, Marks, PathElement, Shape, Switch, cardinal_tangent, end_tangent,
};

/// Holds one element back.
#[derive(Clone, Debug, Default)]
pub(super) struct Emitter {
    held: Option<Held>,
    /// Marks for the next path object.
    starts: Marks,
}

#[derive(Clone, Debug)]
struct Held {
    element: PathElement,
    /// Of a piece of a spline (its shape is the chord): the derivative at its start, m.
    spline: Option<Vector2<f64>>,
    /// H words whose places are not parts of its length yet.
    requests: Vec<Request>,
}

impl Emitter {
    /// Path preparation begins with the next object (`starts`), or ends behind the last one (`ends`).
    pub(super) fn mark(&mut self, starts: Marks, ends: Marks) {
        if starts != Marks::default() {
            self.starts = self.starts.without(starts.rivals()).with(starts);
            return;
        }
        // What has not begun yet does not begin any more.
        self.starts = self.starts.without(ends.begun());
        if let Some(held) = &mut self.held {
            held.element.marks = held.element.marks.with(ends);
        }
    }

    /// Takes the next element; `spline` if it is a piece of one, whose shape is its chord so far.
    pub(super) fn element(
        &mut self,
        mut element: PathElement,
        spline: bool,
        requests: Vec<Request>,
        out: &mut Output,
    ) {
        if element.kind.is_motion() {
            element.marks = element.marks.with(std::mem::take(&mut self.starts));
        }
        let chord = (element.end() - element.start()).xy();
        // The same point again ends a spline, and the next begins there.
        let spline = (spline && chord.norm() > 0.0).then(|| match &self.held {
            Some(Held { element: before, spline: Some(_), .. }) => {
                cardinal_tangent(before.start().xy(), element.end().xy())
            }
            Some(Held { element: before, .. }) if joins(before) => {
                end_tangent(chord, Some(before.end_tangent().xy()))
            }
            _ => chord,
        });
        if let Some(held) = self.held.replace(Held { element, spline, requests }) {
            held.finish(self.held.as_ref(), out);
        }
    }

    /// The element held back.
    pub(super) fn held(&self) -> Option<&PathElement> {
        self.held.as_ref().map(|held| &held.element)
    }

    /// Nothing follows.
    pub(super) fn finish(&mut self, out: &mut Output) {
        if let Some(held) = self.held.take() {
            held.finish(None, out);
        }
    }
}

/// True if the direction of a spline follows that of `element`.
pub(super) fn joins(element: &PathElement) -> bool {
    element.kind == ElementKind::Cut && element.shape.length() > 0.0
}

impl Held {
    fn finish(mut self, next: Option<&Self>, out: &mut Output) {
        if let Some(start_tangent) = self.spline {
            let (start, end) = (self.element.start(), self.element.end());
            let chord = (end - start).xy();
            let tangent = match next {
                Some(Self { element, spline: Some(_), .. }) => {
                    cardinal_tangent(start.xy(), element.end().xy())
                }
                Some(Self { element, .. }) if joins(element) => {
                    end_tangent(chord, Some(element.start_tangent().xy()))
                }
                _ => chord,
            };
            self.element.shape =
                Shape::Cubic(Box::new(Cubic::hermite(start, end, start_tangent, tangent)));
        }
        if !self.requests.is_empty() {
            self.place_switches(out);
        }
        out.element(self.element);
    }

    /// Makes the places of the switches parts of the length, which is known now.
    fn place_switches(&mut self, out: &mut Output) {
        let length = self.element.length();
        let place = self.element.place;
        let mut details =
            self.element.details.take().map_or_else(Details::default, |details| *details);
        // From right to left as they act: of two at one place the left one acts last.
        for Request { number, at, columns } in self.requests.drain(..) {
            let at = match at {
                Some(SwitchPlace::Part(part)) if !part.is_nan() => part,
                Some(SwitchPlace::Length(mm)) if length > 0.0 && mm >= 0.0 => mm / 1e3 / length,
                Some(SwitchPlace::Length(mm)) if length > 0.0 => 1.0 + mm / 1e3 / length,
                // Every place of an object without length is the same.
                Some(SwitchPlace::Length(mm)) => {
                    if mm == 0.0 {
                        0.0
                    } else {
                        f64::INFINITY
                    }
                }
                None | Some(SwitchPlace::Part(_)) => {
                    out.error_at(place, columns, DecodeError::SwitchWithoutPlace);
                    continue;
                }
            };
            // A length that is given with three decimals may be the whole one.
            let slack = if length > 0.0 { 1e-6 / length } else { 0.0 };
            if !(-slack..=1.0 + slack).contains(&at) {
                let length_mm = (length * 1e9).round() / 1e6;
                out.error_at(place, columns, DecodeError::SwitchBeyond { at, length_mm });
                continue;
            }
            let switch =
                Switch { number: switch_number(number), on: number > 0.0, at: at.clamp(0.0, 1.0) };
            // The block had room for no more than fit.
            let _fits = details.switches.add(switch);
        }
        if !details.is_empty() {
            self.element.details = Some(Box::new(details));
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "Letter::check lets only 1 to 32 pass, of either sign"
)]
fn switch_number(number: f64) -> u8 {
    number.abs() as u8
}
