//! Driver and module with what the manual leaves open done in every way that is known.

use super::*;
use crate::Fault;
use crate::tests::common::fault_of;
use crate::{Assumptions, CamStart, EntryOrder, Start, protocol::bits::message};
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
        let clock = &clock();
        let driver = &mut rig.driver;
        driver.set_parameter(axis_1(AxisParameter::HoldingCurrent), 300, clock).await.unwrap();
        driver.home(&BOTH, clock).await.unwrap();
        let (seen, _) = driver.rested(seconds(20), clock).await.unwrap();
        // The edge of the cam is at −400.
        let home = if assumed.homing_keeps_position { -400 } else { 0 };
        assert_eq!(seen.positions, [home; 2], "{assumed:?}");
        assert!(seen.messages.iter().all(|word| word & message::HOMED != 0), "{assumed:?}");
        for to in [[200, -100], [-30, 400]] {
            driver.start(to.map(|to| Some(Start::to(to))), clock).await.unwrap();
            let (seen, _) = driver.rested(seconds(5), clock).await.unwrap();
            assert_eq!(seen.positions, to, "{assumed:?}");
        }
        driver.start([Some(Start::to(2000)), None], clock).await.unwrap();
        sleep(Duration::from_millis(100)).await;
        driver.abandon(clock).await.unwrap();
        let (seen, _) = driver.rested(seconds(5), clock).await.unwrap();
        assert!(seen.positions[0] < 2000, "{assumed:?}");
        let homed = seen.messages[0] & message::HOMED != 0;
        assert_eq!(homed, !assumed.abandon_loses_homing, "{assumed:?}");
    }
}

fn axis_1(parameter: AxisParameter) -> Parameter {
    Parameter::Axis(parameter, ModuleAxis::One)
}

#[tokio::test(start_paused = true)]
async fn zones_taken_by_number_are_written_one_by_one() {
    let by_number = Assumptions { entry_order: EntryOrder::ByNumber, ..Assumptions::default() };
    for (of_driver, works) in [(by_number, true), (Assumptions::default(), false)] {
        let mut rig = rig(by_number, of_driver).await;
        let clock = &clock();
        let started = rig.driver.start([Some(Start::to(300)), Some(Start::to(-300))], clock).await;
        let (seen, _) = rig.driver.rested(seconds(5), clock).await.unwrap();
        // Taken before its targets, the order goes to what was there.
        assert_eq!(seen.positions, if works { [300, -300] } else { [0, 0] });
        assert_eq!(
            matches!(fault_of(&started), Some(Fault::AxisMessages { .. })),
            !works,
            "{started:?}"
        );
    }
}

#[tokio::test(start_paused = true)]
async fn an_order_does_not_end_the_move_of_the_other_axis_unasked() {
    let ends = Assumptions { zero_ends_every_move: true, ..Assumptions::default() };
    for (of_driver, position) in [(ends, 2500), (Assumptions::default(), 0)] {
        let mut rig = rig(ends, of_driver).await;
        let clock = &clock();
        rig.driver.start([Some(Start::to(2500)), None], clock).await.unwrap();
        sleep(Duration::from_millis(100)).await;
        let other = rig.driver.start([None, Some(Start::to(50))], clock).await;
        let (seen, _) = rig.driver.rested(seconds(5), clock).await.unwrap();
        if position > 0 {
            assert!(
                matches!(other, Err(DriveError::Moving { axes: Axes::Numbers(1), .. })),
                "{other:?}"
            );
            assert_eq!(seen.positions, [position, 0]);
            rig.driver.start([None, Some(Start::to(50))], clock).await.unwrap();
        } else {
            other.unwrap();
            assert!(seen.positions[0] < 1000, "{seen:?}");
        }
        let (seen, _) = rig.driver.rested(seconds(5), clock).await.unwrap();
        assert_eq!(seen.positions[1], 50);
    }
}

#[tokio::test(start_paused = true)]
async fn a_refused_order_may_end_the_move() {
    for refusal_stops in [false, true] {
        let assumed = Assumptions { refusal_stops, ..Assumptions::default() };
        let mut rig = rig(assumed, assumed).await;
        let clock = &clock();
        rig.driver.start([Some(Start::to(2000)), None], clock).await.unwrap();
        sleep(Duration::from_millis(50)).await;
        drop(rig.driver.start([Some(Start::to(5)), None], clock).await);
        let (seen, _) = rig.driver.rested(seconds(5), clock).await.unwrap();
        assert_eq!(seen.positions[0] < 2000, refusal_stops, "{seen:?}");
        assert_ne!(seen.messages[0] & message::REFUSED, 0);
    }
}

#[tokio::test(start_paused = true)]
async fn the_holding_current_acts_after_reset_or_at_once() {
    for holding_current_at_once in [false, true] {
        let assumed = Assumptions { holding_current_at_once, ..Assumptions::default() };
        let mut rig = rig(assumed, assumed).await;
        let before = rig.module.module().current_ma(ModuleAxis::One);
        let holding = axis_1(AxisParameter::HoldingCurrent);
        rig.driver.set_parameter(holding, 123, &clock()).await.unwrap();
        // Phases are on either way; a quarter of 2 A from the factory.
        assert_eq!(before, 0);
        let expected = if holding_current_at_once { 123 } else { 500 };
        assert_eq!(rig.module.module().current_ma(ModuleAxis::One), expected);
    }
}

#[tokio::test(start_paused = true)]
async fn homing_that_begins_on_a_cam_ends_on_one_of_its_edges() {
    let mut eeprom = eeprom();
    let bits = coefficient::PRESENT
        | coefficient::CAM_CLOSES
        | coefficient::SWITCHES_CLOSE
        | coefficient::STAY_ON_CAM;
    set(&mut eeprom, ModuleAxis::One, AxisParameter::Coefficient, bits.into());
    for (cam_start, end) in [(CamStart::EdgeTaken, 0), (CamStart::FarEdge, -101)] {
        let assumptions = Assumptions { cam_start, ..Assumptions::default() };
        let module = ModuleOptions { assumptions, ..ModuleOptions::default() };
        let options = Bim2AxOptions { assumptions, ..Bim2AxOptions::default() };
        let mut rig = Rig::new(&module, &options, &eeprom, &surroundings()).await;
        rig.rewire(|around| around.benches[0].cam = Some(Contact::between(-100, 300, true)));
        rig.driver.home(&[ModuleAxis::One], &clock()).await.unwrap();
        let (seen, _) = rig.driver.rested(seconds(5), &clock()).await.unwrap();
        assert_eq!((seen.positions[0], rig.module.module().shaft(ModuleAxis::One)), (0, end));
        assert_ne!(seen.messages[0] & message::HOMED, 0);
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
        for (offset, value) in [(0xFD, 7), (0x00, 0xF1), (0x01, 0), (0x7F, 1)] {
            module.bus_write(offset, value);
        }
        module.advance(2_000_000);
        module.bus_write(0xFD, 6);
        assert_eq!(module.bus_read(0), u8::from(!needs_status));
    }
}
