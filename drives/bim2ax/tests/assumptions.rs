//! Driver and module with what the manual leaves open done in every way that is known.

use super::*;
use crate::Fault;
use crate::tests::common::fault_of;
use crate::{Assumptions, CamStart, EntryOrder, protocol::bits::message};
use twin_drives::{Axes, DriveError};

/// A rig whose driver assumes `driver` of a module that does as `module`.
async fn rig(module: Assumptions, driver: Assumptions) -> Rig {
    let module = ModuleOptions { assumptions: module, ..ModuleOptions::default() };
    let options = Bim2AxOptions { assumptions: driver, ..Bim2AxOptions::default() };
    Rig::new(&module, &options, &eeprom(), &surroundings()).await
}

/// Every alternative, one at a time.
fn alternatives() -> [Assumptions; 12] {
    let usual = Assumptions::default();
    [
        usual,
        Assumptions { refreshes_all: false, ..usual },
        Assumptions { keeps_entries: false, ..usual },
        Assumptions { entry_order: EntryOrder::ByNumber, ..usual },
        Assumptions { needs_status: false, ..usual },
        Assumptions { zero_ends_every_move: true, ..usual },
        Assumptions { refuses_repeats: true, ..usual },
        Assumptions { refusal_stops: true, ..usual },
        Assumptions { cam_start: CamStart::FarEdge, ..usual },
        Assumptions { homing_keeps_position: true, ..usual },
        Assumptions { abandon_loses_homing: true, ..usual },
        Assumptions { holding_current_at_once: true, ..usual },
    ]
}

#[tokio::test(start_paused = true)]
async fn the_driver_copes_with_every_alternative() {
    for assumed in alternatives() {
        let mut rig = rig(assumed, assumed).await;
        rig.set(AxisParameter::HoldingCurrent, 300).await;
        rig.driver.home(&BOTH, &clock()).await.unwrap();
        let seen = rig.rest().await;
        // The edge of the cam is at −400.
        let home = if assumed.homing_keeps_position { -400 } else { 0 };
        assert_eq!(seen.positions, [home; 2], "{assumed:?}");
        assert!(seen.messages.iter().all(|word| word & message::HOMED != 0), "{assumed:?}");
        for to in [[200, -100], [-30, 400]] {
            assert_eq!(rig.go(to.map(Some)).await.positions, to, "{assumed:?}");
        }
        rig.start([Some(2000), None]).await;
        sleep(Duration::from_millis(100)).await;
        rig.driver.abandon(&clock()).await.unwrap();
        let seen = rig.rest().await;
        assert!(seen.positions[0] < 2000, "{assumed:?}");
        let homed = seen.messages[0] & message::HOMED != 0;
        assert_eq!(homed, !assumed.abandon_loses_homing, "{assumed:?}");
    }
}

#[tokio::test(start_paused = true)]
async fn zones_taken_by_number_are_written_one_by_one() {
    let by_number = Assumptions { entry_order: EntryOrder::ByNumber, ..Assumptions::default() };
    for (of_driver, works) in [(by_number, true), (Assumptions::default(), false)] {
        let mut rig = rig(by_number, of_driver).await;
        let started = rig.driver.start([300, -300].map(|to| Some(Start::to(to))), &clock()).await;
        // Taken before its targets, the order goes to what was there.
        assert_eq!(rig.rest().await.positions, if works { [300, -300] } else { [0, 0] });
        let refused = matches!(fault_of(&started), Some(Fault::AxisMessages { .. }));
        assert_eq!(refused, !works, "{started:?}");
    }
}

#[tokio::test(start_paused = true)]
async fn an_order_does_not_end_the_move_of_the_other_axis_unasked() {
    let ends = Assumptions { zero_ends_every_move: true, ..Assumptions::default() };
    for (of_driver, position) in [(ends, 2500), (Assumptions::default(), 0)] {
        let mut rig = rig(ends, of_driver).await;
        rig.start([Some(2500), None]).await;
        sleep(Duration::from_millis(100)).await;
        let other = rig.driver.start([None, Some(Start::to(50))], &clock()).await;
        let seen = rig.rest().await;
        if position > 0 {
            let moving = matches!(other, Err(DriveError::Moving { axes: Axes::Numbers(1), .. }));
            assert!(moving, "{other:?}");
            assert_eq!(seen.positions, [position, 0]);
            rig.start([None, Some(50)]).await;
        } else {
            other.unwrap();
            assert!(seen.positions[0] < 1000, "{seen:?}");
        }
        assert_eq!(rig.rest().await.positions[1], 50);
    }
}

#[tokio::test(start_paused = true)]
async fn the_holding_current_acts_after_reset_or_at_once() {
    for holding_current_at_once in [false, true] {
        let assumed = Assumptions { holding_current_at_once, ..Assumptions::default() };
        let mut rig = rig(assumed, assumed).await;
        assert_eq!(rig.module.module().current_ma(ModuleAxis::One), 0);
        rig.set(AxisParameter::HoldingCurrent, 123).await;
        // Phases are on either way; a quarter of 2 A from the factory.
        let expected = if holding_current_at_once { 123 } else { 500 };
        assert_eq!(rig.module.module().current_ma(ModuleAxis::One), expected);
    }
}

#[test]
fn an_interrupt_may_count_without_its_status() {
    for needs_status in [true, false] {
        let assumptions = Assumptions { needs_status, ..Assumptions::default() };
        let options = ModuleOptions { assumptions, boot_ns: 0, ..ModuleOptions::default() };
        let mut module = Module::new(&options, &eeprom(), &surroundings());
        module.advance(1_000_000);
        // Asks for zone 1 with $01 at 0.
        write(&mut module, &[(0xFD, 7), (0x00, 0xF1), (0x01, 0), (0x7F, 1)]);
        module.advance(2_000_000);
        module.bus_write(0xFD, 6);
        assert_eq!(module.bus_read(0), u8::from(!needs_status));
    }
}
