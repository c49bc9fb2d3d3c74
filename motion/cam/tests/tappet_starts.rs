//! Tests of tappets on which the master is when the cam begins (manual 4.4.2).

use super::tappets::acts;
use super::{Switched, at, cam, started, still, tappet};
use crate::{Action, CamInput, CamTable, Knot, Passage};

/// A master at rest on a tappet when the cam begins has not come to it: it acts when that happens, from either side, at the
/// latest one pass on.
#[test]
fn a_tappet_under_the_master_at_the_start_waits_for_a_passage() {
    for (way, times) in [
        // Away, and once round to it.
        (&[50.0, 60.0, 409.0][..], 0),
        (&[50.0, 60.0, 410.0], 1),
        (&[50.0, 40.0, -309.0], 0),
        (&[50.0, 40.0, -310.0], 1),
        // Away and back.
        (&[50.0, 60.0, 50.0], 1),
        (&[50.0, 40.0, 60.0], 1),
        // It stays, and then goes.
        (&[50.0, 50.0, 60.0], 0),
    ] {
        assert_eq!(acts(Passage::Every, 0.0, way), [times; 2], "{way:?}");
    }
    let places = [(1, 0.0), (2, 360.0), (3, 50.0)];
    let cam =
        still(places.map(|(group, at)| tappet(group, at, Passage::Every, Action::On)).to_vec());
    let stood = |periodic, x: f64| -> Vec<i16> {
        let table = CamTable { periodic, ..CamTable::new(cam.clone()) };
        // Inside the cam at first, so that it may begin a pass or more further.
        let input = CamInput { master_offset: x, ..CamInput::default() };
        let coupling = started(table, input, at(0.0), at(0.0));
        coupling.stood_on().map(|tappet| tappet.group).collect()
    };
    assert_eq!(stood(true, 0.0), [1, 2], "the end is the begin of the next pass");
    assert_eq!(stood(false, 0.0), [1]);
    assert_eq!(stood(false, 360.0), [2]);
    assert_eq!(stood(true, 50.0), [3]);
    assert!(stood(true, 50.000_000_1).is_empty());
}

/// Off at the end of a pass comes before on at the begin of the next one, forwards, and after it backwards: the bit is on after a
/// seam that is passed forwards, and off after one that is passed backwards. The order of the lines, how often the cam has been
/// passed, and how its width is rounded change nothing.
#[test]
fn a_pass_is_over_before_the_next_one_begins() {
    // 0.1 + (0.7 − 0.1) is not 0.7 as numbers are rounded.
    for [start, end] in [[0.0, 100.0], [0.1, 0.7], [-3.3, 7.7], [1e6 + 0.1, 1e6 + 0.3]] {
        let width = end - start;
        for passage in [Passage::Every, Passage::Positive, Passage::Negative] {
            for swapped in [false, true] {
                let mut tappets = vec![
                    tappet(1, start, passage, Action::On),
                    tappet(1, end, passage, Action::Off),
                ];
                if swapped {
                    tappets.reverse();
                }
                let cam = cam(&[Knot::at_rest(start, 0.0), Knot::at_rest(end, 0.0)], tappets);
                for forwards in [true, false] {
                    let counts = match passage {
                        Passage::Positive => forwards,
                        Passage::Negative => !forwards,
                        Passage::Every => true,
                    };
                    // From the middle of a pass to that of the next; the last one to the seam itself, and on.
                    let by = if forwards { width } else { -width };
                    let middle = start.midpoint(end);
                    let mut way: Vec<_> =
                        (0..20).map(|pass| middle + f64::from(pass) * by).collect();
                    way.extend([20.0, 20.5].map(|passes| middle + (passes - 0.5) * by));
                    let mut switched =
                        Switched::new(CamTable::new(cam.clone()), CamInput::default());
                    let cycles = (0..).zip(&way);
                    let found: Vec<_> =
                        cycles.map(|(now_ns, x)| switched.step(at(*x), now_ns).0).collect();
                    let expected: Vec<_> =
                        (0..way.len()).map(|step| step > 0 && counts && forwards).collect();
                    assert_eq!(found, expected, "{start} {end} {passage:?} {swapped} {forwards}");
                }
            }
        }
    }
}
