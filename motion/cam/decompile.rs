//! Decompilation of a running cam to elements that people can edit (manual 4.5, "load from the controller").

use super::error::CamError;
use super::knot::Knot;
use super::reference::{Cam, Shape};
use super::source::{Element, SAME, Source};

impl Source {
    /// Elements and tappets of a cam that runs, with this one's name, scales and period. What is straight between two points
    /// comes back as a line.
    ///
    /// # Errors
    /// [`CamError::NoElements`] of tables: only polynomial cams come back (manual 4.5).
    pub fn loaded(&self, cam: &Cam) -> Result<Self, CamError> {
        let Shape::Polynomial(knots) = cam.shape() else { return Err(CamError::NoElements) };
        let size = knots.iter().fold(0.0, |most: f64, knot| most.max(knot.slave.abs()));
        let mut elements = Vec::with_capacity(knots.len());
        let mut in_line = false;
        for (index, knot) in knots.iter().enumerate() {
            let line = knots.get(index + 1).and_then(|next| straight(knot, next, size));
            if line.is_none() && !in_line {
                elements.push(Element::Point(*knot));
            }
            in_line = line.is_some();
            elements.extend(line);
        }
        Ok(Self { elements, tappets: cam.tappets().to_vec(), ..self.clone() })
    }
}

/// The line between two points, if the curve between them is none other.
fn straight(from: &Knot, to: &Knot, size: f64) -> Option<Element> {
    let width = to.master - from.master;
    let slope = (to.slave - from.slave) / width;
    let bound = SAME * size / width;
    let is_on = |knot: &Knot| {
        (knot.velocity - slope).abs() <= bound && knot.acceleration.abs() <= bound / width
    };
    let ends = [from, to].map(|knot| [knot.master, knot.slave]);
    (is_on(from) && is_on(to)).then_some(Element::Line { from: ends[0], to: ends[1] })
}
