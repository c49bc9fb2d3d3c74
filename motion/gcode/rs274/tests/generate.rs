//! Random programs of the grammar in `grammar.txt`, most of them valid.

use std::f64::consts::TAU;

const GRAMMAR: &str = include_str!("grammar.txt");

/// A plane, the letters of its first and second axis and its normal, and those of the centre.
const PLANES: [(&str, [char; 3], [char; 2]); 3] = [
    ("G17", ['X', 'Y', 'Z'], ['I', 'J']),
    ("G18", ['Z', 'X', 'Y'], ['K', 'I']),
    ("G19", ['Y', 'Z', 'X'], ['J', 'K']),
];

/// Features that together differ from LinuxCNC's, as the documentation of `rs274` says.
const APART: [(&str, &str); 4] = [
    ("do", "breaks"),
    ("rotation", "shift"),
    ("rotation", "local-shift"),
    ("rotary-c", "auxiliary"),
];

/// The features of the grammar whose mark is one of `marks`: + if the decoder has them, - if not.
pub(super) fn features(marks: &str) -> Vec<&'static str> {
    let marked = GRAMMAR.lines().filter(|line| line.starts_with(['+', '-']));
    let marked = marked.filter(|line| line.starts_with(|mark| marks.contains(mark)));
    marked.filter_map(|line| line.split_whitespace().nth(1)).collect()
}

#[derive(Debug)]
struct Rule {
    symbol: &'static str,
    weight: u32,
    features: Vec<&'static str>,
    text: &'static str,
}

fn rules() -> Vec<Rule> {
    let lines = GRAMMAR.lines().filter(|line| !line.starts_with(['#', '+', '-']));
    let rules = lines.map(|line| {
        let (head, text) = line.split_once(": ").unwrap();
        let (symbol, head) = head.split_once(' ').unwrap();
        let (weight, features) = head.split_once(' ').unwrap();
        let features = features.split_whitespace().collect();
        Rule { symbol, weight: weight.parse().unwrap(), features, text }
    });
    rules.collect()
}

#[derive(Debug)]
struct Generator {
    random: u64,
    rules: Vec<Rule>,
    features: Vec<&'static str>,
    labels: u32,
    nesting: u32,
}

