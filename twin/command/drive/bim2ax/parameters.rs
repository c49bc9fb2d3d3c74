//! Parameters of a BIM2AX-BOCM by name and number.

use super::super::session::{Session, no_clock};
use super::super::words::{self, right};
use crate::command::Failure;
use comfy_table::Cell;
use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter, Range};
use twin_bim2ax::{Bim2Ax, DriveMode, ModuleAxis};
use twin_drives::Values;

/// The rating of the largest module.
const MOST_RATING_MA: i64 = 5000;

/// All numbers there can be: $0 to $41, $62 and $63.
pub(super) fn all() -> impl Iterator<Item = Parameter> {
    (0..=0x63).filter_map(Parameter::from_number)
}

pub(super) fn find(text: &str) -> Result<Parameter, Failure> {
    if let Some(number) = words::integer(text) {
        let parameter = u16::try_from(number).ok().and_then(Parameter::from_number);
        return parameter.ok_or_else(|| {
            words::unknown_number(number, "they are 0 to 65, 98 and 99 ($0 to $41, $62, $63)")
        });
    }
    Parameter::named(text).ok_or_else(|| {
        let names: Vec<String> = all().map(Parameter::word).collect();
        words::unknown_name("parameter", text, names.iter().map(String::as_str))
    })
}

/// What a module of this rating, mA, is to be given: a parameter that can be written, its name, and the bits of the value.
fn wanted(
    parameter: Parameter,
    (value, unit): (i64, &str),
    rating_ma: i64,
) -> Result<(String, u32), Failure> {
    let named = format!("{} (${:02X})", parameter.word(), parameter.number().unwrap_or_default());
    let range = parameter.range();
    if range == Range::ReadOnly {
        return Err(Failure::Usage(format!(
            "{named} is read-only: this parameter cannot be written"
        )));
    }
    let values = range.values(rating_ma);
    let bits = u32::try_from(value).ok();
    let bits = bits.or_else(|| i32::try_from(value).ok().map(i32::cast_unsigned));
    match bits {
        Some(bits) if values.contain(value) => Ok((named, bits)),
        // As these are shown and written.
        _ if range == Range::Bits => {
            let usual = format!("${value:04X}");
            let value = if value < 0 { value.to_string() } else { usual };
            Err(Failure::Usage(format!(
                "{named} = {value} is impossible: it takes {}",
                in_hex(&values)
            )))
        }
        _ => {
            words::check_value(&named, value, (&values, unit))?;
            Err(Failure::Usage(format!("{value} has more than 32 bits")))
        }
    }
}

/// The values of bits, as those are shown.
fn in_hex(values: &Values) -> String {
    match values {
        Values::Between(low, high) => format!("${low:04X} to ${high:04X} (bits)"),
        other @ Values::OneOf(_) => format!("{other} (bits)"),
    }
}

/// Writes a parameter to a module that reports none.
pub(super) fn set_unseen(
    session: &Session,
    module: &mut Bim2Ax,
    parameter: Parameter,
    value: i64,
) -> Result<(), Failure> {
    // Its rating is unknown too; the module itself refuses larger values.
    let (_, bits) = wanted(parameter, (value, ""), MOST_RATING_MA)?;
    session.ask(module.set_parameter(parameter, bits, &no_clock))?;
    say!("{}: ? -> {}", parameter.word(), shown(parameter, bits));
    say!(
        "the check sum is right again, and parameters that have not been written since may hold anything: when all are, `reset`, then `get`"
    );
    Ok(())
}

/// A value as people read it.
fn shown(parameter: Parameter, value: u32) -> String {
    match parameter {
        Parameter::FlashCrc
        | Parameter::Axis(AxisParameter::ParameterCrc | AxisParameter::Phases, _) => {
            format!("${value:X}")
        }
        _ => match parameter.range() {
            Range::Bits | Range::Mode => format!("${value:04X}"),
            _ => value.cast_signed().to_string(),
        },
    }
}

