//! Assumptions of a family where its manual is silent: one table gives options, names, values and open questions.
//!
//! [`assumptions!`] makes the table of a family the type that its driver and emulator share, its names in machine files and
//! on the command line (`name = value`), and the list of questions.

use std::{fmt::Display, ops::RangeInclusive, str::FromStr, time::Duration};

/// A question that a manual leaves open, what is assumed, and the option that decides otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenQuestion {
    /// Line of the family's digest on which the assumption is; 0 for those that came up later.
    pub line: u16,
    /// The question.
    pub question: &'static str,
    /// The option, as `Type.field`. Fields of `Assumptions` are the same on both sides.
    pub option: &'static str,
    /// Its default as `Debug` shows it; for a field of `Assumptions` as the table has it.
    pub default: &'static str,
    /// Other answers.
    pub alternatives: &'static str,
    /// Consequence for the client.
    pub driver: &'static str,
}

/// Values of an assumption.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AssumedValues {
    /// All values, in words.
    pub allowed: String,
    /// The default, as [`Assumed::set`] takes it.
    pub usual: String,
    /// The unit of a number, or what it counts; empty for others.
    pub unit: &'static str,
}

/// The assumptions of a family, by name.
pub trait Assumed: Default + PartialEq {
    /// Names, those of the fields.
    const NAMES: &'static [&'static str];
    /// Questions that the manual of the family leaves open.
    const QUESTIONS: &'static [OpenQuestion];

    /// Assumes something else. `-` in a name is as good as `_`.
    ///
    /// # Errors
    /// If the assumption does not exist, or it cannot be so.
    fn set(&mut self, name: &str, value: &str) -> Result<(), AssumedError>;

    /// Values of an assumption; `None` for an unknown name.
    fn values(name: &str) -> Option<AssumedValues>;

    /// The question that an assumption answers.
    fn question(name: &str) -> Option<&'static OpenQuestion> {
        let of = |option: &str| option.strip_prefix("Assumptions.") == Some(name);
        Self::QUESTIONS.iter().find(|question| of(question.option))
    }
}

/// Error of an assumption.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AssumedError {
    /// There is no such assumption.
    #[error("there is no assumption `{name}`; there are {}", known.join(", "))]
    Unknown {
        /// Text that was asked for.
        name: String,
        /// All there are.
        known: &'static [&'static str],
    },
    /// It cannot be so.
    #[error("{name} = `{value}`: it can be {allowed}")]
    Value {
        /// The assumption.
        name: String,
        /// Text that was asked for.
        value: String,
        /// Possible values.
        allowed: String,
    },
}

/// Text form of the values of an option.
pub trait TextForm<T> {
    /// The value that a text means.
    fn read(&self, text: &str) -> Option<T>;

    /// A value as text.
    fn write(&self, value: &T) -> String;

    /// All values, in words.
    fn allowed(&self) -> String;

    /// The unit of a number.
    fn unit(&self) -> &'static str {
        ""
    }

    /// Everything about it.
    fn values(&self, usual: &T) -> AssumedValues {
        AssumedValues { allowed: self.allowed(), usual: self.write(usual), unit: self.unit() }
    }
}

