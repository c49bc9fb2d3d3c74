//! Job file reader.

use super::along::{Motion, along};
use super::block::{moving, on_cam};
use super::kind::{BLOCKS, INTERPOLATOR};
use super::probe::{JobTrigger, When};
use super::values::Values;
use super::{Begins, Call, CamsBefore, Job, Start, VirtualAxis};
use std::path::Path;
use twin_axis::{CamIn, GearIn};
use twin_machine::axis_kind::AxisKind;
use twin_machine::section::{FileKind, Problem};
use twin_machine::section::{Section, parse};
use twin_machine::tappets::{MOST_SIGNALS, Tracks};
use twin_machine::{CamAxis, CamSelection, CoupledBy, Coupling, Machine};
use twin_profile::RampType;

/// Longest time in a job, s: a day.
pub(super) const LONGEST: f64 = 86_400.0;

/// Farthest position, mm or degrees, and fastest of its derivatives.
pub(super) const FAR: f64 = 1e9;

/// Reads the job in `text`, whose cams are named as from `path`, for `machine`.
///
/// # Errors
/// All mistakes, in file order.
pub(crate) fn read(text: &str, path: &Path, machine: &Machine) -> Result<Job, Vec<Problem>> {
    parse(text, |root| {
        let reader =
            Reader { lines: Lines::of(text), path, axes: Vec::new(), triggers: Vec::new() };
        reader.job(root, machine)
    })
}

/// Properties of an axis that are known while blocks are read.
pub(super) struct Known {
    pub(super) name: String,
    pub(super) kind: AxisKind,
    /// mm/s² or degrees/s²; none of a virtual axis that does not say it.
    pub(super) max_acceleration: Option<f64>,
    pub(super) max_deceleration: Option<f64>,
}

/// Line ends of a file, so that lines are not counted for every block.
#[derive(Debug)]
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        Self(text.match_indices('\n').map(|(end, _)| end).collect())
    }

    /// The line, from 1, in which a byte is.
    fn at(&self, byte: usize) -> u32 {
        let before = self.0.partition_point(|end| *end < byte);
        u32::try_from(before + 1).unwrap_or(u32::MAX)
    }
}

pub(super) struct Reader<'t> {
    pub(super) lines: Lines,
    pub(super) path: &'t Path,
    pub(super) axes: Vec<Known>,
    pub(super) triggers: Vec<JobTrigger>,
}

