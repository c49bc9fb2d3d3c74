//! Canonical machining functions as LinuxCNC's `rs274 -g` prints them, compared with path elements.
//!
//! The interpreter prints four decimals, in the length unit in force, without the work offsets; a position is its value
//! plus the offsets of G54 to G59.3, of G92 and of the tool. After an error it ends, and twin reads on: then the elements
//! begin with its moves.

use serde_json::Value;
use std::f64::consts::TAU;

/// Half a unit of the last decimal of two printed numbers, mm.
const PRINTED: f64 = 2e-4;

/// A move, dwell or stop; lengths in mm.
#[derive(Debug, Clone, PartialEq)]
enum Move {
    Rapid { end: [f64; 3] },
    Line { end: [f64; 3], feed: f64 },
    Arc { end: [f64; 3], center: [f64; 2], sweep: f64, radius: f64, feed: f64 },
    Dwell { seconds: f64 },
    Stop { m: u64 },
}

/// Modal values of the printed lines.
struct Canon {
    /// Length of the unit in force, mm.
    unit: f64,
    /// Offsets of the work coordinates, G92 and tool, mm.
    offsets: [[f64; 3]; 3],
    /// mm/s.
    feed: f64,
    position: Option<[f64; 3]>,
    moves: Vec<Move>,
    complete: bool,
}

/// Differences between the printed moves of the interpreter and path elements in JSON lines.
pub(crate) fn compare(canonical: &str, elements: &str) -> Result<Vec<String>, String> {
    let canon = Canon::read(canonical)?;
    let elements = elements
        .lines()
        .map(|line| serde_json::from_str(line).map_err(|error| format!("{error} in {line}")))
        .collect::<Result<Vec<Value>, _>>()?;
    let elements: Vec<_> = elements.iter().filter(|element| is_compared(element)).collect();
    let expected = &canon.moves;
    let mut wrong = Vec::new();
    let all = if canon.complete { expected.len() == elements.len() } else { true };
    if !all || expected.len() > elements.len() {
        wrong.push(format!("{} elements, {} moves of rs274", elements.len(), expected.len()));
    }
    for (number, (expected, element)) in expected.iter().zip(elements).enumerate() {
        let differs = expected.differs(element);
        wrong.extend(
            differs.map(|what| {
                format!("move {}: {what}: {element}, rs274 has {expected:?}", number + 1)
            }),
        );
    }
    Ok(wrong)
}

/// M functions other than stops have no counterpart that is compared.
fn is_compared(element: &Value) -> bool {
    element["kind"] != "m" || element["m"] == 0 || element["m"] == 1
}

impl Canon {
    fn read(text: &str) -> Result<Self, String> {
        let mut canon = Self {
            unit: 1.0,
            offsets: [[0.0; 3]; 3],
            feed: 0.0,
            position: None,
            moves: Vec::new(),
            complete: false,
        };
        for line in text.lines() {
            // "   17 N..... STRAIGHT_FEED(1.0000, …)".
            if let Some((_, call)) = line.split_once(" N..... ")
                && let Some((name, arguments)) = call.split_once('(')
            {
                canon.take(name, arguments.trim_end_matches(')'))?;
            }
            canon.complete |= line.trim() == "rc 0";
        }
        Ok(canon)
    }

    fn take(&mut self, name: &str, arguments: &str) -> Result<(), String> {
        let separators = |c: char| c == ',' || c.is_whitespace();
        let numbers: Vec<f64> =
            arguments.split(separators).filter_map(|number| number.parse().ok()).collect();
        let get = |index: usize| {
            let number = numbers.get(index).copied();
            number.ok_or_else(|| format!("{name}({arguments}) has too few numbers"))
        };
        let three = |from: usize| Ok::<_, String>([get(from)?, get(from + 1)?, get(from + 2)?]);
        match name {
            "USE_LENGTH_UNITS" => self.unit = if arguments.contains("INCH") { 25.4 } else { 1.0 },
            "SET_G5X_OFFSET" => self.offsets[0] = self.in_mm(three(1)?),
            "SET_G92_OFFSET" => self.offsets[1] = self.in_mm(three(0)?),
            "USE_TOOL_LENGTH_OFFSET" => self.offsets[2] = self.in_mm(three(0)?),
            "SET_XY_ROTATION" if get(0)?.abs() > 0.0 => {
                return Err("rotated coordinates are not compared".to_owned());
            }
            "SELECT_PLANE" if !arguments.contains("XY") => {
                return Err("planes other than XY are not compared".to_owned());
            }
            "SET_FEED_RATE" => self.feed = get(0)? * self.unit / 60.0,
            "STRAIGHT_TRAVERSE" => {
                let end = self.go(three(0)?);
                self.moves.push(Move::Rapid { end });
            }
            "STRAIGHT_FEED" | "STRAIGHT_PROBE" => {
                let end = self.go(three(0)?);
                self.moves.push(Move::Line { end, feed: self.feed });
            }
            "ARC_FEED" => self.arc([get(0)?, get(1)?, get(5)?], [get(2)?, get(3)?], get(4)?)?,
            "DWELL" => self.moves.push(Move::Dwell { seconds: get(0)? }),
            "PROGRAM_STOP" => self.moves.push(Move::Stop { m: 0 }),
            "OPTIONAL_PROGRAM_STOP" => self.moves.push(Move::Stop { m: 1 }),
            "NURBS_FEED" => return Err("splines are not compared".to_owned()),
            _ => {}
        }
        Ok(())
    }

