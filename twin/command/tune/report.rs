//! What was found, for people and as an object.

use super::cam::Format;
use crate::cam::CamFile;
use crate::cam::check::CamUse;
use crate::cam::edit::Change;
use crate::cam::tune::{Minimised, ShapeGoal, Shaped};
use crate::command::show::table;
use crate::number::{at_most, beside, significant};
use serde_json::{Value, json};
use std::io::{self, Write};
use twin_motion::axis::profile::RampType;
use twin_motion::cam::tune::{DeadTime, Estimate, Fit, RampIn};
use twin_motion::cam::{Curve, MasterMotion, Quantity};

/// Six significant digits.
fn short(value: f64) -> String {
    significant(value, 6)
}

/// Everything that was found.
#[derive(Debug)]
pub(super) struct Report<'a> {
    file: &'a CamFile,
    pub(super) before: CamUse,
    pub(super) after: CamUse,
    /// What a slave that was measured is to do.
    pub(super) wanted: Option<CamUse>,
    /// What the slave of the run did.
    pub(super) did: Option<CamUse>,
    pub(super) samples: usize,
    pub(super) fit: Option<Fit>,
    pub(super) error_before: Option<f64>,
    pub(super) error_after: Option<f64>,
    /// What is left over is no noise: the intervals are too narrow.
    pub(super) doubtful: bool,
    /// The dead time, and how many switchings told it.
    pub(super) dead_time: Option<(DeadTime, usize)>,
    /// Changed to keep the limits.
    pub(super) within: bool,
    /// Changed for the smallest peak.
    pub(super) least: Option<Minimised>,
    pub(super) shaped: Option<Shaped>,
    pub(super) goal: Option<ShapeGoal>,
    pub(super) ramp: Option<(RampType, RampIn)>,
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
            samples: 0,
            fit: None,
            error_before: None,
            error_after: None,
            doubtful: false,
            dead_time: None,
            within: false,
            least: None,
            shaped: None,
            goal: None,
            ramp: None,
            changes: Vec::new(),
            refused: None,
        }
    }

    /// An offset or a scaling, in the order of the inputs; what is rounding beside the cam is 0.
    fn input(&self, index: usize, value: f64) -> String {
        let curve = self.file.cam.curve();
        let scales = [curve.end() - curve.start(), 1.0, self.height(), 1.0];
        beside(value, scales.get(index).copied().unwrap_or_default(), 6)
    }

    /// How far the slave goes on its cam.
    fn height(&self) -> f64 {
        let y = self.file.cam.curve().extremes().position;
        (y.max - y.min) * self.before.coupling.input.slave_scaling
    }

    /// A place of the master.
    fn place(&self, at: f64) -> String {
        let curve = self.file.cam.curve();
        beside(at, (curve.end() - curve.start()) / self.before.coupling.input.master_scaling, 6)
    }

    /// A position of the slave, or how far it is from one.
    fn slave(&self, position: f64) -> String {
        beside(position, self.height(), 6)
    }

    fn estimates(fit: &Fit) -> [(&'static str, Estimate); 4] {
        [
            ("MasterOffset", fit.master_offset),
            ("MasterScaling", fit.master_scaling),
            ("SlaveOffset", fit.slave_offset),
            ("SlaveScaling", fit.slave_scaling),
        ]
    }

    /// The most important of it in one line.
    pub(super) fn headline(&self) -> String {
        let (master, slave) = (self.file.master.unit(), self.file.slave.unit());
        let mut parts = Vec::new();
        if let (Some(before), Some(after)) = (self.error_before, self.error_after) {
            parts.push(format!("error {} → {} {slave} rms", self.slave(before), self.slave(after)));
        }
        if let Some(Minimised { quantity, before, after, .. }) = &self.least {
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
    fn lines(&self) -> (Vec<String>, Vec<String>) {
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
                Change::Point(_) => {}
            }
        }
        (file, block)
    }

    fn points(&self) -> Vec<String> {
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
        if self.within {
            let pairs =
                self.before.coupling.numbers().into_iter().zip(self.after.coupling.numbers());
            let mut changed = false;
            for (index, ((_, name, before), (_, _, after))) in pairs.enumerate() {
                if before.to_bits() != after.to_bits() {
                    let [before, after] = [before, after].map(|value| self.input(index, value));
                    writeln!(out, "{name}: {before} → {after} keeps the limits")?;
                    changed = true;
                }
            }
            if !changed {
                writeln!(out, "the limits are kept as it is")?;
            }
        }
        if let Some(least) = &self.least {
            self.tell_least(out, least)?;
        }
        if let Some(shaped) = &self.shaped {
            self.tell_shape(out, shaped)?;
        }
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
        let points = self.points();
        if file.is_empty() && points.is_empty() {
            return writeln!(out, "nothing is to be changed");
        }
        if !points.is_empty() {
            writeln!(out, "\npoints of elements, master in {master}:")?;
            points.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        }
        if !file.is_empty() {
            writeln!(out, "\n[coupling] of the cam's file:")?;
            file.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
            writeln!(out, "\ninputs of MC_CamIn (DeadTimeCompensation: of SMC_CAMRegister):")?;
            block.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
        }
        if writes { Ok(()) } else { writeln!(out, "\nnothing is written without --write") }
    }

    /// For what the intervals hold where the samples do not show whether it is so.
    fn independent(&self, fit: &Fit) -> String {
        let samples = self.samples;
        let why = if fit.quantum > 0.0 && samples >= Fit::SAMPLES {
            format!("intervals of a slave that moves by fewer than {} of these steps", Fit::STEPS)
        } else {
            format!("intervals of {samples} samples (below {})", Fit::SAMPLES)
        };
        format!(
            "{why} hold for noise that is independent from sample to sample only; so few do not show whether it is"
        )
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
                header.extend(["wanted", "in effect", "proposed"]);
            }
            rows.set_header(header);
            let wanted = self.wanted.as_ref().map(numbers);
            let (before, after) = (numbers(&self.before), numbers(&self.after));
            for (index, (name, Estimate { value, half_width })) in
                Self::estimates(fit).into_iter().enumerate()
            {
                let half = if half_width > 0.0 { short(half_width) } else { "given".to_owned() };
                let mut row = vec![name.to_owned(), self.input(index, value), half];
                if let Some(wanted) = &wanted {
                    let columns = [wanted, &before, &after];
                    let of_input = columns.into_iter().filter_map(|of| of.get(index));
                    row.extend(of_input.map(|value| self.input(index, *value)));
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
            let tense = if self.wanted.is_some() { "would be" } else { "is" };
            let MasterMotion { velocity, acceleration, .. } = self.before.master;
            let master = self.file.master.unit();
            writeln!(
                out,
                "the master goes {} {master}/s at most, its acceleration within ±{} {master}/s²",
                short(velocity),
                short(acceleration)
            )?;
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
            if !fit.shows_correlation {
                writeln!(out, "{}", self.independent(fit))?;
            }
            if fit.bias > BIAS {
                writeln!(
                    out,
                    "what is left over grows with the slope, as noise of the master's positions makes it: so much of it flattens \
                     what is found, by up to {} % of the half widths, which hold it",
                    short((fit.bias * 100.0).round())
                )?;
            }
            if self.doubtful {
                writeln!(
                    out,
                    "what is left over is no noise (correlation {} from sample to sample): the intervals are too narrow, \
                     the slave does something that the cam does not describe",
                    short(fit.correlation)
                )?;
            }
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

    fn tell_shape(&self, out: &mut impl Write, shaped: &Shaped) -> io::Result<()> {
        let (master, slave) = (self.file.master.unit(), self.file.slave.unit());
        let (before, after) = (short(shaped.before), short(shaped.after));
        match self.goal {
            Some(ShapeGoal::Peak(quantity)) => writeln!(
                out,
                "shape: the slave's largest {quantity} falls from {before} to {after} {}",
                of(slave, quantity)
            )?,
            _ => writeln!(
                out,
                "shape: the master may go {} {master}/s, it was {} {master}/s",
                at_most(shaped.after, 6),
                at_most(shaped.before, 6)
            )?,
        }
        if let Some((quantity, at)) = shaped.limited {
            writeln!(
                out,
                "  now limited by the slave's {quantity} at master {} {master}",
                self.place(at)
            )?;
        }
        for (at, reached, limit) in self.beyond(shaped) {
            let edge = if reached > limit { "most" } else { "least" };
            writeln!(
                out,
                "  the slave leaves its old range: it goes to {} {slave} at master {} {master}, it was {} at {edge}",
                self.slave(reached),
                self.place(at),
                self.slave(limit)
            )?;
        }
        writeln!(out, "  {} linear programs", shaped.programs)
    }

    /// The smallest peak, and what holds the values.
    fn tell_least(&self, out: &mut impl Write, least: &Minimised) -> io::Result<()> {
        let Minimised { quantity, from, before, after, held, part } = least;
        let unit = of(self.file.slave.unit(), *quantity);
        let way = if *part { " on the way of the master" } else { "" };
        let [before, after] = [before, after].map(|peak| short(*peak));
        writeln!(out, "the slave's largest {quantity}{way}: {before} → {after} {unit}")?;
        let pairs = from.iter().copied().zip(self.after.coupling.numbers());
        for (index, ((before, (_, name, after)), held)) in pairs.zip(held).enumerate() {
            if before.to_bits() == after.to_bits() && held.is_empty() {
                continue;
            }
            let by = if held.is_empty() {
                String::new()
            } else {
                format!(", held by {}", held.join(" and "))
            };
            let [before, after] = [before, after].map(|value| self.input(index, value));
            writeln!(out, "  {name}: {before} → {after}{by}")?;
        }
        Ok(())
    }

    /// Where a shape takes the slave beyond the positions it had: master, position, and what it was at most or at least.
    fn beyond(&self, shaped: &Shaped) -> Vec<(f64, f64, f64)> {
        let Ok(curve) = Curve::polynomial(&shaped.knots) else { return Vec::new() };
        let using = &self.after;
        let ends = |curve: &Curve| {
            let y = curve.extremes().position;
            let ends = [(y.min, y.at_min), (y.max, y.at_max)]
                .map(|(y, at)| (using.slave_at(y), using.master_at(at)));
            if using.coupling.input.slave_scaling < 0.0 { [ends[1], ends[0]] } else { ends }
        };
        let [old, new] = [ends(self.file.cam.curve()), ends(&curve)];
        let room = 1e-9 * (old[1].0 - old[0].0).abs();
        let beyond = [new[0].0 < old[0].0 - room, new[1].0 > old[1].0 + room];
        let all = old.into_iter().zip(new).zip(beyond).filter(|(_, beyond)| *beyond);
        all.map(|(((limit, _), (reached, at)), _)| (at, reached, limit)).collect()
    }

    fn json(&self) -> Value {
        let estimate = |Estimate { value, half_width }: Estimate| json!({ "value": value, "half_width_95": half_width });
        let fit = self.fit.as_ref().map(|fit| {
            let named = Self::estimates(fit).map(|(name, found)| (name.to_owned(), estimate(found)));
            json!({
                "estimates": named.into_iter().collect::<serde_json::Map<_, _>>(),
                "samples": self.samples, "rms_before": self.error_before, "rms_after": self.error_after,
                "correlation": fit.correlation, "noise": !self.doubtful,
                "quantum": fit.quantum, "bias": fit.bias, "shows_correlation": fit.shows_correlation,
            })
        });
        let dead_time = self.dead_time.as_ref().map(|(found, count)| {
            json!({ "dead_time_s": estimate(found.dead_time_s), "switchings": count })
        });
        let shape = self.shaped.as_ref().map(|shaped| {
            let what = match self.goal {
                Some(ShapeGoal::Peak(quantity)) => format!("peak {quantity}"),
                _ => "master velocity".to_owned(),
            };
            json!({
                "of": what, "before": shaped.before, "after": shaped.after,
                "limited_by": shaped.limited.map(|(quantity, _)| quantity.to_string()),
                "at_master": shaped.limited.map(|(_, at)| at),
                "beyond": self.beyond(shaped).into_iter().map(|(at, reached, limit)| {
                    json!({ "master": at, "slave": reached, "was": limit })
                }).collect::<Vec<_>>(),
                "points": shaped.knots.iter().map(|knot| {
                    json!({ "master": knot.master, "slave": knot.slave, "velocity": knot.velocity, "acceleration": knot.acceleration })
                }).collect::<Vec<_>>(),
            })
        });
        let ramp = self.ramp.as_ref().map(|(kind, ramp)| {
            let (kind, jerk) = match kind {
                RampType::Trapezoid => ("trapezoid", None),
                RampType::Sigmoid => ("sigmoid", Some(ramp.ramp_jerk)),
                RampType::Parabolic => ("parabolic", Some(ramp.ramp_jerk)),
            };
            json!({
                "velocity_difference": ramp.velocity_difference, "acceleration": ramp.acceleration,
                "deceleration": ramp.deceleration, "duration_s": ramp.duration_s,
                "peak_velocity": ramp.peak_velocity, "peak_acceleration": ramp.peak_acceleration,
                "peak_jerk": ramp.peak_jerk, "peak_cam_jerk": ramp.peak_cam_jerk, "ramp": kind, "axis_jerk": jerk, "position_min": ramp.positions[0], "position_max": ramp.positions[1],
            })
        });
        let least = self.least.as_ref().map(|least| {
            let names = self.after.coupling.numbers();
            let held = names.iter().zip(&least.held).map(|((_, name, _), held)| ((*name).to_owned(), json!(held)));
            json!({
                "of": format!("peak {}", least.quantity), "from": least.from, "before": least.before, "after": least.after,
                "held": held.collect::<serde_json::Map<_, _>>(),
            })
        });
        let (file, block) = self.lines();
        let numbers =
            self.after.coupling.numbers().map(|(key, _, value)| (key.to_owned(), json!(value)));
        json!({
            "cam": self.file.cam.name(),
            "file": self.file.path.display().to_string(),
            "master": { "velocity": self.before.master.velocity, "acceleration": self.before.master.acceleration },
            "slave": fit.as_ref().map(|_| if self.wanted.is_some() { "measured" } else { "wanted" }),
            "fit": fit, "least": least, "dead_time": dead_time, "shape": shape, "ramp": ramp,
            "coupling": numbers.into_iter().collect::<serde_json::Map<_, _>>(),
            "lines": { "coupling": file, "inputs": block, "points": self.points() },
            "refused": self.refused,
        })
    }
}

/// A bias that is a larger part of a half width is told.
const BIAS: f64 = 0.2;

/// The unit of a quantity of the slave.
fn of(unit: &str, quantity: Quantity) -> String {
    match quantity {
        Quantity::Velocity => format!("{unit}/s"),
        Quantity::Acceleration => format!("{unit}/s²"),
        Quantity::Jerk => format!("{unit}/s³"),
    }
}
