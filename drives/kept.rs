//! What emulated devices keep from one start to the next: files.

use std::{fs, io, path::Path};

/// Replaces a file as a whole: whoever is killed meanwhile leaves the old or the new one.
///
/// # Errors
/// If it cannot be written next to the old one, or not take its place.
pub(crate) fn replace(path: &Path, content: &[u8]) -> io::Result<()> {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let new = path.with_file_name(name);
    fs::write(&new, content)?;
    fs::rename(&new, path)
}
