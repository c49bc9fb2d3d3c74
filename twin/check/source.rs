//! Where the set-points of a check come from.

use super::CheckFailure;
use crate::finding::Rule;
use crate::limit::{LimitRules, Limits, Profile, ProfileItem};
use crate::m_function::Acknowledgement;
use crate::machine::Machine;
use crate::program::{ProgramFile, ProgramItem, Setpoints};

/// The set-points of a program, as the controller itself plans them or within the limits of the axes.
#[derive(Debug)]
pub(super) enum Source<'m> {
    Controller(Box<Setpoints>),
    Axes(Box<Profile<'m>>),
}

impl<'m> Source<'m> {
    pub(super) fn new(
        machine: &'m Machine,
        program: &ProgramFile,
        limits: Limits,
        rules: Acknowledgement,
    ) -> Result<Self, CheckFailure> {
        Ok(match limits {
            Limits::Softmotion => Self::Controller(Box::new(program.open(machine, rules)?)),
            Limits::Axes => {
                let profile = Profile::new(program, machine, LimitRules::default())?;
                Self::Axes(Box::new(profile.for_check(&rules)))
            }
        })
    }

    /// Bytes of the file read so far.
    pub(super) fn bytes_read(&self) -> u64 {
        match self {
            Self::Controller(setpoints) => setpoints.bytes_read(),
            Self::Axes(profile) => profile.bytes_read(),
        }
    }

    /// Path elements decoded so far.
    pub(super) fn elements(&self) -> u64 {
        match self {
            Self::Controller(setpoints) => setpoints.elements(),
            Self::Axes(profile) => profile.file().elements(),
        }
    }

    /// Length of the path decoded so far, m.
    pub(super) fn length(&self) -> f64 {
        match self {
            Self::Controller(setpoints) => setpoints.length(),
            Self::Axes(profile) => profile.file().length(),
        }
    }

    /// Diagnostics of the text that were left out because there are too many.
    pub(super) fn left_out(&self) -> u64 {
        match self {
            Self::Controller(setpoints) => setpoints.left_out(),
            Self::Axes(profile) => profile.file().left_out(),
        }
    }
}

impl Iterator for Source<'_> {
    type Item = ProgramItem;

    fn next(&mut self) -> Option<ProgramItem> {
        let profile = match self {
            Self::Controller(setpoints) => return setpoints.next(),
            Self::Axes(profile) => profile,
        };
        loop {
            match profile.next()? {
                ProfileItem::Sample(_) => {
                    if let Some(tool) = profile.tool() {
                        return Some(ProgramItem::Setpoint(*tool));
                    }
                }
                // The check finds that out itself.
                ProfileItem::Finding(finding) if finding.rule == Rule::AxisPosition => {}
                ProfileItem::Finding(finding) => return Some(ProgramItem::Diagnostic(finding)),
                ProfileItem::Io(error) => return Some(ProgramItem::Io(error)),
            }
        }
    }
}
