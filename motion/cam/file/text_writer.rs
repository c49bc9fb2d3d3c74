//! Writes cams as people write them.

use super::super::knot::Knot;
use super::super::source::{Element, Kind, Scale, Source};
use super::super::tappet::{Action, Passage, Tappet};
use std::fmt::Write;

/// Writes a cam as people write it; [`read_text`](super::read_text) gives it back number for number.
pub fn write_text(source: &Source) -> String {
    let Source { name, kind, master, slave, period, elements, tappets } = source;
    let mut text = String::new();
    let key = if *kind == Kind::Cam { "cam" } else { "tappets" };
    // Writing into a text does not fail.
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        let _written = text.write_fmt(arguments);
        text.push('\n');
    };
    line(format_args!("{key} {name}"));
    for (key, Scale { min, max, step, unit }) in [("master", master), ("slave", slave)] {
        let unit = if unit.is_empty() { String::new() } else { format!(" unit {unit}") };
        line(format_args!("{key} {min} {max} step {step}{unit}"));
    }
    if let Some(period) = period {
        line(format_args!("period {period}"));
    }
    for element in elements {
        match element {
            Element::Point(Knot { master, slave, velocity, acceleration }) => {
                let word = |name: &str, value: f64| {
                    if value == 0.0 { String::new() } else { format!(" {name} {value}") }
                };
                let (v, a) = (word("v", *velocity), word("a", *acceleration));
                line(format_args!("point {master} {slave}{v}{a}"));
            }
            Element::Line { from, to } => {
                line(format_args!("line {} {} {} {}", from[0], from[1], to[0], to[1]));
            }
        }
    }
    for Tappet { group, master, passage, action } in tappets {
        let passage = match passage {
            Passage::Positive => "positive",
            Passage::Negative => "negative",
            Passage::Every => "every",
        };
        let us = |ns: i64| Micro(ns);
        let action = match action {
            Action::On => "on".to_owned(),
            Action::Off => "off".to_owned(),
            Action::Invert => "invert".to_owned(),
            Action::Timed { delay_ns, duration_ns } => {
                format!("timed delay_us {} duration_us {}", us(*delay_ns), us(*duration_ns))
            }
        };
        line(format_args!("tappet {group} at {master} {passage} {action}"));
    }
    text
}

/// Nanoseconds as microseconds.
struct Micro(i64);

impl std::fmt::Display for Micro {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (whole, rest) = (self.0 / 1000, (self.0 % 1000).abs());
        if rest == 0 { write!(f, "{whole}") } else { write!(f, "{whole}.{rest:03}") }
    }
}
