//! Axis groups: how their drives are started, reset and timed (2.2.2).
//!
//! The group says what is to be done with which drive, its owner does it and reports. The manual numbers the states of
//! the start-up 0 to 99 and does not name them; here a step is ten of them, named by [`StartStep`].

use super::{AxisError, TaskTimes};

/// What is done with every drive at the start, one step after the other for all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StartStep {
    /// `wState` 0: its port is opened.
    Connecting,
    /// 10: it says who it is.
    Identity,
    /// 20: its parameters are what they should be.
    Parameters,
    /// 30: its limits are.
    Limits,
    /// 40: it is unlocked.
    Enabling,
    /// 50: it is homed, or is known to need it.
    Homed,
}

impl StartStep {
    /// All, in their order.
    pub const ALL: [Self; 6] = [
        Self::Connecting,
        Self::Identity,
        Self::Parameters,
        Self::Limits,
        Self::Enabling,
        Self::Homed,
    ];

    fn state(self) -> u16 {
        match self {
            Self::Connecting => 0,
            Self::Identity => 10,
            Self::Parameters => 20,
            Self::Limits => 30,
            Self::Enabling => 40,
            Self::Homed => 50,
        }
    }

    /// What it does, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Connecting => "connecting",
            Self::Identity => "identity",
            Self::Parameters => "parameters",
            Self::Limits => "limits",
            Self::Enabling => "enabling",
            Self::Homed => "homed",
        }
    }

    fn next(self) -> Option<Self> {
        Self::ALL.into_iter().find(|step| *step > self)
    }
}

/// What `SMC_GetAxisGroupState` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupPhase {
    /// `bStartingUp`: 0 to 99.
    StartingUp,
    /// `bNormalOperation`: 100.
    Normal,
    /// `bResetting`: 200 to 210.
    Resetting,
    /// `bErrorDuringStartUp`: 1000 and above.
    StartUpError,
}

/// What the owner of a group does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupTask {
    /// A step of the start-up with a drive of the group.
    Start {
        /// Which, in the order they were given.
        drive: usize,
        /// What.
        step: StartStep,
    },
    /// Lock a drive before the group is started anew.
    Lock {
        /// Which.
        drive: usize,
    },
    /// Give all axes the ratios, periods and movement types of the configuration again (`bKeepRatioSettings` FALSE).
    RestoreRatios,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Starting { step: StartStep, drive: usize },
    Normal,
    Locking { drive: usize },
    Restoring,
    Failed { step: StartStep, drive: usize },
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Member {
    name: String,
    /// `bDisableDriveInAxisGroup`.
    disabled: bool,
    /// The same as it was when the group was started.
    left_out: bool,
}

/// `SMC_AXISGROUP_REF`.
#[doc(alias = "SMC_AXISGROUP_REF")]
#[doc(alias = "SMC_AXIS_GROUP")]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AxisGroup {
    members: Vec<Member>,
    state: State,
    keep_ratio: bool,
    /// `g_strBootupError`.
    boot_error: Option<String>,
    /// Cycle times.
    pub times: TaskTimes,
}

impl AxisGroup {
    /// A group of drives with these names that begins to start.
    pub fn new(names: impl IntoIterator<Item = String>) -> Self {
        let member = |name| Member { name, disabled: false, left_out: false };
        let members = names.into_iter().map(member).collect();
        let mut group = Self {
            members,
            state: State::Normal,
            keep_ratio: false,
            boot_error: None,
            times: TaskTimes::default(),
        };
        group.start();
        group
    }

    /// Begins the start-up of the drives that are not disabled.
    fn start(&mut self) {
        self.boot_error = None;
        for member in &mut self.members {
            member.left_out = member.disabled;
        }
        self.state = self.starting(StartStep::Connecting, 0);
    }

    /// A step with the first drive from `from` on that takes part, or the step after it.
    fn starting(&self, step: StartStep, from: usize) -> State {
        let mut step = Some(step);
        let mut from = from;
        while let Some(present) = step {
            if let Some(drive) = self.taking_part(from) {
                return State::Starting { step: present, drive };
            }
            (step, from) = (present.next(), 0);
        }
        State::Normal
    }

