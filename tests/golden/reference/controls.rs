//! Words of RS274 that each control takes.

use super::{cell, compare};
use std::fmt::Write;
use twin_gcode::rs274::{CONTROL_WORDS, Cell, Control, Reading};

const HEAD: &str = "\
# Words of controls

`--for CONTROL`, or `control` in `[rs274]` of the [machine file](machine_file.md), says for which control an RS274 program is meant. Words that it refuses are errors, words that it passes over or reads differently are warnings, each once with its count:

```sh
twin check part.ngc --machine machines/gantry3.toml --for grbl
twin path part.ngc --for grbl --format rs274 --output part.nc
```

The second command writes the path of a program with words that the control takes: canned cycles, loops, offsets, splines and inverse time become moves, all in mm.

| sign | the control |
|---|---|
| `+` | reads the word as LinuxCNC does |
| `-` | refuses it (error) |
| `o` | passes over it (warning) |
| `~` | reads it differently (warning), and twin reads it as LinuxCNC does |
| `=` | reads it differently, and so does twin with `--for` |
| `?` | is unknown; in front of another sign: probably (warning) |

Versions: LinuxCNC 2.9, grbl 1.1h, grblHAL 1.1f and FluidNC 3.9 as their sources have it, Fanuc 0i-F and 31i for milling and Mach3 Mill by secondary sources, SoftMotion 2.3 by its manual. Options of a control may change it. Columns: LC LinuxCNC, g grbl, gH grblHAL, FN FluidNC, Fa Fanuc, M3 Mach3, SM SoftMotion.

| word | meaning in LinuxCNC | LC | g | gH | FN | Fa | M3 | SM |
|---|---|---|---|---|---|---|---|---|
";

fn sign(Cell { reading, certain, .. }: Cell) -> String {
    let sign = match reading {
        Reading::Same => "+",
        Reading::Refused => "-",
        Reading::PassedOver => "o",
        Reading::Different => "~",
        Reading::Followed => "=",
        Reading::Unknown => "?",
    };
    format!("{}{sign}", if certain { "" } else { "?" })
}

#[test]
fn the_chapter_on_controls_is_up_to_date() {
    let mut page = HEAD.to_owned();
    for row in CONTROL_WORDS.iter() {
        let signs: Vec<_> = row.cells.into_iter().map(sign).collect();
        let (word, meaning) = (cell(row.word), cell(row.meaning));
        writeln!(page, "| {word} | {meaning} | {} |", signs.join(" | ")).expect("a string");
    }
    for control in Control::ALL {
        let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
        for row in CONTROL_WORDS.iter() {
            let reason = row.cell(control).map_or("", |cell| cell.reason);
            match reasons.iter_mut().find(|(known, _)| *known == reason) {
                _ if reason.is_empty() => {}
                Some((_, words)) => words.push(row.word),
                None => reasons.push((reason, vec![row.word])),
            }
        }
        writeln!(page, "\n## {control}\n").expect("a string");
        for (reason, words) in reasons {
            writeln!(page, "- {}: {reason}", words.join(", ")).expect("a string");
        }
    }
    compare("controls.md", &page);
}
