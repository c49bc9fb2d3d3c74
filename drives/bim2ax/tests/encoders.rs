//! Encoders against counters, in virtual time. 12800 µsteps and 2000 points a turn: a point is 6.4 µsteps.

use super::{
    drive::{Virtual, quick, virtual_drive},
    *,
};
use crate::Fault;
use crate::{
    Bim2AxDriveOptions, EncoderBench, EncoderKind,
    emulator::{Control, Event},
    protocol::bits::{definition, encoder_message},
};
use twin_drives::{Axes, Direction, Drive, DriveError, FaultRule, SetpointStream, When, WireFault};

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

/// Nothing is allowed but what the numbers of the encoder are rounded by.
fn strict() -> Bim2AxDriveOptions {
    let mut options = Bim2AxDriveOptions::new();
    (options.encoder_axes, options.encoder_tolerance) = (BOTH.to_vec(), Some(0));
    options.driver.deadline = Duration::from_millis(50);
    options
}

/// A drive on a module with encoders, enabled.
fn watched(options: &Bim2AxDriveOptions) -> Virtual<impl Fn() -> i64 + Sync + use<>> {
    let (eeprom, surroundings) = with_encoders();
    virtual_drive((&eeprom, &surroundings), &quick(), options).ready()
}

/// The strict drive among other surroundings.
fn among(surroundings: &Surroundings) -> Virtual<impl Fn() -> i64 + Sync + use<>> {
    virtual_drive((&with_encoders().0, surroundings), &quick(), &strict()).ready()
}

impl<C: Fn() -> i64 + Sync> Virtual<C> {
    /// Holds the shaft of an axis, or lets it go.
    fn hold(&self, axis: ModuleAxis, on: bool) {
        self.module.module().control(Control::Event(Event::Stall(axis, on)));
    }

    /// Looks until the module has come that far.
    fn looks_until(&mut self, arrived: impl Fn(&Module) -> bool) {
        while !arrived(&self.module.module()) {
            self.drive.sample(&self.plan).unwrap();
        }
    }
}

/// Bit by bit as 1 is axis 1; whether its shaft is to be where the encoder shows it.
fn differs(said: &DriveError) -> (Axes, i64, i64) {
    match said {
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
        let mut rig = virtual_drive((&eeprom, &surroundings), &module, &strict());
        if late {
            let fault = WireFault::Delay { ns: 7_000_000 };
            let rule = FaultRule { direction: Direction::Answer, when: When::Every(3), fault };
            rig.module.module().control(Control::Fault(rule));
        }
        rig = rig.ready();
        for target in [[2500, -2500], [-2500, 2500], [7, -13], [0, 0]] {
            assert_eq!(rig.goes(target).unwrap(), target);
        }
        assert_eq!(rig.homes().unwrap(), [0, 0]);
        assert_eq!(rig.homed(), [Some(true); 2]);
        rig.goes([300, 200]).unwrap();
        rig.drive.set_position(&[0; 5]).unwrap();
        rig.plan.start_ns = rig.now_ns() + 100_000_000;
        rig.follow(2_000_000_000);
        assert_eq!(rig.drive.sample(&rig.plan).unwrap().position[..2], [0, 0]);
        rig.begin([2000, -2000]).unwrap();
        while !rig.drive.sample(&rig.plan).unwrap().moving {}
        rig.drive.soft_stop().unwrap();
        rig.rests().unwrap();
    }
}

