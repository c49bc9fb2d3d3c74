//! Tappets on which the master stands when the cam begins (manual 4.4.2).

use super::tappets::{acts, tappet};
use crate::axis::profile::State;
use crate::cam::{Action, Cam, CamCoupling, CamInput, CamTable, Knot, Passage, Shape};
use std::sync::Arc;

/// A master that stands on a tappet when the cam begins has not come to it: it acts when that happens, from either side, at the
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
        // It stands on, and then goes.
        (&[50.0, 50.0, 60.0], 0),
    ] {
        assert_eq!(acts(Passage::Every, 0.0, way), [times; 2], "{way:?}");
    }
    let knots = vec![Knot::at_rest(0.0, 0.0), Knot::at_rest(360.0, 0.0)];
    let places = [(1, 0.0), (2, 360.0), (3, 50.0)];
    let tappets = places.map(|(group, at)| tappet(group, at, Passage::Every, Action::On)).to_vec();
    let cam = Arc::new(Cam::new("cam", Shape::Polynomial(knots), tappets).expect("a cam"));
    let stood = |periodic, x: f64| -> Vec<i16> {
        let table = CamTable { periodic, ..CamTable::new(cam.clone()) };
        let rest = State::resting(0.0);
        // Inside the cam at first, so that it may begin a pass or more further.
        let input = CamInput { master_offset: x, ..CamInput::default() };
        let coupling = CamCoupling::start(table, input, &rest, &rest, 0).expect("on the cam");
        coupling.stood_on().map(|tappet| tappet.group).collect()
    };
    assert_eq!(stood(true, 0.0), [1, 2], "the end is the begin of the next pass");
    assert_eq!(stood(false, 0.0), [1]);
    assert_eq!(stood(false, 360.0), [2]);
    assert_eq!(stood(true, 50.0), [3]);
    assert!(stood(true, 50.000_000_1).is_empty());
}
