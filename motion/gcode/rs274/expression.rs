//! Values behind letters: numbers, parameters, functions and expressions in brackets.
//!
//! ```text
//! value       number | # parameter | function [ expression ] | [ expression ] | + value | - value
//! parameter   whole value | < name >
//! expression  value (operator value)*        ** before * / MOD before + - before EQ … LE before AND OR XOR
//! ```
//!
//! Operators of one rank are applied from left to right, `**` too. Angles are in degrees. A sign belongs to its value:
//! `-2**2` is 4.

use super::error::{DecodeError, Problem};
use super::lexer::Lexer;
use super::parameters::{ParameterError, Target, WHOLE};
use std::f64::consts::PI;

/// The deepest nesting of values: brackets, signs and `#`.
const MAX_DEPTH: u32 = 100;

/// Numbers that differ by less than this are equal for EQ and NE.
const EQUAL: f64 = 1e-4;

/// Error of a value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExpressionError {
    /// A bracket or slash that must be there.
    #[error("{0:?} must follow here")]
    Missing(char),
    /// Neither an operator nor the end of the expression.
    #[error(
        "an operator or ] must follow here: + - * / ** MOD AND OR XOR EQ NE GT GE LT LE are the operators"
    )]
    UnknownOperator,
    /// A word that is not a function.
    #[error(
        "not a function: ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN are the functions, each before ["
    )]
    UnknownFunction,
    /// Something else than a value.
    #[error("a value must follow here: a number, # with a parameter, a function or [ ]")]
    NotNumber,
    /// Brackets within brackets without end.
    #[error("values are nested more than {0} deep")]
    TooDeep(u32),
    /// A division by zero.
    #[error("a number is divided by 0")]
    DivisionByZero,
    /// A function whose argument has no result.
    #[error("{function} of {} is undefined: {domain}", twin_number::Short(*argument))]
    Domain {
        /// The function or operator.
        function: &'static str,
        /// Its argument.
        argument: f64,
        /// Range of arguments.
        domain: &'static str,
    },
    /// The result is not finite.
    #[error("the value is too large for a number")]
    NotFinite,
}

/// Rank of an operator, and what it makes of two values; those of higher rank are applied first.
type Operator = (u8, fn(f64, f64) -> Result<f64, ExpressionError>);

/// Operators by their text; a longer one before its beginning.
#[rustfmt::skip]
const OPERATORS: [(&str, Operator); 15] = [
    ("**",  (5, power)),
    ("*",   (4, |a, b| Ok(a * b))),
    ("/",   (4, |a, b| Ok(a / divisor(b)?))),
    ("+",   (3, |a, b| Ok(a + b))),
    ("-",   (3, |a, b| Ok(a - b))),
    ("MOD", (4, |a, b| Ok(a.rem_euclid(divisor(b)?)))),
    ("EQ",  (2, |a, b| truth((a - b).abs() < EQUAL))),
    ("NE",  (2, |a, b| truth((a - b).abs() >= EQUAL))),
    ("GT",  (2, |a, b| truth(a > b))),
    ("GE",  (2, |a, b| truth(a >= b))),
    ("LT",  (2, |a, b| truth(a < b))),
    ("LE",  (2, |a, b| truth(a <= b))),
    ("AND", (1, |a, b| truth(a != 0.0 && b != 0.0))),
    ("OR",  (1, |a, b| truth(a != 0.0 || b != 0.0))),
    ("XOR", (1, |a, b| truth((a != 0.0) != (b != 0.0)))),
];

fn power(base: f64, exponent: f64) -> Result<f64, ExpressionError> {
    if base < 0.0 && exponent.fract() != 0.0 {
        let domain = "a negative number has whole powers only";
        return Err(ExpressionError::Domain { function: "**", argument: base, domain });
    }
    Ok(base.powf(exponent))
}

fn divisor(value: f64) -> Result<f64, ExpressionError> {
    if value == 0.0 { Err(ExpressionError::DivisionByZero) } else { Ok(value) }
}

#[expect(clippy::unnecessary_wraps, reason = "as operators are")]
fn truth(is_so: bool) -> Result<f64, ExpressionError> {
    Ok(if is_so { 1.0 } else { 0.0 })
}

