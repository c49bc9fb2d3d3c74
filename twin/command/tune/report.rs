//! Tuning report: what was found, as text and as one JSON object.
//!
//! Each part gives its JSON value and its lines of text together ([`Section`]).

use crate::cam::check::CamUse;
use crate::cam::edit::Change;
use crate::cam::tune::{Constrained, Kept};
use crate::command::cam::Format;
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use std::ops::{Deref, DerefMut};
use twin_cam::Quantity;
use twin_cam::tune::{Estimate, Fit, RampIn, RampWish};
use twin_machine::cam_file::CamFile;
use twin_number::{beside, significant};
use twin_profile::RampType;

/// Six significant digits.
pub(super) fn short(value: f64) -> String {
    significant(value, 6)
}

/// A part of the report: a field of the JSON object, and lines for people.
#[derive(Debug)]
pub(super) struct Section {
    pub(super) key: &'static str,
    pub(super) value: Value,
    pub(super) text: Vec<String>,
}

impl Section {
    pub(super) const fn empty(key: &'static str) -> Self {
        Self { key, value: Value::Null, text: Vec::new() }
    }
}

/// Everything that was found.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// What a slave that was measured is to do.
    pub(super) wanted: Option<CamUse>,
    /// What the slave of the run did.
    pub(super) did: Option<CamUse>,
    /// What undoes the deviation of a slave that was measured, with the half widths.
    pub(super) proposed: Option<[Estimate; 4]>,
    /// Tappets that were moved along with it.
    pub(super) kept: Option<Box<Kept>>,
    pub(super) samples: usize,
    pub(super) fit: Option<Fit>,
    /// The slave's error, root mean square, u.
    pub(super) error_before: Option<f64>,
    pub(super) error_after: Option<f64>,
    /// The dead time, and the number of switchings.
    pub(super) dead_time: Option<(Estimate, usize)>,
    /// Why outputs do not determine it.
    pub(super) no_dead_time: Option<String>,
    /// Periods of master and slave of the run, where positions begin again.
    pub(super) wound: [Option<f64>; 2],
    /// What the limits leave of what the run determines.
    pub(super) limited: Option<Constrained>,
    /// Changed to keep the limits.
    pub(super) within: Option<Constrained>,
    /// Changed for the smallest peak.
    pub(super) least: Option<Constrained>,
    pub(super) ramp: Option<(RampType, RampIn)>,
    /// The start that it is for.
    pub(super) start: Option<Box<RampWish>>,
    /// `MasterOffset` and `SlaveOffset` that do not start, which others with the same motion replace.
    pub(super) folded: Option<[f64; 2]>,
    pub(super) changes: Vec<Change>,
    /// Why not everything was found.
    pub(super) refused: Option<String>,
}

/// A cam, its use before and after, and what was found.
#[derive(Debug)]
pub(super) struct Report<'a> {
    pub(super) file: &'a CamFile,
    pub(super) before: CamUse,
    pub(super) after: CamUse,
    found: Found,
}

impl Deref for Report<'_> {
    type Target = Found;

    fn deref(&self) -> &Found {
        &self.found
    }
}

impl DerefMut for Report<'_> {
    fn deref_mut(&mut self) -> &mut Found {
        &mut self.found
    }
}

impl<'a> Report<'a> {
    pub(super) fn new(file: &'a CamFile, before: CamUse) -> Self {
        Self { file, before, after: before, found: Found::default() }
    }

    /// Units of master and slave.
    pub(super) fn units(&self) -> [&str; 2] {
        [self.file.master.unit(), self.file.slave.unit()]
    }

    /// The unit of a quantity of the slave.
    pub(super) fn of(&self, quantity: Quantity) -> String {
        let per = match quantity {
            Quantity::Velocity => "/s",
            Quantity::Acceleration => "/s²",
            Quantity::Jerk => "/s³",
        };
        format!("{}{per}", self.file.slave.unit())
    }

    /// How far the master goes on the cam.
    fn width(&self) -> f64 {
        let curve = self.file.cam.curve();
        curve.end() - curve.start()
    }

    /// How far the slave goes on its cam.
    pub(super) fn height(&self) -> f64 {
        let y = self.file.cam.curve().extremes().position;
        (y.max - y.min) * self.before.coupling.input.slave_scaling
    }

    /// An offset or a scaling, in the order of the inputs; rounding is 0.
    pub(super) fn input(&self, index: usize, value: f64) -> String {
        beside(value, [self.width(), 1.0, self.height(), 1.0][index], 6)
    }

    /// A place of the master.
    pub(super) fn place(&self, at: f64) -> String {
        beside(at, self.width() / self.before.coupling.input.master_scaling, 6)
    }

