//! Tests of the path picture: well-formed SVG, arcs and splines, legend, and page size.

use super::*;
use nalgebra::Point3;
use twin_gcode::din66025::{Decoder, DecoderOptions, Item};
use twin_gcode::info::ProgramInfo;

fn elements(program: &str) -> Vec<PathElement> {
    let decoder = Decoder::new(program.as_bytes(), DecoderOptions::default());
    let element = |item| match item {
        Ok(Item::Element(element)) => element,
        other => panic!("{other:?}"),
    };
    decoder.map(element).collect()
}

fn picture(
    title: &str,
    before: &[PathElement],
    path: &[PathElement],
    crosses: &[Point3<f64>],
) -> String {
    let mut info = ProgramInfo::default();
    path.iter().chain(before).for_each(|element| info.element(element));
    let mut picture = Picture::new(Vec::new(), info.bounds, title);
    for element in before {
        picture.before(element).unwrap();
    }
    for element in path {
        picture.element(element).unwrap();
    }
    for cross in crosses {
        picture.cross(cross).unwrap();
    }
    String::from_utf8(picture.finish().unwrap()).unwrap()
}

/// The data of all lines of a style, without those of the legend.
fn data<'a>(svg: &'a str, class: &str) -> Vec<&'a str> {
    let head = format!("<path class=\"{class}\" d=\"");
    svg.split(&head).skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

/// Tags that open are closed in order, attributes are quoted: what a strict reader wants.
fn assert_well_formed(svg: &str) {
    let mut open = Vec::new();
    let mut rest = svg;
    while let Some(at) = rest.find('<') {
        let tag = &rest[at + 1..];
        let end = tag.find('>').unwrap();
        let (tag, behind) = (&tag[..end], &tag[end + 1..]);
        assert!(tag.matches('"').count().is_multiple_of(2), "{tag}");
        assert!(!tag.contains('<'), "{tag}");
        let name = tag.trim_start_matches('/').split([' ', '/']).next().unwrap();
        match (tag.starts_with('/'), tag.ends_with('/')) {
            (true, _) => assert_eq!(open.pop(), Some(name)),
            (false, false) => open.push(name),
            (false, true) => {}
        }
        rest = behind;
    }
    assert_eq!(open, Vec::<&str>::new());
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

/// Line, arcs, ellipse (its main axis 45° up), parabola: mm, Y upwards, arcs in pieces of a quarter, the flag of the
/// sense 1 for counter-clockwise.
#[test]
fn curves_as_commands() {
    let path = elements(
        "%\nN10 G0 X10 F100\nN20 G1 X20\nN30 G3 X20 Y20 I0 J10\nN40 G2 X0 Y20 R10\nN50 G6 X-20 Y20 I-10 J20\n",
    );
    let svg = picture("curves", &[], &path, &[]);
    assert_well_formed(&svg);
    assert_eq!(data(&svg, "rapid"), ["M0 0L10 0"]);
    let cut = "M10 0L20 0A10 10 0 0 1 30 10A10 10 0 0 1 20 20A10 10 0 0 0 10 10A10 10 0 0 0 0 20\
        C-6.6667 33.3333 -13.3333 33.3333 -20 20";
    assert_eq!(data(&svg, "cut").concat().replace('\n', ""), cut);
    let whole = elements("%\nN10 G9 X0 Y0 I20 J20 K45 R0.5 F1\n");
    let svg = picture("ellipse", &[], &whole, &[]);
    let pieces = data(&svg, "cut").concat();
    assert_eq!(pieces.matches("A28.2843 14.1421 45 0 1 ").count(), 4, "{pieces}");
    assert!(pieces.ends_with(" 0 0"), "{pieces}");
}

/// Upright arcs are half an ellipse without width from above: drawn there and back, or not at all aside.
#[test]
fn upright_arcs() {
    let (start, end) = (Point3::origin(), Point3::new(0.02, 0.0, 0.0));
    let center = Point3::new(0.01, 0.0, 0.0);
    let arc =
        twin_path::Arc::in_plane(twin_path::Plane::Zx, start, end, center, std::f64::consts::PI);
    let shape = twin_path::Shape::Arc(arc);
    let commands = curves::commands(&shape);
    assert_eq!(commands.len(), 32);
    assert!(
        commands.iter().all(|(_, point)| point.1 == 0.0 && (0.0..=20.0 + 1e-9).contains(&point.0))
    );
}

#[test]
fn what_is_drawn_has_its_legend() {
    let path = elements(
        "%\nN10 G0 X10 F100\nN20 G1 X20 H1 O0.5\nN30 M3\nN40 G92 X0 Y0\nN50 G1 X5\nN60 G1 Z-5\n",
    );
    let svg = picture("a <b> & \"c\"\n", &path, &path, &[Point3::new(0.01, 0.0, 0.0)]);
    assert_well_formed(&svg);
    assert!(svg.contains("<title>a &lt;b&gt; &amp; &quot;c&quot; </title>"));
    assert!(svg.contains("20 × 0 × 5 mm"));
    for text in [
        "before preparation",
        "rapid",
        "cut",
        "set (G92)",
        "every 100 ms",
        "M function",
        "switch",
        "start",
        "end",
    ] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}");
    }
    assert_eq!(svg.matches("r=\"3.5\"").count(), 2);
    assert_eq!(data(&svg, "cross").len(), 1);
    assert!(!picture("", &[], &path[..1], &[]).contains(">switch<"));
}

