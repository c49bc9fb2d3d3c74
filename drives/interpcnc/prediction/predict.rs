//! Prediction of tracking error and exchange rate of a board before a run.

use super::{InterpCncPrediction, Readings, buffered::BufferedPrediction};
use crate::{AxisOptions, EncoderOptions, Following, emulator::Wire};
use twin_drives::{MAX_DRIVE_AXES, Prediction, SetpointStream, ramp::seconds};

/// Instants at which the axes are compared with the plan are so far apart, ns.
const SPACING_NS: i64 = 1_000_000;

/// Predicted distance of the axes from their plan, and rate of exchanges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PredictionSummary {
    /// Root of the mean square of the error per axis, increments.
    pub rms: [f64; MAX_DRIVE_AXES],
    /// Largest error per axis, increments.
    pub largest: [f64; MAX_DRIVE_AXES],
    /// Exchanges per second, commands and samples together.
    pub exchanges_per_s: f64,
}

/// A board on `wire`, of which `axes` are in use, that follows a plan in simulated time. Its encoder is read if it is said to
/// have one.
pub fn board_prediction(
    axes: &[AxisOptions],
    wire: &Wire,
    following: Following,
    encoder: Option<EncoderOptions>,
) -> Box<dyn Prediction> {
    let readings = Readings::new(axes, encoder);
    match following {
        Following::Retargeted => Box::new(InterpCncPrediction::new(axes, wire).reading(readings)),
        Following::Buffered { start_stop_hz, acceleration_khz_per_s } => {
            let rate = acceleration_khz_per_s;
            Box::new(BufferedPrediction::new(axes, wire, start_stop_hz, rate).reading(readings))
        }
    }
}

/// Predicts a plan from one instant to another, ns, and compares what the axes make of it with the plan every
/// millisecond. No encoder is read.
pub fn predict(
    plan: &dyn SetpointStream,
    axes: &[AxisOptions],
    wire: &Wire,
    following: Following,
    (from_ns, until_ns): (i64, i64),
) -> PredictionSummary {
    let mut prediction = board_prediction(axes, wire, following, None);
    let mut summary = PredictionSummary::default();
    let (mut time_ns, mut count) = (from_ns, 0.0);
    while time_ns <= until_ns {
        let motion = prediction.advance(plan, time_ns);
        let planned = plan.at(time_ns);
        let errors = motion.position.iter().zip(planned.position).take(axes.len());
        let slots = summary.rms.iter_mut().zip(&mut summary.largest);
        for ((squares, largest), (position, plan)) in slots.zip(errors) {
            let error = (position - plan).abs();
            *squares += error * error;
            *largest = largest.max(error);
        }
        count += 1.0;
        time_ns += SPACING_NS;
    }
    for squares in &mut summary.rms {
        *squares = (*squares / f64::max(count, 1.0)).sqrt();
    }
    #[expect(clippy::cast_precision_loss, reason = "counts of exchanges are small")]
    let exchanges = prediction.exchanges() as f64;
    summary.exchanges_per_s = exchanges / seconds((until_ns - from_ns).max(1));
    summary
}
