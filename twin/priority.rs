//! Thread priority: real-time scheduling for threads that talk to drives, ordinary scheduling for long computations.

use thread_priority::unix::{set_thread_priority_and_policy, thread_native_id};
use thread_priority::{
    Error, NormalThreadSchedulePolicy, RealtimeThreadSchedulePolicy, ThreadPriority,
    ThreadPriorityValue, ThreadSchedulePolicy,
};

/// Above everything that is not real-time, below what the kernel runs in threads of its own.
const PRIORITY: u8 = 10;

/// As nice as any other program.
const ORDINARY: u8 = 48;

/// Gives the calling thread ordinary scheduling, for long computations in threads that a real-time thread has started.
///
/// # Errors
/// Systems on which threads cannot be distinguished.
pub fn ordinary() -> Result<(), Error> {
    let value = ThreadPriorityValue::try_from(ORDINARY)
        .map_or(ThreadPriority::Min, ThreadPriority::Crossplatform);
    let policy = ThreadSchedulePolicy::Normal(NormalThreadSchedulePolicy::Other);
    set_thread_priority_and_policy(thread_native_id(), value, policy)
}

/// Runs the calling thread, and the threads it will start, before every ordinary thread of the computer
/// (`SCHED_FIFO`): a drive that is not spoken to for a tenth of a second is a tenth of a second behind the plan.
///
/// # Errors
/// Most users may not do this; the run then goes on at the mercy of what else the computer does.
pub fn real_time() -> Result<(), Error> {
    let value = ThreadPriorityValue::try_from(PRIORITY)
        .map_or(ThreadPriority::Min, ThreadPriority::Crossplatform);
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    set_thread_priority_and_policy(thread_native_id(), value, policy)
}
