//! Rules: the subjects of findings, with severities and texts. A rule is one entry of `rules!`.

use Severity::{Error, Note, Warning};
use serde::Serialize;

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

/// Defines [`Rule`] and its texts by a table with an entry per rule.
macro_rules! rules {
    ($($rule:ident {
        name: $name:literal,
        severities: $severities:expr,
        meaning: $meaning:literal,
        remedy: $remedy:literal,
        $(of_cams: $of_cams:expr,)?
    })*) => {
        /// The rule a finding belongs to. The names are part of the command-line contract.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
        pub enum Rule {
            $(
                #[doc = concat!("`", $name, "`: ", $meaning, ".")]
                #[serde(rename = $name)]
                $rule,
            )*
        }

        impl Rule {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$rule),*];

            /// The rule's name as in reports.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$rule => $name,)*
                }
            }

            /// Severities that its findings have, the worst first.
            pub const fn severities(self) -> &'static [Severity] {
                match self {
                    $(Self::$rule => &$severities,)*
                }
            }

            /// Meaning and remedy of the rule.
            pub const fn meaning(self) -> [&'static str; 2] {
                match self {
                    $(Self::$rule => [$meaning, $remedy],)*
                }
            }

            /// Meaning and remedy of the rule for cams and jobs; none if it does not concern them, or is the same.
            pub const fn of_cams(self) -> Option<[&'static str; 2]> {
                match self {
                    $($(Self::$rule => Some($of_cams),)?)*
                    _ => None,
                }
            }
        }
    };
}

