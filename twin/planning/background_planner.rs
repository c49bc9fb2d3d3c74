//! Background planner: axis-limited planning in its own thread while the run executes the plan.

use crate::finding::Finding;
use crate::limit::{LimitFailure, LimitRules, planner};
use crate::program::{Findings, Halt, Prepared, ProgramFile};
use std::collections::VecDeque;
use std::io;
use std::iter::Map;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::thread::Scope;
use twin_machine::Machine;
use twin_path::prepare::CheckedElement;
use twin_planner::time_optimal::{
    Arrival, Lead, LimitError, Piece, Pieces, PlanExecutor, Planned, Replan, Request,
};

/// Fault of the program. It may be reported again after another override.
pub(super) type Fault = Arc<Halt>;

type Share = fn(Result<CheckedElement, Halt>) -> Result<CheckedElement, Fault>;

/// Requests that may be under way; what comes then waits.
const REQUESTS: usize = 16;

/// Makes the plan.
#[derive(Debug)]
struct Maker<'m> {
    pieces: Pieces<Map<Prepared, Share>, Fault, crate::limit::MachinePath<'m>>,
    found: Findings,
}

impl<'m> Maker<'m> {
    fn new(machine: &'m Machine, program: &ProgramFile) -> Result<Self, LimitFailure> {
        let (path, found) = program.path_for_limits(&machine.conditions)?;
        let share: Share = |next| next.map_err(Arc::new);
        let factor = program.settings().inputs.override_factor.factor();
        let planner = planner(path.map(share), machine, LimitRules::default(), (factor, true))?;
        Ok(Self { pieces: Pieces::new(planner), found })
    }

    fn next(&mut self) -> Message {
        let piece = self.pieces.next_piece();
        Message { piece, findings: std::iter::from_fn(|| self.found.take()).collect() }
    }
}

/// What comes from the maker.
#[derive(Debug)]
struct Message {
    piece: Piece<Fault>,
    findings: Vec<Finding>,
}

/// The way to the maker.
#[derive(Debug)]
enum Link<'m> {
    Here(Box<Maker<'m>>),
    Thread {
        messages: Receiver<Message>,
        requests: SyncSender<Request<Fault>>,
        /// Items below this number are not asked back.
        needs: Arc<AtomicU64>,
    },
    /// Nothing comes any more.
    Gone,
}

/// A plan that is executed while it is made.
#[derive(Debug)]
pub(super) struct BackgroundPlanner<'m> {
    spliced: PlanExecutor<Fault>,
    link: Link<'m>,
    /// A request that has found no room.
    unsent: Option<Request<Fault>>,
    findings: VecDeque<Finding>,
    /// True if it waits for a piece that is not planned yet.
    pub(super) waits: bool,
}

impl<'m> BackgroundPlanner<'m> {
    /// Planned when it is needed.
    pub(super) fn here(machine: &'m Machine, program: &ProgramFile) -> Result<Self, LimitFailure> {
        Ok(Self::over(Link::Here(Box::new(Maker::new(machine, program)?))))
    }

