//! Binary record of one path element.
//!
//! ```text
//! u32 line · u8 has block · [u32 block] · u8 kind · [u16 M number | i64 dwell | u8 probing] ·
//! u8 shape · its numbers · f64 feed, acceleration, deceleration, end velocity, tool radius · u8 marks ·
//! u8 has details · [u8 has extra axes · [10 f64] · u16 S profile · u8 switches · each (u8 number, u8 on, f64 at) ·
//!                   u8 has K, L, O (bits 0 to 2) · [f64 K] · [f64 L] · [8 f64 O]]
//!
//! line     start, end (3 f64 each)
//! arc      u8 plane · start, end, centre · f64 sweep
//! ellipse  start, end · centre, main half axis (2 f64 each) · f64 other half axis, sweep
//! cubic    start, end · 4 f64 of x · 4 f64 of y
//!
//! probing  bit 0: until it comes free, else until it touches · bit 1: need not trip ·
//!          bits 2 and 3: 0 unknown how it ends, 1 tripped, 2 not tripped
//! ```

use super::ContentError;
use crate::Place;
use crate::{
    Arc, AxisMask, Cubic, Details, ElementKind, Ellipse, ExtraAxes, MAX_SWITCHES, MParameters,
    Marks, PathElement, Plane, ProbeOutcome, ProbeTrip, Probing, Shape, Switch, Switches,
};
use nalgebra::{Point2, Point3, Vector2};
use std::f64::consts::TAU;

const LINE: u8 = 1;
const ARC: u8 = 2;
const ELLIPSE: u8 = 3;
const CUBIC: u8 = 4;

const RAPID: u8 = 0;
const CUT: u8 = 1;
const JUMP: u8 = 2;
const M_FUNCTION: u8 = 3;
const DWELL: u8 = 4;
const PROBE: u8 = 5;

/// Bits of a probing move.
const PROBE_RELEASE: u8 = 1 << 0;
const PROBE_OPTIONAL: u8 = 1 << 1;
const PROBE_TRIPPED: u8 = 1 << 2;
const PROBE_NOT_TRIPPED: u8 = 1 << 3;

/// Once around, and rounding. The length of an ellipse is found by quadrature, which more turns would make endless.
const MAX_ELLIPSE_SWEEP: f64 = TAU * (1.0 + 1e-9);

/// Appends `element` to `out`.
pub(super) fn write(out: &mut Vec<u8>, element: &PathElement) {
    // By name, so that a new field does not go missing here.
    let PathElement {
        place: Place { line, block },
        kind,
        shape,
        feed,
        acceleration,
        deceleration,
        end_velocity,
        tool_radius,
        marks: Marks(marks),
        details,
    } = element;
    let mut out = Writer(out);
    out.u32(*line);
    out.flag(block.is_some());
    if let Some(block) = block {
        out.u32(*block);
    }
    match kind {
        ElementKind::Rapid => out.u8(RAPID),
        ElementKind::Cut => out.u8(CUT),
        ElementKind::Jump => out.u8(JUMP),
        ElementKind::MFunction { number } => {
            out.u8(M_FUNCTION);
            out.bytes(&number.to_le_bytes());
        }
        ElementKind::Dwell { time_ns } => {
            out.u8(DWELL);
            out.bytes(&time_ns.to_le_bytes());
        }
        ElementKind::Probe { probing, outcome } => {
            out.u8(PROBE);
            out.u8(probe_bits(*probing, *outcome));
        }
    }
    out.shape(shape);
    out.numbers(&[*feed, *acceleration, *deceleration, *end_velocity, *tool_radius]);
    out.u8(*marks);
    out.flag(details.is_some());
    if let Some(details) = details {
        out.details(details);
    }
}

fn probe_bits(Probing { trips, required }: Probing, outcome: ProbeOutcome) -> u8 {
    let trips = match trips {
        ProbeTrip::Touch => 0,
        ProbeTrip::Release => PROBE_RELEASE,
    };
    let outcome = match outcome {
        ProbeOutcome::Unknown => 0,
        ProbeOutcome::Tripped => PROBE_TRIPPED,
        ProbeOutcome::NotTripped => PROBE_NOT_TRIPPED,
    };
    trips | outcome | if required { 0 } else { PROBE_OPTIONAL }
}

struct Writer<'a>(&'a mut Vec<u8>);

