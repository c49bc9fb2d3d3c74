//! Times of a task (2.2.2, "Chronométrage de cycle").

/// Times of an axis group's task, ns. They are told, not read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TaskTimes {
    begun_ns: Option<i64>,
    /// `udiTaskMinTime`: shortest time between two calls.
    pub least_ns: Option<i64>,
    /// `udiTaskMaxTime`: longest time between two calls.
    pub most_ns: Option<i64>,
    /// `udiTaskRunTime`: time the last call took.
    pub run_ns: Option<i64>,
    /// `udiTaskMaxRunTime`: longest time a call took.
    pub most_run_ns: Option<i64>,
}

impl TaskTimes {
    /// A call of the task that has begun and ended at these times. Without `debug` (`bDebug`) nothing is measured, and
    /// what was measured before is forgotten when it begins again.
    pub fn call(&mut self, debug: bool, begun_ns: i64, ended_ns: i64) {
        if !debug {
            self.begun_ns = None;
            return;
        }
        let between = self.begun_ns.map(|before| begun_ns.saturating_sub(before));
        let run = ended_ns.saturating_sub(begun_ns);
        *self = match between {
            None => Self { run_ns: Some(run), most_run_ns: Some(run), ..Self::default() },
            Some(between) => Self {
                least_ns: Some(self.least_ns.map_or(between, |least| least.min(between))),
                most_ns: self.most_ns.max(Some(between)),
                run_ns: Some(run),
                most_run_ns: self.most_run_ns.max(Some(run)),
                ..*self
            },
        };
        self.begun_ns = Some(begun_ns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_are_timed() {
        let mut times = TaskTimes::default();
        for (begun, ended) in [(0, 5), (100, 103), (190, 197), (320, 321)] {
            times.call(true, begun, ended);
        }
        let found = (times.least_ns, times.most_ns, times.run_ns, times.most_run_ns);
        assert_eq!(found, (Some(90), Some(130), Some(1), Some(7)));
        times.call(false, 400, 900);
        assert_eq!((times.most_ns, times.run_ns), (Some(130), Some(1)));
        times.call(true, 5000, 5002);
        assert_eq!((times.most_ns, times.most_run_ns), (None, Some(2)));
    }
}
