//! Faults from outside, in every phase of a run: page, disk, pipes, a standstill, signals, SIGKILL.
//!
//! One run has axes on devices of all three families. The devices are in this process and say where the axes are.

use std::{
    collections::HashMap,
    fs::File,
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    process::{Child, ChildStderr, Command},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

use serde_json::Value;
use twin_bim2ax::ModuleAxis;
use twin_interpcnc::BoardAxis;

use crate::{
    desk::{Done, comes},
    shop::Shop,
    soak::words,
};

const RUN: &str = "run outside.cnc -m mixture.toml --drives real --homed --home=U --yes --m-ack 2s --report r.json";

/// All blocks are on one line.
const PROGRAM: &str = "% outside\nN10 G92 X60 Y30 Z-35 U4\n\
                       N20 G0 X150 Y75 Z-5 U24 F100 E400 E-400\n\
                       N30 G1 X60 Y30 Z-35 U4 F50 E300 E-300\nN40 M0\n\
                       N50 G1 X78 Y39 Z-29 U8 F20\n";
/// Length of the line in X, Y, Z and U, mm.
const WAY: [f64; 4] = [90.0, 45.0, 30.0, 20.0];
/// Where the program begins, mm. Z counts from where its device was switched on, at -40 mm.
const START: [f64; 4] = [60.0, 30.0, 5.0, 4.0];
/// End of the program as a part of the line.
const END: f64 = 0.2;
/// Two increments of the coarsest axis, mm.
const TOLERANCE: f64 = 2.0 / 320.0;
/// Runs side by side.
const WORKERS: usize = 5;
/// Runs that may end before their phase comes, on a busy computer; they are made again.
const MOST_EARLY: usize = 2;
/// Way after a standstill or the death of the process, as a part of the line: X with 90 mm/s for the 0.25 s that the
/// devices know of the plan, and its ramp.
const MOST_LEFT: f64 = 0.4;

/// Phase of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// On the way to the start of the program.
    Approach,
    Rapid,
    Cutting,
    /// Waiting at M0.
    Hold,
    /// Braking at the end of the last block.
    End,
}

impl Phase {
    pub(crate) const ALL: [Self; 5] =
        [Self::Approach, Self::Rapid, Self::Cutting, Self::Hold, Self::End];

    /// Waits for it; false if the run ends before.
    fn wait(self, struck: &mut Struck) -> bool {
        let mut lives = true;
        let mut reaches = |holds: &dyn Fn(f64) -> bool| {
            comes(|| {
                lives = lives && struck.child.0.try_wait().expect("it is ours").is_none();
                !lives || holds(positions(&struck.shop)[0])
            });
        };
        reaches(&|x| x > 3.0);
        if self == Self::Approach {
            return lives;
        }
        reaches(&|x| x > 80.0);
        if self == Self::Rapid {
            return lives;
        }
        reaches(&|x| x > 145.0);
        reaches(&|x| x < 135.0);
        if self == Self::Cutting {
            return lives;
        }
        reaches(&|x| x < START[0] + TOLERANCE);
        thread::sleep(Duration::from_millis(300));
        if self == Self::End {
            reaches(&|x| x > 76.5);
        }
        lives
    }
}

/// Fault from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outside {
    /// Clients of the page that send half a head, a body without end, and many requests.
    Page,
    /// No file may become larger.
    FullDisk,
    /// Nobody reads the recording any more.
    UnreadPipe,
    /// Nobody reads standard error any more.
    ClosedOutput,
    /// The process stands still for 3 s.
    Standstill,
    Interrupt,
    Terminate,
    Hangup,
    Killed,
}

impl Outside {
    const ALL: [Self; 9] = [
        Self::Page,
        Self::FullDisk,
        Self::UnreadPipe,
        Self::ClosedOutput,
        Self::Standstill,
        Self::Interrupt,
        Self::Terminate,
        Self::Hangup,
        Self::Killed,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Page => "page: slow, huge, many",
            Self::FullDisk => "disk: full",
            Self::UnreadPipe => "recording: pipe, unread",
            Self::ClosedOutput => "standard error: closed",
            Self::Standstill => "SIGSTOP for 3 s",
            Self::Interrupt => "SIGINT",
            Self::Terminate => "SIGTERM",
            Self::Hangup => "SIGHUP",
            Self::Killed => "SIGKILL",
        }
    }

    /// Expected result.
    fn expected(self) -> Ends {
        match self {
            Self::Page | Self::FullDisk | Self::UnreadPipe | Self::ClosedOutput => Ends::GoesOn,
            Self::Standstill => Ends::Brakes,
            Self::Interrupt | Self::Terminate | Self::Hangup => Ends::Stops,
            Self::Killed => Ends::Dies,
        }
    }
}

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ends {
    /// At the end of the program.
    GoesOn,
    /// On the path, with a report that says where and why.
    Stops,
    /// Each axis on its own ramp, near where it was; the report or the error names the standstill.
    Brakes,
    /// Without report; the axes go to their last targets and rest.
    Dies,
}

