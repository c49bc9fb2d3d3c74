//! Robustness of the URDF reader: changed bytes, words and lines give a model or an error, and every model round-trips.

use super::{scara, seeded};
use crate::{Loaded, Model, UrdfFileError, UrdfOptions};
use proptest::prelude::*;
use std::path::Path;

/// A machine with everything in it.
fn text() -> String {
    let generated = scara().model().unwrap().to_urdf().unwrap();
    let more = r#"<link name="finger"><visual><origin rpy="0 1.571 0" xyz="1 0 0"/><geometry><capsule radius="1" length="2"/></geometry>
        <material name="none"/></visual><collision><geometry><sphere radius="1"/></geometry></collision></link>
      <joint name="f" type="prismatic"><parent link="quill"/><child link="finger"/><mimic joint="Z" multiplier="-2" offset="0.1"/>
        <dynamics damping="1" friction="2"/><safety_controller k_velocity="1" soft_upper_limit="1"/><calibration rising="1"/>
        <limit lower="0" upper="1" velocity="1" effort="1"/></joint>
      <twin><drive joint="A"><part axis="0" factor="2"/></drive><passive joint="B" rest="1"/>
        <loop from="arm1" to="quill"><point xyz="0 0 0"/><point xyz="0 0 1"/></loop></twin>
    </robot>"#;
    generated.replace("</robot>", more)
}

fn read(text: &str) -> Result<Loaded, UrdfFileError> {
    Model::read_urdf(text, Path::new(""), &UrdfOptions::default())
}

fn answered(text: &str) -> Result<(), TestCaseError> {
    match read(text) {
        Err(error) => {
            let lines = text.split('\n').count();
            prop_assert!((1..=lines).contains(&usize::try_from(error.line).unwrap()), "{error}");
        }
        Ok(loaded) => {
            // What is read may still not be what can be written: a link may be called like the tip.
            if let Ok(written) = loaded.model.to_urdf() {
                let again = read(&written).map(|again| again.model);
                let same = again.as_ref().is_ok_and(|again| *again == loaded.model);
                prop_assert!(same, "{again:?}\n{written}");
            }
        }
    }
    Ok(())
}

#[test]
fn the_text_is_read() {
    answered(&text()).unwrap();
    let loaded = read(&text()).unwrap();
    assert_eq!((loaded.model.joints.len(), loaded.warnings.len()), (4, 1));
}

#[test]
fn depth_is_no_danger() {
    for depth in [1_000, 300_000] {
        let text = "<robot>".repeat(depth);
        assert!(read(&text).is_err() && read(&(text + &"</robot>".repeat(depth))).is_err());
    }
}

proptest! {
    #![proptest_config(seeded())]

    #[test]
    fn changed_bytes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = text().into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        answered(&String::from_utf8_lossy(&bytes))?;
    }

    /// Words of the text in other places: attributes and elements that are well-formed but not meant.
    #[test]
    fn changed_words(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..4),
        number in prop_oneof![Just("nan"), Just("inf"), Just("-1"), Just("0"), Just("1e308"), Just("1e-320"), Just("")],
        place in any::<prop::sample::Index>(),
    ) {
        let text = text();
        let mut words: Vec<_> = text.split('"').collect();
        for (from, to) in changes {
            // Values only, which are every other.
            let (from, to) = (from.index(words.len() / 2) * 2 + 1, to.index(words.len() / 2) * 2 + 1);
            words[to] = words[from];
        }
        let place = place.index(words.len() / 2) * 2 + 1;
        words[place] = number;
        answered(&words.join("\""))?;
    }

    #[test]
    fn changed_lines(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 0..3), 1..4),
    ) {
        let text = text();
        let mut lines: Vec<_> = text.lines().collect();
        for (one, other, how) in changes {
            let (one, other) = (one.index(lines.len()), other.index(lines.len()));
            match how {
                0 => { lines.remove(one); }
                1 => lines.insert(other, lines[one]),
                _ => lines.swap(one, other),
            }
        }
        answered(&lines.join("\n"))?;
    }
}
