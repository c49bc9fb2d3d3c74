//! Import of drawings (DXF) as programs.

use super::numbers::within;
use crate::command::Failure;
use crate::command::options::unreadable;
use crate::program::settings::ReadSettings;
use crate::program::{Dialect, ProgramFile};
use nalgebra::Point3;
use std::path::Path;
use twin_machine::ProgramConditions;
use twin_machine::text;
use twin_path::dxf;
use twin_path::dxf::{DxfReadError, Heights, ImportOptions, Order, Split};

/// Programs, each with its name.
type Programs = Vec<(String, ProgramFile)>;

/// How a drawing becomes programs.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Drawings (DXF)")]
pub(super) struct DrawingOptions {
    /// What becomes one program
    #[arg(long, value_enum, value_name = "WHAT")]
    one_per: Option<Part>,

    /// The order of the connected sections of a program
    #[arg(long, value_enum)]
    order: Option<SectionOrder>,

    /// Ends that are at most this far apart are joined [default: 0.01]
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = |text: &str| within(text, 0.0..=1e3))]
    join: Option<f64>,

    /// Splines that cannot be kept become lines that are this near [default: 0.01]
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = |text: &str| within(text, 1e-4..=1e3))]
    chord: Option<f64>,

    /// Length of the drawing's unit, if the drawing does not say [default: 1]
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = |text: &str| within(text, 1e-6..=1e7))]
    drawing_unit: Option<f64>,

    /// Feed of cuts and rapids [default: 100]
    #[arg(long, value_name = "MM/S", allow_hyphen_values = true, value_parser = |text: &str| within(text, 1e-3..=1e6))]
    feed: Option<f64>,

    /// Acceleration and deceleration [default: 1000]
    #[arg(long, value_name = "MM/S2", allow_hyphen_values = true, value_parser = |text: &str| within(text, 1e-3..=1e8))]
    acceleration: Option<f64>,

    /// Height at which rapids travel, Z; without it heights are those of the drawing
    #[arg(long, value_name = "MM", requires = "cut_height", allow_hyphen_values = true, value_parser = |text: &str| within(text, -1e5..=1e5))]
    safe_height: Option<f64>,

    /// Height at which the tool cuts, Z
    #[arg(long, value_name = "MM", requires = "safe_height", allow_hyphen_values = true, value_parser = |text: &str| within(text, -1e5..=1e5))]
    cut_height: Option<f64>,

    /// Feed downwards [default: a quarter of the feed]
    #[arg(long, value_name = "MM/S", requires = "safe_height", value_parser = |text: &str| within(text, 1e-3..=1e6))]
    plunge_feed: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// All of it
    Drawing,
    /// Each layer
    Layer,
    /// Each connected section
    Section,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum SectionOrder {
    /// As they are in the drawing
    Drawing,
    /// Each the nearest to the end of the one before
    Nearest,
}

impl DrawingOptions {
    /// True if the drawing may become several programs.
    pub(super) fn is_divided(&self) -> bool {
        matches!(self.one_per, Some(Part::Layer | Part::Section))
    }

    /// Refuses these options for files that are not drawings.
    pub(super) fn check_unused(&self) -> Result<(), Failure> {
        let numbers = [
            self.join,
            self.chord,
            self.drawing_unit,
            self.feed,
            self.acceleration,
            self.safe_height,
            self.plunge_feed,
        ];
        let unused = self.one_per.is_none()
            && self.order.is_none()
            && numbers.into_iter().all(|number| number.is_none());
        if unused {
            return Ok(());
        }
        let message =
            "this is not a drawing; the options under \"Drawings (DXF)\" are for .dxf files";
        Err(Failure::Usage(message.to_owned()))
    }

    /// The programs in the drawing at `path`, and notes about them.
    pub(super) fn import(
        &self,
        path: &Path,
        conditions: &ProgramConditions,
        settings: &ReadSettings,
    ) -> Result<(Programs, Vec<String>), Failure> {
        if let Some((safe, cut)) = self.safe_height.zip(self.cut_height)
            && safe <= cut
        {
            return Err(Failure::Usage(format!(
                "--safe-height {safe} must be above --cut-height {cut}"
            )));
        }
        let drawing = text::lines_of(path).map_err(|source| unreadable(path, source))?;
        let import = dxf::import(drawing, &self.options(conditions));
        let import = import.map_err(|error| match error {
            DxfReadError::Io(source) => unreadable(path, source),
            error => Failure::Usage(format!("{}: {error}", path.display())),
        })?;
        let mut notes: Vec<_> = import.notes.iter().map(ToString::to_string).collect();
        if !import.unit_known && self.drawing_unit.is_none() {
            notes.push(
                "the drawing does not name its unit; it is taken for mm (--drawing-unit)"
                    .to_owned(),
            );
        }
        let whole = !self.is_divided();
        let programs = import.programs.into_iter().map(|program| {
            let name = if whole { name(path) } else { program.name };
            (name, ProgramFile::of_drawing(path, program.elements, settings.clone()))
        });
        Ok((programs.collect(), notes))
    }

    fn options(&self, conditions: &ProgramConditions) -> ImportOptions {
        let metres = |value: Option<f64>, otherwise: f64| value.unwrap_or(otherwise) * 1e-3;
        let feed = metres(self.feed, 100.0);
        let heights = self.safe_height.zip(self.cut_height).map(|(safe, cut)| Heights {
            safe: safe * 1e-3,
            cut: cut * 1e-3,
            plunge_feed: self.plunge_feed.map_or(feed / 4.0, |feed| feed * 1e-3),
        });
        ImportOptions {
            split: match self.one_per {
                None | Some(Part::Drawing) => Split::Whole,
                Some(Part::Layer) => Split::Layers,
                Some(Part::Section) => Split::Sections,
            },
            order: match self.order {
                None | Some(SectionOrder::Drawing) => Order::Drawing,
                Some(SectionOrder::Nearest) => Order::Nearest,
            },
            join_tolerance: metres(self.join, 0.01),
            chord_tolerance: metres(self.chord, 0.01),
            start: Point3::from(conditions.start),
            heights,
            feed,
            acceleration: metres(self.acceleration, 1000.0),
            default_unit: metres(self.drawing_unit, 1.0),
            ..ImportOptions::default()
        }
    }
}

/// Whether `path` is a drawing, by its ending.
pub(super) fn is_drawing(path: &Path, dialect: Option<Dialect>) -> Result<bool, Failure> {
    if dialect.is_some() {
        return Ok(false);
    }
    let guessed = Dialect::guess(path).map_err(|source| unreadable(path, source))?;
    Ok(guessed == Some(Dialect::Dxf))
}

/// The name of a file, without folder and ending.
pub(super) fn name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
