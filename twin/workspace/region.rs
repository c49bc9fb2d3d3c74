//! Regions of a plane, traced from an inside test.
//!
//! The test runs at the nodes of a [`Grid`]; between neighbours that differ bisection finds the boundary. Crossings
//! are joined by marching squares (Lorensen and Cline 1987), region on the left, and chords are refined towards the
//! boundary. Parts thinner than a cell may be missed.

use super::grid::Grid;
use nalgebra::{Point2, Vector2};
use std::collections::BTreeMap;

/// Bisections at most.
const HALVINGS: u32 = 50;
/// Points of a boundary are found to this part of the tolerance.
const SHARPER: f64 = 0.1;
/// Parts of a cell: a chord that is nearer to the boundary is not broken. For figures, and for pictures.
pub const EXACT: f64 = 1e-4;
/// See [`EXACT`].
pub const COARSE: f64 = 0.02;
/// A chord is broken this often at most, each time in two: enough for a corner.
const BREAKS: u32 = 12;

/// A point of a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// m.
    pub at: Point2<f64>,
    /// On the edge of the grid, where the region may go on beyond it.
    pub cut: bool,
}

/// A region of a plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Region {
    /// Closed lines around the region, which is on their left: counter-clockwise around it, clockwise around its holes.
    pub loops: Vec<Vec<Vertex>>,
    /// Triangles that fill the region as far as its boundary is straight within cells: corners.
    pub corners: Vec<Point2<f64>>,
    /// The triangles, each by three places in [`Self::corners`].
    pub triangles: Vec<[u32; 3]>,
}

impl Region {
    /// Region of the points that are `inside`; `nodes` are the results at the grid's nodes. The boundary is off by
    /// at most `tolerance` cells ([`EXACT`], [`COARSE`]).
    pub fn trace(
        grid: &Grid,
        nodes: &[bool],
        tolerance: f64,
        inside: &dyn Fn(&Point2<f64>) -> bool,
    ) -> Self {
        let mut tracing = Tracing {
            grid,
            tolerance: tolerance * grid.cell,
            nodes,
            inside,
            crossings: BTreeMap::new(),
            next: BTreeMap::new(),
            places: BTreeMap::new(),
            region: Self::default(),
        };
        for row in 0..grid.rows + 2 {
            for column in 0..grid.columns + 2 {
                tracing.cell(column, row);
            }
        }
        tracing.join()
    }

    /// Area, m².
    pub fn area(&self) -> f64 {
        let double = edges(&self.loops).map(|[one, other]| one.at.coords.perp(&other.at.coords));
        double.sum::<f64>() / 2.0
    }

    /// Centroid; `None` if the region is empty.
    pub fn centroid(&self) -> Option<Point2<f64>> {
        // About one of its own points, so that no digits are lost to a far origin.
        let about = self.vertices().next()?.at;
        let parts = edges(&self.loops).map(|[one, other]| {
            let (one, other) = (one.at - about, other.at - about);
            let double = one.perp(&other);
            (double, (one + other) * (double / 3.0))
        });
        let (area, moment) =
            parts.fold((0.0, Vector2::zeros()), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        (area > 0.0).then(|| about + moment / area)
    }

    /// Smallest and largest coordinates; `None` if the region is empty.
    pub fn extent(&self) -> Option<[Point2<f64>; 2]> {
        let mut vertices = self.vertices();
        let first = vertices.next()?.at;
        Some(
            vertices.fold([first; 2], |[low, high], vertex| {
                [low.inf(&vertex.at), high.sup(&vertex.at)]
            }),
        )
    }

    /// Distance of a point from the boundary, edge of the grid included, m; infinite if the region is empty.
    pub fn distance(&self, from: &Point2<f64>) -> f64 {
        let squared = edges(&self.loops).map(|[one, other]| {
            let (side, way) = (other.at - one.at, from - one.at);
            let along = (side.dot(&way) / side.norm_squared()).clamp(0.0, 1.0);
            // A side without length has no direction.
            if along.is_nan() { way.norm_squared() } else { (way - side * along).norm_squared() }
        });
        squared.fold(f64::INFINITY, f64::min).sqrt()
    }

    /// Every point of the boundary.
    pub fn vertices(&self) -> impl Iterator<Item = &Vertex> {
        self.loops.iter().flatten()
    }

    /// The boundary as lines, without the edges of the grid.
    pub fn lines(&self) -> Vec<Vec<Point2<f64>>> {
        let mut lines: Vec<Vec<Point2<f64>>> = Vec::new();
        for one in &self.loops {
            let count = one.len();
            // A loop that the edge of the grid cuts begins there.
            let first = one.iter().position(|vertex| vertex.cut).unwrap_or(0);
            let mut line = Vec::new();
            let mut last_cut = false;
            for vertex in one.iter().cycle().skip(first).take(count + 1) {
                if vertex.cut && last_cut {
                    lines.push(std::mem::take(&mut line));
                }
                line.push(vertex.at);
                last_cut = vertex.cut;
            }
            lines.push(line);
        }
        lines.retain(|line| line.len() > 1);
        lines
    }
}

/// The sides of closed lines.
fn edges(loops: &[Vec<Vertex>]) -> impl Iterator<Item = [&Vertex; 2]> {
    loops.iter().flat_map(|one| {
        one.iter().zip(one.iter().cycle().skip(1)).map(|(vertex, next)| [vertex, next])
    })
}

/// The way from a node to its right neighbour, or to the one above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    row: u32,
    column: u32,
    upward: bool,
}