/// Manual 3.5. A spline's Bézier points are all corners of its hull, or one lies inside, or all are in line.
#[test]
fn splines_have_their_hulls() {
    let hulls = |blocks: &str| {
        let svg = picture("", &[], &elements(&format!("%\n{blocks}\n")), &[]);
        assert_well_formed(&svg);
        let (hulls, legend) = (data(&svg, "hull").join(" "), svg.contains(">hull of a spline<"));
        assert_eq!(hulls.is_empty(), !legend);
        hulls
    };
    // Bézier points 0/0, 20/40, 40/40, 60/0.
    assert_eq!(hulls("N10 G6 X60 Y0 I30 J60 F1"), "M0 0L60 0L40 40L20 40Z");
    // The second of 0/0 → 20/0 → 20/20 → 40/20: 20/0, 23.3333/3.3333, 16.6667/16.6667, 20/20.
    let stairs = hulls("N10 G0 X0 F1\nN20 G5 X20 Y0\nN30 G5 X20 Y20\nN40 G5 X40 Y20");
    assert!(stairs.contains("M16.6667 16.6667L20 0L23.3333 3.3333L20 20Z"), "{stairs}");
    assert_eq!(hulls("N10 G5 X20 Y0 F1"), "");
}

/// The frame holds the path with room around it, whatever its proportions, and Y points upwards.
#[test]
fn the_path_is_inside_the_page() {
    for (x, y) in [(100.0, 50.0), (0.001, 1000.0), (1e-9, 1e-9), (0.0, 0.0), (5e4, 10.0)] {
        let bounds = Bounds { min: Point3::new(-x, 7.0, 0.0), max: Point3::new(x, 7.0 + y, 0.0) };
        let mut map = map(Some(bounds), "");
        let [low, high] = [bounds.min, bounds.max].map(|corner| map.pixels(curves::point(&corner)));
        let head = map.take();
        let size = |key: &str| -> f64 {
            let (_, rest) = head.split_once(&format!(" {key}=\"")).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let (width, height) = (size("width"), size("height"));
        assert!(low.0 >= 76.0 && high.0 <= width - 24.0, "{low:?} {high:?} {width}");
        assert!(high.1 >= 56.0 && low.1 <= height - 64.0, "{low:?} {high:?} {height}");
        assert!(low.1 >= high.1 && width <= 1110.0 && height <= 1250.0, "{width} {height}");
    }
}

#[test]
fn nothing_and_absurdities() {
    let empty = picture("", &[], &[], &[]);
    assert_well_formed(&empty);
    assert!(empty.contains("no path"));
    let far = f64::MAX;
    let bounds = Bounds { min: Point3::new(-far, f64::NAN, 0.0), max: Point3::new(far, far, far) };
    let mut picture = Picture::new(Vec::new(), Some(bounds), "far");
    let line = twin_path::Shape::Line { start: bounds.min, end: bounds.max };
    let element = PathElement::new(twin_path::Place::default(), ElementKind::Cut, line);
    picture.element(&element).unwrap();
    picture.cross(&bounds.min).unwrap();
    assert_well_formed(&String::from_utf8(picture.finish().unwrap()).unwrap());
}

/// Long paths get no more arrows than short ones.
#[test]
fn arrows_are_bounded() {
    let program: String = (0..20_000).fold("%\nN1 F100\n".to_owned(), |text, n| {
        text + if n % 2 == 0 { "N2 G1 X100\n" } else { "N2 G1 X0\n" }
    });
    let svg = picture("", &[], &elements(&program), &[]);
    let arrows = svg.matches("class=\"arrow\"").count();
    assert!((50..=MOST_MARKS).contains(&arrows), "{arrows}");
}
