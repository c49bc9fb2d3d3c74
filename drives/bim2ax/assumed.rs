//! The assumptions about the module by name.

use super::{Assumptions, CamStart, EntryOrder, OPEN_QUESTIONS};
use crate::{
    Assumed, AssumedError, OpenQuestion,
    assumed::{Said, field},
};

impl Assumed for Assumptions {
    const NAMES: &'static [&'static str] = &[
        "refreshes_all",
        "keeps_entries",
        "entry_order",
        "needs_status",
        "zero_ends_every_move",
        "refuses_repeats",
        "refusal_stops",
        "cam_start",
        "homing_keeps_position",
        "abandon_loses_homing",
        "holding_current_at_once",
    ];
    const QUESTIONS: &'static [OpenQuestion] = &OPEN_QUESTIONS;

    fn set(&mut self, name: &str, value: &str) -> Result<(), AssumedError> {
        let said = Said { name, value };
        match &*field(name) {
            "refreshes_all" => said.yes_no(&mut self.refreshes_all),
            "keeps_entries" => said.yes_no(&mut self.keeps_entries),
            "entry_order" => said.choice(
                &mut self.entry_order,
                &[("listed", EntryOrder::Listed), ("by-number", EntryOrder::ByNumber)],
            ),
            "needs_status" => said.yes_no(&mut self.needs_status),
            "zero_ends_every_move" => said.yes_no(&mut self.zero_ends_every_move),
            "refuses_repeats" => said.yes_no(&mut self.refuses_repeats),
            "refusal_stops" => said.yes_no(&mut self.refusal_stops),
            "cam_start" => said.choice(
                &mut self.cam_start,
                &[("edge-taken", CamStart::EdgeTaken), ("far-edge", CamStart::FarEdge)],
            ),
            "homing_keeps_position" => said.yes_no(&mut self.homing_keeps_position),
            "abandon_loses_homing" => said.yes_no(&mut self.abandon_loses_homing),
            "holding_current_at_once" => said.yes_no(&mut self.holding_current_at_once),
            _ => Err(AssumedError::Unknown { name: name.to_owned(), known: Self::NAMES }),
        }
    }
}
