//! Tests of tappets (manual 4.4.2, 5.5).

use super::{CYCLE_NS, Switched, at, moving, tappet};
use crate::{Action, CamInput, Passage, Tappet, TappetBit, Trigger};
use proptest::prelude::*;

fn plain(tappets: Vec<Tappet>) -> Switched {
    Switched::by(tappets, CamInput::default())
}

fn banded(tappets: Vec<Tappet>, tappet_hysteresis: f64) -> Switched {
    Switched::by(tappets, CamInput { tappet_hysteresis, ..CamInput::default() })
}

/// How often the bit of group 1 changes, from off on, over positions and velocities a cycle apart.
fn changes(switched: &mut Switched, way: impl IntoIterator<Item = (f64, f64)>) -> usize {
    let (mut count, mut before) = (0, false);
    for (cycle, (position, velocity)) in (0..).zip(way) {
        let (bit, _) = switched.step(moving(position, velocity), cycle * CYCLE_NS);
        count += usize::from(bit != before);
        before = bit;
    }
    count
}

/// The bit of group 1 after each position, a cycle apart.
fn bits(switched: &mut Switched, positions: &[f64]) -> Vec<bool> {
    let cycles = (0..).zip(positions);
    cycles.map(|(cycle, position)| switched.step(at(*position), cycle * CYCLE_NS).0).collect()
}

/// Every passage with every lasting action: on 50 and back.
#[test]
fn passages_and_actions() {
    let way = [40.0, 60.0, 40.0, 60.0, 40.0];
    for (passage, action, expected) in [
        (Passage::Positive, Action::On, [false, true, true, true, true]),
        (Passage::Negative, Action::On, [false, false, true, true, true]),
        (Passage::Every, Action::Invert, [false, true, false, true, false]),
        (Passage::Positive, Action::Invert, [false, true, true, false, false]),
        (Passage::Negative, Action::Invert, [false, false, true, true, false]),
        (Passage::Every, Action::Off, [false; 5]),
    ] {
        let mut switched = plain(vec![tappet(1, 50.0, passage, action)]);
        assert_eq!(bits(&mut switched, &way), expected, "{passage:?} {action:?}");
    }
}

/// Two tappets of one group act in the order in which they are passed, forwards and back.
#[test]
fn tappets_of_a_group_in_order() {
    let both = vec![
        tappet(1, 50.0, Passage::Every, Action::On),
        tappet(1, 55.0, Passage::Every, Action::Off),
    ];
    assert_eq!(
        bits(&mut plain(both), &[40.0, 60.0, 40.0, 52.0, 60.0]),
        [false, false, true, true, false]
    );
}

#[test]
fn a_tappet_acts_once_where_the_master_stops_on_it() {
    let invert = vec![tappet(1, 50.0, Passage::Every, Action::Invert)];
    let found = bits(&mut plain(invert.clone()), &[40.0, 50.0, 50.0, 60.0]);
    assert_eq!(found, [false, true, true, true]);
    // Noise around it: without a band every passage counts, with one the first does.
    let noise = [49.0, 50.4, 49.7, 50.2, 49.6, 50.3, 60.0, 49.9];
    let found = bits(&mut plain(invert.clone()), &noise);
    assert_eq!(found, [false, true, false, true, false, true, true, false]);
    let found = bits(&mut banded(invert, 0.5), &noise);
    assert_eq!(found, [false, true, true, true, true, true, true, false]);
}

/// Number of actions of a tappet at 50 over a motion: by its bit, and as they are reported.
pub(super) fn acts(passage: Passage, hysteresis: f64, way: &[f64]) -> [usize; 2] {
    let mut switched = banded(vec![tappet(1, 50.0, passage, Action::Invert)], hysteresis);
    let (mut counts, mut before) = ([0; 2], false);
    for (cycle, position) in (0..).zip(way) {
        let (bit, acted) = switched.step(at(*position), cycle * CYCLE_NS);
        counts[0] += usize::from(bit != before);
        counts[1] += acted;
        before = bit;
    }
    counts
}

