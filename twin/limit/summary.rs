//! Summary of a plan: durations, peaks, binding limits, slowest lines, and gains from raised limits.

use super::lines::{LineShare, LineShares};
use super::losses::Losses;
use super::{Binding, ProfileSample};
use crate::peak::AxisPeak;
use std::collections::BTreeMap;
use twin_kinematics::AxisVector;
use twin_machine::Axis;
use twin_number::seconds;
use twin_path::Place;

/// Number of lines that lose time and are named.
const NAMED_LINES: usize = 10;

/// Plan of the velocity along a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Limits {
    /// Within the limits of every axis.
    #[default]
    Axes,
    /// By F and E alone, as SoftMotion's own plan.
    Programmed,
}

impl Limits {
    /// As options and reports call them.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Axes => "axes",
            Self::Programmed => "programmed",
        }
    }
}

/// Summary of a plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitSummary {
    /// Limits that it is planned with.
    pub limits: Limits,
    /// Duration under the limits of the axes, s, where it is planned with others.
    pub duration_under_axes_s: Option<f64>,
    /// Duration of the program within all limits, s.
    pub duration_s: f64,
    /// Duration at the programmed feed all the time, s.
    pub duration_by_feed_s: f64,
    /// Length of the path, m.
    pub length: f64,
    /// The largest values of each axis, in machine-file order.
    pub peaks: Vec<AxisPeak>,
    /// The limits that hold the path back, the most costly first.
    pub limited_by: Vec<BindingShare>,
    /// The lines that lose most time, the worst first.
    pub lines: Vec<LineLoss>,
    /// Every line with its binding limits, if requested.
    pub every_line: Vec<LineShare>,
    /// The override at the start: the requested part of the programmed feed.
    pub override_factor: f64,
    /// Gains from raising one limit, the largest first.
    pub changes: Vec<Change>,
    /// Statistics of planning window by window.
    pub windows: Windows,
}

/// A change of the machine file, or of the program, and what it would gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The limit that is raised by [`Self::RAISED`].
    pub binding: Binding,
    /// Approximate time gained, s: from the derivative of the duration, as long as no other limit takes over.
    pub gain_s: f64,
}

impl Change {
    /// Raise of a limit, as a part of it.
    pub const RAISED: f64 = 0.2;
}

/// For how long a limit holds the path back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BindingShare {
    /// The limit; none where it is not known.
    pub binding: Option<Binding>,
    /// Time during which it does, s.
    pub time_s: f64,
    /// Time lost against the programmed feed, s.
    pub lost_s: f64,
}

/// Time lost on a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLoss {
    /// The block.
    pub place: Place,
    /// The largest feed that is programmed there, m/s.
    pub programmed: f64,
    /// The largest feed that the machine allows on the whole line, m/s: the least of what it allows anywhere on it.
    /// `None` if that is not known.
    pub allowed: Option<f64>,
    /// Time on the line, s.
    pub time_s: f64,
    /// Time lost against the programmed feed, s.
    pub lost_s: f64,
    /// The limit that costs most.
    pub binding: Option<Binding>,
    /// Time that this limit costs, s.
    pub binding_lost_s: f64,
}

/// Statistics of planning window by window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Windows {
    /// Windows planned.
    pub count: u64,
    /// Those in which the convex solver failed: feasible, but slower than need be.
    pub failed: u64,
    /// Those in which a limit is still exceeded somewhere.
    pub exceeded: u64,
}

impl LineLoss {
    /// Adds another piece of the same line. The limit that costs most is that of the longest loss without another in
    /// between.
    pub(super) fn include(&mut self, piece: &Self) {
        self.programmed = self.programmed.max(piece.programmed);
        self.allowed = match (self.allowed, piece.allowed) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        };
        self.time_s += piece.time_s;
        self.lost_s += piece.lost_s;
        if piece.binding_lost_s > self.binding_lost_s {
            self.binding = piece.binding;
            self.binding_lost_s = piece.binding_lost_s;
        }
    }
}

/// Makes a summary of the samples of a profile.
///
/// Between two samples the way is gone with the limit and the programmed feed of the first; what it takes longer than
/// with the programmed feed is lost.
#[derive(Clone, Debug, Default)]
pub struct Summing<'m> {
    axes: &'m [Axis],
    /// Axes whose peaks are those of the samples; of the others, while the path moves, they are those of its pieces.
    free: Vec<bool>,
    summary: LimitSummary,
    shares: BTreeMap<Option<Binding>, BindingShare>,
    losses: Losses,
    /// If every line was asked for.
    lines: Option<LineShares>,
    /// The piece of a line under one limit that is being gone through.
    piece: Option<LineLoss>,
    before: Option<ProfileSample>,
    begin_ns: i64,
    begin: f64,
}

