//! `[[gears]]` and `[[cams]]`: axis couplings that hold from the start of every program (`MC_GearIn`, `MC_CamIn`,
//! manual 5.4).

use super::axis::Axis;
use crate::axis_kind::AxisKind;
use crate::cam_file::{CamFile, CamFileError, CamRemark, START_MODES, no_scaling, unit_fits};
use crate::coupling_cycle;
use crate::section::{Elsewhere, MachineFileError, Section};
use crate::tappets::MOST_SIGNALS;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use twin_cam::{CamInput, CamTable, Interpolation};

/// Farthest offset and largest factor of a coupling.
const FAR: f64 = 1e9;

/// An axis that follows another one.
#[derive(Clone, Debug)]
pub struct Coupling {
    /// The slave, by its place in the machine file.
    pub axis: usize,
    /// The master.
    pub master: usize,
    /// Gear or cam.
    pub by: CoupledBy,
}

/// Coupling of two axes; values in mm or degrees.
#[derive(Clone, Debug)]
pub enum CoupledBy {
    /// A gear: way of the slave per way of the master, numerator and denominator. Positions count from where both start.
    Gear(i32, u32),
    /// A cam.
    Cam(Box<CamSelection>),
}

/// A cam with the inputs of `MC_CamTableSelect` and `MC_CamIn`.
#[derive(Clone, Debug)]
pub struct CamSelection {
    /// Output of `MC_CamTableSelect`.
    pub table: CamTable,
    /// Inputs of `MC_CamIn`.
    pub input: CamInput,
    /// Remarks about the cam's elements, each with file and line.
    pub remarks: Vec<CamRemark>,
    /// Gain of the slave per period, in its unit, of a cam that is periodic because nothing else is said.
    pub gain_unsaid: Option<f64>,
}

impl Coupling {
    /// Kind of the coupling, in a word.
    pub fn name(&self) -> &'static str {
        match self.by {
            CoupledBy::Gear(..) => "gear",
            CoupledBy::Cam(_) => "cam",
        }
    }

    /// Remarks about the elements of its cam, each with file and line.
    pub fn remarks(&self) -> &[CamRemark] {
        match &self.by {
            CoupledBy::Gear(..) => &[],
            CoupledBy::Cam(selection) => &selection.remarks,
        }
    }

    /// Description for people.
    pub fn describe(&self, axes: &[Axis]) -> String {
        let name = |index: usize| axes.get(index).map_or("", |axis| axis.name.as_str());
        let (slave, master) = (name(self.axis), name(self.master));
        match &self.by {
            CoupledBy::Gear(numerator, denominator) => {
                format!("{slave} follows {master} in gear, {numerator} : {denominator}")
            }
            CoupledBy::Cam(cam) => {
                format!("{slave} follows {master} by the cam {}", cam.table.cam.name())
            }
        }
    }
}

/// Reads both, masters before slaves; `path` is the machine file. None if any is wrong.
pub(super) fn read(
    root: &Section<'_>,
    path: &Path,
    axes: Option<&[Axis]>,
) -> Option<Vec<Coupling>> {
    let (gears, cams) = (root.sections("gears"), root.sections("cams"));
    let Some(axes) = axes else {
        // Without axes nobody knows their units.
        gears.iter().chain(&cams).for_each(Section::accept_all);
        return None;
    };
    let mut whole = true;
    let mut found: Vec<Coupling> = Vec::new();
    let mut spans = Vec::new();
    for (section, is_gear) in
        gears.iter().map(|it| (it, true)).chain(cams.iter().map(|it| (it, false)))
    {
        let coupling = one(section, path, axes, is_gear);
        if let Some(coupling) = &coupling
            && found.iter().any(|other| other.axis == coupling.axis)
        {
            let message = "the axis follows another one already".to_owned();
            section.complain_at("axis", message);
        }
        whole &= coupling.is_some();
        spans.extend(coupling.as_ref().map(|_| section.span()));
        found.extend(coupling);
    }
    gears.into_iter().chain(cams).for_each(Section::finish);
    if groups(&found) > MOST_SIGNALS {
        root.complain(format!(
            "the cams of [[cams]] have tappets of more than {MOST_SIGNALS} groups"
        ));
        whole = false;
    }
    let pairs: Vec<_> = found.iter().map(|one| (one.master, one.axis)).collect();
    let sorted = masters_first(found);
    if sorted.is_none() {
        let cycle = coupling_cycle::find(&pairs).unwrap_or_default();
        let names =
            coupling_cycle::message(&cycle, |axis| axes.get(axis).map_or("", |axis| &axis.name));
        let message =
            format!("axes of [[gears]] and [[cams]] follow each other in a ring: {names}");
        // At the first of those that are part of it.
        let part = |pair: &(usize, usize)| cycle.windows(2).any(|two| two == [pair.0, pair.1]);
        match pairs.iter().position(part).and_then(|index| spans.get(index)) {
            Some(span) => root.complain_over(span, message),
            None => root.complain(message),
        }
    }
    sorted.filter(|_| whole)
}