impl Reader<'_> {
    fn job(mut self, root: &Section<'_>, machine: &Machine) -> Option<Job> {
        if FileKind::Job.refuses(root) {
            return None;
        }
        // For people.
        root.accept("name");
        let ramps = [
            ("trapezoid", RampType::Trapezoid),
            ("sigmoid", RampType::Sigmoid),
            ("parabolic", RampType::Parabolic),
        ];
        let ramp = root.choice("ramp", &ramps).unwrap_or_default();
        let duration = root.number("duration_s", 0.0..=LONGEST);
        self.axes = machine.axes.iter().map(Known::of).collect();
        let virtual_axes = self.virtual_axes(root, duration.is_some());
        let starts = root.sections("start");
        let mut said: Vec<Start> = Vec::new();
        for section in starts {
            said.extend(self.start(section, machine, &said));
        }
        let starts = said;
        self.triggers = self.triggers(root);
        let sections = root.sections("blocks");
        if sections.is_empty() {
            root.complain("the file lacks [[blocks]]: nothing would move".to_owned());
        }
        let mut cams = CamsBefore::default();
        let calls = (0..).zip(&sections);
        let calls = calls.flat_map(|(index, one)| self.calls(one, machine, index, &mut cams));
        let calls: Vec<_> = calls.collect();
        sections.into_iter().for_each(Section::finish);
        root.check_unknown();
        let written: Vec<_> = calls.into_iter().collect::<Option<_>>()?;
        let line = written.first().map_or(1, |call| call.line);
        let standing = machine.couplings.iter().map(|coupling| standing(machine, coupling, line));
        let calls: Vec<_> = standing.chain(written).collect();
        let tracks = self.tracks(root, &calls)?;
        let triggers = self.triggers;
        Some(Job { ramp, duration, starts, virtual_axes, triggers, tracks, calls })
    }

    /// Signals of the tappets of all cams.
    fn tracks(&self, root: &Section<'_>, calls: &[Call]) -> Option<Tracks> {
        let mut tracks = Tracks::default();
        for call in calls {
            let name = self.axes.get(call.axis).map_or("", |axis| &axis.name);
            for group in call.block.groups() {
                if !tracks.add(call.axis, name, group) {
                    let message =
                        format!("the cams have tappets of more than {MOST_SIGNALS} groups");
                    root.complain(message);
                    return None;
                }
            }
        }
        Some(tracks)
    }

    /// Axes that the job `halted` at its end need an acceleration.
    fn virtual_axes(&mut self, root: &Section<'_>, halted: bool) -> Vec<VirtualAxis> {
        let mut found = Vec::new();
        for section in root.sections("virtual_axes") {
            let name = section.required_text("name");
            let kinds = [("rotary", AxisKind::Rotary), ("linear", AxisKind::Linear)];
            let Some(kind) = section.required_choice("kind", &kinds) else {
                section.accept_all();
                continue;
            };
            let unit = kind.unit();
            let period = section.number(&format!("period_{unit}"), 1e-6..=FAR);
            let max_jerk = section.number(&format!("max_jerk_{unit}_per_s3"), 1e-6..=1e15);
            let key = format!("max_acceleration_{unit}_per_s2");
            let max_acceleration = section.number(&key, 1e-6..=FAR);
            if halted && !section.has(&key) {
                let message = format!("an axis that `duration_s` halts needs `{key}`");
                section.complain(message);
            }
            let start = section.number(&format!("start_{unit}"), -FAR..=FAR).unwrap_or(0.0);
            if let Some(name) = name {
                if self.axes.iter().any(|axis| axis.name == name) {
                    section.complain_at("name", format!("there is an axis \"{name}\" already"));
                } else {
                    let name = name.to_owned();
                    let max_deceleration = max_acceleration;
                    let known = name.clone();
                    self.axes.push(Known { name: known, kind, max_acceleration, max_deceleration });
                    found.push(VirtualAxis {
                        name,
                        unit,
                        period,
                        max_acceleration,
                        max_jerk,
                        start,
                    });
                }
            }
            section.finish();
        }
        found
    }

    /// The inputs that latch.
    fn triggers(&self, root: &Section<'_>) -> Vec<JobTrigger> {
        let mut found: Vec<JobTrigger> = Vec::new();
        for section in root.sections("triggers") {
            let name = section.required_text("name");
            let at = section.number("at_s", 0.0..=LONGEST).map(When::At);
            let passes = section.has("axis").then(|| self.axis(&section, "axis")).flatten();
            let passes = passes.and_then(|(axis, known)| {
                let key = format!("position_{}", known.kind.unit());
                Some(When::Passes(axis, section.required_number(&key, -FAR..=FAR)?))
            });
            if section.has("axis") && passes.is_none() {
                // The unit of the position is unknown without the axis.
                section.accept_all();
            }
            if section.has("at_s") == section.has("axis") {
                let message =
                    "a trigger needs `at_s`, or an `axis` and the position that it passes";
                section.complain(message.to_owned());
            }
            if let Some(name) = name {
                // A trigger with a mistake exists for the blocks that name it.
                let when = at.or(passes).unwrap_or(When::At(0.0));
                if found.iter().any(|trigger| trigger.name == name) {
                    section.complain_at("name", format!("there is a trigger \"{name}\" already"));
                } else {
                    found.push(JobTrigger { name: name.to_owned(), when });
                }
            }
            section.finish();
        }
        found
    }

    /// A start position; `said` are the earlier ones.
    fn start(&self, section: Section<'_>, machine: &Machine, said: &[Start]) -> Option<Start> {
        let Some((axis, known)) = self.axis(&section, "axis") else {
            section.accept_all();
            return None;
        };
        let key = format!("position_{}", known.kind.unit());
        let position = section.required_number(&key, -FAR..=FAR);
        if axis >= machine.axes.len() {
            let message = "the start of a virtual axis is given in [[virtual_axes]]".to_owned();
            section.complain_at("axis", message);
        }
        if said.iter().any(|other| other.axis == axis) {
            let message = format!("two [[start]] say where axis \"{}\" starts", known.name);
            section.complain_at("axis", message);
        }
        let line = self.lines.at(section.span_of(&key).start);
        section.finish();
        Some(Start { line, axis, position: position? })
    }

    /// The axis that `key` names.
    fn axis(&self, section: &Section<'_>, key: &str) -> Option<(usize, &Known)> {
        let name = section.required_text(key)?;
        let found = self.axes.iter().enumerate().find(|(_, axis)| axis.name == name);
        if found.is_none() {
            let names: Vec<_> = self.axes.iter().map(|axis| axis.name.as_str()).collect();
            let message = format!("unknown axis \"{name}\"; the axes are {}", names.join(", "));
            section.complain_at(key, message);
        }
        found
    }

    /// Name and axis of a block, also of one with mistakes.
    fn named(&self, section: &Section<'_>) -> Option<(&'static str, usize)> {
        let [block, axis] = ["block", "axis"].map(|key| section.glance_at_text(key));
        let (name, _) = BLOCKS.into_iter().find(|(name, _)| Some(*name) == block)?;
        let axis = self.axes.iter().position(|one| Some(one.name.as_str()) == axis)?;
        Some((name, axis))
    }

    /// The calls that move axes along a program, and a virtual axis with its path length.
    fn along_program(
        &self,
        section: &Section<'_>,
        machine: &Machine,
        index: usize,
        cams: &mut CamsBefore,
    ) -> Vec<Option<Call>> {
        section.accept("block");
        let (axis, program) = (self.axis(section, "axis"), section.required_text("program"));
        let begins = begins(section);
        let line = self.lines.at(section.span_of("block").start);
        let (Some((way, known)), Some(program)) = (axis, program) else { return vec![None] };
        if way < machine.axes.len() || known.kind != AxisKind::Linear {
            let message = "the axis of the path length is a linear one of [[virtual_axes]]";
            section.complain_at("axis", message.to_owned());
            return vec![None];
        }
        let path = self.path.parent().unwrap_or_else(|| Path::new("")).join(program);
        let motion = match Motion::of(machine, &path) {
            Ok(motion) => motion,
            Err(message) => {
                section.complain_at("program", message);
                return vec![None];
            }
        };
        let call = |(begins, axis, track)| {
            let block = along(track, machine);
            Some(Call { name: INTERPOLATOR, line, axis, master: None, block, begins })
        };
        let axes = motion.axes.iter().map(|(axis, track)| (Begins::WithPrevious, *axis, track));
        let all: Vec<_> = std::iter::once((begins, way, &motion.way)).chain(axes).collect();
        for (_, axis, _) in &all {
            cams.pass(index, INTERPOLATOR, *axis);
        }
        all.into_iter().map(call).collect()
    }

    /// The calls of the block of this number, behind those that have passed the `cams` of the axes; `None` for a mistake.
    pub(super) fn calls(
        &self,
        section: &Section<'_>,
        machine: &Machine,
        index: usize,
        cams: &mut CamsBefore,
    ) -> Vec<Option<Call>> {
        if section.glance_at_text("block") == Some(INTERPOLATOR) {
            return self.along_program(section, machine, index, cams);
        }
        let call = self.call(section, cams);
        if let Some((name, axis)) = self.named(section) {
            cams.pass(index, name, axis);
        }
        vec![call]
    }

    fn call(&self, section: &Section<'_>, cams: &CamsBefore) -> Option<Call> {
        let names = BLOCKS.map(|(name, kind)| (name, (name, kind)));
        let (block, axis) = (section.required_choice("block", &names), self.axis(section, "axis"));
        let begins = begins(section);
        let follows = block.is_some_and(|(_, kind)| kind.follows());
        let master = if follows { self.axis(section, "master") } else { None };
        let of_master = master.map(|(_, known)| known);
        let (Some((name, kind)), Some((axis, known))) = (block, axis) else {
            // Most keys depend on both: one complaint is enough.
            if let Some((_, kind)) = block {
                kind.whatever_axis(section, of_master, self.path);
            }
            section.accept_all();
            return None;
        };
        if master.is_some_and(|(master, _)| master == axis) {
            section.complain_at("master", format!("axis \"{}\" cannot follow itself", known.name));
        }
        let inputs = Values { section, known, master: of_master, triggers: &self.triggers };
        let block = kind.block(&inputs, self.path);
        if follows && master.is_none() {
            // The units of an unknown master are unknown.
            section.accept_all();
            return None;
        }
        if begins == Begins::EndOfProfile && cams.of(axis).is_none() {
            let name = &known.name;
            let message = format!(
                "what moves axis \"{name}\" before this block is not an MC_CamIn of the same axis"
            );
            section.complain_at("at_end_of_profile", message);
        }
        let line = self.lines.at(section.span_of("block").start);
        let master = master.map(|(index, _)| index);
        Some(Call { name, line, axis, master, block: block?, begins })
    }
}

