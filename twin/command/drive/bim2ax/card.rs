//! The module, and how it is stopped.

use super::super::session::{BRAKING, RestPosition, Stopping, no_clock};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::{Instant, sleep};
use twin_bim2ax::protocol::bits::message;
use twin_bim2ax::protocol::zone::Positions;
use twin_bim2ax::{Bim2Ax, Bim2AxOptions, Memory, ModuleAxis};
use twin_drives::{Action, Axes, DriveError, Exchange};

/// Position and messages of an axis.
pub(super) fn of(seen: &Positions, axis: ModuleAxis) -> (i32, u16) {
    let index = axis.index();
    let position = seen.positions.get(index).copied().unwrap_or(0);
    (position, seen.messages.get(index).copied().unwrap_or(0))
}

/// The module and its name.
#[derive(Debug)]
pub(super) struct Card {
    pub(super) driver: Bim2Ax,
    pub(super) port: Arc<str>,
    /// True if another program is its master.
    shared: bool,
}

/// Time at rest after which another master has noticed the stop: longer than a leg of a plan, which ends within the
/// plan's horizon.
const REST_TIME: Duration = Duration::from_secs(1);
/// Interval of looks.
const LOOK: Duration = Duration::from_millis(5);
/// Largest number of stops.
const MOST_STOPS: u32 = 20;

impl Card {
    pub(super) fn new(
        port: Arc<str>,
        memory: impl Memory + 'static,
        mut options: Bim2AxOptions,
        shared: bool,
    ) -> Self {
        if shared {
            // The master takes some of the answers.
            options.deadline = options.deadline.min(REST_TIME / 4);
        }
        let driver = Bim2Ax::new(&port, memory, &options);
        Self { driver, port, shared }
    }

    /// Whether another program was the master of the module when it was opened.
    pub(super) fn is_shared(&self) -> bool {
        self.shared
    }

    /// Stops both axes for good: a program that is the master of the module may give it another order before it notices.
    /// True if the byte order differs from the options.
    pub(super) async fn stop_for_good(&mut self, hard: bool) -> Result<bool, DriveError> {
        let mut stopped = self.stop(hard).await;
        if !self.shared {
            return stopped;
        }
        for _ in 1..MOST_STOPS {
            if stopped.is_ok() && self.rests().await {
                return stopped;
            }
            stopped = self.stop(hard).await;
        }
        stopped.and_then(|_| {
            let at =
                Exchange { port: Arc::clone(&self.port), address: 0, action: Action::ReadState };
            Err(DriveError::Moving { at, axes: Axes::Numbers(0b11) })
        })
    }

    /// Whether both axes are at rest from the first look to the last, for as long as the master may take to notice. An
    /// answer that the other program has taken counts as motion.
    async fn rests(&mut self) -> bool {
        let mut first = None;
        while let Ok((seen, _)) = self.driver.positions(&no_clock).await
            && seen.messages.iter().all(|messages| messages & message::MOVING == 0)
        {
            let now = Instant::now();
            if now.duration_since(*first.get_or_insert(now)) >= REST_TIME {
                return true;
            }
            sleep(LOOK).await;
        }
        false
    }

    /// Stops both axes: whatever else is wrong with the module, the order goes out first.
    ///
    /// Read in the other byte order, that to brake says nothing, but that for a hard stop would begin homing: so the first
    /// stop is on the ramps, and a hard one follows when the byte order is known. True if that differs from the
    /// options.
    async fn stop(&mut self, hard: bool) -> Result<bool, DriveError> {
        let braked = self.driver.abandon(&no_clock).await;
        let other = self.driver.adopt_byte_order(&no_clock).await?;
        if other {
            self.driver.abandon(&no_clock).await?;
        } else {
            braked?;
        }
        if hard {
            self.driver.stop_hard(&no_clock).await?;
        }
        self.driver.rested(BRAKING, &no_clock).await?;
        Ok(other)
    }
}

impl Stopping for Card {
    async fn soft_stop(&mut self) -> Result<(), DriveError> {
        self.driver.abandon(&no_clock).await?;
        self.driver.rested(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn hard_stop(&mut self) -> Result<(), DriveError> {
        self.driver.stop_hard(&no_clock).await?;
        self.driver.rested(BRAKING, &no_clock).await.map(|_| ())
    }

    async fn rest_position(&mut self) -> Result<RestPosition, DriveError> {
        let (seen, _) = self.driver.positions(&no_clock).await?;
        let [one, two] = seen.positions;
        let lost = message::PHASES_OFF | message::HOMED;
        let off = |messages: &u16| messages & lost == message::PHASES_OFF;
        if seen.positions == [0; 2] && seen.messages.iter().all(off) {
            return Ok(RestPosition::Lost("both motors are without current, not homed, and at 0"));
        }
        Ok(RestPosition::Known(format!("1: {one}, 2: {two}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use twin_bim2ax::SharedModule;
    use twin_bim2ax::emulator::{Eeprom, Module as Emulated, ModuleOptions, Surroundings};

    /// A module that hears a number of questions and no more.
    struct Falling {
        module: SharedModule,
        questions: u32,
    }

    impl Memory for Falling {
        fn read(&mut self, offset: u8, bytes: &mut [u8]) -> io::Result<()> {
            self.module.read(offset, bytes)
        }

        fn write(&mut self, offset: u8, bytes: &[u8]) -> io::Result<()> {
            // The last byte of the window interrupts the module.
            if offset == 0x7F {
                self.questions = self.questions.saturating_sub(1);
                if self.questions == 0 {
                    return Ok(());
                }
            }
            self.module.write(offset, bytes)
        }
    }

    fn rests(questions: u32, deadline: Duration) -> bool {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let options = ModuleOptions::default();
        let module = Emulated::new(&options, &Eeprom::blank(), &Surroundings::default());
        let (clock, on_for_ns) = (crate::clock::Clock::start(), options.boot_ns);
        let now = move || clock.now_ns() + on_for_ns;
        let memory = Falling { module: SharedModule::new(module, now), questions };
        let options = Bim2AxOptions { deadline, ..Bim2AxOptions::default() };
        let mut module = Card::new("module".into(), memory, options, true);
        runtime.expect("a runtime").block_on(module.rests())
    }

    #[test]
    fn a_silent_module_does_not_count_as_at_rest() {
        let patient = Duration::from_secs(3);
        assert!(rests(u32::MAX, patient));
        for questions in [1, 20] {
            assert!(!rests(questions, patient), "{questions}");
        }
    }
}
