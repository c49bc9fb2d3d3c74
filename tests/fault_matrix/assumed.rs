//! Faults under other assumptions: points that the manuals leave open are changed in device and driver alike.

use twin_bim2ax as bim2ax;
use twin_bim2ax::ByteOrder;
use twin_drives::{Assumed, Direction, WireFault};
use twin_interpcnc as interpcnc;
use twin_smartdrive as smartdrive;
use twin_smartdrive::TagLayout;

use crate::faults::{DeviceFault, Doing, Family, Fault};

/// One thing that is otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Otherwise {
    /// Whom it is about.
    pub(crate) family: Family,
    /// The assumption, or another option of both sides.
    pub(crate) name: &'static str,
    /// The other assumption.
    pub(crate) value: &'static str,
}

/// Options that answer an open question and are none of the assumptions.
const BYTE_ORDER: &str = "byte_order";
const LAYOUT: &str = "layout";
const PHASES_ON_ORDER: &str = "phases_on_order";
/// The axis has an encoder, of which the driver knows: nothing that a manual leaves open, but a row of its own for a shaft that is
/// held.
const ENCODER: &str = "encoder";

/// Numbers that differ from the usual ones so far that they count in a cell: frames in several parts, a buffer that is
/// full, pauses that a fault may hit. Parameters for segments are those that homing has.
const INTERPCNC: [(&str, &str); 26] = [
    ("arguments_stay", "false"),
    ("lock_coil", "false"),
    ("silence", "5000"),
    ("most_read", "12"),
    ("most_written", "14"),
    ("broadcasts", "false"),
    ("locked_exception", "4"),
    ("locked_exception", "7"),
    ("busy_axis_refuses", "false"),
    ("enable_loss", "on-ramp"),
    ("enable_loss_keeps_segments", "true"),
    ("limit_stop", "on-ramp"),
    ("reversal_gap_ns", "50000000"),
    ("home_one_by_one", "true"),
    ("baud_code", "hundreds"),
    ("baud_code", "index"),
    ("line_at_restart", "false"),
    ("output_code", "number"),
    ("eeprom_write_ns", "100000000"),
    ("eeprom_refuses", "false"),
    ("exceptions_address", "7"),
    ("exceptions_value", "7"),
    ("exceptions_failure", "7"),
    ("buffer_segments", "17"),
    ("segment_acceleration", "57"),
    ("segment_start_stop", "14"),
];
/// Those of them that are about segments.
const SEGMENTS: [&str; 4] =
    ["buffer_segments", "segment_acceleration", "segment_start_stop", "enable_loss_keeps_segments"];
const SMARTDRIVE: [(&str, &str); 30] = [
    ("bad_frame", "generic"),
    ("bad_frame", "working"),
    ("bad_frame", "bad-mode"),
    ("bad_frame", "bad-params"),
    ("bad_frame", "not-available"),
    ("wrong_length", "generic"),
    ("wrong_length", "working"),
    ("wrong_length", "bad-mode"),
    ("wrong_length", "not-available"),
    ("unknown_code", "generic"),
    ("unknown_code", "working"),
    ("unknown_code", "bad-mode"),
    ("unknown_code", "bad-params"),
    ("answer_length", "as-command"),
    ("both_bits", "set"),
    ("both_bits", "clear"),
    ("silent_while_changing", "true"),
    ("refuses_beyond_ceilings", "true"),
    ("step_from", "target"),
    ("clamps_targets", "true"),
    ("limit_stop", "deceleration"),
    ("limit_stop", "at-once"),
    ("home_position", "goes-offset"),
    ("applies_words_at_once", "true"),
    ("extends_signs", "false"),
    ("acc_current", "85"),
    ("zero_rate", "unlimited"),
    ("set_effect", "with-mode"),
    ("set_effect", "restarts-mode"),
    (LAYOUT, "table"),
];
const BIM2AX: [(&str, &str); 13] = [
    ("refreshes_all", "false"),
    ("keeps_entries", "false"),
    ("entry_order", "by-number"),
    ("needs_status", "false"),
    ("zero_ends_every_move", "true"),
    ("refuses_repeats", "true"),
    ("refusal_stops", "true"),
    ("cam_start", "far-edge"),
    ("homing_keeps_position", "true"),
    ("abandon_loses_homing", "true"),
    ("holding_current_at_once", "true"),
    (BYTE_ORDER, "little"),
    (PHASES_ON_ORDER, "false"),
];

impl Otherwise {
    /// Everything that can be otherwise, one at a time.
    pub(crate) fn all() -> Vec<Self> {
        let board = INTERPCNC.into_iter().map(|(name, value)| {
            let family =
                if SEGMENTS.contains(&name) { Family::Segments } else { Family::InterpCnc };
            Self { family, name, value }
        });
        let of = |family| move |(name, value)| Self { family, name, value };
        let drives = SMARTDRIVE.into_iter().map(of(Family::SmartDrive));
        board.chain(drives).chain(BIM2AX.into_iter().map(of(Family::Bim2Ax))).collect()
    }

