//! Result table: times and errors side by side.

use crate::machines::PERIOD;

/// A machine.
pub struct Row {
    pub name: String,
    /// s per period, by rounds.
    pub ours: Vec<f64>,
    /// Of the tip, m.
    pub error: f64,
    pub theirs: Vec<f64>,
    pub peer_error: Option<f64>,
}

/// Prints the head of the table.
pub fn head() {
    println!(
        "With collisions on; µs per 1 ms, median (least–most); error of the tip against the exact solution, µm.\n\
         {:16}{:^24}{:>9} |{:^26}{:>9} |{:^20} | {:>11}",
        "machine", "ours", "error", "MuJoCo, RK4", "error", "ratio", "× real time"
    );
}

impl Row {
    pub fn print(&self) {
        let ratios = self.theirs.iter().zip(&self.ours).map(|(theirs, ours)| theirs / ours);
        let (theirs, ratio) = if self.theirs.is_empty() {
            ("–".to_owned(), "–".to_owned())
        } else {
            (micro(self.theirs.iter().copied()), spread(ratios, 2))
        };
        let error = |error: f64| format!("{:.1e}", error * 1e6);
        let fast = spread(self.ours.iter().map(|ours| PERIOD / ours), 0);
        println!(
            "{:16}{:^24}{:>9} |{:^26}{:>9} |{:^20} | {fast}",
            self.name,
            micro(self.ours.iter().copied()),
            error(self.error),
            theirs,
            self.peer_error.map_or("–".to_owned(), error),
            ratio,
        );
    }
}

fn micro(seconds: impl Iterator<Item = f64>) -> String {
    spread(seconds.map(|seconds| seconds * 1e6), 2)
}

/// Median, least and most.
fn spread(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    match values.as_slice() {
        [] => String::new(),
        [least, .., most] | [least @ most] => {
            let middle = values[values.len() / 2];
            format!("{middle:.digits$} ({least:.digits$}–{most:.digits$})")
        }
    }
}