impl<'m> Summing<'m> {
    /// Nothing yet.
    pub fn new(axes: &'m [Axis]) -> Self {
        Self::under(axes, 1.0)
    }

    /// As [`Self::new`], under an override `factor` that the programmed feed is multiplied by.
    pub fn under(axes: &'m [Axis], factor: f64) -> Self {
        let peaks = vec![AxisPeak::default(); axes.len()];
        let summary = LimitSummary { peaks, override_factor: factor, ..LimitSummary::default() };
        Self { axes, summary, ..Self::default() }
    }

    /// Peaks of the axes so far.
    pub fn peaks(&mut self) -> &mut [AxisPeak] {
        &mut self.summary.peaks
    }

    /// With peaks of the samples for the axes that are `free` of the path only; those of the others are taken from pieces of
    /// the plan.
    #[must_use]
    pub fn by_pieces(self, free: Vec<bool>) -> Self {
        Self { free, ..self }
    }

    /// With every line in the summary, not only those that lose most.
    #[must_use]
    pub fn with_every_line(self) -> Self {
        Self { lines: Some(LineShares::default()), ..self }
    }

    /// Takes the next sample.
    pub fn include(&mut self, sample: &ProfileSample) {
        for (index, (axis, peak)) in self.axes.iter().zip(&mut self.summary.peaks).enumerate() {
            let of = |values: &AxisVector| values.get(index).copied().unwrap_or_default();
            let at = of(&sample.position);
            let [low, high] = peak.position.unwrap_or([at; 2]);
            peak.position = Some([low.min(at), high.max(at)]);
            if let Some(effort) = &sample.effort {
                peak.effort.get_or_insert_default().include(of(effort), sample.place);
            }
            let follows = !self.free.get(index).copied().unwrap_or(true);
            if follows && sample.path_velocity > 0.0 {
                continue;
            }
            let (velocity, acceleration) = (of(&sample.velocity), of(&sample.acceleration));
            peak.velocity.include(velocity, sample.place);
            let slows = axis.slows(velocity, acceleration, 0.0);
            peak.include_acceleration(axis, slows, acceleration, sample.place);
            peak.jerk.include(of(&sample.jerk), sample.place);
        }
        match self.before.replace(*sample) {
            None => (self.begin_ns, self.begin) = (sample.time_ns, sample.way),
            Some(before) => self.interval(&before, sample),
        }
    }

    fn interval(&mut self, before: &ProfileSample, now: &ProfileSample) {
        let time_s = seconds(now.time_ns - before.time_ns);
        let way = now.way - before.way;
        // Where the path rests no feed would gain time.
        let feed = before.feed * self.summary.override_factor;
        let by_feed_s = if feed > 0.0 { way / feed } else { time_s };
        let lost_s = time_s - by_feed_s;
        self.summary.duration_by_feed_s += by_feed_s;
        let binding = before.binding;
        let nothing = BindingShare { binding, time_s: 0.0, lost_s: 0.0 };
        let share = self.shares.entry(binding).or_insert(nothing);
        share.time_s += time_s;
        share.lost_s += lost_s;
        if let Some(lines) = &mut self.lines {
            lines.include(LineShare {
                place: before.place,
                programmed: before.feed,
                allowed: None,
                binding,
                time_s,
                lost_s,
            });
        }
        let piece = LineLoss {
            place: before.place,
            programmed: before.feed,
            allowed: None,
            time_s,
            lost_s,
            binding,
            binding_lost_s: lost_s,
        };
        match &mut self.piece {
            Some(held) if held.place == piece.place && held.binding == binding => {
                let binding_lost_s = held.binding_lost_s + lost_s;
                held.include(&piece);
                held.binding_lost_s = binding_lost_s;
            }
            held => {
                if let Some(whole) = held.replace(piece) {
                    self.losses.include(whole);
                }
            }
        }
    }

    /// The summary. `allowed` knows the largest feed that the machine allows on a line, m/s.
    pub fn finish(
        mut self,
        windows: Windows,
        allowed: impl Fn(u32) -> Option<f64>,
    ) -> LimitSummary {
        if let Some(piece) = self.piece.take() {
            self.losses.include(piece);
        }
        let mut summary = self.summary;
        if let Some(last) = &self.before {
            summary.duration_s = seconds(last.time_ns - self.begin_ns);
            summary.length = last.way - self.begin;
        }
        summary.limited_by = self.shares.into_values().collect();
        summary.limited_by.sort_by(|one, other| {
            other.lost_s.total_cmp(&one.lost_s).then(one.binding.cmp(&other.binding))
        });
        summary.lines = self.losses.worst(NAMED_LINES);
        for line in &mut summary.lines {
            line.allowed = allowed(line.place.line).or(line.allowed);
        }
        summary.every_line = self.lines.map_or_else(Vec::new, |lines| lines.finish(&allowed));
        summary.windows = windows;
        summary
    }
}
