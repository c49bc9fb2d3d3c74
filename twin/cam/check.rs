//! Check of a cam against the limits of its slave.

pub(crate) use super::usage::{AxisLimits, CamUse};
use crate::finding::{Finding, Rule, Severity};
use serde_json::{Value, json};
use twin_cam::{Bounds, Jump, Largest, LimitError, Passage, Quantity, Range, SlaveLimits, Tappet};
use twin_machine::cam_file::CamFile;
use twin_number::{apart, at_most, beside, readable};
use twin_path::Place;

/// A limit that is exceeded by less than this part is kept.
const ROUNDING: f64 = 1e-12;

/// What came of it. Places are positions of the master.
#[derive(Clone, Debug)]
pub(crate) struct CamCheck<'a> {
    file: &'a CamFile,
    using: CamUse,
    /// Position, velocity, acceleration and jerk of the slave.
    pub(crate) bounds: Bounds,
    /// Where position, velocity and acceleration jump.
    pub(crate) jumps: [Option<Jump>; 3],
    /// What jumps where a pass ends that is not repeated: velocity and acceleration of a slave that stays there.
    pub(crate) stop: [Option<Jump>; 2],
    /// The largest velocity of the master, on the cam.
    pub(crate) largest: Result<Largest, LimitError>,
    pub(crate) findings: Vec<Finding>,
}

impl<'a> CamCheck<'a> {
    /// Checks a cam; everything is found exactly, nothing is sampled.
    pub(crate) fn new(file: &'a CamFile, using: CamUse) -> Self {
        let curve = file.cam.curve();
        let factors = using.factors();
        let place = |range: Range| Range {
            at_min: using.master_at(range.at_min),
            at_max: using.master_at(range.at_max),
            ..range
        };
        let Bounds { position, velocity, acceleration, jerk } =
            curve.bounds(&using.master, factors);
        let offset = using.coupling.input.slave_offset;
        let position = Range { min: position.min + offset, max: position.max + offset, ..position };
        let bounds = Bounds {
            position: place(position),
            velocity: place(velocity),
            acceleration: place(acceleration),
            jerk: place(jerk),
        };
        let scaled = |jump: Jump, by: f64| Jump {
            master: using.master_at(jump.master),
            by: jump.by * by * factors.slave,
        };
        let v = using.master.velocity * factors.master;
        let [one, two, three] = curve.real_jumps(using.repeated);
        let jumps = [
            one.map(|jump| scaled(jump, 1.0)),
            two.map(|jump| scaled(jump, v)),
            three.map(|jump| scaled(jump, v * v)),
        ];
        let stop = if using.repeated {
            [None; 2]
        } else {
            // With the master going forwards.
            let [one, two] = curve.stop_jumps(factors.master < 0.0);
            [one.map(|jump| scaled(jump, v)), two.map(|jump| scaled(jump, v * v))]
        };
        let largest = curve.largest_master_velocity(
            &using.limits.motion,
            &using.master,
            factors,
            using.repeated,
        );
        let mut check = Self { file, using, bounds, jumps, stop, largest, findings: Vec::new() };
        check.refuse_jumps();
        check.find();
        check
    }

    /// With a jump that is an error no velocity of the master is slow enough, where the pass ends, either.
    fn refuse_jumps(&mut self) {
        let curve = self.file.cam.curve();
        let [position, ..] = curve.real_jumps(self.using.repeated);
        let [velocity, acceleration] = if self.using.repeated {
            [None; 2]
        } else {
            curve.stop_jumps(self.using.factors().master < 0.0)
        };
        let all = [
            (Quantity::Velocity, position),
            (Quantity::Acceleration, velocity),
            (Quantity::Jerk, acceleration),
        ];
        let found = all.into_iter().enumerate().find_map(|(derivative, (quantity, jump))| {
            let jump = jump.filter(|_| self.severity(derivative) == Severity::Error)?;
            Some(LimitError::Unbounded { quantity, jump })
        });
        if let (Some(error), Ok(_)) = (found, &self.largest) {
            self.largest = Err(error);
        }
    }

