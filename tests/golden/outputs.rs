//! Recording, log and report of a run on a disk that is full, slow, gone or limited: the run goes on, and says so.

use crate::desk::{Desk, Done, has_keys, started};
use crate::recording::{RECORDING, chunks, series};
use serde_json::Value;
use std::fs::File;
use std::process::{Child, Command};
use std::time::Duration;

/// Three circles, 6 s.
const CIRCLES: &str = "% circles\nN10 G2 I30 J0 F100 E500 E-500\nN20 G2 I30 J0\nN30 G2 I30 J0\n";
const RUN: &str = "run circles.cnc --machine machine.toml";

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("circles.cnc", CIRCLES);
    desk
}

/// Ends within a minute.
#[track_caller]
fn ended(mut command: Command) -> Done {
    let mut child: Child = command.spawn().expect("the binary starts");
    for _ in 0..600 {
        if child.try_wait().expect("it can be waited for").is_some() {
            return Done::from(child.wait_with_output().expect("it has ended"));
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    child.kill().expect("it can be killed");
    panic!("it does not end");
}

/// `twin run` with files of this size at most, in blocks of 512 bytes.
fn limited(desk: &Desk, blocks: u32, line: &str) -> Done {
    let twin = desk.command(line);
    let mut shell = started("sh");
    shell.arg("-c").arg(format!("ulimit -f {blocks} && exec \"$0\" \"$@\""));
    shell.arg(twin.get_program()).args(twin.get_args()).current_dir(desk.path(""));
    shell.stdin(std::process::Stdio::null());
    shell.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
    ended(shell)
}

/// The findings of a report that are about its outputs.
fn early(report: &Value) -> Vec<&str> {
    let findings = report["findings"].as_array().expect("findings");
    let early = findings.iter().filter(|finding| finding["rule"] == "recording-ended");
    early.map(|finding| finding["message"].as_str().expect("a message")).collect()
}

/// The report on standard output, before the summary.
fn printed(done: &Done) -> Value {
    let mut values = serde_json::Deserializer::from_str(&done.stdout).into_iter();
    values.next().expect("a report").unwrap_or_else(|error| panic!("{error}: {}", done.stdout))
}

/// The time in a message, ms.
fn time_ms(message: &str) -> i64 {
    let (_, rest) = message.split_once(" ended at ").expect("a time");
    // It has three digits behind the point.
    rest.split_once(" s: ").expect("seconds").0.replace('.', "").parse().expect("a number")
}

#[test]
fn recording_and_log_beyond_the_file_size_limit_end_and_the_run_goes_on() {
    let desk = desk();
    let files = "--drives none --record r.rrd --log-axis X=all:x.log --report r.json";
    let done = limited(&desk, 300, &format!("{RUN} {files}"));
    done.ended(2, "recording-ended").reports(&["File too large"]).says("fit: 0 errors, 2 warnings");
    let report = desk.read("r.json");
    assert_eq!(report["completed"], true);
    let messages = early(&report);
    assert!(messages.iter().all(|message| message.contains("records lost")), "{messages:?}");
    let about = |what: &str| messages.iter().find(|it| it.starts_with(what)).expect("a finding");
    // What was written before is there, and whole: values come in batches of 2 s of the program.
    let (time, _) = *series(&chunks(&desk), "error/tool/twin").last().expect("a value");
    let ended_ns = time_ms(about("the recording r.rrd ended at ")) * 1_000_000;
    assert!(time <= ended_ns && ended_ns < 6_500_000_000, "{time} {messages:?}");
    let log = desk.text("x.log");
    assert!(log.len() > 100_000 && log.len() <= 300 * 512 && log.ends_with("\r\n"));
    // A record per millisecond, from 0 on.
    let logged = time_ms(about("the log x.log ended at "));
    let count = i64::try_from(log.lines().count()).expect("few");
    assert!((count - logged).abs() <= 1, "{messages:?}");
    let lines = log.lines().all(|line| line.split('\t').count() == 6);
    assert!(lines, "a record is cut");
}

#[test]
fn outputs_that_nobody_reads_end_with_the_run() {
    let desk = desk();
    for name in ["r", "x", "y"] {
        let made = Command::new("mkfifo").arg(desk.path(name)).status().expect("mkfifo is there");
        assert!(made.success());
    }
    // It is open, so that it takes what fits into it; the others are not.
    let open = File::options().read(true).write(true).open(desk.path("r")).expect("a pipe");
    for drives in ["--drives none", "--drives none --realtime"] {
        let files = "--record r --log-axis X=all:x --report y";
        let done = ended(desk.command(&format!("{RUN} {drives} {files}")));
        done.ended(2, "or nobody reads it").says("fit: 0 errors, 2 warnings");
        let report = printed(&done);
        assert_eq!(report["completed"], true);
        let kinds: Vec<_> = early(&report).iter().map(|it| &it[..it.len().min(12)]).collect();
        assert_eq!(kinds, ["the recordin", "the log x en", "the report y"]);
        has_keys(&report["axis_error"], "X Y Z");
    }
    drop(open);
}

#[test]
fn a_report_on_a_full_disk_is_printed() {
    let desk = desk();
    let done = desk.twin(&format!("{RUN} --drives none --report /dev/full"));
    let report = printed(&done);
    let time = format!("the report /dev/full ended at {} s: ", report["executed_s"]);
    done.ended(2, &time).reports(&["No space left on device"]);
    assert_eq!((early(&report).len(), &report["completed"]), (1, &Value::Bool(true)));
    // So is one of a program that is not fit.
    desk.write("unfit.cnc", "% unfit\nN10 G1 X300 F500 E2000 E-2000\n");
    let done = desk.twin(
        "run unfit.cnc --machine machine.toml --limits programmed --drives none --report /dev/full",
    );
    assert_eq!(printed(done.ended(2, "No space left on device"))["completed"], false);
}

#[test]
fn outputs_in_a_folder_that_is_removed_end_with_the_run() {
    let desk = desk();
    std::fs::create_dir(desk.path("stick")).expect("a folder");
    let files = "--record stick/r.rrd --log-axis X=all:stick/x.log --report stick/r.json";
    let run = format!("{RUN} --drives none --realtime {files}");
    let gone = || {
        std::thread::sleep(Duration::from_secs(1));
        std::fs::remove_dir_all(desk.path("stick")).expect("removed");
    };
    let done = desk.meanwhile("-INT", "is read as", &run, gone);
    done.ended(2, "the recording stick/r.rrd ended").reports(&["the log stick/x.log ended"]);
    assert_eq!(early(&printed(&done)).len(), 3, "{}", done.stderr);
}

#[test]
fn a_run_that_is_killed_leaves_no_temporary_file() {
    let desk = desk();
    let run = format!("{RUN} --drives none --realtime --log-axis X=all:x.log");
    desk.interrupted("-KILL", "is read as", &run);
    let names = std::fs::read_dir(desk.path("")).expect("a folder");
    let names: Vec<_> = names.map(|entry| entry.expect("an entry").file_name()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
}

#[test]
fn equal_simulated_runs_make_equal_recordings() {
    let desk = desk();
    let record = |file: &str, more: &str| {
        let run = format!("{RUN} --drives none {more} --record {file}");
        assert_eq!(desk.twin(&run).status, Some(0));
        std::fs::read(desk.path(file)).expect("a recording")
    };
    let [one, two] = [RECORDING, "other.rrd"].map(|file| record(file, ""));
    assert!(one == two && one.len() > 100_000, "{} and {} bytes", one.len(), two.len());
    // Another run is another recording for the viewer.
    assert!(record("slow.rrd", "--override-at 1s=50") != one);
}
