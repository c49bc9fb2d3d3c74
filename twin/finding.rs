//! Findings: faults of a program, each with its rule, severity, line, value and limit.

use serde::Serialize;
use std::ops::Range;
use std::sync::Arc;
use twin_machine::section::Elsewhere;
use twin_path::Place;

/// The rule a finding belongs to. The names are part of the command-line contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// The text is not a program of its dialect.
    Syntax,
    /// A word that the dialect, or this version of twin, does not know.
    UnsupportedWord,
    /// An arc whose centre or radius does not fit its ends.
    ArcGeometry,
    /// Where a probing move ends, or that it does not end as it must, or that nobody knows where it ends.
    Probe,
    /// A block of a job that ends with an error, or a job that does not end.
    FunctionBlock,
    /// An axis that follows another one and is moved by the program, or cannot follow.
    Coupling,
    /// A point the machine cannot reach.
    Reach,
    /// An axis beyond its software limits.
    AxisPosition,
    /// An axis asked for more than its velocity.
    AxisVelocity,
    /// An axis asked for more than its acceleration.
    AxisAcceleration,
    /// An axis asked for more than its jerk.
    AxisJerk,
    /// A motor that cannot give what its axis takes.
    AxisEffort,
    /// The path is slower than programmed, or has no profile within the limits.
    FeedReduced,
    /// The arms are stretched or folded.
    Singularity,
    /// A tool of that radius damages the part, or does not get everywhere.
    CompensationGouge,
    /// Loop avoidance has cut a loop off the path.
    LoopCut,
    /// A switch lay on a piece of path that preparation has removed.
    SwitchLost,
    /// A jump of the set-point that each axis bridges on its own.
    Gap,
    /// An axis that the simulated machine cannot keep on its set-point.
    FollowingError,
    /// A step motor of the simulated machine that lost steps.
    LostSteps,
    /// A motor of the simulated machine that gave more than it bears for ever, for too long.
    MotorOverload,
    /// An axis of the simulated machine that ran on a limit switch.
    LimitSwitch,
    /// Something in the way of the machine, or of one of its links.
    Collision,
    /// A fault of the simulated machine that was asked for.
    Fault,
    /// A cam whose position, velocity or acceleration jumps.
    CamContinuity,
    /// A path followed by position that has more than one point for an X.
    AmbiguousPosition,
}

impl Rule {
    /// All of them.
    pub const ALL: [Self; 26] = [
        Self::Syntax,
        Self::UnsupportedWord,
        Self::ArcGeometry,
        Self::Probe,
        Self::FunctionBlock,
        Self::Coupling,
        Self::Reach,
        Self::AxisPosition,
        Self::AxisVelocity,
        Self::AxisAcceleration,
        Self::AxisJerk,
        Self::AxisEffort,
        Self::FeedReduced,
        Self::Singularity,
        Self::CompensationGouge,
        Self::LoopCut,
        Self::SwitchLost,
        Self::Gap,
        Self::FollowingError,
        Self::LostSteps,
        Self::MotorOverload,
        Self::LimitSwitch,
        Self::Collision,
        Self::Fault,
        Self::CamContinuity,
        Self::AmbiguousPosition,
    ];

