//! Bars of the cam picture: the intervals in which each group of tappets is on.

use super::Shown;
use twin_cam::{Action, Passage, Tappet};

/// The tappets of a group in the order in which a master passes them that goes forwards, and begin and end of its passes. With a
/// negative factor of the master they go from the end of the cam to its begin: that is forwards on the mirrored cam.
fn passed(shown: &Shown<'_>, group: i16) -> Vec<Tappet> {
    let backwards = shown.using.factors().master < 0.0;
    let other = if backwards { Passage::Positive } else { Passage::Negative };
    let all = shown.file.cam.tappets().iter();
    let passed = all.filter(|tappet| tappet.group == group && tappet.passage != other);
    let mut tappets: Vec<_> =
        passed.map(|tappet| Tappet { master: mirrored(shown, tappet.master), ..*tappet }).collect();
    tappets.sort_by(|one, other| one.master.total_cmp(&other.master));
    tappets
}

fn mirrored(shown: &Shown<'_>, place: f64) -> f64 {
    let curve = shown.file.cam.curve();
    let backwards = shown.using.factors().master < 0.0;
    if backwards { curve.start() + curve.end() - place } else { place }
}

/// Whether what the bit of a group is in a pass follows from what it was before: nothing but inverts it.
fn inverts(tappets: &[Tappet]) -> bool {
    !tappets.iter().any(|tappet| matches!(tappet.action, Action::On | Action::Off))
}

/// Whether the bit of a group is on in a pass where it is off in the one before: the signal has a period of two passes.
pub(super) fn alternates(shown: &Shown<'_>, group: i16) -> bool {
    let tappets = passed(shown, group);
    let count = tappets.iter().filter(|tappet| tappet.action == Action::Invert).count();
    shown.using.repeated && inverts(&tappets) && count % 2 == 1
}

/// Stretches of the cam on which the bit of a group is on when the master goes forwards, pass after pass. Of a group that is only
/// inverted those of the first pass, from the begin of the cam: it is off there, and has not passed the tappets there.
pub(in crate::cam) fn on_stretches(shown: &Shown<'_>, group: i16) -> Vec<[f64; 2]> {
    let curve = shown.file.cam.curve();
    let (start, end) = (curve.start(), curve.end());
    let backwards = shown.using.factors().master < 0.0;
    let tappets = passed(shown, group);
    let repeated = shown.using.repeated;
    let first_pass = repeated && inverts(&tappets);
    let speed = (shown.using.master.velocity * shown.using.factors().master).abs();
    let mut on = false;
    let mut since = start;
    let mut found = Vec::new();
    // The first pass says how the second begins, if there is one.
    for _pass in 0..if repeated && !first_pass { 2 } else { 1 } {
        found.clear();
        since = start;
        for tappet in &tappets {
            let next = match tappet.action {
                Action::On => true,
                Action::Off => false,
                Action::Invert => on ^ !(first_pass && tappet.master <= start),
                Action::Timed { delay_ns, duration_ns } => {
                    #[expect(clippy::cast_precision_loss, reason = "a day at most")]
                    let [delay, length] =
                        [delay_ns, duration_ns].map(|ns| ns as f64 * 1e-9 * speed);
                    let begin = tappet.master + delay;
                    timed(&mut found, [begin, begin + length], [start, end], repeated);
                    continue;
                }
            };
            if on && !next {
                found.push([since, tappet.master]);
            }
            if next && !on {
                since = tappet.master;
            }
            on = next;
        }
    }
    if on {
        found.push([since, end]);
    }
    if backwards {
        found = found
            .into_iter()
            .map(|[begin, end]| [mirrored(shown, end), mirrored(shown, begin)])
            .collect();
    }
    found
}

/// A pulse, which may go on in the next pass.
fn timed(
    found: &mut Vec<[f64; 2]>,
    [begin, until]: [f64; 2],
    [start, end]: [f64; 2],
    repeated: bool,
) {
    let width = end - start;
    if !repeated {
        if begin < end {
            found.push([begin, until.min(end)]);
        }
        return;
    }
    if until - begin >= width {
        found.push([start, end]);
        return;
    }
    let begin_inside = start + (begin - start).rem_euclid(width);
    let until_inside = begin_inside + (until - begin);
    found.push([begin_inside, until_inside.min(end)]);
    if until_inside > end {
        found.push([start, until_inside - width]);
    }
}
