//! Whether outputs switch as often as the tappets that the master passes can make them.

use super::super::CamFile;
use super::super::check::CamUse;
use super::super::run::RecordedRun;
use super::tappet_error::OutputError;
use twin_motion::cam::{Action, Passage, Tappet};

/// Outputs may switch so many times more than the tappets that were passed say: of two the run has not shown the passage.
const PENDING: usize = 2;
/// More passes from one sample to the next say nothing of tappets.
const MOST_PASSES: f64 = 2.0;
/// So many standard deviations of the master's noise are no motion.
const NOISE: f64 = 6.0;

/// How often an output may have switched: what the tappets that the master passed say, one after the other.
#[derive(Default)]
struct Passed {
    /// Tappets of the group that were passed.
    tappets: usize,
    /// Changes of the bit.
    changes: usize,
    /// Changes from one sample to the next.
    shown: usize,
    /// Whether a pulse is among them, whose end is a matter of time.
    timed: bool,
}

/// Outputs that switch more often than the tappets of their group can make them, or less than half as often.
///
/// The master is measured, so it seems to go to and fro where it stands. At most it passes every tappet that it seems to; what
/// switches them may have seen it beside an `invert` tappet, too. For certain it passes those alone that it goes over by more
/// than its noise.
pub(super) fn refuse_count(
    file: &CamFile,
    using: &CamUse,
    run: &RecordedRun,
    output: usize,
) -> Result<(), OutputError> {
    let Some(group) = run.groups.get(output).copied() else { return Ok(()) };
    let values: Vec<_> = run
        .samples
        .iter()
        .map(|sample| sample.outputs.get(output).copied().unwrap_or_default())
        .collect();
    let count = values.windows(2).filter(|pair| pair.first() != pair.last()).count();
    let input = &using.coupling.input;
    let places: Vec<_> = run
        .samples
        .iter()
        .map(|sample| sample.master * input.master_scaling + input.master_offset)
        .collect();
    let noise = (NOISE * run.noise() * input.master_scaling.abs()).min(f64::MAX);
    let way = Way::new(file, using, group);
    let most = way.passed(&places, &values, noise);
    if count > most.changes + PENDING {
        let Passed { tappets, changes, .. } = most;
        return Err(OutputError::TooOften { group, count, tappets, changes });
    }
    // Where half of what was to be seen is not, something else decides.
    let certain = way.passed(&held(&places, noise), &values, 0.0);
    if !certain.timed && 2 * count + PENDING < certain.shown {
        let Passed { tappets, shown, .. } = certain;
        return Err(OutputError::TooRare { group, count, tappets, changes: shown });
    }
    Ok(())
}

/// Places that follow the others as far behind as they may be noise, so that they turn back only where these do.
fn held(places: &[f64], noise: f64) -> Vec<f64> {
    let mut at = places.first().copied().unwrap_or_default();
    let follow = |place: &f64| {
        at = at.clamp(place - noise, place + noise);
        at
    };
    places.iter().map(follow).collect()
}

/// The tappets of a group on the way of the master.
struct Way<'a> {
    tappets: Vec<&'a Tappet>,
    width: f64,
    repeated: bool,
}

impl<'a> Way<'a> {
    fn new(file: &'a CamFile, using: &CamUse, group: i16) -> Self {
        let curve = file.cam.curve();
        let tappets = file.cam.tappets().iter().filter(|tappet| tappet.group == group).collect();
        Self { tappets, width: curve.end() - curve.start(), repeated: using.repeated }
    }

    /// What is passed at places of the cam, sample by sample, with an output that has these values; beside `invert` tappets
    /// that are no farther than `noise` it may switch as well.
    fn passed(&self, places: &[f64], values: &[bool], noise: f64) -> Passed {
        let mut found = Passed::default();
        let mut on = values.first().copied().unwrap_or_default();
        for (pair, value) in places.windows(2).zip(values.iter().skip(1)) {
            let [from, to] = *pair else { continue };
            if self.repeated && (from - to).abs() > MOST_PASSES * self.width {
                (found.changes, on) = (found.changes + 1, *value);
                continue;
            }
            let before = on;
            let crossed = self.crossed(from, to);
            let none = crossed.is_empty();
            found.tappets += crossed.len();
            for action in crossed {
                let next = match action {
                    Action::On => true,
                    Action::Off => false,
                    Action::Invert => !on,
                    Action::Timed { .. } => {
                        (found.timed, found.changes) = (true, found.changes + 2);
                        on
                    }
                };
                found.changes += usize::from(next != on);
                on = next;
            }
            found.changes += usize::from(none && self.beside(from, to, noise));
            found.shown += usize::from(before != on);
        }
        found
    }

    /// What the tappets do that are passed from one place to another, in order.
    fn crossed(&self, from: f64, to: f64) -> Vec<Action> {
        let forwards = to > from;
        let mut crossed: Vec<(f64, Action)> = Vec::new();
        for tappet in &self.tappets {
            let wanted = match tappet.passage {
                Passage::Every => true,
                Passage::Positive => forwards,
                Passage::Negative => !forwards,
            };
            if !wanted {
                continue;
            }
            if !self.repeated {
                if (from < tappet.master) != (to < tappet.master) {
                    crossed.push((tappet.master, tappet.action));
                }
                continue;
            }
            let passes = |at: f64| ((at - tappet.master) / self.width).floor();
            let (mut pass, last) = (passes(from.min(to)) + 1.0, passes(from.max(to)));
            while pass <= last {
                crossed.push((tappet.master + pass * self.width, tappet.action));
                let next = pass + 1.0;
                // So far away no number tells one pass from the next.
                if next <= pass {
                    break;
                }
                pass = next;
            }
        }
        crossed.sort_by(|one, other| one.0.total_cmp(&other.0));
        if !forwards {
            crossed.reverse();
        }
        crossed.into_iter().map(|(_, action)| action).collect()
    }

    /// Whether an `invert` tappet stands no farther than `noise` from the way between two places.
    fn beside(&self, from: f64, to: f64, noise: f64) -> bool {
        let (low, high) = (from.min(to) - noise, from.max(to) + noise);
        noise > 0.0
            && self.tappets.iter().filter(|tappet| tappet.action == Action::Invert).any(|tappet| {
                let passes =
                    if self.repeated { ((high - tappet.master) / self.width).floor() } else { 0.0 };
                (low..=high).contains(&(tappet.master + passes * self.width))
            })
    }
}
