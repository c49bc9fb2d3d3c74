//! Tidy test: checks that no compiler makes. The table of dependencies holds, the paths in the architecture page exist,
//! no source file is dead, and the coverage tables are true.
//!
//! It reads files only and depends on no crate of the workspace, so that it builds in seconds. Every check lists all
//! offenders at once, as `file:line: what`.

mod circles;
mod coverage;
mod dependencies;
mod manifest;
mod markdown;
mod names;
mod orphans;
mod paths;
mod rooms;
mod tree;
mod words;
