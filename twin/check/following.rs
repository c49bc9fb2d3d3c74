//! Following-error prediction: the drives' response to the set-points, computed in simulated time during the check.

use super::findings::{About, Findings};
use super::messages;
use crate::compare::{Measured, Statistics};
use crate::finding::Finding;
use crate::in_loop::DrivesInLoop;
use crate::setpoint::HORIZON_NS;
use crate::setpoint::{AxisSetpoint, resting_behind};
use crate::tolerance::exceeds;
use std::collections::VecDeque;
use std::io;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{Scope, ScopedJoinHandle};
use twin_drives::WireRates;
use twin_machine::Machine;
use twin_number::seconds;

/// Set-points that go to the thread in one go.
const BATCH: usize = 256;
/// Batches that may wait for it.
const WAITING: usize = 4;

/// Following-error prediction for a program: the effect of the timing on the wires and of the drives' profile
/// generators. It does not include delays of a busy computer or the response of the motors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PredictedFollowing {
    /// Of the tool tip from where the set-points have it, m.
    pub tool: Statistics,
    /// Of each axis from its set-points, m or rad, machine-file order; none of an axis without drive.
    pub axes: Vec<Option<Statistics>>,
    /// Traffic of each device that drives axes.
    pub devices: Vec<PredictedTraffic>,
}

/// Predicted traffic on the wire of a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedTraffic {
    /// Index into [`Machine::drives`].
    pub device: usize,
    /// Largest rates that its wire carries.
    pub rates: WireRates,
    /// Commands and samples together while the program runs, 1/s.
    pub exchanges_per_s: f64,
}

/// Takes set-points one by one and lets the drives follow them in simulated time.
#[derive(Debug)]
pub(super) struct Follower<'m> {
    machine: &'m Machine,
    drives: DrivesInLoop,
    /// Set-points that the drives have not come to: they look ahead.
    ahead: VecDeque<AxisSetpoint>,
    predicted: PredictedFollowing,
    findings: Findings,
    /// From the first set-point to the last, ns.
    span_ns: Option<[i64; 2]>,
}

impl<'m> Follower<'m> {
    pub(super) fn new(machine: &'m Machine, drives: DrivesInLoop) -> Self {
        let axes =
            machine.axes.iter().map(|axis| axis.drive.as_ref().map(|_| Statistics::default()));
        let predicted =
            PredictedFollowing { axes: axes.collect(), ..PredictedFollowing::default() };
        let (ahead, findings) = (VecDeque::new(), Findings::default());
        Self { machine, drives, ahead, predicted, findings, span_ns: None }
    }

    pub(super) fn take(&mut self, setpoint: &AxisSetpoint) {
        self.ahead.push_back(*setpoint);
        let known_ns = setpoint.time_ns.saturating_sub(HORIZON_NS);
        while let Some(next) = self.ahead.pop_front_if(|next| next.time_ns <= known_ns) {
            self.follow(&next);
        }
    }

    fn follow(&mut self, setpoint: &AxisSetpoint) {
        let [first_ns, _] = self.span_ns.unwrap_or([setpoint.time_ns; 2]);
        self.span_ns = Some([first_ns, setpoint.time_ns]);
        let asked = self.drives.motion(setpoint, &self.ahead).position;
        let place = setpoint.place;
        if let Some(found) = Measured::new(self.machine, asked) {
            self.predicted.tool.include((found.tool - setpoint.tool.pose.position).norm(), place);
        }
        let pairs = asked.iter().zip(setpoint.axes.position.iter());
        let axes = self.machine.axes.iter().zip(&mut self.predicted.axes).zip(pairs);
        for (index, ((axis, statistics), (asked, wanted))) in axes.enumerate() {
            let Some(statistics) = statistics else { continue };
            let error = (asked - wanted).abs();
            statistics.include(error, place);
            if let Some(limit) = axis.max_following_error.filter(|limit| exceeds(error, *limit)) {
                let finding = messages::drive_too_far(axis, place, error, limit);
                self.findings.add(Some(About::Axis(index)), finding);
            }
        }
    }

    /// Lets the drives come to rest behind the last set-point.
    pub(super) fn finish(mut self) -> (PredictedFollowing, Findings) {
        let mut last = None;
        while let Some(setpoint) = self.ahead.pop_front() {
            self.follow(&setpoint);
            last = Some(setpoint);
        }
        for resting in last.iter().flat_map(|last| resting_behind(last, self.machine.cycle_ns)) {
            if self.drives.have_arrived() {
                break;
            }
            self.follow(&resting);
        }
        let duration = self.span_ns.map_or(0.0, |[first_ns, last_ns]| seconds(last_ns - first_ns));
        let traffic = self.drives.predictions().map(|(device, prediction)| {
            #[expect(clippy::cast_precision_loss, reason = "counts stay far below 2^53")]
            let exchanges = prediction.exchanges() as f64;
            let exchanges_per_s = if duration > 0.0 { exchanges / duration } else { 0.0 };
            PredictedTraffic { device, rates: prediction.rates(), exchanges_per_s }
        });
        self.predicted.devices = traffic.collect();
        (self.predicted, self.findings)
    }
}

/// Largest rates that the wires of the drives of `machine` carry, device by device (index into [`Machine::drives`]).
pub fn wire_rates(machine: &Machine) -> Vec<(usize, WireRates)> {
    let drives = DrivesInLoop::all(machine);
    let predictions = drives.iter().flat_map(DrivesInLoop::predictions);
    predictions.map(|(device, prediction)| (device, prediction.rates())).collect()
}

/// Following-error prediction in a background thread. It takes about as long as the check itself.
#[derive(Debug)]
pub(super) struct FollowingBeside<'scope> {
    batch: Vec<AxisSetpoint>,
    sender: SyncSender<Vec<AxisSetpoint>>,
    thread: ScopedJoinHandle<'scope, (PredictedFollowing, Findings)>,
}

impl<'scope> FollowingBeside<'scope> {
    /// In a thread of `scope`, which ends when this is dropped; `None` without drives.
    pub(super) fn start<'m: 'scope>(
        scope: &'scope Scope<'scope, '_>,
        machine: &'m Machine,
    ) -> io::Result<Option<Self>> {
        let Some(drives) = DrivesInLoop::all(machine) else { return Ok(None) };
        let (sender, batches) = sync_channel::<Vec<AxisSetpoint>>(WAITING);
        let work = move || {
            let mut follower = Follower::new(machine, drives);
            for batch in batches {
                for setpoint in &batch {
                    follower.take(setpoint);
                }
            }
            follower.finish()
        };
        let thread = std::thread::Builder::new().name("forecast".to_owned());
        let thread = thread.spawn_scoped(scope, work)?;
        Ok(Some(Self { batch: Vec::with_capacity(BATCH), sender, thread }))
    }

    pub(super) fn take(&mut self, setpoint: &AxisSetpoint) {
        self.batch.push(*setpoint);
        if self.batch.len() >= BATCH {
            let batch = std::mem::replace(&mut self.batch, Vec::with_capacity(BATCH));
            // A thread that is gone is noticed at the end.
            self.sender.send(batch).unwrap_or_default();
        }
    }

    /// The prediction, with its findings and the number of findings that were left out.
    pub(super) fn finish(self) -> Option<(PredictedFollowing, Vec<Finding>, u64)> {
        let Self { batch, sender, thread } = self;
        sender.send(batch).unwrap_or_default();
        drop(sender);
        let (predicted, findings) = thread.join().ok()?;
        let (findings, left_out) = findings.into_list();
        Some((predicted, findings, left_out))
    }
}
