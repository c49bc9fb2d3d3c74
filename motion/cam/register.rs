//! Cam register: tappets without a slave (`SMC_CAMRegister`, manual 5.5).

use super::bit::TappetBit;
use super::passage::{Lead, LookAhead, Move, Watch};
use super::reference::Cam;
use super::unwrap::Unwrap;
use std::sync::Arc;

/// Inputs of a register; the defaults are 0, that of the scaling is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegisterInput {
    /// `MasterOffset`, u of the cam.
    pub master_offset: f64,
    /// `MasterScaling`.
    pub master_scaling: f64,
    /// `TappetHysteresis`: a tappet acts again only when the master has left this band on both sides of it, u of the
    /// cam.
    pub hysteresis: f64,
    /// `DeadTimeCompensation`: tappets are looked for where the master will be this much later, s.
    pub dead_time_s: f64,
    /// The master's period, if it is a rotary axis, u.
    pub master_period: Option<f64>,
    /// `MAX_NUM_TAPPETS`: the bits that there are, for groups from 1 on. None for as many as the cam has groups, whatever
    /// their numbers; the manual does not say what the constant is.
    pub max_num_tappets: Option<i16>,
}

impl Default for RegisterInput {
    fn default() -> Self {
        Self {
            master_offset: 0.0,
            master_scaling: 1.0,
            hysteresis: 0.0,
            dead_time_s: 0.0,
            master_period: None,
            max_num_tappets: None,
        }
    }
}

/// Reason why a register does not begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegisterError {
    /// Error 600, `SMC_CR_NO_TAPPETS_IN_CAM`.
    #[error("the cam has no tappets (error 600)")]
    NoTappets,
    /// Error 601, `SMC_CR_TOO_MANY_TAPPETS`.
    #[error("tappet {index} is of group {group}, there are 1 to {most} (error 601)")]
    NoSuchGroup {
        /// Number of the tappet, from 1.
        index: usize,
        /// Its group.
        group: i16,
        /// `MAX_NUM_TAPPETS`.
        most: i16,
    },
}

impl RegisterError {
    /// The manual's number (`SMC_ERROR`, 9.3).
    pub const fn number(&self) -> u16 {
        match self {
            Self::NoTappets => 600,
            Self::NoSuchGroup { .. } => 601,
        }
    }
}

/// Switches the bits of a cam's tappets as a master moves; the curve does not count (`SMC_CAMRegister`, manual 5.5). The
/// cam is periodic.
///
/// A register has its own bits and only reads the cam, so that any number of them may use one: nothing counts accesses
/// (the manual's error 602).
#[doc(alias = "SMC_CAMRegister")]
#[derive(Clone, Debug)]
pub struct CamRegister {
    cam: Arc<Cam>,
    input: RegisterInput,
    unwrap: Option<Unwrap>,
    watch: Watch,
    last: Option<(LookAhead, i64)>,
    passes: f64,
    end_of_profile: bool,
    bits: Vec<(i16, TappetBit)>,
}

impl CamRegister {
    /// Enables the block: all bits are off. A tappet under the master then has not been passed.
    ///
    /// # Errors
    /// [`RegisterError`] for a cam without tappets (600), or one with groups that have no bit (601).
    pub fn new(cam: Arc<Cam>, input: RegisterInput) -> Result<Self, RegisterError> {
        if cam.tappets().is_empty() {
            return Err(RegisterError::NoTappets);
        }
        if let Some(most) = input.max_num_tappets {
            let mut numbered = (1..).zip(cam.tappets());
            if let Some((index, tappet)) = numbered.find(|(_, it)| !(1..=most).contains(&it.group))
            {
                return Err(RegisterError::NoSuchGroup { index, group: tappet.group, most });
            }
        }
        let mut groups: Vec<_> = cam.tappets().iter().map(|tappet| tappet.group).collect();
        groups.sort_unstable();
        groups.dedup();
        let watch = Watch::of(&cam, input.hysteresis, true);
        let bits = groups.into_iter().map(|group| (group, TappetBit::default())).collect();
        Ok(Self {
            cam,
            input,
            unwrap: None,
            watch,
            last: None,
            passes: 0.0,
            end_of_profile: false,
            bits,
        })
    }

    /// Look-ahead position of the register on the scale of the cam: (position + velocity · dead time) · scaling +
    /// offset. If it moves back only because the master brakes, it stays until the master has caught up.
    pub fn looks_at(&self, position: f64, velocity: f64) -> f64 {
        let ahead = position + velocity * self.input.dead_time_s;
        ahead * self.input.master_scaling + self.input.master_offset
    }

    /// A cycle: the master's position (u), velocity (u/s) and the time.
    #[expect(clippy::float_cmp, reason = "counts of passes")]
    pub fn step(&mut self, position: f64, velocity: f64, now_ns: i64) {
        let period = self.input.master_period;
        let unwrap = self.unwrap.get_or_insert_with(|| Unwrap::new(period, position));
        let whole = unwrap.follow(position);
        let RegisterInput { master_scaling, master_offset, dead_time_s, hysteresis, .. } =
            self.input;
        let (x, v) = (whole * master_scaling + master_offset, velocity * master_scaling);
        let mut ahead = match self.last {
            Some((ahead, _)) => ahead,
            None => LookAhead::new(x, v, dead_time_s),
        };
        let [from, to] = ahead.follow(x, v, Lead { dead_time_s, hysteresis });
        let (_, passes) = self.cam.curve().wrap(to);
        if let Some((_, from_ns)) = self.last {
            self.end_of_profile = passes != self.passes;
            for trigger in self.watch.passed(&Move { from, to, from_ns, to_ns: now_ns }) {
                if let Ok(index) = self.bits.binary_search_by_key(&trigger.group, |(id, _)| *id)
                    && let Some((_, bit)) = self.bits.get_mut(index)
                {
                    bit.take(&trigger);
                }
            }
        }
        for (_, bit) in &mut self.bits {
            bit.at(now_ns);
        }
        self.passes = passes;
        self.last = Some((ahead, now_ns));
    }

    /// `EndOfProfile`: in this cycle the master has passed from the end of the cam to its begin, or back.
    pub fn end_of_profile(&self) -> bool {
        self.end_of_profile
    }

    /// The bit of a group; none if the cam has no such group.
    pub fn bit(&self, group: i16) -> Option<bool> {
        let index = self.bits.binary_search_by_key(&group, |(id, _)| *id).ok()?;
        self.bits.get(index).map(|(_, bit)| bit.value())
    }

    /// Groups and their bits (`bTappet`), by ascending groups.
    pub fn bits(&self) -> impl Iterator<Item = (i16, bool)> + '_ {
        self.bits.iter().map(|(group, bit)| (*group, bit.value()))
    }
}
