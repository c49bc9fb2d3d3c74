//! Message bits in words.

use super::bits::{card, encoder_message, message};

/// Message bits of an axis in words, without those of an axis in order, but with homing.
pub fn describe_messages(messages: u16) -> String {
    let known = [
        (message::PLUS_SWITCH, "on the + end switch"),
        (message::MINUS_SWITCH, "on the - end switch"),
        (message::PLUS_LIMIT, "at the + soft limit"),
        (message::MINUS_LIMIT, "at the - soft limit"),
        (message::HARD_STOPPED, "stopped hard"),
        (message::PHASES_OFF, "phases off"),
        (message::PHASE_OPEN, "phase open"),
        (message::PHASE_SHORT, "short circuit between phases"),
        (message::POWER_ABSENT, "power absent"),
        (message::REFUSED, "order during a move, or two orders at a time"),
        (message::MOVING, "moving"),
    ];
    let mut said: Vec<&str> = words(&known, |bit| messages & bit != 0);
    if messages & message::HOMED == 0 {
        said.push("homing not done");
    }
    if said.is_empty() { "not obeyed".to_owned() } else { said.join(", ") }
}

/// What the fault bits of "Message codeur" say (2.2.4).
pub(crate) fn describe_encoder(messages: u16) -> String {
    let known = [
        (encoder_message::DIVISOR_ZERO, "its divisor is 0"),
        (
            encoder_message::FAULT,
            "fault: a channel is missing, it does not answer, or its parity or CRC is wrong",
        ),
        (encoder_message::ALARM, "it has set its alarm bit"),
        (encoder_message::PLUG, "the plug is gone or badly programmed"),
    ];
    let mut said = words(&known, |bit| messages & bit != 0);
    let kinds = encoder_message::ENDAT | encoder_message::SSI | encoder_message::INCREMENTAL;
    if messages & kinds == 0 {
        said.insert(0, "the module does not recognise any");
    }
    if said.is_empty() { "no fault".to_owned() } else { said.join(", ") }
}

/// What the error bits of "Messages carte" say.
pub(crate) fn describe_card(messages: u32) -> String {
    let known = [
        (card::CHECKSUM, "check sum of the EEPROM is wrong"),
        (card::BAD_WRITE, "parameter cannot be written, or not with this value"),
        (card::BAD_READ, "no such parameter or plug"),
        (card::MOVING, "an axis moves"),
        (card::BAD_ORDER, "no such parameter order"),
    ];
    let said = words(&known, |bit| messages & bit != 0);
    if said.is_empty() { "not obeyed".to_owned() } else { said.join(", ") }
}

fn words<T: Copy>(known: &[(T, &'static str)], set: impl Fn(T) -> bool) -> Vec<&'static str> {
    known.iter().filter(|(bit, _)| set(*bit)).map(|(_, word)| *word).collect()
}
