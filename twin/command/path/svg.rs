//! Picture of a path as SVG.

use super::Job;
use super::output::stdio;
use super::picture::Picture;
use crate::command::Failure;
use crate::command::options::unreadable;
use crate::m_function::Acknowledgement;
use crate::program::ProgramItem;
use std::io::Write;
use twin_gcode::info::ProgramInfo;
use twin_number::seconds;

/// Between the crosses that show where the tool is, ns (manual 3.5).
const CROSSES_NS: i64 = 100_000_000;

/// More crosses than this hide the path, so there are none.
const MOST_CROSSES: i64 = 3000;

/// Draws the path, and what it was before if it is prepared.
pub(super) fn picture(job: &mut Job<'_>, out: &mut dyn Write) -> Result<(), Failure> {
    let (program, conditions) = (job.program, job.conditions);
    let failed = |source| unreadable(program.path(), source);
    // The frame of the picture comes first, so the path is gone through once more.
    let mut info = ProgramInfo::default();
    job.each(|element| {
        info.element(&element);
        Ok(())
    })?;
    let findings = std::mem::take(&mut job.findings);
    if job.prepare {
        let before = program.elements(conditions).map_err(failed)?;
        job.take(before, |element| {
            info.element(&element);
            Ok(())
        })?;
    }
    let mut picture = Picture::new(out, info.bounds, job.name);
    if job.prepare {
        let before = program.elements(conditions).map_err(failed)?;
        job.take(before, |element| picture.before(&element).map_err(stdio))?;
    }
    job.each(|element| picture.element(&element).map_err(stdio))?;
    let duration_ns = if job.prepare { super::info::duration(job)?.unwrap_or(0) } else { 0 };
    if duration_ns > MOST_CROSSES * CROSSES_NS {
        stderr!("no crosses every 100 ms: the program takes {:.0} s", seconds(duration_ns));
    } else if job.prepare {
        let setpoints = program.setpoints(conditions, None, Acknowledgement::default());
        let mut next_ns = 0;
        for item in setpoints.map_err(failed)? {
            match item {
                ProgramItem::Setpoint(setpoint) if setpoint.time_ns >= next_ns => {
                    next_ns = setpoint.time_ns + CROSSES_NS;
                    picture.cross(&setpoint.position).map_err(stdio)?;
                }
                ProgramItem::Setpoint(_) | ProgramItem::Diagnostic(_) => {}
                ProgramItem::Io(source) => return Err(failed(source)),
            }
        }
    }
    // Each way through the path has found the same.
    job.findings = findings;
    picture.finish().map_err(stdio)?;
    Ok(())
}
