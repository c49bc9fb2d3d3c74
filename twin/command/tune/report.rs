//! Tuning report: collects the results and words them for people.

use super::start::Started;
use super::words::Format;
use crate::cam::check::CamUse;
use crate::cam::edit::Change;
use crate::cam::tune;
use crate::cam::tune::{Begin, Constrained, Kept, ShapeGoal, Shaped};
use crate::command::show::table;
use std::io::{self, Write};
use twin_cam::tune::{DeadTime, Estimate, Fit, RampIn, RampWish};
use twin_cam::{MasterMotion, Quantity};
use twin_machine::cam_file::CamFile;
use twin_number::{beside, significant};
use twin_profile::RampType;

/// Six significant digits.
pub(super) fn short(value: f64) -> String {
    significant(value, 6)
}

/// Everything that was found.
#[derive(Debug)]
pub(super) struct Report<'a> {
    pub(super) file: &'a CamFile,
    pub(super) before: CamUse,
    pub(super) after: CamUse,
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
    pub(super) error_before: Option<f64>,
    pub(super) error_after: Option<f64>,
    /// The dead time, and how many switchings told it.
    pub(super) dead_time: Option<(DeadTime, usize)>,
    /// Why outputs do not tell it.
    pub(super) no_dead_time: Option<String>,
    /// After what the positions of master and slave of the run begin again, where they do.
    pub(super) wound: [Option<f64>; 2],
    /// What the limits left of what the run tells.
    pub(super) limited: Option<Constrained>,
    /// Changed to keep the limits, and what holds each value.
    pub(super) within: Option<Constrained>,
    /// Changed for the smallest peak.
    pub(super) least: Option<Constrained>,
    pub(super) shaped: Option<Shaped>,
    pub(super) goal: Option<ShapeGoal>,
    pub(super) ramp: Option<(RampType, RampIn)>,
    /// The start that it is for.
    pub(super) start: Option<Box<RampWish>>,
    /// Where a run begins that it begins with.
    pub(super) begin: Option<Begin>,
    /// How it is known where the master starts.
    pub(super) started: Option<Started>,
    /// `MasterOffset` and `SlaveOffset` that do not start, in place of which the same motion is told.
    pub(super) folded: Option<[f64; 2]>,
    pub(super) changes: Vec<Change>,
    /// Why not everything was found.
    pub(super) refused: Option<String>,
}

impl<'a> Report<'a> {
    pub(super) fn new(file: &'a CamFile, before: CamUse) -> Self {
        Self {
            file,
            before,
            after: before,
            wanted: None,
            did: None,
            proposed: None,
            kept: None,
            samples: 0,
            fit: None,
            error_before: None,
            error_after: None,
            dead_time: None,
            no_dead_time: None,
            wound: [None; 2],
            limited: None,
            within: None,
            least: None,
            shaped: None,
            goal: None,
            ramp: None,
            start: None,
            begin: None,
            started: None,
            folded: None,
            changes: Vec::new(),
            refused: None,
        }
    }

    /// An offset or a scaling, in the order of the inputs; what is rounding beside the cam is 0.
    pub(super) fn input(&self, index: usize, value: f64) -> String {
        let curve = self.file.cam.curve();
        let scales = [curve.end() - curve.start(), 1.0, self.height(), 1.0];
        beside(value, scales.get(index).copied().unwrap_or_default(), 6)
    }

    /// How far the slave goes on its cam.
    pub(super) fn height(&self) -> f64 {
        let y = self.file.cam.curve().extremes().position;
        (y.max - y.min) * self.before.coupling.input.slave_scaling
    }

    /// A place of the master.
    pub(super) fn place(&self, at: f64) -> String {
        let curve = self.file.cam.curve();
        beside(at, (curve.end() - curve.start()) / self.before.coupling.input.master_scaling, 6)
    }

    /// A position of the slave, or how far it is from one.
    pub(super) fn slave(&self, position: f64) -> String {
        beside(position, self.height(), 6)
    }

    /// The most important of it in one line.
    pub(super) fn headline(&self) -> String {
        let (master, slave) = (self.file.master.unit(), self.file.slave.unit());
        let mut parts = Vec::new();
        if let (Some(before), Some(after)) = (self.error_before, self.error_after) {
            parts.push(format!("error {} → {} {slave} rms", self.slave(before), self.slave(after)));
        }
        if let Some(Constrained { quantity: Some(quantity), before, after, .. }) = &self.least {
            let [before, after] = [before, after].map(|peak| short(*peak));
            parts.push(format!("largest {quantity} {before} → {after} {}", of(slave, *quantity)));
        }
        if let Some(shaped) = &self.shaped {
            parts.push(match self.goal {
                Some(ShapeGoal::Peak(quantity)) => format!(
                    "largest {quantity} {} → {} {}",
                    short(shaped.before),
                    short(shaped.after),
                    of(slave, quantity)
                ),
                _ => format!(
                    "largest velocity of the master {} → {} {master}/s",
                    short(shaped.before),
                    short(shaped.after)
                ),
            });
        }
        if let Some((_, ramp)) = &self.ramp {
            parts.push(format!("on the cam after {} s", short(ramp.duration_s)));
        }
        if parts.is_empty() { "within the limits".to_owned() } else { parts.join("; ") }
    }

