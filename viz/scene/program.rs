//! Program text around the current line, and the page's legend.

use std::collections::VecDeque;

use rerun::TextDocument;

use super::Setup;
use super::clearance::NEAR;
use crate::error::Result;
use crate::recorder::Recorder;
use crate::units::mm;

/// Lines shown before the current one.
const BEFORE: usize = 2;
/// Lines shown after it.
const AFTER: usize = 3;
/// A longer line is cut: the panel is narrow.
const WIDTH: usize = 44;
/// Happenings that are shown below the lines, the last ones.
const NEWS: usize = 4;

/// Shows the lines around the current one.
#[derive(Debug)]
pub(super) struct Excerpt {
    text: String,
    /// Where each line begins in the text.
    begins: Vec<usize>,
    shown: Option<u32>,
    /// What has happened.
    news: VecDeque<String>,
}

impl Excerpt {
    pub(super) fn new(text: &str) -> Self {
        let begins =
            std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { text: text.to_owned(), begins, shown: None, news: VecDeque::new() }
    }

    /// Logs the lines around `line`, from 1, if it is another than the one shown, at the stream's time.
    pub(super) fn log(&mut self, stream: &mut Recorder, line: u32) -> Result<()> {
        if self.shown != Some(line) {
            self.shown = Some(line);
            stream.log("program/here", &TextDocument::from_markdown(self.page(line)))?;
        }
        Ok(())
    }

    /// Logs what has happened at `line`, `time` s after the start, and the lines around it.
    pub(super) fn log_news(
        &mut self,
        stream: &mut Recorder,
        (time, line): (f64, u32),
        what: &str,
    ) -> Result<()> {
        while self.news.len() >= NEWS {
            self.news.pop_front();
        }
        self.news.push_back(format!("**{time:.3} s, line {line}:** {what}"));
        self.shown = None;
        self.log(stream, line)
    }

    /// The lines, and what has happened.
    fn page(&self, line: u32) -> String {
        let mut page = format!("```\n{}```", self.around(line));
        // The newest first: the panel is small.
        for news in self.news.iter().rev() {
            page.push_str("\n\n");
            page.push_str(news);
        }
        page
    }

    fn around(&self, line: u32) -> String {
        let current = usize::try_from(line).unwrap_or(usize::MAX);
        let first = current.saturating_sub(BEFORE).max(1);
        let last = current.saturating_add(AFTER);
        let lines = (first..=last).map_while(|number| Some((number, self.line(number)?))).map(
            |(number, text)| {
                let pointer = if number == current { '▶' } else { ' ' };
                let text: String =
                    text.chars().take(WIDTH).filter(|character| *character != '`').collect();
                [pointer.to_string(), format!(" {number:>5}  "), text, "\n".to_owned()].concat()
            },
        );
        lines.collect()
    }

    /// A line of the program, from 1.
    fn line(&self, number: usize) -> Option<&str> {
        let index = number.checked_sub(1)?;
        let begin = *self.begins.get(index)?;
        let end = self.begins.get(index + 1).map_or(self.text.len(), |next| next - 1);
        let line = self.text.get(begin..end)?;
        // Nothing follows the last line end.
        (begin < self.text.len()).then_some(line.trim_end_matches('\r'))
    }
}

/// Logs what the page shows, in words.
pub(super) fn log_about(stream: &mut Recorder, setup: &Setup<'_>) -> Result<()> {
    let drives =
        setup.drives.map_or_else(String::new, |drives| format!("  \n**Drives** {drives} (orange)"));
    let clearance = setup.clearance.map_or_else(String::new, |_| {
        let near = mm(NEAR);
        format!("  \n**Clearance** of the twin; its nearest points are joined below {near:.0} mm (yellow to red)")
    });
    let about = format!(
        "**Program** {}  \n**Machine** {}  \n**Set-point** where the tool should be (blue)  \n\
         **Twin** where the physics machine has it (green){clearance}{drives}  \n\
         **Programmed** cuts (grey), rapids (yellow), probing moves (dark blue); after preparation (red), where that differs",
        setup.program.name, setup.machine.name
    );
    stream.log_static("about", &TextDocument::from_markdown(about))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_current_line_is_marked_among_its_neighbours() {
        let excerpt = Excerpt::new("%\r\nN10 G0 X0\r\nN20 G1 X5 F10\r\nN30 G2 X0\r\n");
        assert_eq!(
            excerpt.around(2),
            "      1  %\n▶     2  N10 G0 X0\n      3  N20 G1 X5 F10\n      4  N30 G2 X0\n"
        );
        assert_eq!(
            excerpt.around(4),
            "      2  N10 G0 X0\n      3  N20 G1 X5 F10\n▶     4  N30 G2 X0\n"
        );
    }

    #[test]
    fn what_has_happened_stands_below_the_lines() {
        let mut excerpt = Excerpt::new("G0 X0\nG1 X5\n");
        let folder = tempfile::tempdir().unwrap();
        let mut stream = Recorder::create(&folder.path().join("a.rrd"), "a", None).unwrap();
        for (number, what) in ["a", "b", "c", "d", "e"].into_iter().enumerate() {
            let line = u32::try_from(number).unwrap() % 2 + 1;
            excerpt.log_news(&mut stream, (0.5, line), what).unwrap();
        }
        assert_eq!(
            excerpt.page(2),
            "```\n      1  G0 X0\n▶     2  G1 X5\n```\n\n**0.500 s, line 1:** e\n\n**0.500 s, line 2:** d\n\n\
             **0.500 s, line 1:** c\n\n**0.500 s, line 2:** b"
        );
    }

    #[test]
    fn a_line_outside_the_program_shows_nothing_of_its_own() {
        let excerpt = Excerpt::new("G0 X0");
        assert_eq!(excerpt.around(0), "      1  G0 X0\n");
        assert_eq!(excerpt.around(9), "");
        assert_eq!(Excerpt::new("").around(1), "");
    }
}
