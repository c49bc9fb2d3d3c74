//! Set-up of an emulated device before it starts: control commands from `--bench` files and `--with`.

use super::faults::Said;
use super::{Common, Failure};
use crate::bounded;
use std::io::{self, Write};
use twin_drives::Control;

/// A line of words, and where it stands.
#[derive(Debug)]
struct Line {
    origin: String,
    text: String,
}

/// The words of `--bench` and `--with`, understood one after the other: `obey` takes each into what is set up, or gives
/// back what is to happen as soon as the device runs.
///
/// # Errors
/// What is wrong with a line, and where it stands.
pub(super) fn set_up<E>(
    common: &Common,
    mut obey: impl FnMut(&[&str]) -> Result<Option<Control<E>>, Said>,
) -> Result<Vec<Control<E>>, Failure> {
    let mut afterwards = Vec::new();
    for line in lines(common)? {
        let words: Vec<_> = line.text.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        match obey(&words) {
            Ok(later) => afterwards.extend(later),
            // Help is asked for, or something is wrong.
            Err(Ok(said) | Err(said)) => {
                let Line { origin, text } = line;
                return Err(Failure::Usage(format!("{origin}: `{}`: {said}", text.trim())));
            }
        }
    }
    Ok(afterwards)
}

/// Says what words there are, or about one of them, if `--with` asks for that; true if it did.
pub(super) fn help(
    common: &Common,
    obey: impl Fn(&[&str]) -> Result<(), Said>,
) -> Result<bool, Failure> {
    let mut helped = false;
    for said in &common.with {
        let words: Vec<_> = said.split_whitespace().collect();
        if words.first() == Some(&"help")
            && let Err(Ok(text)) = obey(&words)
        {
            writeln!(io::stdout(), "{text}").map_err(Failure::Stdio)?;
            helped = true;
        }
    }
    Ok(helped)
}

/// All lines in their order: files first.
fn lines(common: &Common) -> Result<Vec<Line>, Failure> {
    let mut lines = Vec::new();
    for path in &common.bench {
        let name = path.display();
        let text = bounded::read_to_string(path)
            .map_err(|source| Failure::Usage(format!("--bench {name}: {source}")))?;
        lines.extend((1..).zip(text.lines()).map(|(number, line)| Line {
            origin: format!("{name}:{number}"),
            text: line.split('#').next().unwrap_or_default().to_owned(),
        }));
    }
    let said = common.with.iter();
    lines.extend(said.map(|text| Line { origin: "--with".to_owned(), text: text.clone() }));
    Ok(lines)
}

/// `FROM..TO`, of which either may be left out.
///
/// # Errors
/// What is wrong with it.
pub(super) fn stretch(text: &str) -> Result<(Option<i32>, Option<i32>), String> {
    let wanted = "expected FROM..TO, FROM.. or ..TO in whole increments, like -3000..-1500";
    let (from, to) = text.split_once("..").ok_or(wanted)?;
    let end = |text: &str| match text {
        "" => Ok(None),
        text => text.parse().map(Some).map_err(|_no_number| wanted),
    };
    let (from, to) = (end(from)?, end(to)?);
    if let (Some(from), Some(to)) = (from, to)
        && from >= to
    {
        return Err(format!("it begins at {from}, which must lie below its end {to}"));
    }
    Ok((from, to))
}

#[cfg(test)]
mod tests {
    use super::stretch;

    #[test]
    fn a_stretch_has_two_ends_or_one() {
        assert_eq!(stretch("-3000..-1500"), Ok((Some(-3000), Some(-1500))));
        assert_eq!(stretch("8000.."), Ok((Some(8000), None)));
        assert_eq!(stretch("..-500"), Ok((None, Some(-500))));
        for nonsense in ["", "5", "5-6", "a..b", "1.5..2", "1..2..3"] {
            assert!(stretch(nonsense).is_err_and(|why| why.contains("FROM..TO")), "{nonsense}");
        }
        assert!(stretch("5..-5").is_err_and(|why| why.contains("its end -5")));
    }
}
