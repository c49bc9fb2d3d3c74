//! Tests of the simulated machine on shipped machine files, URDF models, plates that hit and faults.

#![expect(clippy::float_cmp, reason = "given in the file, rounded before, or to be exact")]

mod faults;
mod plates;
mod shipped;
mod urdf;

use std::path::Path;
use twin_machine::Machine;

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

fn load(text: &str) -> Machine {
    Machine::parse(Path::new("machine.toml"), text)
        .unwrap_or_else(|problems| panic!("{problems:#?}"))
}

/// `text` with the first `from` replaced, which must be there.
fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from} is not in the file");
    text.replacen(from, to, 1)
}