/// Corner of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Corner {
    Node(u32, u32),
    Crossing(Edge),
}

/// Tracing state. A ring of outside nodes surrounds the grid, so that every line closes; rows and columns count
/// from it.
struct Tracing<'a> {
    grid: &'a Grid,
    /// m.
    tolerance: f64,
    nodes: &'a [bool],
    inside: &'a dyn Fn(&Point2<f64>) -> bool,
    crossings: BTreeMap<Edge, Vertex>,
    /// Where the boundary goes from a crossing, through a cell.
    next: BTreeMap<Edge, Edge>,
    /// Places of corners.
    places: BTreeMap<Corner, u32>,
    region: Region,
}

impl Tracing<'_> {
    fn node(&self, column: u32, row: u32) -> Point2<f64> {
        let on = |place: u32, last: u32| place.saturating_sub(1).min(last);
        self.grid.node(on(column, self.grid.columns), on(row, self.grid.rows))
    }

    /// A node of the ring around the grid.
    fn is_ring(&self, column: u32, row: u32) -> bool {
        column == 0 || row == 0 || column > self.grid.columns + 1 || row > self.grid.rows + 1
    }

    fn is_inside(&self, column: u32, row: u32) -> bool {
        !self.is_ring(column, row)
            && self.nodes.get(self.grid.index(column - 1, row - 1)).copied().unwrap_or(false)
    }

    /// One cell, by its lower left node.
    fn cell(&mut self, column: u32, row: u32) {
        let nodes = [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)];
        let inside = nodes.map(|(column, row)| self.is_inside(column, row));
        if inside == [false; 4] {
            return;
        }
        // Side k leads from corner k to the next one, counter-clockwise.
        let sides = [
            Edge { row, column, upward: false },
            Edge { row, column: column + 1, upward: true },
            Edge { row: row + 1, column, upward: false },
            Edge { row, column, upward: true },
        ];
        let is_ring = nodes.iter().any(|(column, row)| self.is_ring(*column, *row));
        let diagonal = inside == [true, false, true, false] || inside == [false, true, false, true];
        let apart = diagonal && !(self.inside)(&self.middle(column, row));
        let mut pieces: Vec<Vec<Corner>> = vec![Vec::new()];
        let steps = nodes.iter().zip(inside).zip(inside.iter().cycle().skip(1)).zip(sides);
        for (((node, here), there), side) in steps {
            if here && let Some(piece) = pieces.last_mut() {
                piece.push(Corner::Node(node.0, node.1));
            }
            if here == *there {
                continue;
            }
            if let Some(piece) = pieces.last_mut() {
                piece.push(Corner::Crossing(side));
            }
            // Two corners that have nothing to do with each other.
            if apart && here {
                pieces.push(Vec::new());
            }
        }
        if apart && let Some(rest) = pieces.pop() {
            // What was begun at the end belongs to what the first corner has begun.
            match pieces.first_mut().filter(|_| inside.first() == Some(&true)) {
                Some(first) => first.splice(0..0, rest).for_each(drop),
                None => pieces.push(rest),
            }
        }
        for piece in pieces {
            self.piece(&piece, is_ring);
        }
    }

    fn middle(&self, column: u32, row: u32) -> Point2<f64> {
        nalgebra::center(&self.node(column, row), &self.node(column + 1, row + 1))
    }

    /// The part of a cell that is inside, counter-clockwise: its boundary, and its triangles.
    fn piece(&mut self, corners: &[Corner], is_ring: bool) {
        let following = corners.iter().cycle().skip(1);
        for (one, other) in corners.iter().zip(following) {
            // Counter-clockwise, the crossing out of the region comes before the one back into it.
            if let (Corner::Crossing(from), Corner::Crossing(to)) = (one, other) {
                self.cross(*from);
                self.cross(*to);
                self.next.insert(*from, *to);
            }
        }
        if is_ring {
            return;
        }
        let places: Vec<_> = corners.iter().map(|corner| self.place(*corner)).collect();
        if let Some((first, rest)) = places.split_first() {
            let pairs = rest.iter().zip(rest.iter().skip(1));
            self.region.triangles.extend(pairs.map(|(second, third)| [*first, *second, *third]));
        }
    }

    fn place(&mut self, corner: Corner) -> u32 {
        let at = match corner {
            Corner::Node(column, row) => self.node(column, row),
            Corner::Crossing(edge) => self.cross(edge).at,
        };
        let corners = &mut self.region.corners;
        *self.places.entry(corner).or_insert_with(|| {
            corners.push(at);
            u32::try_from(corners.len() - 1).unwrap_or(u32::MAX)
        })
    }

    /// Where the boundary crosses an edge between two nodes that differ.
    fn cross(&mut self, edge: Edge) -> Vertex {
        if let Some(known) = self.crossings.get(&edge) {
            return *known;
        }
        let Edge { column, row, upward } = edge;
        let (right, above) = if upward { (column, row + 1) } else { (column + 1, row) };
        let (mut within, mut without) = (self.node(column, row), self.node(right, above));
        if !self.is_inside(column, row) {
            std::mem::swap(&mut within, &mut without);
        }
        let beyond = self.is_ring(column, row) || self.is_ring(right, above);
        let at = if beyond { within } else { self.between(within, without) };
        let along_edge = if upward {
            column == 1 || column == self.grid.columns + 1
        } else {
            row == 1 || row == self.grid.rows + 1
        };
        let cut = beyond || along_edge;
        let vertex = Vertex { at, cut };
        self.crossings.insert(edge, vertex);
        vertex
    }

    /// The last point inside on the way from a point inside to one that is not.
    fn between(&self, mut within: Point2<f64>, mut without: Point2<f64>) -> Point2<f64> {
        let enough = self.tolerance * SHARPER;
        for _ in 0..HALVINGS {
            if (without - within).norm() <= enough {
                break;
            }
            let middle = nalgebra::center(&within, &without);
            if (self.inside)(&middle) {
                within = middle;
            } else {
                without = middle;
            }
        }
        within
    }

    /// Follows the boundary from crossing to crossing.
    fn join(mut self) -> Region {
        while let Some((start, mut edge)) = self.next.pop_first() {
            let mut vertices = vec![self.cross(start)];
            while edge != start {
                let (last, vertex) = (vertices.last().copied(), self.cross(edge));
                if let Some(last) = last {
                    self.break_up(last, vertex, BREAKS, &mut vertices);
                }
                vertices.push(vertex);
                let Some(next) = self.next.remove(&edge) else { break };
                edge = next;
            }
            if let Some((last, first)) = vertices.last().copied().zip(vertices.first().copied()) {
                self.break_up(last, first, BREAKS, &mut vertices);
            }
            vertices.dedup();
            self.region.loops.push(vertices);
        }
        self.region
    }

    /// Adds the points of the boundary between two of its points, neither of which is added.
    fn break_up(&self, from: Vertex, to: Vertex, breaks: u32, vertices: &mut Vec<Vertex>) {
        let chord = to.at - from.at;
        if breaks == 0 || (from.cut && to.cut) || chord.norm() <= self.tolerance {
            return;
        }
        let middle = nalgebra::center(&from.at, &to.at);
        let aside = Vector2::new(-chord.y, chord.x) * (self.tolerance / chord.norm());
        if (self.inside)(&(middle + aside)) && !(self.inside)(&(middle - aside)) {
            return;
        }
        // To the left is the region. No right angle over the chord has its corner farther away than half of it.
        let left = Vector2::new(-chord.y, chord.x) * 0.55;
        let at = if (self.inside)(&middle) {
            let outside = middle - left;
            if (self.inside)(&outside) {
                return;
            }
            self.between(middle, outside)
        } else {
            let inside = middle + left;
            if !(self.inside)(&inside) {
                return;
            }
            self.between(inside, middle)
        };
        let vertex = Vertex { at, cut: false };
        self.break_up(from, vertex, breaks - 1, vertices);
        vertices.push(vertex);
        self.break_up(vertex, to, breaks - 1, vertices);
    }
}
