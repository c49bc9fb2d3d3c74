//! Messages of a program: comments that a control shows or writes to a file. They are shown, never carried out.

use super::parameters::Target;
use super::state::State;

/// A comment that a control acts on, its parameters replaced by their values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Purpose, in capitals: ABORT, MSG, DEBUG, PRINT, LOG, LOGOPEN, LOGAPPEND, LOGCLOSE, PROBEOPEN or PROBECLOSE.
    pub kind: &'static str,
    /// Text.
    pub text: String,
}

/// Purposes, and whether parameters in their text are replaced.
const KINDS: [(&str, bool); 10] = [
    ("ABORT", true),
    ("MSG", false),
    ("DEBUG", true),
    ("PRINT", true),
    ("LOG", true),
    ("LOGOPEN", false),
    ("LOGAPPEND", false),
    ("LOGCLOSE", false),
    ("PROBEOPEN", false),
    ("PROBECLOSE", false),
];

impl Message {
    /// The message of a comment; none if it is for readers only.
    pub(super) fn of_comment(comment: &[u8], state: &State) -> Option<Self> {
        let text = comment.trim_ascii_start();
        let fits = |kind: &str| {
            let head = text.get(..kind.len())?;
            let behind = text.get(kind.len()..)?.trim_ascii_start();
            let ends = match kind {
                "LOGCLOSE" | "PROBECLOSE" => behind.is_empty(),
                "LOGOPEN" | "LOGAPPEND" | "PROBEOPEN" => true,
                _ => behind.first() == Some(&b','),
            };
            (head.eq_ignore_ascii_case(kind.as_bytes()) && ends).then_some(behind)
        };
        let (kind, replaces, rest) =
            KINDS.iter().find_map(|(kind, replaces)| Some((*kind, *replaces, fits(kind)?)))?;
        let rest = rest.strip_prefix(b",").unwrap_or(rest);
        let text = if replaces { replaced(rest, state) } else { rest.to_vec() };
        Some(Self { kind, text: String::from_utf8_lossy(&text).trim().to_owned() })
    }
}

/// `text` with the values of its parameters, six decimals each, or as `%d`, `%f` and `%.3f` before them say.
fn replaced(text: &[u8], state: &State) -> Vec<u8> {
    let (mut shown, mut decimals, mut rest) = (Vec::new(), 6, text);
    while let Some((&byte, behind)) = rest.split_first() {
        let taken = match byte {
            b'#' => parameter(behind).map(|(target, length)| {
                let value = target.and_then(|target| state.parameter(&target).ok());
                let value =
                    value.map_or("######".to_owned(), |value| format!("{value:.decimals$}"));
                shown.extend_from_slice(value.as_bytes());
                length
            }),
            b'%' => format(behind).map(|(count, length)| {
                decimals = count;
                length
            }),
            _ => None,
        };
        if taken.is_none() {
            shown.push(byte);
        }
        rest = behind.get(taken.unwrap_or_default()..).unwrap_or_default();
    }
    shown
}

/// The parameter whose number or name begins here, if there can be one, and the length of it.
fn parameter(text: &[u8]) -> Option<(Option<Target>, usize)> {
    if let Some(name) = text.strip_prefix(b"<") {
        let length = name.iter().position(|byte| *byte == b'>')?;
        let name = name.get(..length)?.iter().filter(|byte| !byte.is_ascii_whitespace());
        let name: Vec<u8> = name.map(u8::to_ascii_lowercase).collect();
        return Some((Some(Target::Named(name.into())), length + 2));
    }
    let length = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let number = crate::number::parse(text.get(..length)?)?;
    Some((Target::numbered(number).ok(), length))
}

/// Decimals of the format that begins here, and the length of it.
fn format(text: &[u8]) -> Option<(usize, usize)> {
    match text {
        [b'd', ..] => Some((0, 1)),
        [b'f', ..] => Some((4, 1)),
        [b'l', b'f', ..] => Some((6, 2)),
        [b'.', digit @ b'0'..=b'9', b'f', ..] => Some((usize::from(digit - b'0'), 3)),
        _ => None,
    }
}
