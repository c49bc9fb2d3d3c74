//! `twin drive … home --by-switch`: switches that the drive only shows.

use crate::drive::{a_bus, a_module};
use twin_drives::bim2ax::emulator::Event;
use twin_drives::bim2ax::{Contact, ModuleAxis};

/// As a look at the switch takes, some tens of µsteps at the slow speed, with the time of this computer.
const LATE: f64 = 150.0;

/// The switch on DIR is pressed from 3000 to 1000 µsteps behind the start: backwards onto it, and slowly off it again, is home.
#[test]
fn a_smartdrive_is_homed_by_a_switch_at_an_input() {
    let (running, hand) = a_bus(Vec::new());
    // Inputs are GO, DIR, OFF, LIMP, LIMN. No home switch is known of this drive.
    hand.refuses("home --by-switch 0 --yes", "home switch");
    let ask = "home --by-switch 0 --input 2 --fast 3200 --slow 534 --max-way 5000";
    hand.refuses(ask, "towards - until input 2 says so, 5000 increments at most");
    let homed = hand.does(&format!("{ask} --yes"));
    assert!(homed.stdout.contains("drive 1 is home, at "), "{}", homed.stdout);
    // TRJINIT 1, "la position actuelle devient 0": the drive's own counter tells it to whoever asks next.
    hand.refuses(&format!("{ask} --home-position 10001 --yes"), "--max-slow-way");
    let devices = running.stop().expect("it runs");
    let home = devices[0].mechanical() - f64::from(devices[0].counter());
    assert!((home + 1000.0).abs() <= LATE, "{home}");
    assert_eq!(devices[0].counter(), 0);
}

/// The cam of axis 1 reaches from 400 µsteps behind the start on backwards.
#[test]
fn an_axis_of_a_bim2ax_is_homed_by_its_cam_and_by_an_input() {
    let (running, hand) = a_module();
    let mut surroundings = *running.module().surroundings();
    surroundings.benches[0].cam = Some(Contact::below(-400, true));
    running.module().happen(Event::Surroundings(Box::new(surroundings)));
    hand.refuses("home 1 2 --by-switch 0 --yes", "homes one axis at a time");
    // Inputs of the axis are its end switches + and -, and its cam.
    for switch in ["", " --input 3"] {
        let ask = format!("home 1 --by-switch 0{switch} --fast 3200 --slow 800 --max-way 8000");
        let homed = hand.does(&format!("{ask} --yes"));
        assert!(homed.stdout.contains("axis 1 is home, at "), "{}", homed.stdout);
        let module = running.module();
        let shaft = i32::try_from(module.shaft(ModuleAxis::One)).expect("it has not gone far");
        let home = f64::from(shaft) - module.position(ModuleAxis::One);
        assert!((home + 400.0).abs() <= LATE, "{home}");
    }
}
