//! Tests of editing and compiling cams (manual 4.2 to 4.4).

use crate::{
    Action, CamError, Compile, Element, Interpolation, Kind, Knot, Passage, Scale, Shape, Source,
    TableScale, Tappet, VariableType,
};

/// Rest at 0, a line from 60/20 to 120/70, and back at 360.
fn source() -> Source {
    let mut source = Source::new("lift");
    source.insert_point(360.0, 12.0);
    source.insert_line([60.0, 20.0], [120.0, 70.0]);
    source.insert_point(0.0, 0.0);
    source.insert_point(200.0, 90.0);
    source
}

fn table(points: usize) -> Compile {
    Compile::Elements {
        points,
        variable: VariableType::Lreal,
        master: TableScale::IDENTITY,
        slave: TableScale::IDENTITY,
        interpolation: Interpolation::Linear,
    }
}

#[test]
fn a_new_cam_is_a_turn() {
    let source = Source::new("new");
    assert_eq!((source.master.min, source.master.max, source.master.step), (0.0, 360.0, 20.0));
    assert_eq!((source.master.unit.as_str(), source.slave.step), ("°", 40.0));
    assert_eq!(source.knots(), Err(CamError::TooFewPoints { found: 0 }));
}

#[test]
fn elements_join_twice_continuously() {
    let cam = source().compile(Compile::Polynomial).expect("a cam");
    let curve = cam.curve();
    assert_eq!((cam.name(), cam.shape().number(), cam.shape().len()), ("lift", 3, 5));
    // The line is straight, and its ends are joined with its velocity.
    for master in [60.0, 75.0, 119.0, 120.0] {
        let found = curve.at(master);
        assert!((found.position - (20.0 + (master - 60.0) * 50.0 / 60.0)).abs() < 1e-12);
        assert!((found.velocity - 50.0 / 60.0).abs() < 1e-12 && found.acceleration.abs() < 1e-12);
    }
    let jumps = curve.jumps(true);
    for jump in [jumps.position, jumps.velocity, jumps.acceleration] {
        assert!(jump.by.abs() < 1e-12, "{jumps:?}");
    }
    // An inserted point is at rest. The end was edited to 12, which a periodic cam ignores.
    assert_eq!(curve.at(200.0).velocity, 0.0);
    assert!(curve.at(360.0).position.abs() < 1e-12);
}

#[test]
fn the_end_of_a_periodic_cam_is_its_begin() {
    let begin = Knot { master: 0.0, slave: 5.0, velocity: 0.5, acceleration: 0.25 };
    let end_with = |slave: f64, period| {
        let mut source = Source::new("turn");
        source.period = Some(period);
        source.elements = vec![Element::Point(begin), Element::Point(Knot::at_rest(360.0, slave))];
        source.knots().expect("points")[1]
    };
    // Whole periods may be gained.
    for (slave, period, expected) in
        [(5.0, 360.0, 5.0), (370.0, 360.0, 365.0), (-100.0, 50.0, -95.0)]
    {
        assert_eq!(end_with(slave, period), Knot { master: 360.0, slave: expected, ..begin });
    }
    // No end: the begin again.
    let mut source = Source::new("turn");
    source.elements = vec![Element::Point(begin), Element::Point(Knot::at_rest(90.0, 50.0))];
    assert_eq!(source.knots().expect("points")[2], Knot { master: 360.0, ..begin });
    // A line to the end must arrive as the begin goes on.
    source.insert_line([300.0, -25.0], [360.0, 5.0]);
    let bent =
        CamError::Kink { index: 3, what: "acceleration", master: 360.0, value: 0.0, before: 0.25 };
    assert_eq!(source.knots(), Err(bent));
}

#[test]
fn what_does_not_fit_is_reported() {
    let mut source = source();
    source.period = None;
    source.insert_line([120.0, 70.0], [130.0, 90.0]);
    let Err(CamError::Kink { index: 3, what: "velocity", master, value, before }) = source.knots()
    else {
        panic!("{:?}", source.knots())
    };
    assert_eq!((master, value), (120.0, 2.0));
    assert!((before - 50.0 / 60.0).abs() < 1e-15);
    let refused = |elements: &[Element], period| {
        let mut source = Source::new("bad");
        source.period = period;
        source.elements = elements.to_vec();
        source.knots().expect_err("bad")
    };
    let point = |master, slave| Element::Point(Knot::at_rest(master, slave));
    let missing = |what, master, scale| CamError::EndMissing { what, master, scale };
    assert_eq!(refused(&[point(10.0, 0.0), point(360.0, 0.0)], None), missing("begin", 10.0, 0.0));
    assert_eq!(refused(&[point(0.0, 0.0), point(350.0, 0.0)], None), missing("end", 350.0, 360.0));
    let outside = refused(&[point(0.0, 0.0), point(361.0, 0.0)], None);
    assert_eq!(outside.to_string(), "element 2: master 361 lies outside 0 to 360");
    let line = Element::Line { from: [50.0, 0.0], to: [40.0, 1.0] };
    let backwards = CamError::NotAscending { index: 2, master: 40.0, before: 50.0 };
    assert_eq!(refused(&[point(0.0, 0.0), line], None), backwards);
    let long = Element::Line { from: [0.0, 0.0], to: [100.0, 0.0] };
    let overlapping = CamError::NotAscending { index: 2, master: 60.0, before: 100.0 };
    assert_eq!(refused(&[long, point(60.0, 3.0)], None), overlapping);
}

