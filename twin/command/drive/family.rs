//! Interface of a family to `twin drive`.

use super::action::Command;
use super::by_switch::BySwitch;
use crate::command::{Failure, Status};
use clap::Args;
use std::fmt::Debug;
use std::time::Duration;
use twin_drives::Drive;

/// No arguments.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(super) struct Nothing {}

/// A move to be asked for and carried out.
pub(super) struct Travel<P> {
    /// Where the axis is sent, increments.
    pub(super) target: i32,
    /// Which axis, from where, to where, how fast.
    pub(super) question: String,
    /// Speed and ramps as the device takes them.
    pub(super) profile: P,
    /// How long it may take.
    pub(super) patience: Duration,
}

/// An opened device of a family, with what the command line says about it.
pub(super) trait Family: Debug + Sized {
    /// Options of line and driver.
    type Line: Args + Debug;
    /// Arguments of `scan`.
    type Scan: Args + Debug;
    /// Arguments of `unlock`: which axes.
    type Unlock: Args + Debug;
    /// Arguments of `home`: which axes, how far or how long.
    type Home: Args + Debug;
    /// Which axis is moved.
    type Axis: Args + Debug;
    /// Speed and ramps of a move.
    type Ramps: Args + Debug;
    /// Outputs to switch.
    type Outputs: Args + Debug;
    /// Speed and ramps as the device takes them.
    type Profile;
    /// A parameter.
    type Parameter;

    /// What its increments are called.
    const UNIT: &'static str;
    /// What is said to `save` where there is nothing to save.
    const KEEPS: Option<&'static str> = None;
    /// What is said to `reset` where there is none.
    const NO_RESET: Option<&'static str> = None;
    /// What is said to `outputs` where there are none.
    const NO_OUTPUTS: Option<&'static str> = None;
    /// Columns of the table of parameters.
    const COLUMNS: &'static [&'static str];

    /// Opens the device.
    fn open(command: &Command<Self>) -> Result<Self, Failure>;

    /// The device with all its axes, as runs drive it; `restore` if parameters are to be restored.
    fn drive(command: &Command<Self>, restore: bool) -> Result<Box<dyn Drive>, Failure>;

    /// Shows who answers.
    fn scan(command: &Command<Self>, scan: &Self::Scan) -> Result<Status, Failure>;

    /// Homes one axis by a switch that the device only shows.
    fn home_by_switch(
        command: &Command<Self>,
        home: &Self::Home,
        by_switch: &BySwitch,
    ) -> Result<(), Failure>;

    /// Does what comes before any action. A status ends the command: the action is done.
    fn prepare(&mut self, _command: &Command<Self>) -> Result<Option<Status>, Failure> {
        Ok(None)
    }

    /// Shows state and positions.
    fn status(&mut self) -> Result<(), Failure>;

    /// Makes the device obey.
    fn unlock(&mut self, unlock: &Self::Unlock) -> Result<(), Failure>;

    /// Homes axes by the device's own homing.
    fn home(&mut self, home: &Self::Home) -> Result<(), Failure>;

    /// Name of an axis in a message.
    fn axis_name(axis: &Self::Axis) -> String;

    /// Plans a move of an axis that may be moved; `target` makes the target of where it is.
    fn plan(
        &mut self,
        axis: &Self::Axis,
        ramps: &Self::Ramps,
        target: &dyn Fn(i32) -> Result<i32, Failure>,
    ) -> Result<Travel<Self::Profile>, Failure>;

    /// Moves an axis and waits until it is there.
    fn travel(&mut self, axis: &Self::Axis, to: &Travel<Self::Profile>) -> Result<(), Failure>;

    /// Says what else has moved.
    fn report_follower(&mut self) -> Result<(), Failure> {
        Ok(())
    }

    /// Stops all axes, on their ramps or at once; what has become of them.
    fn stop(&mut self, now: bool) -> Result<String, Failure>;

    /// The parameter of a name or number.
    fn find(text: &str) -> Result<Self::Parameter, Failure>;

    /// All parameters.
    fn parameters() -> Vec<Self::Parameter>;

    /// Row of a parameter in the table.
    fn row(&mut self, parameter: &Self::Parameter) -> Result<Vec<comfy_table::Cell>, Failure>;

    /// Sets a parameter.
    fn set(&mut self, parameter: &Self::Parameter, value: &str) -> Result<(), Failure>;

    /// Makes the device keep its parameters.
    fn save(&mut self) -> Result<(), Failure> {
        Ok(())
    }

    /// Restarts the device.
    fn reset(&mut self) -> Result<Status, Failure> {
        Ok(Status::Fit)
    }

    /// Shows the inputs.
    fn inputs(&mut self) -> Result<(), Failure>;

    /// Switches outputs, and shows all.
    fn outputs(&mut self, _outputs: &Self::Outputs) -> Result<(), Failure> {
        Ok(())
    }
}
