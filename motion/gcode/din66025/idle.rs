//! Unused words of a block: errors and warnings.

use super::block::Block;
use super::error::DecodeError;
use super::output::Output;
use super::word::{Command, Letter, Word};

/// Words that hold for one block and may have nothing to act on in it.
const LOCAL_WORDS: [Letter; 6] = [Letter::I, Letter::J, Letter::K, Letter::L, Letter::O, Letter::R];

/// Reports words that the block does not use: an error where they would have to act at some later motion, a
/// warning where they do nothing.
pub(super) fn complain(
    command: Command,
    block: &Block,
    moved: bool,
    words: &[Word],
    out: &mut Output,
) {
    let number = command.number();
    let motion_words: &[Letter] = match command {
        Command::Motion(motion) => motion.words(),
        _ => &[],
    };
    for word in words {
        let letter = word.letter;
        let without_motion =
            || DecodeError::WordWithoutMotion { letter: letter.as_char(), command: number };
        if letter.is_target() {
            if !matches!(command, Command::Motion(_) | Command::SetPosition) {
                out.error(word.columns.clone(), without_motion());
            }
        } else if letter == Letter::H {
            if !moved {
                out.error(word.columns.clone(), without_motion());
            }
        } else if LOCAL_WORDS.contains(&letter) {
            let switches = block.switches.first().is_some_and(Option::is_some);
            let used = motion_words.contains(&letter)
                || match letter {
                    Letter::K => block.m.is_some() || command == Command::Jump,
                    Letter::L => block.m.is_some() || switches || command == Command::Jump,
                    Letter::O => {
                        block.m.is_some() || switches || matches!(command, Command::Variable { .. })
                    }
                    _ => false,
                };
            if used {
                continue;
            }
            let acts_later = matches!(letter, Letter::I | Letter::J | Letter::R)
                && !matches!(command, Command::Motion(_) | Command::SetPosition);
            if acts_later {
                out.error(word.columns.clone(), without_motion());
            } else {
                let letter = letter.as_char();
                out.warning(
                    word.columns.clone(),
                    DecodeError::UnusedWord { letter, command: number },
                );
            }
        }
    }
}
