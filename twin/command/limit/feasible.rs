//! The program with feeds that the axes can follow.

use super::{Failure, unwritable};
use crate::command::options::unreadable;
use crate::machine::Machine;
use crate::program::{Dialect, ProgramFile};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Write};
use std::path::Path;
use twin_motion::refeed::{LineLimit, Refed, RefeedError, Unrepaired};
use twin_motion::{din66025, rs274};

/// A program is not written over itself or over one of the `others`, and only programs have F words.
pub(super) fn check_target<'p>(
    program: &ProgramFile,
    target: &Path,
    others: impl Iterator<Item = &'p Path>,
) -> Result<(), Failure> {
    match program.dialect() {
        Dialect::Din66025 | Dialect::Rs274 => {}
        Dialect::Queue | Dialect::Dxf => {
            return Err(Failure::Usage(format!("{} has no F words", program.path().display())));
        }
    }
    let known = |path: &Path| std::fs::canonicalize(path).ok();
    let is_target = |path: &Path| {
        path == target || known(target).is_some_and(|target| Some(target) == known(path))
    };
    let wrong = if is_target(program.path()) {
        "this is the program itself"
    } else if others.into_iter().any(is_target) {
        "something else is read from or written to it"
    } else {
        let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
        if folder.is_some_and(|folder| !folder.is_dir()) {
            let source = io::Error::from(io::ErrorKind::NotFound);
            return Err(unwritable(target, source));
        }
        return Ok(());
    };
    Err(Failure::Usage(format!("--feasible {}: {wrong}; name another file", target.display())))
}

pub(super) fn write(
    program: &ProgramFile,
    machine: &Machine,
    limits: Vec<LineLimit>,
    target: &Path,
) -> Result<Refed, Failure> {
    let source = File::open(program.path()).map_err(|error| unreadable(program.path(), error))?;
    let reader = BufReader::new(source);
    let file = File::create(target).map_err(|source| unwritable(target, source))?;
    let mut out = BufWriter::new(file);
    let limits = limits.into_iter().map(Ok);
    let refed = if program.dialect() == Dialect::Rs274 {
        let options = program.rs274_options(&machine.conditions);
        rs274::refeed(reader, &options, limits, &mut out)
    } else {
        let options = program.din66025_options(&machine.conditions);
        din66025::refeed(reader, &options, limits, &mut out)
    };
    let refed = refed.map_err(|error| match error {
        RefeedError::Read(source) => unreadable(program.path(), source),
        RefeedError::Write(source) => unwritable(target, source),
        error => Failure::Usage(error.to_string()),
    })?;
    out.flush().map_err(|source| unwritable(target, source))?;
    Ok(refed)
}

/// What is not fit for the machine is not made so by other feeds.
pub(super) fn tell_none(target: &Path) -> io::Result<()> {
    writeln!(
        io::stderr().lock(),
        "{}: not written; no feed makes the program fit for the machine",
        target.display()
    )
}

/// What became of the F words.
pub(super) fn tell(refed: &Refed, target: &Path) -> io::Result<()> {
    let mut out = io::stderr().lock();
    let Refed { lines, changed, lowered, .. } = refed;
    writeln!(
        out,
        "{}: {lowered} of {lines} lines are slower than programmed, F changed in {changed}; for --limits axes",
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
