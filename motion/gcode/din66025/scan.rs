//! Scan of a program for the preparation stages and jumps that it names, without decoding it.

use std::io::{self, BufRead};
use twin_path::Marks;

/// The start marks of all G41, G42, G51, G52 and G61 in a program's text, in comments, too: what preparation it may
/// need. A command whose number is a variable is not seen.
///
/// # Errors
/// If `program` cannot be read.
pub fn marks_in(program: impl BufRead) -> io::Result<Marks> {
    let mut marks = Marks::default();
    commands(program, |number| marks = marks.with(starts(number)))?;
    Ok(marks)
}

/// True if a program may jump (G20): it names the command anywhere, in comments, too, or a command whose number is a
/// variable.
///
/// # Errors
/// If `program` cannot be read.
pub(super) fn may_jump(program: impl BufRead) -> io::Result<bool> {
    let mut jumps = false;
    commands(program, |number| jumps |= matches!(number, Some(20) | None))?;
    Ok(jumps)
}

/// Hands on the number after each G, none where it is a variable.
fn commands(mut program: impl BufRead, mut each: impl FnMut(Option<u32>)) -> io::Result<()> {
    // The number after a G as far as it has been read: none outside of such a word.
    let mut number: Option<u32> = None;
    loop {
        let chunk = match program.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            other => other?,
        };
        for byte in chunk {
            match (byte, number) {
                (b'G' | b'g', _) => {
                    if number.is_some() {
                        each(number);
                    }
                    number = Some(0);
                }
                (b'0'..=b'9', Some(value)) => {
                    number = Some(value.saturating_mul(10).saturating_add(u32::from(byte - b'0')));
                }
                // A sign belongs to the number.
                (b'+', Some(0)) | (_, None) => {}
                (b'$', Some(0)) => {
                    each(None);
                    number = None;
                }
                (_, Some(_)) => {
                    each(number);
                    number = None;
                }
            }
        }
        let length = chunk.len();
        program.consume(length);
        if length == 0 {
            if number.is_some() {
                each(number);
            }
            return Ok(());
        }
    }
}

fn starts(number: Option<u32>) -> Marks {
    match number {
        Some(41) => Marks::CORRECTION_LEFT,
        Some(42) => Marks::CORRECTION_RIGHT,
        Some(51) => Marks::SMOOTHING,
        Some(52) => Marks::ROUNDING,
        Some(61) => Marks::LOOPS,
        _ => Marks::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    #[test]
    fn marks_are_found_wherever_the_reader_stops() {
        let program = "%\nN10 G1 X41 G91\nN20 g042D3\nN30 G+61.0\n(G52) G510 G411 X52 G4\n1G51";
        let expected =
            Marks::CORRECTION_RIGHT.with(Marks::LOOPS).with(Marks::ROUNDING).with(Marks::SMOOTHING);
        for capacity in 1..40 {
            let reader = BufReader::with_capacity(capacity, program.as_bytes());
            assert_eq!(marks_in(reader).unwrap(), expected);
        }
        assert_eq!(marks_in(&b"N10 G1 X1 F10"[..]).unwrap(), Marks::default());
    }

    #[test]
    fn jumps_are_found() {
        for (program, jumps) in [
            ("%\nN10 G1 X20", false),
            ("%\nN10 g020 L10", true),
            ("%\nN10 G20.0L10", true),
            ("%\nN10 G$a$ L10", true),
            ("%\nN10 G120 X$a$", false),
            ("%\nN10 X1G20", true),
        ] {
            assert_eq!(may_jump(program.as_bytes()).unwrap(), jumps, "{program}");
        }
    }
}
