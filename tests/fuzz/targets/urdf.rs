//! Fuzz target: any UTF-8 text as URDF. A model that is read has finite poses, and is the same when it is written and
//! read again; an error names a line of the text.

#![no_main]

use libfuzzer_sys::{Corpus, fuzz_target};
use std::path::Path;
use twin_urdf::{JointPositions, Model, UrdfOptions};

/// Largest position of a joint or a link for which poses are asked for, m.
const FAR: f64 = 1e100;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let Ok(text) = std::str::from_utf8(bytes) else { return Corpus::Reject };
    let path = Path::new("fuzz.urdf");
    let lines = text.split('\n').count();
    let options = UrdfOptions { right_angle_tolerance: 1e-3, ..UrdfOptions::default() };
    let loaded = match Model::read_urdf(text, path, &options) {
        Ok(loaded) => loaded,
        Err(error) => {
            assert!((1..=lines).contains(&(error.line as usize)), "{error} of {lines} lines");
            assert!(error.to_string().starts_with("fuzz.urdf:"), "{error}");
            return Corpus::Keep;
        }
    };
    for warning in &loaded.warnings {
        assert!((1..=lines).contains(&(warning.line as usize)), "{warning}");
    }
    let model = loaded.model;
    let near = model.joints.iter().all(|joint| {
        joint.origin.translation.vector.amax() <= FAR
            && joint.usable_limits().is_none_or(|limits| limits.iter().all(|x| x.abs() <= FAR))
    });
    if near {
        let rest = JointPositions::at_rest(&model);
        assert!(rest.values().iter().all(|value| value.is_finite()), "{rest:?}");
        for pose in model.link_poses(&[]) {
            assert!(pose.translation.vector.iter().all(|x| x.is_finite()), "{pose:?}");
            assert!((pose.rotation.norm() - 1.0).abs() < 1e-6, "{pose:?}");
        }
        assert!(model.tip_position(&[]).coords.iter().all(|x| x.is_finite()));
    }
    // A link other than the tool tip may have its name: then it cannot be written.
    let Ok(written) = model.to_urdf() else { return Corpus::Keep };
    let again = Model::read_urdf(&written, path, &UrdfOptions::default());
    let again = again.unwrap_or_else(|error| panic!("{error} in\n{written}"));
    assert_eq!(again.model, model, "in\n{written}");
    Corpus::Keep
});
