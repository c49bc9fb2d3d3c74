//! XML writer.

use std::fmt::Display;

/// XML that grows.
#[derive(Debug, Default)]
pub(super) struct Xml {
    text: String,
    /// Elements that are open.
    open: Vec<&'static str>,
    /// True if the last of them is still without content.
    is_bare: bool,
}

impl Xml {
    /// Begins an element within the one that is open.
    pub(super) fn open(&mut self, element: &'static str) -> &mut Self {
        self.fill();
        self.indent();
        self.text.push('<');
        self.text.push_str(element);
        self.open.push(element);
        self.is_bare = true;
        self
    }

    /// Adds an attribute to the element that has just been opened.
    pub(super) fn attribute(&mut self, name: &str, value: impl Display) -> &mut Self {
        self.text.extend([" ", name, "=\""]);
        for character in value.to_string().chars() {
            match character {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '>' => self.text.push_str("&gt;"),
                '"' => self.text.push_str("&quot;"),
                // Readers take them for blanks in an attribute.
                '\n' | '\r' | '\t' => {
                    self.text.extend(["&#", &u32::from(character).to_string(), ";"]);
                }
                character => self.text.push(character),
            }
        }
        self.text.push('"');
        self
    }

    /// Numbers with blanks between them; −0 is written as 0.
    pub(super) fn numbers<const N: usize>(&mut self, name: &str, values: [f64; N]) -> &mut Self {
        self.attribute(name, values.map(|value| (value + 0.0).to_string()).join(" "))
    }

    /// Ends the element that was opened last.
    pub(super) fn close(&mut self) {
        let Some(element) = self.open.pop() else { return };
        if self.is_bare {
            self.text.push_str("/>\n");
            self.is_bare = false;
        } else {
            self.indent();
            self.text.extend(["</", element, ">\n"]);
        }
    }

    /// The whole text, with every element ended.
    pub(super) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn fill(&mut self) {
        if self.is_bare {
            self.text.push_str(">\n");
            self.is_bare = false;
        }
    }

    fn indent(&mut self) {
        self.open.iter().for_each(|_| self.text.push_str("  "));
    }
}