    /// A position of the slave, or how far it is from one.
    pub(super) fn slave(&self, position: f64) -> String {
        beside(position, self.height(), 6)
    }

    /// `largest jerk 3 → 2 mm/s³`.
    pub(super) fn peak(&self, quantity: Quantity, before: f64, after: f64) -> String {
        format!("largest {quantity} {} → {} {}", short(before), short(after), self.of(quantity))
    }

    /// The most important of it in one line.
    pub(super) fn headline(&self) -> String {
        let [_, slave] = self.units();
        let mut parts = Vec::new();
        if let (Some(before), Some(after)) = (self.error_before, self.error_after) {
            parts.push(format!("error {} → {} {slave} rms", self.slave(before), self.slave(after)));
        }
        if let Some(Constrained { quantity: Some(quantity), before, after, .. }) = &self.least {
            parts.push(self.peak(*quantity, *before, *after));
        }
        if let Some((_, ramp)) = &self.ramp {
            parts.push(format!("on the cam after {} s", short(ramp.duration_s)));
        }
        if parts.is_empty() { "within the limits".to_owned() } else { parts.join("; ") }
    }

    /// Writes it; `writes` if what was found is written into a file, too.
    pub(super) fn write(
        &self,
        format: Format,
        writes: bool,
        out: &mut impl Write,
    ) -> io::Result<()> {
        let sections = [
            self.fit(),
            self.dead_time(),
            self.limited(),
            self.constrained("within", self.within.as_ref()),
            self.constrained("least", self.least.as_ref()),
            self.start(),
            self.tappets(),
            self.ramp(),
            self.lines(writes),
        ];
        match format {
            Format::Human => {
                writeln!(out, "{}: {}", self.file.path.display(), self.file.cam.name())?;
                let mut lines = sections.iter().flat_map(|section| &section.text);
                lines.try_for_each(|line| writeln!(out, "{line}"))
            }
            Format::Json => {
                let [master_period, slave_period] = self.wound;
                let coupling = self.after.coupling.numbers();
                let coupling = coupling.map(|(key, _, value)| (key.to_owned(), json!(value)));
                let run = self.fit.as_ref();
                let mut all = json!({
                    "cam": self.file.cam.name(),
                    "file": self.file.path.display().to_string(),
                    "master": {
                        "velocity": self.before.master.velocity,
                        "acceleration": self.before.master.acceleration, "period": master_period,
                    },
                    "slave_period": slave_period,
                    "slave": run.map(|_| if self.wanted.is_some() { "measured" } else { "wanted" }),
                    "no_dead_time": self.no_dead_time,
                    "coupling": coupling.into_iter().collect::<Map<_, _>>(),
                    "refused": self.refused,
                });
                for section in sections {
                    all[section.key] = section.value;
                }
                writeln!(out, "{all}")
            }
        }
    }

    /// The lines that apply it: of the TOML file, and the inputs of the blocks.
    fn lines(&self, writes: bool) -> Section {
        let inputs = self.after.coupling.numbers();
        let [mut tappets, mut file, mut block] = [const { Vec::<String>::new() }; 3];
        for change in &self.changes {
            match change {
                Change::Coupling(key, value) => {
                    file.push(format!("{key} = {value}"));
                    // `wanted_…` is not an input.
                    let input = inputs.iter().find(|(other, ..)| other == key);
                    block.extend(input.map(|(_, name, _)| format!("{name} := {value}")));
                }
                Change::CouplingWord(key, word) => {
                    file.push(format!("{key} = \"{word}\""));
                    block.push(format!("StartMode := {word}"));
                }
                Change::Tappet { tappet, .. } => {
                    tappets.push(format!("{{ {} }},", twin_machine::cam_file::tappet_line(tappet)));
                }
            }
        }
        let value = json!({ "tappets": tappets, "coupling": file, "inputs": block });
        let mut text = Vec::new();
        let [master, _] = self.units();
        for (heading, lines) in [
            (format!("tappets of the cam's file, master in {master}"), tappets),
            ("[coupling] of the cam's file".to_owned(), file),
            ("inputs of MC_CamIn (DeadTimeCompensation: of SMC_CAMRegister)".to_owned(), block),
        ] {
            if !lines.is_empty() {
                text.push(format!("\n{heading}:"));
                text.extend(lines.into_iter().map(|line| format!("  {line}")));
            }
        }
        if text.is_empty() {
            text.push("nothing is to be changed".to_owned());
        } else if !writes {
            text.push("\nnothing is written without --write".to_owned());
        }
        if self.refused.is_some() {
            text.clear();
        }
        Section { key: "lines", value, text }
    }
}
