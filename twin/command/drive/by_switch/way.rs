//! Maximum search distance of homing by a switch.

use super::BySwitch;
use crate::command::Failure;
use twin_drives::{DeviceLimits, Drive};

/// Where neither the user nor the drive says how far, increments.
const USUAL_WAY: u32 = 100_000;

impl BySwitch {
    /// The longest way to the switch from the position of the axis, increments, and in words what it ends at where that is a limit of
    /// the drive's own.
    pub(super) fn way(
        &self,
        drive: &mut dyn Drive,
        from: i64,
        unit: &str,
    ) -> Result<(u32, String), Failure> {
        // Where the position says nothing yet, as a BIM2AX knows, its limits do not count.
        let lost = drive.homed()?.first().copied().flatten() == Some(false);
        let limits = drive.limits()?.first().copied().filter(|_| !lost).unwrap_or_default();
        self.within(&limits, from, unit).map_err(Failure::Usage)
    }

    fn within(
        &self,
        limits: &DeviceLimits,
        from: i64,
        unit: &str,
    ) -> Result<(u32, String), String> {
        let limit = if self.positive { limits.highest } else { limits.lowest };
        let Some(limit) = limit else {
            return Ok((self.max_way.unwrap_or(USUAL_WAY), String::new()));
        };
        let room = if self.positive { limit - from } else { from - limit };
        let room = u32::try_from(room.max(0)).unwrap_or(u32::MAX);
        let of_drive = format!("the drive's own limit is at {limit} {unit}");
        match self.max_way {
            _ if room == 0 => {
                let way = if self.positive { "--positive" } else { "without --positive" };
                Err(format!("{of_drive}, and the axis counts {from}: it cannot go on ({way})"))
            }
            Some(wanted) if wanted > room => Err(format!(
                "--max-way {wanted}: {of_drive}, which is {room} {unit} from the position of the axis, {from}"
            )),
            Some(wanted) => Ok((wanted, String::new())),
            None if room < USUAL_WAY => Ok((room, format!(" ({of_drive})"))),
            None => Ok((USUAL_WAY, String::new())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{BySwitch, DeviceLimits};
    use clap::{Args, Command, FromArgMatches};

    fn by_switch(words: &str) -> BySwitch {
        let command = BySwitch::augment_args(Command::new("home").no_binary_name(true));
        let found = command.try_get_matches_from(words.split(' ')).expect("words");
        BySwitch::from_arg_matches(&found).expect("words")
    }

    #[test]
    fn the_longest_way_ends_at_the_drives_own_limits() {
        let limits = DeviceLimits { lowest: Some(-1000), highest: Some(500_000), ..<_>::default() };
        let way = |words: &str, from| by_switch(words).within(&limits, from, "µsteps");
        let at_limit = " (the drive's own limit is at -1000 µsteps)".to_owned();
        assert_eq!(way("--by-switch 0", 200), Ok((1200, at_limit)));
        assert_eq!(way("--by-switch 0 --positive", 200), Ok((100_000, String::new())));
        assert_eq!(way("--by-switch 0 --max-way 1200", 200), Ok((1200, String::new())));
        let beyond = way("--by-switch 0 --max-way 1201", 200).unwrap_err();
        assert!(
            beyond.starts_with("--max-way 1201: ") && beyond.contains("1200 µsteps"),
            "{beyond}"
        );
        // On the limit, and outside of it.
        for from in [-1000, -1001] {
            assert!(way("--by-switch 0", from).unwrap_err().contains("it cannot go on"), "{from}");
        }
        let none = by_switch("--by-switch 0").within(&DeviceLimits::default(), 200, "steps");
        assert_eq!(none, Ok((100_000, String::new())));
    }
}
