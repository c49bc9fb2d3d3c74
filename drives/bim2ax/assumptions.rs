//! What the manual leaves open about the module, and what is assumed instead.
//!
//! Paragraphs are those of the digest that the tests list (`drives/tests/assumptions.rs`). The byte order, which the
//! manual does not say either, is an option of its own on both sides ([`super::ByteOrder`]): it comes before all else.

/// In which order the zones are taken that the entries at $70 to $73 name, from version 15 on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryOrder {
    /// As they are listed.
    Listed,
    /// By their numbers: "Ordre UC" before the positions.
    ByNumber,
}

/// What homing does that begins on the cam, with coefficient bit 11 (no clearing).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CamStart {
    /// The edge counts as taken where the axis stands.
    EdgeTaken,
    /// The axis crosses the cam in the direction of homing; its end is the edge.
    FarEdge,
}

/// How a module corrects programmed moves after what its encoder shows. The manual says that it does, and that a message bit
/// tells "au moins une correction" (2.2.4); not when it corrects, nor how often. The emulated module behaves by it; the
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

/// What is assumed where the manual is silent. The emulated module behaves by it, and the driver expects it where it
/// matters to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "independent facts, each so or not")]
pub struct Assumptions {
    /// From version 15 on: one interrupt refreshes all zones, not only the one asked for (§2). The driver reads only what
    /// it has asked for. Default true.
    pub refreshes_all: bool,
    /// From version 15 on: entries at $70 to $73 are carried out again with every interrupt until they are cleared (§2).
    /// The driver clears them. Default true.
    pub keeps_entries: bool,
    /// In which order the zones of the entries are taken (§2). The driver writes zone by zone where that is not as
    /// listed. Default as listed.
    pub entry_order: EntryOrder,
    /// An interrupt counts only with bit 0 of the interrupt status (page 7, $01), which the driver always sets (§2).
    /// Default true.
    pub needs_status: bool,
    /// The order 0 ends every move, with ramp, not only manual ones (§4). The driver then gives no order to one axis
    /// while the other makes a move that would be ended. Default false.
    pub zero_ends_every_move: bool,
    /// The bit of a manual move that is repeated while it runs is refused as a second order, with message bit 14; the move
    /// goes on (§4). Default false.
    pub refuses_repeats: bool,
    /// An order that is refused because of the move under way ends that move, with ramp (§4). Default false.
    pub refusal_stops: bool,
    /// What homing does that begins on a cam it does not clear (§4). Default the edge is taken.
    pub cam_start: CamStart,
    /// The counter goes on counting through homing instead of being 0 at its end (§4). The driver reads it, and tells
    /// when it is not so ([`super::Fault::HomeCount`]). Default false.
    pub homing_keeps_position: bool,
    /// A move that is abandoned costs homing (§4). The driver reads message bit 4. Default false.
    pub abandon_loses_homing: bool,
    /// A holding current that is written acts at once, not after RESET as the others (§6); the phases are on at once
    /// either way. Default false.
    pub holding_current_at_once: bool,
}

impl Default for Assumptions {
    fn default() -> Self {
        Self {
            refreshes_all: true,
            keeps_entries: true,
            entry_order: EntryOrder::Listed,
            needs_status: true,
            zero_ends_every_move: false,
            refuses_repeats: false,
            refusal_stops: false,
            cam_start: CamStart::EdgeTaken,
            homing_keeps_position: false,
            abandon_loses_homing: false,
            holding_current_at_once: false,
        }
    }
}