/// The unit of speeds follows the drive mode of the axis.
fn unit(parameter: Parameter, per_step: [bool; 2]) -> &'static str {
    use AxisParameter as P;
    let steps = |axis: ModuleAxis| per_step.get(axis.index()) == Some(&true);
    match parameter {
        Parameter::Rating | Parameter::Axis(P::MotorCurrent | P::HoldingCurrent, _) => "mA",
        Parameter::Axis(P::FastSpeed | P::StartStopSpeed, axis) if steps(axis) => "steps/s",
        Parameter::Axis(P::FastSpeed | P::StartStopSpeed, _) => "µsteps/s",
        Parameter::Axis(P::Acceleration, axis) if steps(axis) => "steps/s²",
        Parameter::Axis(P::Acceleration, _) => "µsteps/s²",
        Parameter::Axis(P::Dividend, _) => "µsteps/turn",
        Parameter::Axis(P::Divisor, _) => "points/turn",
        Parameter::Axis(P::EncoderOffset | P::LastEncoderPosition, _) => "points",
        Parameter::Axis(P::LastPosition, _) => "µsteps",
        _ => match parameter.range() {
            Range::Distance | Range::Position => "µsteps",
            Range::Bits | Range::Mode => "bits",
            _ => "",
        },
    }
}

/// Whether the speeds of each axis are in whole steps.
pub(super) fn per_step(session: &Session, module: &mut Bim2Ax) -> Result<[bool; 2], Failure> {
    let mut found = [false; 2];
    for (axis, place) in ModuleAxis::ALL.into_iter().zip(&mut found) {
        let mode = Parameter::Axis(AxisParameter::Mode, axis);
        let code = session.ask(module.parameter(mode, &no_clock))?;
        let mode = u16::try_from(code).ok().and_then(DriveMode::from_code);
        *place = mode.is_some_and(|mode| mode.code() >= 0x0100);
    }
    Ok(found)
}

/// Number, name, value, unit.
pub(super) fn row(
    session: &Session,
    module: &mut Bim2Ax,
    parameter: Parameter,
    per_step: [bool; 2],
) -> Result<Vec<Cell>, Failure> {
    let value = session.ask(module.parameter(parameter, &no_clock))?;
    let number = parameter.number().unwrap_or_default();
    Ok(vec![
        right(format!("${number:02X}")),
        parameter.word().into(),
        right(shown(parameter, value)),
        unit(parameter, per_step).into(),
    ])
}

pub(super) fn set(
    session: &Session,
    module: &mut Bim2Ax,
    parameter: Parameter,
    value: i64,
) -> Result<(), Failure> {
    let rating = session.ask(module.parameter(Parameter::Rating, &no_clock))?;
    let per_step = per_step(session, module)?;
    let of_value = unit(parameter, per_step);
    let (_, bits) = wanted(parameter, (value, of_value), rating.into())?;
    let old = session.ask(module.parameter(parameter, &no_clock))?;
    session.ask(module.set_parameter(parameter, bits, &no_clock))?;
    let [old, new] = [old, bits].map(|bits| shown(parameter, bits));
    say!("{}: {}", parameter.word(), words::changed(old, new, of_value));
    if parameter.needs_reset() {
        say!("it acts after `reset`");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{all, find, shown};
    use twin_bim2ax::ModuleAxis;
    use twin_bim2ax::protocol::parameter::{AxisParameter, Parameter};

    #[test]
    fn every_parameter_is_found_by_its_name_and_number() {
        // $0 to $41, $62 and $63 (manual 3).
        assert_eq!(all().count(), 0x42 + 2);
        for parameter in all() {
            let number = parameter.number().map(|number| format!("${number:X}"));
            assert_eq!(find(&parameter.word()).ok(), Some(parameter));
            assert_eq!(number.and_then(|number| find(&number).ok()), Some(parameter));
        }
        let fast = Parameter::Axis(AxisParameter::FastSpeed, ModuleAxis::Two);
        assert_eq!(find("fast-speed-2").ok(), Some(fast));
        assert_eq!(find("11").ok(), Some(fast));
        // As the manual has it.
        assert_eq!(find("Fast speed of axis 2").ok(), Some(fast));
        let minus = Parameter::Axis(AxisParameter::SoftMinus, ModuleAxis::One);
        assert_eq!(find("soft-limit-minus-1").ok(), Some(minus));
        assert!(find("$42").is_err() && find("soft-limit").is_err());
        assert_eq!(shown(minus, 0xFFFF_FC18), "-1000");
    }
}
