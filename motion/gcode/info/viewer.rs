//! Blocks of a program as a viewer shows them (`SMC_GCodeViewer`, manual 6.2.2).

/// A line of a program as the viewer shows it: without comments, with one blank between words, and with the numbers
/// that `value` gives in place of `$name$` (a name it does not know stays). None if there is nothing in it.
pub fn shown_block(line: &str, value: impl Fn(&str) -> Option<f64>) -> Option<String> {
    let mut text = String::with_capacity(line.len());
    let mut rest = line;
    loop {
        let (before, from) = rest.split_at(rest.find(['(', ';', '$']).unwrap_or(rest.len()));
        text.push_str(before);
        rest = match from.as_bytes().first() {
            Some(b'(') => from.split_once(')').map_or("", |(_, behind)| behind),
            Some(b';') => "",
            _ => {
                let name = from.get(1..).and_then(|name| name.split_once('$'));
                let Some((name, behind)) = name else {
                    text.push_str(from);
                    break;
                };
                match value(name.trim()) {
                    Some(value) => text.push_str(&value.to_string()),
                    None => text.extend(["$", name, "$"]),
                }
                behind
            }
        };
        if rest.is_empty() {
            break;
        }
    }
    let words: Vec<_> = text.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}