    /// A place of the master, for people.
    pub(crate) fn place(&self, at: f64) -> String {
        let curve = self.file.cam.curve();
        let width = (curve.end() - curve.start()) / self.using.coupling.input.master_scaling;
        beside(at, width, 6)
    }

    /// The slave's unit, with that of a derivative by time.
    fn unit(&self, derivative: usize) -> String {
        let unit = self.file.slave.unit();
        match derivative {
            0 => unit.to_owned(),
            1 => format!("{unit}/s"),
            2 => format!("{unit}/s²"),
            _ => format!("{unit}/s³"),
        }
    }

    /// What the slave gains in every pass in which the master goes forwards, of a periodic cam; none if that is nothing.
    pub(crate) fn gain(&self) -> Option<f64> {
        let input = &self.using.coupling.input;
        let rise = self.using.gain(self.file)?;
        Some(rise * input.slave_scaling * input.master_scaling.signum())
    }

    fn find(&mut self) {
        let limits = self.using.limits;
        let [low, high] = limits.position;
        // What gains in every pass goes everywhere: only an axis without limits of its position follows it.
        if let Some(gain) = self.gain() {
            if self.using.is_limited() {
                let unit = self.unit(0);
                let limit = |limit: f64| (limit.is_finite(), readable(limit, 6));
                let limits = match [low, high].map(limit) {
                    [(true, low), (true, high)] => format!("limits, {low} to {high} {unit}"),
                    [(true, low), _] => format!("least position, {low} {unit}"),
                    [_, (_, high)] => format!("greatest position, {high} {unit}"),
                };
                let period = self.file.period.map_or(String::new(), |period| {
                    format!(": an axis with limits does not go round, whatever the period of the cam's file ({period} {unit}) says")
                });
                let message = format!(
                    "the slave gains {} {unit} in every pass of the cam and leaves its {limits}, sooner or later{period}",
                    readable(gain, 6),
                );
                self.add(
                    Rule::AxisPosition,
                    Severity::Error,
                    message,
                    None,
                    "--once passes it once",
                );
            }
        } else {
            let Range { min, at_min, max, at_max } = self.bounds.position;
            // A position at a limit but for rounding keeps it.
            let room = ROUNDING * (max - min).max(min.abs()).max(max.abs());
            for (outside, value, limit, at) in
                [(min < low - room, min, low, at_min), (max > high + room, max, high, at_max)]
            {
                if outside {
                    let hint = "--slave-offset moves it, --slave-scaling makes it smaller";
                    self.exceeds(Rule::AxisPosition, 0, value, limit, at, hint);
                }
            }
        }
        let hint = match &self.largest {
            Ok(Largest { value, .. }) if value.is_finite() => format!(
                "the master may go {} {}/s at most",
                at_most(*value, 6),
                self.file.master.unit()
            ),
            _ => String::new(),
        };
        for (derivative, rule, range, limit) in [
            (1, Rule::AxisVelocity, self.bounds.velocity, limits.motion.velocity),
            (2, Rule::AxisAcceleration, self.bounds.acceleration, limits.motion.acceleration),
            (3, Rule::AxisJerk, self.bounds.jerk, limits.motion.jerk),
        ] {
            let (value, at) = if range.max >= -range.min {
                (range.max, range.at_max)
            } else {
                (range.min, range.at_min)
            };
            if value.abs() > limit * (1.0 + ROUNDING) {
                self.exceeds(rule, derivative, value, limit, at, &hint);
            }
        }
        self.find_jumps();
        self.findings.extend(self.using.refused_start(self.file));
        crate::finding::sort(&mut self.findings);
    }

