//! Sections as drive families read them.

use super::Section;
use std::ops::RangeInclusive;
use twin_drives::family::Keys;

impl Keys for Section<'_> {
    fn has(&self, key: &str) -> bool {
        Section::has(self, key)
    }

    fn keys(&self) -> Vec<String> {
        Section::keys(self).into_iter().map(str::to_owned).collect()
    }

    fn text(&self, key: &str) -> Option<String> {
        Section::text(self, key).map(str::to_owned)
    }

    fn word(&self, key: &str, words: &[&str]) -> Option<usize> {
        let places: Vec<_> = words.iter().enumerate().map(|(place, word)| (*word, place)).collect();
        self.choice(key, &places)
    }

    fn flag(&self, key: &str) -> Option<bool> {
        Section::flag(self, key)
    }

    fn integer(&self, key: &str, range: RangeInclusive<i64>) -> Option<i64> {
        Section::integer(self, key, range)
    }

    fn integers(&self, key: &str, range: &RangeInclusive<i64>, most: usize) -> Vec<i64> {
        Section::integers(self, key, range, most)
    }

    fn number(&self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        Section::number(self, key, range)
    }

    fn table(&self, key: &str) -> Option<Box<dyn Keys + '_>> {
        Section::has(self, key).then(|| Box::new(self.section(key)) as Box<dyn Keys + '_>)
    }

    fn require(&self, key: &str) {
        if !Section::has(self, key) {
            self.complain(format!("{} lacks `{key}`", self.name));
        }
    }

    fn complain(&self, key: &str, message: String) {
        self.complain_at(key, message);
    }

    fn finish(&self) {
        self.check_unknown();
    }
}
