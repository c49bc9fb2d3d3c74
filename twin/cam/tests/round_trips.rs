//! Round trips of random cams through TOML, tables and CSV.

use super::files::read;
use proptest::prelude::*;
use twin_cam::{
    Action, CamInput, Element, Equidistant, Interpolation, Kind, Knot, PairTable, Passage, Scale,
    Shape, Source, StartMode, TableScale, Tappet, VariableType,
};
use twin_machine::cam_file::{CamFile, Coupling, csv_of, write_file, write_toml};

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        Just(0.0),
        -1e3..1e3_f64,
        -1e-7..1e-7_f64,
        -1e14..1e14_f64,
        (-20_i32..20).prop_map(f64::from)
    ]
}

fn scale() -> impl Strategy<Value = Scale> {
    (-1e3..1e3_f64, 1e-3..1e3_f64, 1e-3..1e2_f64, "[a-z°/\"\\\\ #]{0,6}").prop_map(
        |(min, width, step, unit)| {
            let unit = if unit.trim().is_empty() { String::new() } else { unit };
            Scale { min, max: min + width, step, unit }
        },
    )
}

fn tappet(start: f64, width: f64) -> impl Strategy<Value = Tappet> {
    let passages = prop::sample::select(vec![Passage::Positive, Passage::Negative, Passage::Every]);
    let timed = (0..86_400_000_000_000_i64, 0..86_400_000_000_000_i64)
        .prop_map(|(delay_ns, duration_ns)| Action::Timed { delay_ns, duration_ns });
    let actions = prop_oneof![Just(Action::On), Just(Action::Off), Just(Action::Invert), timed];
    (any::<i16>(), 0.0..1.0_f64, passages, actions).prop_map(
        move |(group, share, passage, action)| Tappet {
            group,
            master: start + share * width,
            passage,
            action,
        },
    )
}

fn tappets(scale: &Scale) -> impl Strategy<Value = Vec<Tappet>> + use<> {
    prop::collection::vec(tappet(scale.min, scale.max - scale.min), 0..5).prop_map(|mut tappets| {
        tappets.sort_by(|one, other| one.master.total_cmp(&other.master));
        tappets
    })
}

fn coupling() -> impl Strategy<Value = Coupling> {
    let factors = prop_oneof![0.01..10.0_f64, -10.0..-0.01_f64];
    let modes = prop::sample::select(vec![
        StartMode::Absolute,
        StartMode::Relative,
        StartMode::RampIn,
        StartMode::RampInPositive,
        StartMode::RampInNegative,
    ]);
    (number(), factors.clone(), number(), factors, modes, prop::array::uniform5(0.0..1e4_f64))
        .prop_map(
            |(master_offset, master_scaling, slave_offset, slave_scaling, start_mode, more)| {
                let [velocity_difference, acceleration, deceleration, tappet_hysteresis, dead] =
                    more;
                let input = CamInput {
                    master_offset,
                    master_scaling,
                    slave_offset,
                    slave_scaling,
                    start_mode,
                    velocity_difference,
                    acceleration,
                    deceleration,
                    tappet_hysteresis,
                    tappet_dead_time_s: 0.0,
                };
                Coupling { input, dead_time_s: dead * 1e-6, wanted: None }
            },
        )
}

fn source() -> impl Strategy<Value = Source> {
    let parts = (scale(), scale(), "[a-zA-Z0-9 _\"\\\\'#äé-]{0,20}x", any::<bool>());
    parts.prop_flat_map(|(master, slave, name, is_cam)| {
        let values = prop::array::uniform3(-1e3..1e3_f64);
        let inner = prop::collection::vec((0.001..0.999_f64, values), 0..6);
        let ends = prop::array::uniform2(prop::array::uniform3(-1e3..1e3_f64));
        let (start, width) = (master.min, master.max - master.min);
        let tappets = tappets(&master);
        (inner, ends, tappets, prop::option::of(1e-3..1e3_f64)).prop_map(
            move |(mut inner, ends, tappets, period)| {
                inner.sort_by(|one, other| one.0.total_cmp(&other.0));
                inner.dedup_by(|one, other| one.0 - other.0 < 1e-3);
                let knot = |master: f64, [slave, velocity, acceleration]: [f64; 3]| {
                    Element::Point(Knot { master, slave, velocity, acceleration })
                };
                let mut elements = vec![knot(start, ends[0])];
                elements
                    .extend(inner.into_iter().map(|(share, all)| knot(start + share * width, all)));
                elements.push(knot(master.max, ends[1]));
                let kind = if is_cam { Kind::Cam } else { Kind::Tappets };
                let elements = if is_cam { elements } else { Vec::new() };
                let name = name.trim().to_owned();
                Source {
                    name,
                    kind,
                    master: master.clone(),
                    slave: slave.clone(),
                    period,
                    elements,
                    tappets,
                }
            },
        )
    })
}

