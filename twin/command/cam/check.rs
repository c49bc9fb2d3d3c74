//! `twin cam check`: bounds of the slave's motion on a cam, against its limits.

use super::options::{LimitOptions, MasterOptions, UseOptions, load, number};
use super::show_findings;
use crate::cam::check::{AxisLimits, CamCheck, CamUse};
use crate::command::show::table;
use crate::command::{Failure, Status};
use crate::finding;
use clap::ValueEnum;
use comfy_table::CellAlignment;
use std::io::{self, Write};
use std::path::PathBuf;
use twin_cam::{Action, Largest, Passage, Range};
use twin_machine::cam_file::CamFile;
use twin_number::{at_most, beside, readable};

/// Check a cam: exact bounds of the slave against its limits, how fast the master may go, jumps, tappets
///
/// Everything follows from the polynomials in closed form; nothing is sampled. Bounds are those of the slave with the
/// master at its velocity, its acceleration and jerk anywhere between both signs.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Arguments {
    /// The cam
    #[arg(value_name = "CAM")]
    cam: PathBuf,

    /// For people, or one JSON object
    #[arg(long, value_enum, default_value = "human")]
    format: Format,

    /// Where the master is when `MC_CamIn` starts, u: beyond the cam it ends with error 626
    #[arg(long, value_name = "U", allow_hyphen_values = true, value_parser = number)]
    master_start: Option<f64>,

    #[command(flatten)]
    master: MasterOptions,

    #[command(flatten)]
    limits: LimitOptions,

    #[command(flatten)]
    coupling: UseOptions,
}

const AFTER_HELP: &str = "\
Exit status:
  0  the slave keeps its limits
  1  it does not, or the cam jumps where it must not
  2  the command could not be carried out

Example:
  twin cam check examples/cams/pick_and_place.toml --master-velocity 360 --max-velocity 900 --max-acceleration 20000";

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::command) enum Format {
    Human,
    Json,
}

pub(super) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    let file = load(&arguments.cam, arguments.coupling.interpolation)?;
    let limits = arguments.limits.limits(&file)?;
    let mut using = arguments.coupling.using(&file, arguments.master.motion(), limits);
    using.start = arguments.master_start;
    let check = CamCheck::new(&file, using);
    let mut out = io::stdout().lock();
    match arguments.format {
        Format::Json => writeln!(out, "{}", check.json()),
        Format::Human => {
            show_findings(&check.findings);
            report(&mut out, &file, &using, &check)
        }
    }
    .map_err(Failure::Stdio)?;
    Ok(if finding::unfit(&check.findings) { Status::Unfit } else { Status::Fit })
}

/// Six significant digits.
fn short(value: f64) -> String {
    readable(value, 6)
}

