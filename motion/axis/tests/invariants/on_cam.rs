//! Promise of a slave on its cam and on its ramp-in, and of its tappets.

use super::*;

/// [`CYCLE`], ns.
const CYCLE_NS: i64 = 10_000_000;
/// Time from the passage of a tappet to the end of its pulse, ns.
const PULSE_NS: i64 = 50_000_000;
/// Time from the passage to the begin of the pulse, ns.
const DELAY_NS: i64 = 20_000_000;

/// Pulses in group 1, another action in group 2.
pub(super) fn tappets(random: &mut Random) -> Vec<Tappet> {
    let timed = Action::Timed { delay_ns: DELAY_NS, duration_ns: PULSE_NS - DELAY_NS };
    let tappet = |random: &mut Random, group, action| Tappet {
        group,
        master: random.between(0.0, 90.0),
        passage: random.one_of(&[Passage::Positive, Passage::Negative, Passage::Every]),
        action,
    };
    let other = random.one_of(&[Action::On, Action::Off, Action::Invert]);
    vec![tappet(random, 1, timed), tappet(random, 1, timed), tappet(random, 2, other)]
}

/// Watch over a cam and what its tappets switch.
pub(super) struct OnCam {
    bit: TappetBit,
    passed: Option<Passed>,
    /// When a pulse was begun last, and whether it has been seen.
    begun_ns: i64,
    /// When the output was read last.
    read_ns: i64,
    unseen: bool,
    /// Owner on the ramp, and its velocity and acceleration relative to the cam.
    ramp: Option<(i64, f64, f64)>,
}

/// Place of the master on the cam, and the tappets that it has passed and not left.
struct Passed {
    owner: i64,
    x: f64,
    held: Vec<Held>,
}

/// Whether a tappet has acted and not been left.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    /// Nothing is known yet.
    Unknown,
    Left,
    /// It has acted there.
    At(f64),
}

impl Held {
    /// The same where the master is at x.
    fn left_at(self, x: f64, hysteresis: f64) -> Self {
        match self {
            Self::At(at) if (x - at).abs() > hysteresis => Self::Left,
            held => held,
        }
    }
}

impl Passed {
    /// The places of a tappet about a way.
    fn places(table: &CamTable, tappet: &Tappet, [from, to]: [f64; 2]) -> Vec<f64> {
        let curve = table.cam.curve();
        let width = curve.end() - curve.start();
        if !table.periodic {
            return vec![tappet.master];
        }
        let first = ((from.min(to) - tappet.master) / width).floor() - 1.0;
        (0..4).map(|more| tappet.master + (first + f64::from(more)) * width).collect()
    }

    /// Passages on the way to `x`: least and largest count of each group.
    fn on(&mut self, x: f64, table: &CamTable, hysteresis: f64) -> Vec<(i16, [usize; 2])> {
        let from = std::mem::replace(&mut self.x, x);
        let mut counts = Vec::new();
        for (tappet, held) in table.cam.tappets().iter().zip(&mut self.held) {
            let places = Self::places(table, tappet, [from, x]);
            if *held == Held::Unknown {
                // Known again outside all places.
                if places.iter().all(|at| (x - at).abs() > hysteresis) {
                    *held = Held::Left;
                }
                counts.push((tappet.group, [0, 1]));
                continue;
            }
            *held = held.left_at(from, hysteresis);
            let counts_so = match tappet.passage {
                Passage::Positive => x > from,
                Passage::Negative => x < from,
                Passage::Every => true,
            };
            let passed = places
                .into_iter()
                .filter(|at| (from < *at && *at <= x) || (x <= *at && *at < from))
                .filter(|at| counts_so && *held != Held::At(*at))
                .collect::<Vec<_>>();
            *held = passed.last().map_or(*held, |at| Held::At(*at)).left_at(x, hysteresis);
            counts.push((tappet.group, [passed.len(); 2]));
        }
        counts
    }
}

impl OnCam {
    pub(super) fn new() -> Self {
        let bit = TappetBit::default();
        Self { bit, passed: None, begun_ns: 0, read_ns: 0, unseen: false, ramp: None }
    }

