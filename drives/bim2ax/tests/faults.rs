//! Faults of module, motors and wires in every state of an axis, in virtual time: what becomes of the motion, what
//! the driver says, and that the module can be used again afterwards.

use super::*;
use crate::Fault;
use crate::tests::common::fault_of;
use crate::{
    emulator::Control,
    protocol::bits::{card, message},
};
use twin_drives::{Clock, Direction, DriveError, FaultRule, When, WireFault};

/// Later than the deadline, so that the answer to a question comes during the next.
const LATE: WireFault = WireFault::Delay { ns: 15_000_000 };

/// What an axis is doing when something goes wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doing {
    Idle,
    Homing,
    Moving,
    Stopping,
}

const EVERYTHING: [Doing; 4] = [Doing::Idle, Doing::Homing, Doing::Moving, Doing::Stopping];

/// A rig whose first axis does that, for so long that it goes on during several exchanges.
async fn doing(what: Doing) -> Rig {
    let mut eeprom = eeprom();
    // A ramp of 1.8 s, and no switches in its way.
    set(&mut eeprom, ModuleAxis::One, AxisParameter::Acceleration, 5000);
    let mut surroundings = surroundings();
    surroundings.benches[0].plus = Some(Contact::above(1_000_000, true));
    surroundings.benches[0].minus = Some(Contact::below(-1_000_000, true));
    let module = ModuleOptions::default();
    let mut rig = Rig::new(&module, &Bim2AxOptions::default(), &eeprom, &surroundings).await;
    let clock = &clock();
    rig.driver.set_phases(&BOTH, true, clock).await.unwrap();
    match what {
        Doing::Idle => {}
        Doing::Homing => rig.driver.home(&[ModuleAxis::One], clock).await.unwrap(),
        Doing::Moving | Doing::Stopping => {
            rig.start([Some(50_000), None]).await;
            sleep(seconds(1)).await;
        }
    }
    if what == Doing::Stopping {
        rig.driver.abandon(clock).await.unwrap();
    }
    assert_eq!(rig.moves().await, what != Doing::Idle, "{what:?}");
    rig
}

/// Does something to a rig in every state, which is usable again afterwards.
async fn everywhere(test: impl AsyncFn(&mut Rig, Doing, &dyn Clock)) {
    for what in EVERYTHING {
        let mut rig = doing(what).await;
        test(&mut rig, what, &clock()).await;
        rig.usable().await;
    }
}

impl Rig {
    async fn moves(&mut self) -> bool {
        self.seen().await.messages[0] & message::MOVING != 0
    }

    /// Something goes wrong with interrupts.
    fn spoil(&self, direction: Direction, when: When, fault: WireFault) {
        self.module.module().control(Control::Fault(FaultRule { direction, when, fault }));
    }

    /// It goes wrong with every interrupt from now on.
    fn always(&self, direction: Direction, fault: WireFault) {
        self.spoil(direction, When::Always, fault);
    }

    /// Nothing goes wrong any more.
    fn sound(&self) {
        let mut module = self.module.module();
        module.control(Control::NoFaults);
        module.set_garbled(None);
    }

    fn speed(&self) -> f64 {
        self.module.module().velocity(ModuleAxis::One).abs()
    }

    /// The module obeys again.
    async fn usable(&mut self) {
        let (before, _) = self.driver.rested(seconds(60), &clock()).await.unwrap();
        let there = before.positions[0] - 100;
        assert_eq!(self.go([Some(there), None]).await.positions[0], there);
    }
}