#[derive(Clone, Copy, Debug)]
enum Function {
    /// Of one argument; the arguments for which it is defined, if those are not all.
    Of(fn(f64) -> f64, &'static str),
    Atan,
    Exists,
}

#[rustfmt::skip]
const FUNCTIONS: [(&str, Function); 14] = [
    ("ABS",    Function::Of(f64::abs, "")),
    ("ACOS",   Function::Of(|x| degrees(x.acos()), "it takes -1 to 1")),
    ("ASIN",   Function::Of(|x| degrees(x.asin()), "it takes -1 to 1")),
    ("ATAN",   Function::Atan),
    ("COS",    Function::Of(|x| radians(x).cos(), "")),
    ("EXISTS", Function::Exists),
    ("EXP",    Function::Of(f64::exp, "")),
    ("FIX",    Function::Of(f64::floor, "")),
    ("FUP",    Function::Of(f64::ceil, "")),
    ("LN",     Function::Of(f64::ln, "it takes numbers above 0")),
    ("ROUND",  Function::Of(f64::round, "")),
    ("SIN",    Function::Of(|x| radians(x).sin(), "")),
    ("SQRT",   Function::Of(f64::sqrt, "it takes 0 and numbers above")),
    ("TAN",    Function::Of(|x| radians(x).tan(), "")),
];

/// Rest of π behind its 53 bits.
const PI_REST: f64 = 1.224_646_799_147_353_2e-16;

/// `angle` in degrees, with π to 106 bits: a function of a round number gives a round number more often, and the same
/// as in LinuxCNC.
fn degrees(angle: f64) -> f64 {
    let product = angle * 180.0;
    let quotient = product / PI;
    quotient + ((-quotient).mul_add(PI, product) - quotient * PI_REST) / PI
}

/// `angle` in radians; see [`degrees`].
fn radians(angle: f64) -> f64 {
    let product = angle * PI;
    let rest = angle.mul_add(PI, -product) + angle * PI_REST;
    let quotient = product / 180.0;
    quotient + ((-quotient).mul_add(180.0, product) + rest) / 180.0
}

impl Lexer<'_> {
    /// The value that begins here.
    pub(super) fn value(&mut self) -> Result<f64, Problem> {
        let start = self.at;
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.since(start, ExpressionError::TooDeep(MAX_DEPTH)));
        }
        let value = match self.peek() {
            Some(b'[') => self.expression()?,
            Some(b'#') => self.parameter_value()?,
            Some(sign @ (b'+' | b'-')) if !self.is_number() => {
                self.at += 1;
                let value = self.value()?;
                if sign == b'-' { -value } else { value }
            }
            Some(byte) if byte.is_ascii_alphabetic() => self.function()?,
            _ => self.number()?,
        };
        self.depth -= 1;
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.since(start, ExpressionError::NotFinite))
        }
    }

    /// The expression in brackets that begins here.
    pub(super) fn expression(&mut self) -> Result<f64, Problem> {
        self.expect('[')?;
        self.see("expressions", self.at - 1..self.at);
        let value = self.operation(0)?;
        self.expect(']')?;
        Ok(value)
    }

    /// Values and operators of at least a rank.
    fn operation(&mut self, least: u8) -> Result<f64, Problem> {
        let start = self.at;
        let mut left = self.value()?;
        while self.peek() != Some(b']') {
            let Some(((_, (rank, apply)), end)) = self.one_of(&OPERATORS) else {
                if matches!(self.peek(), Some(b'(' | b';') | None) {
                    self.expect(']')?;
                }
                let at = self.at;
                return Err(self.problem(at, at + 1, ExpressionError::UnknownOperator.into()));
            };
            if *rank < least {
                break;
            }
            self.at = end;
            let right = self.operation(rank + 1)?;
            left = apply(left, right).map_err(|error| self.since(start, error))?;
        }
        Ok(left)
    }

    /// True if a function's name is here.
    pub(super) fn is_function(&self) -> bool {
        self.one_of(&FUNCTIONS).is_some()
    }

    fn function(&mut self) -> Result<f64, Problem> {
        let start = self.at;
        let Some((&(name, function), end)) = self.one_of(&FUNCTIONS) else {
            return Err(self.problem(start, start + 1, ExpressionError::UnknownFunction.into()));
        };
        self.at = end;
        match function {
            Function::Exists => {
                self.expect('[')?;
                let parameter = self.any_parameter()?;
                self.expect(']')?;
                let value = parameter.and_then(|parameter| self.state.parameter(&parameter));
                Ok(if value.is_ok() { 1.0 } else { 0.0 })
            }
            Function::Atan => {
                let over = self.expression()?;
                self.expect('/')?;
                Ok(degrees(over.atan2(self.expression()?)))
            }
            Function::Of(apply, domain) => {
                let argument = self.expression()?;
                let value = apply(argument);
                if value.is_finite() || domain.is_empty() {
                    return Ok(value);
                }
                let undefined = ExpressionError::Domain { function: name, argument, domain };
                Err(self.since(start, undefined))
            }
        }
    }

    fn parameter_value(&mut self) -> Result<f64, Problem> {
        let start = self.at;
        let parameter = self.parameter()?;
        self.state.parameter(&parameter).map_err(|error| self.since(start, error))
    }

    /// The parameter that begins here with `#`.
    pub(super) fn parameter(&mut self) -> Result<Target, Problem> {
        let start = self.at;
        self.any_parameter()?.map_err(|error| self.since(start, error))
    }

    /// The same, or why no parameter has the number that is written.
    fn any_parameter(&mut self) -> Result<Result<Target, ParameterError>, Problem> {
        self.expect('#')?;
        let is_named = self.peek() == Some(b'<');
        let kind = if is_named { "named parameters" } else { "parameters" };
        self.see(kind, self.at - 1..self.at);
        if is_named {
            return Ok(Ok(Target::Named(self.name()?)));
        }
        Ok(Target::numbered(self.value()?))
    }

    /// The name in `< >` that begins here: lower case, without blanks.
    pub(super) fn name(&mut self) -> Result<Box<[u8]>, Problem> {
        let start = self.at;
        self.expect('<')?;
        let mut name = Vec::new();
        loop {
            match self.peek() {
                Some(b'>') => break,
                Some(byte) => name.push(byte.to_ascii_lowercase()),
                None => return Err(self.since(start, ExpressionError::Missing('>'))),
            }
            self.at += 1;
        }
        self.at += 1;
        Ok(name.into())
    }

    /// The whole number that begins here.
    pub(super) fn whole(&mut self) -> Result<i64, Problem> {
        let start = self.at;
        let value = self.value()?;
        let rounded = value.round();
        if (value - rounded).abs() > WHOLE || rounded.abs() > 1e15 {
            let error = DecodeError::NotWhole { letter: 'O', value };
            return Err(self.since(start, error));
        }
        #[expect(clippy::cast_possible_truncation, reason = "checked above")]
        Ok(rounded as i64)
    }

    /// Reads this character.
    pub(super) fn expect(&mut self, character: char) -> Result<(), Problem> {
        if self.peek().map(char::from) == Some(character) {
            self.at += 1;
            return Ok(());
        }
        let at = self.at.min(self.line.len().saturating_sub(1));
        Err(self.problem(at, at + 1, ExpressionError::Missing(character).into()))
    }

    /// The entry of `table` whose text is here, and where it ends.
    pub(super) fn one_of<'t, T>(
        &self,
        table: &'t [(&'static str, T)],
    ) -> Option<(&'t (&'static str, T), usize)> {
        table.iter().find_map(|entry| Some((entry, self.end_of(entry.0)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::options::DecoderOptions;
    use super::super::state::State;
    use super::*;

    fn value(text: &str) -> Result<f64, String> {
        let state = State::new(DecoderOptions::default());
        let mut lexer = Lexer::new(text.as_bytes(), 0, &state);
        let value = lexer.value().map_err(|problem| problem.error.to_string())?;
        assert_eq!(lexer.peek(), None, "{text}");
        Ok(value)
    }

    /// Closed forms; LinuxCNC's interpreter agrees (`tests/linuxcnc.txt`).
    #[test]
    fn values() {
        for (text, expected) in [
            ("[1+2*3]", 7.0),
            ("[2**3**2]", 64.0),
            ("-2", -2.0),
            ("[-2**2]", 4.0),
            ("- [ 2 ** 2 ]", -4.0),
            ("[7 MOD 3]", 1.0),
            ("[-7 mod 3]", 2.0),
            ("[1 + 2 GT 2 AND 1]", 1.0),
            ("[1 OR 0 AND 0]", 0.0),
            ("[1 XOR 1]", 0.0),
            ("[1 EQ 1.00005]", 1.0),
            ("[1 LT 1.00005]", 1.0),
            ("sin[30]", 0.5),
            ("ATAN[1]/[-1]", 135.0),
            ("fix[-2.8]", -3.0),
            ("fup[2.2]", 3.0),
            ("round[-2.5]", -3.0),
            ("[1 - - 1]", 2.0),
            ("s q r t [16]", 4.0),
            ("#[30 + 1]", 0.0),
            ("EXISTS[#99999]", 0.0),
            ("EXISTS[#31]", 1.0),
            ("##31", 0.0),
        ] {
            let found = value(text);
            if text == "##31" {
                assert!(found.unwrap_err().contains("parameter 0 does not"), "{text}");
                continue;
            }
            let found = found.unwrap_or_else(|error| panic!("{text}: {error}"));
            assert!((found - expected).abs() < 1e-12, "{text}: {found}");
        }
        for (text, message) in [
            ("[1", "']' must follow"),
            ("[1 2 + 3 y]", "operator"),
            ("[1/0]", "divided by 0"),
            ("sqrt[-1]", "SQRT of -1 is undefined"),
            ("[-8 ** 0.5]", "whole powers"),
            ("exp[1000]", "too large"),
            ("EXISTS[##99999]", "parameter 99999"),
            ("foo[1]", "not a function"),
            ("atan[1]", "'/' must follow"),
            (&"[".repeat(5_000), "nested"),
            (&"-".repeat(5_000), "nested"),
        ] {
            let error = value(text).expect_err(text);
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
