//! Pieces of elements: cutting, moving and the hand-over of switches, for the adapters.

use super::{Notice, Notices};
use crate::Place;
use crate::{
    AxisMask, Details, ExtraAxes, ExtraPosition, Marks, PathElement, Shape, Switch, Switches,
};
use nalgebra::{Point3, Vector2, Vector3};

/// Angles are equal to within this, rad (the strict zero of manual 6.4, `g_fSMC_CNC_EPS`).
pub(super) const ANGLE_EPS: f64 = 1e-9;

/// Points are equal to within this, m: a thousandth of what a program of micrometres can say.
pub(super) const POINT_EPS: f64 = 1e-9;

/// A point of the path with everything that is somewhere there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Station {
    /// The tool, m.
    pub(super) point: Point3<f64>,
    /// The extra axes, if the program has named any, u.
    pub(super) extra: Option<ExtraPosition>,
}

impl Station {
    /// The start of `element`.
    pub(super) fn start(element: &PathElement) -> Self {
        Self { point: element.start(), extra: element.extra().map(|extra| extra.start) }
    }

    /// The end of `element`.
    pub(super) fn end(element: &PathElement) -> Self {
        Self { point: element.end(), extra: element.extra().map(|extra| extra.end) }
    }

    /// At path length `s`, m, of `element`.
    pub(super) fn at(element: &PathElement, s: f64) -> Self {
        Self {
            point: element.at(s).position,
            extra: element.extra_at(s).map(|extra| extra.position),
        }
    }
}

/// X and Y.
pub(super) fn flat(vector: &Vector3<f64>) -> Vector2<f64> {
    vector.xy()
}

/// The piece of `element` from path length `from` to `to`, m, with what switches lie on it; the ends of the element
/// stay what they are, bit for bit. Its marks stay with it.
pub(super) fn section(element: &PathElement, from: f64, to: f64) -> PathElement {
    let length = element.shape.length();
    if from <= 0.0 && to >= length {
        return element.clone();
    }
    let mut piece = part(element, from, to);
    piece.shape = element.shape.section(from, to);
    if element.details.as_ref().is_some_and(|details| details.s_profile.contains(AxisMask::Z)) {
        let height = |s: f64| element.at(s).position.z;
        piece.shape = piece.shape.with_heights(height(from), height(to));
    }
    piece
}

/// The element with the extra axes and switches of its piece from path length `from` to `to`, m; the shape is that of
/// the whole.
pub(super) fn part(element: &PathElement, from: f64, to: f64) -> PathElement {
    let mut piece = element.clone();
    let (start, end) = (Station::at(element, from), Station::at(element, to));
    set_extra(&mut piece, start.extra, end.extra);
    if let Some(details) = &mut piece.details {
        details.switches = Switches::default();
        for switch in part_of_switches(element, from, to, from, to) {
            // There are no more on the whole element.
            let _fits = details.switches.add(switch);
        }
    }
    tidy(&mut piece);
    piece
}

/// Those of the marks that end something behind their element.
pub(super) fn end_marks(marks: Marks) -> Marks {
    let ends = Marks::CORRECTION_END.with(Marks::CORNERS_END).with(Marks::LOOPS_END);
    Marks(marks.0 & ends.0)
}

/// The switches of `element` on path lengths above `low` up to `high`, m (at the very start of the element with it),
/// as parts of the piece from `from` to `to`.
pub(super) fn part_of_switches(
    element: &PathElement,
    low: f64,
    high: f64,
    from: f64,
    to: f64,
) -> impl Iterator<Item = Switch> + '_ {
    let length = element.length();
    element.switches().iter().filter_map(move |switch| {
        let s = switch.at * length;
        let here = (s > low || low <= 0.0) && (s <= high || high >= length);
        let at = if to > from { ((s - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        here.then_some(Switch { at, ..*switch })
    })
}

/// Adds a switch to `element`; one for which there is no room is told.
pub(super) fn add_switch(
    element: &mut PathElement,
    switch: Switch,
    from: Place,
    notices: &Notices,
) {
    let details = element.details.get_or_insert_default();
    if !details.switches.add(switch) {
        notices.add(Notice::SwitchLost { place: from, number: switch.number, on: switch.on });
    }
}

/// An element between two stations with the limits of `first` and `second` that hold on both.
pub(super) fn between(
    first: &PathElement,
    second: &PathElement,
    shape: Shape,
    stations: [&Station; 2],
) -> PathElement {
    let mut element = PathElement {
        feed: first.feed.min(second.feed),
        acceleration: first.acceleration.min(second.acceleration),
        deceleration: first.deceleration.min(second.deceleration),
        tool_radius: first.tool_radius,
        ..PathElement::new(first.place, first.kind, shape)
    };
    let [start, end] = stations;
    set_extra(&mut element, start.extra, end.extra.or(start.extra));
    element
}

/// Puts an element without a path (M function, dwell, length zero) somewhere else.
pub(super) fn relocate(element: &mut PathElement, station: &Station) {
    element.shape = Shape::Line { start: station.point, end: station.point };
    if element.extra().is_some() {
        set_extra(element, station.extra, station.extra);
    }
}

/// Gives the extra axes other ends; where only one end knows of them, they are at 0 at the other.
pub(super) fn set_extra(
    element: &mut PathElement,
    start: Option<ExtraPosition>,
    end: Option<ExtraPosition>,
) {
    if start.is_some() || end.is_some() {
        let (start, end) = (start.unwrap_or_default(), end.unwrap_or_default());
        element.details.get_or_insert_default().extra = Some(ExtraAxes { start, end });
    }
}

/// Gives the extra axes another start.
pub(super) fn set_start_extra(element: &mut PathElement, start: Option<ExtraPosition>) {
    let end = Station::end(element).extra;
    set_extra(element, start, end);
}

/// Moves the switches of an element of which only the part between two parameters is left; those on what is gone go to
/// its ends.
pub(super) fn trim_switches(element: &mut PathElement, from: f64, to: f64) {
    if from <= 0.0 && to >= 1.0 {
        return;
    }
    let Some(details) = &mut element.details else { return };
    let mut switches = Switches::default();
    for switch in details.switches.as_slice() {
        let at = if to > from { ((switch.at - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        // As many as before fit.
        let _fits = switches.add(Switch { at, ..*switch });
    }
    details.switches = switches;
}

/// Makes an element end somewhere else by rounding.
pub(super) fn end_at(element: &mut PathElement, end: Point3<f64>) {
    if element.end() != end {
        element.shape = element.shape.clone().with_ends(element.start(), end);
    }
}

/// Takes off details that say nothing.
fn tidy(element: &mut PathElement) {
    if element.details.as_deref().is_some_and(Details::is_empty) {
        element.details = None;
    }
}