    fn taking_part(&self, from: usize) -> Option<usize> {
        let members = self.members.iter().enumerate().skip(from);
        members.filter(|(_, member)| !member.left_out).map(|(drive, _)| drive).next()
    }

    /// What is to be done now; `None` in normal operation and after an error.
    pub fn task(&self) -> Option<GroupTask> {
        match self.state {
            State::Starting { step, drive } => Some(GroupTask::Start { drive, step }),
            State::Locking { drive } => Some(GroupTask::Lock { drive }),
            State::Restoring => Some(GroupTask::RestoreRatios),
            State::Normal | State::Failed { .. } => None,
        }
    }

    /// What has become of [`Self::task`]. A step of the start-up that has failed ends it; a drive that cannot be locked
    /// does not keep the group from being started anew, which will show what is wrong.
    pub fn report(&mut self, outcome: Result<(), String>) {
        self.state = match (self.state, outcome) {
            (State::Starting { step, drive }, Ok(())) => self.starting(step, drive + 1),
            (State::Starting { step, drive }, Err(text)) => {
                let name = self.members.get(drive).map_or("", |member| member.name.as_str());
                self.boot_error = Some(format!("{name}: {}: {text}", step.name()));
                State::Failed { step, drive }
            }
            (State::Locking { drive }, _) => match self.taking_part(drive + 1) {
                Some(drive) => State::Locking { drive },
                None => return self.locked(),
            },
            (State::Restoring, _) => return self.start(),
            (state, _) => state,
        };
    }

    fn locked(&mut self) {
        if self.keep_ratio {
            self.start();
        } else {
            self.state = State::Restoring;
        }
    }

    /// `SMC_ResetAxisGroup`: locks the drives and starts those that are not disabled anew. `keep_ratio`
    /// (`bKeepRatioSettings`) leaves ratio, period and movement type as they are, as `SMC_ChangeGearingRatio` wants it.
    #[doc(alias = "SMC_ResetAxisGroup")]
    pub fn reset(&mut self, keep_ratio: bool) {
        self.keep_ratio = keep_ratio;
        match self.taking_part(0) {
            Some(drive) => self.state = State::Locking { drive },
            None => self.locked(),
        }
    }

    /// Whether the last reset is over.
    ///
    /// # Errors
    /// [`AxisError::StartUp`] (80) if the start-up has failed.
    pub fn reset_done(&self) -> Result<bool, AxisError> {
        match (self.state, &self.boot_error) {
            (State::Normal, _) => Ok(true),
            (State::Failed { .. }, Some(text)) => Err(AxisError::StartUp { text: text.clone() }),
            _ => Ok(false),
        }
    }

    /// `wState`.
    pub fn state(&self) -> u16 {
        match self.state {
            State::Starting { step, .. } => step.state(),
            State::Normal => 100,
            State::Locking { .. } => 200,
            State::Restoring => 205,
            State::Failed { step, .. } => 1000 + step.state(),
        }
    }

    /// What `wState` means.
    #[doc(alias = "SMC_GetAxisGroupState")]
    pub fn phase(&self) -> GroupPhase {
        match self.state() {
            0..=99 => GroupPhase::StartingUp,
            200..=210 => GroupPhase::Resetting,
            1000.. => GroupPhase::StartUpError,
            _ => GroupPhase::Normal,
        }
    }

    /// `SMC_IsAxisGroupReady`.
    #[doc(alias = "SMC_IsAxisGroupReady")]
    pub fn is_ready(&self) -> bool {
        self.state == State::Normal
    }

    /// `pErrorDrive`: the drive whose start-up has failed.
    pub fn error_drive(&self) -> Option<usize> {
        match self.state {
            State::Failed { drive, .. } => Some(drive),
            _ => None,
        }
    }

    /// `g_strBootupError`: drive, step and reason.
    pub fn boot_error(&self) -> Option<&str> {
        self.boot_error.as_deref()
    }

