//! What is said of another answer that fits alike, and of a slave that goes the other way.

use super::report::Report;
use serde_json::{Value, json};
use std::io::{self, Write};
use twin_motion::cam::tune::Fit;

impl Report<'_> {
    /// Whether a scaling has the other sign than the one of what is wanted.
    fn mirrors(&self, slave_scaling: f64) -> bool {
        let wanted = self.wanted.as_ref().unwrap_or(&self.before);
        slave_scaling * wanted.coupling.input.slave_scaling < 0.0
    }

    /// What a run tells as well, or of a slave that is mirrored.
    pub(super) fn tell_other(&self, out: &mut impl Write, fit: &Fit) -> io::Result<()> {
        let mirrored = self.mirrors(fit.slave_scaling.value);
        if mirrored {
            writeln!(
                out,
                "the slave is mirrored: SlaveScaling has the other sign than what is {}",
                if self.wanted.is_some() { "wanted" } else { "in effect" }
            )?;
        }
        let Some(other) = &fit.other else { return Ok(()) };
        let sought = Self::estimates(fit).map(|(name, found)| (name, found.half_width > 0.0));
        let values: Vec<_> = sought
            .into_iter()
            .zip(other)
            .enumerate()
            .filter(|(_, ((_, sought), _))| *sought)
            .map(|(index, ((name, _), value))| format!("{name} {}", self.input(index, *value)))
            .collect();
        let [.., factor] = other;
        let why = if self.mirrors(*factor) == mirrored {
            "the cam repeats itself: taken is the MasterOffset that is nearer to what is"
        } else {
            "the cam with a mirrored slave: taken is the sign that SlaveScaling has in what is"
        };
        let of = if self.wanted.is_some() { "wanted" } else { "in effect" };
        writeln!(out, "{} fits alike, as {why} {of}", values.join(", "))
    }

    /// The same as an object.
    pub(super) fn other_json(fit: &Fit) -> Value {
        let Some(other) = fit.other else { return Value::Null };
        let names = Self::estimates(fit).map(|(name, _)| name.to_owned());
        let values = names.into_iter().zip(other.map(|value| json!(value)));
        Value::Object(values.collect())
    }
}
