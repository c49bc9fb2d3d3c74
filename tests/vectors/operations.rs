//! Operations of the CNC editor on objects (manual 3.3, 6.3).

use super::program::{Fault, element, elements, length, lines, move_type, stream, xy};
use super::vector::check;
use nalgebra::Vector3;
use twin_path::{MapPath, Shape, Similarity, SplitAt};

#[test]
pub(crate) fn split() {
    check("cnc-split", |vector| {
        let [[x, y]] = vector.points("end")[..] else { panic!("one end") };
        let path = elements(&vector.numbers("start"), &format!("G1 X{x} Y{y} F10"));
        let parts: Result<Vec<_>, Fault> =
            SplitAt::new(stream(path.clone()), 0, vector.number("pos")).collect();
        let [first, second] = &parts.expect("a part")[..] else { panic!("two parts") };
        vector.expect("mid", xy(first.end()));
        vector.expect("mid", xy(second.start()));
        assert_eq!((first.start(), second.end()), (path[0].start(), path[0].end()));
    });
}

#[test]
pub(crate) fn reversed_arc() {
    check("cnc-reverse-arc", |vector| {
        let command = if vector.word("cw") == "true" { "G2" } else { "G3" };
        let [[x, y]] = vector.points("end")[..] else { panic!("one end") };
        let [[i, j]] = vector.points("center")[..] else { panic!("one centre") };
        let at = vector.number("switch_rel");
        let block = format!("G98\n{command} X{x} Y{y} I{i} J{j} F10 H1 O{at}");
        let back = element(&vector.numbers("start"), &block).reversed();
        let Shape::Arc(arc) = &back.shape else { panic!("no arc: {back:?}") };
        vector.expect("move_type", move_type(&back));
        vector.expect("P1", [arc.center().x * 1e3]);
        vector.expect("P2", [arc.center().y * 1e3]);
        vector.expect("P3", [arc.radius() * 1e3]);
        vector.expect("T1", [arc.start_angle().to_degrees()]);
        vector.expect("T2", [-arc.sweep().to_degrees()]);
        vector.expect("length", length(&back));
        vector.expect("start", xy(back.start()));
        vector.expect("end", xy(back.end()));
        vector.expect("switch_rel", back.switches().iter().map(|switch| switch.at));
    });
}

/// About the origin, about another point (there, turned, and back), and scaled.
#[test]
pub(crate) fn turned_and_scaled() {
    check("cnc-rotate-queue", |vector| {
        let points = vector.points("p");
        let end = |map: Similarity| {
            let path = stream(elements(&[], &lines(&[[0.0; 2], points[0]])));
            let mapped: Result<Vec<_>, Fault> = MapPath::new(path, map).collect();
            xy(mapped.expect("a path")[0].end())
        };
        let turn = Similarity::rotation(vector.number("phi").to_radians());
        vector.expect("origin", end(turn));
        let [[x, y]] = vector.points("about")[..] else { panic!("one point") };
        let center = Vector3::new(x, y, 0.0) * 1e-3;
        let there = Similarity::translation(-center);
        vector.expect("about", end(there.then(&turn).then(&Similarity::translation(center))));
        let scaling = Similarity::scaling(vector.number("scale")).expect("a factor");
        vector.expect("scaled", end(scaling));
    });
}
