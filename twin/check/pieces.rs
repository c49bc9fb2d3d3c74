//! Check of the planned motion, piece by piece, instead of at its set-points.

use super::edge::{EdgeDistance, EdgeSearch};
use super::findings::{About, AxisFindings, Findings};
use super::messages;
use crate::finding::{Finding, Rule, Severity};
use crate::limit::{MachinePath, out_of_reach};
use crate::messages::beyond_position;
use crate::peak::AxisPeak;
use crate::tolerance::exceeds;
use nalgebra::{Point3, Vector3};
use std::collections::VecDeque;
use std::sync::Arc;
use twin_kinematics::{AxisVector, Kinematics};
use twin_machine::{Axis, DirectionRule, Machine};
use twin_number::seconds;
use twin_path::Place;
use twin_planner::blended_path::BlendedElement;
use twin_planner::extremes::{AxisExtremes, Examiner, Extremes, Floor, LinearAxes};
use twin_planner::planned_motion::{PathState, PlannedPiece};
use twin_planner::time_optimal::AxisPath;

/// Extremes are exact to a millionth; no more than that is above a limit.
pub(super) const EXACT: f64 = 1.0 + 2e-6;
/// The same for jerks, which are exact to a thousandth.
const JERK_EXACT: f64 = 1.0 + 2e-3;
/// A jerk above its limit by more than this factor does not come from the rounding of a plan that keeps it.
const FAR_ABOVE: f64 = 1.5;
/// Values below this part of their limits are not looked for between nodes.
pub(super) const LITTLE: f64 = 1e-3;
/// Pieces that follow each other within this time, s, do so without a rest.
pub(super) const SAME_TIME: f64 = 1e-9;
/// Points nearer to each other than this are one, axes rest, and velocities do not change, m or rad (a second).
const SAME_PLACE: f64 = 1e-9;

/// The tool is at an edge of the reach if it is nearer to it than this, m.
const AT_EDGE: f64 = 1e-6;

/// A joint of the path, between two pieces.
#[derive(Debug)]
struct Joint {
    /// When, s.
    time: f64,
    /// Changes of the axes' velocities, m/s or rad/s.
    changes: AxisVector,
    /// Direction of the path before it, work frame.
    before: Vector3<f64>,
}

/// The end of the last piece.
#[derive(Debug)]
struct Last {
    element: Arc<BlendedElement>,
    /// Path length on it, m, and velocity, m/s.
    state: [f64; 2],
    place: Place,
    /// When, s.
    time: f64,
    /// First to third derivative of the axes by time.
    rates: [AxisVector; 3],
    /// Direction of the path, work frame.
    tangent: Vector3<f64>,
}

/// Checker of pieces.
#[derive(Debug)]
pub(super) struct PieceCheck<'m> {
    pub(super) machine: &'m Machine,
    pub(super) path: MachinePath<'m>,
    /// Positions of the axes at the end of the last piece, m or rad.
    pub(super) near: AxisVector,
    last: Option<Last>,
    /// Joints within the last cycle.
    joints: VecDeque<Joint>,
    /// Where the last piece ended, work frame, if the tool turns with the path: at corners it does so at once.
    tip: Option<Point3<f64>>,
    /// The last piece is out of reach, so that nothing is known of its end.
    lost: bool,
    open: Option<Open>,
    /// Factors on the limits, as [`super::checker::Checker`] has them.
    slack: [f64; 3],
    /// Axes that are checked at set-points: slaves.
    sampled: Vec<bool>,
    /// Steps of the velocity that an axis may make, m/s or rad/s.
    steps: Vec<f64>,
    /// Findings say which feed would do.
    feeds: bool,
    edge: Option<EdgeSearch<'m>>,
}

/// An element under way, with the findings that a lower feed may cure: which, is known at its end.
#[derive(Debug)]
pub(super) struct Open {
    pub(super) element: Arc<BlendedElement>,
    pub(super) near: AxisVector,
    /// Velocities at its start and where it has come to, and the largest, m/s.
    pub(super) ends: [f64; 2],
    pub(super) fastest: f64,
    /// The axes along it, if they are linear in its length.
    linear: Option<LinearAxes>,
    wrong: Vec<Wrong>,
}

