//! Words of the dialect: switch points, S profiles, loops, relative targets (manual 3.2).

use super::program::{at, decoded_with, element, elements, length, xy};
use super::vector::check;
use twin_gcode::din66025::DecoderOptions;
use twin_path::{ElementKind, PathElement};

/// Number (negative: off) and place of every switch of an element.
fn switches(element: &PathElement) -> Vec<(f64, f64)> {
    let signed = |number: u8, on: bool| if on { f64::from(number) } else { -f64::from(number) };
    element.switches().iter().map(|switch| (signed(switch.number, switch.on), switch.at)).collect()
}

#[test]
pub(crate) fn switch_points() {
    check("cnc-switch-points", |vector| {
        let [[x, y]] = vector.points("end")[..] else { panic!("one end") };
        let part = |letter: &str, name: &str| {
            let value = vector.number(name);
            let block = format!("G1 X{x} Y{y} F10 H2 {letter}{value}");
            let element = element(&vector.numbers("start"), &block);
            let [(2.0, part)] = switches(&element)[..] else { panic!("{element:?}") };
            (element, part)
        };
        let (element, by_o) = part("O", "O");
        vector.expect("length", length(&element));
        vector.expect("O_point", at(&element, by_o));
        vector.expect("L_pos_rel", [part("L", "L_pos").1]);
        let (element, from_end) = part("L", "L_neg");
        vector.expect("L_neg_rel", [from_end]);
        vector.expect("L_neg_point", at(&element, from_end));
    });
}

/// Each H takes the L on its right.
#[test]
pub(crate) fn two_switches() {
    check("cnc-two-switches", |vector| {
        let elements = elements(&[], &vector.program());
        let element = elements.last().expect("an element");
        assert_eq!(xy(element.start()).to_vec(), vector.numbers("start"));
        assert_eq!(xy(element.end()).to_vec(), vector.numbers("end"));
        vector.expect("length", length(element));
        let found = switches(element);
        assert_eq!(found.len(), 2);
        for (index, (number, part)) in found.into_iter().enumerate() {
            vector.expect(&format!("switches/{index}/id"), [number]);
            vector.expect(&format!("switches/{index}/rel"), [part]);
            vector.expect(&format!("switches/{index}/x"), [at(element, part)[0]]);
        }
    });
}

#[test]
pub(crate) fn s_profile() {
    check("cnc-S-profile", |vector| {
        let [from, to, way] = ["p0", "p1", "length"].map(|name| vector.number(name));
        for (name, word) in [("P", " S7"), ("P_linear", "")] {
            let options =
                DecoderOptions { start_extra: [from, 0.0, 0.0, 0.0, 0.0], ..Default::default() };
            let blocks = format!("G1 X{way} P{to}{word} F10");
            let (elements, warnings) = decoded_with(options, &blocks);
            assert!(warnings.is_empty());
            let places = vector.numbers("s");
            let extra = |s: &f64| elements[0].extra_at(s * 1e-3).expect("extra axes").position[0];
            vector.expect(name, places.iter().map(extra));
        }
    });
}

#[test]
pub(crate) fn loop_on_the_implicit_variable() {
    check("cnc-loop", |vector| {
        let start = vector.numbers("start");
        let found = elements(&start, &vector.program());
        let lines: Vec<_> = found.iter().map(|element| element.place.line).collect();
        let passes = lines.iter().filter(|line| **line == lines[0]).count();
        let count = u32::try_from(passes).map(f64::from).expect("few");
        vector.expect("passes", [count]);
        let cuts = found.iter().filter(|element| element.kind == ElementKind::Cut).count();
        vector.expect("line_objects", [u32::try_from(cuts).map(f64::from).expect("few")]);
        vector.expect("moving_length", [found.iter().map(|element| length(element)[0]).sum()]);
        vector.expect_that("zero_length_first", found[0].length() == 0.0);
        // How much the variable holds afterwards is how many passes it adds to a loop of three.
        let more = "N2000 G37 D3\nN2010 G1 Z1\nN2020 G37 D-1\nN2030 G20 L2010";
        let longer = elements(&start, &format!("{}\n{more}", vector.program())).len();
        let added = u32::try_from(longer - found.len()).map(f64::from).expect("few");
        vector.expect("final_implicit", [added - 3.0]);
    });
}

#[test]
pub(crate) fn relative_targets_and_set_positions() {
    check("cnc-g91-g92", |vector| {
        let elements = elements(&[], &vector.program());
        assert!(elements.iter().all(|element| element.kind == ElementKind::Cut));
        let ends = elements.iter().flat_map(|element| [element.start(), element.end()]);
        vector.expect("objects", ends.flat_map(xy));
    });
}
