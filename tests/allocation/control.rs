//! Control of the allocation counter: a wasteful transform must be counted.

use super::{Calls, counter, methods};
use nalgebra::{Vector2, Vector3};
use std::hint::black_box;
use twin_kinematics::gantry::Gantry2;
use twin_kinematics::transform::{Serial, Straight};
use twin_kinematics::{Coordinate, Result, Transform};

#[test]
fn asking_and_asking_for_more_is_counted() {
    let mut held = black_box(Vec::with_capacity(1));
    assert_eq!(counter::asked_during(|| held.push(1.0)), 0);
    assert_eq!(counter::asked_during(|| held.push(2.0)), 1);
    assert_eq!(counter::asked_during(|| drop(held)), 0);
    assert_eq!(counter::asked_during(|| drop(black_box(Box::new(1.0)))), 1);
    let other = || drop(black_box(std::thread::Builder::new().spawn(|| drop(vec![1.0]))));
    assert!(counter::asked_during(other) > 0, "a thread takes memory from whom starts it");
}

/// A transform that keeps a list where none is needed.
#[derive(Clone, Debug)]
struct Wasteful(Gantry2);

impl Transform<2> for Wasteful {
    type Differential = Serial<Straight>;

    fn coordinates(&self) -> &'static [Coordinate] {
        self.0.coordinates()
    }

    fn rotary(&self) -> [bool; 2] {
        self.0.rotary()
    }

    fn to_tool(&self, axes: &Vector2<f64>) -> Result<Vector2<f64>> {
        self.0.to_tool(axes)
    }

    fn to_axes(&self, tool: &Vector2<f64>) -> Result<Vector2<f64>> {
        let list: Vec<f64> = black_box(tool.iter().copied().collect());
        self.0.to_axes(&Vector2::from_column_slice(&list))
    }

    fn at_axes(&self, axes: &Vector2<f64>) -> Result<(Vector2<f64>, Self::Differential)> {
        self.0.at_axes(axes)
    }

    fn at_tool(
        &self,
        tool: &Vector2<f64>,
        near: &Vector2<f64>,
    ) -> Result<(Vector2<f64>, Self::Differential)> {
        self.0.at_tool(tool, near)
    }

    fn characteristic_length(&self) -> f64 {
        self.0.characteristic_length()
    }

    fn holding(self, tip: &Vector3<f64>) -> Self {
        Self(self.0.holding(tip))
    }
}

#[test]
fn a_transform_that_asks_for_memory_is_found() {
    let mut calls = Calls::default();
    let wasteful = Wasteful(Gantry2::new([0.0; 2]).unwrap());
    let place = Vector2::new(0.1, 0.2);
    methods::of_transform(&mut calls, "wasteful", &wasteful, &place, &place);
    assert_eq!(calls.asking, ["wasteful: to_axes", "wasteful: to_axes_near"]);
}