/// From when on the shaft is held the counter goes on alone: by how much the axis moves between two looks it is reported late, and
/// 5 ms at 10000 µsteps/s are 50.
#[test]
fn a_held_shaft_is_told_while_it_moves_and_when_it_is_stopped() {
    let mut options = strict();
    options.encoder_tolerance = None;
    let (one, two) = (ModuleAxis::One, ModuleAxis::Two);

    // On its way to a target: three steps of 64 µsteps, and 9 of rounding.
    let mut rig = watched(&options);
    rig.hold(two, true);
    let said = rig.goes([2000, -2500]).unwrap_err();
    let (axis, counter, encoder) = differs(&said);
    assert_eq!((axis, encoder), (Axes::Numbers(2), 0));
    assert!((-360..-192).contains(&counter), "{said}");
    let message = said.to_string();
    for part in ["module", "axis 2", "by its encoder", "µsteps", "192"] {
        assert!(message.contains(part), "{message}");
    }
    // It can be stopped, and where its encoder is then counts from there on.
    rig.drive.soft_stop().unwrap();

    // While it follows a plan. By its encoder the module corrects leg after leg.
    let mut rig = watched(&strict());
    rig.plan.start_ns = rig.now_ns() + 50_000_000;
    let said = loop {
        if let Err(error) = rig.drive.follow(&rig.plan) {
            break error;
        }
        if rig.plan.now_ns() > 300_000_000 {
            rig.hold(one, true);
        }
        assert!(rig.plan.now_ns() < 2_000_000_000, "nothing is said");
    };
    assert_eq!(differs(&said).0, Axes::Numbers(1));

    // While it is stopped: (10000² − 1000²)/40000 are 2475 µsteps to brake from full speed.
    let mut rig = watched(&options);
    rig.drive.set_position(&[-2500, 0, 0, 0, 0]).unwrap();
    rig.drive.move_to(&[1_000_000, 0, 0, 0, 0], &[10_000.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
    rig.looks_until(|module| module.velocity(one) >= 5000.0);
    rig.hold(one, true);
    let said = rig.drive.soft_stop().unwrap_err();
    assert_eq!(differs(&said).0, Axes::Numbers(1), "{said}");
    assert!(rig.module.module().velocity(one).abs() < 1e-9, "it does not move");
    rig.drive.soft_stop().unwrap();

    // While it homes: it is away from where it began by more than may be.
    let mut rig = watched(&options);
    rig.drive.begin_homing(&[Some(1), Some(1), None, None, None]).unwrap();
    rig.hold(one, true);
    assert_eq!(differs(&rig.rests().unwrap_err()).0, Axes::Numbers(1));
}

/// The module goes on saying that it is homed; that it is not where it says is known to whoever looks at its encoder.
#[test]
fn an_axis_that_lost_its_place_is_not_homed_until_it_homes() {
    let mut rig = watched(&strict());
    rig.homes().unwrap();
    rig.hold(ModuleAxis::One, true);
    differs(&rig.goes([500, 500]).unwrap_err());
    rig.drive.soft_stop().unwrap();
    rig.hold(ModuleAxis::One, false);
    // Another program: whatever it knows it has from the module.
    rig.drive.probe(&rig.plan).unwrap();
    assert_eq!(rig.homed(), [Some(false), Some(true)]);
    assert_eq!(differs(&rig.begin([0, 0]).unwrap_err()).0, Axes::Numbers(1));
    rig.homes().unwrap();
    assert_eq!(rig.homed(), [Some(true); 2]);
    assert_eq!(rig.goes([500, 500]).unwrap(), [500, 500]);
}

/// 5.1: homing makes counters 0 and clears incremental encoders; an absolute one goes by its offset, which zeroing stores (3.1.16).
/// Until then the module would correct each move by 5000 points.
#[test]
fn an_absolute_encoder_has_to_be_told_where_home_is() {
    let mut surroundings = with_encoders().1;
    for encoder in surroundings.encoders.iter_mut().flatten() {
        *encoder = EncoderBench { kind: Some(EncoderKind::EnDat), origin: 5000, ..*encoder };
    }
    let mut rig = among(&surroundings);
    let home = rig.homes();
    let said = home.map_or_else(|said| said, |_| rig.drive.homed().unwrap_err());
    let (_, counter, encoder) = differs(&said);
    assert_eq!(counter, 0);
    assert!(encoder.abs() > 1000, "{encoder}");
    assert!(rig.begin([500, 500]).is_err(), "it is somewhere else");
    rig.drive.set_position(&[0; 5]).unwrap();
    assert_eq!(rig.homed(), [Some(true); 2]);
    assert_eq!(rig.goes([500, 500]).unwrap(), [500, 500]);
    // Homed again it is where it should be.
    rig.homes().unwrap();
    assert_eq!(rig.homed(), [Some(true); 2]);
}

#[test]
fn an_encoder_that_counts_the_wrong_way_or_is_broken_is_told() {
    let sound = with_encoders().1;
    let change = |change: &dyn Fn(&mut EncoderBench)| {
        let mut surroundings = sound;
        surroundings.encoders.iter_mut().flatten().take(1).for_each(change);
        surroundings
    };
    let mut rig = among(&change(&|encoder| encoder.inverted = true));
    let (axis, counter, encoder) = differs(&rig.goes([800, 0]).unwrap_err());
    assert!(axis == Axes::Numbers(1) && counter > 0 && encoder < 0, "{counter} {encoder}");

    // A plug that comes off on the way; one of an axis in use that is not there from the start.
    let mut rig = among(&sound);
    rig.begin([800, 0]).unwrap();
    rig.drive.sample(&rig.plan).unwrap();
    let broken = change(&|encoder| encoder.disconnected = true);
    rig.module.module().set_surroundings(&broken);
    let said = rig.rests().unwrap_err();
    assert!(matches!(said.fault(), Some(Fault::Encoder { axis: 1, .. })), "{said}");
    assert!(said.to_string().contains("the encoder of axis 1: fault"), "{said}");

    // The bit of the plug is a fault where it comes; a module without plugs shows it from the start, as all of these do.
    let mut rig = among(&Surroundings { plugs: [Some(1); 2], ..sound });
    rig.drive.sample(&rig.plan).unwrap();
    // Page 6, $32 and 8 on: messages of axis 1, low byte last.
    rig.module.module().set_garbled(Some((0x3B, 0x04)));
    let said = rig.drive.sample(&rig.plan).unwrap_err();
    let plug = encoder_message::PLUG;
    assert!(
        matches!(said.fault(), Some(Fault::Encoder { messages, .. }) if messages & plug != 0),
        "{said}"
    );
}

/// A look that is spoilt, by which it would be noted what belongs together, is no reason to doubt the shaft ever after; nor is one
/// on the way.
#[test]
fn one_look_that_is_spoilt_is_survived() {
    let fault = WireFault::Corrupt { bytes: 1 };
    let rule = FaultRule { direction: Direction::Answer, when: When::Next(1), fault };
    for (after, seed) in (0..6).flat_map(|after| (0..12).map(move |seed| (after, seed))) {
        let mut rig = watched(&strict());
        rig.module.module().set_seed(seed);
        rig.module.module().control(Control::Fault(rule).after(after));
        for _ in 0..6 {
            rig.drive.sample(&rig.plan).unwrap();
        }
        for target in [600, 0] {
            assert_eq!(rig.goes([target, 0]).unwrap()[0], target, "{after} {seed}");
        }
    }
}

/// 3.1.14 to 3.1.19, and message bit 4: "au moins une correction".
#[test]
fn what_the_module_has_corrected_itself_is_no_fault() {
    let mut options = strict();
    options.encoder_tolerance = Some(1000);
    let mut rig = watched(&options);
    let one = ModuleAxis::One;
    rig.drive.set_position(&[0; 5]).unwrap();
    rig.begin([2000, 0]).unwrap();
    rig.looks_until(|module| module.position(one) >= 300.0);
    rig.hold(one, true);
    rig.looks_until(|module| module.position(one) >= 700.0);
    rig.hold(one, false);
    assert_eq!(rig.rests().unwrap()[0], 2000);
    let shaft = rig.module.module().shaft(one);
    assert!((1990..=2010).contains(&shaft), "{shaft}");
}

#[test]
fn an_encoder_that_is_said_to_be_there_has_to_be() {
    let (with, surroundings) = with_encoders();
    // Not declared: without a word nothing is watched, with one it is refused.
    let mut rig = virtual_drive((&eeprom(), &surroundings), &quick(), &strict());
    let said = rig.drive.probe(&rig.plan).unwrap_err();
    assert!(said.to_string().contains("presence of the encoder, definition bit 0 = 0"), "{said}");
    // Declared, and none is recognised (terminals 2 and 13).
    let none = Surroundings { encoders: [None; 2], ..surroundings };
    let mut rig = among(&none);
    let said = rig.drive.sample(&rig.plan).unwrap_err();
    assert!(said.to_string().contains("the module does not recognise any"), "{said}");
    let mut rig = virtual_drive((&with, &none), &quick(), &Bim2AxDriveOptions::new()).ready();
    rig.hold(ModuleAxis::One, true);
    assert_eq!(rig.goes([800, 0]).unwrap()[0], 800);
}
