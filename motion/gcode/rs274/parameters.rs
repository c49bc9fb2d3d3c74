//! Parameters of the program: numbered, named, and those that show the state of the interpreter.
//!
//! ```text
//! #1 to #30        local to a subroutine: its arguments
//! #31 to #5000     of the program
//! #5061 to #5602   of the interpreter: probe result, home positions, offsets, tool, position
//! #<name>          local to a subroutine
//! #<_name>         global
//! #<_x>, ...       state of the interpreter, read only
//! ```

use super::options::LengthUnit;
use super::state::State;
use super::word::FeedMode;
use std::collections::HashMap;
use twin_number::Short;

/// Whole numbers may be off by this much.
pub(super) const WHOLE: f64 = 1e-4;

/// The highest number of a parameter.
pub(super) const LAST: u16 = 5602;

/// Number of parameters that are local to a subroutine, from 1 on.
pub(super) const LOCAL: usize = 30;

/// Their values.
pub(super) type Locals = Box<[f64; LOCAL]>;

/// Error of a parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// A number that no parameter has.
    #[error("parameter {} does not exist: the numbers are whole, 1 to {LAST}", Short(*.0))]
    Number(f64),
    /// A named parameter without value.
    #[error(
        "#<{0}> has no value: it must be set before it is used, in the same subroutine unless it begins with _"
    )]
    NoValue(String),
    /// A parameter that shows the state of the interpreter.
    #[error("{0} cannot be set: it shows the state of the control")]
    ReadOnly(String),
    /// A position that is not known while compensation is on.
    #[error(
        "the position #{0} cannot be read with cutter radius compensation, which decides it later: end it with G40 before"
    )]
    Compensated(u16),
}

/// A parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// From 1 to [`LAST`].
    Numbered(u16),
    /// In lower case, without blanks.
    Named(Box<[u8]>),
}

impl Target {
    /// The parameter of this number.
    ///
    /// # Errors
    /// [`ParameterError::Number`].
    pub(super) fn numbered(value: f64) -> Result<Self, ParameterError> {
        let rounded = value.round();
        if (value - rounded).abs() > WHOLE || !(1.0..=f64::from(LAST)).contains(&rounded) {
            return Err(ParameterError::Number(value));
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "checked above"
        )]
        Ok(Self::Numbered(rounded as u16))
    }

    /// As the program writes it.
    fn text(&self) -> String {
        match self {
            Self::Numbered(number) => format!("#{number}"),
            Self::Named(name) => format!("#<{}>", String::from_utf8_lossy(name)),
        }
    }
}

/// Numbers by name.
type Names = HashMap<Box<[u8]>, f64>;

/// Parameters that the program sets.
#[derive(Debug)]
pub(super) struct Parameters {
    numbered: Vec<f64>,
    global: Names,
    /// Those of the program and of each open subroutine.
    local: Vec<Names>,
    /// Line of the current block.
    pub(super) line: u32,
    /// Value of the last RETURN or ENDSUB, if it had one.
    pub(super) returned: Option<f64>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            numbered: vec![0.0; usize::from(LAST) + 1],
            global: Names::new(),
            local: vec![Names::new()],
            line: 0,
            returned: None,
        }
    }
}

impl Parameters {
    fn get(&self, number: u16) -> f64 {
        self.numbered.get(usize::from(number)).copied().unwrap_or_default()
    }

    pub(super) fn set(&mut self, number: u16, value: f64) {
        if let Some(slot) = self.numbered.get_mut(usize::from(number)) {
            *slot = value;
        }
    }

    /// Begins a subroutine; its arguments if it has any of its own. Returns the parameters to be restored at its end.
    pub(super) fn enter(&mut self, arguments: Option<Locals>) -> Option<Locals> {
        self.local.push(Names::new());
        self.exchange(arguments)
    }

    /// Ends a subroutine.
    pub(super) fn leave(&mut self, saved: Option<Locals>) {
        if self.local.len() > 1 {
            self.local.pop();
        }
        self.exchange(saved);
    }

    /// Replaces the numbered local parameters, if `values` are any; returns those before.
    fn exchange(&mut self, values: Option<Locals>) -> Option<Locals> {
        let mut values = values?;
        self.numbered.get_mut(1..=LOCAL)?.swap_with_slice(&mut *values);
        Some(values)
    }

    /// Number of open subroutines.
    pub(super) fn depth(&self) -> usize {
        self.local.len() - 1
    }

    fn names(&self, name: &[u8]) -> Option<&Names> {
        if name.starts_with(b"_") { Some(&self.global) } else { self.local.last() }
    }
}