fn table() -> impl Strategy<Value = (Shape, Scale)> {
    let kinds = prop::sample::select(VariableType::ALL.to_vec());
    let between = prop::sample::select(vec![Interpolation::Linear, Interpolation::Cubic]);
    let values = prop::collection::vec(0..30_000_u32, 2..25);
    let slave = prop_oneof![
        Just(TableScale::IDENTITY),
        (-10.0..10.0_f64).prop_map(|min| TableScale {
            min,
            max: min + 5.0,
            table_min: 0.0,
            table_max: 30_000.0
        })
    ];
    (kinds, between, values, slave, any::<bool>(), any::<bool>()).prop_map(
        |(variable, interpolation, values, slave, periodic, pairs)| {
            let numbers: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
            #[expect(clippy::cast_precision_loss, reason = "a few")]
            let end = (numbers.len() - 1) as f64;
            let scale = Scale { min: 0.0, max: end, step: end / 10.0, unit: String::new() };
            let shape = if pairs {
                let pairs = (0..).map(f64::from).zip(numbers).map(|(x, y)| [x, y]).collect();
                let master = TableScale::IDENTITY;
                Shape::Pairs(PairTable { variable, master, slave, periodic, interpolation, pairs })
            } else {
                let (start, end) = (scale.min, scale.max);
                Shape::Equidistant(Equidistant {
                    variable,
                    start,
                    end,
                    periodic,
                    slave,
                    interpolation,
                    values: numbers,
                })
            };
            (shape, scale)
        },
    )
}

proptest! {
    /// Elements, tappets and coupling, number for number.
    #[test]
    fn toml_is_read_as_it_was_written(source in source(), coupling in coupling()) {
        let text = write_toml(&source, None, &coupling);
        let file = read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert_eq!(&file.coupling, &coupling, "{}", text);
        let mut expected = source.clone();
        // A tappets' slave has no scale of its own.
        if source.kind == Kind::Tappets {
            expected.slave = file.source.as_ref().expect("a source").slave.clone();
        }
        prop_assert_eq!(file.source.as_ref(), Some(&expected), "{}", text);
        prop_assert_eq!(file.to_toml(), write_toml(&expected, None, &coupling));
    }

    /// Tables, too; and through a file they are the same.
    #[test]
    fn tables_are_read_as_they_were_written((shape, scale) in table()) {
        let source = Source {
            name: "table".to_owned(), kind: Kind::Cam, slave: scale.clone(), master: scale,
            period: None, elements: Vec::new(), tappets: Vec::new(),
        };
        let text = write_toml(&source, Some(&shape), &Coupling::default());
        let file = read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        prop_assert_eq!(file.cam.shape(), &shape, "{}", text);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("again.toml");
        std::fs::write(&path, write_file(&file, &path, None).expect("bytes")).expect("written");
        let again = CamFile::load(&path, Interpolation::Linear).expect("a cam");
        prop_assert_eq!(again.cam.shape(), &shape);
    }

    /// Points as CSV, number for number.
    #[test]
    fn points_as_csv(source in source()) {
        prop_assume!(source.kind == Kind::Cam);
        let file = read(&write_toml(&source, None, &Coupling::default())).expect("a cam");
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cam.csv");
        std::fs::write(&path, csv_of(&file, None)).expect("written");
        let again = CamFile::load(&path, Interpolation::Linear).expect("a cam");
        prop_assert_eq!(again.cam.shape(), file.cam.shape());
    }
}
