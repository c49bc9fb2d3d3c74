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
/// Largest number of connections at a time.
const MOST_TALKERS: usize = 16;
/// Reads from a connection at a time: a flood must not keep the device from its work.
const MOST_READS: usize = 32;

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
        while let Ok((mut stream, _)) = self.listener.accept() {
            if self.talkers.len() >= MOST_TALKERS {
                refuse(&mut stream, &format!("{MOST_TALKERS} connections are open, the most"));
            } else if stream.set_nonblocking(true).is_ok() {
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

/// Says why a connection ends. Whoever does not listen learns it from the end.
fn refuse(stream: &mut UnixStream, why: &str) {
    writeln!(stream, "error: {why}").unwrap_or_default();
}

/// Reads what is there and answers whole lines; false once the talker is gone.
fn talk(stream: &mut UnixStream, pending: &mut Vec<u8>, device: &mut dyn Obeys) -> bool {
    let mut chunk = [0; 512];
    for _ in 0..MOST_READS {
        let is_last = match stream.read(&mut chunk) {
            Ok(0) => true,
            Ok(count) => {
                pending.extend(chunk.iter().take(count));
                false
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return true,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(_) => return false,
        };
        // A last line needs no end.
        if is_last && !pending.is_empty() {
            pending.push(b'\n');
        }
        if !answer_lines(stream, pending, device) || is_last {
            return false;
        }
        if pending.len() > MOST_BYTES {
            refuse(stream, &format!("a line has more than {MOST_BYTES} bytes, the most"));
            return false;
        }
    }
    true
}

/// Obeys the whole lines of `pending`; false if the talker takes no answers.
fn answer_lines(stream: &mut UnixStream, pending: &mut Vec<u8>, device: &mut dyn Obeys) -> bool {
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
    true
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

        // A line without an end ends with an error, many short ones do not.
        let mut endless = UnixStream::connect(&path).unwrap();
        endless.write_all(&[b'x'; 3 * MOST_BYTES]).unwrap();
        console.serve(&mut parrot);
        assert!(console.talkers.is_empty() && parrot.0.len() == 2);
        let mut said = vec![0; 60];
        let count = endless.read(&mut said).unwrap();
        assert_eq!(&said[..count], b"error: a line has more than 4096 bytes, the most\n");
        let mut long = UnixStream::connect(&path).unwrap();
        long.write_all(format!("quiet{}\n", " ".repeat(100)).repeat(100).as_bytes()).unwrap();
        console.serve(&mut parrot);
        assert_eq!((console.talkers.len(), parrot.0.len()), (1, 2 + 100));

        // So many talk at a time at most.
        let talkers: Vec<_> =
            (0..MOST_TALKERS).map(|_| UnixStream::connect(&path).unwrap()).collect();
        console.serve(&mut parrot);
        assert_eq!(console.talkers.len(), MOST_TALKERS);
        let said = BufReader::new(&talkers[MOST_TALKERS - 1]).lines().next().unwrap().unwrap();
        assert_eq!(said, "error: 16 connections are open, the most");
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
