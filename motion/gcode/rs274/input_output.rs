//! Inputs and outputs (M62 to M68) and user-defined M functions (M100 to M199).
//!
//! Each is an M function at which the path waits, with its words as parameters:
//!
//! ```text
//! M62 M63 M64 M65   K = P: number of the digital output
//! M66               K = P or L = E: number of the digital or analog input; O: wait type (L), timeout (Q), s
//! M67 M68           K = E: number of the analog output, L = Q: its value
//! M100 to M199      K = P, L = Q
//! ```
//!
//! The value that M66 reads (#5399) is -1: it is unknown before the program runs.

use super::block::{Block, Letter, Letters};
use super::error::{DecodeError, Problem};
use super::leniency::Leniency;
use super::output::Output;
use super::parameters::Target;
use super::state::State;
use twin_path::{ElementKind, MParameters};

/// Parameter with the value that M66 has read.
const RESULT: u16 = 5399;

/// The largest number of an output, an input or a tool.
const MAX_NUMBER: f64 = 1e6;

/// The last wait type of M66 (low).
const MAX_WAIT: f64 = 4.0;

/// The words that M functions of inputs, outputs, overrides and the user take.
pub(super) fn m_letters(block: &Block) -> Letters {
    let mut letters = Letters::default();
    letters = letters.with(match block.m.input_output {
        Some(62..=65) => Letters::of("P"),
        Some(66) => Letters::of("PELQ"),
        Some(_) => Letters::of("EQ"),
        None => Letters::default(),
    });
    if matches!(block.m.overrides, Some(50..=53)) {
        letters = letters.with(Letters::of("P"));
    }
    if block.m.user.is_some() || !block.other_m.is_empty() {
        letters = letters.with(Letters::of("PQ"));
    }
    letters
}

impl State {
    /// M62 to M68.
    ///
    /// # Errors
    /// Those of missing and wrong words.
    pub(super) fn set_outputs(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        let Some(number) = block.m.input_output else { return Ok(()) };
        let missing = |word| DecodeError::missing(format!("M{number}"), word);
        let channel = |letter| rounded(block, letter).map(|it| it.map(f64::from));
        let parameters = match number {
            66 => {
                self.set_parameter(&Target::Numbered(RESULT), -1.0);
                wait(block)?
            }
            67 | 68 => MParameters {
                k: Some(channel(Letter::E)?.ok_or(missing("E: the number of the analog output"))?),
                l: Some(block.get(Letter::Q).ok_or(missing("Q: the value of the analog output"))?),
                o: None,
            },
            _ => MParameters {
                k: Some(channel(Letter::P)?.ok_or(missing("P: the number of the digital output"))?),
                ..MParameters::default()
            },
        };
        self.stand(ElementKind::MFunction { number }, parameters, out);
        Ok(())
    }

    /// M100 to M199, and other numbers than those of LinuxCNC.
    ///
    /// # Errors
    /// That of [`Self::forgive`].
    pub(super) fn call_user(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        for (number, columns) in &block.other_m {
            self.forgive(Leniency::UnknownM(*number), Some(columns.clone()), out)?;
        }
        let (k, l) = (block.get(Letter::P), block.get(Letter::Q));
        for number in block.other_m.iter().map(|(number, _)| *number).chain(block.m.user) {
            self.stand(ElementKind::MFunction { number }, MParameters { k, l, o: None }, out);
        }
        Ok(())
    }
}

/// The nearest whole number of a word that names an output, an input or a tool (M61).
pub(super) fn rounded(block: &Block, letter: Letter) -> Result<Option<u32>, Problem> {
    let number = State::in_range(block, letter, MAX_NUMBER)?.map(f64::round);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    Ok(number.map(|number| number as u32))
}

/// The parameters of M66.
fn wait(block: &Block) -> Result<MParameters, Problem> {
    let channel = |letter| rounded(block, letter).map(|it| it.map(f64::from));
    let (digital, analog) = (channel(Letter::P)?, channel(Letter::E)?);
    let kind = block.whole_within(Letter::L, [0.0, MAX_WAIT])?.unwrap_or(0);
    let timeout = block.get(Letter::Q).unwrap_or(0.0).max(0.0);
    match (digital, analog) {
        (None, None) => {
            let input = "the number of its input: P if it is digital, E if it is analog";
            return Err(DecodeError::missing("M66", input).into());
        }
        (Some(_), Some(_)) => return Err(block.at(Letter::E, DecodeError::WaitForTwoInputs)),
        (None, Some(_)) if kind > 0 => return Err(block.at(Letter::L, DecodeError::WaitForAnalog)),
        _ => {}
    }
    if kind > 0 && timeout <= 0.0 {
        return Err(block.at(Letter::L, DecodeError::WaitWithoutTimeout));
    }
    let o = Some([f64::from(kind), timeout, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    Ok(MParameters { k: digital, l: analog, o })
}