    /// `bDisableDriveInAxisGroup` of one drive; it counts from the next reset on.
    pub fn disable(&mut self, drive: usize, disabled: bool) {
        if let Some(member) = self.members.get_mut(drive) {
            member.disabled = disabled;
        }
    }

    /// `SMC_DisableAllDrives`; it counts from the next reset on.
    #[doc(alias = "SMC_DisableAllDrives")]
    pub fn disable_all(&mut self) {
        self.members.iter_mut().for_each(|member| member.disabled = true);
    }

    /// `SMC_EnableAllDrives`; it counts from the next reset on.
    #[doc(alias = "SMC_EnableAllDrives")]
    pub fn enable_all(&mut self) {
        self.members.iter_mut().for_each(|member| member.disabled = false);
    }

    /// Whether a drive takes part: it was not disabled when the group was started last.
    pub fn takes_part(&self, drive: usize) -> bool {
        self.members.get(drive).is_some_and(|member| !member.left_out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group() -> AxisGroup {
        AxisGroup::new(["left".to_owned(), "right".to_owned()])
    }

    /// Does all tasks, and says what they were and in which states.
    fn run(group: &mut AxisGroup) -> Vec<(u16, GroupTask)> {
        let mut done = Vec::new();
        while let Some(task) = group.task() {
            done.push((group.state(), task));
            group.report(Ok(()));
        }
        done
    }

    #[test]
    fn all_drives_start_step_by_step() {
        let mut group = group();
        assert_eq!((group.phase(), group.is_ready()), (GroupPhase::StartingUp, false));
        let done = run(&mut group);
        assert_eq!(done.len(), 12);
        assert_eq!(done[1], (0, GroupTask::Start { drive: 1, step: StartStep::Connecting }));
        assert_eq!(done[2], (10, GroupTask::Start { drive: 0, step: StartStep::Identity }));
        assert!(done.iter().all(|(state, _)| *state < 100));
        assert_eq!((group.state(), group.phase()), (100, GroupPhase::Normal));
        assert!(group.is_ready() && group.reset_done() == Ok(true));
        group.report(Err("of nothing".to_owned()));
        assert!(group.is_ready(), "there was no task");
    }

    #[test]
    fn a_drive_that_fails_is_named_and_can_be_left_out() {
        let mut group = group();
        for _ in 0..5 {
            group.report(Ok(()));
        }
        group.report(Err("Trj_VelMax is 499, not 500".to_owned()));
        assert_eq!((group.state(), group.phase()), (1020, GroupPhase::StartUpError));
        assert_eq!((group.error_drive(), group.task()), (Some(1), None));
        assert_eq!(group.boot_error(), Some("right: parameters: Trj_VelMax is 499, not 500"));
        assert_eq!(group.reset_done().unwrap_err().number(), Some(80));
        group.disable(1, true);
        assert!(group.takes_part(1), "from the next reset on");
        group.reset(true);
        let done = run(&mut group);
        // Both are locked, one is started; the ratios stay.
        assert_eq!(
            (done[0], done[1]),
            ((200, GroupTask::Lock { drive: 0 }), (200, GroupTask::Lock { drive: 1 }))
        );
        assert_eq!(done.len(), 2 + 6);
        assert!(group.is_ready() && !group.takes_part(1) && group.boot_error().is_none());
    }

    #[test]
    fn a_group_without_drives_still_works() {
        let mut group = group();
        run(&mut group);
        group.disable_all();
        assert!(group.is_ready());
        group.reset(false);
        assert_eq!(group.phase(), GroupPhase::Resetting);
        group.report(Err("silent".to_owned()));
        group.report(Ok(()));
        assert_eq!((group.state(), group.task()), (205, Some(GroupTask::RestoreRatios)));
        assert_eq!(run(&mut group).len(), 1);
        assert!(group.is_ready() && !group.takes_part(0));
        group.enable_all();
        group.reset(true);
        assert_eq!(run(&mut group).len(), 12, "nothing to lock");
    }
}
