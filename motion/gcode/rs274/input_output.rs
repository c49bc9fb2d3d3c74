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
use super::word::MWords;
use twin_path::{ElementKind, MParameters};

/// Parameter with the value that M66 has read.
const RESULT: u16 = 5399;

/// The last wait type of M66 (low).
const MAX_WAIT: u32 = 4;

/// The words that M functions of inputs, outputs, overrides and the user take.
pub(super) fn m_letters(block: &Block) -> Letters {
    let mut letters = Letters::default();
    letters = letters.with(match block.m.input_output {
        Some(62..=65) => Letters::of(&[Letter::P]),
        Some(66) => Letters::of(&[Letter::P, Letter::E, Letter::L, Letter::Q]),
        Some(_) => Letters::of(&[Letter::E, Letter::Q]),
        None => Letters::default(),
    });
    if matches!(block.m.overrides, Some(50..=53)) {
        letters = letters.with(Letters::of(&[Letter::P]));
    }
    if block.m.user.is_some() {
        letters = letters.with(Letters::of(&[Letter::P, Letter::Q]));
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
        let missing =
            |letter: Letter| DecodeError::MissingMWord { m: number, letter: letter.as_char() };
        let channel = |letter| block.whole_at(letter, 0).map(|it| it.map(f64::from));
        let parameters = match number {
            66 => {
                self.set_parameter(&Target::Numbered(RESULT), -1.0);
                wait(block)?
            }
            67 | 68 => MParameters {
                k: Some(channel(Letter::E)?.ok_or(missing(Letter::E))?),
                l: Some(block.get(Letter::Q).ok_or(missing(Letter::Q))?),
                o: None,
            },
            _ => MParameters {
                k: Some(channel(Letter::P)?.ok_or(missing(Letter::P))?),
                ..MParameters::default()
            },
        };
        self.stand(ElementKind::MFunction { number }, parameters, out);
        Ok(())
    }

    /// M100 to M199, and other numbers than those of LinuxCNC.
    ///
    /// # Errors
    /// [`DecodeError::UnsupportedCode`] for the latter, where it is strict.
    pub(super) fn call_user(&mut self, block: &Block, out: &mut Output) -> Result<(), Problem> {
        if let Some(number) = block.m.user {
            if !MWords::knows(number) {
                self.forgive(Leniency::UnknownM(number), block.code_columns(), out)?;
            }
            let (k, l) = (block.get(Letter::P), block.get(Letter::Q));
            self.stand(ElementKind::MFunction { number }, MParameters { k, l, o: None }, out);
        }
        Ok(())
    }
}

/// The parameters of M66.
fn wait(block: &Block) -> Result<MParameters, Problem> {
    let channel = |letter| block.whole_at(letter, 0).map(|it| it.map(f64::from));
    let (digital, analog) = (channel(Letter::P)?, channel(Letter::E)?);
    let kind = block.whole_at(Letter::L, 0)?.unwrap_or(0);
    let timeout = block.get(Letter::Q).unwrap_or(0.0).max(0.0);
    let at = |letter: Letter, error| Problem { columns: block.columns(letter), error };
    match (digital, analog) {
        (None, None) => return Err(DecodeError::WaitWithoutInput.into()),
        (Some(_), Some(_)) => return Err(at(Letter::E, DecodeError::WaitForTwoInputs)),
        (None, Some(_)) if kind > 0 => return Err(at(Letter::L, DecodeError::WaitForAnalog)),
        _ => {}
    }
    if kind > MAX_WAIT {
        let (value, max) = (f64::from(kind), f64::from(MAX_WAIT));
        let error = DecodeError::OutOfRange { letter: 'L', value, min: 0.0, max, unit: "" };
        return Err(at(Letter::L, error));
    }
    if kind > 0 && timeout <= 0.0 {
        return Err(at(Letter::L, DecodeError::WaitWithoutTimeout));
    }
    let o = Some([f64::from(kind), timeout, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    Ok(MParameters { k: digital, l: analog, o })
}