/// Number of tappet groups, counted per slave.
fn groups(couplings: &[Coupling]) -> usize {
    let of = |coupling: &Coupling| match &coupling.by {
        CoupledBy::Gear(..) => 0,
        CoupledBy::Cam(selection) => {
            let groups = selection.table.cam.tappets().iter().map(|tappet| tappet.group);
            groups.collect::<BTreeSet<_>>().len()
        }
    };
    couplings.iter().map(of).sum()
}

fn one(section: &Section<'_>, path: &Path, axes: &[Axis], is_gear: bool) -> Option<Coupling> {
    let [slave, master] = ["axis", "master"].map(|key| {
        let name = section.required_text(key)?;
        let found = axes.iter().position(|axis| axis.name == name);
        if found.is_none() {
            let names: Vec<_> = axes.iter().map(|axis| axis.name.as_str()).collect();
            let message = format!("unknown axis \"{name}\"; the axes are {}", names.join(", "));
            section.complain_at(key, message);
        }
        found
    });
    // Other errors are reported as well.
    let by = if is_gear {
        let ratio = read_ratio(section);
        ratio.map(|(numerator, denominator)| CoupledBy::Gear(numerator, denominator.unsigned_abs()))
    } else {
        let [slave, master] =
            [slave, master].map(|index| index.and_then(|index| axes.get(index)).map(CamAxis::of));
        read_cam(section, path, slave, master).map(|cam| CoupledBy::Cam(Box::new(cam)))
    };
    let (axis, master) = (slave?, master?);
    if axis == master {
        section.complain_at("master", "an axis cannot follow itself");
        return None;
    }
    Some(Coupling { axis, master, by: by? })
}

/// Sorted so that masters come before slaves; `None` if there is a cycle.
fn masters_first(mut left: Vec<Coupling>) -> Option<Vec<Coupling>> {
    let mut sorted = Vec::new();
    while !left.is_empty() {
        let free = left.iter().position(|one| left.iter().all(|other| other.axis != one.master))?;
        sorted.push(left.remove(free));
    }
    Some(sorted)
}

/// `ratio_numerator` (not 0) and `ratio_denominator` (1 if absent, and at least 1).
pub fn read_ratio(section: &Section<'_>) -> Option<(i32, i32)> {
    let most = i64::from(i32::MAX);
    let numerator = section.required_integer("ratio_numerator", -most..=most);
    let denominator = section.integer("ratio_denominator", 1..=most);
    let wrong = section.has("ratio_denominator") && denominator.is_none();
    if numerator == Some(0) {
        let message = "`ratio_numerator` is 0: the slave would never move; it must not be 0";
        section.complain_at("ratio_numerator", message.to_owned());
        return None;
    }
    if wrong {
        return None;
    }
    let denominator = denominator.unwrap_or(1);
    Some((i32::try_from(numerator?).ok()?, i32::try_from(denominator).ok()?))
}

/// An axis of a cam, as far as the cam has to fit it.
#[derive(Clone, Copy, Debug)]
pub struct CamAxis<'a> {
    /// Its name.
    pub name: &'a str,
    /// Kind of its unit, mm or degrees.
    pub kind: AxisKind,
}

impl<'a> CamAxis<'a> {
    fn of(axis: &'a Axis) -> Self {
        Self { name: &axis.name, kind: axis.kind }
    }
}