    /// The rule's name as in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Syntax => "syntax",
            Self::UnsupportedWord => "unsupported-word",
            Self::ArcGeometry => "arc-geometry",
            Self::Probe => "probe",
            Self::FunctionBlock => "function-block",
            Self::Coupling => "coupling",
            Self::Reach => "reach",
            Self::AxisPosition => "axis-position",
            Self::AxisVelocity => "axis-velocity",
            Self::AxisAcceleration => "axis-acceleration",
            Self::AxisJerk => "axis-jerk",
            Self::AxisEffort => "axis-effort",
            Self::FeedReduced => "feed-reduced",
            Self::Singularity => "singularity",
            Self::CompensationGouge => "compensation-gouge",
            Self::LoopCut => "loop-cut",
            Self::SwitchLost => "switch-lost",
            Self::Gap => "gap",
            Self::FollowingError => "following-error",
            Self::LostSteps => "lost-steps",
            Self::MotorOverload => "motor-overload",
            Self::LimitSwitch => "limit-switch",
            Self::Collision => "collision",
            Self::Fault => "fault",
            Self::CamContinuity => "cam-continuity",
            Self::AmbiguousPosition => "ambiguous-position",
        }
    }

    /// Severities that its findings have, the worst first.
    pub const fn severities(self) -> &'static [Severity] {
        use Severity::{Error, Note, Warning};
        match self {
            Self::Reach
            | Self::Coupling
            | Self::Singularity
            | Self::AxisPosition
            | Self::AxisVelocity
            | Self::AxisEffort
            | Self::LostSteps
            | Self::LimitSwitch => &[Error],
            Self::UnsupportedWord
            | Self::ArcGeometry
            | Self::AxisAcceleration
            | Self::AxisJerk
            | Self::CompensationGouge
            | Self::FollowingError => &[Error, Warning],
            Self::Syntax
            | Self::FunctionBlock
            | Self::Probe
            | Self::Collision
            | Self::CamContinuity => &[Error, Warning, Note],
            Self::FeedReduced => &[Error, Note],
            Self::SwitchLost | Self::MotorOverload | Self::AmbiguousPosition => &[Warning],
            Self::LoopCut | Self::Gap => &[Note],
            Self::Fault => &[Warning, Note],
        }
    }

    /// Meaning and remedy of the rule.
    #[expect(clippy::too_many_lines, reason = "two lines for each rule")]
    pub const fn meaning(self) -> [&'static str; 2] {
        match self {
            Self::Syntax => [
                "the text is not a program of its dialect",
                "correct the line; --dialect says in which dialect it is read",
            ],
            Self::UnsupportedWord => [
                "a word that the dialect, or this version of twin, does not know",
                "leave the word out, or write the program in the other dialect",
            ],
            Self::ArcGeometry => [
                "centre or radius of an arc do not fit its ends; a straight line replaces it (manual 3.2)",
                "correct I, J, K or R, or the ends of the arc",
            ],
            Self::Probe => [
                "a probing move that does not trip although it must, or whose end is unknown; a note gives the position where a probe trips",
                "describe the surroundings in the machine file, and begin the move where the tool is free",
            ],
            Self::FunctionBlock => [
                "a block of a job that ends with an error, or a job that does not end",
                "`twin explain NUMBER` says what the error means; give endless motions a duration_s or an MC_Halt",
            ],
            Self::Coupling => [
                "an axis that follows another one by a gear or cam, and is moved by the program or cannot follow, or a cam that does not start where its master is (error 626)",
                "leave the slave out of the program, or the coupling out of the machine file; `twin cam check --master-start` says from where to where a cam starts",
            ],
            Self::Reach => [
                "a point the arms cannot reach",
                "move the work nearer, turn it, or choose the other side of the elbow",
            ],
            Self::AxisPosition => [
                "an axis beyond its software limits",
                "move the path or the work, or correct the limits in the machine file",
            ],
            Self::AxisVelocity => [
                "an axis asked for more than its velocity",
                "lower F to the feed in the message, or plan with --limits axes",
            ],
            Self::AxisAcceleration => [
                "an axis asked for more than its acceleration",
                "lower E or F, round corners (G52), or plan with --limits axes",
            ],
            Self::AxisJerk => [
                "an axis asked for more than its jerk",
                "plan with --limits axes, or with --profile jerk-limited",
            ],
            Self::AxisEffort => [
                "a motor that cannot give what its axis takes",
                "lower what the axis carries or moves with, or take a stronger motor",
            ],
            Self::FeedReduced => [
                "a line whose programmed feed cannot be held within the limits of the axes",
                "`twin limit` says which limit holds it back, and by how much",
            ],
            Self::Singularity => [
                "the arms are stretched or folded while the tool moves",
                "keep the path away from there, or slow down on that line",
            ],
            Self::CompensationGouge => [
                "a tool of that radius damages the part, or does not get everywhere",
                "take a smaller tool, or a contour without inner corners narrower than it",
            ],
            Self::LoopCut => [
                "loop avoidance has cut a loop off the path",
                "look whether the loop was meant; without G61 it stays",
            ],
            Self::SwitchLost => [
                "a switch point lay on a piece of path that preparation has removed",
                "put the switch where the prepared path goes",
            ],
            Self::Gap => [
                "a jump of the set-point (G92), which each axis bridges on its own while the path waits (SMC_ControlAxisByPos with bAvoidGaps, manual 11.7.1)",
                "look whether the jump was meant: the tool does not go there on a straight line; G0 does",
            ],
            Self::FollowingError => [
                "an axis that the simulated machine cannot keep near its set-point",
                "go slower there, tune its control loop, or allow a larger error in the machine file",
            ],
            Self::LostSteps => [
                "a step motor of the simulated machine that lost steps",
                "go slower there, accelerate less, or take a stronger motor",
            ],
            Self::MotorOverload => [
                "a motor of the simulated machine that is above its continuous effort for too long",
                "let it rest in between, accelerate less, or take a larger motor",
            ],
            Self::LimitSwitch => [
                "an axis of the simulated machine that ran on a limit switch",
                "keep clear of the switches: software limits should lie within them",
            ],
            Self::Collision => [
                "a part of the machine that is in an obstacle or in another part, or nearer than the clearance",
                "move the obstacle, lift the tool over it, or shorten the tool",
            ],
            Self::Fault => [
                "a fault of the simulated machine, from --faults",
                "nothing, if the scenario is meant so",
            ],
            Self::CamContinuity => [
                "a cam whose slave position, velocity or acceleration jumps",
                "join points and lines with equal velocity and acceleration, and let the end of a periodic cam go on as its begin does",
            ],
            Self::AmbiguousPosition => [
                "a path followed by position (--by-position) has more than one point for an X, so that the set-point jumps (manual 6.6)",
                "let X grow along the whole path; with --against-x let it fall",
            ],
        }
    }
}

