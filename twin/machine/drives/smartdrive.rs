//! `[[drives]]` entry of a SmartDRIVE bus.

use super::{Abilities, assumptions, microseconds};
use crate::section::Section;
use twin_smartdrive::{Assumptions, StepsPerTurn};

/// Entry of the drives on a bus, which are alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SmartDriveEntry {
    /// µsteps of a turn of the motor: full steps (parameter 43) times divisor (44).
    pub turn: StepsPerTurn,
    /// Parameter 43.
    pub full_steps: u16,
    /// Parameter 44.
    pub microsteps: u16,
    /// Acceleration of their ramps, rpm/s; at most parameter 31.
    pub acceleration_rpm_per_s: u16,
    /// Deceleration, rpm/s, at most parameter 32; 0: as the acceleration.
    pub deceleration_rpm_per_s: u16,
    /// Assumptions where the manual is silent.
    pub assumptions: Assumptions,
    /// Time an emulated drive takes to answer, µs.
    pub response_us: u32,
}

impl SmartDriveEntry {
    /// Speeds are whole turns per minute; a quarter of the largest is one, too.
    pub(super) fn abilities(&self) -> Abilities {
        let speeds = self.turn.steps(4.0)..=self.turn.steps(f64::from(i16::MAX));
        Abilities { speeds, counts: f64::from(i32::MAX) }
    }
}

pub(super) fn read(section: &Section<'_>) -> Option<SmartDriveEntry> {
    let full_steps = section.integer("full_steps_per_turn", 1..=32_767).unwrap_or(200);
    let divisor = section.integer("microsteps", 1..=1024).unwrap_or(16);
    let acceleration = section.integer("acceleration_rpm_per_s", 1..=32_767).unwrap_or(30_000);
    let deceleration = section.integer("deceleration_rpm_per_s", 0..=32_767).unwrap_or(0);
    let response_us = microseconds(section, "emulated_turnaround_ms", 2.0);
    let [full_steps, microsteps] = [full_steps, divisor].map(u16::try_from);
    let (full_steps, microsteps) = (full_steps.ok()?, microsteps.ok()?);
    let turn = StepsPerTurn::new(full_steps, microsteps);
    if turn.is_none() {
        let message = format!("`microsteps` is {divisor}; a step has 1, 2, 4, … or 1024");
        section.complain_at("microsteps", message);
    }
    Some(SmartDriveEntry {
        turn: turn?,
        full_steps,
        microsteps,
        acceleration_rpm_per_s: u16::try_from(acceleration).ok()?,
        deceleration_rpm_per_s: u16::try_from(deceleration).ok()?,
        assumptions: assumptions(section),
        response_us,
    })
}
