//! Encoders against counters, in virtual time. 12800 µsteps and 2000 points a turn: a point is 6.4 µsteps.

use super::{
    drive::{Plan, virtual_drive},
    *,
};
use crate::Fault;
use crate::{
    Bim2AxDrive, Bim2AxDriveOptions, EncoderBench, EncoderKind,
    emulator::{Control, Event},
    protocol::bits::{definition, encoder_message},
};
use twin_drives::{Axes, Direction, Drive, DriveError, FaultRule, SetpointStream, When, WireFault};

const FAST: [f64; 5] = [10_000.0; 5];

/// Both axes have encoders, of which their parameters know.
fn with_encoders() -> (Eeprom, Surroundings) {
    let mut eeprom = eeprom();
    for axis in BOTH {
        set(&mut eeprom, axis, AxisParameter::Dividend, 12_800);
        set(&mut eeprom, axis, AxisParameter::Divisor, 2000);
        set(&mut eeprom, axis, AxisParameter::EncoderDefinition, definition::PRESENT.into());
    }
    let mut surroundings = surroundings();
    let bench = EncoderBench { microsteps_per_turn: 12_800, ..EncoderBench::default() };
    surroundings.encoders = [Some(bench); 2];
    (eeprom, surroundings)
}

fn quick() -> ModuleOptions {
    ModuleOptions { boot_ns: 0, ..ModuleOptions::default() }
}

/// Nothing is allowed but what the numbers of the encoder are rounded by.
fn strict() -> Bim2AxDriveOptions {
    let mut options = Bim2AxDriveOptions::new();
    (options.encoder_axes, options.encoder_tolerance) = (BOTH.to_vec(), Some(0));
    options.driver.deadline = Duration::from_millis(50);
    options
}

/// Looks until the axes rest.
fn rests<C: Fn() -> i64 + Sync>(
    drive: &mut Bim2AxDrive,
    plan: &Plan<C>,
) -> Result<[i64; 5], DriveError> {
    loop {
        let sample = drive.sample(plan)?;
        if !sample.moving {
            return Ok(sample.position);
        }
        assert!((plan.clock)() < 200_000_000_000, "it does not end");
    }
}

/// Bit by bit as 1 is axis 1; whether its shaft is to be where the encoder shows it.
fn differs(told: &DriveError) -> (Axes, i64, i64) {
    match told {
        DriveError::EncoderDiffers {
            axis, counter, encoder, unit: "µsteps", points: None,
        ..
        } => (*axis, *counter, *encoder),
        other => panic!("{other:?}"),
    }
}

/// Full speed, both ways, turns, legs of a plan, homing, another zero; on old and new modules, and with answers that come late.
#[test]
fn shafts_that_follow_are_never_doubted() {
    let (eeprom, surroundings) = with_encoders();
    let old = ModuleOptions { version: 14, ..quick() };
    let mut singly = quick();
    singly.assumptions.refreshes_all = false;
    for (module, late) in [(quick(), false), (old, false), (singly, true), (quick(), true)] {
        let (mut drive, device, clock) =
            virtual_drive(&module, (&eeprom, &surroundings), &strict());
        let mut plan = Plan { clock: clock.clone(), start_ns: i64::MAX / 2 };
        if late {
            let fault = WireFault::Delay { ns: 7_000_000 };
            let rule = FaultRule { direction: Direction::Answer, when: When::Every(3), fault };
            device.module().control(Control::Fault(rule));
        }
        drive.probe(&plan).unwrap();
        drive.enable().unwrap();
        for target in [[2500, -2500], [-2500, 2500], [7, -13], [0, 0]] {
            let target = [target[0], target[1], 0, 0, 0];
            drive.move_to(&target, &FAST).unwrap();
            assert_eq!(rests(&mut drive, &plan).unwrap(), target);
        }
        drive.begin_homing(&[Some(1), Some(1), None, None, None]).unwrap();
        assert_eq!(rests(&mut drive, &plan).unwrap()[..2], [0, 0]);
        assert_eq!(drive.homed().unwrap()[..2], [Some(true); 2]);
        drive.move_to(&[300, 200, 0, 0, 0], &FAST).unwrap();
        rests(&mut drive, &plan).unwrap();
        drive.set_position(&[0; 5]).unwrap();
        plan.start_ns = clock() + 100_000_000;
        while plan.now_ns() < 2_000_000_000 {
            drive.follow(&plan).unwrap();
        }
        assert_eq!(drive.sample(&plan).unwrap().position[..2], [0, 0]);
        drive.move_to(&[2000, -2000, 0, 0, 0], &FAST).unwrap();
        while !drive.sample(&plan).unwrap().moving {}
        drive.soft_stop().unwrap();
        rests(&mut drive, &plan).unwrap();
    }
}

