//! Cams written by hand.
//!
//! A line says one thing; what follows a `#` is for people. Words are parted by spaces.
//!
//! ```text
//! cam lift                     # its name; `tappets NAME` for tappets without a curve
//! master 0 360 step 20 unit °  # scale of the master: the curve begins and ends with it
//! slave 0 100 step 10 unit mm  # scale of the slave, for pictures
//! period 360                   # the slave's; the cam is periodic then, and its end that of its begin
//! point 0 0                    # master and slave; velocity and acceleration are 0 …
//! point 200 90 v 0.5 a 0.01    # … unless they are given
//! line 60 20 120 70            # from master and slave to master and slave
//! tappet 1 at 45 positive on   # group, master, positive|negative|every, on|off|invert …
//! tappet 2 at 60 every timed delay_us 1500 duration_us 3000   # … or for a time
//! ```

use super::super::knot::Knot;
use super::super::source::{Element, Kind, Scale, Source};
use super::super::tappet::{Action, Passage, Tappet};
use std::str::SplitWhitespace;

/// What is wrong with a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TextError {
    /// The line begins with a word that means nothing.
    #[error(
        "line {line}: `{key}` is not one of cam, tappets, master, slave, period, point, line, tappet"
    )]
    UnknownKey {
        /// Which line, from 1.
        line: usize,
        /// The word.
        key: String,
    },
    /// A key that may stand once stands again.
    #[error("line {line}: `{key}` stands twice")]
    Twice {
        /// The later line, from 1.
        line: usize,
        /// The key.
        key: &'static str,
    },
    /// The line ends too early.
    #[error("line {line}: `{key}` needs {needs}")]
    Missing {
        /// Which line, from 1.
        line: usize,
        /// Its key.
        key: &'static str,
        /// What is missing.
        needs: &'static str,
    },
    /// A word is not what should stand there.
    #[error("line {line}: `{key}`: `{value}` is not {expected}")]
    Value {
        /// Which line, from 1.
        line: usize,
        /// Its key.
        key: &'static str,
        /// What stands there.
        value: String,
        /// What should.
        expected: &'static str,
    },
    /// A number is outside its limits.
    #[error("line {line}: `{key}`: {name} {value} is not {limit}")]
    Limit {
        /// Which line, from 1.
        line: usize,
        /// Its key.
        key: &'static str,
        /// Which of its numbers.
        name: &'static str,
        /// The number.
        value: f64,
        /// What it should be.
        limit: String,
    },
    /// There is no line with this key.
    #[error("there is no `{key}`")]
    NoLine {
        /// The key.
        key: &'static str,
    },
}

/// Reads a cam written by hand.
///
/// # Errors
/// [`TextError`] with line, key, value and limit. That elements make a curve is seen when it is compiled.
pub fn read_text(text: &str) -> Result<Source, TextError> {
    let mut reader = Reader::default();
    for (line, text) in (1..).zip(text.lines()) {
        let said = text.split('#').next().unwrap_or_default();
        let said = said.trim_start_matches('\u{feff}');
        reader.line(line, said)?;
    }
    let missing = |key| TextError::NoLine { key };
    let (kind, name) = reader.head.ok_or(missing("cam"))?;
    let master = reader.master.ok_or(missing("master"))?;
    let whole = || Scale { min: 0.0, max: 1.0, step: 0.1, unit: String::new() };
    let slave = match (kind, reader.slave) {
        (_, Some(slave)) => slave,
        (Kind::Tappets, None) => whole(),
        (Kind::Cam, None) => return Err(missing("slave")),
    };
    let mut source = Source {
        name,
        kind,
        master,
        slave,
        period: reader.period,
        elements: Vec::new(),
        tappets: Vec::new(),
    };
    for (line, element) in reader.elements {
        let key = if matches!(element, Element::Line { .. }) { "line" } else { "point" };
        for master in element.ends().map(|knot| knot.master) {
            inside(line, key, master, &source.master)?;
        }
        source.insert(element);
    }
    for (line, tappet) in reader.tappets {
        inside(line, "tappet", tappet.master, &source.master)?;
        source.insert_tappet(tappet);
    }
    Ok(source)
}

