//! The module, and how it is stopped.

use super::super::session::{BRAKING, Stands, Stopping, no_clock};
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
    /// Another program is its master.
    beside: bool,
}

/// How long a module that another program drives has to stand until that has noticed that it was stopped: longer than a leg
/// of a plan takes, which ends within the plan's horizon.
const STANDING: Duration = Duration::from_secs(1);
/// Time between two looks at it.
const LOOK: Duration = Duration::from_millis(5);
/// It is stopped at most so many times.
const MOST_STOPS: u32 = 20;

impl Card {
    pub(super) fn new(
        port: Arc<str>,
        memory: impl Memory + 'static,
        mut options: Bim2AxOptions,
        beside: bool,
    ) -> Self {
        if beside {
            // The master takes some of the answers: they are waited for no longer than it makes sense to look.
            options.deadline = options.deadline.min(STANDING / 4);
        }
        let driver = Bim2Ax::new(&port, memory, &options);
        Self { driver, port, beside }
    }

    /// Whether another program was the master of the module when it was opened.
    pub(super) fn is_beside(&self) -> bool {
        self.beside
    }

    /// Stops both axes for good: a program that is the master of the module may give it another order before it notices.
    /// True if the module writes its numbers otherwise than it was thought to.
    pub(super) async fn stop_for_good(&mut self, hard: bool) -> Result<bool, DriveError> {
        let mut stopped = self.stop(hard).await;
        if !self.beside {
            return stopped;
        }
        for _ in 1..MOST_STOPS {
            if stopped.is_ok() && self.stands().await {
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

    /// Whether both axes stand for as long as the master may take to notice, from the first look to the last. The two ask at
    /// the same time, and each may miss what the module answers to it: not known is not standing.
    async fn stands(&mut self) -> bool {
        let mut first = None;
        while let Ok((seen, _)) = self.driver.positions(&no_clock).await
            && seen.messages.iter().all(|messages| messages & message::MOVING == 0)
        {
            let now = Instant::now();
            if now.duration_since(*first.get_or_insert(now)) >= STANDING {
                return true;
            }
            sleep(LOOK).await;
        }
        false
    }

    /// Stops both axes: whatever else is wrong with the module, the order goes out first.
    ///
    /// Read in the other byte order, that to brake says nothing, but that for a hard stop would begin homing: so the first
    /// stop is on the ramps, and a hard one comes after the module has told how it writes its numbers. True if that is
    /// otherwise than it was thought to be.
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

    async fn stands(&mut self) -> Result<Stands, DriveError> {
        let (seen, _) = self.driver.positions(&no_clock).await?;
        let [one, two] = seen.positions;
        let lost = message::PHASES_OFF | message::HOMED;
        let off = |messages: &u16| messages & lost == message::PHASES_OFF;
        if seen.positions == [0; 2] && seen.messages.iter().all(off) {
            return Ok(Stands::Anew("both motors are without current, not homed, and at 0"));
        }
        Ok(Stands::At(format!("1: {one}, 2: {two}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use twin_bim2ax::SharedModule;
    use twin_bim2ax::emulator::{Eeprom, Module as Emulated, ModuleOptions, Surroundings};

    /// A module that is asked nothing any more once it has been asked so many times.
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

    fn stands(questions: u32, deadline: Duration) -> bool {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let options = ModuleOptions::default();
        let module = Emulated::new(&options, &Eeprom::blank(), &Surroundings::default());
        let (clock, on_for_ns) = (crate::clock::Clock::start(), options.boot_ns);
        let now = move || clock.now_ns() + on_for_ns;
        let memory = Falling { module: SharedModule::new(module, now), questions };
        let options = Bim2AxOptions { deadline, ..Bim2AxOptions::default() };
        let mut module = Card::new("module".into(), memory, options, true);
        runtime.expect("a runtime").block_on(module.stands())
    }

    /// However long it may take to answer: a question that hangs is no look.
    #[test]
    fn a_module_that_falls_silent_is_not_known_to_stand() {
        let patient = Duration::from_secs(3);
        assert!(stands(u32::MAX, patient));
        for questions in [1, 20] {
            assert!(!stands(questions, patient), "{questions}");
        }
    }
}