/// A tappet acts again when the master has left the band around it. What it does not count, a passage in the other
/// direction, holds nothing back.
#[test]
fn the_band_holds_back_what_has_acted_only() {
    use Passage::{Every, Negative, Positive};
    for (passage, way, banded, plain) in [
        (Positive, &[60.0, 47.0, 80.0][..], 1, 1),
        (Negative, &[60.0, 47.0, 80.0], 1, 1),
        (Every, &[60.0, 47.0, 80.0], 1, 2),
        (Positive, &[40.0, 53.0, 20.0], 1, 1),
        (Negative, &[40.0, 53.0, 20.0], 1, 1),
        (Every, &[40.0, 53.0, 20.0], 1, 2),
        // Back within the band, and forth.
        (Positive, &[40.0, 53.0, 48.0, 80.0], 1, 2),
        (Negative, &[60.0, 47.0, 52.0, 20.0], 1, 2),
        (Every, &[40.0, 53.0, 48.0, 80.0], 1, 3),
        // Back beyond it.
        (Positive, &[40.0, 53.0, 44.0, 80.0], 2, 2),
        (Negative, &[60.0, 47.0, 56.0, 20.0], 2, 2),
        (Every, &[40.0, 56.0, 44.0, 80.0], 3, 3),
        // Near it all the time: each direction once.
        (Positive, &[52.0, 48.0, 52.0, 48.0, 52.0], 1, 2),
        (Negative, &[52.0, 48.0, 52.0, 48.0, 52.0], 1, 2),
        (Every, &[52.0, 48.0, 52.0, 48.0, 52.0], 1, 4),
    ] {
        for (hysteresis, expected) in [(5.0, banded), (0.0, plain)] {
            let found = acts(passage, hysteresis, way);
            assert_eq!(found, [expected; 2], "{passage:?} {hysteresis} {way:?}");
        }
    }
}

#[test]
fn timed_tappets_have_delay_and_duration() {
    // Passed half way between the cycles at 0 and 1 ms: on at 3.5 ms, off at 5.6 ms.
    let timed = Action::Timed { delay_ns: 3_000_000, duration_ns: 2_100_000 };
    let mut slow = plain(vec![tappet(1, 50.0, Passage::Every, timed)]);
    let way = [45.0, 55.0, 60.0, 60.0, 60.0, 60.0, 60.0];
    assert_eq!(bits(&mut slow, &way), [false, false, false, false, true, true, false]);
    // Shorter than a cycle: seen in one.
    let short = Action::Timed { delay_ns: 1_100_000, duration_ns: 1000 };
    let mut short = plain(vec![tappet(1, 50.0, Passage::Every, short)]);
    assert_eq!(bits(&mut short, &way), [false, false, true, false, false, false, false]);
}

#[test]
fn pulses_overlap() {
    let mut bit = TappetBit::default();
    let timed = Action::Timed { delay_ns: 10, duration_ns: 100 };
    let trigger = |time_ns, action| Trigger { group: 1, action, time_ns };
    bit.take(&trigger(0, timed));
    assert_eq!([9, 10].map(|now| bit.at(now)), [false, true]);
    bit.take(&trigger(50, timed));
    // 10 to 110 and 60 to 160.
    let times = [109, 110, 159, 160];
    assert_eq!(times.map(|now| bit.at(now)), [true, true, true, false]);
    // What is switched off within a pulse stays off.
    bit.take(&trigger(200, timed));
    assert!(bit.at(250));
    bit.take(&trigger(260, Action::Off));
    assert_eq!([270, 309, 400].map(|now| bit.at(now)), [false; 3]);
}

/// 10 passes of a rotary master over a cam of half its turn.
#[test]
fn passes_over_the_end() {
    let mut switched = plain(vec![tappet(1, 0.0, Passage::Positive, Action::Invert)]);
    switched.table.master_period = Some(720.0);
    let mut ends = 0;
    let way = (0..=720_i32).map(|step| (f64::from(step) * 5.0 % 720.0, 0.0));
    assert_eq!(changes(&mut switched.clone(), way.clone()), 10);
    for (cycle, (position, _)) in (0..).zip(way) {
        switched.step(at(position), cycle * CYCLE_NS);
        let coupling = switched.coupling.as_ref().expect("it has begun");
        ends += i32::from(coupling.output().end_of_profile);
    }
    assert_eq!(ends, 10);
}

/// A master at v u/s from x0 on: a tappet at x switches at (x − x0)/v − dead time, forwards and back, whatever the scaling.
#[test]
fn dead_time_switches_so_much_earlier() {
    for (velocity, from, scaling) in [(100.0, 0.0, 1.0), (-100.0, 360.0, 1.0), (50.0, 0.0, 2.0)] {
        for dead_time_s in [0.0, 0.05, 0.3] {
            let on = vec![tappet(1, 200.0, Passage::Every, Action::On)];
            let input = CamInput {
                tappet_dead_time_s: dead_time_s,
                master_scaling: scaling,
                ..CamInput::default()
            };
            let mut bit = Switched::by(on, input);
            let switched = (0..4_000_i32).find(|cycle| {
                let position = from + velocity * 1e-3 * f64::from(*cycle);
                bit.step(moving(position, velocity), i64::from(*cycle) * CYCLE_NS).0
            });
            let expected = (200.0 / scaling - from) / velocity - dead_time_s;
            let switched = f64::from(switched.expect("it switches")) * 1e-3;
            assert!((switched - expected).abs() <= 1e-3 + 1e-9, "{switched} {expected}");
        }
    }
}