impl Known {
    pub(super) fn of(axis: &twin_machine::Axis) -> Self {
        let max_acceleration = Some(axis.from_si(axis.max_acceleration));
        let max_deceleration = Some(axis.from_si(axis.max_deceleration));
        Self { name: axis.name.clone(), kind: axis.kind, max_acceleration, max_deceleration }
    }

    pub(super) fn as_cam(&self) -> CamAxis<'_> {
        CamAxis { name: &self.name, kind: self.kind }
    }
}

/// A coupling of the machine file, which holds from the beginning; the job has only its first `line`.
fn standing(machine: &Machine, coupling: &Coupling, line: u32) -> Call {
    let (name, block) = match &coupling.by {
        CoupledBy::Gear(ratio_numerator, ratio_denominator) => {
            let axis = machine.axes.get(coupling.axis);
            let acceleration = axis.map_or(1.0, |axis| axis.from_si(axis.max_acceleration));
            let deceleration = axis.map_or(1.0, |axis| axis.from_si(axis.max_deceleration));
            let gear = GearIn {
                ratio_numerator: *ratio_numerator,
                ratio_denominator: *ratio_denominator,
                acceleration,
                deceleration,
            };
            ("MC_GearIn", moving(gear))
        }
        CoupledBy::Cam(selection) => {
            let CamSelection { table, input, .. } = &**selection;
            // The check reports on its file.
            (
                "MC_CamIn",
                on_cam(CamIn { table: Some(table.clone()), input: *input }, Vec::new(), None),
            )
        }
    };
    let (axis, master) = (coupling.axis, Some(coupling.master));
    Call { name, line, axis, master, block, begins: Begins::Standing }
}

/// When a block begins.
fn begins(section: &Section<'_>) -> Begins {
    let at = section.number("at_s", 0.0..=LONGEST);
    let after = section.number("after_s", 0.0..=LONGEST);
    let with_previous = section.flag("with_previous").unwrap_or(false);
    let at_end = section.flag("at_end_of_profile").unwrap_or(false);
    let keys = ["at_s", "after_s", "with_previous", "at_end_of_profile"];
    if keys.into_iter().filter(|key| section.has(key)).count() > 1 {
        let message =
            "a block begins `at_s`, `after_s`, `with_previous` or `at_end_of_profile`: one of them";
        section.complain(message.to_owned());
    }
    match at {
        Some(time) => Begins::At(time),
        None if with_previous => Begins::WithPrevious,
        None if at_end => Begins::EndOfProfile,
        None => after.map_or(Begins::Next, Begins::After),
    }
}
