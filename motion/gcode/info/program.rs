//! Key figures of a program (manual 3.3, "Info").

use crate::decode::Rule;
use nalgebra::Point3;
use twin_path::Place;
use twin_path::{Bounds, ElementKind, PathElement, Shape};

/// Objects by what they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Positioning (G0).
    pub rapids: u64,
    /// Cuts along lines.
    pub lines: u64,
    /// Cuts along arcs and helices.
    pub arcs: u64,
    /// Cuts along ellipses.
    pub ellipses: u64,
    /// Cuts along splines and parabolas.
    pub cubics: u64,
    /// Probing moves (G38).
    pub probes: u64,
    /// Jumps of the set-point (G92).
    pub jumps: u64,
    /// M functions.
    pub m_functions: u64,
    /// Dwells.
    pub dwells: u64,
}

impl Counts {
    /// All objects.
    pub fn total(&self) -> u64 {
        let Self { rapids, lines, arcs, ellipses, cubics, probes, jumps, m_functions, dwells } =
            self;
        rapids + lines + arcs + ellipses + cubics + probes + jumps + m_functions + dwells
    }
}

/// Count of a broken rule, and its first place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleCount {
    /// The rule.
    pub rule: Rule,
    /// The count.
    pub count: u64,
    /// The first block that breaks it.
    pub first: Place,
}

/// Key figures of a program, added up as its elements pass: give it every element and every diagnostic.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProgramInfo {
    /// Name of the program, if it has one. The decoder knows.
    pub name: Option<String>,
    /// Lines of the file. The decoder knows.
    pub lines: u32,
    /// Blocks that gave objects; a block that is run again counts again.
    pub blocks: u64,
    /// Objects by what they are.
    pub objects: Counts,
    /// Switch points on them.
    pub switches: u64,
    /// Length of the way of the tool in rapids, m.
    pub rapid_length: f64,
    /// And in cuts and probing moves, m.
    pub cut_length: f64,
    /// The box around rapids, cuts and probing moves.
    pub bounds: Option<Bounds>,
    /// Start of the path, m.
    pub start: Option<Point3<f64>>,
    /// End of the path, m.
    pub end: Option<Point3<f64>>,
    /// Sum of all dwells, ns.
    pub dwell_ns: i64,
    /// Duration, ns: filled in by the planner of the path.
    pub duration_ns: Option<i64>,
    /// The rules that are broken, in the order in which that happens first.
    pub rules: Vec<RuleCount>,
    last: Option<Place>,
}

impl ProgramInfo {
    /// Adds an element.
    pub fn element(&mut self, element: &PathElement) {
        if self.last.replace(element.place) != Some(element.place) {
            self.blocks += 1;
        }
        let counts = &mut self.objects;
        let count = match (element.kind, &element.shape) {
            (ElementKind::Rapid, _) => &mut counts.rapids,
            (ElementKind::Cut, Shape::Line { .. }) => &mut counts.lines,
            (ElementKind::Cut, Shape::Arc(_)) => &mut counts.arcs,
            (ElementKind::Cut, Shape::Ellipse(_)) => &mut counts.ellipses,
            (ElementKind::Cut, Shape::Cubic(_)) => &mut counts.cubics,
            (ElementKind::Probe { .. }, _) => &mut counts.probes,
            (ElementKind::Jump, _) => &mut counts.jumps,
            (ElementKind::MFunction { .. }, _) => &mut counts.m_functions,
            (ElementKind::Dwell { time_ns }, _) => {
                self.dwell_ns = self.dwell_ns.saturating_add(time_ns);
                &mut counts.dwells
            }
        };
        *count += 1;
        self.switches += element.switches().len() as u64;
        self.start.get_or_insert(element.start());
        self.end = Some(element.end());
        if element.kind.is_motion() {
            let length = element.tool_length();
            match element.kind {
                ElementKind::Rapid => self.rapid_length += length,
                _ => self.cut_length += length,
            }
            let bounds = element.shape.bounds();
            self.bounds = Some(self.bounds.map_or(bounds, |all| all.with(&bounds)));
        }
    }

    /// Adds something that is wrong with the program.
    pub fn diagnostic(&mut self, rule: Rule, place: Place) {
        match self.rules.iter_mut().find(|count| count.rule == rule) {
            Some(count) => count.count += 1,
            None => self.rules.push(RuleCount { rule, count: 1, first: place }),
        }
    }

    /// Length of the whole way of the tool, m.
    pub fn length(&self) -> f64 {
        self.rapid_length + self.cut_length
    }
}