/// A value above its limit.
#[derive(Debug)]
pub(super) struct Wrong {
    pub(super) axis: usize,
    pub(super) quantity: Quantity,
    /// SI.
    pub(super) limit: f64,
    pub(super) finding: Finding,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Quantity {
    Velocity,
    Acceleration,
    Deceleration,
    /// Of the velocity at once, at an edge of the reach: no feed helps.
    Step,
}

/// A piece with what is known of it.
struct Examined<'p> {
    planned: &'p PlannedPiece,
    place: Place,
    /// Path length on its element, m, and velocity, m/s, at its start.
    state: [f64; 2],
    /// Direction of the path there, work frame.
    tangent: Vector3<f64>,
    extremes: Box<Extremes>,
}

impl<'m> PieceCheck<'m> {
    pub(super) fn new(
        machine: &'m Machine,
        near: AxisVector,
        slack: [f64; 3],
        sampled: Vec<bool>,
    ) -> Self {
        let cycle = seconds(machine.cycle_ns);
        Self {
            machine,
            path: MachinePath::without_motors(machine),
            near,
            last: None,
            joints: VecDeque::new(),
            tip: None,
            lost: false,
            open: None,
            slack,
            sampled,
            steps: machine.axes.iter().map(|axis| axis.velocity_step(cycle)).collect(),
            feeds: true,
            edge: EdgeSearch::new(machine),
        }
    }

    /// Findings without the feeds that would do.
    pub(super) fn without_feeds(self) -> Self {
        Self { feeds: false, ..self }
    }

    /// True unless the plan keeps the limits of the axes.
    pub(super) fn plans_as_programmed(&self) -> bool {
        let [faster, ..] = self.slack;
        faster <= 1.0
    }

    /// Takes the next piece: its peaks and findings. `rapids`: how fast rapids are, m/s, where the machine file says it.
    pub(super) fn take(
        &mut self,
        planned: &PlannedPiece,
        peaks: &mut [AxisPeak],
        findings: &mut Findings,
        rapids: Option<f64>,
    ) {
        // Rounding makes pieces without a duration, whose acceleration says nothing.
        if planned.piece.duration < SAME_TIME {
            if let Some(last) = self.last.as_mut().filter(|last| last.goes_on(planned)) {
                last.time = planned.start() + planned.piece.duration;
            }
            return;
        }
        let place = planned.element.place();
        let goes_on = self.last.as_ref().is_some_and(|last| last.goes_on(planned));
        if !goes_on {
            self.rest(peaks, findings);
        }
        if !self.open.as_ref().is_some_and(|open| Arc::ptr_eq(&open.element, &planned.element)) {
            self.close(findings, rapids);
            if let Some(edge) = &mut self.edge {
                edge.take(&self.path, &planned.element);
            }
        }
        let floors = self.floors(peaks);
        let examiner = Examiner::new(&self.path, seconds(self.machine.cycle_ns));
        let linear = self.open.as_ref().and_then(|open| open.linear.as_ref());
        let (element, piece) = (&planned.element, &planned.piece);
        let extremes = match examiner.examine(element, piece, &self.near, &floors, linear) {
            Ok(extremes) => extremes,
            Err(out) => {
                findings.add(None, out_of_reach(self.machine, &planned.element, &out.error));
                (self.last, self.open, self.lost, self.tip) = (None, None, true, None);
                self.joints.clear();
                return;
            }
        };
        let PathState { position, velocity, .. } = piece.at(0.0).0;
        let (state, start) = ([position, velocity], element.at(position));
        let examined = Examined { planned, place, state, tangent: start.first, extremes };
        let mut open = self.open.take().unwrap_or_else(|| Open::at(planned, &self.near));
        let lost = std::mem::take(&mut self.lost);
        let jumps = self.jumps(&examined, &start.position);
        if !lost {
            self.join(&examined);
        }
        for (index, (axis, peak)) in self.machine.axes.iter().zip(peaks).enumerate() {
            if self.sampled.get(index).copied().unwrap_or_default() {
                continue;
            }
            let mut found = findings.of_axis(index, axis);
            self.values(&examined, index, axis, peak, &mut open.wrong, &mut found);
            let step = examined.extremes.axes.get(index).map(|extremes| extremes.step);
            let limit = self.step_limit(index);
            if let Some(step) = step.filter(|step| exceeds(step.value, limit)) {
                let (state, _) = planned.piece.at(step.at);
                let finding = messages::step(axis, place, step.value, limit);
                if self.is_at_edge(&planned.element, state.position) {
                    let (finding, quantity) = (messages::at_edge(finding), Quantity::Step);
                    open.wrong.push(Wrong { axis: index, quantity, limit, finding });
                } else {
                    found.add(messages::at_once(finding, state.velocity * limit / step.value));
                }
            }
            if let Some(jumps) = &jumps {
                self.jump(&examined, jumps, index, peak, &mut found);
            }
            if !lost {
                let ends = (self.last.as_ref(), Some(&examined));
                self.step(ends, index, peak, &mut open.wrong, &mut found);
            }
        }
        let [_, end] = &examined.extremes.ends;
        let (state, _) = planned.piece.at(planned.piece.duration);
        (open.ends[1], open.linear) = (state.velocity, examined.extremes.linear);
        open.fastest = open.fastest.max(state.velocity).max(velocity);
        self.open = Some(open);
        self.near = end.position;
        let point = element.at(state.position);
        let with_path = matches!(self.machine.direction, DirectionRule::Path(..));
        self.tip = with_path.then_some(point.position);
        self.last = Some(Last {
            element: Arc::clone(&planned.element),
            state: [state.position, state.velocity],
            place,
            time: planned.start() + planned.piece.duration,
            rates: end.rates,
            tangent: point.first,
        });
    }

