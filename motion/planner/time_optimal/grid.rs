//! Grid: a path through the space of the axes, cut into cells, with the limits at their ends.
//!
//! With the path parameter u, b = u̇² and a = ü:
//!
//! ```text
//!   q̇ = q′·√b        q̈ = q′·a + q″·b        q⃛ = (q′·ȧ/√b + 3·q″·a + q‴·b)·√b
//! ```
//!
//! so that limits of velocity are bounds on b, and limits of acceleration are linear in a and b.

use super::bound::{
    AxisLimits, Cap, CapSource, Constraint, Disc, JerkRow, Part, Rates, Row, number,
};
use twin_kinematics::AxisVector;

/// One end of a cell.
#[derive(Clone, Debug)]
pub struct CellEnd<'a> {
    /// The axes.
    pub rates: Rates,
    /// Bound of u̇² in addition to the axes.
    pub cap: Cap,
    /// Further half planes, as many at every place: the programmed accelerations along the path, motor torques.
    pub rows: &'a [Row],
    /// The acceleration of the tool tip, if it is limited.
    pub disc: Option<Disc>,
}

/// Cells of a path, one after the other, each with the limits at its two ends. Where the path is smooth, the end of one
/// cell and the start of the next say the same.
#[derive(Clone, Debug)]
pub struct Grid {
    limits: Vec<AxisLimits>,
    /// One per axis.
    parts: Vec<Part>,
    limits_jerk: bool,
    extra: usize,
    /// Axes whose deceleration is a limit of its own. Their rows hold the larger of the two limits in both directions,
    /// and a further row each the smaller one in its direction; where the axis turns round, the smaller one holds in both.
    own_decelerations: Vec<usize>,
    /// Path parameter of every node: one more than cells.
    u: Vec<f64>,
    /// Per node, over both cells that meet there.
    caps: Vec<Cap>,
    /// Per cell, at both ends: axes, then further rows, then those of [`Self::own_decelerations`].
    rows: Vec<Row>,
    /// Per cell, at both ends: axes. None where no axis has a limit.
    jerks: Vec<JerkRow>,
    /// Per cell, half-way: axes.
    middles: Vec<JerkRow>,
    /// Per cell: whether jerks are limited at its ends in any case.
    dense: Vec<bool>,
    /// Per cell, at both ends. None before the first cell with a disc.
    discs: Vec<Option<Disc>>,
    /// Per cell: the smaller cap of its two ends, as each end has it.
    cell_caps: Vec<[Cap; 2]>,
}

impl Grid {
    /// No cells yet, from the parameter `start` on. Every cell end will have `extra` further rows.
    pub fn new(limits: Vec<AxisLimits>, extra: usize, start: f64) -> Self {
        let part = |limits: &AxisLimits| Part {
            velocity: 1.0 / limits.velocity,
            acceleration: [
                1.0 / limits.smallest_acceleration(),
                1.0 / limits.largest_acceleration(),
            ],
            jerk: limits.jerk.map_or(0.0, |jerk| 1.0 / jerk),
        };
        Self {
            parts: limits.iter().map(part).collect(),
            limits_jerk: limits.iter().any(|limits| limits.jerk.is_some()),
            own_decelerations: (0..limits.len())
                .filter(|axis| limits[*axis].has_own_deceleration())
                .collect(),
            limits,
            extra,
            u: vec![start],
            caps: vec![Cap::NONE],
            rows: Vec::new(),
            jerks: Vec::new(),
            middles: Vec::new(),
            dense: Vec::new(),
            discs: Vec::new(),
            cell_caps: Vec::new(),
        }
    }

    /// Adds a cell of the given `length` (of the parameter).
    pub fn push(&mut self, length: f64, start: &CellEnd<'_>, end: &CellEnd<'_>) {
        let here = self.u.last().copied().unwrap_or_default();
        self.u.push(here + length);
        let firsts = [&start.rates.first, &end.rates.first];
        let caps = [self.push_end(start, firsts), self.push_end(end, firsts)];
        if start.disc.is_some() || end.disc.is_some() || !self.discs.is_empty() {
            self.discs.resize(2 * self.cell_caps.len(), None);
            self.discs.extend([start.disc, end.disc]);
        }
        if let Some(last) = self.caps.last_mut() {
            *last = last.min(caps[0]);
        }
        self.caps.push(caps[1]);
        self.cell_caps.push(caps);
        self.dense.push(false);
        let axes = self.limits.len();
        let from = self.jerks.len().saturating_sub(2 * axes);
        let (start, end) =
            self.jerks.get(from..).unwrap_or_default().split_at_checked(axes).unwrap_or_default();
        self.middles.extend(start.iter().zip(end).map(|(start, end)| start.between(end)));
    }

    /// Half-way through the newest cell the axes have these rates, which else are taken to be the mean of those at its ends.
    pub(super) fn bend_last(&mut self, middle: &Rates) {
        let from = self.middles.len().saturating_sub(self.limits.len());
        let rows = self.middles.get_mut(from..).unwrap_or_default();
        let rates = middle.first.iter().zip(middle.second.iter()).zip(middle.third.iter());
        for ((row, part), ((first, second), third)) in rows.iter_mut().zip(&self.parts).zip(rates) {
            *row = JerkRow::new([*first, *second, *third], part);
        }
    }

