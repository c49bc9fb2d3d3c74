//! Atomic file writes: data goes to a temporary `.NAME.….part`, which is renamed on success.

use super::Failure;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file under a temporary name that is renamed on success: an existing file of its name stays until then. Devices and
/// pipes are written to directly.
#[derive(Debug)]
pub(super) struct AtomicFile {
    out: BufWriter<Out>,
    /// As it was given.
    name: PathBuf,
    path: PathBuf,
}

#[derive(Debug)]
enum Out {
    Temporary(NamedTempFile),
    Device(File),
}

impl AtomicFile {
    /// Begins the file `path`.
    ///
    /// # Errors
    /// [`Failure::Write`] with its name.
    pub(super) fn create(path: &Path) -> Result<Self, Failure> {
        Self::begin(path).map_err(|source| unwritable(path, source))
    }

    fn begin(name: &Path) -> io::Result<Self> {
        check(name)?;
        // What a link leads to is replaced, not the link.
        let path = fs::canonicalize(name).unwrap_or_else(|_| name.to_owned());
        let device = fs::metadata(&path).is_ok_and(|known| !known.is_file());
        let out = if device {
            Out::Device(File::options().write(true).open(&path)?)
        } else {
            let mut prefix = OsString::from(".");
            prefix.push(path.file_name().unwrap_or_default());
            prefix.push(".");
            let mut builder = tempfile::Builder::new();
            let builder = builder.prefix(&prefix).suffix(".part");
            Out::Temporary(builder.tempfile_in(folder_of(&path).unwrap_or(Path::new(".")))?)
        };
        Ok(Self { out: BufWriter::with_capacity(1 << 16, out), name: name.to_owned(), path })
    }

    /// Its name, as it was given.
    pub(super) fn name(&self) -> &Path {
        &self.name
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// [`Failure::Write`] with its name.
    pub(super) fn finish(self) -> Result<(), Failure> {
        let Self { out, name, path } = self;
        let named = out.into_inner().map_err(io::IntoInnerError::into_error);
        let named = named.and_then(|out| match out {
            Out::Temporary(file) => {
                permit(&file, &path)?;
                file.persist(&path).map(|_| ()).map_err(|error| error.error)
            }
            Out::Device(_) => Ok(()),
        });
        named.map_err(|source| unwritable(&name, source))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Write for Out {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Temporary(file) => file.write(bytes),
            Self::Device(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Temporary(file) => file.flush(),
            Self::Device(file) => file.flush(),
        }
    }
}

fn folder_of(path: &Path) -> Option<&Path> {
    path.parent().filter(|folder| !folder.as_os_str().is_empty())
}

/// Checks that a file of this name can be written, before long work.
///
/// # Errors
/// If not.
pub(super) fn check(path: &Path) -> io::Result<()> {
    if let Some(folder) = folder_of(path).filter(|folder| !folder.is_dir()) {
        let message = format!("there is no folder {}", folder.display());
        return Err(io::Error::new(io::ErrorKind::NotFound, message));
    }
    match fs::metadata(path) {
        Ok(known) if known.is_dir() => {
            Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"))
        }
        Ok(known) if known.permissions().readonly() => {
            Err(io::Error::from(io::ErrorKind::PermissionDenied))
        }
        _ => Ok(()),
    }
}

/// Pictures are SVG, and their files say so.
///
/// # Errors
/// [`Failure::Usage`] if the file has another ending than `.svg`.
pub(super) fn check_picture(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg")) {
        return Ok(());
    }
    let message = format!("{}: pictures are SVG; give the file an ending .svg", path.display());
    Err(Failure::Usage(message))
}

/// Checks that files can be written: nothing over the `program`, if there is one, or other `read` files, and nothing
/// twice. `targets` are given with the options that name them.
///
/// # Errors
/// [`Failure::Usage`] and [`Failure::Write`], with the option or the name of the file.
pub(super) fn check_targets<'a>(
    program: Option<&Path>,
    read: impl IntoIterator<Item = &'a Path>,
    targets: impl IntoIterator<Item = (&'static str, &'a Path)>,
) -> Result<(), Failure> {
    let mut used: Vec<&Path> = read.into_iter().collect();
    for (option, path) in targets {
        let wrong = if program.is_some_and(|program| is_same(path, program)) {
            "this is the program itself"
        } else if used.iter().any(|used| is_same(path, used)) {
            "something else is read from or written to it"
        } else {
            check(path).map_err(|source| unwritable(path, source))?;
            used.push(path);
            continue;
        };
        let message = format!("{option} {}: {wrong}; name another file", path.display());
        return Err(Failure::Usage(message));
    }
    Ok(())
}

/// Nothing takes the place of a file that is there already, unasked.
///
/// # Errors
/// [`Failure::Usage`] with its name, if there is one and `force` does not say that it is to be replaced.
pub(super) fn refuse_existing(path: &Path, force: bool) -> Result<(), Failure> {
    // A device or a pipe is written to, and keeps nothing.
    if force || !path.is_file() {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "{}: the file exists already and is left unchanged; name another one, or replace it with --force",
        path.display()
    )))
}

/// Writes a whole file.
///
/// # Errors
/// [`Failure::Write`] with its name.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|source| unwritable(path, source))?;
    file.finish()
}

/// True if both names are of one file, which need not be there yet.
pub(super) fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| {
        let folder = folder_of(path).unwrap_or(Path::new("."));
        let new = || Some(fs::canonicalize(folder).ok()?.join(path.file_name()?));
        fs::canonicalize(path).ok().or_else(new)
    };
    one == other || real(one).is_some_and(|path| Some(path) == real(other))
}

pub(super) fn unwritable(path: &Path, source: io::Error) -> Failure {
    Failure::Write { path: path.display().to_string(), source }
}

/// Temporary files are their owner's alone; this one is an ordinary file now, or may be read by whom the one it takes the place of
/// could be.
fn permit(file: &NamedTempFile, path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(known) => file.as_file().set_permissions(known.permissions()),
        Err(_new) => readable(file),
    }
}

#[cfg(unix)]
fn readable(file: &NamedTempFile) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.as_file().set_permissions(fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_file: &NamedTempFile) -> io::Result<()> {
    Ok(())
}