/// From when on the shaft is held the counter goes on alone: by how much the axis moves between two looks it is reported late, and
/// 5 ms at 10000 µsteps/s are 50.
#[test]
fn a_held_shaft_is_told_while_it_moves_and_when_it_is_stopped() {
    let (eeprom, surroundings) = with_encoders();
    let mut options = strict();
    options.encoder_tolerance = None;
    let started = |options: &Bim2AxDriveOptions| {
        let made = virtual_drive(&quick(), (&eeprom, &surroundings), options);
        let (mut drive, device, clock) = made;
        let plan = Plan { clock, start_ns: i64::MAX / 2 };
        drive.probe(&plan).unwrap();
        drive.enable().unwrap();
        (drive, device, plan)
    };
    let held = |axis| Control::Event(Event::Stall(axis, true));

    // On its way to a target: three steps of 64 µsteps, and 9 of rounding.
    let (mut drive, device, plan) = started(&options);
    device.module().control(held(ModuleAxis::Two));
    drive.move_to(&[2000, -2500, 0, 0, 0], &FAST).unwrap();
    let told = rests(&mut drive, &plan).unwrap_err();
    let (axis, counter, encoder) = differs(&told);
    assert_eq!((axis, encoder), (Axes::Numbers(2), 0));
    assert!((-360..-192).contains(&counter), "{told}");
    let said = told.to_string();
    for part in ["module", "axis 2", "by its encoder", "µsteps", "192"] {
        assert!(said.contains(part), "{said}");
    }
    // It can be stopped, and where its encoder is then counts from there on.
    drive.soft_stop().unwrap();

    // While it follows a plan. By its encoder the module corrects leg after leg.
    let (mut drive, device, mut plan) = started(&strict());
    plan.start_ns = (plan.clock)() + 50_000_000;
    let told = loop {
        match drive.follow(&plan) {
            Ok(_) if plan.now_ns() > 300_000_000 => {
                device.module().control(held(ModuleAxis::One));
            }
            Ok(_) => {}
            Err(error) => break error,
        }
        assert!(plan.now_ns() < 2_000_000_000, "nothing is said");
    };
    assert_eq!(differs(&told).0, Axes::Numbers(1));

    // While it is stopped: (10000² − 1000²)/40000 are 2475 µsteps to brake from full speed.
    let (mut drive, device, plan) = started(&options);
    drive.set_position(&[-2500, 0, 0, 0, 0]).unwrap();
    drive.move_to(&[1_000_000, 0, 0, 0, 0], &[10_000.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
    while device.module().velocity(ModuleAxis::One) < 5000.0 {
        drive.sample(&plan).unwrap();
    }
    device.module().control(held(ModuleAxis::One));
    let told = drive.soft_stop().unwrap_err();
    assert_eq!(differs(&told).0, Axes::Numbers(1), "{told}");
    assert!(device.module().velocity(ModuleAxis::One).abs() < 1e-9, "it stands");
    drive.soft_stop().unwrap();

    // While it homes: it is away from where it began by more than may be.
    let (mut drive, device, plan) = started(&options);
    drive.begin_homing(&[Some(1), Some(1), None, None, None]).unwrap();
    device.module().control(held(ModuleAxis::One));
    assert_eq!(differs(&rests(&mut drive, &plan).unwrap_err()).0, Axes::Numbers(1));
}

/// The module goes on saying that it is homed; that it is not where it says is known to whoever looks at its encoder.
#[test]
fn an_axis_that_lost_its_place_is_not_homed_until_it_homes() {
    let (eeprom, surroundings) = with_encoders();
    let (mut drive, device, clock) = virtual_drive(&quick(), (&eeprom, &surroundings), &strict());
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    let ways = [Some(1), Some(1), None, None, None];
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
    drive.begin_homing(&ways).unwrap();
    rests(&mut drive, &plan).unwrap();
    let hold = |on| device.module().control(Control::Event(Event::Stall(ModuleAxis::One, on)));
    hold(true);
    drive.move_to(&[500, 500, 0, 0, 0], &FAST).unwrap();
    differs(&rests(&mut drive, &plan).unwrap_err());
    drive.soft_stop().unwrap();
    hold(false);
    // Another program: whatever it knows it has from the module.
    drive.probe(&plan).unwrap();
    assert_eq!(drive.homed().unwrap()[..2], [Some(false), Some(true)]);
    let told = drive.move_to(&[0; 5], &FAST).unwrap_err();
    assert_eq!(differs(&told).0, Axes::Numbers(1));
    drive.begin_homing(&ways).unwrap();
    rests(&mut drive, &plan).unwrap();
    assert_eq!(drive.homed().unwrap()[..2], [Some(true); 2]);
    drive.move_to(&[500, 500, 0, 0, 0], &FAST).unwrap();
    assert_eq!(rests(&mut drive, &plan).unwrap()[..2], [500, 500]);
}

/// 5.1: homing makes counters 0 and clears incremental encoders; an absolute one goes by its offset, which zeroing stores (3.1.16).
/// Until then the module would correct each move by 5000 points.
#[test]
fn an_absolute_encoder_has_to_be_told_where_home_is() {
    let (eeprom, mut surroundings) = with_encoders();
    for encoder in surroundings.encoders.iter_mut().flatten() {
        *encoder = EncoderBench { kind: Some(EncoderKind::EnDat), origin: 5000, ..*encoder };
    }
    let (mut drive, _device, clock) = virtual_drive(&quick(), (&eeprom, &surroundings), &strict());
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
    drive.begin_homing(&[Some(1), Some(1), None, None, None]).unwrap();
    let home = rests(&mut drive, &plan);
    let told = home.map_or_else(|told| told, |_| drive.homed().unwrap_err());
    let (_, counter, encoder) = differs(&told);
    assert_eq!(counter, 0);
    assert!(encoder.abs() > 1000, "{encoder}");
    assert!(drive.move_to(&[500, 500, 0, 0, 0], &FAST).is_err(), "it is somewhere else");
    drive.set_position(&[0; 5]).unwrap();
    assert_eq!(drive.homed().unwrap()[..2], [Some(true); 2]);
    drive.move_to(&[500, 500, 0, 0, 0], &FAST).unwrap();
    assert_eq!(rests(&mut drive, &plan).unwrap()[..2], [500, 500]);
    // Homed again it is where it should be.
    drive.begin_homing(&[Some(1), Some(1), None, None, None]).unwrap();
    rests(&mut drive, &plan).unwrap();
    assert_eq!(drive.homed().unwrap()[..2], [Some(true); 2]);
}

#[test]
fn an_encoder_that_counts_the_wrong_way_or_is_broken_is_told() {
    let (eeprom, sound) = with_encoders();
    let change = |change: &dyn Fn(&mut EncoderBench)| {
        let mut surroundings = sound;
        surroundings.encoders.iter_mut().flatten().take(1).for_each(change);
        surroundings
    };
    let inverted = change(&|encoder| encoder.inverted = true);
    let (mut drive, _device, clock) = virtual_drive(&quick(), (&eeprom, &inverted), &strict());
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
    drive.move_to(&[800, 0, 0, 0, 0], &FAST).unwrap();
    let (axis, counter, encoder) = differs(&rests(&mut drive, &plan).unwrap_err());
    assert!(axis == Axes::Numbers(1) && counter > 0 && encoder < 0, "{counter} {encoder}");

    // A plug that comes off on the way; one of an axis in use that is not there from the start.
    let broken = change(&|encoder| encoder.disconnected = true);
    let (mut drive, device, clock) = virtual_drive(&quick(), (&eeprom, &sound), &strict());
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
    drive.move_to(&[800, 0, 0, 0, 0], &FAST).unwrap();
    drive.sample(&plan).unwrap();
    device.module().set_surroundings(&broken);
    let told = rests(&mut drive, &plan).unwrap_err();
    assert!(matches!(told.fault(), Some(Fault::Encoder { axis: 1, .. })), "{told}");
    assert!(told.to_string().contains("the encoder of axis 1: fault"), "{told}");

    // The bit of the plug is a fault where it comes; a module without plugs shows it from the start, as all of these do.
    let mut plugged = sound;
    plugged.plugs = [Some(1); 2];
    let (mut drive, device, clock) = virtual_drive(&quick(), (&eeprom, &plugged), &strict());
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
    drive.sample(&plan).unwrap();
    // Page 6, $32 and 8 on: messages of axis 1, low byte last.
    device.module().set_garbled(Some((0x3B, 0x04)));
    let told = drive.sample(&plan).unwrap_err();
    let plug = encoder_message::PLUG;
    assert!(
        matches!(told.fault(), Some(Fault::Encoder { messages, .. }) if messages & plug != 0),
        "{told}"
    );
}

/// A look that is spoilt, by which it would be noted what belongs together, is no reason to doubt the shaft ever after; nor is one
/// on the way.
#[test]
fn one_look_that_is_spoilt_is_survived() {
    let (eeprom, surroundings) = with_encoders();
    let fault = WireFault::Corrupt { bytes: 1 };
    let rule = FaultRule { direction: Direction::Answer, when: When::Next(1), fault };
    for (after, seed) in (0..6).flat_map(|after| (0..12).map(move |seed| (after, seed))) {
        let (mut drive, device, clock) =
            virtual_drive(&quick(), (&eeprom, &surroundings), &strict());
        let plan = Plan { clock, start_ns: i64::MAX / 2 };
        drive.probe(&plan).unwrap();
        drive.enable().unwrap();
        device.module().set_seed(seed);
        device.module().control(Control::Fault(rule).after(after));
        for _ in 0..6 {
            drive.sample(&plan).unwrap();
        }
        for target in [600, 0] {
            drive.move_to(&[target, 0, 0, 0, 0], &FAST).unwrap();
            let found = rests(&mut drive, &plan);
            assert_eq!(found.unwrap()[0], target, "{after} {seed}");
        }
    }
}

/// 3.1.14 to 3.1.19, and message bit 4: "au moins une correction".
#[test]
fn what_the_module_has_corrected_itself_is_no_fault() {
    let (eeprom, surroundings) = with_encoders();
    let mut options = strict();
    options.encoder_tolerance = Some(1000);
    let (mut drive, device, clock) = virtual_drive(&quick(), (&eeprom, &surroundings), &options);
    let plan = Plan { clock, start_ns: i64::MAX / 2 };
    drive.probe(&plan).unwrap();
    drive.enable().unwrap();
    drive.set_position(&[0; 5]).unwrap();
    let hold = |on| device.module().control(Control::Event(Event::Stall(ModuleAxis::One, on)));
    drive.move_to(&[2000, 0, 0, 0, 0], &FAST).unwrap();
    while device.module().position(ModuleAxis::One) < 300.0 {
        drive.sample(&plan).unwrap();
    }
    hold(true);
    while device.module().position(ModuleAxis::One) < 700.0 {
        drive.sample(&plan).unwrap();
    }
    hold(false);
    assert_eq!(rests(&mut drive, &plan).unwrap()[0], 2000);
    let shaft = device.module().shaft(ModuleAxis::One);
    assert!((1990..=2010).contains(&shaft), "{shaft}");
}

#[test]
fn an_encoder_that_is_said_to_be_there_has_to_be() {
    let (with, surroundings) = with_encoders();
    let plan = |clock| Plan { clock, start_ns: i64::MAX / 2 };
    // Not declared: without a word nothing is watched, with one it is refused.
    let (mut drive, _device, clock) =
        virtual_drive(&quick(), (&eeprom(), &surroundings), &strict());
    let told = drive.probe(&plan(clock)).unwrap_err();
    assert!(told.to_string().contains("presence of the encoder, definition bit 0 = 0"), "{told}");
    // Declared, and none is recognised (terminals 2 and 13).
    let mut none = surroundings;
    none.encoders = [None; 2];
    let (mut drive, _device, clock) = virtual_drive(&quick(), (&with, &none), &strict());
    let plan_of = plan(clock);
    drive.probe(&plan_of).unwrap();
    drive.enable().unwrap();
    let told = drive.sample(&plan_of).unwrap_err();
    assert!(told.to_string().contains("the module does not recognise any"), "{told}");
    let usual = Bim2AxDriveOptions::new();
    let (mut drive, device, clock) = virtual_drive(&quick(), (&with, &none), &usual);
    let plan_of = plan(clock);
    drive.probe(&plan_of).unwrap();
    drive.enable().unwrap();
    device.module().control(Control::Event(Event::Stall(ModuleAxis::One, true)));
    drive.move_to(&[800, 0, 0, 0, 0], &FAST).unwrap();
    assert_eq!(rests(&mut drive, &plan_of).unwrap()[0], 800);
}
