//! Tests of pictures: extremes stay visible, gaps stay gaps, and text fits the page.

use super::map::hull;
use super::page::{Head, legend_places};
use super::series::{COLUMNS, thinned};
use super::ticks::ticks;
use super::*;
use proptest::prelude::*;

#[test]
fn ticks_are_round() {
    let texts = |low, high, count| -> Vec<String> {
        ticks(low, high, count).into_iter().map(|(_, text)| text).collect()
    };
    assert_eq!(texts(0.0, 1.0, 5.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
    assert_eq!(texts(-110.0, 110.0, 5.0), ["-100", "-50", "0", "50", "100"]);
    assert_eq!(texts(0.0, 7300.0, 4.0), ["0", "2000", "4000", "6000"]);
    assert_eq!(texts(0.0, 0.001, 2.0), ["0.0000", "0.0005", "0.0010"]);
    assert_eq!(texts(-3.0, 7.0, 2.0), ["0", "5"]);
    assert_eq!(texts(20.0, 60.0, 2.0), ["20", "40", "60"]);
    assert_eq!(ticks(1.0, 1.0, 5.0).len(), 1);
    assert_eq!(ticks(0.0, f64::INFINITY, 5.0).len(), 1);
}

#[test]
fn the_hull_goes_around_every_point() {
    let points = [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (1.0, 1.0), (0.0, 1.0), (0.5, 0.0)];
    assert_eq!(hull(points.to_vec()), [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]);
    assert!(hull(vec![(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]).len() < 3);
}

proptest! {
    /// Whatever the rate of the samples: nothing lower or higher is lost, the points kept are samples in order, and their
    /// number is limited.
    #[test]
    fn extremes_are_kept(
        steps in prop::collection::vec((prop_oneof![0.0..5.0, 0.0..1e6_f64, 0.0..1e12_f64], -1.0..1.0_f64, 0..5_u8), 1..400),
        times in 1..60_u8,
    ) {
        let mut time = 7.0;
        let mut series = Series::default();
        let mut samples = Vec::new();
        for (step, value, gap) in (0..times).flat_map(|_| steps.clone()) {
            time += step;
            series.push(time, (gap > 0).then_some(value));
            if gap > 0 {
                samples.push((time, value));
            }
        }
        let kept: Vec<_> = series.points().iter().copied().filter(|at| !at.1.is_nan()).collect();
        prop_assert!(series.points().len() <= 10_000);
        let all = |points: &[Point]| reach(points.iter().map(|(_, value)| *value));
        prop_assert_eq!(all(&kept), all(&samples));
        let mut rest = samples.iter();
        prop_assert!(kept.iter().all(|at| rest.any(|sample| sample == at)));
        prop_assert_eq!((kept.first(), kept.last()), (samples.first(), samples.last()));
    }
}

/// Hours at 1 kHz: every column of the page has its extremes, and a spike stays where it is.
#[test]
fn long_programs_fill_the_page() {
    let mut series = Series::default();
    let mut stretches = Stretches::default();
    for number in 0..3_000_000_u32 {
        let value = if number == 1_234_567 { 5.0 } else { f64::from(number % 10) * 0.1 };
        series.push(f64::from(number) * 1e-3, Some(value));
        stretches.push(f64::from(number) * 1e-3, number / 3);
    }
    let last = 2_999_999.0 * 1e-3;
    let points = thinned(series.points(), [0.0, last]);
    assert!(
        (2.0 * COLUMNS..=5.0 * COLUMNS).contains(&f64::from(u32::try_from(points.len()).unwrap()))
    );
    assert!(points.contains(&(1_234_567.0 * 1e-3, 5.0)));
    let width = last / COLUMNS * 2.0;
    assert!(points.windows(2).all(|pair| pair[1].0 - pair[0].0 < width));
    let all: Vec<_> = stretches.iter().collect();
    assert!(all.len() <= 10_000);
    assert!(all.windows(2).all(|pair| pair[0].1 <= pair[1].0 && pair[0].2 < pair[1].2));
    assert_eq!((all[0].0, all.last().unwrap().1), (0.0, last));
}

/// Where a line leaves its columns free it has a gap.
#[test]
fn a_value_that_is_missing_is_a_gap() {
    let mut series = Series::default();
    for (at, value) in [(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, f64::INFINITY), (4.0, 3.0)] {
        series.push(at, Some(value));
    }
    series.push(5.0, None);
    let pieces: Vec<_> = series.points().split(|at| at.1.is_nan()).map(<[_]>::to_vec).collect();
    assert_eq!(pieces, [vec![(0.0, 1.0), (1.0, 2.0)], vec![(4.0, 3.0)], vec![]]);
}

fn chart(row: Row) -> String {
    Chart {
        title: "a <b> & \"c\"".to_owned(),
        subtitle: String::new(),
        across: Across::time([0.0, 1000.0]),
        rows: vec![row],
        strips: Vec::new(),
        legend: Legend::new(),
    }
    .svg()
}

/// Limits that are far away would make a level line of the curve: they are noted next to it.
#[test]
fn far_limits_are_notes() {
    let row = |limits: &[f64]| Row::fitted("x", "mm", 100.0, Some([0.0, 10.0]), limits);
    let near = row(&[-5.0, 12.0]);
    assert!(near.shows_limit() && near.range[0] < -5.0 && near.range[1] > 12.0);
    let text = chart(near);
    assert_eq!(text.matches("stroke-dasharray").count(), 2);
    assert!(!text.contains("limit ") && text.contains("a &lt;b&gt; &amp; &quot;c&quot;"));
    assert!(text.contains(">time (min)</text>"));
    let far = row(&[f64::NEG_INFINITY, 500.0]);
    assert!(!far.shows_limit() && far.range[1] < 12.0);
    let text = chart(far);
    assert!(!text.contains("stroke-dasharray") && text.contains(">limit 500</text>"), "{text}");
}

/// A label lies neither on a limit nor outside of its row, and labels leave each other room.
#[test]
fn labels_are_clear() {
    let mut row = Row::new("x", "mm", 100.0, [0.0, 10.0]);
    row.limits = vec![8.2];
    row.shapes.push(Shape::Mark(Mark {
        at: (500.0, 7.0),
        color: INK,
        label: "line 7".to_owned(),
        side: Side::Above,
    }));
    for at in [100.0, 110.0, 900.0] {
        row.shapes.push(Shape::Label(at, format!("hit {at}"), MARK));
    }
    let text = chart(row);
    let y = |start: &str, key: &str| -> f64 {
        let line = text.lines().find(|line| line.contains(start)).unwrap();
        let (_, rest) = line.split_once(&format!(" {key}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    assert!((y(">line 7<", "y") - y("stroke-dasharray", "y1")).abs() > 9.0, "{text}");
    assert!(text.contains("hit 100<") && text.contains("hit 900<") && !text.contains("hit 110<"));
}

#[test]
fn words_have_room() {
    let long = "word ".repeat(60);
    let head = Head::new("title", &long, 500.0);
    assert!(head.height() > Head::new("title", "word", 500.0).height() + 50.0);
    let legend = vec![(Sign::Ring(INK), "some words".to_owned()); 8];
    let (places, height) = legend_places(&legend, 400.0);
    assert!(places.iter().all(|place| place.0 < 400.0 && place.1 < height) && height > 40.0);
}
