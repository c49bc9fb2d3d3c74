//! Cams as people write them in TOML.

use crate::cam_file::file::CamRemark;
use crate::cam_file::form::Coupling;
use crate::cam_file::toml_coupling::coupling;
use crate::cam_file::toml_table;
use crate::section::{FileKind, Section};
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use twin_cam::{
    Action, Cam, CamError, Compile, Element, Kind, Knot, Passage, Scale, Shape, Source, Tappet,
};
use twin_number::{counted, readable, significant};

/// Points that a note names.
const MOST_SHOWN: usize = 5;
/// Numbers of a file.
pub(super) const ANY: RangeInclusive<f64> = -1e15..=1e15;
/// Those that must be greater than 0.
pub(super) const POSITIVE: RangeInclusive<f64> = 1e-15..=1e15;
/// The longest time of a tappet, µs: a day.
const TAPPET_US: RangeInclusive<f64> = 0.0..=86_400e6;

/// Content of a cam file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TomlCam {
    pub(super) source: Source,
    /// A table instead of elements.
    pub(super) table: Option<Shape>,
    pub(super) coupling: Coupling,
    pub(super) cam: Cam,
    /// Remarks about elements, with their places.
    pub(super) remarks: Vec<(Range<usize>, CamRemark)>,
}

/// Reads a cam; one that says no name has `usual`, that of its file.
pub(super) fn read(root: &Section<'_>, usual: &str) -> Option<TomlCam> {
    if FileKind::Cam.refuses(root) {
        return None;
    }
    let name = if root.has("name") {
        root.required_text("name")
    } else {
        root.accept("name");
        Some(usual)
    };
    let kind = root.choice("kind", &[("cam", Kind::Cam), ("tappets", Kind::Tappets)]);
    let kind = kind.unwrap_or_default();
    let section = root.section("master");
    let master = scale(&section);
    section.finish();
    let section = root.section("slave");
    let (slave, bare) = slave_scale(&section);
    let period = section.number("period", POSITIVE);
    section.finish();
    let section = root.section("coupling");
    let coupling = coupling(&section);
    section.finish();
    let sections = [root.sections("elements"), root.sections("tappets")];
    let mut elements: Vec<_> = sections[0].iter().filter_map(element).collect();
    // They are sorted, but another place may have been meant.
    let out_of_order = elements.windows(2).find_map(|pair| {
        let [(before, _), (element, span)] = pair else { return None };
        let [before, master] = [begin(before), begin(element)];
        let message = format!(
            "the element at master {master} comes after the one at {before}; they are taken by ascending masters"
        );
        (master < before).then(|| (span.clone(), message))
    });
    elements.sort_by(|one, other| begin(&one.0).total_cmp(&begin(&other.0)));
    let mut tappets: Vec<_> = sections[1].iter().filter_map(tappet).collect();
    // Elements with errors of their own are missing below, so further errors would mislead.
    let mut whole = [elements.len(), tappets.len()] == sections.each_ref().map(Vec::len);
    tappets.sort_by(|one, other| one.0.master.total_cmp(&other.0.master));
    let section = root.section("table");
    let mut table = None;
    if root.has("table") {
        if !sections[0].is_empty() {
            let message = "`table` and `elements` describe the cam twice: leave one of them out";
            root.complain_at("table", message.to_owned());
        }
        table = toml_table::shape(&section, master.as_ref(), period.is_some());
        whole &= table.is_some();
        section.check_unknown();
    } else if kind == Kind::Cam && !root.has("elements") {
        root.complain("the cam has no `elements` and no `table`");
        whole = false;
    }
    root.check_unknown();
    if !whole {
        return None;
    }
    let mut source = Source {
        name: name?.to_owned(),
        kind,
        master: master?,
        slave: slave?,
        period,
        elements: elements.iter().map(|(element, _)| *element).collect(),
        tappets: tappets.iter().map(|(tappet, _)| *tappet).collect(),
    };
    if bare {
        source.scale_slave(None);
    }
    let cam = match &table {
        Some(shape) => Cam::new(&source.name, shape.clone(), source.tappets.clone()),
        None => source.compile(Compile::Polynomial),
    };
    match cam {
        Ok(cam) => {
            if bare && kind == Kind::Cam {
                source.scale_slave(Some(cam.curve()));
                let key = if table.is_some() { "table" } else { "elements" };
                check_scale(&source.slave, root, key);
            }
            let replaced = elements.last().and_then(|(element, span)| {
                let section = sections[0].iter().find(|section| section.span() == *span)?;
                Some((span.clone(), replaced_end(element, section, &source, &cam)?))
            });
            let remark = |is_note| move |(span, text)| (span, CamRemark { text, is_note });
            let warnings = out_of_order.into_iter().chain(replaced).map(remark(false));
            let rests = rests(&sections[0], &source, &cam).map(remark(true));
            let remarks = warnings.chain(rests).collect();
            Some(TomlCam { source, table, coupling, cam, remarks })
        }
        Err(error) => {
            let elements: Vec<_> = elements.into_iter().map(|(_, span)| span).collect();
            let tappets: Vec<_> = tappets.into_iter().map(|(_, span)| span).collect();
            complain_of(error, root, &elements, &tappets, table.is_some().then_some(&section));
            None
        }
    }
}