rules! {
    Syntax {
        name: "syntax",
        severities: [Error, Warning, Note],
        meaning: "the text is not a program of its dialect",
        remedy: "correct the line; --dialect says in which dialect it is read",
    }
    UnsupportedWord {
        name: "unsupported-word",
        severities: [Error, Warning],
        meaning: "a word that the dialect, or this version of twin, does not know",
        remedy: "leave the word out, or write the program in the other dialect",
    }
    Control {
        name: "control",
        severities: [Error, Warning],
        meaning: "a word that the control of --for refuses (error), passes over or reads differently",
        remedy: "`twin path PROGRAM --for CONTROL --format rs274` writes the path with words that this control takes",
    }
    ArcGeometry {
        name: "arc-geometry",
        severities: [Error, Warning],
        meaning: "centre or radius of an arc do not fit its ends; a straight line replaces it (manual 3.2)",
        remedy: "correct I, J, K or R, or the ends of the arc",
    }
    Probe {
        name: "probe",
        severities: [Error, Warning, Note],
        meaning: "a probing move that does not trip although it must, or whose end is unknown; a note gives the position where a probe trips",
        remedy: "describe the surroundings in the machine file, and begin the move where the tool is free",
    }
    FunctionBlock {
        name: "function-block",
        severities: [Error, Warning, Note],
        meaning: "a block of a job that ends with an error, or a job that does not end",
        remedy: "`twin explain NUMBER` says what the error means; give endless motions a duration_s or an MC_Halt",
    }
    Coupling {
        name: "coupling",
        severities: [Error],
        meaning: "an axis that follows another one by a gear or cam, and is moved by the program or cannot follow, or a cam that does not start where its master is (error 626)",
        remedy: "leave the slave out of the program, or the coupling out of the machine file; `twin cam check --master-start` says from where to where a cam starts",
    }
    Reach {
        name: "reach",
        severities: [Error],
        meaning: "a point the arms cannot reach",
        remedy: "move the work nearer, turn it, or choose the other side of the elbow",
    }
    AxisPosition {
        name: "axis-position",
        severities: [Error],
        meaning: "an axis beyond its software limits",
        remedy: "move the path or the work, or correct the limits in the machine file",
        of_cams: [
            "a cam takes its slave beyond the axis's limits, or a block moves an axis there",
            "lay the cam elsewhere (SlaveOffset) or let it go less far (SlaveScaling): `twin tune cam --find slave-offset,slave-scaling` with the limits finds the nearest motion; correct the target of a block, or where its axis starts",
        ],
    }
    AxisVelocity {
        name: "axis-velocity",
        severities: [Error],
        meaning: "an axis asked for more than its velocity",
        remedy: "lower F to the feed in the message, or plan with --limits axes",
        of_cams: [
            "the master is too fast for the cam or the gear, or a ramp onto the cam adds too much; a block asks for more",
            "let the master go no faster than `twin cam check` says; `twin tune cam` changes scalings within the limits (--find master-scaling,slave-scaling) and finds a ramp within the limits (--ramp-in); lower a block's velocity, or its velocity_difference",
        ],
    }
    AxisAcceleration {
        name: "axis-acceleration",
        severities: [Error, Warning],
        meaning: "an axis asked for more than its acceleration",
        remedy: "lower E or F, round corners (G52), or plan with --limits axes",
        of_cams: [
            "the cam is too steep for the velocity of its master, whose square its acceleration grows with, or the master is accelerated too hard; or the velocity of the slave jumps: at a corner of a table with linear interpolation, at the end of a cam that is passed once, at a start without a ramp",
            "let the master go no faster than `twin cam check` says (--master-acceleration counts with it) and accelerate it less; `twin tune cam --find` changes scalings, --ramp-in finds a ramp; tables with interpolation = \"cubic\" have no corners, start_mode = \"ramp_in\" no jump",
        ],
    }
    AxisJerk {
        name: "axis-jerk",
        severities: [Error, Warning],
        meaning: "an axis asked for more than its jerk",
        remedy: "plan with --limits axes, or with --profile jerk-limited",
        of_cams: [
            "the cam's jerk grows with the cube of its master's velocity; accelerations that step ask for more than any limit: of a cam whose acceleration jumps, of ramp = \"trapezoid\", of set-points along straight lines",
            "let the master go no faster than `twin cam check` says (--master-jerk counts with it); choose ramp = \"parabolic\" or \"sigmoid\" in the job; `twin tune cam --find` with --minimise jerk finds scalings, --ramp-in with --ramp parabolic a ramp; points and lines that join with equal acceleration do not step (cam-continuity)",
        ],
    }
    AxisVelocityStep {
        name: "axis-velocity-step",
        severities: [Error],
        meaning: "an axis asked to change its velocity at once, by more than it can: at a corner that is passed without a stop, or at an edge of the reach",
        remedy: "lower F to the feed in the message, let the path stop at smaller corners (`angle_tolerance_deg` in [program]), or round them (G52)",
    }
    AxisEffort {
        name: "axis-effort",
        severities: [Error],
        meaning: "a motor that cannot give what its axis takes",
        remedy: "lower what the axis carries or moves with, or take a stronger motor",
        of_cams: [
            "the motor of a slave cannot give what the cam, the gear or a ramp asks of it, which grows with its acceleration",
            "slow the master down or accelerate it less; `twin tune cam --find` with --minimise acceleration makes the cam's peak smaller, --within S a ramp's",
        ],
    }
    ProgrammedPlan {
        name: "programmed-plan",
        severities: [Warning],
        meaning: "planned within the limits of the axes the program is fit, but a controller that plans by F and E alone would overload an axis; one warning names the worst line",
        remedy: "run the program with twin's plan, or check with --limits programmed, which lists all such lines with the feed that each allows",
    }
    FeedReduced {
        name: "feed-reduced",
        severities: [Error, Note],
        meaning: "a line whose programmed feed cannot be held within the limits of the axes",
        remedy: "`twin limit` says which limit holds it back, and by how much",
    }
    Singularity {
        name: "singularity",
        severities: [Error],
        meaning: "the arms are stretched or folded while the tool moves",
        remedy: "keep the path away from there, or move the part",
    }
    CompensationGouge {
        name: "compensation-gouge",
        severities: [Error, Warning],
        meaning: "a tool of that radius damages the part, or does not get everywhere",
        remedy: "take a smaller tool, or a contour without inner corners narrower than it",
    }
    LoopCut {
        name: "loop-cut",
        severities: [Note],
        meaning: "loop avoidance has cut a loop off the path",
        remedy: "look whether the loop was meant; without G61 it stays",
    }
    SwitchLost {
        name: "switch-lost",
        severities: [Warning],
        meaning: "a switch point lay on a piece of path that preparation has removed",
        remedy: "put the switch where the prepared path goes",
    }
    Gap {
        name: "gap",
        severities: [Note],
        meaning: "a jump of the set-point (G92), which each axis bridges on its own while the path waits (SMC_ControlAxisByPos with bAvoidGaps, manual 11.7.1)",
        remedy: "look whether the jump was meant: the tool does not go there on a straight line; G0 does",
    }
    FollowingError {
        name: "following-error",
        severities: [Error, Warning],
        meaning: "an axis that the simulated machine cannot keep near its set-point",
        remedy: "go slower there, tune its control loop, or allow a larger error in the machine file",
    }
    LostSteps {
        name: "lost-steps",
        severities: [Error],
        meaning: "a step motor of the simulated machine that lost steps",
        remedy: "go slower there, accelerate less, or take a stronger motor",
    }
    MotorOverload {
        name: "motor-overload",
        severities: [Warning],
        meaning: "a motor of the simulated machine that is above its continuous effort for too long",
        remedy: "let it rest in between, accelerate less, or take a larger motor",
    }
    LimitSwitch {
        name: "limit-switch",
        severities: [Error],
        meaning: "an axis of the simulated machine that ran on a limit switch",
        remedy: "keep clear of the switches: software limits should lie within them",
    }
    Collision {
        name: "collision",
        severities: [Error, Warning, Note],
        meaning: "a part of the machine that is in an obstacle or in another part, or nearer than the clearance",
        remedy: "move the obstacle, lift the tool over it, or shorten the tool",
    }
    PartMoved {
        name: "part-moved",
        severities: [Error],
        meaning: "a part that the simulated machine pushed from its place, so that it is not where the program expects it",
        remedy: "lift the tool over the part, or hold the part with a clamp (clamp_n)",
    }
    PartLost {
        name: "part-lost",
        severities: [Error],
        meaning: "a part that a gripper of the simulated machine lost, by its weight and acceleration or because it touched something",
        remedy: "lower E or F of the line, take a gripper that holds more, or keep the part clear of what it touches",
    }
    ClampOverloaded {
        name: "clamp-overloaded",
        severities: [Error],
        meaning: "a clamp of the simulated machine that gave way, because the force on its part was larger than it holds",
        remedy: "lower F of the line, or take a clamp that holds more",
    }
    Dropped {
        name: "dropped",
        severities: [Error],
        meaning: "a part that fell below everything that could carry it",
        remedy: "put the part down on something, or move what carries it",
    }
    GripMissed {
        name: "grip-missed",
        severities: [Error],
        meaning: "a gripper of the simulated machine that closed without a part in its reach",
        remedy: "correct the position of the line or of the part, or let the gripper reach farther (reach_mm)",
    }
    Fault {
        name: "fault",
        severities: [Warning, Note],
        meaning: "a fault of the simulated machine, from --faults",
        remedy: "nothing, if the scenario is meant so",
    }
    RecordingEnded {
        name: "recording-ended",
        severities: [Warning],
        meaning: "a recording, log or report that ended before its run: the file is full, too slow or gone. The run went on, and the exit status is 2",
        remedy: "make room, or name a file on another disk; what was written before is in the file, and the report is on standard output",
    }
    CamContinuity {
        name: "cam-continuity",
        severities: [Error, Warning, Note],
        meaning: "a cam whose slave position, velocity or acceleration jumps",
        remedy: "join points and lines with equal velocity and acceleration, and let the end of a periodic cam go on as its begin does",
    }
    AmbiguousPosition {
        name: "ambiguous-position",
        severities: [Warning],
        meaning: "a path followed by position (--by-position) has more than one point for an X, so that the set-point jumps (manual 6.6)",
        remedy: "let X grow along the whole path; with --against-x let it fall",
    }
}
