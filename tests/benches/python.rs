//! Search for a Python interpreter with a package that a benchmark compares with.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A package of the Python package index.
#[derive(Clone, Copy, Debug)]
pub struct Package {
    /// Name of the import.
    pub name: &'static str,
    /// The version that the numbers are about.
    pub requirement: &'static str,
    /// The environment variable that may name a Python that has it.
    pub variable: &'static str,
}

impl Package {
    /// A command that runs the script `tests/peers/<script>`, with one thread as ours. None, with a line that says why, where there is
    /// no Python that has the package.
    pub fn script(&self, script: &str) -> Option<Command> {
        let Some(python) = self.interpreter() else {
            let Self { name, variable, .. } = self;
            println!("peer, {name}: skipped, there is no Python that has it ({variable})");
            return None;
        };
        let folder = workspace().join("tests/peers");
        let mut command = Command::new(&python);
        command.arg(folder.join(script));
        for variable in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"] {
            command.env(variable, "1");
        }
        Some(command)
    }

    /// The Python named by the variable, the usual one, or one in a virtual environment of its own below `target`, made here if it
    /// is not there yet.
    fn interpreter(&self) -> Option<OsString> {
        let Self { name, requirement, variable } = self;
        if let Some(python) = env::var_os(variable) {
            assert!(self.is_in(&python), "{variable} has no {name}");
            return Some(python);
        }
        let usual = OsString::from("python3");
        if self.is_in(&usual) {
            return Some(usual);
        }
        let target = env::var_os("CARGO_TARGET_DIR")
            .map_or_else(|| workspace().join("target"), PathBuf::from);
        let folder = target.join(format!("{name}-venv"));
        let python = folder.join("bin").join("python").into_os_string();
        if !self.is_in(&python) {
            println!("peer, {name}: {requirement} is installed in {}", folder.display());
            let made = runs(Command::new(&usual).args(["-m", "venv"]).arg(&folder));
            let install = ["-m", "pip", "install", "--quiet", requirement];
            if !made || !runs(Command::new(&python).args(install)) {
                return None;
            }
        }
        self.is_in(&python).then_some(python)
    }

    fn is_in(&self, python: &OsString) -> bool {
        runs(Command::new(python).args(["-c", &format!("import {}", self.name)]))
    }
}

fn runs(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// Root of the workspace, whichever crate includes this file.
fn workspace() -> &'static Path {
    let mut folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    folders.find(|folder| folder.join("Cargo.lock").is_file()).expect("the crate is in a workspace")
}
