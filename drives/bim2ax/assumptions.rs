//! Assumptions about the module where the manual is silent.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`). The byte order, which the
//! manual does not say either, is an option of its own on both sides ([`super::ByteOrder`]): it comes before all else.

use twin_drives::assumptions::{Choice, FLAG, assumptions};

/// In which order the zones are taken that the entries at $70 to $73 name, from version 15 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryOrder {
    /// As they are listed.
    Listed,
    /// By their numbers: "Ordre UC" before the positions.
    ByNumber,
}

/// First leg of homing that begins on the cam, with coefficient bit 11 (no clearing).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CamStart {
    /// The edge counts as taken where the axis is.
    EdgeTaken,
    /// The axis crosses the cam in the direction of homing; its end is the edge.
    FarEdge,
}

/// Correction of programmed moves by the encoder. The manual says that there is one, and that a message bit
/// shows "au moins une correction" (2.2.4); not when it corrects, nor how often. The emulated module behaves by it; the
/// driver asks for neither number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corrections {
    /// Corrections of one move, at most. Nothing in the manual; default 3.
    pub most: u8,
    /// µsteps by which encoder and counter may differ uncorrected: 3.1.15 has "1 ou 2 pas" for rounding alone. Default 2.
    pub tolerance: u16,
}

impl Default for Corrections {
    fn default() -> Self {
        Self { most: 3, tolerance: 2 }
    }
}

assumptions! {
    /// Assumptions where the manual is silent. The emulated device behaves by them, and the client expects them where it
    /// matters to it.
    pub struct Assumptions {
        refreshes_all: bool = true, FLAG,
            (40, "Does an interrupt refresh all zones?",
                "only the one asked for", "reads only what it has asked for");
        keeps_entries: bool = true, FLAG,
            (41, "Are entries that are left over written again?",
                "forgotten once taken", "clears them");
        entry_order: EntryOrder = EntryOrder::Listed,
            Choice(&[("listed", EntryOrder::Listed), ("by-number", EntryOrder::ByNumber)]),
            (42, "In which order are entries taken?",
                "by number of the zone", "writes zone by zone");
        needs_status: bool = true, FLAG,
            (44, "Does an interrupt need bit 0 of the interrupt status?",
                "counts without it", "always sets it");
        zero_ends_every_move: bool = false, FLAG,
            (93, "Does the order 0 end every move?",
                "every move, not only manual ones", "gives no order that would end the move of the other axis");
        refuses_repeats: bool = false, FLAG,
            (93, "Does repeating its bit keep a manual move?",
                "it goes on, with message bit 14", "gives no manual move");
        refusal_stops: bool = false, FLAG,
            (94, "What becomes of the move under way when an order is refused?",
                "it ends", "says that the order was refused");
        cam_start: CamStart = CamStart::EdgeTaken,
            Choice(&[("edge-taken", CamStart::EdgeTaken), ("far-edge", CamStart::FarEdge)]),
            (95, "What does homing do on a cam that is not cleared?",
                "crosses it to the other edge", "waits for the end and message bit 4");
        homing_keeps_position: bool = false, FLAG,
            (95, "What is the position after homing?",
                "what it was, counted on", "reads it, and tells where it is not so");
        abandon_loses_homing: bool = false, FLAG,
            (100, "Does abandoning a move keep homing?",
                "homing is lost", "reads message bit 4");
        holding_current_at_once: bool = false, FLAG,
            (166, "When does a new holding current act?",
                "at once", "says whether a restart is needed");
    }
    others {
        "ModuleOptions.byte_order" = "Big",
            (15, "In which byte order are the module's numbers?",
                "little", "Bim2AxOptions.byte_order");
        "Bim2AxOptions.byte_order" = "Big",
            (15, "In which byte order does the driver read and write them?",
                "little", "finds a wrong one without changing anything");
        "ModuleOptions.interrupt_ns" = "300000",
            (44, "How long does an interrupt take?",
                "any time", "waits Bim2AxOptions.pause between looks");
        "ModuleOptions.phases_on_order" = "true",
            (0, "Does the module know the order for phases on?",
                "no, before revision D", "tests the motor instead");
        "ModuleOptions.corrections" = "Corrections { most: 3, tolerance: 2 }",
            (0, "From which difference between encoder and counter on, and how often, is a move corrected?",
                "any number and difference, also never", "shows that there was a correction, and asks for no number");
    }
}