impl Ends {
    fn name(self) -> &'static str {
        match self {
            Self::GoesOn => "goes on",
            Self::Stops => "stops",
            Self::Brakes => "brakes",
            Self::Dies => "dies, rests",
        }
    }
}

/// The process of a run, which does not outlive its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // One that has ended cannot be killed.
        let _ended = self.0.kill();
        let _status = self.0.wait();
    }
}

/// A run under a fault.
struct Struck {
    shop: Shop,
    child: Running,
    stderr: Option<BufReader<ChildStderr>>,
    /// What it has written to standard error.
    seen: String,
    /// Open until the run has ended.
    clients: Vec<TcpStream>,
    /// Set when nobody reads the recording any more.
    unread: Arc<AtomicBool>,
}

impl Struck {
    fn start(fault: Outside) -> Self {
        let shop = Shop::new();
        shop.desk.write("outside.cnc", PROGRAM);
        let unread = Arc::new(AtomicBool::new(false));
        if fault == Outside::UnreadPipe {
            drain_until(&shop.desk.path("r.rrd"), &unread);
        }
        let more = match fault {
            Outside::Page => "--serve 127.0.0.1:0",
            Outside::FullDisk | Outside::UnreadPipe => "--record r.rrd --log-axis X=all:x.log",
            _ => "",
        };
        let mut child = shop.desk.command(&format!("{RUN} {more}")).spawn().expect("it starts");
        let stderr = child.stderr.take().map(BufReader::new);
        Self {
            shop,
            child: Running(child),
            stderr,
            seen: String::new(),
            clients: Vec::new(),
            unread,
        }
    }

    /// Reads standard error up to `sign`.
    fn read_until(&mut self, sign: &str) {
        let mut lines = self.stderr.as_mut().expect("it is open").lines().map_while(Result::ok);
        for line in lines.by_ref() {
            self.seen += &line;
            self.seen.push('\n');
            if line.contains(sign) {
                return;
            }
        }
        panic!("`{sign}` does not appear on standard error:\n{}", self.seen);
    }

    fn signal(&self, signal: &str) {
        let process = self.child.0.id().to_string();
        let sent = Command::new("kill").args([signal, &process]).status().expect("kill is there");
        assert!(sent.success(), "it has ended already:\n{}", self.seen);
    }

    fn strike(&mut self, fault: Outside) {
        match fault {
            Outside::Page => self.visit(),
            Outside::FullDisk => {
                let process = self.child.0.id().to_string();
                let mut limit = Command::new("prlimit");
                limit.args(["--fsize=20000", "--pid", &process]);
                assert!(limit.status().expect("prlimit is there").success());
            }
            Outside::UnreadPipe => self.unread.store(true, Ordering::SeqCst),
            Outside::ClosedOutput => drop(self.stderr.take()),
            Outside::Standstill => {
                self.signal("-STOP");
                thread::sleep(Duration::from_secs(3));
                self.signal("-CONT");
            }
            Outside::Interrupt => self.signal("-INT"),
            Outside::Terminate => self.signal("-TERM"),
            Outside::Hangup => self.signal("-HUP"),
            Outside::Killed => self.signal("-KILL"),
        }
    }

