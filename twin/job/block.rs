//! Common interface of all function blocks of a job.

use std::fmt;
use twin_axis::{Axis, Block, CamIn, GearInPos, Master, Motion, Outputs, SuperImposed};
use twin_cam::{StartMode, TappetData, Trigger};
use twin_machine::cam_file::CamRemark;

/// Inputs of a block call besides its axis.
#[derive(Debug)]
pub(super) struct With<'a> {
    /// The axis that it follows.
    pub(super) master: Option<Master>,
    /// The triggers of the job.
    pub(super) triggers: &'a mut [twin_axis::Trigger],
}

/// A block, called once a cycle.
pub(super) trait Called: fmt::Debug + Send {
    /// Calls it with Execute, the axis it moves, and what else it needs.
    fn call(&mut self, execute: bool, axis: &mut Axis, with: With<'_>) -> Outputs;

    /// Groups of the tappets that it may switch.
    fn groups(&self) -> Vec<i16> {
        Vec::new()
    }

    /// Tappets of the last call.
    fn tappets(&self) -> Option<&TappetData> {
        None
    }

    /// Dead time by which tappets act ahead of the master, s.
    fn dead_time(&self) -> f64 {
        0.0
    }

    /// Start of its axis on a cam, of a block with a cam.
    fn cam_start(&self) -> Option<CamStart> {
        None
    }

    /// Shifts the cam of a block that has not begun, in the unit of its axis.
    fn lay(&mut self, _by: f64) {}

    /// Groups of the tappets on which the master stood when its cam began.
    fn stood_on(&self) -> Vec<i16> {
        Vec::new()
    }

    /// Duration of its motion from the beginning, s, if it is known.
    fn lasts(&self) -> Option<f64> {
        None
    }

    /// Position of its master at which it is coupled, in the master's unit, until then.
    fn awaits(&self) -> Option<f64> {
        None
    }

    /// `EndOfProfile` of the last call.
    fn ends_profile(&self) -> bool {
        false
    }

    /// Warnings about the elements of its cam, each with file and line.
    fn cam_remarks(&self) -> &[CamRemark] {
        &[]
    }

    /// Number of the trigger that it waits for.
    fn trigger(&self) -> Option<usize> {
        None
    }

    /// Gain of its axis in every pass of a cam that is periodic by default, in its unit.
    fn gain_unsaid(&self) -> Option<f64> {
        None
    }

    /// Position that it has recorded, while it is done.
    fn recorded(&self) -> Option<f64> {
        None
    }
}

/// Start of an axis on its cam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CamStart {
    /// True if the cam is relative to the position of the axis (manual 4.6.1).
    pub(super) relative: bool,
    /// `SlaveOffset`, mm or degrees.
    pub(super) slave_offset: f64,
    /// Range of its master then, mm or degrees; for a cam whose zero is put at its master, the range of `MasterOffset`.
    pub(super) masters: [f64; 2],
    /// True if the zero of the cam is the position of its master.
    pub(super) laid: bool,
}

/// A block whose axis follows a cam.
#[derive(Debug)]
struct OnCam {
    block: Block<CamIn>,
    remarks: Vec<CamRemark>,
    gain_unsaid: Option<f64>,
}

impl Called for OnCam {
    fn call(&mut self, execute: bool, axis: &mut Axis, with: With<'_>) -> Outputs {
        match with.master {
            Some(master) => self.block.call_with(execute, axis, master),
            None => Outputs::default(),
        }
    }

    fn groups(&self) -> Vec<i16> {
        let cam = self.block.inputs.table.as_ref().map(|table| &table.cam);
        cam.into_iter().flat_map(|cam| cam.tappets()).map(|tappet| tappet.group).collect()
    }

    fn tappets(&self) -> Option<&TappetData> {
        self.block.running().map(|run| &run.coupling().output().tappets)
    }

    fn dead_time(&self) -> f64 {
        self.block.inputs.input.tappet_dead_time_s
    }

    fn cam_remarks(&self) -> &[CamRemark] {
        &self.remarks
    }

    fn cam_start(&self) -> Option<CamStart> {
        let CamIn { table, input } = &self.block.inputs;
        let relative = input.start_mode == StartMode::Relative
            || table.as_ref().is_some_and(|table| !table.slave_absolute);
        let laid = table.as_ref().is_some_and(|table| !table.master_absolute);
        let curve = table.as_ref().map(|table| table.cam.curve());
        let ends = curve.map(|curve| [curve.start(), curve.end()]).unwrap_or_default();
        let masters = if laid {
            ends
        } else {
            let [one, other] = ends.map(|x| (x - input.master_offset) / input.master_scaling);
            [one.min(other), one.max(other)]
        };
        Some(CamStart { relative, slave_offset: input.slave_offset, masters, laid })
    }

