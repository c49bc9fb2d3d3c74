//! Path of the axes for time-optimal planning: derivatives at the nodes of a grid, and limits.

/// Limits of one axis, m or rad and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    pub velocity: f64,
    pub acceleration: f64,
    pub jerk: f64,
}

/// The derivatives q′, q″ and q‴ of the axes by the path parameter at one place.
pub type Rates = [Vec<f64>; 3];

/// A path whose axes have three continuous derivatives, at the nodes of a grid.
#[derive(Clone, Debug)]
pub struct Path {
    /// One per axis.
    pub limits: Vec<Limits>,
    /// Path parameter, rising.
    pub nodes: Vec<f64>,
    /// One per node.
    pub rates: Vec<Rates>,
    /// Largest rate of the path parameter (the programmed velocity, where that is path length), per s.
    pub feed: f64,
}

impl Path {
    /// `rates` of the path parameter at these nodes.
    pub fn new(limits: Vec<Limits>, nodes: Vec<f64>, mut rates: impl FnMut(f64) -> Rates) -> Self {
        let rates = nodes.iter().map(|s| rates(*s)).collect();
        Self { limits, nodes, rates, feed: f64::INFINITY }
    }

    pub fn cells(&self) -> usize {
        self.nodes.len() - 1
    }

    pub fn axes(&self) -> usize {
        self.limits.len()
    }

    /// The largest squared rate at a node that no velocity limit forbids.
    pub fn cap(&self, node: usize) -> f64 {
        let [first, ..] = &self.rates[node];
        let axes = first.iter().zip(&self.limits);
        let rate = axes.map(|(first, limits)| limits.velocity / first.abs());
        rate.fold(self.feed, f64::min).powi(2)
    }

    /// Duration with these squared rates at the nodes, linear between them, s.
    pub fn duration(&self, squared: &[f64]) -> f64 {
        assert_eq!(squared.len(), self.nodes.len());
        let cells = self.nodes.windows(2).zip(squared.windows(2));
        cells.map(|(s, b)| 2.0 * (s[1] - s[0]) / (b[0].sqrt() + b[1].sqrt())).sum()
    }

    /// The largest share of an acceleration limit that these squared rates, linear between the nodes, ask for at either
    /// end of a cell.
    pub fn acceleration_use(&self, squared: &[f64]) -> f64 {
        let mut most = 0.0_f64;
        for (cell, (s, b)) in self.nodes.windows(2).zip(squared.windows(2)).enumerate() {
            let a = (b[1] - b[0]) / (2.0 * (s[1] - s[0]));
            for (b, [first, second, _]) in b.iter().zip(&self.rates[cell..]) {
                for (axis, limits) in self.limits.iter().enumerate() {
                    let acceleration = first[axis] * a + second[axis] * b;
                    most = most.max(acceleration.abs() / limits.acceleration);
                }
            }
        }
        most
    }
}

/// Nodes of equal cells from 0 to `end`.
pub fn equal(end: f64, cells: usize) -> Vec<f64> {
    (0..=cells).map(|node| end * (as_float(node) / as_float(cells))).collect()
}

/// A count as a number.
pub fn as_float(count: usize) -> f64 {
    f64::from(u32::try_from(count).expect("a count that fits"))
}
