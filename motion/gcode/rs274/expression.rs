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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Operator {
    Power,
    Times,
    Divided,
    Modulo,
    Plus,
    Minus,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
    And,
    Or,
    Xor,
}

/// Operators by their text; a longer one before its beginning.
const OPERATORS: [(&str, Operator); 15] = [
    ("**", Operator::Power),
    ("*", Operator::Times),
    ("/", Operator::Divided),
    ("+", Operator::Plus),
    ("-", Operator::Minus),
    ("MOD", Operator::Modulo),
    ("EQ", Operator::Equal),
    ("NE", Operator::NotEqual),
    ("GT", Operator::Greater),
    ("GE", Operator::GreaterOrEqual),
    ("LT", Operator::Less),
    ("LE", Operator::LessOrEqual),
    ("AND", Operator::And),
    ("OR", Operator::Or),
    ("XOR", Operator::Xor),
];

impl Operator {
    /// Operators of higher rank are applied first.
    fn rank(self) -> u8 {
        match self {
            Self::And | Self::Or | Self::Xor => 1,
            Self::Equal
            | Self::NotEqual
            | Self::Greater
            | Self::GreaterOrEqual
            | Self::Less
            | Self::LessOrEqual => 2,
            Self::Plus | Self::Minus => 3,
            Self::Times | Self::Divided | Self::Modulo => 4,
            Self::Power => 5,
        }
    }

    fn apply(self, left: f64, right: f64) -> Result<f64, ExpressionError> {
        let truth = |is_so: bool| Ok(if is_so { 1.0 } else { 0.0 });
        let (same, yes) = ((left - right).abs() < EQUAL, |value: f64| value != 0.0);
        match self {
            Self::Power if left < 0.0 && right.fract() != 0.0 => Err(ExpressionError::Domain {
                function: "**",
                argument: left,
                domain: "a negative number has whole powers only",
            }),
            Self::Power => Ok(left.powf(right)),
            Self::Times => Ok(left * right),
            Self::Divided | Self::Modulo if right == 0.0 => Err(ExpressionError::DivisionByZero),
            Self::Divided => Ok(left / right),
            Self::Modulo => Ok(left.rem_euclid(right)),
            Self::Plus => Ok(left + right),
            Self::Minus => Ok(left - right),
            Self::Equal => truth(same),
            Self::NotEqual => truth(!same),
            Self::Greater => truth(left > right),
            Self::GreaterOrEqual => truth(left >= right),
            Self::Less => truth(left < right),
            Self::LessOrEqual => truth(left <= right),
            Self::And => truth(yes(left) && yes(right)),
            Self::Or => truth(yes(left) || yes(right)),
            Self::Xor => truth(yes(left) != yes(right)),
        }
    }
}

/// Functions of one argument; ATAN takes two and EXISTS a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Function {
    Abs,
    Acos,
    Asin,
    Atan,
    Cos,
    Exists,
    Exp,
    Fix,
    Fup,
    Ln,
    Round,
    Sin,
    Sqrt,
    Tan,
}

const FUNCTIONS: [(&str, Function); 14] = [
    ("ABS", Function::Abs),
    ("ACOS", Function::Acos),
    ("ASIN", Function::Asin),
    ("ATAN", Function::Atan),
    ("COS", Function::Cos),
    ("EXISTS", Function::Exists),
    ("EXP", Function::Exp),
    ("FIX", Function::Fix),
    ("FUP", Function::Fup),
    ("LN", Function::Ln),
    ("ROUND", Function::Round),
    ("SIN", Function::Sin),
    ("SQRT", Function::Sqrt),
    ("TAN", Function::Tan),
];

impl Function {
    fn apply(self, argument: f64) -> Result<f64, ExpressionError> {
        let within = |function, is_defined: bool, domain| {
            let undefined = ExpressionError::Domain { function, argument, domain };
            if is_defined { Ok(()) } else { Err(undefined) }
        };
        Ok(match self {
            Self::Abs => argument.abs(),
            Self::Acos => {
                within("ACOS", argument.abs() <= 1.0, "it takes -1 to 1")?;
                degrees(argument.acos())
            }
            Self::Asin => {
                within("ASIN", argument.abs() <= 1.0, "it takes -1 to 1")?;
                degrees(argument.asin())
            }
            Self::Cos => radians(argument).cos(),
            Self::Exp => argument.exp(),
            Self::Fix => argument.floor(),
            Self::Fup => argument.ceil(),
            Self::Ln => {
                within("LN", argument > 0.0, "it takes numbers above 0")?;
                argument.ln()
            }
            Self::Round => argument.round(),
            Self::Sin => radians(argument).sin(),
            Self::Sqrt => {
                within("SQRT", argument >= 0.0, "it takes 0 and numbers above")?;
                argument.sqrt()
            }
            Self::Tan => radians(argument).tan(),
            Self::Atan | Self::Exists => argument,
        })
    }
}

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
        let value = self.operation(0)?;
        self.expect(']')?;
        Ok(value)
    }

    /// Values and operators of at least a rank.
    fn operation(&mut self, least: u8) -> Result<f64, Problem> {
        let start = self.at;
        let mut left = self.value()?;
        while self.peek() != Some(b']') {
            let Some((operator, end)) = self.one_of(&OPERATORS) else {
                if matches!(self.peek(), Some(b'(' | b';') | None) {
                    self.expect(']')?;
                }
                let at = self.at;
                return Err(self.problem(at, at + 1, ExpressionError::UnknownOperator.into()));
            };
            if operator.rank() < least {
                break;
            }
            self.at = end;
            let right = self.operation(operator.rank() + 1)?;
            left = operator.apply(left, right).map_err(|error| self.since(start, error))?;
        }
        Ok(left)
    }

    /// True if a function's name is here.
    pub(super) fn is_function(&self) -> bool {
        self.one_of(&FUNCTIONS).is_some()
    }

    fn function(&mut self) -> Result<f64, Problem> {
        let start = self.at;
        let Some((function, end)) = self.one_of(&FUNCTIONS) else {
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
            _ => {
                let argument = self.expression()?;
                function.apply(argument).map_err(|error| self.since(start, error))
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
        if self.peek() == Some(b'<') {
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
    pub(super) fn one_of<T: Copy>(&self, table: &[(&str, T)]) -> Option<(T, usize)> {
        table.iter().find_map(|(text, meaning)| Some((*meaning, self.end_of(text)?)))
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
