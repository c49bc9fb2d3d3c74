//! Program overview: key figures, G-code view and listing (manual 3.3, 6.2.2 and 7).

use super::Job;
use super::output::stdio;
use crate::command::Failure;
use crate::command::options::unreadable;
use crate::finding::{Finding, Severity};
use crate::m_function::Acknowledgement;
use crate::program::{Dialect, ProgramItem};
use nalgebra::Point3;
use std::io::{self, BufRead, Write};
use twin_gcode::info::{
    Counts, ProgramInfo, QUEUE_HEADING, QueueRow, SHOWN, first_lines, shown_block,
};
use twin_machine::text;
use twin_number::fixed;
use twin_number::seconds;
use twin_path::Place;

/// The key figures.
pub(super) fn key_figures(job: &mut Job<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let mut info = ProgramInfo::default();
    let path = job.path()?;
    let facts = path.facts();
    job.take(path, |element| {
        info.element(&element);
        Ok(())
    })?;
    let facts = facts.take();
    (info.name, info.lines) = (facts.name, facts.lines);
    info.duration_ns = duration(job)?;
    write_figures(job, &info, out).map_err(stdio)
}

/// Duration of the program, if it can be planned; every M function takes a cycle.
pub(super) fn duration(job: &Job<'_>) -> Result<Option<i64>, Failure> {
    let failed = |source| unreadable(job.program.path(), source);
    let setpoints = job.program.setpoints(job.conditions, None, Acknowledgement::default());
    let mut setpoints = setpoints.map_err(failed)?;
    setpoints.leave_out_cycles();
    let mut last_ns = None;
    for item in setpoints {
        match item {
            ProgramItem::Setpoint(setpoint) => last_ns = Some(setpoint.time_ns),
            ProgramItem::Diagnostic(_) => {}
            ProgramItem::Io(source) => return Err(failed(source)),
        }
    }
    Ok(last_ns)
}

fn write_figures(job: &Job<'_>, info: &ProgramInfo, out: &mut dyn Write) -> io::Result<()> {
    let program = job.program;
    let name = info.name.as_deref().filter(|name| !name.is_empty()).unwrap_or("–");
    writeln!(out, "file             {} ({})", program.path().display(), program.dialect().name())?;
    writeln!(out, "name             {name}")?;
    if info.lines > 0 {
        writeln!(out, "lines            {}", info.lines)?;
    }
    writeln!(out, "blocks           {}", info.blocks)?;
    writeln!(out, "objects          {}{}", info.objects.total(), kinds(&info.objects))?;
    writeln!(out, "switch points    {}", info.switches)?;
    let (rapid, cut) = (info.rapid_length * 1e3, info.cut_length * 1e3);
    writeln!(out, "length           {:.3} mm ({rapid:.3} rapid, {cut:.3} cut)", rapid + cut)?;
    let point = |point: Option<Point3<f64>>| {
        point.map_or("–".to_owned(), |point| {
            let [x, y, z] = [point.x, point.y, point.z].map(|value| fixed(value * 1e3, 3));
            format!("X {x}  Y {y}  Z {z} mm")
        })
    };
    writeln!(out, "start            {}", point(info.start))?;
    writeln!(out, "end              {}", point(info.end))?;
    if let Some(bounds) = &info.bounds {
        let range =
            |low: f64, high: f64| format!("{} … {}", fixed(low * 1e3, 3), fixed(high * 1e3, 3));
        let x = range(bounds.min.x, bounds.max.x);
        let y = range(bounds.min.y, bounds.max.y);
        let z = range(bounds.min.z, bounds.max.z);
        writeln!(out, "within           X {x}  Y {y}  Z {z} mm")?;
    }
    writeln!(out, "angle tolerance  {:.3} deg", job.conditions.angle_tolerance.to_degrees())?;
    writeln!(out, "dwells           {:.3} s", seconds(info.dwell_ns))?;
    match info.duration_ns {
        Some(duration_ns) => writeln!(out, "duration         {:.3} s", seconds(duration_ns))?,
        None => writeln!(out, "duration         –")?,
    }
    let rules = broken(&job.findings);
    if rules.is_empty() {
        return writeln!(out, "errors           none");
    }
    let mut heading = "errors           ";
    for (rule, severity, count, first) in rules {
        writeln!(out, "{heading}{severity} {rule}: {count}, first at {first}")?;
        heading = "                 ";
    }
    Ok(())
}