    /// The lines that apply it: of the TOML file, and the inputs of the blocks.
    pub(super) fn lines(&self) -> (Vec<String>, Vec<String>) {
        let inputs = self.after.coupling.numbers();
        let (mut file, mut block) = (Vec::new(), Vec::new());
        for change in &self.changes {
            match change {
                Change::Coupling(key, value) => {
                    file.push(format!("{key} = {value}"));
                    let input = inputs.iter().find(|(other, ..)| other == key);
                    // What is wanted is no input.
                    block.extend(input.map(|(_, name, _)| format!("{name} := {value}")));
                }
                Change::CouplingWord(key, word) => {
                    file.push(format!("{key} = \"{word}\""));
                    block.push(format!("StartMode := {word}"));
                }
                Change::Point(_) | Change::Tappet { .. } => {}
            }
        }
        (file, block)
    }

    pub(super) fn points(&self) -> Vec<String> {
        let point = |change: &Change| {
            let Change::Point(knot) = change else { return None };
            Some(format!(
                "{{ master = {}, slave = {}, velocity = {}, acceleration = {} }},",
                knot.master, knot.slave, knot.velocity, knot.acceleration
            ))
        };
        self.changes.iter().filter_map(point).collect()
    }

    /// Tells it; `writes` if it is written into a file, too.
    pub(super) fn write(
        &self,
        format: Format,
        writes: bool,
        out: &mut impl Write,
    ) -> io::Result<()> {
        match format {
            Format::Json => writeln!(out, "{}", self.json()),
            Format::Human => self.tell(writes, out),
        }
    }

    fn tell(&self, writes: bool, out: &mut impl Write) -> io::Result<()> {
        let (master, slave) = (self.file.master.unit(), self.file.slave.unit());
        writeln!(out, "{}: {}", self.file.path.display(), self.file.cam.name())?;
        self.tell_run(out)?;
        if let Some(limited) = &self.limited {
            self.tell_limited(out, limited)?;
        }
        for found in [&self.within, &self.least].into_iter().flatten() {
            self.tell_constrained(out, found)?;
        }
        if self.refused.is_none() {
            self.tell_start(out)?;
            self.tell_tappets(out)?;
        }
        if let Some(shaped) = &self.shaped {
            self.tell_shape(out, shaped)?;
        }
        self.tell_begin(out)?;
        if let Some((kind, ramp)) = &self.ramp {
            let jerk = match kind {
                RampType::Trapezoid => "as its acceleration steps within a millisecond, ",
                _ => "with the cam's own jerk, ",
            };
            writeln!(
                out,
                "ramp: on the cam after {} s; the slave reaches {} {slave}/s, {} {slave}/s² and, {jerk}{} {slave}/s³ (the cam \
                 alone {}), and goes from {} to {} {slave}",
                short(ramp.duration_s),
                short(ramp.peak_velocity),
                short(ramp.peak_acceleration),
                short(ramp.peak_jerk),
                short(ramp.peak_cam_jerk),
                self.slave(ramp.positions[0]),
                self.slave(ramp.positions[1]),
            )?;
            let less = ramp.ramp_jerk < self.before.limits.motion.jerk * (1.0 - 1e-6);
            if *kind != RampType::Trapezoid && less {
                writeln!(
                    out,
                    "  with a jerk of {} {slave}/s³ of the slave's axis: `max_jerk_…` of the machine file, MC_CamIn has no input for it",
                    short(ramp.ramp_jerk)
                )?;
            }
        }
        if self.refused.is_some() {
            return Ok(());
        }
        let (file, block) = self.lines();
        let (points, tappets) = (self.points(), self.moved_tappets());
        if file.is_empty() && points.is_empty() && tappets.is_empty() {
            return writeln!(out, "nothing is to be changed");
        }
        if !points.is_empty() {
            writeln!(out, "\npoints of elements, master in {master}:")?;
            points.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        }
        if !tappets.is_empty() {
            writeln!(out, "\ntappets of the cam's file, master in {master}:")?;
            tappets.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        }
        if !file.is_empty() {
            writeln!(out, "\n[coupling] of the cam's file:")?;
            file.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
            writeln!(out, "\ninputs of MC_CamIn (DeadTimeCompensation: of SMC_CAMRegister):")?;
            block.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        }
        if writes { Ok(()) } else { writeln!(out, "\nnothing is written without --write") }
    }