    /// Axes with an encoder, in the families that do not know by themselves that a shaft is held.
    pub(crate) fn encoders() -> Vec<Self> {
        [(Family::InterpCnc, "counts"), (Family::Segments, "counts"), (Family::Bim2Ax, "declared")]
            .into_iter()
            .map(|(family, value)| Self { family, name: ENCODER, value })
            .collect()
    }

    /// True if the axis has an encoder.
    pub(crate) fn has_encoder(self) -> bool {
        self.name == ENCODER
    }

    /// Faults under this assumption: a lost request, a corrupted request, a brown-out, and an axis fault that the
    /// family can report.
    pub(crate) fn faults(self) -> [Fault; 4] {
        let alarm = match self.family {
            Family::SmartDrive | Family::Pair => DeviceFault::Stall,
            Family::InterpCnc | Family::Segments | Family::Bim2Ax => DeviceFault::Alarm,
        };
        let request = |fault| Fault::Wire(Direction::Request, fault);
        [
            request(WireFault::Drop),
            request(WireFault::Corrupt { bytes: 1 }),
            Fault::Device(DeviceFault::BrownOut),
            Fault::Device(alarm),
        ]
    }

    /// True if the cell is made for this activity; homing only if the assumption concerns it.
    pub(crate) fn is_meant(self, doing: Doing) -> bool {
        if self.has_encoder() {
            // The shaft is held: not the command to home, but what comes of it.
            return doing != Doing::ToHome;
        }
        match doing {
            Doing::Idle => self.family != Family::Segments,
            Doing::Moving | Doing::Stopping => true,
            Doing::Homing => self.name.contains("hom") || self.name == "cam_start",
            _ => false,
        }
    }

    /// As the table calls it.
    pub(crate) fn name(self) -> String {
        format!("{}={}", self.name, self.value)
    }

    /// Assumes it, on one side.
    pub(crate) fn assume<A: Assumed>(self, assumptions: &mut A) {
        if ![BYTE_ORDER, LAYOUT, PHASES_ON_ORDER, ENCODER].contains(&self.name) {
            assumptions.set(self.name, self.value).expect("it can be so");
        }
    }

    pub(crate) fn byte_order(self) -> ByteOrder {
        if self.name == BYTE_ORDER { ByteOrder::Little } else { ByteOrder::Big }
    }

    /// The seed with which the byte that is spoilt is again that of the target of least weight, where that is another
    /// one: rest 2 of 30.
    pub(crate) fn seed(self, fault: Fault, doing: Doing) -> Option<u64> {
        let spoilt = Fault::Wire(Direction::Request, WireFault::Corrupt { bytes: 1 });
        (self.name == BYTE_ORDER && fault == spoilt && doing == Doing::Idle).then_some(52)
    }

    /// True if the driver reads the other axis before it gives an order.
    pub(crate) fn looks_at_the_others(self) -> bool {
        (self.name, self.value) == ("zero_ends_every_move", "true")
    }

    pub(crate) fn layout(self) -> TagLayout {
        if self.name == LAYOUT { TagLayout::Table } else { TagLayout::Diagram }
    }

    pub(crate) fn phases_on_order(self) -> bool {
        self.name != PHASES_ON_ORDER
    }
}

/// Each name has an alternative, which is none of what is usual; each choice has all of them.
fn check<A: Assumed + PartialEq + std::fmt::Debug>(listed: &[(&str, &str)]) {
    for name in A::NAMES {
        let values: Vec<_> = listed.iter().filter(|(of, _)| of == name).collect();
        assert!(!values.is_empty(), "{name} has no cell");
        for (_, value) in &values {
            let mut assumptions = A::default();
            assumptions.set(name, value).expect("it can be so");
            assert_ne!(assumptions, A::default(), "{name} = {value} is usual");
        }
        let allowed = A::values(name).expect("it can be something").allowed;
        for choice in allowed.split(" or ").filter(|_| !allowed.contains(" to ")) {
            let mut assumptions = A::default();
            assumptions.set(name, choice).expect("it is allowed");
            let there = values.iter().any(|(_, value)| *value == choice);
            assert!(there || assumptions == A::default(), "{name} = {choice} has no cell");
        }
    }
}

#[test]
fn every_alternative_of_every_assumption_has_its_cells() {
    check::<interpcnc::Assumptions>(&INTERPCNC);
    check::<smartdrive::Assumptions>(&SMARTDRIVE);
    check::<bim2ax::Assumptions>(&BIM2AX);
}