    fn exceeds(
        &mut self,
        rule: Rule,
        derivative: usize,
        value: f64,
        limit: f64,
        at: f64,
        hint: &str,
    ) {
        let what = ["position", "velocity", "acceleration", "jerk"];
        let what = what.get(derivative).copied().unwrap_or_default();
        let [value_said, limit_said] = apart(value, limit);
        let message = format!(
            "the slave's {what} is {value_said} {unit} at master {} {}, its limit is {limit_said} {unit}",
            self.place(at),
            self.file.master.unit(),
            unit = self.unit(derivative),
        );
        self.add(rule, Severity::Error, message, Some((value, limit)), hint);
    }

    fn find_jumps(&mut self) {
        let names = ["position", "velocity", "acceleration"];
        for (derivative, name) in names.into_iter().enumerate() {
            let Some(jump) = self.jumps.get(derivative).copied().flatten() else { continue };
            let severity = self.severity(derivative);
            let message = format!(
                "the slave's {name} jumps by {} {} at master {} {}",
                readable(jump.by, 6),
                self.unit(derivative),
                self.place(jump.master),
                self.file.master.unit(),
            );
            let hint = match derivative {
                0 => "no axis follows a jump",
                1 => {
                    "between the points of a table cubics have no such jumps (interpolation = \"cubic\"), points and lines neither"
                }
                _ => "points and lines with equal velocity and acceleration have no such jumps",
            };
            self.add(Rule::CamContinuity, severity, message, None, hint);
        }
        self.find_stop();
    }

    /// A jump asks for more than any limit of what comes next.
    fn severity(&self, derivative: usize) -> Severity {
        let SlaveLimits { acceleration, jerk, .. } = self.using.limits.motion;
        match derivative {
            0 => Severity::Error,
            1 if acceleration.is_finite() || jerk.is_finite() => Severity::Error,
            1 => Severity::Warning,
            _ if jerk.is_finite() => Severity::Error,
            _ => Severity::Note,
        }
    }

    /// What a slave that stays where the pass ends still has of velocity and acceleration.
    fn find_stop(&mut self) {
        let mut first = self.stop.iter().zip(["velocity", "acceleration"]).zip(1..);
        // What follows a jump jumps, too: the first one says it.
        let Some((jump, name, derivative)) =
            first.find_map(|((jump, name), d)| Some(((*jump)?, name, d)))
        else {
            return;
        };
        let message = format!(
            "the pass ends at master {} {} and is not repeated: the slave stays there, its {name} jumps by {} {}",
            self.place(jump.master),
            self.file.master.unit(),
            readable(jump.by, 6),
            self.unit(derivative),
        );
        let hint = format!(
            "a cam that ends with {name} 0 has no such jump; nor has one that is repeated (--end-to-end), or followed at \
             EndOfProfile by one that goes on as it ends"
        );
        let severity = self.severity(derivative);
        self.add(Rule::CamContinuity, severity, message, None, &hint);
    }

    fn add(
        &mut self,
        rule: Rule,
        severity: Severity,
        message: String,
        value: Option<(f64, f64)>,
        hint: &str,
    ) {
        let mut finding = Finding::error(rule, Place::at(0), message);
        finding.severity = severity;
        finding.value = value.map(|(value, _)| value);
        finding.limit = value.map(|(_, limit)| limit);
        finding.hint = (!hint.is_empty()).then(|| hint.to_owned());
        self.findings.push(finding);
    }

    /// Tappets with where the master is at each and where the slave is then.
    pub(crate) fn tappets(&self) -> impl Iterator<Item = (&Tappet, f64, f64)> {
        self.file.cam.tappets().iter().map(|tappet| {
            let y = self.file.cam.curve().at(tappet.master).position;
            (tappet, self.using.master_at(tappet.master), self.using.slave_at(y))
        })
    }

    /// Whether the cam is passed again and again.
    pub(crate) fn is_repeated(&self) -> bool {
        self.using.repeated
    }

