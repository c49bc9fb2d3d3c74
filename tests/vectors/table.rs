//! Table of vectors: every worked vector of the digest has its test.

use super::vector;
use serde_json::Value;
use std::collections::BTreeMap;
use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// Facts of the digest's vectors that this project does not compute, by how the ids begin: those of pictures of a PLC's
/// visualisation, and increments of a drive.
const LEFT_OUT: [(&str, &[&str]); 2] = [
    (
        "trafo-",
        &[
            "minX",
            "maxX",
            "minY",
            "maxY",
            "dnx",
            "dny",
            "dnOffsetX",
            "dnOffsetY",
            "ratio",
            "alpha",
            "beta",
            "dpx",
            "dpy",
            "dppx",
            "dppy",
            "dR",
            "dR1",
            "dR2",
            "dRatioInnerOuter",
        ],
    ),
    ("axis-units", &["inc", "num", "denom", "units"]),
];

/// A vector's id and the test that exercises it.
pub(crate) type Exercise = (&'static str, fn());

/// Owner of the test that exercises a vector. Every vector has one, and each compares its table with its
/// own, so together they leave none out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    /// `tests/vectors/main.rs`.
    Motion,
    /// `tests/vectors/transforms/main.rs`.
    Kinematics,
}

impl Owner {
    /// By how the ids begin; none for what this project does not do.
    fn of(id: &str) -> Option<Self> {
        let begins = |groups: &[&str]| groups.iter().any(|group| id.starts_with(group));
        let motion = ["cam-", "cnc-", "prep-", "ipo-", "axis-", "gear-", "x-interpolator"];
        if begins(&motion) || id == "diag-tracking" {
            Some(Self::Motion)
        } else if begins(&["trafo-", "trafov-"]) {
            Some(Self::Kinematics)
        } else {
            None
        }
    }
}

/// Every vector of `owner` has its test, every test its vector, and each test uses the vector next to it.
pub(crate) fn every_vector_is_exercised(owner: Owner, exercised: &[Exercise]) {
    let table: BTreeMap<_, _> = exercised.iter().copied().collect();
    assert_eq!(table.len(), exercised.len(), "a vector is in the table twice");
    let listed: Vec<_> = table.keys().copied().collect();
    let vectors = vector::all();
    for id in vectors.keys() {
        assert!(Owner::of(id).is_some(), "nobody exercises `{id}`");
    }
    let given: Vec<_> = vectors.keys().map(String::as_str).collect();
    let given: Vec<_> = given.into_iter().filter(|id| Owner::of(id) == Some(owner)).collect();
    assert_eq!(listed, given, "the table of tests and the vectors differ");
    for (id, test) in exercised {
        vector::take_checked();
        test();
        assert_eq!(vector::take_checked(), [*id], "the test listed for `{id}` looks at others");
    }
}

/// The vectors of `owner` are those of the digest, number for number but for what is left out. Skipped where the digest is
/// not at hand.
pub(crate) fn the_vectors_are_the_digests(owner: Owner) {
    let Some(path) = digest() else {
        println!("skipped: no vectors of the digest (TWIN_SHARED, ../shared)");
        return;
    };
    let text =
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut theirs = vector::parse(&text);
    theirs.retain(|id, _| Owner::of(id) == Some(owner));
    for (id, vector) in &mut theirs {
        leave_out(id, vector);
    }
    let mut ours = vector::all();
    ours.retain(|id, _| Owner::of(id) == Some(owner));
    assert_eq!(theirs.keys().collect::<Vec<_>>(), ours.keys().collect::<Vec<_>>());
    for (id, vector) in &ours {
        for part in ["inputs", "expected"] {
            let (ours, theirs) = (&vector[part], &theirs[id][part]);
            assert!(same(ours, theirs), "`{id}`: {part} are {ours}, those of the digest {theirs}");
        }
    }
}

/// Takes from a vector of the digest what is left out.
fn leave_out(id: &str, vector: &mut Value) {
    let left_out = LEFT_OUT.iter().filter(|(group, _)| id.starts_with(group));
    let left_out: Vec<_> = left_out.flat_map(|(_, names)| *names).copied().collect();
    for part in ["inputs", "expected"] {
        if let Some(facts) = vector.get_mut(part).and_then(Value::as_object_mut) {
            facts.retain(|name, _| !left_out.contains(&name.as_str()));
        }
    }
}

/// Path of the digest's vectors, if they are at hand.
fn digest() -> Option<PathBuf> {
    // Crates of several depths include this file.
    let mut folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let workspace = folders.find(|folder| folder.join("Cargo.lock").is_file())?;
    let shared = env::var_os("TWIN_SHARED").map_or(workspace.join("../shared"), PathBuf::from);
    let path = shared.join("spec/vectors/softmotion-vectors.json");
    path.is_file().then_some(path)
}

/// The same names and numbers; 5 is 5.0.
fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.as_f64() == b.as_f64(),
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(name, a)| b.get(name).is_some_and(|b| same(a, b)))
        }
        _ => a == b,
    }
}