    fn lay(&mut self, by: f64) {
        self.block.inputs.input.slave_offset += by;
    }

    fn stood_on(&self) -> Vec<i16> {
        let run = self.block.running().into_iter();
        run.flat_map(|run| run.coupling().stood_on()).map(|tappet| tappet.group).collect()
    }

    fn ends_profile(&self) -> bool {
        self.block.running().is_some_and(|run| run.coupling().output().end_of_profile)
    }

    fn gain_unsaid(&self) -> Option<f64> {
        self.gain_unsaid
    }
}

/// Moves the zero of an axis, not the axis.
#[derive(Debug)]
struct SetPosition {
    position: f64,
    relative: bool,
    /// Outputs since its first call.
    shown: Option<Outputs>,
}

impl Called for SetPosition {
    fn call(&mut self, _execute: bool, axis: &mut Axis, _with: With<'_>) -> Outputs {
        *self.shown.get_or_insert_with(|| {
            let error = axis.shift_zero(self.position, self.relative).err();
            Outputs { done: error.is_none(), error, ..Outputs::default() }
        })
    }
}

/// Block that moves the zero of an axis once, so that the axis is at `position`, or by `position` if `relative`.
pub(super) fn set_position(position: f64, relative: bool) -> Box<dyn Called> {
    Box::new(SetPosition { position, relative, shown: None })
}

/// A block whose axis follows a cam, with notes on the cam's file.
pub(super) fn on_cam(
    inputs: CamIn,
    remarks: Vec<CamRemark>,
    gain_unsaid: Option<f64>,
) -> Box<dyn Called> {
    Box::new(OnCam { block: Block::new(inputs), remarks, gain_unsaid })
}

/// A tappet that has acted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fired {
    /// Axis on the cam.
    pub(super) slave: usize,
    /// Its master.
    pub(super) master: usize,
    /// Its action; its time is that of the job.
    pub(super) trigger: Trigger,
    /// Dead time by which it acts ahead of the master, s of the job.
    pub(super) dead_time: f64,
}

/// A block of motions that needs its axis, or a master as well.
#[derive(Debug)]
struct Moving<M: Motion>(Block<M>);

/// The further input of a motion, from a call.
pub(super) trait Input: Copy {
    fn of(with: &With<'_>) -> Option<Self>;
}

impl Input for () {
    fn of(_with: &With<'_>) -> Option<Self> {
        Some(())
    }
}

impl Input for Master {
    fn of(with: &With<'_>) -> Option<Self> {
        with.master
    }
}

impl<M> Called for Moving<M>
where
    M: Motion<With: Input> + Clone + fmt::Debug + Send,
    M::Run: Send,
{
    fn call(&mut self, execute: bool, axis: &mut Axis, with: With<'_>) -> Outputs {
        M::With::of(&with).map_or(Outputs::default(), |with| self.0.call_with(execute, axis, with))
    }

    fn lasts(&self) -> Option<f64> {
        self.0.duration()
    }
}

/// A block of `inputs` that moves an axis.
pub(super) fn moving<M>(inputs: M) -> Box<dyn Called>
where
    M: Motion<With: Input> + Clone + fmt::Debug + Send + 'static,
    M::Run: Send + 'static,
{
    Box::new(Moving(Block::new(inputs)))
}

impl Called for SuperImposed {
    fn call(&mut self, execute: bool, axis: &mut Axis, _with: With<'_>) -> Outputs {
        Self::call(self, execute, axis)
    }

    fn lasts(&self) -> Option<f64> {
        self.duration()
    }
}

/// A block whose axis is in gear with another one from a place on.
#[derive(Debug)]
struct InGearFrom(Moving<GearInPos>);

impl Called for InGearFrom {
    fn call(&mut self, execute: bool, axis: &mut Axis, with: With<'_>) -> Outputs {
        self.0.call(execute, axis, with)
    }

    fn awaits(&self) -> Option<f64> {
        let Moving(block) = &self.0;
        block.running().map(|_| block.inputs.master_sync_position)
    }
}

/// A block whose axis is in gear with another one from a place on.
pub(super) fn in_gear_from(inputs: GearInPos) -> Box<dyn Called> {
    Box::new(InGearFrom(Moving(Block::new(inputs))))
}