impl Writer<'_> {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    fn flag(&mut self, value: bool) {
        self.u8(value.into());
    }

    fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    fn number(&mut self, value: f64) {
        self.bytes(&value.to_le_bytes());
    }

    fn numbers(&mut self, values: &[f64]) {
        for value in values {
            self.number(*value);
        }
    }

    fn ends(&mut self, start: &Point3<f64>, end: &Point3<f64>) {
        self.numbers(start.coords.as_slice());
        self.numbers(end.coords.as_slice());
    }

    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { start, end } => {
                self.u8(LINE);
                self.ends(start, end);
            }
            Shape::Arc(arc) => {
                self.u8(ARC);
                self.u8(match arc.plane() {
                    Plane::Xy => 0,
                    Plane::Zx => 1,
                    Plane::Yz => 2,
                });
                self.ends(&arc.start(), &arc.end());
                self.numbers(arc.center().coords.as_slice());
                self.number(arc.sweep());
            }
            Shape::Ellipse(ellipse) => {
                self.u8(ELLIPSE);
                self.ends(&ellipse.start(), &ellipse.end());
                self.numbers(ellipse.center().coords.as_slice());
                self.numbers(ellipse.major().as_slice());
                self.numbers(&[ellipse.minor(), ellipse.sweep()]);
            }
            Shape::Cubic(cubic) => {
                self.u8(CUBIC);
                self.ends(&cubic.start(), &cubic.end());
                self.numbers(&cubic.x());
                self.numbers(&cubic.y());
            }
        }
    }

    fn details(&mut self, details: &Details) {
        self.flag(details.extra.is_some());
        if let Some(extra) = &details.extra {
            self.numbers(&extra.start);
            self.numbers(&extra.end);
        }
        self.bytes(&details.s_profile.0.to_le_bytes());
        let switches = details.switches.as_slice();
        // At most MAX_SWITCHES, by its type.
        self.u8(u8::try_from(switches.len()).unwrap_or(u8::MAX));
        for switch in switches {
            self.u8(switch.number);
            self.flag(switch.on);
            self.number(switch.at);
        }
        let MParameters { k, l, o } = &details.parameters;
        self.u8(u8::from(k.is_some()) | u8::from(l.is_some()) << 1 | u8::from(o.is_some()) << 2);
        self.numbers(k.as_slice());
        self.numbers(l.as_slice());
        self.numbers(o.as_ref().map_or(&[], |o| o.as_slice()));
    }
}

/// The element at the beginning of `bytes`, which moves on behind it.
///
/// # Errors
/// [`ContentError`]; `bytes` is then at the error, or a few bytes behind it.
pub(super) fn read(bytes: &mut &[u8]) -> Result<PathElement, ContentError> {
    let mut from = Reader(bytes);
    let line = from.u32()?;
    let block = from.optional(Reader::u32)?;
    let kind = match from.u8()? {
        RAPID => ElementKind::Rapid,
        CUT => ElementKind::Cut,
        JUMP => ElementKind::Jump,
        M_FUNCTION => ElementKind::MFunction { number: u16::from_le_bytes(from.take()?) },
        DWELL => ElementKind::Dwell { time_ns: i64::from_le_bytes(from.take()?) },
        PROBE => from.probe()?,
        value => return Err(ContentError::Unknown { field: "kind of element", value }),
    };
    let shape = from.shape()?;
    let [feed, acceleration, deceleration] = from.numbers()?;
    let end_velocity = from.limit()?;
    let tool_radius = from.number()?;
    let marks = Marks(from.u8()?);
    let details = from.optional(Reader::details)?.map(Box::new);
    Ok(PathElement {
        feed,
        acceleration,
        deceleration,
        end_velocity,
        tool_radius,
        marks,
        details,
        ..PathElement::new(Place { line, block }, kind, shape)
    })
}

struct Reader<'a, 'b>(&'a mut &'b [u8]);

