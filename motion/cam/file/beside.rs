//! What stands beside the cam in `*.CAM` files of version 1.3: what people edit and how the cam is used.

use super::super::knot::Knot;
use super::super::selection::{CamInput, StartMode};
use super::super::source::{Compile, Element, Kind, Scale, Source};
use super::super::{Cam, Shape};
use super::binary::{Content, MAX_NAME, Payload};
use super::{CamReadError, CamWriteError, MAX_ELEMENTS};

/// What is known of a cam beside its curve and its tappets.
#[derive(Clone, Debug, PartialEq)]
pub struct Beside {
    /// Curve, or tappets only.
    pub kind: Kind,
    /// Scale of the master with its unit.
    pub master: Scale,
    /// Scale of the slave with its unit.
    pub slave: Scale,
    /// The slave's period, u.
    pub period: Option<f64>,
    /// Whether the cam is put end to end.
    pub repeated: bool,
    /// Points and lines; none of a table.
    pub elements: Option<Vec<Element>>,
    /// Inputs of `MC_CamIn`, and the dead time of the tappets.
    pub input: CamInput,
    /// Offset and scaling of the master and of the slave that are wanted where the inputs make up for what the slave does
    /// otherwise.
    pub wanted: Option<[f64; 4]>,
}

impl Beside {
    /// What people edit of the cam, if it consists of elements.
    pub fn source(&self, cam: &Cam) -> Option<Source> {
        Some(Source {
            name: cam.name().to_owned(),
            kind: self.kind,
            master: self.master.clone(),
            slave: self.slave.clone(),
            period: self.period,
            elements: self.elements.clone()?,
            tappets: cam.tappets().to_vec(),
        })
    }

    fn numbers(&self) -> [f64; 9] {
        let input = &self.input;
        [
            input.master_offset,
            input.master_scaling,
            input.slave_offset,
            input.slave_scaling,
            input.velocity_difference,
            input.acceleration,
            input.deceleration,
            input.tappet_hysteresis,
            input.tappet_dead_time_s,
        ]
    }
}

/// Start modes in the order of their numbers in files, from 1.
const MODES: [StartMode; 5] = [
    StartMode::Absolute,
    StartMode::Relative,
    StartMode::RampIn,
    StartMode::RampInPositive,
    StartMode::RampInNegative,
];

pub(super) fn write(beside: &Beside, payload: &mut Payload) -> Result<(), CamWriteError> {
    let kind = if beside.kind == Kind::Cam { 1 } else { 2 };
    payload.0.extend([kind, u8::from(beside.repeated)]);
    for Scale { min, max, step, unit } in [&beside.master, &beside.slave] {
        payload.numbers([*min, *max, *step]);
        payload.count("bytes of a unit", unit.len(), MAX_NAME)?;
        payload.0.extend(unit.as_bytes());
    }
    payload.0.push(u8::from(beside.period.is_some()));
    payload.numbers(beside.period);
    payload.0.push(u8::from(beside.elements.is_some()));
    if let Some(elements) = &beside.elements {
        payload.count("elements", elements.len(), MAX_ELEMENTS)?;
        for element in elements {
            let (kind, numbers) = match *element {
                Element::Point(Knot { master, slave, velocity, acceleration }) => {
                    (1, [master, slave, velocity, acceleration])
                }
                Element::Line { from, to } => (2, [from[0], from[1], to[0], to[1]]),
            };
            payload.0.push(kind);
            payload.numbers(numbers);
        }
    }
    payload.numbers(beside.numbers());
    let mode = (1..).zip(MODES).find(|(_, mode)| *mode == beside.input.start_mode);
    payload.0.push(mode.map_or(1, |(number, _)| number));
    payload.0.push(u8::from(beside.wanted.is_some()));
    payload.numbers(beside.wanted.into_iter().flatten());
    Ok(())
}

/// Reads what stands beside `cam`, and holds it against the cam.
pub(super) fn read(content: &mut Content<'_>, cam: &Cam) -> Result<Beside, CamReadError> {
    let [number] = content.array()?;
    let kind = match number {
        1 => Some(Kind::Cam),
        2 => Some(Kind::Tappets),
        _ => None,
    };
    let kind = content.unknown("kind of cams", number.into(), kind)?;
    let repeated = content.flag()?;
    let (master, slave) = (scale(content)?, scale(content)?);
    let period = if content.flag()? {
        let [period] = content.numbers()?;
        let right = period.is_finite() && period > 0.0;
        Some(right.then_some(period).ok_or_else(|| content.wrong("period", period))?)
    } else {
        None
    };
    let elements =
        if content.flag()? { Some(content.list("elements", MAX_ELEMENTS, element)?) } else { None };
    let numbers: [f64; 9] = content.numbers()?;
    let [number] = content.array()?;
    let mode = MODES.get(usize::from(number).wrapping_sub(1)).copied();
    let start_mode = content.unknown("start mode", number.into(), mode)?;
    let [a, b, c, d, e, f, g, h, i] = numbers;
    let input = CamInput {
        master_offset: a,
        master_scaling: b,
        slave_offset: c,
        slave_scaling: d,
        start_mode,
        velocity_difference: e,
        acceleration: f,
        deceleration: g,
        tappet_hysteresis: h,
        tappet_dead_time_s: i,
    };
    let wanted = if content.flag()? { Some(content.numbers::<4>()?) } else { None };
    let said = numbers.into_iter().chain(wanted.into_iter().flatten());
    if let Some(number) = said.clone().find(|number| !number.is_finite()) {
        return Err(content.wrong("input of MC_CamIn", number));
    }
    let scalings = [b, d].into_iter().chain(wanted.into_iter().flat_map(|[_, m, _, s]| [m, s]));
    if scalings.into_iter().any(|scaling| scaling == 0.0) {
        return Err(content.wrong("scaling", 0.0));
    }
    if let Some(number) = [e, f, g, h].into_iter().find(|number| *number < 0.0) {
        return Err(content.wrong("input of MC_CamIn", number));
    }
    let beside = Beside { kind, master, slave, period, repeated, elements, input, wanted };
    // Elements that make another curve are not those of this cam.
    if let Some(source) = beside.source(cam) {
        let same = matches!(cam.shape(), Shape::Polynomial(_))
            && source.compile(Compile::Polynomial)?.shape() == cam.shape();
        if !same {
            return Err(CamReadError::OtherElements { offset: content.offset() });
        }
    }
    Ok(beside)
}

fn scale(content: &mut Content<'_>) -> Result<Scale, CamReadError> {
    let [min, max, step] = content.numbers()?;
    for (what, value, right) in [
        ("begin of a scale", min, min.is_finite()),
        ("end of a scale", max, max.is_finite() && max > min),
        ("step of a scale", step, step.is_finite() && step > 0.0),
    ] {
        if !right {
            return Err(content.wrong(what, value));
        }
    }
    Ok(Scale { min, max, step, unit: content.text("bytes of a unit")? })
}

fn element(content: &mut Content<'_>) -> Result<Element, CamReadError> {
    let [number] = content.array()?;
    let known = (1..=2).contains(&number).then_some(());
    content.unknown("kind of elements", number.into(), known)?;
    let [a, b, c, d] = content.numbers()?;
    Ok(if number == 1 {
        Element::Point(Knot { master: a, slave: b, velocity: c, acceleration: d })
    } else {
        Element::Line { from: [a, b], to: [c, d] }
    })
}