/// Warning about values of `last`, the element of `section`, that are not those of the end of the periodic `cam`.
fn replaced_end(
    last: &Element,
    section: &Section<'_>,
    source: &Source,
    cam: &Cam,
) -> Option<String> {
    let (Element::Point(written), Shape::Polynomial(knots)) = (last, cam.shape()) else {
        return None;
    };
    let end = knots.last().filter(|end| end.master <= written.master)?;
    let replaced: Vec<_> = [
        ("slave", written.slave, end.slave),
        ("velocity", written.velocity, end.velocity),
        ("acceleration", written.acceleration, end.acceleration),
    ]
    .into_iter()
    .filter(|(key, ..)| section.has(key))
    .map(|(key, written, used)| (key, significant(written, 6), significant(used, 6)))
    .filter(|(_, written, used)| written != used)
    .map(|(key, written, used)| format!("{key} {written} is replaced by {used}"))
    .collect();
    let period = significant(source.period?, 6);
    let message = format!(
        "the element at master {}, the end: {}. The end of a periodic cam is the begin plus whole periods of {period}; write these values, or leave `period` out",
        significant(written.master, 6),
        replaced.join(", ")
    );
    (!replaced.is_empty()).then_some(message)
}

/// Note about points without `velocity` at which the slave rests though neither a dwell nor a turn of it says so, at the
/// place of the first in the file.
fn rests(sections: &[Section<'_>], source: &Source, cam: &Cam) -> Option<(Range<usize>, String)> {
    let Shape::Polynomial(knots) = cam.shape() else { return None };
    let bare = sections.iter().filter(|section| !section.has("from") && !section.has("velocity"));
    let bare: BTreeMap<u64, Range<usize>> = bare
        .filter_map(|section| Some((section.required_number("master", ANY)?, section.span())))
        .map(|(master, span)| ((master + 0.0).to_bits(), span))
        .collect();
    let steps: Vec<f64> =
        knots.iter().zip(knots.iter().skip(1)).map(|(one, next)| next.slave - one.slave).collect();
    // Where the cam goes on, its end is its begin; else it rests at its ends.
    let goes_on = source.period.is_some() || cam.curve().rise() == 0.0;
    let before = steps.last().copied().filter(|_| goes_on).unwrap_or_default();
    let around = std::iter::once(before).chain(steps.iter().copied()).zip(steps.iter().copied());
    let found: Vec<_> = knots
        .iter()
        .zip(around)
        .filter(|(knot, (before, after))| knot.velocity == 0.0 && before * after > 0.0)
        .filter_map(|(knot, _)| Some((knot.master, bare.get(&(knot.master + 0.0).to_bits())?)))
        .collect();
    let span = found.iter().map(|(_, span)| *span).min_by_key(|span| span.start)?.clone();
    let shown: Vec<_> =
        found.iter().take(MOST_SHOWN).map(|(master, _)| significant(*master, 6)).collect();
    let left = found.len().saturating_sub(shown.len());
    let more = if left > 0 { format!(" and {left} more") } else { String::new() };
    let message = format!(
        "{} without `velocity`, at master {}{more}: the slave rests there; write the velocity, or `velocity = 0` for a rest",
        counted(found.len(), "point"),
        shown.join(", ")
    );
    Some((span, message))
}

/// Reports errors of elements and tappets, which are ordered by their masters, at their places.
fn complain_of(
    error: CamError,
    root: &Section<'_>,
    elements: &[Range<usize>],
    tappets: &[Range<usize>],
    table: Option<&Section<'_>>,
) {
    let is_table = table.is_some();
    let place = match error {
        CamError::OutsideScale { what: "tappet", index, .. }
        | CamError::TappetTime { index, .. } => tappets.get(index - 1).cloned(),
        CamError::Kink { index, .. }
        | CamError::OutsideScale { index, .. }
        | CamError::NotAscending { index, .. }
        | CamError::Beyond { index }
            if !is_table =>
        {
            elements.get(index - 1).cloned()
        }
        CamError::OutsideType { index, .. }
        | CamError::Fraction { index, .. }
        | CamError::NotAscending { index, .. }
            if is_table =>
        {
            let item = table.and_then(|table| toml_table::span_of_item(table, index - 1));
            item.or_else(|| Some(root.span_of("table")))
        }
        CamError::EndMissing { .. } => Some(root.span_of("master")),
        _ if is_table => Some(root.span_of("table")),
        _ => Some(root.span_of("elements")),
    };
    // Numbers are those of the file, not those by master.
    let error = match (error, &place) {
        (CamError::OutsideScale { what, master, min, max, index }, Some(span)) => {
            let spans = if what == "tappet" { tappets } else { elements };
            let index = if !is_table || what == "tappet" {
                1 + spans.iter().filter(|other| other.start < span.start).count()
            } else {
                index
            };
            CamError::OutsideScale { what, index, master, min, max }
        }
        (error, _) => error,
    };
    match place {
        Some(span) => root.complain_over(&span, error.to_string()),
        None => root.complain(error.to_string()),
    }
}

fn scale(section: &Section<'_>) -> Option<Scale> {
    let [min, max] = [section.required_number("min", ANY), section.required_number("max", ANY)];
    let step = section.number("step", POSITIVE);
    let unit = section.text("unit").unwrap_or_default().to_owned();
    let (min, max) = (min?, max?);
    if max <= min {
        section.complain_at("max", format!("`max` is {max}; it must be greater than `min`, {min}"));
        return None;
    }
    Some(Scale { min, max, step: step.unwrap_or((max - min) / 10.0), unit })
}

/// Scale of the slave, and whether its ends are open: pictures then show the range of the slave.
fn slave_scale(section: &Section<'_>) -> (Option<Scale>, bool) {
    if section.has("min") || section.has("max") {
        return (scale(section), false);
    }
    section.accept("min");
    section.accept("max");
    let step = section.number("step", POSITIVE).unwrap_or(0.0);
    let unit = section.text("unit").unwrap_or_default().to_owned();
    (Some(Scale { min: 0.0, max: 1.0, step, unit }), true)
}

/// Complains about `key`, whose slave has a scale that a file cannot have.
fn check_scale(slave: &Scale, root: &Section<'_>, key: &str) {
    if ANY.contains(&slave.min) && ANY.contains(&slave.max) {
        return;
    }
    let (Scale { min, max, .. }, (low, high)) = (slave, ANY.into_inner());
    root.complain_at(
        key,
        format!(
            "the scale of the slave would go from {} to {}; it must lie between {low:e} and {high:e}: use smaller \
             positions, velocities and accelerations",
            readable(*min, 6),
            readable(*max, 6),
        ),
    );
}

fn begin(element: &Element) -> f64 {
    match element {
        Element::Point(knot) => knot.master,
        Element::Line { from, .. } => from[0],
    }
}

/// A point (`master`, `slave`, `velocity`, `acceleration`) or a straight line (`from`, `to`).
fn element(section: &Section<'_>) -> Option<(Element, Range<usize>)> {
    let is_line = section.has("from") || section.has("to");
    let element = if is_line {
        let ends =
            [section.required_numbers::<2>("from", ANY), section.required_numbers::<2>("to", ANY)];
        match ends {
            [Some(from), Some(to)] if to[0] > from[0] => Some(Element::Line { from, to }),
            [Some(from), Some(to)] => {
                let message = format!(
                    "`to` begins with master {}; it must be greater than that of `from`, {}",
                    to[0], from[0]
                );
                section.complain_at("to", message);
                None
            }
            _ => None,
        }
    } else {
        let [master, slave] = ["master", "slave"].map(|key| section.required_number(key, ANY));
        let [velocity, acceleration] =
            ["velocity", "acceleration"].map(|key| section.number(key, ANY).unwrap_or(0.0));
        match (master, slave) {
            (Some(master), Some(slave)) => {
                Some(Element::Point(Knot { master, slave, velocity, acceleration }))
            }
            _ => None,
        }
    };
    section.check_unknown();
    Some((element?, section.span()))
}

fn tappet(section: &Section<'_>) -> Option<(Tappet, Range<usize>)> {
    let group = section.required_integer("group", i64::from(i16::MIN)..=i64::from(i16::MAX));
    let master = section.required_number("master", ANY);
    let passages = [
        ("positive", Passage::Positive),
        ("negative", Passage::Negative),
        ("every", Passage::Every),
    ];
    let passage = section.choice("passage", &passages).unwrap_or_default();
    let timed = Action::Timed { delay_ns: 0, duration_ns: 0 };
    let actions =
        [("on", Action::On), ("off", Action::Off), ("invert", Action::Invert), ("timed", timed)];
    let mut action = section.required_choice("action", &actions);
    if action == Some(timed) {
        let delay_ns = section.number("delay_us", TAPPET_US).map_or(0, nanoseconds);
        let duration = section.required_number("duration_us", TAPPET_US).map(nanoseconds);
        action = duration.map(|duration_ns| Action::Timed { delay_ns, duration_ns });
    }
    section.check_unknown();
    let group = i16::try_from(group?).ok()?;
    Some((Tappet { group, master: master?, passage, action: action? }, section.span()))
}

#[expect(clippy::cast_possible_truncation, reason = "a day at most")]
fn nanoseconds(us: f64) -> i64 {
    (us * 1e3).round() as i64
}