    /// The point so far that is nearest to the edge of the reach; none if the machine has no such edge.
    pub(super) fn nearest_to_edge(&self) -> Option<EdgeDistance> {
        self.edge.as_ref()?.nearest
    }

    /// Takes the last piece at its set-points behind `shown_ns`, if it leads out of reach: positions and findings. Returns how
    /// many of them the machine cannot take.
    pub(super) fn sample(
        &self,
        planned: &PlannedPiece,
        shown_ns: i64,
        peaks: &mut [AxisPeak],
        findings: &mut Findings,
    ) -> i64 {
        let mut untaken = 0;
        if !self.lost {
            return untaken;
        }
        let place = planned.element.place();
        let mut near = self.near;
        for time in planned.cycles(shown_ns, self.machine.cycle_ns) {
            let (state, _) = planned.piece.at(time);
            let point = match self.path.axes(&planned.element, state.position, &near) {
                Ok(point) => point,
                Err(_beyond) => {
                    untaken += 1;
                    continue;
                }
            };
            near = point.position;
            let axes = self.machine.axes.iter().zip(peaks.iter_mut()).zip(near.iter());
            for (index, ((axis, peak), position)) in axes.enumerate() {
                peak.include_position([*position; 2]);
                if let Some(finding) = beyond_position(axis, place, *position) {
                    findings.add(Some(About::Axis(index)), finding);
                }
            }
        }
        untaken
    }

    /// Nothing follows.
    pub(super) fn finish(
        &mut self,
        peaks: &mut [AxisPeak],
        findings: &mut Findings,
        rapids: Option<f64>,
    ) {
        self.rest(peaks, findings);
        self.close(findings, rapids);
    }

    /// Adds what velocities change at the start of a piece to the joints of the last cycle.
    fn join(&mut self, examined: &Examined<'_>) {
        let Examined { planned, tangent, extremes, .. } = examined;
        let now = planned.start();
        let oldest = now - seconds(self.machine.cycle_ns) * (1.0 - SAME_PLACE);
        self.joints.retain(|joint| joint.time > oldest);
        let [start, _] = &extremes.ends;
        let (changes, before) = match &self.last {
            Some(last) => {
                let pairs = start.rates[0].iter().zip(last.rates[0].iter());
                (AxisVector::from_values(pairs.map(|(to, from)| to - from)), last.tangent)
            }
            None => (start.rates[0], *tangent),
        };
        self.joints.push_back(Joint { time: now, changes, before });
    }