/// One of some values, by name.
#[derive(Clone, Debug)]
pub struct Choice<T: 'static>(pub &'static [(&'static str, T)]);

/// Yes or no.
pub const FLAG: Choice<bool> = Choice(&[("true", true), ("false", false)]);

impl<T: Copy + PartialEq> TextForm<T> for Choice<T> {
    fn read(&self, text: &str) -> Option<T> {
        let text = text.replace('_', "-");
        self.0.iter().find(|(name, _)| name.eq_ignore_ascii_case(&text)).map(|(_, value)| *value)
    }

    fn write(&self, value: &T) -> String {
        let named = self.0.iter().find(|(_, known)| known == value);
        named.map_or("", |(name, _)| name).to_owned()
    }

    fn allowed(&self) -> String {
        let names: Vec<_> = self.0.iter().map(|(name, _)| *name).collect();
        names.join(" or ")
    }
}

/// A number of a range, with its unit.
#[derive(Clone, Debug)]
pub struct Number<T>(pub RangeInclusive<T>, pub &'static str);

impl<T: FromStr + PartialOrd + Display> TextForm<T> for Number<T> {
    fn read(&self, text: &str) -> Option<T> {
        text.parse().ok().filter(|number| self.0.contains(number))
    }

    fn write(&self, value: &T) -> String {
        value.to_string()
    }

    fn allowed(&self) -> String {
        format!("{} to {}", self.0.start(), self.0.end())
    }

    fn unit(&self) -> &'static str {
        self.1
    }
}

/// A time in whole microseconds.
#[derive(Clone, Debug)]
pub struct Microseconds(pub RangeInclusive<u64>);

impl TextForm<Duration> for Microseconds {
    fn read(&self, text: &str) -> Option<Duration> {
        let number = text.parse().ok().filter(|number| self.0.contains(number));
        number.map(Duration::from_micros)
    }

    fn write(&self, value: &Duration) -> String {
        value.as_micros().to_string()
    }

    fn allowed(&self) -> String {
        format!("{} to {}", self.0.start(), self.0.end())
    }

    fn unit(&self) -> &'static str {
        "µs"
    }
}

/// A value, or `none`.
#[derive(Clone, Debug)]
pub struct OrNone<F>(pub F);

impl<T, F: TextForm<T>> TextForm<Option<T>> for OrNone<F> {
    fn read(&self, text: &str) -> Option<Option<T>> {
        if text.eq_ignore_ascii_case("none") { Some(None) } else { self.0.read(text).map(Some) }
    }

    fn write(&self, value: &Option<T>) -> String {
        value.as_ref().map_or_else(|| "none".to_owned(), |value| self.0.write(value))
    }

    fn allowed(&self) -> String {
        format!("none or {}", self.0.allowed())
    }

    fn unit(&self) -> &'static str {
        self.0.unit()
    }
}

/// Makes the table of a family its `Assumptions`.
///
/// A row: field, type, default, text form, then line of the digest, question, other answers, and what the driver makes of
/// it. Questions that options of driver or emulator answer come last, with those options.
#[macro_export]
macro_rules! assumptions {
    (
        $(#[$attribute:meta])*
        $visible:vis struct $name:ident {
            $($field:ident: $type:ty = $default:expr, $form:expr,
                ($line:literal, $question:literal, $alternatives:literal, $driver:literal $(,)?);)*
        }
        others {
            $($option:literal = $usual:literal,
                ($its_line:literal, $its_question:literal, $others:literal, $its_driver:literal $(,)?);)*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[allow(clippy::doc_markdown, reason = "questions of the table are prose")]
        $visible struct $name {
            $(
                #[doc = $question]
                ///
                #[doc = concat!("Other answers: ", $alternatives, ". The driver: ", $driver, ".")]
                pub $field: $type,
            )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $crate::Assumed for $name {
            const NAMES: &'static [&'static str] = &[$(stringify!($field),)*];
            const QUESTIONS: &'static [$crate::OpenQuestion] = &[
                $($crate::OpenQuestion {
                    line: $line,
                    question: $question,
                    option: concat!("Assumptions.", stringify!($field)),
                    default: stringify!($default),
                    alternatives: $alternatives,
                    driver: $driver,
                },)*
                $($crate::OpenQuestion {
                    line: $its_line,
                    question: $its_question,
                    option: $option,
                    default: $usual,
                    alternatives: $others,
                    driver: $its_driver,
                },)*
            ];

            fn set(&mut self, name: &str, value: &str) -> Result<(), $crate::AssumedError> {
                use $crate::assumptions::TextForm;
                let field = name.to_lowercase().replace('-', "_");
                $(if field == stringify!($field) {
                    let form = $form;
                    let Some(read) = form.read(value) else {
                        let (name, value) = (name.to_owned(), value.to_owned());
                        let allowed = form.allowed();
                        return Err($crate::AssumedError::Value { name, value, allowed });
                    };
                    self.$field = read;
                    return Ok(());
                })*
                let (name, known) = (name.to_owned(), Self::NAMES);
                Err($crate::AssumedError::Unknown { name, known })
            }

            fn values(name: &str) -> Option<$crate::AssumedValues> {
                use $crate::assumptions::TextForm;
                let usual = Self::default();
                $(if name == stringify!($field) {
                    return Some($form.values(&usual.$field));
                })*
                None
            }
        }
    };
}
#[doc(inline)]
pub use assumptions;
