//! The control socket of an emulator: a line in, a line out.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use std::fs;
use std::io::{self, Read, Write};
use std::os::unix::fs::FileTypeExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};

/// Longest line of a command, bytes.
const MOST_BYTES: usize = 4096;

/// A device that things can be done to.
pub(super) trait Obeys {
    /// Does what the words say.
    ///
    /// # Errors
    /// The reason, in words.
    fn obey(&mut self, words: &[&str]) -> Result<String, String>;
}

/// On or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Switch {
    /// Pressed, closed, present.
    On,
    /// Released, open, absent.
    Off,
}

impl Switch {
    pub(super) fn is_on(self) -> bool {
        self == Self::On
    }
}

/// Parses one of a few words as its meaning; help and errors list them.
pub(in crate::command) fn one_of<T: Copy + Send + Sync + 'static>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.iter().map(|(word, _)| *word)).try_map(|word| {
        let found = table.iter().find(|(known, _)| known.eq_ignore_ascii_case(&word));
        found.map(|(_, meaning)| *meaning).ok_or("not one of the words")
    })
}

/// Parses the words of a line.
///
/// # Errors
/// What is said instead: help, or what is wrong with them.
pub(super) fn understood<T: clap::Parser>(words: &[&str]) -> Result<T, Result<String, String>> {
    T::try_parse_from(words).map_err(|error| {
        let text = error.to_string();
        // Help is not an error.
        if !error.use_stderr() {
            return Ok(text.trim_end().to_owned());
        }
        // What is wrong and what is allowed; how to call it comes after an empty line.
        let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
        let said = lines.collect::<Vec<_>>().join(" ");
        let said = said.trim_start_matches("error: ");
        if error.kind() != ErrorKind::InvalidSubcommand {
            return Err(said.to_owned());
        }
        let command = T::command();
        let known: Vec<_> = command.get_subcommands().map(clap::Command::get_name).collect();
        Err(format!("{said}; there are {}, and help", known.join(", ")))
    })
}

/// A socket and who talks to it.
#[derive(Debug)]
pub(super) struct Console {
    listener: UnixListener,
    path: PathBuf,
    talkers: Vec<(UnixStream, Vec<u8>)>,
}

impl Console {
    /// Makes the socket; one that nobody listens to any more is replaced.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let is_socket = fs::symlink_metadata(path).is_ok_and(|found| found.file_type().is_socket());
        if is_socket && UnixStream::connect(path).is_err() {
            fs::remove_file(path)?;
        }
        let listener = UnixListener::bind(path)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, path: path.to_owned(), talkers: Vec::new() })
    }

    /// Obeys what has come in, and answers.
    pub(super) fn serve(&mut self, device: &mut dyn Obeys) {
        while let Ok((stream, _)) = self.listener.accept() {
            if stream.set_nonblocking(true).is_ok() {
                self.talkers.push((stream, Vec::new()));
            }
        }
        self.talkers.retain_mut(|(stream, pending)| talk(stream, pending, device));
    }
}

impl Drop for Console {
    fn drop(&mut self) {
        // Nothing can be done about a socket that does not go.
        fs::remove_file(&self.path).unwrap_or_default();
    }
}

/// Reads what is there and answers whole lines; false once the talker is gone.
fn talk(stream: &mut UnixStream, pending: &mut Vec<u8>, device: &mut dyn Obeys) -> bool {
    let mut chunk = [0; 512];
    let goes_on = loop {
        match stream.read(&mut chunk) {
            Ok(0) => break false,
            Ok(count) => pending.extend(chunk.iter().take(count)),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => break true,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(_) => return false,
        }
        if pending.len() > MOST_BYTES {
            return false;
        }
    };
    // A last line needs no end.
    if !goes_on && !pending.is_empty() && !pending.ends_with(b"\n") {
        pending.push(b'\n');
    }
    while let Some(end) = pending.iter().position(|byte| *byte == b'\n') {
        let line: Vec<u8> = pending.drain(..=end).collect();
        let line = String::from_utf8_lossy(&line);
        let words: Vec<_> = line.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        let answer = match device.obey(&words) {
            Ok(said) if said.is_empty() => "ok".to_owned(),
            Ok(said) => said,
            Err(why) => format!("error: {why}"),
        };
        if writeln!(stream, "{answer}").is_err() {
            return false;
        }
    }
    goes_on
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufRead, BufReader};

    /// Repeats its commands, and refuses "no".
    #[derive(Default)]
    struct Parrot(Vec<String>);

    impl Obeys for Parrot {
        fn obey(&mut self, words: &[&str]) -> Result<String, String> {
            if words == ["no"] {
                return Err("as asked".to_owned());
            }
            self.0.push(words.join(" "));
            Ok(if words == ["quiet"] { String::new() } else { words.join("+") })
        }
    }

    #[test]
    fn lines_are_obeyed_and_answered() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("control");
        let (mut console, mut parrot) = (Console::open(&path).unwrap(), Parrot::default());
        assert!(Console::open(&path).is_err(), "it is in use");
        let mut talker = UnixStream::connect(&path).unwrap();
        talker.write_all(b"input 3  on\n\nno\nqui").unwrap();
        console.serve(&mut parrot);
        talker.write_all(b"et").unwrap();
        talker.shutdown(std::net::Shutdown::Write).unwrap();
        console.serve(&mut parrot);
        let said: Vec<_> = BufReader::new(talker).lines().map(Result::unwrap).collect();
        assert_eq!(said, ["input+3+on", "error: as asked", "ok"]);
        assert_eq!(parrot.0, ["input 3 on", "quiet"]);
        assert!(console.talkers.is_empty());

        // A line without an end is dropped.
        let mut endless = UnixStream::connect(&path).unwrap();
        endless.write_all(&[b'x'; 3 * MOST_BYTES]).unwrap();
        console.serve(&mut parrot);
        assert!(console.talkers.is_empty() && parrot.0.len() == 2);
        drop(console);
        assert!(!path.exists());
    }

    #[test]
    fn a_socket_that_is_left_is_replaced_and_a_file_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("control");
        drop(UnixListener::bind(&path).unwrap());
        assert!(path.exists());
        drop(Console::open(&path).unwrap());
        fs::write(&path, "mine").unwrap();
        assert!(Console::open(&path).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
    }
}