fn kinds(counts: &Counts) -> String {
    let named = [
        (counts.rapids, "rapids"),
        (counts.lines, "lines"),
        (counts.arcs, "arcs"),
        (counts.ellipses, "ellipses"),
        (counts.cubics, "splines and parabolas"),
        (counts.probes, "probing moves"),
        (counts.jumps, "jumps"),
        (counts.m_functions, "M functions"),
        (counts.dwells, "dwells"),
    ];
    let there: Vec<_> = named
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, name)| format!("{count} {name}"))
        .collect();
    if there.is_empty() { String::new() } else { format!(" ({})", there.join(", ")) }
}

/// Rules that are broken, how often, and where first.
fn broken(findings: &[Finding]) -> Vec<(&'static str, &'static str, u64, Place)> {
    let mut rules: Vec<(&str, &str, u64, Place)> = Vec::new();
    for finding in findings {
        let severity = match finding.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        let place = finding.place();
        let key = (finding.rule.name(), severity);
        match rules.iter_mut().find(|(rule, severity, ..)| (*rule, *severity) == key) {
            Some((_, _, count, first)) => {
                *count += 1;
                if place.line < first.line {
                    *first = place;
                }
            }
            None => rules.push((key.0, key.1, 1, place)),
        }
    }
    rules
}

/// The blocks as a G-code viewer shows them (`SMC_GCodeViewer`).
pub(super) fn viewer(job: &mut Job<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let program = job.program;
    if !matches!(program.dialect(), Dialect::Din66025 | Dialect::Rs274) {
        let message = "there are no blocks to show: this is not the text of a program";
        return Err(Failure::Usage(message.to_owned()));
    }
    let variables = &program.settings().variables;
    each_line(job, |number, line| match shown_block(line, |name| variables.get(name)) {
        Some(block) => writeln!(out, "{number:>6}  {block}").map_err(stdio),
        None => Ok(()),
    })
}

/// Hands on the lines of the program as far as they are text.
fn each_line(
    job: &Job<'_>,
    mut take: impl FnMut(u32, &str) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let failed = |source| unreadable(job.program.path(), source);
    let mut reader = text::lines_of(job.program.path()).map_err(failed)?;
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        let limit = u64::try_from(twin_gcode::din66025::MAX_LINE_BYTES).unwrap_or(u64::MAX);
        let read = io::Read::take(&mut reader, limit).read_until(b'\n', &mut line);
        if read.map_err(failed)? == 0 {
            return Ok(());
        }
        if line.last() != Some(&b'\n') {
            reader.skip_until(b'\n').map_err(failed)?;
        }
        take(number, &String::from_utf8_lossy(&line))?;
    }
    Ok(())
}

/// The beginnings of program and queue (`SMC_ShowCNCREF`, `SMC_ShowQueue`).
pub(super) fn listing(job: &mut Job<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let program = job.program;
    let failed = |source| unreadable(program.path(), source);
    if matches!(program.dialect(), Dialect::Din66025 | Dialect::Rs274) {
        let reader = text::lines_of(program.path()).map_err(failed)?;
        for (number, line) in (1..).zip(first_lines(reader, SHOWN).map_err(failed)?) {
            writeln!(out, "{number:>6}  {line}").map_err(stdio)?;
        }
        writeln!(out).map_err(stdio)?;
    }
    writeln!(out, "{QUEUE_HEADING}").map_err(stdio)?;
    let mut number = 0;
    job.each(|element| {
        if number < SHOWN as u64 {
            writeln!(out, "{}", QueueRow::new(number, &element)).map_err(stdio)?;
        }
        number += 1;
        Ok(())
    })?;
    writeln!(out, "{number} objects").map_err(stdio)
}
