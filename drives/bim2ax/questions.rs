//! What the manual leaves open, as a list: `tests::assumptions` holds it against the options.

use crate::OpenQuestion;

/// What the manual of the module leaves open, in the order of its digest.
pub const OPEN_QUESTIONS: [OpenQuestion; 16] = [
    OpenQuestion::new(
        15,
        "In which byte order are the module's numbers?",
        ("ModuleOptions.byte_order", "Big"),
        "little",
        "Bim2AxOptions.byte_order",
    ),
    OpenQuestion::new(
        15,
        "In which byte order does the driver read and write them?",
        ("Bim2AxOptions.byte_order", "Big"),
        "little",
        "finds a wrong one without changing anything",
    ),
    OpenQuestion::new(
        40,
        "Does an interrupt refresh all zones?",
        ("Assumptions.refreshes_all", "true"),
        "only the one asked for",
        "reads only what it has asked for",
    ),
    OpenQuestion::new(
        41,
        "Are entries that are left over written again?",
        ("Assumptions.keeps_entries", "true"),
        "forgotten once taken",
        "clears them",
    ),
    OpenQuestion::new(
        42,
        "In which order are entries taken?",
        ("Assumptions.entry_order", "Listed"),
        "by number of the zone",
        "writes zone by zone",
    ),
    OpenQuestion::new(
        44,
        "Does an interrupt need bit 0 of the interrupt status?",
        ("Assumptions.needs_status", "true"),
        "counts without it",
        "always sets it",
    ),
    OpenQuestion::new(
        44,
        "How long does an interrupt take?",
        ("ModuleOptions.interrupt_ns", "300000"),
        "any time",
        "waits Bim2AxOptions.pause between looks",
    ),
    OpenQuestion::new(
        93,
        "Does the order 0 end every move?",
        ("Assumptions.zero_ends_every_move", "false"),
        "every move, not only manual ones",
        "gives no order that would end the move of the other axis",
    ),
    OpenQuestion::new(
        93,
        "Does repeating its bit keep a manual move?",
        ("Assumptions.refuses_repeats", "false"),
        "it goes on, with message bit 14",
        "repeats it, and looks at the messages of the axis ordered",
    ),
    OpenQuestion::new(
        94,
        "What becomes of the move under way when an order is refused?",
        ("Assumptions.refusal_stops", "false"),
        "it ends",
        "says that the order was refused",
    ),
    OpenQuestion::new(
        95,
        "What does homing do on a cam that is not cleared?",
        ("Assumptions.cam_start", "EdgeTaken"),
        "crosses it to the other edge",
        "waits for the end and message bit 4",
    ),
    OpenQuestion::new(
        95,
        "What is the position after homing?",
        ("Assumptions.homing_keeps_position", "false"),
        "what it was, counted on",
        "reads it, and tells where it is not so",
    ),
    OpenQuestion::new(
        100,
        "Does abandoning a move keep homing?",
        ("Assumptions.abandon_loses_homing", "false"),
        "homing is lost",
        "reads message bit 4",
    ),
    OpenQuestion::new(
        166,
        "When does a new holding current act?",
        ("Assumptions.holding_current_at_once", "false"),
        "at once",
        "says whether a restart is needed",
    ),
    OpenQuestion::new(
        0,
        "Does the module know the order for phases on?",
        ("ModuleOptions.phases_on_order", "true"),
        "no, before revision D",
        "tests the motor instead",
    ),
    OpenQuestion::new(
        0,
        "From which difference between encoder and counter on, and how often, is a move corrected?",
        ("ModuleOptions.corrections", "Corrections { most: 3, tolerance: 2 }"),
        "any number and difference, also never",
        "shows that there was a correction, and asks for no number",
    ),
];
