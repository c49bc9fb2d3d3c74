//! Units in the headers of points: velocity and acceleration are those of the slave by its master (manual 4.7), never by time.

use crate::cam_file::form::unit_of;

/// Columns of derivatives, each with the power of the master's unit in its own.
const DERIVATIVES: [(&str, &str); 2] = [("velocity", ""), ("acceleration", "2")];

/// Units of time, by which `twin cam sample` and recordings have their derivatives.
const TIMES: [&str; 7] = ["s", "sec", "ms", "us", "µs", "min", "h"];

/// Checks the units of the columns `velocity` and `acceleration` against those of `master` and `slave`. Unknown
/// units fit anything but a time.
pub(super) fn check(names: &[String]) -> Result<(), String> {
    let [master, slave, derivatives @ ..] = names else { return Ok(()) };
    let [x, y] = [master, slave].map(|name| unit_of(name));
    for (name, (what, power)) in derivatives.iter().zip(DERIVATIVES) {
        let said = super::columns::unit(name);
        let Some(by) = wrong(said, [&x, &y], power) else { continue };
        let [known_x, known_y] = [&x, &y].map(|unit| if unit.is_empty() { "u" } else { unit });
        let raised = if power.is_empty() { "" } else { "²" };
        let [key_x, key_y] = [known_x, known_y].map(normal);
        let plain = [&key_x, &key_y].iter().all(|key| key.chars().all(char::is_alphanumeric));
        let right = if plain {
            format!("{what}_{key_y}_per_{key_x}{power}")
        } else {
            format!("{what} ({known_y}/({known_x}){raised})")
        };
        let of_points = format!("the {what} of points is in {known_y}/{known_x}{raised}");
        return Err(match by {
            By::Time => format!(
                "column `{name}` is by time, as `twin cam sample` writes it; {of_points}, by the master: expected `{right}`, or \
                 `{master}` and `{slave}` alone, which make a table (`twin cam convert` writes points)"
            ),
            By::Other => format!("column `{name}`: {of_points}; expected `{right}`"),
        });
    }
    Ok(())
}

/// Unit that a derivative is by, if it is not that of the master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum By {
    Time,
    Other,
}

/// Error of a unit, if any; `u` and an empty text are units that are not known.
fn wrong(said: &str, [master, slave]: [&str; 2], power: &str) -> Option<By> {
    let said = normal(said);
    if said.is_empty() {
        return None;
    }
    let [master, slave] = [master, slave].map(normal);
    // A slave whose unit is a fraction has its own stroke.
    let (above, below) = match said.strip_prefix(&slave).filter(|_| !slave.is_empty()) {
        Some(rest) => (slave.as_str(), rest.strip_prefix('/').unwrap_or_default()),
        None => said.split_once('/').unwrap_or((&said, "")),
    };
    let Some(below) = below.strip_suffix(power).filter(|below| !below.is_empty()) else {
        return Some(By::Other);
    };
    let unsaid = |unit: &str| unit.is_empty() || unit == "u";
    if below != master && TIMES.contains(&below) {
        return Some(By::Time);
    }
    let fits = |said: &str, known: &str| said == known || unsaid(known) || unsaid(said);
    (!(fits(above, &slave) && fits(below, &master))).then_some(By::Other)
}

/// `mm/deg2` of `mm_per_deg2`, `mm per °²` and `mm/(deg)^2`.
fn normal(unit: &str) -> String {
    let words = unit.split(|c: char| "_ ()[]^".contains(c));
    let text: String = words.map(|word| if word == "per" { "/" } else { word }).collect();
    text.replace('°', "deg").replace('²', "2").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::check;

    fn of(header: &str) -> Result<(), String> {
        check(&header.split(';').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn units_of_points_are_by_the_master() {
        for header in [
            "master;slave;velocity;acceleration",
            "master_deg;slave_mm;velocity;acceleration",
            "master_deg;slave_mm;velocity_mm_per_deg;acceleration_mm_per_deg2",
            "master (°);slave (mm);velocity (mm/°);acceleration (mm/°²)",
            "master [deg];slave [mm];velocity [mm/deg];acceleration [mm/deg^2]",
            "master_deg;slave_mm;Velocity mm per deg;Acceleration mm per deg^2",
            "master_u;slave_u;velocity_u_per_u;acceleration_u_per_u2",
            "master;slave;velocity_mm_per_deg;acceleration_mm_per_deg2",
            "master (1/min);slave_mm;velocity (mm/(1/min));acceleration (mm/(1/min)²)",
            "master_deg;slave (m/s);velocity (m/s/deg);acceleration (m/s/deg²)",
            // A cam over time: its master is one.
            "master_s;slave_mm;velocity_mm_per_s;acceleration_mm_per_s2",
        ] {
            assert_eq!(of(header), Ok(()), "{header}");
        }
    }

    #[test]
    fn other_units_are_refused_with_the_right_one() {
        for (header, words) in [
            (
                "master_deg;slave_mm;velocity_mm_per_s;acceleration_mm_per_s2;jerk_mm_per_s3",
                "`velocity_mm_per_s` is by time, as `twin cam sample` writes it; the velocity of points is in mm/deg, by the \
                 master: expected `velocity_mm_per_deg`, or `master_deg` and `slave_mm` alone",
            ),
            ("master;slave;velocity_u_per_s;acceleration", "`velocity_u_per_s` is by time"),
            (
                "master_deg;slave_mm;velocity_mm_per_deg;acceleration_mm_per_s2",
                "the acceleration of points is in mm/deg², by the master: expected `acceleration_mm_per_deg2`",
            ),
            (
                "master_deg;slave_mm;velocity_mm_per_mm;acceleration_mm_per_mm2",
                "column `velocity_mm_per_mm`: the velocity of points is in mm/deg; expected `velocity_mm_per_deg`",
            ),
            ("master_deg;slave_mm;velocity_deg_per_mm;acceleration", "`velocity_deg_per_mm`"),
            ("master_deg;slave_mm;velocity_cm_per_deg;acceleration", "`velocity_cm_per_deg`"),
            ("master_deg;slave_mm;velocity_mm;acceleration", "`velocity_mm`"),
            (
                "master_deg;slave_mm;velocity_mm_per_deg;acceleration_mm_per_deg",
                "expected `acceleration_mm_per_deg2`",
            ),
            (
                "master_s;slave_mm;velocity_mm_per_ms;acceleration",
                "`velocity_mm_per_ms` is by time",
            ),
            (
                "master (1/min);slave_mm;velocity_mm_per_deg;acceleration",
                "expected `velocity (mm/(1/min))`",
            ),
        ] {
            let said = of(header).expect_err(header);
            assert!(said.contains(words), "{header}: {said}");
        }
    }
}
