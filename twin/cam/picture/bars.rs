//! When tappets are on.

use super::Shown;
use twin_motion::cam::{Action, Passage, Tappet};

/// Stretches of the cam on which the bit of a group is on when the master goes forwards, pass after pass. With a negative
/// factor of the master the passes go from the end of the cam to its begin.
pub(in crate::cam) fn on_stretches(shown: &Shown<'_>, group: i16) -> Vec<[f64; 2]> {
    let curve = shown.file.cam.curve();
    let (start, end) = (curve.start(), curve.end());
    let backwards = shown.using.factors().master < 0.0;
    let other = if backwards { Passage::Positive } else { Passage::Negative };
    // Backwards is forwards on the mirrored cam.
    let mirrored = |place: f64| if backwards { start + end - place } else { place };
    let all = shown.file.cam.tappets().iter();
    let passed = all.filter(|tappet| tappet.group == group && tappet.passage != other);
    let mut tappets: Vec<_> =
        passed.map(|tappet| Tappet { master: mirrored(tappet.master), ..*tappet }).collect();
    tappets.sort_by(|one, other| one.master.total_cmp(&other.master));
    let speed = (shown.using.master.velocity * shown.using.factors().master).abs();
    let mut on = false;
    let mut since = start;
    let mut found = Vec::new();
    // The first pass says how the second begins, if there is one.
    for _pass in 0..if shown.using.repeated { 2 } else { 1 } {
        found.clear();
        since = start;
        for tappet in &tappets {
            let next = match tappet.action {
                Action::On => true,
                Action::Off => false,
                Action::Invert => !on,
                Action::Timed { delay_ns, duration_ns } => {
                    #[expect(clippy::cast_precision_loss, reason = "a day at most")]
                    let [delay, length] =
                        [delay_ns, duration_ns].map(|ns| ns as f64 * 1e-9 * speed);
                    let begin = tappet.master + delay;
                    timed(&mut found, [begin, begin + length], [start, end], shown.using.repeated);
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
        found = found.into_iter().map(|[begin, end]| [mirrored(end), mirrored(begin)]).collect();
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