    /// Opens connections that stay, and asks for the page many times.
    fn visit(&mut self) {
        let address = self.seen.split("http://").nth(1).and_then(|rest| rest.split('/').next());
        let address = address.expect("an address").to_owned();
        let connect = || TcpStream::connect(&address).expect("it listens");
        let endless =
            format!("POST / HTTP/1.1\r\nHost: {address}\r\nContent-Length: 99999999999\r\n\r\n");
        for head in [endless.as_bytes(), b"GET / HTTP/1.1\r\nHo"] {
            for _ in 0..50 {
                let mut client = connect();
                // One that is refused is closed at once.
                let _refused = client.write_all(head);
                self.clients.push(client);
            }
        }
        let mut answered = 0;
        for _ in 0..300 {
            let mut client = connect();
            let asked = format!("GET / HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
            let _refused = client.write_all(asked.as_bytes());
            let mut answer = Vec::new();
            let _refused = client.read_to_end(&mut answer);
            answered += u32::from(answer.starts_with(b"HTTP/1.1 200 "));
        }
        assert!(answered > 0, "nobody answers");
    }

    /// Waits for its end.
    fn finish(mut self) -> (Shop, Done) {
        if !self.clients.is_empty() {
            // The page stays open until SIGINT.
            comes(|| self.shop.desk.path("r.json").exists());
            self.signal("-INT");
        }
        let mut stderr = self.stderr.take();
        let mut stdout = self.child.0.stdout.take().expect("piped");
        let reads = thread::Builder::new().name("standard error".to_owned()).spawn(move || {
            let mut text = String::new();
            let read = stderr.as_mut().map(|stderr| stderr.read_to_string(&mut text));
            read.transpose().map(|_| text)
        });
        let written = thread::Builder::new().name("standard output".to_owned()).spawn(move || {
            let mut text = String::new();
            stdout.read_to_string(&mut text).map(|_| text)
        });
        comes(|| self.child.0.try_wait().expect("it is ours").is_some());
        let status = self.child.0.wait().expect("it has ended").code();
        let more = reads.expect("a thread").join().expect("it ends").expect("text");
        let written = written.expect("a thread").join().expect("it ends").expect("text");
        (self.shop, Done { status, stdout: written, stderr: self.seen + &more })
    }
}

/// Makes a pipe and reads it until `unread` is set; it stays open.
fn drain_until(path: &Path, unread: &Arc<AtomicBool>) {
    let made = Command::new("mkfifo").arg(path).status().expect("mkfifo is there");
    assert!(made.success());
    let mut pipe = File::options().read(true).write(true).open(path).expect("a pipe");
    let unread = Arc::clone(unread);
    let read = move || {
        let mut bytes = vec![0; 1 << 16];
        while !unread.load(Ordering::SeqCst) {
            assert_ne!(pipe.read(&mut bytes).expect("it is open for writing"), 0);
        }
        thread::sleep(Duration::from_secs(30));
    };
    thread::Builder::new().name("reader".to_owned()).spawn(read).expect("a thread");
}

/// Positions of X, Y, Z and U by their devices, mm.
fn positions(shop: &Shop) -> [f64; 4] {
    let board = shop.board.look().expect("it runs");
    let [x, y] = [BoardAxis::X, BoardAxis::Y].map(|axis| board.position(axis) / 320.0);
    let bus = shop.bus.borrow();
    let drives = bus.as_ref().expect("it is there").look().expect("it runs");
    let u = shop.module.module().position(ModuleAxis::One) / 320.0;
    [x, y, f64::from(drives[0].counter()) / 640.0, u]
}

/// Checks where an axis rests, which was at `struck` when the fault came.
fn check_axis(
    axis: usize,
    (struck, found): ([f64; 4], [f64; 4]),
    phase: Phase,
    ends: Ends,
) -> Result<(), String> {
    let at = found[axis];
    let is_left_near = (at - struck[axis]).abs() <= MOST_LEFT * WAY[axis];
    let near = |due: f64| (at - due).abs() <= TOLERANCE;
    let within = |low: f64, high: f64| (low - TOLERANCE..=high + TOLERANCE).contains(&at);
    let end = START[axis] + WAY[axis];
    let right = match ends {
        Ends::GoesOn => near(START[axis] + END * WAY[axis]),
        Ends::Brakes | Ends::Dies if !is_left_near => false,
        _ if phase == Phase::Approach => within(0.0, START[axis]),
        // On the line, where X is.
        Ends::Stops => {
            near(START[axis] + (found[0] - START[0]) / WAY[0] * WAY[axis])
                && within(START[axis], end)
        }
        Ends::Brakes | Ends::Dies => within(START[axis], end),
    };
    let name = ["X", "Y", "Z", "U"][axis];
    let (before, x) = (struck[axis], found[0]);
    if right {
        Ok(())
    } else {
        Err(format!("{name} went from {before:.3} to {at:.3} mm; X is at {x:.3}"))
    }
}

/// A run's end, and what is wrong with its device of each family.
type Outcome = (Ends, [Result<(), String>; 3]);

/// One run; none if it ends before the phase.
fn trial(fault: Outside, phase: Phase) -> Option<Outcome> {
    let mut struck = Struck::start(fault);
    struck.read_until("axis U is home");
    if !phase.wait(&mut struck) {
        return None;
    }
    let before = positions(&struck.shop);
    struck.strike(fault);
    let (shop, done) = struck.finish();
    let mut wanted = fault.expected();
    let Done { status, stdout, stderr } = &done;
    let said = format!("status {status:?}\n{stdout}\n{stderr}");
    let report = match std::fs::read_to_string(shop.desk.path("r.json")) {
        Ok(text) => serde_json::from_str(&text).ok(),
        Err(_) => serde_json::Deserializer::from_str(stdout)
            .into_iter::<Value>()
            .next()
            .and_then(Result::ok),
    };
    match (wanted, &report) {
        (Ends::Dies, report) => assert!(status.is_none() && report.is_none(), "{said}"),
        (_, None) => panic!("no report: {said}"),
        (_, Some(report)) => {
            if phase == Phase::End && report["completed"] == true {
                // It had been planned to its end.
                wanted = Ends::GoesOn;
            }
            assert_eq!(report["completed"], wanted == Ends::GoesOn, "{report:#}\n{said}");
            let findings = report["findings"].as_array().expect("findings");
            let early = findings.iter().any(|finding| finding["rule"] == "recording-ended");
            let failed = early || wanted != Ends::GoesOn;
            assert_eq!(*status, Some(if failed { 2 } else { 0 }), "{said}");
            let spoilt = matches!(fault, Outside::FullDisk | Outside::UnreadPipe);
            // At the end a pipe takes what is left.
            assert!(early == spoilt || spoilt && phase == Phase::End, "{said}");
            if wanted == Ends::Stops {
                let reason = report["stopped_because"].as_str().unwrap_or_default();
                assert!(reason.starts_with("stopped by the user"), "{reason}\n{said}");
            }
            if wanted == Ends::Brakes {
                done.reports(&["look first for what stopped this process"]);
            }
        }
    }
    if wanted == Ends::Dies {
        shop.others_come_to_rest();
    }
    let found = shop.at_rest().map(|at| at.expect("it is there"));
    let axis = |axis| check_axis(axis, (before, found), phase, wanted);
    Some((wanted, [axis(0).and(axis(1)), axis(2), axis(3)]))
}

/// Families of X and Y, Z, and U.
const FAMILIES: [&str; 3] = ["InterpCnc", "SmartDrive", "Bim2Ax"];

/// Runs the cells whose name contains `wanted`, prints them as rows of the table and returns the failures.
pub(crate) fn outside_faults(wanted: &str) -> Vec<String> {
    let name = |fault: Outside, phase: Phase| format!("outside/{}/{phase:?}", fault.name());
    let cells = Outside::ALL.into_iter().flat_map(|fault| Phase::ALL.map(|phase| (fault, phase)));
    let cells: Vec<_> =
        cells.filter(|(fault, phase)| name(*fault, *phase).contains(wanted)).collect();
    let next = AtomicUsize::new(0);
    let early = AtomicUsize::new(0);
    let made = Mutex::new(HashMap::new());
    let work = || {
        while let Some((fault, phase)) = cells.get(next.fetch_add(1, Ordering::SeqCst)) {
            let attempt = || catch_unwind(AssertUnwindSafe(|| trial(*fault, *phase)));
            let mut outcome = attempt();
            while matches!(outcome, Ok(None)) && early.fetch_add(1, Ordering::SeqCst) < MOST_EARLY {
                outcome = attempt();
            }
            let failed = |why: &str| (fault.expected(), [(); 3].map(|()| Err(why.to_owned())));
            let outcome = match outcome {
                Ok(Some(outcome)) => outcome,
                Ok(None) => failed("the run ends before"),
                Err(panic) => failed(words(&*panic)),
            };
            made.lock().expect("cells").insert(name(*fault, *phase), outcome);
        }
    };
    thread::scope(|scope| {
        for worker in 0..WORKERS {
            let name = format!("outside {worker}");
            thread::Builder::new().name(name).spawn_scoped(scope, work).expect("a thread");
        }
    });
    let made = made.into_inner().expect("cells");
    let mut wrong = Vec::new();
    println!(
        "{:<30} {:<11} {}",
        "fault from outside",
        "family",
        Phase::ALL.map(|phase| format!("{:<24}", format!("{phase:?}"))).concat()
    );
    for fault in Outside::ALL {
        for (place, family) in FAMILIES.into_iter().enumerate() {
            let cell = |phase: Phase| {
                let name = name(fault, phase);
                let Some((ends, outcomes)) = made.get(&name) else { return format!("{:<24}", "") };
                let ends = ends.name();
                if let Err(why) = &outcomes[place] {
                    wrong.push(format!("{name}, {family}: {ends} expected, {why}"));
                    return format!("! {ends:<22}");
                }
                format!("{ends:<24}")
            };
            println!("{:<30} {family:<11} {}", fault.name(), Phase::ALL.map(cell).concat());
        }
    }
    println!("{} runs, {} not as expected", made.len(), wrong.len());
    wrong
}