/// A master that jitters by less than the hysteresis passes nothing again that was looked for ahead of it, 10 u here; one
/// that turns does, from where it has turned.
#[test]
fn jitter_within_the_hysteresis_passes_nothing_ahead_again() {
    let counts = |place: f64, passage, hysteresis: f64, then: f64| {
        let cam = vec![tappet(1, place, passage, Action::Invert)];
        let input = CamInput {
            tappet_dead_time_s: 0.1,
            tappet_hysteresis: hysteresis,
            ..CamInput::default()
        };
        // By 1 u a cycle to 50, then back and forth by 0.5 u, then on.
        let jitter = (0..40).map(|cycle| if cycle % 2 == 0 { 49.5 } else { 50.0 });
        let way = (0..=50)
            .map(f64::from)
            .chain(jitter)
            .chain((1..=20).map(|by| 50.0 + f64::from(by) * then));
        let mut before = 0.0;
        let way = way.map(|place| {
            let velocity = if place == before { 0.0 } else { 100.0 * (place - before).signum() };
            before = place;
            (place, velocity)
        });
        changes(&mut Switched::by(cam, input), way)
    };
    for passage in [Passage::Every, Passage::Positive] {
        assert_eq!(counts(55.0, passage, 1.0, 1.0), 1);
        assert_eq!(counts(55.0, passage, 1.0, -1.0), 1);
    }
    assert_eq!(counts(55.0, Passage::Negative, 1.0, -1.0), 0);
    // It has been to 50, so that it passes 49.8 when it has turned, and 45 with it.
    assert_eq!(counts(49.8, Passage::Negative, 1.0, -1.0), 1);
    assert_eq!(counts(45.0, Passage::Every, 1.0, -1.0), 2);
    // Without a hysteresis every step is a turn.
    assert!(counts(55.0, Passage::Every, 0.0, 1.0) > 10);
}

/// Positions and velocities of a master that brakes with 2000 u/s² from 100 u/s, 2.5 u on, rests, and goes on or back.
fn braking(then: f64) -> Vec<(f64, f64)> {
    let at = |cycle: i32| {
        let t = f64::from(cycle) * 1e-3;
        match t {
            ..0.1 => (100.0 * t, 100.0),
            ..0.15 => {
                let t = t - 0.1;
                (10.0 + 100.0 * t - 1000.0 * t * t, 100.0 - 2000.0 * t)
            }
            ..0.2 => (12.5, 0.0),
            _ => (12.5 + then * (t - 0.2), then),
        }
    };
    (0..300).map(at).collect()
}

/// Where a braking master will be comes nearer with its velocity: it does not go backwards for that.
#[test]
fn a_braking_master_passes_nothing_backwards() {
    let counts = |place: f64, passage, then: f64| {
        let cam = vec![tappet(1, place, passage, Action::Invert)];
        let input = CamInput { tappet_dead_time_s: 0.1, ..CamInput::default() };
        changes(&mut Switched::by(cam, input), braking(then))
    };
    // 10 u ahead at 100 u/s it has been seen up to 20; it rests at 12.5.
    for (place, passage, then, expected) in [
        (11.0, Passage::Every, 0.0, 1),
        (15.0, Passage::Every, 0.0, 1),
        (15.0, Passage::Negative, 0.0, 0),
        (15.0, Passage::Negative, 100.0, 0),
        (15.0, Passage::Every, 100.0, 1),
        (15.0, Passage::Positive, 100.0, 1),
        // Back from 12.5 it has never been at 15, but comes to 11 once more.
        (15.0, Passage::Negative, -100.0, 0),
        (15.0, Passage::Every, -100.0, 1),
        (11.0, Passage::Negative, -100.0, 1),
        (11.0, Passage::Every, -100.0, 2),
    ] {
        assert_eq!(counts(place, passage, then), expected, "{place} {passage:?} {then}");
    }
}

proptest! {
    /// However a way is cut into cycles, an inverting tappet is passed as often.
    #[test]
    fn every_passage_counts(cuts in prop::collection::vec(0.0..1000.0_f64, 1..40), place in 0.0..360.0_f64) {
        let mut sorted = cuts;
        sorted.extend([0.0, 1000.0]);
        sorted.sort_by(f64::total_cmp);
        let invert = vec![tappet(1, place, Passage::Positive, Action::Invert)];
        let bit = *bits(&mut plain(invert), &sorted).last().expect("cycles");
        let passages = (0..3).filter(|pass| {
            let at = place + 360.0 * f64::from(*pass);
            at > 0.0 && at <= 1000.0
        });
        prop_assert_eq!(bit, passages.count() % 2 == 1);
    }
}
