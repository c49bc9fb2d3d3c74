//! Sections of a drawing: joins touching chains and orders them.

use super::expand::Chain;
use super::primitive::Primitive;
use nalgebra::Point3;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Connected pieces, each with the line of the file it comes from.
#[derive(Clone, Debug)]
pub(super) struct Section {
    pub(super) pieces: Vec<(Primitive, u32)>,
    pub(super) layer: String,
    pub(super) rapid: bool,
}

type Spot = GeomWithData<[f64; 3], (usize, usize)>;

fn spot(point: Point3<f64>, data: (usize, usize)) -> Spot {
    GeomWithData::new(point.coords.into(), data)
}

impl Section {
    fn new(chain: Chain) -> Self {
        let Chain { pieces, layer, rapid, line } = chain;
        Self { pieces: pieces.into_iter().map(|piece| (piece, line)).collect(), layer, rapid }
    }

    pub(super) fn start(&self) -> Point3<f64> {
        self.pieces.first().map_or_else(Point3::origin, |(piece, _)| piece.start())
    }

    pub(super) fn end(&self) -> Point3<f64> {
        self.pieces.last().map_or_else(Point3::origin, |(piece, _)| piece.end())
    }

    fn reverse(&mut self) {
        self.pieces.reverse();
        for (piece, _) in &mut self.pieces {
            *piece = piece.reversed();
        }
    }

    fn is_closed(&self, tolerance: f64) -> bool {
        (self.end() - self.start()).norm() <= tolerance
    }
}

/// Joins the cuts between two rapids, see [`join`]. Rapids stay as they are drawn, with their places among the cuts.
pub(super) fn join_between_rapids(
    chains: &[Chain],
    tolerance: f64,
    by_layer: bool,
) -> Vec<Section> {
    let groups = chains.chunk_by(|one, other| !one.rapid && !other.rapid);
    groups.flat_map(|group| join(group.to_vec(), tolerance, by_layer)).collect()
}

/// Joins chains whose ends are within `tolerance` (m) to sections, each in the direction of its first chain, in the
/// order of their first chains. Where several meet, the first in the drawing goes on. With `by_layer` only what is on
/// the same layer is joined.
fn join(chains: Vec<Chain>, tolerance: f64, by_layer: bool) -> Vec<Section> {
    let mut open: Vec<Option<Section>> =
        chains.into_iter().map(|chain| Some(Section::new(chain))).collect();
    let ends = open.iter().enumerate().flat_map(|(index, section)| {
        section.iter().filter(|section| !section.is_closed(tolerance)).flat_map(move |section| {
            [spot(section.start(), (index, 0)), spot(section.end(), (index, 1))]
        })
    });
    let mut tree = RTree::bulk_load(ends.collect());
    let mut sections = Vec::new();
    for index in 0..open.len() {
        let Some(mut section) = open.get_mut(index).and_then(Option::take) else { continue };
        forget(&mut tree, &section, index);
        for _ in 0..2 {
            while !section.is_closed(tolerance) {
                let near =
                    tree.locate_within_distance(section.end().coords.into(), tolerance * tolerance);
                let next = near
                    .filter(|spot| {
                        let other = open.get(spot.data.0).and_then(Option::as_ref);
                        other.is_some_and(|other| !by_layer || other.layer == section.layer)
                    })
                    .map(|spot| spot.data)
                    .min();
                let Some((index, side)) = next else { break };
                let Some(mut next) = open.get_mut(index).and_then(Option::take) else { break };
                forget(&mut tree, &next, index);
                if side == 1 {
                    next.reverse();
                }
                section.pieces.append(&mut next.pieces);
            }
            // Once forwards, once backwards; then it is as it was.
            section.reverse();
        }
        sections.push(section);
    }
    sections
}

fn forget(tree: &mut RTree<Spot>, section: &Section, index: usize) {
    tree.remove(&spot(section.start(), (index, 0)));
    tree.remove(&spot(section.end(), (index, 1)));
}

/// The section from its end or corner nearest to `at` on, the place to which a rapid leads; of a closed one the piece that
/// was drawn first comes first. The curves of a drawing have no direction of their own.
pub(super) fn entered_at(mut section: Section, at: Point3<f64>, tolerance: f64) -> Section {
    let distance = |point: Point3<f64>| (point - at).norm();
    if section.is_closed(tolerance) {
        let corners = section.pieces.iter().enumerate();
        let nearest = corners.min_by(|(_, (one, _)), (_, (other, _))| {
            distance(one.start()).total_cmp(&distance(other.start()))
        });
        let first = nearest.map_or(0, |(index, _)| index);
        section.pieces.rotate_left(first);
        let lines = [section.pieces.first(), section.pieces.last()].map(|piece| piece.map(|p| p.1));
        if lines[1] < lines[0] {
            section.reverse();
        }
    } else if distance(section.end()) < distance(section.start()) {
        section.reverse();
    }
    section
}

/// The sections in an order in which each is the nearest to the end of the one before, from `start` on. Open ones may
/// be entered from both ends, closed ones at each of their corners.
pub(super) fn nearest_first(
    sections: Vec<Section>,
    start: Point3<f64>,
    tolerance: f64,
) -> Vec<Section> {
    let entries = |index: usize, section: &Section| -> Vec<Spot> {
        if section.is_closed(tolerance) {
            let corners = section.pieces.iter().enumerate();
            corners.map(|(at, (piece, _))| spot(piece.start(), (index, at))).collect()
        } else {
            vec![spot(section.start(), (index, 0)), spot(section.end(), (index, 1))]
        }
    };
    let all = sections.iter().enumerate().flat_map(|(index, section)| entries(index, section));
    let mut tree = RTree::bulk_load(all.collect());
    let mut open: Vec<Option<Section>> = sections.into_iter().map(Some).collect();
    let mut ordered = Vec::with_capacity(open.len());
    let mut at = start;
    while let Some((index, entry)) =
        tree.nearest_neighbor(at.coords.into()).map(|nearest| nearest.data)
    {
        let Some(mut section) = open.get_mut(index).and_then(Option::take) else { break };
        for spot in entries(index, &section) {
            tree.remove(&spot);
        }
        if section.is_closed(tolerance) {
            section.pieces.rotate_left(entry);
        } else if entry == 1 {
            section.reverse();
        }
        at = section.end();
        ordered.push(section);
    }
    // Nothing is left, unless a place was no number.
    ordered.extend(open.into_iter().flatten());
    ordered
}
