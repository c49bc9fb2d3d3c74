//! The driver with boards that do what the manual leaves open in every way that is known.

use std::time::Duration;

use tokio::time::sleep;

use super::{
    LOCKED, assuming,
    board::{Hand, LONG, Rig, happen, no_clock},
    profile, segment_of_x,
};
use crate::{
    Assumptions, AxisMask, BaudCode, BoardAxis, BoardStop, InterpCnc, OutputCode, emulator::Event,
    protocol::registers::Status,
};

/// Every alternative, one at a time.
fn alternatives() -> Vec<Assumptions> {
    let usual = Assumptions::default();
    vec![
        usual,
        Assumptions { buffer_segments: 9, ..usual },
        Assumptions { arguments_stay: false, ..usual },
        Assumptions { lock_coil: false, ..usual },
        Assumptions { silence: Some(Duration::from_millis(4)), ..usual },
        Assumptions { most_read: 16, most_written: 16, ..usual },
        Assumptions { segment_acceleration: 200, segment_start_stop: 201, ..usual },
        Assumptions { broadcasts: false, ..usual },
        Assumptions { locked_exception: Some(6), ..usual },
        Assumptions { busy_axis_refuses: false, ..usual },
        Assumptions { enable_loss: BoardStop::OnRamp, ..usual },
        Assumptions { enable_loss_keeps_segments: true, ..usual },
        Assumptions { limit_stop: BoardStop::OnRamp, ..usual },
        Assumptions { reversal_gap_ns: 5_000_000, ..usual },
        Assumptions { home_one_by_one: true, ..usual },
        Assumptions { baud_code: BaudCode::Index, ..usual },
        Assumptions { line_at_restart: false, ..usual },
        Assumptions { output_code: OutputCode::Number, ..usual },
        Assumptions { eeprom_write_ns: 50_000_000, ..usual },
        Assumptions { eeprom_refuses: false, ..usual },
        Assumptions {
            exceptions_address: 11,
            exceptions_value: 12,
            exceptions_failure: 13,
            ..usual
        },
    ]
}

/// What is asked of every board: refuse while locked, move, take segments, lose ENABLE, move again.
async fn session(mut driver: InterpCnc, hand: Hand) {
    let assumed = driver.options().assumptions;
    for refused in [
        driver.move_axis(BoardAxis::X, &profile(500), LONG, &no_clock).await,
        driver.set_output(3, true, &no_clock).await,
    ] {
        assert!(refused.as_ref().is_err_and(LOCKED), "{assumed:?}: {refused:?}");
    }
    driver.unlock(&no_clock).await.unwrap();
    driver.set_output(3, true, &no_clock).await.unwrap();
    for target in [500, -300] {
        driver.move_axis(BoardAxis::X, &profile(target), LONG, &no_clock).await.unwrap();
    }
    for (number, value) in [(assumed.segment_acceleration, 50), (assumed.segment_start_stop, 200)] {
        driver.set_parameter(number, value, LONG, &no_clock).await.unwrap();
    }
    for target in [700, 900] {
        driver.send(&segment_of_x(5000, target), &no_clock).await.unwrap();
    }
    driver.wait_for_rest(AxisMask::ALL, LONG, &no_clock).await.unwrap();
    assert_eq!(driver.state(&no_clock).await.unwrap().0.positions[0], 900, "{assumed:?}");
    for target in [90_000, 0] {
        driver.send(&segment_of_x(5000, target), &no_clock).await.unwrap();
    }
    happen(&hand, Event::Enable(false)).await;
    sleep(Duration::from_secs(1)).await;
    happen(&hand, Event::Enable(true)).await;
    sleep(Duration::from_secs(1)).await;
    driver.unlock(&no_clock).await.unwrap();
    let (then, _) = driver.state(&no_clock).await.unwrap();
    sleep(Duration::from_secs(1)).await;
    // Nothing moves by what was queued before.
    let (now, _) = driver.state(&no_clock).await.unwrap();
    assert_eq!(then.positions, now.positions, "{assumed:?}");
    assert!(now.status.has(Status::BUFFER_EMPTY) && now.status.moving() == AxisMask::NONE);
    driver.move_axis(BoardAxis::X, &profile(0), LONG, &no_clock).await.unwrap();
}

#[test]
fn the_driver_copes_with_every_alternative() {
    for assumptions in alternatives() {
        let ((), board) = Rig::new(assuming(assumptions)).run(session);
        assert_eq!(board.counters()[0], 0, "{assumptions:?}");
    }
}

/// What waits in a board that keeps it is carried out if the driver does not know.
#[test]
fn segments_that_are_kept_surprise_a_driver_that_does_not_expect_them() {
    let keeps = Assumptions { enable_loss_keeps_segments: true, ..Assumptions::default() };
    let mut rig = Rig::new(assuming(keeps));
    rig.settings.assumptions = Assumptions::default();
    let ((), board) = rig.run(|mut driver, hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        for target in [90_000, 1234] {
            driver.send(&segment_of_x(5000, target), &no_clock).await.unwrap();
        }
        sleep(Duration::from_secs(1)).await;
        happen(&hand, Event::Enable(false)).await;
        sleep(Duration::from_secs(1)).await;
        happen(&hand, Event::Enable(true)).await;
        sleep(Duration::from_millis(10)).await;
        driver.unlock(&no_clock).await.unwrap();
        sleep(Duration::from_secs(10)).await;
    });
    assert_eq!(board.counters()[0], 1234);
}

/// A board that neither does nor refuses it is asked before: the way goes on, and the error names the axis.
#[test]
fn an_axis_in_an_interpolated_move_gets_no_other() {
    let busy = Assumptions { busy_axis_refuses: false, ..Assumptions::default() };
    let ((), board) = Rig::new(assuming(busy)).run(|mut driver, _hand| async move {
        driver.unlock(&no_clock).await.unwrap();
        driver.send(&segment_of_x(2000, 20_000), &no_clock).await.unwrap();
        let moved = driver.move_axis(BoardAxis::X, &profile(500), LONG, &no_clock).await;
        let said = moved.map_err(|error| error.to_string()).unwrap_err();
        assert!(said.contains("command 80 (independent move)") && said.contains('X'), "{said}");
        driver.move_axis(BoardAxis::Y, &profile(500), LONG, &no_clock).await.unwrap();
        driver.wait_for_rest(AxisMask::ALL, LONG, &no_clock).await.unwrap();
    });
    assert_eq!(board.counters()[..2], [20_000, 500]);
}
