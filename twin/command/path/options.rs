//! Options of `twin path`: start position, inputs of preparation, operations on the path.

use super::numbers::{list, within};
use crate::command::Failure;
use crate::program::Operations;
use twin_gcode::rs274::Position;
use twin_machine::ProgramConditions;
use twin_path::Chords;
use twin_path::prepare::CircularLimits;

/// A distance or an acceleration that is not negative.
fn positive(text: &str) -> Result<f64, String> {
    within(text, 0.0..=1e9)
}

fn angle(text: &str) -> Result<f64, String> {
    within(text, 0.0..=180.0)
}

/// Where the path starts and what preparation is given.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Preparation")]
pub(super) struct PreparationOptions {
    /// Show the path after preparation: tool radius correction (G41, G42), loop avoidance (G61), smoothing (G51),
    /// rounding (G52), limits on curves, velocities at transitions
    #[arg(long)]
    pub(super) prepare: bool,

    /// Where the program starts: X,Y[,Z[,P,Q,U,V,W]]
    #[arg(long, value_name = "X,Y…", allow_hyphen_values = true, value_parser = |text: &str| list::<8>(text, 2))]
    start: Option<[f64; 8]>,

    /// Turns of the path up to this angle are passed without a stop (dAngleTol) [default: 2]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = angle)]
    angle_tolerance: Option<f64>,

    /// Added to D where the tool radius is corrected (dToolRadius)
    #[arg(long, value_name = "MM", requires = "prepare", allow_hyphen_values = true, value_parser = positive)]
    tool_radius: Option<f64>,

    /// Distance by which the tool may come closer to the contour than its radius without a gouge [default: 0.001]
    #[arg(long, value_name = "MM", requires = "prepare", allow_hyphen_values = true, value_parser = positive)]
    gouge_tolerance: Option<f64>,

    /// Added to D where corners are smoothed (dEdgeDistance)
    #[arg(long, value_name = "MM", requires = "prepare", allow_hyphen_values = true, value_parser = positive)]
    edge_distance: Option<f64>,

    /// In place of D where corners are rounded (dRadius)
    #[arg(long, value_name = "MM", requires = "prepare", allow_hyphen_values = true, value_parser = positive)]
    rounding_distance: Option<f64>,

    /// Turns up to this angle are neither smoothed nor rounded
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = angle)]
    corner_angle_tolerance: Option<f64>,

    /// Largest acceleration towards the centre of a curve (dMaxAcc)
    #[arg(long, value_name = "MM/S2", requires = "prepare", allow_hyphen_values = true, value_parser = positive)]
    circular_acceleration: Option<f64>,

    /// Largest jump of that acceleration from one element to the next (dMaxAccJump)
    #[arg(long, value_name = "MM/S2", requires = "prepare", allow_hyphen_values = true, value_parser = positive)]
    circular_acceleration_jump: Option<f64>,
}

impl PreparationOptions {
    /// Replaces values of `conditions` by those given here.
    pub(super) fn complete(&self, conditions: &mut ProgramConditions) {
        if let Some([x, y, z, additional @ ..]) = self.start {
            conditions.start = [x, y, z].map(|value| value * 1e-3);
            conditions.start_additional = additional;
            conditions.rs274.start = Position::new(conditions.start, additional);
        }
        let inputs = &mut conditions.preparation;
        let metres = |value: f64| value * 1e-3;
        let set = |slot: &mut f64, value: Option<f64>| *slot = value.unwrap_or(*slot);
        set(&mut conditions.angle_tolerance, self.angle_tolerance.map(f64::to_radians));
        set(&mut inputs.tool_radius, self.tool_radius.map(metres));
        set(&mut inputs.gouge_tolerance, self.gouge_tolerance.map(metres));
        set(&mut inputs.edge_distance, self.edge_distance.map(metres));
        set(&mut inputs.rounding_distance, self.rounding_distance.map(metres));
        let tolerance = self.corner_angle_tolerance.map(f64::to_radians);
        set(&mut inputs.corner_angle_tolerance, tolerance);
        if self.circular_acceleration.is_some() || self.circular_acceleration_jump.is_some() {
            let without = f64::INFINITY;
            let limits = inputs.circular.get_or_insert(CircularLimits {
                acceleration: without,
                acceleration_jump: without,
            });
            set(&mut limits.acceleration, self.circular_acceleration.map(metres));
            set(&mut limits.acceleration_jump, self.circular_acceleration_jump.map(metres));
        }
    }
}

/// Operations on the path.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Operations, done in this order before preparation")]
pub(super) struct OperationOptions {
    /// Cut the object of this number, from 0, in two at this part of its length, 0 to 1
    #[arg(long, value_name = "OBJECT:PART", value_parser = split)]
    split: Option<(u64, f64)>,

    /// Stretch by a factor about the origin (`SMC_SCALEQUEUE3D`)
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, default_value = "1", hide_default_value = true, value_parser = |text: &str| within(text, 1e-6..=1e6))]
    scale: f64,

    /// Turn counter-clockwise about the z axis through the origin (`SMC_ROTATEQUEUE2D`)
    #[arg(long, value_name = "DEG", default_value = "0", hide_default_value = true, allow_hyphen_values = true, value_parser = |text: &str| within(text, -3600.0..=3600.0))]
    rotate: f64,

    /// Move by X,Y[,Z[,P,Q,U,V,W]] (`SMC_TRANSLATEQUEUE3D`)
    #[arg(long, value_name = "X,Y…", allow_hyphen_values = true, value_parser = |text: &str| list::<8>(text, 2))]
    translate: Option<[f64; 8]>,

    /// Make lines of splines and ellipses, each with at most so much path
    #[arg(long, value_name = "MM", allow_hyphen_values = true, conflicts_with = "linearise_angle", value_parser = |text: &str| within(text, 1e-3..=1e6))]
    linearise: Option<f64>,

    /// The same, such that the path turns by less than this angle between lines
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = |text: &str| within(text, 0.01..=90.0))]
    linearise_angle: Option<f64>,

    /// Make lines of arcs, too
    #[arg(long)]
    arcs: bool,

    /// From its end to its start; switches stay where they are
    #[arg(long)]
    reverse: bool,
}

impl OperationOptions {
    pub(super) fn operations(&self) -> Result<Operations, Failure> {
        let length = self.linearise.map(|length| Chords::Length(length * 1e-3));
        let angle = self.linearise_angle.map(|angle| Chords::Angle(angle.to_radians()));
        let linearise = length.or(angle);
        if self.arcs && linearise.is_none() {
            let message = "--arcs has no effect without --linearise or --linearise-angle";
            return Err(Failure::Usage(message.to_owned()));
        }
        let [x, y, z, translate_additional @ ..] = self.translate.unwrap_or_default();
        Ok(Operations {
            split: self.split,
            scale: self.scale,
            rotate: self.rotate.to_radians(),
            translate: [x, y, z].map(|value| value * 1e-3),
            translate_additional,
            linearise,
            arcs: self.arcs,
            reverse: self.reverse,
        })
    }
}

fn split(text: &str) -> Result<(u64, f64), String> {
    let (object, part) = text.split_once(':').ok_or("expected OBJECT:PART, like 3:0.5")?;
    let object = object.trim().parse().ok();
    let object =
        object.ok_or_else(|| format!("`{text}` has no object's number before the colon"))?;
    Ok((object, within(part, 0.0..=1.0)?))
}
