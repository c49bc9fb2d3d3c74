//! Verdicts of `twin check` on generated programs against the independent truth of `tests/verdict`.

use crate::desk::BINARY;
use crate::root;
use std::process::Command;

/// As `tests/verdict/verdict.py` without arguments, with fewer programs. The seed is another one.
#[test]
fn generated_programs_get_the_true_verdict() {
    for (tool, version) in [("python3", "-c import tomllib"), ("c++", "--version")] {
        let arguments = version.splitn(2, ' ');
        let found = Command::new(tool).args(arguments).output();
        if !found.is_ok_and(|output| output.status.success()) {
            println!("skipped: no {tool} (Python from 3.11)");
            return;
        }
    }
    let script = root().join("tests/verdict/verdict.py");
    let folder = tempfile::tempdir().expect("temporary folder");
    let output = Command::new("python3")
        .arg(script)
        .args(["--count", "400", "--seed", "2"])
        .args(["--twin", BINARY, "--folder"])
        .arg(folder.path().join("programs"))
        .output()
        .expect("python3 runs");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && printed.contains("recall 100.000 %"),
        "{printed}\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
