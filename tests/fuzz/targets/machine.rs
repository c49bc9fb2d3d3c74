//! Fuzz target: any UTF-8 text as a machine file. A machine that is read has finite numbers, and its transform leads
//! back from the tool to the axes.

#![no_main]

mod problems;

use libfuzzer_sys::{Corpus, fuzz_target};
use std::path::Path;
use twin_kinematics::{Kinematics, MAX_AXES};
use twin_machine::Machine;

/// Folder of the files that machine files name: URDF, cams, meshes.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../machines/fuzz.toml");

/// Distance between a pose and that of its axes at most, m: rounding of the largest machines.
const ROUNDING: f64 = 1e-6;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let Ok(text) = std::str::from_utf8(bytes) else { return Corpus::Reject };
    match Machine::parse(Path::new(FOLDER), text) {
        Ok(machine) => sound(&machine),
        Err(found) => {
            let again = Machine::parse(Path::new(FOLDER), text).expect_err("it is refused");
            assert_eq!(found, again, "problems differ from one reading to the next");
            problems::sound("machine file", text, found);
        }
    }
    Corpus::Keep
});

fn sound(machine: &Machine) {
    assert!((1..=MAX_AXES).contains(&machine.axes.len()), "{} axes", machine.axes.len());
    assert_eq!(machine.kinematics.sources().len(), machine.axes.len());
    for axis in &machine.axes {
        let [min, max] = axis.position_limits;
        assert!(min.is_finite() && max.is_finite() && min <= max, "{axis:?}");
    }
    assert!(machine.length_scale.is_finite() && machine.length_scale > 0.0);
    assert!(machine.moving_mass().is_finite() && machine.rest_height().is_finite());
    assert!(machine.start_pose().position.coords.iter().all(|x| x.is_finite()));
    if let Some(start) = machine.start_without_slaves() {
        assert!(start.iter().all(|value| value.is_finite()), "{start:?}");
    }
    let middle = machine.middle();
    let Ok(pose) = machine.kinematics.forward(&middle) else { return };
    assert!(pose.position.coords.iter().all(|x| x.is_finite()), "{pose:?}");
    let Ok(axes) = machine.kinematics.inverse(&pose, &middle) else { return };
    let back = machine.kinematics.forward(&axes).expect("these axes have been found");
    let distance = (back.position - pose.position).norm();
    let size = 1.0 + pose.position.coords.norm();
    assert!(distance <= ROUNDING * size, "{distance} m between {pose:?} and {back:?}");
}
