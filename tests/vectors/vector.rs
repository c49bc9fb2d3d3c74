//! Worked vector: named inputs and expectations, with a record of those that a test has used.

use serde_json::Value;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The vectors, tolerance and units in front.
const TEXT: &str = include_str!("../data/softmotion-vectors.json");

thread_local! {
    /// The vectors that tests of this thread have checked.
    static CHECKED: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// All vectors of this repository by their ids.
pub(crate) fn all() -> BTreeMap<String, Value> {
    parse(TEXT)
}

/// The vectors of a file by their ids.
pub(crate) fn parse(text: &str) -> BTreeMap<String, Value> {
    let file: Value = serde_json::from_str(text).expect("JSON");
    let vectors = file["vectors"].as_array().expect("`vectors` is a list");
    let by_id: BTreeMap<_, _> = vectors
        .iter()
        .map(|vector| (vector["id"].as_str().expect("an id").to_owned(), vector.clone()))
        .collect();
    assert_eq!(by_id.len(), vectors.len(), "an id occurs twice");
    by_id
}

/// The ids checked on this thread since the last call.
pub(crate) fn take_checked() -> Vec<String> {
    CHECKED.with_borrow_mut(std::mem::take)
}

/// Runs a test on the vector `id`; fails if it leaves any input or expectation unused.
pub(crate) fn check(id: &str, test: impl FnOnce(&Vector)) {
    let facts = all().remove(id).unwrap_or_else(|| panic!("there is no vector `{id}`"));
    let file: Value = serde_json::from_str(TEXT).expect("JSON");
    let tolerance = file["tolerance"].as_f64().expect("a tolerance");
    let vector =
        Vector { id: id.to_owned(), facts, tolerance, used: RefCell::new(BTreeSet::new()) };
    test(&vector);
    let mut facts = Vec::new();
    for part in ["inputs", "expected", "program"] {
        leaves(&vector.facts[part], part, &mut facts);
    }
    let used = vector.used.borrow();
    let unused: Vec<_> =
        facts.iter().map(|(name, _)| name).filter(|name| !used.contains(*name)).collect();
    assert!(unused.is_empty(), "`{id}`: the test does not use {unused:?}");
    CHECKED.with_borrow_mut(|checked| checked.push(id.to_owned()));
}

/// A vector under test. Names are paths: `start`, `arc/center`, `switches/0/rel`.
pub(crate) struct Vector {
    id: String,
    facts: Value,
    tolerance: f64,
    used: RefCell<BTreeSet<String>>,
}

impl Vector {
    /// A number among the inputs.
    pub(crate) fn number(&self, name: &str) -> f64 {
        let [number] = self.numbers(name)[..] else { panic!("`{}`: {name} is a list", self.id) };
        number
    }

    /// The numbers below a name of the inputs, in their order.
    pub(crate) fn numbers(&self, name: &str) -> Vec<f64> {
        self.values(&format!("inputs/{name}"))
            .iter()
            .map(|value| value.as_f64().unwrap_or_else(|| panic!("{}: {name}: {value}", self.id)))
            .collect()
    }

    /// A list of points among the inputs.
    pub(crate) fn points(&self, name: &str) -> Vec<[f64; 2]> {
        let numbers = self.numbers(name);
        assert!(numbers.len().is_multiple_of(2), "`{}`: {name} are no points", self.id);
        numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    /// A text or a truth value among the inputs, as text.
    pub(crate) fn word(&self, name: &str) -> String {
        let [value] = &self.values(&format!("inputs/{name}"))[..] else { panic!("{name}") };
        value.as_str().map_or_else(|| value.to_string(), str::to_owned)
    }

    /// The blocks of the vector's program.
    pub(crate) fn program(&self) -> String {
        let blocks = self.values("program");
        let blocks: Vec<_> = blocks.iter().map(|block| block.as_str().expect("text")).collect();
        blocks.join("\n")
    }

    /// Compares the numbers below an expected name with those found, in their order.
    #[track_caller]
    pub(crate) fn expect(&self, name: &str, found: impl IntoIterator<Item = f64>) {
        let expected = self.values(&format!("expected/{name}"));
        let found: Vec<f64> = found.into_iter().collect();
        let close = |(expected, found): (&Value, &f64)| {
            expected.as_f64().is_some_and(|expected| (expected - found).abs() <= self.tolerance)
        };
        assert!(
            expected.len() == found.len() && expected.iter().zip(&found).all(close),
            "`{}`: {name} is {found:?}, expected {expected:?}",
            self.id
        );
    }

    /// Compares an expected truth value.
    #[track_caller]
    pub(crate) fn expect_that(&self, name: &str, found: bool) {
        let expected = self.values(&format!("expected/{name}"));
        assert_eq!(expected, [Value::Bool(found)], "`{}`: {name}", self.id);
    }

    /// Compares an expected word.
    #[track_caller]
    pub(crate) fn expect_word(&self, name: &str, found: &str) {
        let expected = self.values(&format!("expected/{name}"));
        assert_eq!(expected, [Value::from(found)], "`{}`: {name}", self.id);
    }

    /// The values below a path, from now on used. There is at least one.
    #[track_caller]
    fn values(&self, path: &str) -> Vec<Value> {
        let node = self.facts.pointer(&format!("/{path}")).unwrap_or(&Value::Null);
        let mut found = Vec::new();
        leaves(node, path, &mut found);
        assert!(!found.is_empty(), "`{}` has no {path}", self.id);
        let mut used = self.used.borrow_mut();
        found
            .into_iter()
            .map(|(name, value)| {
                used.insert(name);
                value
            })
            .collect()
    }
}

/// The values below `node` with their paths.
fn leaves(node: &Value, path: &str, found: &mut Vec<(String, Value)>) {
    match node {
        Value::Object(fields) => {
            for (name, node) in fields {
                leaves(node, &format!("{path}/{name}"), found);
            }
        }
        Value::Array(items) => {
            for (index, node) in items.iter().enumerate() {
                leaves(node, &format!("{path}/{index}"), found);
            }
        }
        Value::Null => {}
        value => found.push((path.to_owned(), value.clone())),
    }
}

/// What the runner itself must refuse.
mod tests {
    use super::{check, take_checked};
    use std::panic::{AssertUnwindSafe, catch_unwind};

    #[test]
    fn unused_wrong_and_unknown_facts_are_failures() {
        let fails = |id: &str, test: &dyn Fn(&super::Vector)| {
            catch_unwind(AssertUnwindSafe(|| check(id, test))).is_err()
        };
        let inputs = |vector: &super::Vector| {
            for name in ["start", "end", "pos"] {
                vector.numbers(name);
            }
        };
        let whole = |vector: &super::Vector| {
            inputs(vector);
            vector.expect("mid", [20.0, 40.0]);
        };
        take_checked();
        assert!(!fails("cnc-split", &whole));
        assert_eq!(take_checked(), ["cnc-split"]);
        assert!(fails("cnc-split", &inputs), "an expectation that nobody looks at");
        assert!(fails("cnc-split", &|vector| vector.expect("mid", [20.0, 40.0])), "no input used");
        let part = |vector: &super::Vector| {
            inputs(vector);
            vector.expect("mid/0", [20.0]);
        };
        assert!(fails("cnc-split", &part), "half of a point");
        let far = |vector: &super::Vector| {
            inputs(vector);
            vector.expect("mid", [20.0, 40.0 + 2e-8]);
        };
        assert!(fails("cnc-split", &far), "beyond the tolerance");
        let more = |vector: &super::Vector| {
            inputs(vector);
            vector.expect("mid", [20.0, 40.0, 0.0]);
        };
        assert!(fails("cnc-split", &more), "more numbers than expected");
        let unknown = |vector: &super::Vector| {
            whole(vector);
            vector.expect("length", [0.0; 0]);
        };
        assert!(fails("cnc-split", &unknown), "a name that is not there");
        assert!(fails("cnc-splt", &whole), "a vector that is not there");
        assert!(take_checked().is_empty());
    }
}