impl Reader<'_, '_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ContentError> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(ContentError::Incomplete)?;
        *self.0 = rest;
        Ok(*taken)
    }

    fn u8(&mut self) -> Result<u8, ContentError> {
        let [value] = self.take()?;
        Ok(value)
    }

    fn u32(&mut self) -> Result<u32, ContentError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    fn probe(&mut self) -> Result<ElementKind, ContentError> {
        let bits = self.u8()?;
        let trips = if bits & PROBE_RELEASE == 0 { ProbeTrip::Touch } else { ProbeTrip::Release };
        let outcome = match bits & !(PROBE_RELEASE | PROBE_OPTIONAL) {
            0 => ProbeOutcome::Unknown,
            PROBE_TRIPPED => ProbeOutcome::Tripped,
            PROBE_NOT_TRIPPED => ProbeOutcome::NotTripped,
            _ => return Err(ContentError::Unknown { field: "probing move", value: bits }),
        };
        let probing = Probing { trips, required: bits & PROBE_OPTIONAL == 0 };
        Ok(ElementKind::Probe { probing, outcome })
    }

    fn flag(&mut self) -> Result<bool, ContentError> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            value => Err(ContentError::Unknown { field: "yes (1) or no (0)", value }),
        }
    }

    fn optional<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Result<T, ContentError>,
    ) -> Result<Option<T>, ContentError> {
        if self.flag()? { read(self).map(Some) } else { Ok(None) }
    }

    fn number(&mut self) -> Result<f64, ContentError> {
        let value = f64::from_le_bytes(self.take()?);
        if value.is_finite() { Ok(value) } else { Err(ContentError::NotFinite(value)) }
    }

    /// A number, or infinity where nothing limits.
    fn limit(&mut self) -> Result<f64, ContentError> {
        match f64::from_le_bytes(self.take()?) {
            f64::INFINITY => Ok(f64::INFINITY),
            value if value.is_finite() => Ok(value),
            value => Err(ContentError::NotFinite(value)),
        }
    }

    fn numbers<const N: usize>(&mut self) -> Result<[f64; N], ContentError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number()?;
        }
        Ok(numbers)
    }

    fn point(&mut self) -> Result<Point3<f64>, ContentError> {
        Ok(Point3::from(self.numbers::<3>()?))
    }

    fn shape(&mut self) -> Result<Shape, ContentError> {
        Ok(match self.u8()? {
            LINE => Shape::Line { start: self.point()?, end: self.point()? },
            ARC => {
                let plane = match self.u8()? {
                    0 => Plane::Xy,
                    1 => Plane::Zx,
                    2 => Plane::Yz,
                    value => return Err(ContentError::Unknown { field: "plane", value }),
                };
                let (start, end, center) = (self.point()?, self.point()?, self.point()?);
                Shape::Arc(Arc::in_plane(plane, start, end, center, self.number()?))
            }
            ELLIPSE => {
                let (start, end) = (self.point()?, self.point()?);
                let center = Point2::from(self.numbers::<2>()?);
                let major = Vector2::from(self.numbers::<2>()?);
                let [minor, sweep] = self.numbers()?;
                if sweep.abs() > MAX_ELLIPSE_SWEEP {
                    return Err(ContentError::Turns(sweep));
                }
                Shape::Ellipse(Box::new(Ellipse::new(start, end, center, major, minor, sweep)))
            }
            CUBIC => {
                let (start, end) = (self.point()?, self.point()?);
                let (x, y) = (self.numbers()?, self.numbers()?);
                Shape::Cubic(Box::new(Cubic::between(start, end, x, y)))
            }
            value => return Err(ContentError::Unknown { field: "shape", value }),
        })
    }

    fn details(&mut self) -> Result<Details, ContentError> {
        let extra =
            self.optional(|from| Ok(ExtraAxes { start: from.numbers()?, end: from.numbers()? }))?;
        let s_profile = AxisMask(u16::from_le_bytes(self.take()?));
        let count = self.u8()?;
        if usize::from(count) > MAX_SWITCHES {
            return Err(ContentError::Unknown { field: "number of switches", value: count });
        }
        let mut switches = Switches::default();
        for _ in 0..count {
            let switch = Switch { number: self.u8()?, on: self.flag()?, at: self.number()? };
            // There is room for as many as the count may be.
            let _fits = switches.add(switch);
        }
        let given = self.u8()?;
        if given > 0b111 {
            return Err(ContentError::Unknown { field: "set of parameters", value: given });
        }
        let mut parameters = MParameters::default();
        if given & 1 != 0 {
            parameters.k = Some(self.number()?);
        }
        if given & 2 != 0 {
            parameters.l = Some(self.number()?);
        }
        if given & 4 != 0 {
            parameters.o = Some(self.numbers()?);
        }
        Ok(Details { extra, s_profile, switches, parameters })
    }
}
