//! Blocks of any kind behind one interface.

use std::fmt;
use twin_motion::axis::{Axis, Block, Master, Motion, MoveSuperImposed, Outputs};

/// A block, called once a cycle.
pub(super) trait Called: fmt::Debug + Send {
    /// Calls it with Execute, the axis it moves and the one it follows.
    fn call(&mut self, execute: bool, axis: &mut Axis, master: Option<Master>) -> Outputs;
}

/// A block that moves an axis by itself.
#[derive(Debug)]
struct Alone<M: Motion>(Block<M>);

impl<M> Called for Alone<M>
where
    M: Motion<With = ()> + Clone + fmt::Debug + Send,
    M::Run: Send,
{
    fn call(&mut self, execute: bool, axis: &mut Axis, _master: Option<Master>) -> Outputs {
        self.0.call(execute, axis)
    }
}

/// A block whose axis follows another one.
#[derive(Debug)]
struct Following<M: Motion>(Block<M>);

impl<M> Called for Following<M>
where
    M: Motion<With = Master> + Clone + fmt::Debug + Send,
    M::Run: Send,
{
    fn call(&mut self, execute: bool, axis: &mut Axis, master: Option<Master>) -> Outputs {
        match master {
            Some(master) => self.0.call_with(execute, axis, master),
            None => Outputs::default(),
        }
    }
}

impl Called for MoveSuperImposed {
    fn call(&mut self, execute: bool, axis: &mut Axis, _master: Option<Master>) -> Outputs {
        Self::call(self, execute, axis)
    }
}

/// A block of `inputs` that moves an axis by itself.
pub(super) fn alone<M>(inputs: M) -> Box<dyn Called>
where
    M: Motion<With = ()> + Clone + fmt::Debug + Send + 'static,
    M::Run: Send + 'static,
{
    Box::new(Alone(Block::new(inputs)))
}

/// A block of `inputs` whose axis follows another one.
pub(super) fn following<M>(inputs: M) -> Box<dyn Called>
where
    M: Motion<With = Master> + Clone + fmt::Debug + Send + 'static,
    M::Run: Send + 'static,
{
    Box::new(Following(Block::new(inputs)))
}
