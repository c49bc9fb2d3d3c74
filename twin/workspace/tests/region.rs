//! Tests of regions: area, corners, boundaries and triangles.

use super::near;
use crate::workspace::Grid;
use crate::workspace::region::{EXACT, Region};
use nalgebra::Point2;
use std::f64::consts::{FRAC_PI_2, PI};

fn trace(inside: &dyn Fn(&Point2<f64>) -> bool) -> Region {
    let grid = Grid::over(Point2::new(-1.05, -1.02), Point2::new(1.0, 1.03), 100);
    let nodes: Vec<_> = grid.nodes().map(|(column, row)| inside(&grid.node(column, row))).collect();
    Region::trace(&grid, &nodes, EXACT, inside)
}

#[test]
fn a_ring_has_the_area_of_a_ring() {
    let ring = trace(&|at| (0.3..=0.8).contains(&at.coords.norm()));
    assert_eq!(ring.loops.len(), 2);
    near(ring.area(), PI * (0.64 - 0.09), 2e-5);
    for vertex in ring.vertices() {
        let radius = vertex.at.coords.norm();
        assert!((radius - 0.8).abs() < 1e-6 || (radius - 0.3).abs() < 1e-6, "{radius}");
    }
    let [low, high] = ring.extent().unwrap();
    for (found, expected) in [(low.x, -0.8), (low.y, -0.8), (high.x, 0.8), (high.y, 0.8)] {
        near(found, expected, 1e-5);
    }
    near(ring.distance(&Point2::new(0.5, 0.0)), 0.2, 1e-5);
    // A line around, and one around the hole: nothing is cut off.
    let lines = ring.lines();
    assert_eq!(lines.len(), 2);
    for line in lines {
        assert_eq!(line.first(), line.last());
    }
}

/// Corners lie anywhere in a cell; a turned square has them on no grid line.
#[test]
fn corners_are_found() {
    let square = |turn: f64, half: f64| {
        trace(&|at| {
            let (sin, cos) = turn.sin_cos();
            let (x, y) = (at.x * cos + at.y * sin, at.y * cos - at.x * sin);
            x.abs() <= half && y.abs() <= half
        })
    };
    for turn in [0.0, 0.1, 0.3, FRAC_PI_2 / 2.0] {
        for half in [0.5, 0.4321, 0.613] {
            let square = square(turn, half);
            near(square.area(), 4.0 * half * half, 1e-6);
            let [low, high] = square.extent().unwrap();
            let (sin, cos) = turn.sin_cos();
            near(high.x, half * (sin + cos), 1e-5);
            near(low.y, -half * (sin + cos), 1e-5);
        }
    }
}

/// The region right of a line: the edge of the grid closes it without being a boundary.
#[test]
fn the_edge_of_the_grid_is_no_boundary() {
    let half = trace(&|at| at.x >= 0.123_456);
    let grid = Grid::over(Point2::new(-1.05, -1.02), Point2::new(1.0, 1.03), 100);
    near(half.area(), (grid.max().x - 0.123_456) * 2.05, 1e-6);
    let lines = half.lines();
    assert_eq!(lines.len(), 1, "{lines:?}");
    for point in &lines[0] {
        near(point.x, 0.123_456, 1e-6);
    }
    assert!(trace(&|_| true).lines().is_empty());
    near(trace(&|_| true).area(), 2.05 * 2.05, 1e-9);
    let nothing = trace(&|_| false);
    assert_eq!((nothing.loops.len(), nothing.area(), nothing.extent()), (0, 0.0, None));
    assert!(nothing.distance(&Point2::origin()).is_infinite());
}

/// Two squares that touch at the middle of a cell, diagonally: apart or together as the point between says.
#[test]
fn diagonal_neighbours_are_separate() {
    let grid = Grid::over(Point2::origin(), Point2::new(3.0, 3.0), 3);
    let nodes = |diagonal: bool| -> Vec<bool> {
        grid.nodes()
            .map(|(column, row)| match (column, row) {
                (1, 1) | (2, 2) => diagonal,
                (1, 2) | (2, 1) => !diagonal,
                _ => false,
            })
            .collect()
    };
    let middle = Point2::new(1.5, 1.5);
    for diagonal in [true, false] {
        let two = Region::trace(&grid, &nodes(diagonal), 1.0, &|at| {
            let node = at.map(f64::round);
            (at - node).norm() < 0.4
                && (1.0..=2.0).contains(&node.x)
                && (1.0..=2.0).contains(&node.y)
                && ((node.x - node.y).abs() < 0.5) == diagonal
        });
        assert_eq!(two.loops.len(), 2);
        let one = Region::trace(&grid, &nodes(diagonal), 1.0, &|at| (at - middle).norm() < 0.8);
        assert_eq!(one.loops.len(), 1);
    }
}

/// The triangles fill the region except what bends within a cell.
#[test]
fn triangles_fill_the_region() {
    let ring = trace(&|at| (0.3..=0.8).contains(&at.coords.norm()));
    let corner = |place: u32| ring.corners[usize::try_from(place).unwrap()];
    let areas = ring.triangles.iter().map(|triangle| {
        let [one, two, three] = triangle.map(corner);
        (two - one).perp(&(three - one)) / 2.0
    });
    let areas: Vec<_> = areas.collect();
    assert!(areas.iter().all(|area| *area > -1e-12), "a triangle is the wrong way round");
    near(areas.iter().sum(), PI * (0.64 - 0.09), 1e-3);
}