    /// Limits jerks at the ends of the newest cell in any case.
    pub(super) fn make_last_dense(&mut self) {
        if let Some(dense) = self.dense.last_mut() {
            *dense = true;
        }
    }

    /// True if jerks are limited at the ends of a cell in any case.
    pub(super) fn is_dense(&self, cell: usize) -> bool {
        self.dense.get(cell).copied().unwrap_or_default()
    }

    /// Adds the limits at one end of a cell at whose ends the axes have the first derivatives `firsts`.
    fn push_end(&mut self, end: &CellEnd<'_>, firsts: [&AxisVector; 2]) -> Cap {
        let CellEnd { rates: Rates { first, second, third }, cap, rows, .. } = end;
        // The largest part of its limit that an axis has at the unit rate.
        let (mut most, mut fastest) = (0.0, 0);
        let values = first.iter().zip(second.iter()).zip(&self.parts);
        let turns = |axis: usize| firsts[0][axis] * firsts[1][axis] <= 0.0;
        self.rows.extend(values.enumerate().map(|(axis, ((&d1, &d2), part))| {
            let velocity = d1.abs() * part.velocity;
            if velocity > most {
                (most, fastest) = (velocity, axis);
            }
            let [narrow, wide] = part.acceleration;
            let factor = if turns(axis) { narrow } else { wide };
            Row { a: d1 * factor, b: d2 * factor }
        }));
        if self.extra > 0 {
            let given = rows.iter().copied().chain(std::iter::repeat(Row::default()));
            self.rows.extend(given.take(self.extra));
        }
        for &axis in &self.own_decelerations {
            let [narrow, _] = self.parts[axis].acceleration;
            let (d1, d2) = (first[axis], second[axis]);
            let slows = self.limits[axis].deceleration < self.limits[axis].acceleration;
            // The acceleration times this is what the smaller limit bounds.
            let side = if slows { -d1.signum() } else { d1.signum() } * narrow;
            let row = Row { a: side * d1, b: side * d2 };
            self.rows.push(if turns(axis) { Row::default() } else { row });
        }
        if self.limits_jerk {
            let values = first.iter().zip(second.iter()).zip(third.iter()).zip(&self.parts);
            self.jerks
                .extend(values.map(|(((d1, d2), d3), part)| JerkRow::new([*d1, *d2, *d3], part)));
        }
        let axes = 1.0 / (most * most);
        cap.min(Cap { v2: axes, source: CapSource::AxisVelocity(number(fastest)) })
    }

    /// Bounds u̇² at the newest node as well.
    pub(crate) fn cap_last(&mut self, cap: Cap) {
        if let Some(last) = self.caps.last_mut() {
            *last = last.min(cap);
        }
    }

    /// Makes the limits of acceleration, of jerk and of velocity in the newest cell tighter by these factors.
    pub(super) fn tighten_last(&mut self, [acceleration, jerk, velocity]: [f64; 3]) {
        let width = 2 * self.width();
        for row in self.rows.iter_mut().rev().take(width) {
            row.a *= acceleration;
            row.b *= acceleration;
        }
        let ends = 2 * self.cells();
        let discs = self.discs.iter_mut().skip(ends.saturating_sub(2)).flatten();
        for part in discs.flat_map(|disc| disc.a.iter_mut().chain(&mut disc.b)) {
            *part *= acceleration;
        }
        let axes = self.limits.len();
        let ends = self.jerks.iter_mut().rev().take(2 * axes);
        for row in ends.chain(self.middles.iter_mut().rev().take(axes)) {
            row.tighten(jerk);
        }
        if let Some(caps) = self.cell_caps.last_mut() {
            for (cap, node) in caps.iter_mut().rev().zip(self.caps.iter_mut().rev()) {
                cap.v2 /= velocity * velocity;
                *node = node.min(*cap);
            }
        }
    }

    /// Bounds u̇² at a node as well.
    pub(crate) fn cap_at(&mut self, node: usize, cap: Cap) {
        if let Some(slot) = self.caps.get_mut(node) {
            *slot = slot.min(cap);
        }
    }

    /// Limits of the axes.
    pub fn limits(&self) -> &[AxisLimits] {
        &self.limits
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cell_caps.len()
    }

    /// Path parameter of the nodes: one more than cells.
    pub fn nodes(&self) -> &[f64] {
        &self.u
    }

    /// Largest u̇² at the nodes.
    pub(crate) fn caps(&self) -> &[Cap] {
        &self.caps
    }

    /// Length of a cell.
    pub fn length(&self, cell: usize) -> f64 {
        match self.u.get(cell..) {
            Some([from, to, ..]) => to - from,
            _ => 0.0,
        }
    }

    /// The caps that the two ends of a cell have themselves.
    pub(crate) fn cell_caps(&self, cell: usize) -> [Cap; 2] {
        self.cell_caps.get(cell).copied().unwrap_or([Cap::NONE; 2])
    }