    /// Planned in a thread of `scope`, which ends when this is dropped.
    pub(super) fn thread<'scope>(
        scope: &'scope Scope<'scope, '_>,
        machine: &'m Machine,
        program: &'scope ProgramFile,
    ) -> Result<Self, LimitFailure>
    where
        'm: 'scope,
    {
        // One piece waits while another is made.
        let (sender, messages) = sync_channel(1);
        let (requests, asked) = sync_channel(REQUESTS);
        let (opened, whether_opened) = sync_channel(1);
        let needs = Arc::new(AtomicU64::new(0));
        let needed = Arc::clone(&needs);
        let plan = move || {
            // Where that is refused, it is as it was.
            crate::priority::ordinary().unwrap_or_default();
            match Maker::new(machine, program) {
                Ok(maker) => {
                    opened.send(Ok(())).unwrap_or_default();
                    make(maker, &sender, &asked, &needed);
                }
                Err(failure) => opened.send(Err(failure)).unwrap_or_default(),
            }
        };
        std::thread::Builder::new().name("planner".to_owned()).spawn_scoped(scope, plan)?;
        let gone = |_| LimitFailure::Read(io::Error::other("its thread has ended"));
        whether_opened.recv().map_err(gone)??;
        Ok(Self::over(Link::Thread { messages, requests, needs }))
    }

    fn over(link: Link<'m>) -> Self {
        let spliced = PlanExecutor::new(Lead::default());
        Self { spliced, link, unsent: None, findings: VecDeque::new(), waits: true }
    }

    /// True if nothing of the plan is there yet.
    pub(super) fn is_pending(&mut self) -> bool {
        self.exchange();
        self.spliced.is_new() && !matches!(self.link, Link::Gone)
    }

    /// The next thing found in the program.
    pub(super) fn found(&mut self) -> Option<Finding> {
        self.findings.pop_front()
    }

    /// True if the path follows the last request.
    pub(super) fn follows(&self) -> bool {
        self.spliced.follows()
    }

    /// Number of plans that came too late so far.
    pub(super) fn late(&self) -> u64 {
        self.spliced.late()
    }

    fn send(&mut self, request: Request<Fault>) {
        match &mut self.link {
            Link::Here(maker) => maker.pieces.obey(request),
            Link::Thread { requests, .. } => match requests.try_send(request) {
                Ok(()) => self.unsent = None,
                Err(TrySendError::Full(request)) => self.unsent = Some(request),
                Err(TrySendError::Disconnected(_)) => self.link = Link::Gone,
            },
            Link::Gone => {}
        }
    }

    /// Takes over what has been planned, and asks for what is missing.
    fn exchange(&mut self) {
        if let Some(request) = self.unsent.take() {
            self.send(request);
        }
        while self.spliced.wants_more() {
            let message = match &mut self.link {
                Link::Here(maker) => {
                    maker.pieces.forget(self.spliced.needs());
                    maker.next()
                }
                Link::Thread { messages, needs, .. } => {
                    needs.store(self.spliced.needs(), Ordering::Relaxed);
                    let next = if self.waits {
                        messages.recv().map_err(|_gone| TryRecvError::Disconnected)
                    } else {
                        messages.try_recv()
                    };
                    match next {
                        Ok(message) => message,
                        Err(TryRecvError::Empty) => break,
                        Err(TryRecvError::Disconnected) => {
                            self.link = Link::Gone;
                            return;
                        }
                    }
                }
                Link::Gone => return,
            };
            self.findings.extend(message.findings);
            if self.spliced.receive(message.piece) == Arrival::Late {
                let request = self.spliced.ask_again();
                self.send(request);
            }
        }
        if self.spliced.is_starving() {
            let request = self.spliced.ask_again();
            self.send(request);
        }
    }
}

/// Plans on until nobody wants it any more.
fn make(
    mut maker: Maker<'_>,
    sender: &SyncSender<Message>,
    asked: &Receiver<Request<Fault>>,
    needed: &AtomicU64,
) {
    loop {
        let waiting = if maker.pieces.is_resting() {
            let Ok(first) = asked.recv() else { return };
            Some(first)
        } else {
            None
        };
        // The last is what counts.
        if let Some(request) = asked.try_iter().last().or(waiting) {
            maker.pieces.obey(request);
        }
        maker.pieces.forget(needed.load(Ordering::Relaxed));
        if sender.send(maker.next()).is_err() {
            return;
        }
    }
}

impl Iterator for BackgroundPlanner<'_> {
    type Item = Result<Planned, LimitError<Fault>>;

    fn next(&mut self) -> Option<Self::Item> {
        self.exchange();
        match self.spliced.take() {
            // Nothing will ever let it go on.
            Some(Ok(Planned::Hold { .. })) if matches!(self.link, Link::Gone) => None,
            next => next,
        }
    }
}

impl Replan for BackgroundPlanner<'_> {
    fn set_override(&mut self, factor: f64) {
        let request = self.spliced.set_override(factor);
        self.send(request);
    }

    fn abandon(&mut self) {
        self.link = Link::Gone;
    }
}