#[tokio::test(start_paused = true)]
async fn a_module_that_hears_nothing_is_a_timeout_and_motion_goes_on_to_its_end() {
    everywhere(async |rig, what, clock| {
        rig.always(Direction::Request, WireFault::Drop);
        let error = rig.driver.positions(clock).await.unwrap_err();
        let text = "/dev/uio0: reading zone 0 (Position): no answer within 10 ms";
        assert_eq!(error.to_string(), text, "{what:?}");
        // What was there before is not taken for an answer to an order either.
        let error = rig.driver.stop_hard(clock).await.unwrap_err();
        assert!(matches!(error, DriveError::Timeout { .. }), "{what:?}: {error}");
        assert_eq!(rig.speed() > 0.0, what != Doing::Idle, "{what:?}");
        rig.sound();
        rig.driver.stop_hard(clock).await.unwrap();
        assert!(!rig.moves().await);
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn a_module_that_says_nothing_still_stops() {
    everywhere(async |rig, what, clock| {
        rig.always(Direction::Answer, WireFault::Drop);
        let error = rig.driver.stop_hard(clock).await.unwrap_err();
        assert!(matches!(error, DriveError::Timeout { .. }), "{what:?}: {error}");
        assert!(rig.speed() == 0.0, "{what:?}");
        rig.sound();
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn late_answers_are_not_taken_for_those_to_the_next_question() {
    everywhere(async |rig, what, clock| {
        rig.always(Direction::Request, LATE);
        // A late answer is for one zone and the question for another: the zone's number tells.
        for _ in 0..5 {
            if let Err(error) = rig.driver.acknowledgements(clock).await {
                use DriveError::{Protocol, Timeout};
                assert!(matches!(error, Timeout { .. } | Protocol { .. }), "{what:?}: {error}");
            }
            if let Ok((seen, stamp)) = rig.driver.positions(clock).await {
                let now = rig.module.module().position(ModuleAxis::One);
                let took = twin_drives::ramp::seconds(clock.now_ns() - stamp.sent_ns);
                let moved = (f64::from(seen.positions[0]) - now).abs();
                assert!(moved <= 10_000.0 * took + 1.0, "{what:?}: stale");
            }
        }
        rig.sound();
        sleep(Duration::from_millis(50)).await;
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn garbled_zone_numbers_and_parameters_are_told() {
    everywhere(async |rig, what, clock| {
        // Bits of the number of the parameter that the module echoes.
        rig.module.module().set_garbled(Some((0x1D, 0x40)));
        let error = rig.driver.parameter(Parameter::Version, clock).await.unwrap_err();
        assert!(matches!(error, DriveError::Protocol { .. }), "{what:?}: {error}");
        // The number of the zone: 1 instead of 0.
        rig.module.module().set_garbled(Some((0x00, 0x01)));
        let error = rig.driver.positions(clock).await.unwrap_err();
        assert!(matches!(error, DriveError::Protocol { .. }), "{what:?}: {error}");
        rig.sound();
        assert_eq!(rig.get(Parameter::Version).await, 15);
    })
    .await;
}

/// A question for a parameter changes nothing, so one that is lost, late or spoilt is asked again, also while looking who
/// is there; with two of them lost the second says so.
#[tokio::test(start_paused = true)]
async fn a_parameter_that_does_not_come_is_asked_for_again_once() {
    let faults = [
        (Direction::Request, WireFault::Drop),
        (Direction::Answer, WireFault::Drop),
        (Direction::Request, LATE),
        (Direction::Answer, LATE),
    ];
    everywhere(async |rig, what, clock| {
        for (direction, fault) in faults {
            for (lost, answered) in [(1, true), (2, false)] {
                rig.spoil(direction, When::Next(lost), fault);
                let rating = rig.driver.parameter(Parameter::Rating, clock).await.ok();
                let expected = answered.then_some(2000);
                assert_eq!(rating, expected, "{what:?}, {lost} × {direction:?} {fault}");
                rig.sound();
            }
            // Zone, rating and version are three questions.
            for unharmed in 0..3 {
                rig.spoil(direction, When::After(unharmed), fault);
                let identity = rig.driver.identify(clock).await.unwrap();
                assert_eq!((identity.rating_ma, identity.version), (2000, 15), "{what:?}");
                rig.sound();
            }
        }
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn a_reset_on_the_way_stops_the_motor_and_is_told() {
    everywhere(async |rig, what, clock| {
        let stood = rig.module.module().shaft(ModuleAxis::One);
        rig.module.module().brown_out(0);
        let error = rig.driver.positions(clock).await.unwrap_err();
        assert!(matches!(error.fault(), Some(Fault::NotRunning)), "{what:?}: {error}");
        let error = rig.driver.stop_hard(clock).await.unwrap_err();
        assert!(matches!(error.fault(), Some(Fault::NotRunning)), "{what:?}: {error}");
        assert!(rig.speed() == 0.0, "{what:?}");
        sleep(seconds(1)).await;
        let seen = rig.seen().await;
        assert_eq!(seen.messages[0] & (message::HOMED | message::PHASES_OFF), message::PHASES_OFF);
        assert_eq!(rig.module.module().shaft(ModuleAxis::One), stood, "{what:?}");
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn power_lost_on_the_way_stops_hard_and_is_told() {
    everywhere(async |rig, what, clock| {
        rig.rewire(|surroundings| surroundings.benches[0].power = false);
        let seen = rig.seen().await;
        let hard = if what == Doing::Idle { 0 } else { message::HARD_STOPPED };
        let reported =
            seen.messages[0] & (message::POWER_ABSENT | message::HARD_STOPPED | message::MOVING);
        assert_eq!(reported, message::POWER_ABSENT | hard, "{what:?}");
        let error = rig.driver.start([Some(Start::to(0)), None], clock).await;
        assert!(matches!(fault_of(&error), Some(Fault::AxisMessages { axis: 1, .. })), "{what:?}");
        rig.rewire(|surroundings| surroundings.benches[0].power = true);
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn a_phase_that_breaks_is_found_at_the_end_and_cleared_by_a_test() {
    everywhere(async |rig, what, clock| {
        rig.rewire(|surroundings| surroundings.benches[0].phase_open = true);
        rig.driver.rested(seconds(60), clock).await.unwrap();
        let error = rig.driver.start([Some(Start::to(1)), None], clock).await.unwrap_err();
        assert!(error.to_string().contains("axis 1: phase open"), "{what:?}: {error}");
        rig.rewire(|surroundings| surroundings.benches[0].phase_open = false);
        rig.driver.test_motors(&[ModuleAxis::One], clock).await.unwrap();
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn a_switch_that_sticks_stops_with_the_ramp() {
    everywhere(async |rig, what, clock| {
        let stick = |rig: &Rig, stuck| {
            rig.rewire(|surroundings| {
                let bench = &mut surroundings.benches[0];
                for contact in [&mut bench.plus, &mut bench.minus].into_iter().flatten() {
                    contact.stuck = stuck;
                }
            });
        };
        stick(rig, Some(true));
        // At most 6000 µsteps/s at 5000 µsteps/s².
        let (seen, _) = rig.driver.rested(Duration::from_millis(1500), clock).await.unwrap();
        let both = message::PLUS_SWITCH | message::MINUS_SWITCH;
        assert_eq!(seen.messages[0] & (both | message::HOMED), both, "{what:?}");
        let error = rig.driver.start([Some(Start::to(0)), None], clock).await;
        let reported = matches!(fault_of(&error), Some(Fault::AxisMessages { axis: 1, .. }));
        assert!(seen.positions[0] == 0 || reported, "{what:?}");
        stick(rig, None);
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn an_eeprom_that_fails_is_found_at_reset() {
    everywhere(async |rig, what, clock| {
        rig.module.module().spoil_eeprom();
        assert_eq!(rig.moves().await, what != Doing::Idle, "nothing is noticed until RESET");
        // A start finds it as RESET does.
        if what == Doing::Moving {
            rig.module.module().brown_out(1_000_000);
            sleep(seconds(2)).await;
        } else {
            rig.driver.reset().await.unwrap();
        }
        let error = rig.driver.identify(clock).await.unwrap_err();
        assert!(
            matches!(error.fault(), Some(Fault::CardMessages { messages: card::CHECKSUM, .. })),
            "{what:?}: {error}"
        );
        rig.set(AxisParameter::HoldingCurrent, 500).await;
        rig.driver.reset().await.unwrap();
    })
    .await;
}

#[tokio::test(start_paused = true)]
async fn a_module_that_is_slow_to_reset_does_not_count_as_running_again() {
    let mut rig = doing(Doing::Idle).await;
    let starts = rig.module.module().starts();
    // It reads the order long after it was given, and runs as before until then.
    rig.always(Direction::Request, WireFault::Delay { ns: 200_000_000 });
    rig.driver.reset().await.unwrap();
    assert_eq!(rig.module.module().starts(), starts + 1);
    rig.sound();
    assert_ne!(rig.seen().await.messages[0] & message::PHASES_OFF, 0);

    rig.always(Direction::Request, WireFault::Drop);
    let text = rig.driver.reset().await.unwrap_err().to_string();
    assert_eq!(text, "/dev/uio0: command 32768 (RESET): no answer within 1000 ms");
    rig.sound();
    rig.usable().await;
}

#[tokio::test(start_paused = true)]
async fn a_memory_that_is_gone_is_told() {
    struct Gone;
    impl crate::Memory for Gone {
        fn read(&mut self, _: u8, _: &mut [u8]) -> std::io::Result<()> {
            Err(std::io::ErrorKind::NotConnected.into())
        }
        fn write(&mut self, _: u8, _: &[u8]) -> std::io::Result<()> {
            Err(std::io::ErrorKind::NotConnected.into())
        }
    }
    let mut driver = Bim2Ax::new("/dev/uio3", Gone, &Bim2AxOptions::default());
    let error = driver.stop_hard(&clock()).await.unwrap_err();
    assert!(matches!(error, DriveError::Transport { .. }), "{error}");
    assert!(error.to_string().starts_with("/dev/uio3: order $0100 (hard stop): "), "{error}");
}

/// The module hears a move, whichever of its parts, 15 ms late: after the driver has given it up and stopped.
#[tokio::test(start_paused = true)]
async fn a_stop_outlasts_an_order_that_arrives_late() {
    for late in 0..6 {
        for hard in [false, true] {
            let mut rig = doing(Doing::Idle).await;
            let clock = &clock();
            rig.spoil(Direction::Request, When::After(late), LATE);
            drop(rig.driver.start([Some(Start::to(50_000)), None], clock).await);
            if hard {
                rig.driver.stop_hard(clock).await.unwrap();
            } else {
                rig.driver.abandon(clock).await.unwrap();
            }
            sleep(seconds(3)).await;
            assert!(rig.speed() <= 0.0, "{late}, hard: {hard}");
            rig.sound();
        }
    }
}
