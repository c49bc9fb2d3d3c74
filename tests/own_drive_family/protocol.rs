//! Lines of text, each with a check sum: `?`, `enable 1`, `zero 0 0`, `move 100 500.0 -20 100.0`, `stop 0`.
//!
//! An answer is `at POSITION... MOVING ENABLED` or `no CODE`.

use std::fmt::Write;
use std::time::Duration;

/// Bits per second, 8N1.
pub(crate) const BAUD: u32 = 115_200;
/// Axes of a device.
pub(crate) const AXES: usize = 3;

/// A request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Request {
    /// Nothing but the state.
    State,
    /// Obeys motion commands, or does so no more.
    Enable(bool),
    /// Gives the present positions these numbers, steps.
    Zero([i64; AXES]),
    /// Sends every axis to a target, steps, at most at a speed, steps/s.
    Move([(i64, f64); AXES]),
    /// Stops, on the ramps or at once.
    Stop { now: bool },
}

/// State of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct State {
    /// Steps.
    pub(crate) position: [i64; AXES],
    pub(crate) moving: bool,
    pub(crate) enabled: bool,
}

/// Reason for which a device refuses a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Refusal {
    #[error("the device is locked")]
    Locked,
    #[error("an axis moves")]
    Moving,
    #[error("code {0}")]
    Other(u8),
}

impl Refusal {
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Locked => 1,
            Self::Moving => 2,
            Self::Other(code) => code,
        }
    }

    fn of(code: u8) -> Self {
        match code {
            1 => Self::Locked,
            2 => Self::Moving,
            other => Self::Other(other),
        }
    }
}

/// A line with its check sum, XOR of its bytes.
fn seal(text: &str) -> Vec<u8> {
    let sum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{text}*{sum:02X}\n").into_bytes()
}

/// The text of a line whose check sum is right.
fn open(line: &[u8]) -> Option<&str> {
    let (text, sum) = std::str::from_utf8(line).ok()?.trim_end().split_once('*')?;
    let found = text.bytes().fold(0, |sum, byte| sum ^ byte);
    (u8::from_str_radix(sum, 16).ok()? == found).then_some(text)
}

fn flag(word: &str) -> Option<bool> {
    word.parse::<u8>().ok().map(|number| number != 0)
}

impl Request {
    pub(crate) fn encode(&self) -> Vec<u8> {
        let mut text = String::new();
        let written = match self {
            Self::State => write!(text, "?"),
            Self::Enable(on) => write!(text, "enable {}", u8::from(*on)),
            Self::Zero([a, b, c]) => write!(text, "zero {a} {b} {c}"),
            Self::Move([a, b, c]) => {
                write!(text, "move {} {} {} {} {} {}", a.0, a.1, b.0, b.1, c.0, c.1)
            }
            Self::Stop { now } => write!(text, "stop {}", u8::from(*now)),
        };
        written.expect("a string takes everything");
        seal(&text)
    }

    pub(crate) fn decode(line: &[u8]) -> Option<Self> {
        let words: Vec<_> = open(line)?.split(' ').collect();
        let whole = |word: &str| word.parse::<i64>().ok();
        Some(match words[..] {
            ["?"] => Self::State,
            ["enable", on] => Self::Enable(flag(on)?),
            ["zero", a, b, c] => Self::Zero([whole(a)?, whole(b)?, whole(c)?]),
            ["move", a, u, b, v, c, w] => Self::Move([
                (whole(a)?, u.parse().ok()?),
                (whole(b)?, v.parse().ok()?),
                (whole(c)?, w.parse().ok()?),
            ]),
            ["stop", now] => Self::Stop { now: flag(now)? },
            _ => return None,
        })
    }
}

pub(crate) fn encode(answer: Result<State, Refusal>) -> Vec<u8> {
    seal(&match answer {
        Ok(State { position: [a, b, c], moving, enabled }) => {
            format!("at {a} {b} {c} {} {}", u8::from(moving), u8::from(enabled))
        }
        Err(refusal) => format!("no {}", refusal.code()),
    })
}

pub(crate) fn decode(line: &[u8]) -> Option<Result<State, Refusal>> {
    let words: Vec<_> = open(line)?.split(' ').collect();
    let whole = |word: &str| word.parse::<i64>().ok();
    Some(match words[..] {
        ["at", a, b, c, moving, enabled] => {
            let position = [whole(a)?, whole(b)?, whole(c)?];
            Ok(State { position, moving: flag(moving)?, enabled: flag(enabled)? })
        }
        ["no", code] => Err(Refusal::of(code.parse().ok()?)),
        _ => return None,
    })
}

/// Time of bytes on the wire: 10 bits each.
pub(crate) fn wire_time(bytes: usize) -> Duration {
    Duration::from_secs_f64(bytes as f64 * 10.0 / f64::from(BAUD))
}

#[test]
fn lines_come_back_and_wrong_ones_do_not() {
    for request in [
        Request::State,
        Request::Enable(true),
        Request::Zero([1, -2, 3]),
        Request::Move([(-5, 1.5), (0, 0.0), (7, 2e3)]),
        Request::Stop { now: false },
    ] {
        let line = request.encode();
        assert_eq!(Request::decode(&line), Some(request));
        let mut spoilt = line;
        spoilt[0] ^= 1;
        assert_eq!(Request::decode(&spoilt), None);
    }
    // XOR of `?` is 3Fh.
    assert_eq!(Request::State.encode(), b"?*3F\n");
    let state = State { position: [4, 5, -6], moving: true, enabled: false };
    assert_eq!(decode(&encode(Ok(state))), Some(Ok(state)));
    assert_eq!(decode(&encode(Err(Refusal::Locked))), Some(Err(Refusal::Locked)));
}
