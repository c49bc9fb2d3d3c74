//! DXF import: a drawing as programs.

use super::arrange::{self, Section};
use super::error::{DxfReadError, Note};
use super::expand::Expander;
use super::primitive::Primitive;
use super::survey::survey;
use crate::Place;
use crate::{ElementKind, PathElement, Shape};
use ::dxf::Drawing;
use nalgebra::Point3;
use std::io::BufRead;

/// Ends as near as this are made the same point, m; wider gaps are bridged by a line.
const SNAP: f64 = 1e-6;

/// Division of a drawing into programs (manual 3.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Split {
    /// One program for all.
    #[default]
    Whole,
    /// One program per layer.
    Layers,
    /// One program per connected section.
    Sections,
}

/// The order of the sections of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// That of their first entities in the drawing.
    #[default]
    Drawing,
    /// Each the nearest to the end of the one before. Sections are entered from the nearer end.
    Nearest,
}

/// Heights between which the tool goes down to cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heights {
    /// Height of rapids, m.
    pub safe: f64,
    /// Height of cuts, m: all of the drawing is at this height.
    pub cut: f64,
    /// Feed downwards, m/s.
    pub plunge_feed: f64,
}

/// Limits that a hostile drawing cannot exceed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Bytes of the file.
    pub bytes: u64,
    /// Pieces of path and inserted blocks.
    pub pieces: usize,
    /// Blocks in blocks.
    pub depth: usize,
    /// Largest coordinate, m.
    pub farthest: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { bytes: 1 << 28, pieces: 1_000_000, depth: 16, farthest: 1e3 }
    }
}

/// Options of the import.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportOptions {
    /// Programs.
    pub split: Split,
    /// Order of the sections.
    pub order: Order,
    /// Ends that are at most this far apart are joined, m.
    pub join_tolerance: f64,
    /// Tolerance of the lines that replace curves which cannot be kept (rational splines), m.
    pub chord_tolerance: f64,
    /// Start of every program, m.
    pub start: Point3<f64>,
    /// Heights; without them the heights of the drawing hold and rapids go straight.
    pub heights: Option<Heights>,
    /// Feed of the cuts and rapids, m/s.
    pub feed: f64,
    /// Acceleration and deceleration, m/s².
    pub acceleration: f64,
    /// Length of the drawing's unit, m, if the drawing does not say.
    pub default_unit: f64,
    /// Limits.
    pub limits: Limits,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            split: Split::default(),
            order: Order::default(),
            join_tolerance: 1e-5,
            chord_tolerance: 1e-5,
            start: Point3::origin(),
            heights: None,
            feed: 0.1,
            acceleration: 0.1,
            default_unit: 1e-3,
            limits: Limits::default(),
        }
    }
}

impl ImportOptions {
    /// True if lines on the layer RAPID stay rapids: the order and the heights of the drawing must stay, too.
    fn keeps_rapids(&self) -> bool {
        (self.split, self.order, self.heights) == (Split::Whole, Order::Drawing, None)
    }
}

/// A path made of a drawing, or of a part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// `drawing`, the layer's name, or the section's number and layer.
    pub name: String,
    /// Its elements. Their places are lines of the drawing's file: of the entity, or of the INSERT that brings it in.
    pub elements: Vec<PathElement>,
    /// Connected sections in it.
    pub sections: usize,
}

/// Result of an import.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The programs.
    pub programs: Vec<Program>,
    /// Notes about parts that are not, or not exactly, in them.
    pub notes: Vec<Note>,
    /// Length of the drawing's unit, m.
    pub unit: f64,
    /// True if the drawing gives it (`$INSUNITS`).
    pub unit_known: bool,
}

/// Makes programs of the drawing in `reader`, a text DXF file.
///
/// The drawing is held in memory as a whole, within [`Limits`].
///
/// # Errors
/// [`DxfReadError`].
pub fn import(reader: impl BufRead, options: &ImportOptions) -> Result<Import, DxfReadError> {
    let survey = survey(reader, options.limits.bytes)?;
    let drawing = Drawing::load(&mut survey.drawing.as_slice())?;
    let known = survey.units.and_then(unit);
    let unit = known.unwrap_or(options.default_unit);
    let tolerance = options.chord_tolerance / unit;
    let keeps_rapids = options.keeps_rapids();
    let mut expander = Expander::new(&drawing, &survey, options.limits, tolerance, keeps_rapids)?;
    expander.run(unit)?;
    let notes = expander.notes();
    let by_layer = options.split == Split::Layers;
    let sections = arrange::join_between_rapids(&expander.chains, options.join_tolerance, by_layer);
    let order = |sections: Vec<Section>| match options.order {
        Order::Drawing => sections,
        Order::Nearest => arrange::nearest_first(sections, options.start, options.join_tolerance),
    };
    let programs = match options.split {
        Split::Whole if sections.is_empty() => Vec::new(),
        Split::Whole => vec![program("drawing".to_owned(), &order(sections), options)],
        Split::Layers => {
            // In the order in which the layers appear.
            let mut layers: Vec<(String, Vec<Section>)> = Vec::new();
            for section in sections {
                match layers.iter_mut().find(|(name, _)| *name == section.layer) {
                    Some((_, sections)) => sections.push(section),
                    None => layers.push((section.layer.clone(), vec![section])),
                }
            }
            layers
                .into_iter()
                .map(|(name, sections)| program(name, &order(sections), options))
                .collect()
        }
        Split::Sections => (1..)
            .zip(order(sections))
            .map(|(number, section)| {
                let name = format!("section {number} ({})", section.layer);
                program(name, &[section], options)
            })
            .collect(),
    };
    Ok(Import { programs, notes, unit, unit_known: known.is_some() })
}