/// The program of a seed, with these features at most.
pub(super) fn program(seed: u64, features: &[&'static str]) -> String {
    let (rules, features) = (rules(), features.to_vec());
    let mut generator = Generator { random: seed, rules, features, labels: 400, nesting: 0 };
    // Programs of some features find more than those of all.
    let kept = 2 + generator.up_to(3);
    let mut features = std::mem::take(&mut generator.features);
    features.retain(|_| generator.up_to(5) <= kept);
    for (one, other) in APART {
        if features.contains(&one) {
            features.retain(|feature| *feature != other);
        }
    }
    generator.features = features;
    let subroutines = generator.symbol("subroutines");
    let fanuc = generator.symbol("fanuc");
    // Subroutines call none.
    generator.features.push("called");
    let text = generator.symbol("program").replace("SUBROUTINES", &subroutines);
    let lines = text.lines().chain(fanuc.lines()).filter(|line| !line.is_empty());
    lines.map(|line| generator.line(line) + "\n").collect()
}

impl Generator {
    /// Random bits: `SplitMix64`.
    fn next(&mut self) -> u64 {
        self.random = self.random.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = self.random;
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn up_to(&mut self, most: u32) -> u32 {
        u32::try_from(self.next() % (u64::from(most) + 1)).unwrap()
    }

    fn below(&mut self, count: usize) -> usize {
        usize::try_from(self.next() % count as u64).unwrap()
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    fn has(&self, feature: &str) -> bool {
        self.features.contains(&feature)
    }

    /// `text` with everything in braces replaced.
    fn expand(&mut self, text: &str) -> String {
        let Some(start) = text.find('{') else { return text.to_owned() };
        let end = start + closing(&text[start..]);
        let inside = &text[start + 1..end];
        let choices = split(inside, '|');
        let chosen = if choices.len() > 1 {
            let choice = self.pick(&choices);
            self.expand(choice)
        } else if let Some((from, to)) = inside.split_once("..") {
            let (from, to): (u32, u32) = (from.parse().unwrap(), to.parse().unwrap());
            (from + self.up_to(to - from)).to_string()
        } else {
            self.symbol(inside)
        };
        format!("{}{chosen}{}", &text[..start], self.expand(&text[end + 1..]))
    }

    fn symbol(&mut self, symbol: &str) -> String {
        match symbol {
            "literal" => return self.literal(),
            "arc" => return self.arc(),
            "radius arc" => return self.radius_arc(),
            _ => {}
        }
        let is_possible =
            |rule: &&Rule| rule.symbol == symbol && rule.features.iter().all(|one| self.has(one));
        let mut rules: Vec<(u32, &'static str)> =
            self.rules.iter().filter(is_possible).map(|rule| (rule.weight, rule.text)).collect();
        let goes_deeper = matches!(symbol, "section" | "value");
        if goes_deeper && self.nesting >= 3 {
            rules.truncate(1);
        }
        let mut at = self.up_to(rules.iter().map(|rule| rule.0).sum::<u32>().saturating_sub(1));
        let mut text = rules.first().unwrap_or_else(|| panic!("no rule for {symbol}")).1;
        for (weight, choice) in rules {
            if at < weight {
                text = choice;
                break;
            }
            at -= weight;
        }
        self.labels += 2;
        let labels = [self.labels, self.labels + 1].map(|label| label.to_string());
        let text = text.replace("\\n", "\n").replace('@', &labels[0]).replace('$', &labels[1]);
        let nesting = self.nesting;
        self.nesting = if symbol == "number" { 1 } else { nesting + u32::from(goes_deeper) };
        let expanded = self.expand(&text);
        self.nesting = nesting;
        // LinuxCNC's lines have at most 255 characters.
        if symbol == "chain" && expanded.len() > 60 { self.symbol(symbol) } else { expanded }
    }

    fn literal(&mut self) -> String {
        let decimals = self.below(4);
        let value = f64::from(self.up_to(80_000)) / 1e3 - 40.0;
        let text = format!("{value:.decimals$}");
        match self.up_to(9) {
            0 => text.replace("0.", "."),
            1 if decimals == 0 => text + ".",
            2 if value >= 0.5 => format!("+{text}"),
            _ => text,
        }
    }

    /// A word whose number must be this one.
    fn exact(&mut self, letter: char, value: f64) -> String {
        let (value, other) = (rounded(value), f64::from(self.up_to(9)));
        if self.has("expressions") && other < 2.0 {
            return format!(" {letter}[{} - {other}]", rounded(value + other));
        }
        format!(" {letter}{value}")
    }

    /// One or two arcs about their centres, the second without its G word.
    fn arc(&mut self) -> String {
        let (mut text, mut at, [first, second, normal], centers) = self.begin_arc();
        let mut motion = self.pick(&["\nG2", "\nG3"]);
        for _ in 0..=self.up_to(1) {
            let radius = f64::from(1 + self.up_to(20));
            let from = f64::from(self.up_to(23)) / 24.0 * TAU;
            let to = from + f64::from(1 + self.up_to(22)) / 24.0 * TAU;
            let center = [at[0] - radius * from.cos(), at[1] - radius * from.sin()].map(rounded);
            let end = [center[0] + radius * to.cos(), center[1] + radius * to.sin()].map(rounded);
            let modes: &[_] =
                if self.has("absolute-centers") { &["G90.1", "G91.1"] } else { &[""] };
            let mode = self.pick(modes);
            let origin = if mode == "G90.1" { [0.0; 2] } else { at };
            text.extend([motion, " ", mode]);
            text +=
                &[0, 1].map(|axis| self.exact(centers[axis], center[axis] - origin[axis])).concat();
            // A full circle has no end.
            if self.up_to(5) > 0 {
                text += &self.end_of_arc([first, second], at, end);
                at = end;
            }
            text += &self.more_of_arc(normal);
            motion = "\n";
        }
        text
    }

    fn radius_arc(&mut self) -> String {
        let (text, at, [first, second, normal], _) = self.begin_arc();
        let chord = [1 + self.up_to(20), self.up_to(20)].map(f64::from);
        let radius = chord[0].hypot(chord[1]) * f64::from(51 + self.up_to(99)) / 100.0;
        let radius = self.pick(&[radius, radius, -radius]);
        let end = self.end_of_arc([first, second], at, [at[0] + chord[0], at[1] + chord[1]]);
        let (motion, radius) = (self.pick(&["G2", "G3"]), self.exact('R', radius));
        format!("{text}\n{motion}{radius}{end}{}", self.more_of_arc(normal))
    }

    /// The line to the start in a plane that arcs may have, the start, and the letters of the plane.
    fn begin_arc(&mut self) -> (String, [f64; 2], [char; 3], [char; 2]) {
        // LinuxCNC's module turns no centres in other planes.
        let planes = if self.has("planes") && !self.has("rotation") { 3 } else { 1 };
        let (plane, axes, centers) = self.pick(&PLANES[..planes]);
        let at = [self.up_to(30), self.up_to(30)].map(f64::from);
        let words = [0, 1].map(|axis| self.exact(axes[axis], at[axis])).concat();
        (self.expand(&format!("{plane} G90 {{G0|G1}} F60{words}")), at, axes, centers)
    }

    fn end_of_arc(&mut self, letters: [char; 2], at: [f64; 2], end: [f64; 2]) -> String {
        let is_relative = self.has("incremental") && self.up_to(1) == 0;
        let (mode, origin) = if is_relative { (" G91", at) } else { (" G90", [0.0; 2]) };
        let words = [0, 1].map(|axis| self.exact(letters[axis], end[axis] - origin[axis]));
        format!("{mode}{}", words.concat())
    }

    fn more_of_arc(&mut self, normal: char) -> String {
        let rotary = if self.has("rotary") { " {|||A{number}}" } else { "" };
        self.expand(&format!(" F{{1..99}} {{||{normal}{{number}}}} {{||P{{1..3}}}}{rotary}"))
    }

    /// A line of a program: words in any order, in other notations.
    fn line(&mut self, line: &str) -> String {
        let notation = self.has("notation");
        let is_ordered = line.starts_with(['o', 'O']) || line.starts_with("M9");
        let mut text = line.to_owned();
        if !is_ordered {
            let mut words = split(line, ' ');
            words.retain(|word| !word.is_empty());
            for index in (1..words.len()).rev() {
                words.swap(index, self.below(index + 1));
            }
            text = words.join(if notation && self.up_to(2) == 0 { "" } else { " " });
        }
        if !notation {
            return text;
        }
        text = self.pick(&[str::to_owned, str::to_lowercase, str::to_uppercase])(&text);
        if self.up_to(3) == 0 {
            text.insert_str(self.below(text.len() + 1), self.pick(&[" ", "\t", "  "]));
        }
        match self.up_to(11) {
            0 => format!("N{} {text}", self.up_to(99_999)),
            1 => format!("n{}.5{text}", self.up_to(999)),
            2 => format!("/{text}"),
            3 if !is_ordered => format!("/ N7{text}"),
            4 if !is_ordered => format!("(first) {text} ; last (G1 X"),
            5 if !is_ordered => text + "(#1 = [G3])",
            _ => text,
        }
    }
}

/// True until the text that `text` begins with, in brackets, is closed, for each of its characters.
fn is_inside() -> impl FnMut(char) -> bool {
    let mut depth = 0;
    move |c| {
        depth += i32::from("{[<".contains(c)) - i32::from("}]>".contains(c));
        depth > 0
    }
}

/// Where the bracket that `text` begins with is closed.
fn closing(text: &str) -> usize {
    let mut inside = is_inside();
    text.find(|c| !inside(c)).unwrap()
}

/// The parts of `text` between separators that are not in brackets.
fn split(text: &str, separator: char) -> Vec<&str> {
    let mut inside = is_inside();
    text.split(|c| !inside(c) && c == separator).collect()
}

/// `value` with nine decimals.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}