    /// What the velocity of an axis has changed at joints of the path within the last cycle, and by what angle the path has
    /// turned there to `direction`, rad.
    fn joined(&self, index: usize, direction: &Vector3<f64>) -> (f64, f64) {
        let changes = self.joints.iter().filter_map(|joint| joint.changes.get(index));
        let angle = self.joints.front().map_or(0.0, |joint| joint.before.angle(direction));
        (changes.sum::<f64>().abs(), angle)
    }

    /// True if the tool is at an edge of the reach `s` m from the start of an element.
    fn is_at_edge(&self, element: &BlendedElement, s: f64) -> bool {
        let margins = self.machine.kinematics.margins(&self.path.pose(element, s));
        margins.is_ok_and(|margins| margins.boundary.min(margins.branch) < AT_EDGE)
    }

    /// The path comes to rest after the last piece.
    fn rest(&mut self, peaks: &mut [AxisPeak], findings: &mut Findings) {
        let Some(last) = self.last.take() else { return };
        let mut wrong = Vec::new();
        for (index, (axis, peak)) in self.machine.axes.iter().zip(peaks).enumerate() {
            if !self.sampled.get(index).copied().unwrap_or_default() {
                let mut found = findings.of_axis(index, axis);
                self.step((Some(&last), None), index, peak, &mut wrong, &mut found);
            }
        }
        if let Some(open) = &mut self.open {
            open.wrong.append(&mut wrong);
        }
    }

    /// The element under way is over: its findings, with the feeds that cure them.
    fn close(&mut self, findings: &mut Findings, rapids: Option<f64>) {
        let Some(mut open) = self.open.take() else { return };
        for mut wrong in std::mem::take(&mut open.wrong) {
            if self.feeds && findings.has_room(wrong.finding.severity) {
                wrong.finding.largest_feed_mm_per_s = self.largest_feed(&open, &wrong);
                if wrong.finding.largest_feed_mm_per_s.is_none() {
                    // RS274 has no word for accelerations.
                    wrong.finding.hint = Some(self.remedy(&open, &wrong, rapids.is_none()));
                }
            }
            if !self.feeds {
                wrong.finding.hint = Some(messages::LOWER.to_owned());
            }
            if open.element.rapid()
                && !matches!(wrong.quantity, Quantity::Step)
                && let Some(velocity) = rapids
            {
                wrong.finding.hint = Some(messages::rapid_hint(velocity));
            }
            findings.add(Some(About::Axis(wrong.axis)), wrong.finding);
        }
    }

    /// Floors: known peaks and limits.
    fn floors(&self, peaks: &[AxisPeak]) -> Vec<Floor> {
        let axes = self.machine.axes.iter().zip(peaks);
        let floor = |known: f64, limit: f64| known.min(limit).max(LITTLE * limit);
        let floors = axes.map(|(axis, peak)| {
            let [low, high] = axis.position_limits;
            let [known_low, known_high] =
                peak.position.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
            let own = axis.own_deceleration();
            let falling = peak.deceleration.unwrap_or_default().value;
            Floor {
                position: [known_low.max(low), known_high.min(high)],
                velocity: floor(peak.velocity.value, axis.max_velocity),
                acceleration: floor(peak.acceleration.value, axis.max_acceleration),
                deceleration: own.map(|limit| floor(falling, limit)),
                jerk: axis.max_jerk.map_or(f64::INFINITY, |limit| floor(peak.jerk.value, limit)),
            }
        });
        floors.collect()
    }

