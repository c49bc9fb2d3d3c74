//! Profile as a CSV table.

use super::ProfileSample;
use csv::{ByteRecord, Writer};
use std::io::Write;
use twin_machine::Axis;
use twin_number::{exact_seconds, significant};

/// Significant digits of all numbers but times, which are whole nanoseconds.
const DIGITS: usize = 12;

/// Writes a profile as CSV: a header that names every column with its unit, then a line per sample.
///
/// The columns are `time_s`, `line`, `block` (empty without an N word), `path_mm`, `feed_mm_per_s`,
/// `velocity_mm_per_s`, `acceleration_mm_per_s2`, `jerk_mm_per_s3`; for an axis named A `A_deg`, `A_velocity_deg_per_s`,
/// `A_acceleration_deg_per_s2`, `A_jerk_deg_per_s3` (mm for linear axes) and, where the efforts of motors are known,
/// `A_torque_nm` (`A_force_n`); then the limit that holds the path back,
/// `limited_by` ([`super::Binding::name`]), and its axis, `limited_by_axis`.
#[derive(Debug)]
pub struct ProfileCsv<'m, W: Write> {
    axes: &'m [Axis],
    efforts: bool,
    writer: Writer<W>,
    record: ByteRecord,
}

impl<'m, W: Write> ProfileCsv<'m, W> {
    /// Writes the header. With `efforts` the samples have those of the motors.
    ///
    /// # Errors
    /// If `out` cannot be written.
    pub fn new(out: W, axes: &'m [Axis], efforts: bool) -> Result<Self, csv::Error> {
        let mut writer = Writer::from_writer(out);
        let mut header: Vec<String> = [
            "time_s",
            "line",
            "block",
            "path_mm",
            "feed_mm_per_s",
            "velocity_mm_per_s",
            "acceleration_mm_per_s2",
            "jerk_mm_per_s3",
        ]
        .map(str::to_owned)
        .to_vec();
        for axis in axes {
            let (name, unit) = (&axis.name, axis.unit());
            header.push(format!("{name}_{unit}"));
            header.push(format!("{name}_velocity_{unit}_per_s"));
            header.push(format!("{name}_acceleration_{unit}_per_s2"));
            header.push(format!("{name}_jerk_{unit}_per_s3"));
            if efforts {
                let unit = axis.kind.effort_unit().to_lowercase();
                header.push(format!("{name}_{}_{unit}", axis.kind.effort_name()));
            }
        }
        header.extend(["limited_by", "limited_by_axis"].map(str::to_owned));
        writer.write_record(&header)?;
        Ok(Self { axes, efforts, writer, record: ByteRecord::new() })
    }

    /// Writes one line.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn write(&mut self, sample: &ProfileSample) -> Result<(), csv::Error> {
        let record = &mut self.record;
        record.clear();
        let mut field = |text: &str| record.push_field(text.as_bytes());
        let number = |value: f64| significant(value, DIGITS);
        field(&exact_seconds(sample.time_ns));
        field(&sample.place.line.to_string());
        field(&sample.place.block.map_or_else(String::new, |block| block.to_string()));
        for metres in [
            sample.way,
            sample.feed,
            sample.path_velocity,
            sample.path_acceleration,
            sample.path_jerk,
        ] {
            field(&number(metres * 1e3));
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let of = [&sample.position, &sample.velocity, &sample.acceleration, &sample.jerk];
            for values in of {
                let value = values.get(index).copied().unwrap_or_default();
                field(&number(axis.from_si(value)));
            }
            if self.efforts {
                let effort = sample.effort.and_then(|effort| effort.get(index).copied());
                field(&effort.map_or_else(String::new, number));
            }
        }
        field(sample.binding.map_or("", super::Binding::name));
        let axis = sample.binding.and_then(|binding| binding.axis(self.axes));
        field(axis.map_or("", |axis| &axis.name));
        self.writer.write_byte_record(record)
    }

    /// Flushes the output and returns it.
    ///
    /// # Errors
    /// If the output cannot be written.
    pub fn finish(self) -> std::io::Result<W> {
        self.writer.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}
