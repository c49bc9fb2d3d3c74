//! Feed rewriting: the program with F words that the axes can follow.

use super::Failure;
use crate::command::atomic_file::{AtomicFile, unwritable};
use crate::command::options::unreadable;
use crate::program::{Dialect, ProgramFile};
use std::io::{self, Read, Write};
use std::path::Path;
use twin_gcode::refeed::{LineLimit, Refed, RefeedError, Unrepaired};
use twin_gcode::{din66025, rs274};
use twin_machine::Machine;
use twin_machine::text;

/// Only programs have F words.
pub(super) fn check_dialect(program: &ProgramFile) -> Result<(), Failure> {
    match program.dialect() {
        Dialect::Din66025 | Dialect::Rs274 => Ok(()),
        Dialect::Job | Dialect::Dxf => {
            Err(Failure::Usage(format!("{} has no F words", program.path().display())))
        }
    }
}

pub(super) fn write(
    program: &ProgramFile,
    machine: &Machine,
    limits: &[LineLimit],
    target: &Path,
) -> Result<Refed, Failure> {
    let failed = |error| unreadable(program.path(), error);
    let lines = || text::lines_of(program.path()).map_err(failed);
    let mut out = AtomicFile::create(target)?;
    let limits = limits.iter().copied().map(Ok);
    let refed = if program.dialect() == Dialect::Rs274 {
        let options = program.rs274_options(&machine.conditions);
        let once = rs274::refeed(lines()?, &options, [], io::sink());
        if matches!(once, Err(RefeedError::Repeated(_))) {
            let mut whole = Vec::new();
            lines()?.read_to_end(&mut whole).map_err(failed)?;
            rs274::refeed_repeated(&whole, &options, limits, &mut out)
        } else {
            rs274::refeed(lines()?, &options, limits, &mut out)
        }
    } else {
        let options = program.din66025_options(&machine.conditions);
        din66025::refeed(lines()?, &options, limits, &mut out)
    };
    let refed = refed.map_err(|error| match error {
        RefeedError::Read(source) => unreadable(program.path(), source),
        RefeedError::Write(source) => unwritable(target, source),
        error => Failure::Usage(error.to_string()),
    })?;
    out.finish()?;
    Ok(refed)
}

/// Reports that no program was written: other feeds do not make an unfit program fit for the machine.
pub(super) fn tell_none(target: &Path) -> io::Result<()> {
    writeln!(
        io::stderr().lock(),
        "{}: not written; no feed makes the program fit for the machine",
        target.display()
    )
}

/// Reports the changes of the F words.
pub(super) fn tell(refed: &Refed, target: &Path) -> io::Result<()> {
    let mut out = io::stderr().lock();
    let Refed { lines, changed, lowered, .. } = refed;
    writeln!(
        out,
        "{}: F is too fast on {lowered} of {lines} lines; F changed in {changed} lines, E unchanged (run the program with --limits axes to keep the accelerations too)",
        target.display()
    )?;
    let left = refed.unrepaired.len() as u64 + refed.unrepaired_left_out;
    if left > 0 {
        writeln!(out, "{left} lines stay too fast, because no F governs them:")?;
        for line in refed.unrepaired.iter().take(10) {
            let Unrepaired { place, reason, programmed, limit } = line;
            writeln!(
                out,
                "  {place}: {:.1} mm/s, the machine allows {:.1} mm/s; {reason}",
                programmed * 1e3,
                limit * 1e3
            )?;
        }
    }
    Ok(())
}