/// Reads a cam and its start; `path` is the file that names it. Defaults come from the cam's file, except the three
/// flags of `MC_CamTableSelect`, which are true. Keys with units need known axes.
pub fn read_cam(
    section: &Section<'_>,
    path: &Path,
    slave: Option<CamAxis<'_>>,
    master: Option<CamAxis<'_>>,
) -> Option<CamSelection> {
    let between = [("linear", Interpolation::Linear), ("cubic", Interpolation::Cubic)];
    let between = section.choice("interpolation", &between).unwrap_or(Interpolation::Linear);
    let file = section.required_text("cam").and_then(|name| {
        let path = path.parent().unwrap_or(Path::new("")).join(name);
        let file = CamFile::load(&path, between);
        let file = file.map_err(|error| complain(section, &path, error)).ok()?;
        for (which, scale, axis) in
            [("slave", &file.slave, slave), ("master", &file.master, master)]
        {
            let Some(axis) = axis else { continue };
            if !unit_fits(scale, axis.kind) {
                let CamAxis { name, kind } = axis;
                let (unit, own) = (scale.unit(), kind.unit());
                let time = ["s", "ms", "sec"].contains(&unit) && which == "master";
                let time = if time { NO_TIME } else { "" };
                let message = format!(
                    "{}: the {which} is in {unit}, axis {name} in {own}{time}",
                    path.display()
                );
                section.complain_at("cam", message);
            }
        }
        if section.has("interpolation")
            && let Some(why) = file.no_interpolation()
        {
            let message =
                format!("{}: {why}; `interpolation` is for .csv and .asc", path.display());
            section.complain_at("interpolation", message);
        }
        Some(file)
    });
    let own = file.as_ref().map(|file| file.coupling.input).unwrap_or_default();
    let dead_time_s = file.as_ref().map_or(0.0, |file| file.coupling.dead_time_s);
    let flag = |key, otherwise| section.flag(key).unwrap_or(otherwise);
    // As `MC_CamTableSelect` has them by default (manual 5.4).
    let [periodic, master_absolute, slave_absolute] =
        ["periodic", "master_absolute", "slave_absolute"].map(|key| flag(key, true));
    let start_mode = section.choice("start_mode", &START_MODES).unwrap_or(own.start_mode);
    let number = |(key, own): (&str, f64), axis: Option<CamAxis<'_>>, suffix: &str, least: f64| {
        let key = axis.map(|axis| format!("{key}_{}{suffix}", axis.kind.unit()));
        key.and_then(|key| section.number(&key, least..=FAR)).unwrap_or(own)
    };
    let scaling = |key: &str, own| {
        let said = section.number(key, -FAR..=FAR);
        if let Some(message) = said.and_then(|said| no_scaling(&format!("`{key}`"), said)) {
            section.complain_at(key, message);
        }
        said.unwrap_or(own)
    };
    let input = CamInput {
        master_offset: number(("master_offset", own.master_offset), master, "", -FAR),
        master_scaling: scaling("master_scaling", own.master_scaling),
        slave_offset: number(("slave_offset", own.slave_offset), slave, "", -FAR),
        slave_scaling: scaling("slave_scaling", own.slave_scaling),
        start_mode,
        velocity_difference: number(
            ("velocity_difference", own.velocity_difference),
            slave,
            "_per_s",
            0.0,
        ),
        acceleration: number(("acceleration", own.acceleration), slave, "_per_s2", 0.0),
        deceleration: number(("deceleration", own.deceleration), slave, "_per_s2", 0.0),
        tappet_hysteresis: number(("tappet_hysteresis", own.tappet_hysteresis), master, "", 0.0),
        tappet_dead_time_s: section.number("dead_time_s", -FAR..=FAR).unwrap_or(dead_time_s),
    };
    if slave.is_none() || master.is_none() {
        section.accept_all();
        return None;
    }
    let file = file?;
    let named = file.path.display();
    let remark = |CamRemark { text, is_note }: &CamRemark| CamRemark {
        text: format!("{named}: {text}"),
        is_note: *is_note,
    };
    let remarks = file.remarks.iter().map(remark).collect();
    let rise = file.cam.curve().rise() * input.slave_scaling * input.master_scaling.signum();
    let unsaid = periodic && !section.has("periodic") && file.period.is_none() && !file.repeated;
    let gain_unsaid = (unsaid && rise != 0.0).then_some(rise);
    let cam = Arc::new(file.cam);
    let table = CamTable { periodic, master_absolute, slave_absolute, ..CamTable::new(cam) };
    Some(CamSelection { table, input, remarks, gain_unsaid })
}

/// Advice for a cam over time.
const NO_TIME: &str = ": no axis is time itself; a linear axis that MC_MoveVelocity moves with 1 mm/s counts seconds in mm, so that the \
                       unit of the master is mm";

/// Reports the error of a cam file in one line, with the lines of the file if they are known.
fn complain(section: &Section<'_>, path: &Path, error: CamFileError) {
    let said = error.to_string();
    let named = path.display().to_string();
    if let CamFileError::Toml(MachineFileError::Content { path, text, problems, .. }) = error {
        // What is about the whole of a file has no line in it to show.
        if let [whole] = problems.as_slice()
            && whole.span.is_empty()
        {
            section.complain_at("cam", format!("{named}: {}", whole.message));
            return;
        }
        let elsewhere = Elsewhere { path, text, problems };
        section.complain_elsewhere("cam", elsewhere);
        return;
    }
    let said = if said.contains(&named) { said } else { format!("{named}: {said}") };
    section.complain_at("cam", said);
}
