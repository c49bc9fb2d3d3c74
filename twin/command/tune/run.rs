//! Report on a run: offsets and scalings, the slave's error, and the dead time.

use super::report::{Report, Section, short};
use crate::cam::check::CamUse;
use crate::command::show::table;
use serde_json::{Map, Value, json};
use twin_cam::MasterMotion;
use twin_cam::tune::{Estimate, Fit};

fn estimate(Estimate { value, half_width }: Estimate) -> Value {
    json!({ "value": value, "half_width_95": half_width })
}

impl Report<'_> {
    /// Offsets and scalings of the run.
    pub(super) fn fit(&self) -> Section {
        let Some(fit) = &self.fit else { return Section::empty("fit") };
        let measured = self.wanted.is_some();
        let numbers = |using: &CamUse| using.coupling.numbers().map(|(.., value)| value);
        let columns = self.wanted.as_ref().map(|wanted| [wanted, &self.before, &self.after]);
        let mut rows = table();
        let found = if measured { "the slave was at" } else { "found in the run" };
        let more: &[_] =
            if measured { &["wanted", "in effect", "proposed", "± (95 %)"] } else { &[] };
        rows.set_header([&[found, "value", "± (95 %)"], more].concat());
        let [mut estimates, mut proposed] = [Map::new(), Map::new()];
        let names = self.before.coupling.numbers().map(|(_, name, _)| name);
        for (index, (found, name)) in fit.estimates.into_iter().zip(names).enumerate() {
            let half = found.half_width;
            let half = if half > 0.0 { short(half) } else { "given".to_owned() };
            let mut row = vec![name.to_owned(), self.input(index, found.value), half];
            row.extend(
                columns.iter().flatten().map(|using| self.input(index, numbers(using)[index])),
            );
            let own = self.undoes(index);
            if measured {
                row.push(own.map(|own| short(own.half_width)).unwrap_or_default());
            }
            rows.add_row(row);
            estimates.insert(name.to_owned(), estimate(found));
            proposed.extend(own.map(|own| (name.to_owned(), estimate(own))));
        }
        let value = json!({
            "estimates": estimates, "proposed": self.proposed.as_ref().map(|_| proposed),
            "samples": self.samples, "rms_before": self.error_before, "rms_after": self.error_after,
            "correlation": fit.correlation, "quantum": fit.quantum,
        });
        let mut text = vec![rows.to_string()];
        text.extend(self.notes(fit));
        Section { key: "fit", value, text }
    }

    /// What undoes a deviation, if nothing else changed the value.
    fn undoes(&self, index: usize) -> Option<Estimate> {
        let found = self.proposed?[index];
        let [before, after] =
            [&self.before, &self.after].map(|using| using.coupling.numbers()[index].2.to_bits());
        let own = after == found.value.to_bits() && before != after && found.half_width > 0.0;
        own.then_some(found)
    }

    fn notes(&self, fit: &Fit) -> Vec<String> {
        let ([master, slave], measured) = (self.units(), self.wanted.is_some());
        let mut text = Vec::new();
        if measured {
            text.push(
                "`slave` is the position measured with the coupling in effect; the proposal corrects its deviation from the wanted motion (with --slave wanted the run itself is that motion)"
                    .to_owned(),
            );
        }
        let reference = self.wanted.as_ref().unwrap_or(&self.before);
        if fit.estimates[3].value * reference.coupling.input.slave_scaling < 0.0 {
            let what = if measured { "wanted" } else { "in effect" };
            text.push(format!(
                "the slave is mirrored: SlaveScaling has the other sign than what is {what}"
            ));
        }
        let MasterMotion { velocity, acceleration, .. } = self.before.master;
        let [velocity, acceleration] = [velocity, acceleration].map(short);
        text.push(format!(
            "the master goes {velocity} {master}/s at most, its acceleration within ±{acceleration} {master}/s²"
        ));
        for ((name, period), unit) in
            ["master", "slave"].into_iter().zip(self.wound).zip(self.units())
        {
            text.extend(period.map(|period| {
                let period = short(period);
                format!(
                    "the {name} is recorded within its period of {period} {unit}, and unwrapped"
                )
            }));
        }
        let [before, after] = [self.error_before, self.error_after]
            .map(|error| self.slave(error.unwrap_or_default()));
        let (samples, tense) = (self.samples, if measured { "would be" } else { "is" });
        text.push(format!(
            "{samples} samples; the slave's error was {before} {slave} rms and {tense} {after} {slave}"
        ));
        if fit.quantum > 0.0 {
            let step = short(fit.quantum);
            text.push(format!(
                "the slave's positions are rounded to {step} {slave}; the intervals hold that"
            ));
        }
        if samples < Fit::SAMPLES {
            let enough = Fit::SAMPLES;
            text.push(format!(
                "the intervals of {samples} samples (fewer than {enough}) assume noise that is independent from sample to sample; so few samples do not show whether it is"
            ));
        }
        text
    }

    /// The dead time of the tappets.
    pub(super) fn dead_time(&self) -> Section {
        let mut text: Vec<String> = Vec::new();
        text.extend(self.no_dead_time.as_ref().map(|why| format!("{why}; it is left as it is")));
        let value = self.dead_time.map(|(found, count)| {
            let ms = |seconds: f64| short(seconds * 1e3);
            let [value, half] = [found.value, found.half_width].map(ms);
            let compensated = ms(self.before.coupling.dead_time_s);
            text.push(format!(
                "dead time of the tappets: {value} ± {half} ms (95 %), of {count} switchings, if the run was recorded with \
                 DeadTimeCompensation {compensated} ms in effect"
            ));
            json!({ "dead_time_s": estimate(found), "switchings": count })
        });
        Section { key: "dead_time", value: json!(value), text }
    }
}
