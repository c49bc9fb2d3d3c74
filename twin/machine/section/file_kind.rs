//! Kind of a TOML file, recognised by its keys, so that a file of another kind is refused by its name.

use super::Section;

/// Kind of a TOML file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A machine file.
    Machine,
    /// A job: a sequence of PLCopen blocks.
    Job,
    /// A cam.
    Cam,
    /// A scene: what is around a machine.
    Scene,
}

impl FileKind {
    /// True if a file that should be of this kind is of another one. That is then reported, and nothing else.
    pub fn refuses(self, root: &Section<'_>) -> bool {
        if self.is(root) {
            return false;
        }
        let kinds = [Self::Machine, Self::Job, Self::Cam, Self::Scene];
        let Some(other) = kinds.into_iter().find(|kind| kind.is(root)) else { return false };
        let hint = match other {
            Self::Machine => "",
            Self::Job => ": `twin cam run` runs it",
            Self::Cam => ": `twin cam check` looks at it",
            Self::Scene => ": `--scene` adds it to a machine",
        };
        root.complain(format!("this is a {}, not a {}{hint}", other.name(), self.name()));
        root.accept_all();
        true
    }

    /// By keys that only this kind has.
    fn is(self, root: &Section<'_>) -> bool {
        let keys: &[&str] = match self {
            Self::Machine => &["axes"],
            Self::Job => &["blocks"],
            Self::Cam => &["elements", "table", "tappets"],
            Self::Scene => &["obstacles", "bodies", "friction", "grippers"],
        };
        keys.iter().any(|key| root.has(key))
    }

    fn name(self) -> &'static str {
        match self {
            Self::Machine => "machine file",
            Self::Job => "job",
            Self::Cam => "cam",
            Self::Scene => "scene file",
        }
    }
}