fn report(
    out: &mut impl Write,
    file: &CamFile,
    using: &CamUse,
    check: &CamCheck<'_>,
) -> io::Result<()> {
    let (master, slave) = (file.master.unit(), file.slave.unit());
    let curve = file.cam.curve();
    let motion = &using.master;
    writeln!(
        out,
        "{}: {} over master {} … {} {master}, {}",
        file.path.display(),
        file.cam.name(),
        short(curve.start()),
        short(curve.end()),
        if using.repeated { "put end to end" } else { "once" },
    )?;
    writeln!(
        out,
        "master at {} {master}/s, its acceleration within ±{} {master}/s², its jerk within ±{} {master}/s³",
        short(motion.velocity),
        short(motion.acceleration),
        short(motion.jerk)
    )?;
    // A cam of tappets only has no slave.
    if file.is_tappets_only() {
        writeln!(out, "tappets only")?;
        return tappets(out, file, check);
    }
    let mut rows = table();
    rows.set_header(["slave", "least", "at master", "greatest", "at master", "limit"]);
    let AxisLimits { position, motion: limits, .. } = using.limits;
    let both = |limit: f64| [-limit, limit];
    for (name, unit, range, limit) in [
        ("position", "", &check.bounds.position, position),
        ("velocity", "/s", &check.bounds.velocity, both(limits.velocity)),
        ("acceleration", "/s²", &check.bounds.acceleration, both(limits.acceleration)),
        ("jerk", "/s³", &check.bounds.jerk, both(limits.jerk)),
    ] {
        let Range { min, at_min, max, at_max } = range;
        // Rounding relative to the whole is 0.
        let message =
            |value: f64| if value.abs() < 1e-12 * range.magnitude() { 0.0 } else { value };
        rows.add_row([
            format!("{name} ({slave}{unit})"),
            short(message(*min)),
            check.place(*at_min),
            short(message(*max)),
            check.place(*at_max),
            limit_text(limit),
        ]);
    }
    for column in 1..5 {
        if let Some(column) = rows.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    writeln!(out, "{rows}")?;
    if let Some(gain) = check.gain() {
        let gain = short(gain);
        writeln!(out, "positions are those of the first pass: every pass gains {gain} {slave}")?;
    }
    let smooth = match check.smoothness() {
        "C2" => "C2: position, velocity and acceleration are continuous",
        "C1" => "C1: position and velocity are continuous, the acceleration jumps",
        "C0" => "C0: the position is continuous, the velocity jumps",
        _ => "the position jumps",
    };
    let seam = match check.stop {
        _ if using.repeated => ", from its end to its begin, too",
        [Some(_), _] => " where the pass ends, as the slave stays there",
        [_, Some(_)] if check.jumps[1].is_none() => {
            " where the pass ends, as the slave stays there"
        }
        _ => "",
    };
    // What jumps on the cam, too, jumps not only there.
    let alone = check.jumps.iter().all(Option::is_none);
    writeln!(out, "{smooth}{}", if alone || using.repeated { seam } else { "" })?;
    match &check.largest {
        Ok(Largest { value, limited: Some((quantity, place)) }) => writeln!(
            out,
            "the master may go {} {master}/s: the slave's {quantity} at master {} {master} limits it",
            at_most(*value, 6),
            check.place(using.master_at(*place)),
        )?,
        Ok(Largest { limited: None, .. }) => {
            writeln!(out, "no limit says how fast the master may go")?;
        }
        Err(error) => writeln!(out, "no velocity of the master is slow enough: {error}")?,
    }
    start(out, file, using, check)?;
    tappets(out, file, check)
}

/// Where the master may be when the slave is coupled; where it is, and where the slave has to be then.
fn start(
    out: &mut impl Write,
    file: &CamFile,
    using: &CamUse,
    check: &CamCheck<'_>,
) -> io::Result<()> {
    let (master, slave) = (file.master.unit(), file.slave.unit());
    let curve = file.cam.curve();
    if let Some(at) = using.start.filter(|at| using.starts_at(curve, *at)) {
        let place = using.place_at(at);
        let position = using.slave_at(curve.at(place).position);
        writeln!(
            out,
            "MC_CamIn starts with the master at {} {master}: at {} of the cam, which has the slave at {} {slave}",
            check.place(at),
            beside(place, curve.end() - curve.start(), 6),
            beside(position, check.bounds.position.magnitude(), 6),
        )
    } else {
        // A refused start is among the findings.
        let [from, to] = using.starts(curve).map(|at| check.place(at));
        writeln!(
            out,
            "MC_CamIn starts with the master from {from} to {to} {master}, elsewhere it ends with error 626"
        )
    }
}

fn limit_text([low, high]: [f64; 2]) -> String {
    match [low.is_finite(), high.is_finite()] {
        [true, true] if low.to_bits() == (-high).to_bits() => format!("±{}", short(high)),
        [true, true] => format!("{} … {}", short(low), short(high)),
        [true, false] => format!("from {}", short(low)),
        [false, true] => format!("to {}", short(high)),
        [false, false] => "–".to_owned(),
    }
}

fn tappets(out: &mut impl Write, file: &CamFile, check: &CamCheck<'_>) -> io::Result<()> {
    if file.cam.tappets().is_empty() {
        return Ok(());
    }
    let (master, slave) = (file.master.unit(), file.slave.unit());
    let mut rows = table();
    let header = ["tappets of group", "passage", "action"].map(str::to_owned);
    let alone = file.is_tappets_only();
    let place = (!alone).then(|| format!("slave ({slave})"));
    let places = [Some(format!("master ({master})")), place, Some("time (ms)".to_owned())];
    rows.set_header(header.into_iter().chain(places.into_iter().flatten()));
    for (tappet, at, position) in check.tappets() {
        let passage = match tappet.passage {
            Passage::Positive => "positive",
            Passage::Negative => "negative",
            Passage::Every => "every",
        };
        let action = match tappet.action {
            Action::On => "on".to_owned(),
            Action::Off => "off".to_owned(),
            Action::Invert => "invert".to_owned(),
            Action::Timed { delay_ns, duration_ns } => {
                format!("after {} ms for {} ms", milliseconds(delay_ns), milliseconds(duration_ns))
            }
        };
        let position = (!alone).then(|| beside(position, check.bounds.position.magnitude(), 6));
        let after = check.passed_after(tappet).map_or("–".to_owned(), |after| short(after * 1e3));
        let cells = [tappet.group.to_string(), passage.to_owned(), action, check.place(at)];
        rows.add_row(cells.into_iter().chain(position).chain([after]));
    }
    writeln!(out, "{rows}")?;
    if check.tappets().any(|(tappet, ..)| check.passed_after(tappet) == Some(0.0)) {
        let again = if check.is_repeated() { ", in the next pass" } else { "" };
        writeln!(
            out,
            "a tappet acts when the master reaches it; one at the start position acts when the master reaches it again{again}"
        )?;
    }
    Ok(())
}

fn milliseconds(ns: i64) -> String {
    #[expect(clippy::cast_precision_loss, reason = "a day at most")]
    let ms = ns as f64 * 1e-6;
    short(ms)
}