fn inside(line: usize, key: &'static str, value: f64, scale: &Scale) -> Result<(), TextError> {
    if (scale.min..=scale.max).contains(&value) {
        return Ok(());
    }
    let limit = format!("from {} to {}", scale.min, scale.max);
    Err(TextError::Limit { line, key, name: "master", value, limit })
}

#[derive(Default)]
struct Reader {
    head: Option<(Kind, String)>,
    master: Option<Scale>,
    slave: Option<Scale>,
    period: Option<f64>,
    elements: Vec<(usize, Element)>,
    tappets: Vec<(usize, Tappet)>,
}

impl Reader {
    fn line(&mut self, line: usize, text: &str) -> Result<(), TextError> {
        let mut words = text.split_whitespace();
        let Some(key) = words.next() else { return Ok(()) };
        match key {
            "cam" | "tappets" => {
                let (key, kind) =
                    if key == "cam" { ("cam", Kind::Cam) } else { ("tappets", Kind::Tappets) };
                let name = words.collect::<Vec<_>>().join(" ");
                if name.is_empty() {
                    return Err(TextError::Missing { line, key, needs: "a name" });
                }
                return once(line, key, &mut self.head, (kind, name));
            }
            "master" => {
                let mut said = Said { line, key: "master", words };
                let scale = said.scale()?;
                said.end()?;
                return once(line, "master", &mut self.master, scale);
            }
            "slave" => {
                let mut said = Said { line, key: "slave", words };
                let scale = said.scale()?;
                said.end()?;
                return once(line, "slave", &mut self.slave, scale);
            }
            "period" => {
                let mut said = Said { line, key: "period", words };
                let period = said.positive("period")?;
                said.end()?;
                return once(line, "period", &mut self.period, period);
            }
            "point" => {
                let mut said = Said { line, key: "point", words };
                let mut knot = Knot::at_rest(said.number("master")?, said.number("slave")?);
                let [velocity, acceleration] = said.named(["v", "a"])?;
                knot.velocity = velocity.unwrap_or(0.0);
                knot.acceleration = acceleration.unwrap_or(0.0);
                self.elements.push((line, Element::Point(knot)));
            }
            "line" => {
                let mut said = Said { line, key: "line", words };
                let from = [said.number("master")?, said.number("slave")?];
                let to = [said.number("end of the master")?, said.number("end of the slave")?];
                said.end()?;
                if to[0] <= from[0] {
                    let (name, limit) = ("end of the master", format!("greater than {}", from[0]));
                    return Err(TextError::Limit { line, key: "line", name, value: to[0], limit });
                }
                self.elements.push((line, Element::Line { from, to }));
            }
            "tappet" => {
                let tappet = Said { line, key: "tappet", words }.tappet()?;
                self.tappets.push((line, tappet));
            }
            key => return Err(TextError::UnknownKey { line, key: key.to_owned() }),
        }
        Ok(())
    }
}

fn once<T>(
    line: usize,
    key: &'static str,
    slot: &mut Option<T>,
    value: T,
) -> Result<(), TextError> {
    if slot.replace(value).is_some() { Err(TextError::Twice { line, key }) } else { Ok(()) }
}

/// The words of a line behind its key.
struct Said<'a> {
    line: usize,
    key: &'static str,
    words: SplitWhitespace<'a>,
}

impl<'a> Said<'a> {
    fn word(&mut self, needs: &'static str) -> Result<&'a str, TextError> {
        let Self { line, key, .. } = *self;
        self.words.next().ok_or(TextError::Missing { line, key, needs })
    }

    fn wrong(&self, value: &str, expected: &'static str) -> TextError {
        TextError::Value { line: self.line, key: self.key, value: value.to_owned(), expected }
    }

    fn number(&mut self, needs: &'static str) -> Result<f64, TextError> {
        let word = self.word(needs)?;
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.wrong(word, "a number"))
    }