    /// Position, velocity, acceleration and jerk of one axis.
    fn values(
        &self,
        examined: &Examined<'_>,
        index: usize,
        axis: &Axis,
        peak: &mut AxisPeak,
        wrong: &mut Vec<Wrong>,
        found: &mut AxisFindings<'_>,
    ) {
        let Examined { place, extremes, .. } = examined;
        let place = *place;
        let Some(extremes) = extremes.axes.get(index) else { return };
        let AxisExtremes { position, velocity, acceleration, deceleration, jerk, .. } = *extremes;
        let [faster, harder, jerkier] = self.slack;
        if let Some([low, high]) = position {
            peak.include_position([low, high]);
            for position in [low, high] {
                if let Some(beyond) = beyond_position(axis, place, position) {
                    found.add(beyond);
                }
            }
        }
        peak.velocity.include(velocity.value, place);
        let (error, limit) = (Severity::Error, axis.max_velocity);
        if exceeds(velocity.value, EXACT * faster * limit)
            && !found.count_unkept((error, Rule::AxisVelocity), place, velocity.value, limit)
        {
            let finding = messages::too_fast(axis, place, velocity.value);
            let quantity = Quantity::Velocity;
            wrong.push(Wrong { axis: index, quantity, limit, finding });
        }
        let hard = [
            (false, acceleration.value, Quantity::Acceleration),
            (true, deceleration.value, Quantity::Deceleration),
        ];
        for (slows, value, quantity) in hard {
            if slows && axis.own_deceleration().is_none() {
                continue;
            }
            let limit = axis.acceleration_limit(slows);
            peak.include_acceleration(axis, slows, value, place);
            if exceeds(value, EXACT * harder * limit)
                && !found.count_unkept((error, Rule::AxisAcceleration), place, value, limit)
            {
                let finding = messages::too_hard(axis, place, value, slows);
                wrong.push(Wrong { axis: index, quantity, limit, finding });
            }
        }
        peak.jerk.include(jerk.value, place);
        if let Some(limit) =
            axis.max_jerk.filter(|limit| exceeds(jerk.value, JERK_EXACT * jerkier * *limit))
        {
            self.add_jerky(axis, place, jerk.value, limit, found);
        }
    }

    /// Adds a finding about a jerk above its limit: an error if the plan has to keep the limit and exceeds it by more than
    /// [`FAR_ABOVE`].
    fn add_jerky(
        &self,
        axis: &Axis,
        place: Place,
        jerk: f64,
        limit: f64,
        found: &mut AxisFindings<'_>,
    ) {
        let far = !self.plans_as_programmed() && exceeds(jerk, FAR_ABOVE * limit);
        let severity = if far { Severity::Error } else { Severity::Warning };
        if found.count_unkept((severity, Rule::AxisJerk), place, jerk, limit) {
            return;
        }
        found.add(if far {
            messages::far_too_jerky(axis, place, jerk, limit)
        } else {
            messages::too_jerky(axis, place, jerk, limit)
        });
    }

    /// Jumps of the axes at the `start` of a piece, where the path goes on; none if it does not.
    fn jumps(&self, examined: &Examined<'_>, start: &Point3<f64>) -> Option<AxisVector> {
        let goes_on = self.tip.is_some_and(|tip| (tip - start).norm() < SAME_PLACE);
        goes_on.then(|| {
            let pairs = examined.extremes.ends[0].position.iter().zip(self.near.iter());
            AxisVector::from_values(pairs.map(|(start, end)| start - end))
        })
    }

    /// Checks the jump of one axis, at the velocity that takes it there in a cycle.
    fn jump(
        &self,
        examined: &Examined<'_>,
        jumps: &AxisVector,
        index: usize,
        peak: &mut AxisPeak,
        found: &mut AxisFindings<'_>,
    ) {
        let jump = jumps.get(index).copied().unwrap_or_default();
        let Some(axis) = self.machine.axes.get(index).filter(|_| jump.abs() > SAME_PLACE) else {
            return;
        };
        let place = examined.place;
        let velocity = jump.abs() / seconds(self.machine.cycle_ns);
        peak.velocity.include(velocity, place);
        let [faster, ..] = self.slack;
        let limit = self.step_limit(index);
        if exceeds(velocity, EXACT * faster * axis.max_velocity) {
            found.add(messages::turns_at_once(messages::too_fast(axis, place, velocity)));
        } else if exceeds(velocity, limit) {
            found.add(messages::turns_at_once(messages::step(axis, place, velocity, limit)));
        }
    }

