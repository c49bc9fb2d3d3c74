//! Runs on real drives whose wires lose answers, carry too little, or whose devices do not do what they confirm.

use crate::desk::{Desk, number};
use crate::shop::Shop;
use twin_bim2ax::emulator as module;
use twin_drives::{Control, Direction, FaultRule, When, WireFault};
use twin_interpcnc::emulator as board;
use twin_smartdrive::emulator as bus;

/// Ten seconds on the way.
const WAY: &str = "% way\nN10 G1 X100 Y50 Z-10 U30 F10 E300 E-300\n";

#[test]
fn lost_answers_cost_an_exchange_and_not_the_run() {
    let shop = Shop::new();
    shop.desk.write("long.cnc", WAY);
    let done = shop.disturbed("-CONT", |_| {
        let (direction, when) = (Direction::Answer, When::Next(1));
        let rule = FaultRule { direction, when, fault: WireFault::Drop };
        shop.board.control(Control::Fault(rule)).expect("it runs");
        let bus = shop.bus.borrow();
        bus.as_ref().expect("it is there").control(Control::Fault(rule)).expect("it runs");
        shop.module.control(Control::Fault(rule));
    });
    done.ended(0, "").says(", 1 lost answer asked for again");
    let report = shop.desk.read("run.json");
    for device in ["board", "bus", "module"] {
        let heard = &report["drive_samples"]["devices"][device];
        assert!(number(&heard["lost_answers"]) >= 1.0, "{device}: {heard}");
        // The deadline of the machine file's two seconds has passed once.
        assert!(number(&heard["longest_gap_ms"]) >= 2000.0, "{device}: {heard}");
    }
    for axis in ["X", "Y", "Z", "U"] {
        assert!(number(&report["axis_error"][axis]["drives"]["max"]) > 0.0, "{axis}");
    }
    let ends = shop.at_rest().map(|found| found.expect("it is there"));
    for (end, due) in ends.into_iter().zip([100.0, 50.0, -10.0, 30.0]) {
        // The zero of Z is where the program begins, at −40.
        assert!((end - due).abs() < 0.02 || (end - due - 40.0).abs() < 0.02, "{end} {due}");
    }
}

#[test]
fn ten_lost_answers_in_a_row_end_the_run_with_the_cause() {
    let shop = Shop::new();
    shop.desk.write("long.cnc", WAY);
    let done = shop.disturbed("-CONT", |_| {
        let (direction, when) = (Direction::Answer, When::Always);
        let rule = FaultRule { direction, when, fault: WireFault::WrongCheck };
        shop.board.control(Control::Fault(rule)).expect("it runs");
    });
    done.ended(2, "the drives failed at line");
    done.ended(2, "the answer is garbled, ");
    done.ended(2, " times in a row");
}

#[test]
fn a_move_without_effect_is_repeated_and_then_stops_the_run() {
    for device in ["board", "bus", "module"] {
        let shop = Shop::new();
        shop.desk.write("long.cnc", WAY);
        let done = shop.disturbed("-CONT", |_| match device {
            "board" => shop.board.happen(board::Event::IgnoreMoves(u32::MAX)).expect("it runs"),
            "bus" => {
                let bus = shop.bus.borrow();
                let event = bus::Event::IgnoreMoves(u32::MAX).to(0);
                bus.as_ref().expect("it is there").control(event).expect("it runs");
            }
            _ => shop.module.module().happen(module::Event::IgnoreMoves(u32::MAX)),
        });
        done.ended(2, "two moves were confirmed and had no effect");
        done.ended(2, &format!("device `{device}`, ax"));
        shop.at_rest();
    }
}

/// 3 · (35 bytes of 10 bits at 4800 baud, two silences of 3.5 characters of 11 bits) and 37 bytes for the sample: 0.36 s.
#[test]
fn a_wire_that_is_too_slow_is_refused_before_anything_moves() {
    let desk = Desk::new();
    let text = desk.text("machine.toml");
    let slow = text.replace("kind = \"interpcnc\"", "kind = \"interpcnc\"\nbaud = 4800");
    assert_ne!(slow, text);
    desk.write("slow.toml", &slow);
    desk.write("way.cnc", "% way\nN10 G1 X10 Y5 F5 E50 E-50\n");
    let done = desk.twin("run way.cnc -m slow.toml");
    done.ended(2, "✗ device `board`: a round of its 3 axes takes");
    done.ended(2, "it carries 2.");
    done.ended(2, "commands per second for each axis; at least 4.0 are necessary");
    done.ended(2, "nothing has moved");
}
