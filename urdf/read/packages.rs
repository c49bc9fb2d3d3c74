//! Search paths of the mesh files that URDF names.

use percent_encoding::percent_decode_str;
use std::path::{Component, Path, PathBuf};

/// Possible paths of a file, the likeliest first. `folder` is that of the URDF.
///
/// `package://NAME/REST` is REST in the folder that the caller gives for NAME, or in a folder NAME next to the URDF or
/// next to any folder that it is in; failing that, as much of the end of REST as there is next to the URDF, so that a
/// URDF may be carried about with its meshes. `file://` and `model://` may be written; other names are relative to the URDF.
/// URIs are percent-decoded: `%20` is a blank.
pub(super) fn places(name: &str, folder: &Path, packages: &[(String, PathBuf)]) -> Vec<PathBuf> {
    let after = |scheme| Some(percent_decode_str(name.strip_prefix(scheme)?).decode_utf8_lossy());
    if let Some(path) = after("file://") {
        return vec![folder.join(&*path)];
    }
    let Some(path) = after("package://").or_else(|| after("model://")) else {
        return vec![folder.join(name)];
    };
    let path = Path::new(&*path);
    let mut parts = path.components();
    let package = match parts.next() {
        Some(Component::Normal(package)) => package.to_os_string(),
        _ => return vec![folder.join(path)],
    };
    let rest = parts.as_path();
    let mut places: Vec<PathBuf> = packages
        .iter()
        .filter(|(name, _)| package == name.as_str())
        .map(|(_, folder)| folder.join(rest))
        .collect();
    let whole = std::path::absolute(folder).unwrap_or_else(|_no_folder| folder.to_path_buf());
    for above in whole.ancestors() {
        if above.file_name() == Some(&package) {
            places.push(above.join(rest));
        }
        places.push(above.join(&package).join(rest));
    }
    let mut tail = rest.components();
    while tail.as_path().components().next().is_some() {
        places.push(folder.join(tail.as_path()));
        tail.next();
    }
    places
}