    /// When the master passes a tappet, s after the pass began, going forwards at its velocity; none of a tappet that is
    /// passed the other way only. With a negative factor of the master the pass goes from the end of the cam to its begin.
    pub(crate) fn passed_after(&self, tappet: &Tappet) -> Option<f64> {
        let curve = self.file.cam.curve();
        let factor = self.using.factors().master;
        let (begin, other) = if factor < 0.0 {
            (curve.end(), Passage::Positive)
        } else {
            (curve.start(), Passage::Negative)
        };
        let speed = (self.using.master.velocity * factor).abs();
        (tappet.passage != other).then(|| (tappet.master - begin).abs() / speed)
    }

    /// How smooth the cam is: how many of its derivatives, the position counted, do not jump.
    pub(crate) fn smoothness(&self) -> &'static str {
        match self.jumps {
            [None, ..] if matches!(self.stop, [Some(_), _]) => "C0",
            [None, None, _] if matches!(self.stop, [_, Some(_)]) => "C1",
            [Some(_), ..] => "discontinuous",
            [_, Some(_), _] => "C0",
            [_, _, Some(_)] => "C1",
            _ => "C2",
        }
    }

    pub(crate) fn json(&self) -> Value {
        let finite = |value: f64| value.is_finite().then_some(value);
        let range = |range: &Range, limit: [f64; 2]| {
            json!({
                "min": range.min, "at_min": range.at_min, "max": range.max, "at_max": range.at_max,
                "limit": limit.map(finite),
            })
        };
        let both = |limit: f64| [-limit, limit];
        let SlaveLimits { velocity, acceleration, jerk } = self.using.limits.motion;
        let jump =
            |jump: &Option<Jump>| jump.map(|jump| json!({ "master": jump.master, "by": jump.by }));
        let [one, two, three] = &self.jumps;
        let [stop, stopped] = &self.stop;
        let largest = match &self.largest {
            Ok(Largest { value, limited }) => json!({
                "velocity": finite(*value),
                "limited_by": limited.map(|(quantity, _)| quantity.to_string()),
                "at_master": limited.map(|(_, place)| self.using.master_at(place)),
            }),
            Err(error) => json!({ "velocity": Value::Null, "reason": error.to_string() }),
        };
        let findings = self.findings.iter().map(|finding| {
            json!({
                "rule": finding.rule, "severity": finding.severity, "message": finding.message,
                "value": finding.value, "limit": finding.limit,
            })
        });
        let tappets = self.tappets().map(|(tappet, master, slave)| {
            let after_s = self.passed_after(tappet);
            json!({ "group": tappet.group, "master": master, "slave": slave, "after_s": after_s })
        });
        let curve = self.file.cam.curve();
        let input = &self.using.coupling.input;
        json!({
            "cam": self.file.cam.name(),
            "file": self.file.path.display().to_string(),
            "master": {
                "unit": self.file.master.unit(), "min": curve.start(), "max": curve.end(),
                "velocity": self.using.master.velocity,
                "acceleration": self.using.master.acceleration,
                "jerk": self.using.master.jerk,
                "offset": input.master_offset, "scaling": input.master_scaling,
            },
            "slave": {
                "unit": self.file.slave.unit(), "offset": input.slave_offset,
                "scaling": input.slave_scaling, "rise": curve.rise() * input.slave_scaling,
            },
            "repeated": self.using.repeated,
            "start": self.using.start_json(self.file),
            "position": range(&self.bounds.position, self.using.limits.position),
            "velocity": range(&self.bounds.velocity, both(velocity)),
            "acceleration": range(&self.bounds.acceleration, both(acceleration)),
            "jerk": range(&self.bounds.jerk, both(jerk)),
            "continuity": self.smoothness(),
            "jumps": { "position": jump(one), "velocity": jump(two), "acceleration": jump(three) },
            "stop": { "velocity": jump(stop), "acceleration": jump(stopped) },
            "largest_master": largest,
            "tappets": tappets.collect::<Vec<_>>(),
            "findings": findings.collect::<Vec<_>>(),
        })
    }
}