#[test]
fn tappets_alone_and_on_a_cam() {
    let tappet = |master, action| Tappet { group: 1, master, passage: Passage::Every, action };
    let mut source = Source::new("switches");
    source.kind = Kind::Tappets;
    source.insert_tappet(tappet(200.0, Action::Off));
    source.insert_tappet(tappet(100.0, Action::On));
    let cam = source.compile(Compile::Polynomial).expect("a cam");
    let masters: Vec<_> = cam.tappets().iter().map(|tappet| tappet.master).collect();
    assert_eq!(masters, [100.0, 200.0]);
    assert_eq!(cam.curve().extremes().velocity.magnitude(), 0.0);
    source.insert_tappet(tappet(400.0, Action::On));
    let outside = source.compile(Compile::Polynomial).expect_err("outside");
    assert_eq!(outside.to_string(), "tappet 3: master 400 lies outside 0 to 360");
    source.tappets.pop();
    source.insert_tappet(tappet(300.0, Action::Timed { delay_ns: -1, duration_ns: 5 }));
    let negative = CamError::TappetTime { index: 3, what: "delay", value: -1 };
    assert_eq!(source.compile(Compile::Polynomial), Err(negative));
}

#[test]
fn equidistant_tables_leave_out_the_end_of_periodic_cams() {
    let mode = |points| Compile::Equidistant {
        points,
        variable: VariableType::Uint,
        slave: TableScale { min: 0.0, max: 100.0, table_min: 0.0, table_max: 65_535.0 },
        interpolation: Interpolation::Cubic,
    };
    let whole = source().compile(Compile::Polynomial).expect("a cam");
    let cam = source().compile(mode(360)).expect("a cam");
    let Shape::Equidistant(table) = cam.shape() else { panic!("a table") };
    assert!(table.periodic && table.values.len() == 360);
    assert_eq!((table.master(1), table.master(359)), (1.0, 359.0));
    assert_eq!(table.values[90], (whole.curve().at(90.0).position * 655.35).round());
    for master in [0.5, 77.7, 120.5, 300.2] {
        let [a, b] = [&whole, &cam].map(|cam| cam.curve().at(master).position);
        // Half a number, and the cubic.
        assert!((a - b).abs() < 0.005, "{master}: {a} {b}");
    }
    let mut once = source();
    once.period = None;
    let cam = once.compile(mode(361)).expect("a cam");
    let Shape::Equidistant(table) = cam.shape() else { panic!("a table") };
    assert_eq!((table.periodic, table.master(360)), (false, 360.0));
    assert!(matches!(once.compile(mode(1)), Err(CamError::TooFewPoints { found: 1 })));
}

#[test]
fn lines_get_only_their_ends() {
    let cam = source().compile(table(33)).expect("a cam");
    let Shape::Pairs(pairs) = cam.shape() else { panic!("a table") };
    let masters: Vec<_> = pairs.pairs.iter().map(|[master, _]| *master).collect();
    assert_eq!(masters.len(), 33);
    assert_eq!(masters.iter().filter(|m| (60.0..=120.0).contains(*m)).count(), 2);
    assert!(masters.contains(&60.0) && masters.contains(&120.0));
    assert_eq!((masters[0], masters[32]), (0.0, 360.0));
    // 300 units without a line, 29 points between 4 fixed ones: steps of about 10.
    for pair in masters.windows(2).filter(|pair| pair[0] != 60.0) {
        assert!((8.5..10.7).contains(&(pair[1] - pair[0])), "{pair:?}");
    }
    assert!(matches!(source().compile(table(3)), Err(CamError::TooFewPoints { found: 3 })));
    // A cam of one line.
    let mut line = Source::new("line");
    line.period = None;
    line.master = Scale { min: 0.0, max: 100.0, step: 10.0, unit: "mm".to_owned() };
    line.insert_line([0.0, 0.0], [100.0, 50.0]);
    let cam = line.compile(table(2)).expect("a cam");
    assert_eq!(cam.curve().at(30.0).position, 15.0);
}