    fn positive(&mut self, name: &'static str) -> Result<f64, TextError> {
        let value = self.number(name)?;
        if value > 0.0 {
            return Ok(value);
        }
        let Self { line, key, .. } = *self;
        Err(TextError::Limit { line, key, name, value, limit: "greater than 0".to_owned() })
    }

    fn scale(&mut self) -> Result<Scale, TextError> {
        let (min, max) = (self.number("least value")?, self.number("greatest value")?);
        if max <= min {
            let Self { line, key, .. } = *self;
            let (name, limit) = ("greatest value", format!("greater than {min}"));
            return Err(TextError::Limit { line, key, name, value: max, limit });
        }
        let mut scale = Scale { min, max, step: (max - min) / 10.0, unit: String::new() };
        while let Some(word) = self.words.next() {
            match word {
                "step" => scale.step = self.positive("step")?,
                "unit" => self.word("a unit")?.clone_into(&mut scale.unit),
                other => return Err(self.wrong(other, "step or unit")),
            }
        }
        Ok(scale)
    }

    /// Numbers behind their names, in any order, to the end of the line.
    fn named<const N: usize>(
        &mut self,
        names: [&'static str; N],
    ) -> Result<[Option<f64>; N], TextError> {
        let mut found = [None; N];
        while let Some(word) = self.words.next() {
            let slot = names.iter().zip(&mut found).find(|(name, _)| **name == word);
            let Some((name, slot)) = slot else {
                return Err(self.wrong(word, "a name of a number"));
            };
            *slot = Some(self.number(name)?);
        }
        Ok(found)
    }

    fn tappet(&mut self) -> Result<Tappet, TextError> {
        let word = self.word("a group")?;
        let group = word.parse().ok();
        let group = group.ok_or_else(|| self.wrong(word, "a group of -32768 to 32767"))?;
        match self.word("at and a master")? {
            "at" => {}
            other => return Err(self.wrong(other, "at")),
        }
        let master = self.number("a master")?;
        let passage = match self.word("positive, negative or every")? {
            "positive" => Passage::Positive,
            "negative" => Passage::Negative,
            "every" => Passage::Every,
            other => return Err(self.wrong(other, "positive, negative or every")),
        };
        let action = match self.word("on, off, invert or timed")? {
            "on" => Action::On,
            "off" => Action::Off,
            "invert" => Action::Invert,
            "timed" => self.timed()?,
            other => return Err(self.wrong(other, "on, off, invert or timed")),
        };
        self.end()?;
        Ok(Tappet { group, master, passage, action })
    }

    fn timed(&mut self) -> Result<Action, TextError> {
        let [delay, duration] = self.named(["delay_us", "duration_us"])?;
        let Self { line, key, .. } = *self;
        let duration =
            duration.ok_or(TextError::Missing { line, key, needs: "duration_us and a number" })?;
        let ns = |name, value: f64| {
            if (0.0..=MOST_US).contains(&value) {
                #[expect(clippy::cast_possible_truncation, reason = "limited just before")]
                return Ok((value * 1e3).round() as i64);
            }
            let limit = format!("from 0 to {MOST_US}");
            Err(TextError::Limit { line, key, name, value, limit })
        };
        Ok(Action::Timed {
            delay_ns: ns("delay_us", delay.unwrap_or(0.0))?,
            duration_ns: ns("duration_us", duration)?,
        })
    }

    fn end(&mut self) -> Result<(), TextError> {
        match self.words.next() {
            Some(word) => Err(self.wrong(word, "expected here: the line should end")),
            None => Ok(()),
        }
    }
}

/// The longest time of a tappet, µs: a day.
const MOST_US: f64 = 86_400e6;