    fn in_mm(&self, lengths: [f64; 3]) -> [f64; 3] {
        lengths.map(|length| length * self.unit)
    }

    /// The machine position of a point in the unit in force.
    fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let mut place = self.in_mm(point);
        for offset in &self.offsets {
            for (coordinate, part) in place.iter_mut().zip(offset) {
                *coordinate += part;
            }
        }
        place
    }

    fn go(&mut self, point: [f64; 3]) -> [f64; 3] {
        let end = self.place(point);
        self.position = Some(end);
        end
    }

    /// `turns` is positive counter-clockwise; 1 is the arc without a whole turn.
    fn arc(&mut self, point: [f64; 3], center: [f64; 2], turns: f64) -> Result<(), String> {
        let start = self.position.ok_or("an arc without a start")?;
        let [cx, cy, _] = self.place([center[0], center[1], 0.0]);
        let end = self.go(point);
        let angle = |place: [f64; 3]| (place[1] - cy).atan2(place[0] - cx);
        // Towards the sense of the turn, above 0 and at most a whole turn.
        let within = (turns.signum() * (angle(end) - angle(start))).rem_euclid(TAU);
        let same = (0..2).all(|index| (end[index] - start[index]).abs() < 1e-9);
        let within = if same { TAU } else { within };
        let sweep = turns.signum() * (within + (turns.abs() - 1.0) * TAU);
        let radius = (start[0] - cx).hypot(start[1] - cy);
        self.moves.push(Move::Arc { end, center: [cx, cy], sweep, radius, feed: self.feed });
        Ok(())
    }
}

impl Move {
    /// The key of the element in which it is another move.
    fn differs(&self, element: &Value) -> Option<&'static str> {
        let near = |key: &str, value: f64, tolerance: f64| match element[key].as_f64() {
            Some(number) => (number - value).abs() <= tolerance,
            None => false,
        };
        let at = |key: &str, place: &[f64]| {
            place.iter().enumerate().all(|(index, value)| {
                element[key][index].as_f64().is_some_and(|is| (is - value).abs() <= PRINTED)
            })
        };
        let moves = |kind: &str, end: &[f64; 3]| {
            [("kind", element["kind"] == kind), ("end_mm", at("end_mm", end))]
        };
        let feeds = |feed: f64| ("feed_mm_per_s", near("feed_mm_per_s", feed, 1e-6 * feed + 1e-6));
        let checks = match self {
            Self::Rapid { end } => moves("rapid", end).to_vec(),
            Self::Line { end, feed } => [&moves("line", end)[..], &[feeds(*feed)]].concat(),
            Self::Arc { end, center, sweep, radius, feed } => {
                let tolerance = (PRINTED / radius).to_degrees();
                let arc = [
                    ("center_mm", at("center_mm", center)),
                    ("sweep_deg", near("sweep_deg", sweep.to_degrees(), tolerance)),
                    feeds(*feed),
                ];
                [&moves("arc", end)[..], &arc].concat()
            }
            Self::Dwell { seconds } => vec![("dwell_s", near("dwell_s", *seconds, 1e-4))],
            Self::Stop { m } => vec![("m", element["m"] == *m)],
        };
        checks.into_iter().find_map(|(what, fits)| (!fits).then_some(what))
    }
}

#[test]
fn moves_are_read_and_compared() {
    let text = "    1 N..... USE_LENGTH_UNITS(CANON_UNITS_INCHES)\n    2 N..... SET_G92_OFFSET(1.0000, 0.0000, 0.0000, 0, 0, 0)\n\
                \x20   3 N..... STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n    4 N..... SET_FEED_RATE(60.0000)\n\
                \x20   5 N..... ARC_FEED(1.0000, 2.0000, 1.0000, 1.0000, -2, 0.0000, 0.0000, 0.0000, 0.0000)\n";
    let rapid = r#"{"kind":"rapid","end_mm":[50.8,0,0]}"#;
    let arc = r#"{"kind":"arc","end_mm":[50.8,50.8,0],"center_mm":[50.8,25.4,0],"sweep_deg":-540,"feed_mm_per_s":25.4}"#;
    let found = |rest: &str, elements: &[&str]| {
        compare(&format!("{text}{rest}"), &elements.join("\n")).expect("read").len()
    };
    assert_eq!(found("rc 0\n", &[rapid, arc]), 0);
    assert_eq!(found("rc 0\n", &[rapid, arc, rapid]), 1);
    assert_eq!(found("rc 1\n", &[rapid, arc, rapid]), 0);
    assert_eq!(found("rc 1\n", &[rapid]), 1);
    assert_eq!(found("rc 0\n", &[rapid, &arc.replace("-540", "-180")]), 1);
    assert_eq!(found("rc 0\n", &[rapid, &arc.replace("25.4}", "1}")]), 1);
}