    /// Tappets act in the cycle in which the master passes them, and no pulse is lost or hangs.
    fn see_tappets(&mut self, owner: i64, run: &CamRun, taken: &CamIn) -> Checked {
        let coupling = run.coupling();
        let data = &coupling.output().tappets;
        let triggers: Vec<_> = data.triggers().copied().collect();
        let now = data.now_ns;
        let table = taken.table.as_ref().ok_or("without a cam")?;
        let unknown = Passed {
            owner,
            x: coupling.place(),
            held: vec![Held::Unknown; table.cam.tappets().len()],
        };
        let mut passed = self.passed.take().filter(|it| it.owner == owner).unwrap_or(unknown);
        let counts = passed.on(coupling.place(), table, taken.input.tappet_hysteresis);
        self.passed = Some(passed);
        for group in [1, 2] {
            let acted = triggers.iter().filter(|trigger| trigger.group == group).count();
            let of_group = counts.iter().filter(|(it, _)| *it == group);
            let [least, most] =
                of_group.fold([0, 0], |[a, b], (_, [least, most])| [a + least, b + most]);
            if acted < least || acted > most {
                return Err(format!("tappets of group {group} acted {acted} times, not {least}"));
            }
        }
        let mut before = i64::MIN;
        for trigger in &triggers {
            let time = trigger.time_ns;
            if time < before || time > now || time < now - CYCLE_NS - 1 {
                return Err(format!("{trigger:?} at {now}, after {before}"));
            }
            before = time;
            if trigger.group == 1 {
                if self.unseen && time > self.begun_ns + PULSE_NS {
                    return Err(format!("nobody has seen the pulse of {}", self.begun_ns));
                }
                self.begun_ns = time;
                self.unseen = true;
            }
        }
        let on = switched(&mut self.bit, data);
        let after = now - self.begun_ns;
        self.unseen &= !(on && after >= DELAY_NS);
        // A pulse shows for a cycle at least; one that ended unseen shows until it is read.
        let read = std::mem::replace(&mut self.read_ns, now);
        if on && read > self.begun_ns + PULSE_NS + CYCLE_NS {
            return Err(format!("a pulse of {} is still there at {now}", self.begun_ns));
        }
        if self.unseen && after > DELAY_NS + CYCLE_NS {
            return Err(format!("a pulse of {} is not there at {now}", self.begun_ns));
        }
        Ok(())
    }

    /// On the cam it has the cam's motion (manual 4.6.1: scaling · y(x)); on the ramp it stays within the ramp's limits.
    fn see_motion(&mut self, owner: i64, run: &CamRun, it: &Look<'_, CamIn>) -> Checked {
        /// Slopes of a rise of 20 u over 40 u between rests: 15/8 and 10/√3 of a straight line's.
        const STEEPEST: [f64; 2] = [0.9375, 0.072_169];
        let (before, input, axis) = (self.ramp.take(), &it.taken.input, it.axis);
        if owner != axis.owner() {
            return Ok(());
        }
        let coupling = run.coupling();
        let Master { velocity, acceleration, .. } = Master::of(it.lead);
        let (scaling, of_master) = (input.slave_scaling, input.master_scaling);
        let (v, a) = (velocity * of_master, acceleration * of_master);
        let curve = coupling.table().cam.curve();
        let x = coupling.place();
        let at = if coupling.table().periodic { curve.repeated(x) } else { curve.at(x) };
        let expected = scaling * at.velocity * v;
        let bent = scaling * (at.acceleration * v * v + at.velocity * a);
        let [steep, curved] = STEEPEST;
        if expected.abs() > scaling.abs() * steep * v.abs() + 1e-9
            || bent.abs() > scaling.abs() * (curved * v * v + steep * a.abs()) + 1e-9
        {
            return Err(format!("a cam of {expected} u/s and {bent} u/s² under {v} and {a}"));
        }
        let (faster, more) = (axis.base.velocity - expected, axis.base.acceleration - bent);
        if run.is_in_sync() {
            return if faster.abs() > 1e-6 || more.abs() > 1e-4 {
                Err(format!("in step, but {faster} u/s and {more} u/s² off the cam"))
            } else {
                Ok(())
            };
        }
        let limited = axis.ramp() != RampType::Trapezoid;
        if let Some((_, last, rate)) = before.filter(|(who, ..)| *who == owner) {
            let settling = if limited { 0.5 * rate * rate / JERK } else { 0.0 };
            let most = input.velocity_difference.max(last.abs() + settling);
            if faster.abs() > most * (1.0 + 1e-9) + 1e-6 {
                return Err(format!("{faster} u/s off the cam after {last}, allowed {most}"));
            }
        }
        self.ramp = Some((owner, faster, more));
        Ok(())
    }
}

impl Watch<CamIn> for OnCam {
    fn see(&mut self, it: &Look<'_, CamIn>) -> Checked {
        let (Some(owner), Some(run)) = (it.block.owner(), it.block.running()) else {
            self.ramp = None;
            return Ok(());
        };
        let (shown, now) = (run.coupling().output().tappets.now_ns, it.axis.now_ns());
        if shown != now {
            return Err(format!("tappets of {shown} at {now}"));
        }
        self.see_tappets(owner, run, it.taken)?;
        self.see_motion(owner, run, it)
    }
}