impl Rule {
    /// Meaning and remedy of the rule for cams and jobs; none if it does not concern them, or is the same.
    pub const fn of_cams(self) -> Option<[&'static str; 2]> {
        Some(match self {
            Self::AxisPosition => [
                "a cam takes its slave beyond the axis's limits, or a block moves an axis there",
                "lay the cam elsewhere (SlaveOffset) or let it go less far (SlaveScaling): `twin tune cam --find slave-offset,slave-scaling` with the limits finds the nearest motion; correct the target of a block, or where its axis starts",
            ],
            Self::AxisVelocity => [
                "the master is too fast for the cam or the gear, or a ramp onto the cam adds too much; a block asks for more",
                "let the master go no faster than `twin cam check` says; `twin tune cam` changes scalings within the limits (--find master-scaling,slave-scaling) and finds a ramp within the limits (--ramp-in); lower a block's velocity, or its velocity_difference",
            ],
            Self::AxisAcceleration => [
                "the cam is too steep for the velocity of its master, whose square its acceleration grows with, or the master is accelerated too hard; or the velocity of the slave jumps: at a corner of a table with linear interpolation, at the end of a cam that is passed once, at a start without a ramp",
                "let the master go no faster than `twin cam check` says (--master-acceleration counts with it) and accelerate it less; `twin tune cam --find` changes scalings, --ramp-in finds a ramp; tables with interpolation = \"cubic\" have no corners, start_mode = \"ramp_in\" no jump",
            ],
            Self::AxisJerk => [
                "the cam's jerk grows with the cube of its master's velocity; accelerations that step ask for more than any limit: of a cam whose acceleration jumps, of ramp = \"trapezoid\", of set-points along straight lines",
                "let the master go no faster than `twin cam check` says (--master-jerk counts with it); choose ramp = \"parabolic\" or \"sigmoid\" in the job; `twin tune cam --find` with --minimise jerk finds scalings, --ramp-in with --ramp parabolic a ramp; points and lines that join with equal acceleration do not step (cam-continuity)",
            ],
            Self::AxisEffort => [
                "the motor of a slave cannot give what the cam, the gear or a ramp asks of it, which grows with its acceleration",
                "slow the master down or accelerate it less; `twin tune cam --find` with --minimise acceleration makes the cam's peak smaller, --within S a ramp's",
            ],
            _ => return None,
        })
    }
}

/// Severity of a finding. Ordered: the worst is the greatest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// The program runs, but perhaps not as meant.
    Warning,
    /// The program is not fit for the machine.
    Error,
}

/// One thing found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The rule.
    pub rule: Rule,
    /// The severity.
    pub severity: Severity,
    /// Line of the program file, from 1.
    pub line: u32,
    /// N word of the block, if it has one.
    pub block: Option<u32>,
    /// The fault, with value and limit.
    pub message: String,
    /// The axis concerned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<String>,
    /// The value found, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The limit it breaks, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Unit of `value` and `limit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// The largest feed with which this would not be found, mm/s, where that has a closed form.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_feed_mm_per_s: Option<f64>,
    /// Remedy, for people.
    #[serde(skip)]
    pub hint: Option<String>,
    /// Bytes of the line to underline.
    #[serde(skip)]
    pub columns: Option<Range<usize>>,
    /// Problems of the file that is named there, for people.
    #[serde(skip)]
    pub elsewhere: Option<Arc<Elsewhere>>,
}

impl Finding {
    /// An error of `rule` at `place`.
    pub fn error(rule: Rule, place: Place, message: String) -> Self {
        Self {
            rule,
            severity: Severity::Error,
            line: place.line,
            block: place.block,
            message,
            axis: None,
            value: None,
            limit: None,
            unit: None,
            largest_feed_mm_per_s: None,
            hint: None,
            columns: None,
            elsewhere: None,
        }
    }

    /// With the numbers behind it.
    #[must_use]
    pub fn with_value(mut self, value: f64, limit: f64, unit: &'static str) -> Self {
        self.value = Some(value);
        self.limit = Some(limit);
        self.unit = Some(unit);
        self
    }
}

/// Brings findings into the order they are shown in: the worst first, then by line.
pub fn sort(findings: &mut [Finding]) {
    for Finding { rule, severity, .. } in &*findings {
        debug_assert!(rule.severities().contains(severity), "{rule:?} has {severity:?}");
    }
    // What the user has asked to go wrong explains the rest.
    let consequence = |finding: &Finding| finding.rule != Rule::Fault;
    findings.sort_by(|a, b| {
        consequence(a)
            .cmp(&consequence(b))
            .then(b.severity.cmp(&a.severity))
            .then(a.line.cmp(&b.line))
            .then(a.rule.cmp(&b.rule))
            .then_with(|| a.axis.cmp(&b.axis))
    });
}

/// A program in which nothing moves.
pub(crate) fn nothing_moves() -> Finding {
    let message = "the program has no block that moves anything".to_owned();
    Finding::error(Rule::Syntax, Place { line: 1, block: None }, message)
}

/// True if any finding makes the program unfit for the machine.
pub fn unfit(findings: &[Finding]) -> bool {
    findings.iter().any(|finding| finding.severity == Severity::Error)
}