    /// Number of rows at an end of a cell.
    fn width(&self) -> usize {
        self.limits.len() + self.extra + self.own_decelerations.len()
    }

    /// The constraint of a further row.
    pub(super) fn further(&self, row: usize) -> Constraint {
        match row.checked_sub(self.extra).and_then(|row| self.own_decelerations.get(row)) {
            Some(axis) => Constraint::AxisAcceleration(number(*axis)),
            None => Constraint::Further(number(row)),
        }
    }

    /// The rows of the axes (each holds with both signs) and the further ones (as they are) at an end of a cell.
    pub(super) fn rows(&self, cell: usize, end: End) -> (&[Row], &[Row]) {
        let width = self.width();
        let from = (2 * cell + end as usize) * width;
        let rows = self.rows.get(from..from + width).unwrap_or_default();
        rows.split_at_checked(self.limits.len()).unwrap_or_default()
    }

    /// The rows at both ends of a cell, each as [`Self::rows`]; none if the tool tip is limited there as well.
    #[inline]
    pub(super) fn cell_rows(&self, cell: usize) -> Option<[(&[Row], &[Row]); 2]> {
        if self.discs.get(2 * cell..2 * cell + 2).is_some_and(|discs| discs != [None; 2]) {
            return None;
        }
        let width = self.width();
        let (start, finish) =
            self.rows.get(2 * cell * width..2 * (cell + 1) * width)?.split_at_checked(width)?;
        let axes = self.limits.len();
        Some([start.split_at_checked(axes)?, finish.split_at_checked(axes)?])
    }

    /// The jerk rows of the axes at an end of a cell.
    pub(super) fn jerks(&self, cell: usize, end: End) -> &[JerkRow] {
        let width = self.limits.len();
        let from = (2 * cell + end as usize) * width;
        self.jerks.get(from..from + width).unwrap_or_default()
    }

    /// The jerk rows of the axes half-way through a cell.
    pub(super) fn middle_jerks(&self, cell: usize) -> &[JerkRow] {
        let width = self.limits.len();
        self.middles.get(cell * width..(cell + 1) * width).unwrap_or_default()
    }

    /// By how much jerks differ at the ends of a cell from those in its middle, at most, as parts of their limits, with these b,
    /// a and γ at its start, in its middle and at its end.
    pub(super) fn varies(&self, cell: usize, motion: &[[f64; 3]; 3]) -> f64 {
        let [start, middle, end] =
            motion.map(|[b, a, gamma]| move |row: &JerkRow| row.at(b, a, gamma));
        let starts = self.jerks(cell, End::Start).iter().map(start);
        let ends = self.jerks(cell, End::Finish).iter().map(end);
        let middles = self.middle_jerks(cell).iter().map(middle);
        let most = |most: f64, ((start, end), middle): ((f64, f64), f64)| {
            most.max((start - middle).abs()).max((end - middle).abs())
        };
        starts.zip(ends).zip(middles).fold(0.0, most)
    }

    /// The largest u̇² at which a cell keeps the jerk limits at its ends and in its middle without ü.
    pub(super) fn jerk_bound(&self, cell: usize) -> f64 {
        let places =
            [self.jerks(cell, End::Start), self.middle_jerks(cell), self.jerks(cell, End::Finish)];
        let most =
            places.iter().copied().flatten().fold(0.0, |most: f64, row| most.max(row.third.abs()));
        most.powf(-2.0 / 3.0)
    }

    /// The disc of the tool tip at an end of a cell.
    pub(super) fn disc(&self, cell: usize, end: End) -> Option<&Disc> {
        self.discs.get(2 * cell + end as usize)?.as_ref()
    }
}

/// One of the ends of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Start = 0,
    Finish = 1,
}

impl End {
    pub(super) const BOTH: [Self; 2] = [Self::Start, Self::Finish];
}

impl Grid {
    /// The largest acceleration and jerk of the parameter from rest at the start of a cell, and to rest at its end.
    pub(super) fn rest_rates(&self, cell: usize) -> [[f64; 2]; 2] {
        let acceleration = |end: End, sign: f64| {
            let (axes, further) = self.rows(cell, end);
            let most = axes.iter().fold(0.0, |most: f64, row| most.max(row.a.abs()));
            1.0 / further.iter().fold(most, |most, row| most.max(sign * row.a))
        };
        [
            [acceleration(End::Start, 1.0), self.jerk_start(cell)],
            [acceleration(End::Finish, -1.0), self.jerk_end(cell)],
        ]
    }

    /// The largest jerk of the parameter with which a cell can be begun from rest.
    pub fn jerk_start(&self, cell: usize) -> f64 {
        rest_jerk(self.jerks(cell, End::Start))
    }

    /// The largest jerk of the parameter with which a cell can end at rest.
    pub fn jerk_end(&self, cell: usize) -> f64 {
        rest_jerk(self.jerks(cell, End::Finish))
    }
}

fn rest_jerk(rows: &[JerkRow]) -> f64 {
    1.0 / rows.iter().fold(0.0, |most, row| row.first.abs().max(most))
}