    /// How the run was recorded: within periods of its axes, and whether its time can be right.
    fn tell_recorded(&self, out: &mut impl Write) -> io::Result<()> {
        let units = [self.file.master.unit(), self.file.slave.unit()];
        for ((name, period), unit) in ["master", "slave"].into_iter().zip(self.wound).zip(units) {
            let Some(period) = period else { continue };
            writeln!(
                out,
                "the {name} is recorded within its period of {} {unit}, and is taken to go on where that begins again",
                short(period)
            )?;
        }
        if let Some(passes) = tune::passes_too_often(self.file, &self.before) {
            writeln!(
                out,
                "that is {} passes of the cam a second: is the time of the run in the unit that its column says?",
                short(passes)
            )?;
        }
        Ok(())
    }

    /// What the run tells.
    fn tell_run(&self, out: &mut impl Write) -> io::Result<()> {
        let slave = self.file.slave.unit();
        if let Some(fit) = &self.fit {
            let mut rows = table();
            let numbers = |using: &CamUse| {
                let [one, two, three, four, ..] = using.coupling.numbers();
                [one, two, three, four].map(|(.., value)| value)
            };
            let found = if self.wanted.is_some() { "the slave was at" } else { "found in the run" };
            let mut header = vec![found, "value", "± (95 %)"];
            if self.wanted.is_some() {
                header.extend(["wanted", "in effect", "proposed", "± (95 %)"]);
            }
            rows.set_header(header);
            let wanted = self.wanted.as_ref().map(numbers);
            let (before, after) = (numbers(&self.before), numbers(&self.after));
            let names = self.before.coupling.numbers().map(|(_, name, _)| name);
            for (index, (Estimate { value, half_width }, name)) in
                fit.estimates.into_iter().zip(names).enumerate()
            {
                let half = if half_width > 0.0 { short(half_width) } else { "given".to_owned() };
                let mut row = vec![name.to_owned(), self.input(index, value), half];
                if let Some(wanted) = &wanted {
                    let columns = [wanted, &before, &after];
                    let of_input = columns.into_iter().filter_map(|of| of.get(index));
                    row.extend(of_input.map(|value| self.input(index, *value)));
                    row.push(self.proposed_within(index).map(short).unwrap_or_default());
                }
                rows.add_row(row);
            }
            writeln!(out, "{rows}")?;
            if self.wanted.is_some() {
                writeln!(
                    out,
                    "the slave is taken as measured, with what is in effect above; what is proposed undoes how it deviates from \
                     what is wanted (--slave wanted: the run is the motion wanted)"
                )?;
            }
            let reference = self.wanted.as_ref().unwrap_or(&self.before);
            if fit.estimates[3].value * reference.coupling.input.slave_scaling < 0.0 {
                let what = if self.wanted.is_some() { "wanted" } else { "in effect" };
                writeln!(
                    out,
                    "the slave is mirrored: SlaveScaling has the other sign than what is {what}"
                )?;
            }
            let tense = if self.wanted.is_some() { "would be" } else { "is" };
            let MasterMotion { velocity, acceleration, .. } = self.before.master;
            let master = self.file.master.unit();
            writeln!(
                out,
                "the master goes {} {master}/s at most, its acceleration within ±{} {master}/s²",
                short(velocity),
                short(acceleration)
            )?;
            self.tell_recorded(out)?;
            writeln!(
                out,
                "{} samples; the slave's error was {} {slave} rms and {tense} {} {slave}",
                self.samples,
                self.slave(self.error_before.unwrap_or_default()),
                self.slave(self.error_after.unwrap_or_default()),
            )?;
            if fit.quantum > 0.0 {
                writeln!(
                    out,
                    "the slave's positions are rounded to {} {slave}; the intervals hold that",
                    short(fit.quantum)
                )?;
            }
            if self.samples < Fit::SAMPLES {
                writeln!(
                    out,
                    "intervals of {} samples (below {}) hold for noise that is independent from sample to sample only; so few \
                     do not show whether it is",
                    self.samples,
                    Fit::SAMPLES
                )?;
            }
        }
        if let Some(why) = &self.no_dead_time {
            writeln!(out, "{why}; it is left as it is")?;
        }
        if let Some((found, count)) = &self.dead_time {
            let Estimate { value, half_width } = found.dead_time_s;
            writeln!(
                out,
                "dead time of the tappets: {} ± {} ms (95 %), of {count} switchings, if the run was recorded with \
                 DeadTimeCompensation {} ms in effect",
                short(value * 1e3),
                short(half_width * 1e3),
                short(self.before.coupling.dead_time_s * 1e3)
            )?;
        }
        Ok(())
    }
}

/// The unit of a quantity of the slave.
pub(super) fn of(unit: &str, quantity: Quantity) -> String {
    match quantity {
        Quantity::Velocity => format!("{unit}/s"),
        Quantity::Acceleration => format!("{unit}/s²"),
        Quantity::Jerk => format!("{unit}/s³"),
    }
}