/// Length of the unit of `$INSUNITS`, m (DXF reference); none for "no unit" and what is not known.
fn unit(number: i32) -> Option<f64> {
    Some(match number {
        1 => 0.0254,
        2 => 0.3048,
        3 => 1609.344,
        4 => 1e-3,
        5 => 1e-2,
        6 => 1.0,
        7 => 1e3,
        8 => 25.4e-9,
        9 => 25.4e-6,
        10 => 0.9144,
        11 => 1e-10,
        12 => 1e-9,
        13 => 1e-6,
        14 => 0.1,
        15 => 10.0,
        16 => 100.0,
        // The US survey foot, its twelfth, its yard and its mile.
        21 => 1200.0 / 3937.0,
        22 => 100.0 / 3937.0,
        23 => 3600.0 / 3937.0,
        24 => 6_336_000.0 / 3937.0,
        _ => return None,
    })
}

fn program(name: String, sections: &[Section], options: &ImportOptions) -> Program {
    let mut path = Path { options, at: options.start, elements: Vec::new() };
    let mut after_rapid = false;
    for section in sections {
        if after_rapid && !section.rapid {
            path.section(&arrange::entered_at(section.clone(), path.at, options.join_tolerance));
        } else {
            path.section(section);
        }
        after_rapid = section.rapid;
    }
    if let (Some(heights), Some(last)) = (options.heights, path.elements.last()) {
        let place = last.place;
        path.line(ElementKind::Rapid, Point3::new(path.at.x, path.at.y, heights.safe), place);
    }
    let sections = sections.iter().filter(|section| !section.rapid).count();
    Program { name, elements: path.elements, sections }
}

struct Path<'a> {
    options: &'a ImportOptions,
    at: Point3<f64>,
    elements: Vec<PathElement>,
}

impl Path<'_> {
    fn section(&mut self, section: &Section) {
        let Some(&(_, line)) = section.pieces.first() else { return };
        let place = Place::at(line);
        let start = section.start();
        match self.options.heights {
            None if (start - self.at).norm() <= SNAP => {}
            None => self.line(ElementKind::Rapid, start, place),
            Some(heights) => {
                for point in [self.at, start] {
                    let above = Point3::new(point.x, point.y, heights.safe);
                    self.line(ElementKind::Rapid, above, place);
                }
                self.line(ElementKind::Cut, Point3::new(start.x, start.y, heights.cut), place);
                if let Some(plunge) = self.elements.last_mut()
                    && plunge.kind == ElementKind::Cut
                {
                    plunge.feed = heights.plunge_feed;
                }
            }
        }
        let kind = if section.rapid { ElementKind::Rapid } else { ElementKind::Cut };
        let first = self.at;
        let count = section.pieces.len();
        for (index, (piece, line)) in section.pieces.iter().enumerate() {
            let place = Place::at(*line);
            let piece = match self.options.heights {
                Some(heights) => piece.at_height(heights.cut),
                None => piece.clone(),
            };
            let (mut start, mut end) = (piece.start(), piece.end());
            if (start - self.at).norm() <= SNAP {
                start = self.at;
            } else {
                self.line(kind, start, place);
            }
            if index + 1 == count && (end - first).norm() <= SNAP {
                end = first;
            }
            let near_level =
                matches!(piece, Primitive::Line { .. }) || start.z.to_bits() == end.z.to_bits();
            let snapped = if near_level { piece.between(start, end) } else { piece };
            let shape = snapped.shape();
            // A piece shorter than a nanometre after its ends have moved is dropped.
            if shape.length() > 1e-9 {
                self.at = shape.end();
                self.push(kind, shape, place);
            }
        }
    }

    /// Straight to `end`, unless it is there already.
    fn line(&mut self, kind: ElementKind, end: Point3<f64>, place: Place) {
        let start = std::mem::replace(&mut self.at, end);
        if start != end {
            self.push(kind, Shape::Line { start, end }, place);
        }
    }

    fn push(&mut self, kind: ElementKind, shape: Shape, place: Place) {
        let ImportOptions { feed, acceleration, .. } = *self.options;
        self.elements.push(PathElement {
            feed,
            acceleration,
            deceleration: acceleration,
            ..PathElement::new(place, kind, shape)
        });
    }
}
