//! Corpus of programs from CAM systems and by hand, placed on every machine by a work offset.
//!
//! Moves of rotary axes alone are left out: these machines have none. Each program is planned up to a number of
//! elements; `TWIN_CORPUS_FULL` removes that limit or, as a number, sets it. `TWIN_CORPUS_ONLY` names a program, or a
//! part of its name, and with a colon the machine as well: `flower:tripod`.

use super::machines::Machine;
use super::run::{Report, Settings, run};
use nalgebra::{Point3, Vector3};
use std::fs;
use std::path::{Path, PathBuf};
use twin_gcode::decode::Item;
use twin_gcode::rs274::{Decoder, DecoderOptions, Tool, ToolTable};
use twin_path::{PathElement, Similarity};

/// Elements per program, and the time that they take at their feed, s.
const FEW: (usize, f64) = (60, 6.0);

fn programs() -> Vec<(String, PathBuf)> {
    let shared = std::env::var_os("TWIN_SHARED").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    let corpus = shared.join("corpus");
    let Ok(index) = fs::read_to_string(corpus.join("INDEX.tsv")) else {
        println!("skipped: there is no {}", corpus.join("INDEX.tsv").display());
        return Vec::new();
    };
    let names = index.lines().skip(1).map(|line| {
        let name = line.split('\t').take(2).collect::<Vec<_>>().join("/");
        let path = corpus.join(&name);
        (name, path)
    });
    names.collect()
}

/// True if a program is planned on a machine.
fn is_wanted(name: &str, machine: Machine) -> bool {
    let only = std::env::var("TWIN_CORPUS_ONLY").unwrap_or_default();
    let (program, on) = only.split_once(':').unwrap_or((&only, ""));
    name.contains(program) && (on.is_empty() || on == machine.name())
}

/// The elements of a program in which nothing is wrong.
fn decode(path: &Path, (count, time): (usize, f64)) -> Option<Vec<PathElement>> {
    let text = fs::read(path).ok()?;
    let tools = (1..200).map(|number| Tool { number, ..Tool::default() });
    let options = DecoderOptions {
        rapid_velocity: 0.15,
        acceleration: 1.0,
        deceleration: 1.0,
        tools: Some(ToolTable::new(tools)),
        ..DecoderOptions::default()
    };
    let mut elements = Vec::new();
    for item in Decoder::new(text.as_slice(), options) {
        if let Item::Element(element) = item.ok()? {
            if element.kind.is_motion() && element.shape.length() == 0.0 {
                continue;
            }
            elements.push(element);
        }
    }
    elements.truncate(count);
    let mut takes = 0.0;
    let within = elements.iter().take_while(|element| {
        takes += if element.kind.is_motion() { element.length() / element.feed } else { 0.0 };
        takes <= time
    });
    let within = within.count().max(2);
    elements.truncate(within);
    (!elements.is_empty()).then_some(elements)
}

/// The elements moved to where all of them are within reach, if there is such a place.
fn place(elements: &[PathElement], machine: Machine) -> Option<Vec<PathElement>> {
    let bounds = elements.iter().map(|element| element.shape.bounds());
    let bounds = bounds.reduce(|all, bounds| all.with(&bounds))?;
    let middle = 0.5 * (bounds.min.coords + bounds.max.coords);
    let [min, max] = machine.room();
    let places = [10, 7, 13, 4, 16, 1, 19].map(|part| f64::from(part) / 20.0);
    let (size, room) = (bounds.max - bounds.min, max - min);
    let rough = (0..3).any(|axis| size[axis] > 2.0 * room[axis] + 0.1);
    let offsets = places
        .iter()
        .flat_map(|x| places.iter().flat_map(move |y| places.map(|z| Vector3::new(*x, *y, z))));
    let fits = |offset: &Vector3<f64>| {
        let mut inside = elements.iter().flat_map(|element| {
            let length = element.shape.length();
            [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| element.shape.at(part * length).position)
        });
        inside.all(|point| machine.reaches(&(point.coords + offset)))
    };
    let mut offsets = offsets.map(|part| min + part.component_mul(&room) - middle);
    let offset = if rough { None } else { offsets.find(fits) }?;
    let map = Similarity::translation(offset);
    Some(elements.iter().map(|element| map.element(element).unwrap()).collect())
}

fn row(name: &str, machine: Machine, report: &Report) {
    println!(
        "{name:44} {:8} {:9.2} {:7.4} {:7.4} {:7.4} {:7.4} {:7.4} {:7.4} {:3} {:4} {:6} {:6.1} {:7.0}",
        machine.name(),
        report.duration,
        report.velocity.value,
        report.acceleration.value,
        report.jerk.value,
        report.third_difference.value,
        report.feed.value,
        report.path_acceleration.value,
        report.effort.failed,
        report.effort.exceeded,
        report.effort.committed,
        report.effort.cells as f64 / report.effort.committed as f64,
        report.points_per_second(),
    );
}

/// Plans every program on every machine, and looks at every millisecond.
fn look_at_all(jerk: bool) {
    let count = std::env::var("TWIN_CORPUS_FULL").ok();
    let most = count.map_or(FEW, |count| (count.parse().unwrap_or(usize::MAX), f64::INFINITY));
    println!(
        "{:44} {:8} {:>9} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>3} {:>4} {:>6} {:>6} {:>7}",
        "program",
        "machine",
        "s",
        "v",
        "a",
        "jerk",
        "3rd",
        "F",
        "E",
        "bad",
        "over",
        "cells",
        "times",
        "cells/s"
    );
    let mut wrong = Vec::new();
    for (name, path) in programs() {
        let machines = Machine::ALL.into_iter().chain([Machine::Cutter]);
        let machines = machines.filter(|machine| is_wanted(&name, *machine));
        let machines: Vec<Machine> = machines.collect();
        if machines.is_empty() {
            continue;
        }
        let Some(elements) = decode(&path, most) else { continue };
        for machine in machines {
            let Some(elements) = place(&elements, machine) else {
                println!("{name:44} {:8} does not fit", machine.name());
                continue;
            };
            let settings = Settings {
                machine,
                jerk,
                tolerance: 1e-6,
                angle: 2_f64.to_radians(),
                horizon: 1.5,
            };
            let report = run(elements.iter().cloned(), &settings, settings.options());
            row(&name, machine, &report);
            if let Err(reason) = super::random::check(&report, &elements, &settings) {
                let reason: String = reason.to_string().chars().take(200).collect();
                println!("    {reason}");
                wrong.push((name.clone(), machine));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn every_program_that_fits_keeps_the_limits() {
    look_at_all(true);
}

#[test]
fn every_program_that_fits_keeps_the_limits_without_those_of_jerks() {
    look_at_all(false);
}

/// A program at the edge of the room still fits, one that is larger does not.
#[test]
fn programs_are_placed_where_they_fit() {
    use twin_path::Place;
    use twin_path::{ElementKind, Shape};
    for machine in Machine::ALL {
        let [min, max] = machine.room();
        for (part, fits) in [(0.5, true), (20.0, false)] {
            let end = Point3::from((max - min) * part);
            let shape = Shape::Line { start: Point3::origin(), end };
            let line = PathElement::new(Place::default(), ElementKind::Cut, shape);
            assert_eq!(place(&[line], machine).is_some(), fits, "{machine:?}");
        }
    }
}
