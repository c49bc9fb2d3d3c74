//! Gouge check: detects a tool that cuts into the contour.

use super::super::planar::{Bounds, Curve, distance};
use super::super::{Notice, Notices};
use crate::Place;
use std::collections::VecDeque;

/// Pairs of blocks reported last; each pair is reported once.
const REMEMBERED: usize = 32;

/// Compares the pieces of the tool's path with those of the contour around them: the last ones of each, and the first, which the end of a closed contour comes back to.
#[derive(Debug)]
pub(super) struct GougeCheck {
    radius: f64,
    tolerance: f64,
    windows: [usize; 2],
    contour: VecDeque<Piece>,
    path: VecDeque<Piece>,
    reported: VecDeque<(Place, Place)>,
}

#[derive(Debug)]
struct Piece {
    place: Place,
    curve: Curve,
    bounds: Bounds,
}

impl GougeCheck {
    /// With the number of pieces of the contour and of the path that are kept; coming nearer than the radius by no more
    /// than `tolerance`, m, is not a gouge.
    pub(super) fn new(radius: f64, tolerance: f64, windows: [usize; 2]) -> Self {
        Self {
            radius,
            tolerance,
            windows,
            contour: VecDeque::new(),
            path: VecDeque::new(),
            reported: VecDeque::new(),
        }
    }

    /// A further piece of the contour.
    pub(super) fn contour(&mut self, place: Place, curve: Curve, notices: &Notices) {
        let piece = Piece { place, curve, bounds: curve.bounds() };
        let near = piece.bounds.widened(self.radius);
        for path in self.path.iter().filter(|path| path.bounds.meets(&near)) {
            compare([self.radius, self.tolerance], path, &piece, &mut self.reported, notices);
        }
        remember(&mut self.contour, piece, self.windows[0]);
    }

    /// A further piece of the tool's path.
    pub(super) fn path(&mut self, place: Place, curve: Curve, notices: &Notices) {
        let piece = Piece { place, curve, bounds: curve.bounds() };
        let near = piece.bounds.widened(self.radius);
        for contour in self.contour.iter().filter(|contour| contour.bounds.meets(&near)) {
            compare([self.radius, self.tolerance], &piece, contour, &mut self.reported, notices);
        }
        remember(&mut self.path, piece, self.windows[1]);
    }
}

fn compare(
    [radius, tolerance]: [f64; 2],
    path: &Piece,
    contour: &Piece,
    reported: &mut VecDeque<(Place, Place)>,
    notices: &Notices,
) {
    let depth = radius - distance(&path.curve, &contour.curve);
    let pair = (path.place, contour.place);
    if depth > tolerance && !reported.contains(&pair) {
        if reported.len() >= REMEMBERED {
            reported.pop_front();
        }
        reported.push_back(pair);
        notices.add(Notice::Gouge { place: path.place, damaged: contour.place, depth });
    }
}

/// Keeps the first and the last pieces.
fn remember(pieces: &mut VecDeque<Piece>, piece: Piece, window: usize) {
    pieces.push_back(piece);
    if pieces.len() > window.saturating_add(1) {
        pieces.remove(1);
    }
}