    /// The largest change of the velocity at once, m/s or rad/s.
    pub(super) fn step_limit(&self, index: usize) -> f64 {
        let [_, harder, _] = self.slack;
        self.steps.get(index).map_or(f64::INFINITY, |limit| harder * limit)
    }

    /// Checks steps of velocity and acceleration of one axis between two pieces; at rest where there is none.
    fn step(
        &self,
        (last, next): (Option<&Last>, Option<&Examined<'_>>),
        index: usize,
        peak: &mut AxisPeak,
        wrong: &mut Vec<Wrong>,
        found: &mut AxisFindings<'_>,
    ) {
        let Some(axis) = self.machine.axes.get(index) else { return };
        let of = |rates: Option<&[AxisVector; 3]>, order: usize| {
            let rates = rates.and_then(|rates| rates.get(order));
            rates.and_then(|rates| rates.get(index)).copied().unwrap_or_default()
        };
        let before = last.map(|last| &last.rates);
        let start = next.map(|next| &next.extremes.ends[0].rates);
        let [velocity, acceleration] = [0, 1].map(|order| of(start, order) - of(before, order));
        // What comes up is of the new block, what ends of the one before.
        let place = |rises: bool| match (next, last) {
            (Some(next), _) if rises => next.place,
            (_, Some(last)) => last.place,
            (Some(next), None) => next.place,
            (None, None) => Place::default(),
        };
        let limit = self.step_limit(index);
        let value = velocity.abs();
        match (last, next) {
            (Some(_), Some(next)) if next.passes() => {
                // Corners that follow each other within a cycle are one for the axis.
                let (joined, angle) = self.joined(index, &next.tangent);
                let value = if value > SAME_PLACE { value.max(joined) } else { value };
                let of = (Severity::Error, Rule::AxisVelocityStep);
                if exceeds(value, limit) && !found.count_unkept(of, place(true), value, limit) {
                    let feed = next.state[1] * limit / value;
                    let finding = messages::step(axis, place(true), value, limit);
                    found.add(messages::at_corner(finding, angle, feed));
                }
            }
            _ if exceeds(value, limit) => {
                let rises = of(start, 0).abs() * (1.0 + SAME_PLACE) >= of(before, 0).abs();
                let finding = messages::step(axis, place(rises), value, limit);
                let here = match (last, next) {
                    (_, Some(next)) => Some((&next.planned.element, next.state[0])),
                    (Some(last), None) => Some((&last.element, last.state[0])),
                    (None, None) => None,
                };
                if here.is_some_and(|(element, s)| self.is_at_edge(element, s)) {
                    let (finding, quantity) = (messages::at_edge(finding), Quantity::Step);
                    wrong.push(Wrong { axis: index, quantity, limit, finding });
                } else {
                    let moving = last.map_or(0.0, |last| last.state[1]);
                    let starting = next.map_or(0.0, |next| next.state[1]);
                    found.add(messages::at_once(finding, moving.max(starting) * limit / value));
                }
            }
            _ => {}
        }
        let jerk = acceleration.abs() / seconds(self.machine.cycle_ns);
        let place = place(of(start, 1).abs() >= of(before, 1).abs());
        let [.., jerkier] = self.slack;
        peak.jerk.include(jerk, place);
        if let Some(limit) = axis.max_jerk.filter(|limit| exceeds(jerk, jerkier * *limit)) {
            self.add_jerky(axis, place, jerk, limit, found);
        }
    }
}

impl Last {
    /// True if `planned` begins where and when the last piece has ended.
    fn goes_on(&self, planned: &PlannedPiece) -> bool {
        (planned.start() - self.time).abs() < SAME_TIME
    }
}

impl Open {
    fn at(planned: &PlannedPiece, near: &AxisVector) -> Self {
        let velocity = planned.piece.at(0.0).0.velocity;
        Self {
            element: Arc::clone(&planned.element),
            near: *near,
            ends: [velocity; 2],
            fastest: velocity,
            linear: None,
            wrong: Vec::new(),
        }
    }
}

impl Examined<'_> {
    /// True if the path moves where the piece begins.
    fn passes(&self) -> bool {
        self.state[1] >= LITTLE * self.planned.element.feed()
    }
}
