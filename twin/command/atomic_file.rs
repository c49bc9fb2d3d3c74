//! Atomic file writes: data goes to a file without a name, which gets its name on success. Where a file system knows no such
//! files, the name is a temporary `.NAME.….part`.

use super::Failure;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;
use twin_viz::Sink;

/// A file that gets its name on success: an existing file of its name stays until then. Devices and pipes are written to
/// directly.
#[derive(Debug)]
pub(super) struct AtomicFile {
    out: BufWriter<File>,
    target: Target,
    /// As it was given.
    name: PathBuf,
    path: PathBuf,
    /// Size of the items of a log that are written as a whole.
    whole: u64,
}

#[derive(Debug)]
enum Target {
    /// Goes on every way out, also when the process is killed.
    Unnamed,
    Temporary(TempPath),
    Device,
}

impl AtomicFile {
    /// Begins the file `path`.
    ///
    /// # Errors
    /// [`Failure::Write`] with its name.
    pub(super) fn create(path: &Path) -> Result<Self, Failure> {
        Self::begin(path).map_err(|source| unwritable(path, source))
    }

    /// The same with the error of the system.
    pub(super) fn begin(name: &Path) -> io::Result<Self> {
        check(name)?;
        // What a link leads to is replaced, not the link.
        let path = fs::canonicalize(name).unwrap_or_else(|_| name.to_owned());
        let folder = folder_of(&path).unwrap_or(Path::new("."));
        let (file, target) = if fs::metadata(&path).is_ok_and(|known| !known.is_file()) {
            (File::options().write(true).open(&path)?, Target::Device)
        } else if let Ok(file) = unnamed(folder) {
            (file, Target::Unnamed)
        } else {
            let mut prefix = OsString::from(".");
            prefix.push(path.file_name().unwrap_or_default());
            prefix.push(".");
            let mut builder = tempfile::Builder::new();
            let named = builder.prefix(&prefix).suffix(".part").tempfile_in(folder)?;
            let (file, part) = named.into_parts();
            (file, Target::Temporary(part))
        };
        let out = BufWriter::with_capacity(1 << 16, file);
        Ok(Self { out, target, name: name.to_owned(), path, whole: 0 })
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
        let name = self.name.clone();
        Sink::finish(self).map_err(|source| unwritable(&name, source))
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

impl Sink<Vec<u8>> for AtomicFile {
    fn write(&mut self, item: Vec<u8>) -> io::Result<()> {
        self.out.write_all(&item)?;
        self.out.flush()?;
        self.whole += item.len() as u64;
        Ok(())
    }

    fn finish(self) -> io::Result<()> {
        let file = self.out.into_inner().map_err(io::IntoInnerError::into_error)?;
        self.target.name(&file, &self.path)
    }

    /// Keeps the whole items, if there are any.
    fn cut(self) {
        let (file, _) = self.out.into_parts();
        if self.whole > 0 && file.set_len(self.whole).is_ok() {
            // Why the file has ended is what counts.
            self.target.name(&file, &self.path).ok();
        }
    }
}

impl Target {
    /// Gives a file its name, and the permissions of the file that it takes the place of.
    fn name(self, file: &File, path: &Path) -> io::Result<()> {
        match self {
            Self::Unnamed => permit(file, path).and_then(|()| link(file, path)),
            Self::Temporary(part) => {
                permit(file, path)?;
                part.persist(path).map_err(|error| error.error)
            }
            Self::Device => Ok(()),
        }
    }
}

/// A new file without a name.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> io::Result<File> {
    use rustix::fs::{Mode, OFlags};
    // Without it such a file cannot get a name.
    fs::metadata(OWN_FILES)?;
    let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
    Ok(rustix::fs::open(folder, flags, Mode::RUSR | Mode::WUSR)?.into())
}

/// The open files of this process, by number.
#[cfg(target_os = "linux")]
const OWN_FILES: &str = "/proc/self/fd";

/// Gives a file without a name one, by way of a temporary one: a link does not replace what is there.
#[cfg(target_os = "linux")]
fn link(file: &File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    use std::os::fd::AsRawFd;
    let own = format!("{OWN_FILES}/{}", file.as_raw_fd());
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    let part = path.with_file_name(name);
    linkat(CWD, own, CWD, &part, AtFlags::SYMLINK_FOLLOW)?;
    fs::rename(&part, path).inspect_err(|_| {
        fs::remove_file(&part).ok();
    })
}

#[cfg(not(target_os = "linux"))]
fn unnamed(_folder: &Path) -> io::Result<File> {
    Err(io::Error::from(io::ErrorKind::Unsupported))
}

#[cfg(not(target_os = "linux"))]
fn link(_file: &File, _path: &Path) -> io::Result<()> {
    Err(io::Error::from(io::ErrorKind::Unsupported))
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
fn permit(file: &File, path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(known) => file.set_permissions(known.permissions()),
        Err(_new) => readable(file),
    }
}

#[cfg(unix)]
fn readable(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable(_file: &File) -> io::Result<()> {
    Ok(())
}