impl State {
    /// Value of a parameter, in the units of the program.
    ///
    /// # Errors
    /// [`ParameterError::NoValue`].
    pub(super) fn parameter(&self, target: &Target) -> Result<f64, ParameterError> {
        match target {
            Target::Numbered(number @ 5420..=5428) if self.compensation_is_on() => {
                Err(ParameterError::Compensated(*number))
            }
            Target::Numbered(number) => Ok(self.numbered(*number)),
            Target::Named(name) => {
                let known = self.parameters.names(name).and_then(|names| names.get(name).copied());
                let value = known.or_else(|| self.shown(name));
                value.ok_or_else(|| {
                    ParameterError::NoValue(String::from_utf8_lossy(name).into_owned())
                })
            }
        }
    }

    /// Checks that the program may set a parameter.
    ///
    /// # Errors
    /// [`ParameterError::ReadOnly`].
    pub(super) fn check_settable(&self, target: &Target) -> Result<(), ParameterError> {
        let shown = match target {
            Target::Numbered(number) => matches!(number, 5400..=5413 | 5420..=5428),
            Target::Named(name) => self.shown(name).is_some(),
        };
        if shown { Err(ParameterError::ReadOnly(target.text())) } else { Ok(()) }
    }

    /// Sets a parameter that may be set.
    pub(super) fn set_parameter(&mut self, target: &Target, value: f64) {
        let parameters = &mut self.parameters;
        match target {
            Target::Numbered(number) => {
                parameters.set(*number, value);
                self.offsets.set_parameter(*number, value);
            }
            Target::Named(name) => {
                let names = if name.starts_with(b"_") {
                    Some(&mut parameters.global)
                } else {
                    parameters.local.last_mut()
                };
                if let Some(names) = names {
                    names.insert(name.clone(), value);
                }
            }
        }
    }

    fn numbered(&self, number: u16) -> f64 {
        match number {
            5420..=5428 => self.compensated_program()[usize::from(number - 5420)],
            _ => self.offsets.parameter(number).unwrap_or_else(|| self.parameters.get(number)),
        }
    }

    /// Named parameters that show the state of the interpreter.
    fn shown(&self, name: &[u8]) -> Option<f64> {
        let name = name.strip_prefix(b"_")?;
        let truth = |is_so: bool| if is_so { 1.0 } else { 0.0 };
        let tenths = |code: f64| (code * 10.0).round();
        Some(match name {
            b"vmajor" => 2.9,
            b"vminor" | b"task" | b"remap_level" => 0.0,
            b"line" => f64::from(self.parameters.line),
            b"motion_mode" => tenths(self.motion.number()),
            b"plane" => {
                let plane = match self.plane {
                    twin_path::Plane::Xy => 170.0,
                    twin_path::Plane::Zx => 180.0,
                    twin_path::Plane::Yz => 190.0,
                };
                plane + truth(self.parallel_plane)
            }
            b"ccomp" => self.compensation_number(),
            b"metric" => truth(self.units == LengthUnit::Millimetre),
            b"imperial" => truth(self.units == LengthUnit::Inch),
            b"absolute" => truth(!self.relative),
            b"incremental" => truth(self.relative),
            b"inverse_time" => truth(self.feed_mode == FeedMode::InverseTime),
            b"units_per_minute" => truth(self.feed_mode == FeedMode::PerMinute),
            b"units_per_rev" => truth(self.feed_mode == FeedMode::PerRevolution),
            b"lathe_diameter_mode" => truth(self.diameters),
            b"lathe_radius_mode" => truth(!self.diameters),
            b"spindle_css_mode" => truth(self.surface_speed.is_some()),
            b"spindle_rpm_mode" => truth(self.surface_speed.is_none()),
            b"coord_system" => self.offsets.system_number(),
            b"tool_offset" => truth(self.offsets.has_tool_length()),
            b"retract_r_plane" => truth(!self.initial_level),
            b"retract_old_z" => truth(self.initial_level),
            b"ijk_absolute_mode" => truth(self.absolute_centers),
            b"spindle_on" => truth(self.spindle.is_some()),
            b"spindle_cw" => truth(self.spindle == Some(3)),
            b"mist" => truth(self.coolant[0]),
            b"flood" => truth(self.coolant[1]),
            b"feed_override" => truth(self.overrides.feed),
            b"speed_override" => truth(self.overrides.spindle),
            b"adaptive_feed" => truth(self.overrides.adaptive),
            b"feed_hold" => truth(self.overrides.hold),
            b"feed" => self.feed_word,
            b"rpm" => self.speed.unwrap_or_default(),
            b"current_tool" => f64::from(self.tool),
            b"selected_tool" => self.selected_tool.map_or(0.0, f64::from),
            b"value" => self.parameters.returned.unwrap_or_default(),
            b"value_returned" => truth(self.parameters.returned.is_some()),
            #[expect(clippy::cast_precision_loss, reason = "few")]
            b"call_level" => self.parameters.depth() as f64,
            [letter] => {
                let axis = b"xyzabcuvw".iter().position(|axis| axis == letter)?;
                self.compensated_program()[axis]
            }
            _ => return None,
        })
    }
}
