//! Files that are wrong, and devices that do not obey.

use super::*;
use crate::{
    Action, Drive, DriveError, Exchange, Identity, Increments, MAX_DRIVE_AXES, ParameterId,
    ParameterInfo, Sample, SetpointStream, Values,
};

/// Two parameters and a version, no axes.
#[expect(clippy::struct_excessive_bools, reason = "each is a fault of its own")]
#[derive(Debug)]
struct Shelf {
    values: [i64; 3],
    /// Refuses the second.
    refuses: bool,
    /// Loses parameters when it is to save them.
    forgets: bool,
    saved: u32,
    silent: bool,
    /// Tells what parameters it has, not their values.
    secretive: bool,
}

impl Shelf {
    fn new() -> Self {
        let [refuses, forgets, silent, secretive] = [false; 4];
        Self { values: [1, 2, 77], refuses, forgets, saved: 0, silent, secretive }
    }

    fn place(id: ParameterId) -> Result<usize, DriveError> {
        let known = (id.address == 0).then(|| usize::from(id.number)).filter(|place| *place < 3);
        known.ok_or_else(|| DriveError::NoParameter { at: Self::at(), id })
    }

    fn at() -> Exchange {
        Exchange { port: "shelf".into(), address: 0, action: Action::Nothing }
    }

    fn never<T>() -> Result<T, DriveError> {
        Err(DriveError::Unsupported { at: Self::at(), what: "axis" })
    }
}

impl Drive for Shelf {
    fn describe(&self) -> String {
        "a shelf\nwith two lines & <marks>".to_owned()
    }

    fn axis_count(&self) -> usize {
        0
    }

    fn identity(&mut self) -> Result<Identity, DriveError> {
        Ok(Identity { family: "Shelf", units: Vec::new() })
    }

    fn probe(&mut self, _stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        Self::never()
    }

    fn enable(&mut self) -> Result<(), DriveError> {
        Self::never()
    }

    fn set_output(&mut self, _output: u8, _on: bool) -> Result<(), DriveError> {
        Self::never()
    }

    fn set_position(&mut self, _position: &Increments) -> Result<(), DriveError> {
        Self::never()
    }

    fn move_to(
        &mut self,
        _target: &Increments,
        _speed: &[f64; MAX_DRIVE_AXES],
    ) -> Result<(), DriveError> {
        Self::never()
    }

    fn sample(&mut self, _stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        Self::never()
    }

    fn follow(&mut self, _stream: &dyn SetpointStream) -> Result<Sample, DriveError> {
        Self::never()
    }

    fn soft_stop(&mut self) -> Result<(), DriveError> {
        Self::never()
    }

    fn hard_stop(&mut self) -> Result<(), DriveError> {
        Self::never()
    }

    fn parameters(&mut self) -> Result<Vec<ParameterInfo>, DriveError> {
        if self.silent {
            let deadline = std::time::Duration::from_millis(1);
            return Err(DriveError::Timeout { at: Self::at(), deadline });
        }
        let id = |number| ParameterId { address: 0, number };
        let speed = ParameterInfo {
            unit: "rpm",
            ..ParameterInfo::new(id(0), "speed".to_owned(), Values::Between(1, 500))
        };
        let mode = ParameterInfo {
            needs_restart: true,
            ..ParameterInfo::new(id(1), "\"mode\"".to_owned(), Values::OneOf(vec![2, 4]))
        };
        let version = ParameterInfo {
            writable: false,
            ..ParameterInfo::new(id(2), "version".to_owned(), Values::Between(0, 99))
        };
        Ok(vec![speed, mode, version])
    }

    fn parameter(&mut self, id: ParameterId) -> Result<i64, DriveError> {
        if self.secretive {
            return Self::never();
        }
        let place = Self::place(id)?;
        Ok(self.values[place])
    }

    fn set_parameter(&mut self, id: ParameterId, value: i64) -> Result<(), DriveError> {
        let place = Self::place(id)?;
        if self.refuses && place == 1 {
            return Err(DriveError::ReadOnly { at: Self::at(), id });
        }
        self.values[place] = value;
        Ok(())
    }

    fn save_parameters(&mut self) -> Result<(), DriveError> {
        self.saved += 1;
        if self.forgets {
            self.values = [1, 2, 77];
        }
        Ok(())
    }
}

fn from(text: &str) -> Result<Backup, BackupError> {
    read("shelf.txt", &mut text.as_bytes())
}

const GOOD: &str = "drive-parameters 1\nfamily Shelf\n0 0 500 # the fastest\n\n0 1 4\n0 2 78\n";

#[test]
fn a_file_is_what_it_says() {
    let mut shelf = Shelf::new();
    let mut text = Vec::new();
    write_parameters(&mut shelf, "f", &mut text).unwrap();
    let expected = "drive-parameters 1\n# a shelf with two lines & <marks>\nfamily Shelf\n\
        # station number value\n0 0 1 # speed [rpm]\n0 1 2 # \"mode\"\n0 2 77 # version, read-only\n";
    assert_eq!(String::from_utf8(text).unwrap(), expected);
}

#[test]
fn a_plan_says_what_would_change_and_changes_nothing() {
    let mut shelf = Shelf::new();
    let plan = plan(&mut shelf, &from(GOOD).unwrap()).unwrap();
    assert_eq!(shelf.values, [1, 2, 77]);
    let expected = "parameter 0 (speed): 1 -> 500 rpm\n\
        parameter 1 (\"mode\"): 2 -> 4, after a restart\n\
        parameter 2 (version): 77 -> 78: left as it is, read-only\n2 to change, 0 as they are";
    assert_eq!(plan.to_string(), expected);
    assert!(plan.needs_restart() && !plan.is_empty());
    plan.carry_out(&mut shelf, false).unwrap();
    assert_eq!((shelf.values, shelf.saved), ([500, 4, 77], 0));
    let again = super::plan(&mut shelf, &from(GOOD).unwrap()).unwrap();
    assert!(again.is_empty() && again.same == 2);
    again.carry_out(&mut shelf, true).unwrap();
    assert_eq!(shelf.saved, 0, "nothing to save");
}

#[test]
fn a_device_that_does_otherwise_is_found_out() {
    let backup = from(GOOD).unwrap();
    let mut shelf = Shelf { refuses: true, ..Shelf::new() };
    let error = plan(&mut shelf, &backup).unwrap().carry_out(&mut shelf, true).unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("parameter 1 (\"mode\") = 4: shelf: "), "{text}");
    assert!(text.ends_with("; 1 of 2 changes have been made"), "{text}");
    let mut shelf = Shelf { forgets: true, ..Shelf::new() };
    let error = plan(&mut shelf, &backup).unwrap().carry_out(&mut shelf, true).unwrap_err();
    assert_eq!(error.to_string(), "parameter 0 (speed) reads 1 after 500 was written");
}

#[test]
fn every_wrong_line_is_told() {
    let wrong = |text: &str| match from(text) {
        Err(error @ BackupError::Lines(_)) => error.to_string(),
        other => panic!("{other:?}"),
    };
    let text = "drive-parameters 2\nfamily\n0 0\n300 x 1 2\n0 70000 9223372036854775808\n";
    let expected = "shelf.txt:1: version \"2\" is not known (1)\n\
        shelf.txt:2: family is missing\n\
        shelf.txt:3: value is missing\n\
        shelf.txt:4: station: \"300\" is not a whole number from 0 to 255\n\
        shelf.txt:4: number: \"x\" is not a whole number from 0 to 65535\n\
        shelf.txt:4: \"2\" is not expected here\n\
        shelf.txt:5: number: \"70000\" is not a whole number from 0 to 65535\n\
        shelf.txt:5: value: \"9223372036854775808\" is not a whole number from \
        -9223372036854775808 to 9223372036854775807";
    assert_eq!(wrong(text), expected);
    assert_eq!(wrong("hello"), "shelf.txt:1: this is not a file of drive parameters");
    assert_eq!(wrong(""), "shelf.txt:1: this is not a file of drive parameters");
    assert_eq!(wrong("drive-parameters 1\n"), "shelf.txt:1: family is missing");
    assert_eq!(wrong("<a/>"), "shelf.txt:1: this is not a file of drive parameters");
}

#[test]
fn what_the_device_cannot_have_is_told_by_line() {
    let mut shelf = Shelf::new();
    let text = "drive-parameters 1\nfamily shelf\n0 0 501\n0 1 3\n0 9 1\n1 0 1\n0 0 7\n";
    let error = plan(&mut shelf, &from(text).unwrap()).unwrap_err();
    let expected = "shelf.txt:3: parameter 0 (speed) = 501 is impossible (1 to 500)\n\
        shelf.txt:4: parameter 1 (\"mode\") = 3 is impossible (2, 4)\n\
        shelf.txt:5: the device has no parameter 9\n\
        shelf.txt:6: the device has no parameter 0 at address 1\n\
        shelf.txt:7: parameter 0 is given in line 3 already";
    assert_eq!((error.to_string().as_str(), error.number()), (expected, None));
    assert_eq!(shelf.values, [1, 2, 77]);
}

#[test]
fn files_that_fail_are_named() {
    let (mut shelf, mut full) = (Shelf::new(), [0_u8; 9]);
    let error = write_parameters(&mut shelf, "a/b.txt", &mut full.as_mut_slice()).unwrap_err();
    assert_eq!(error.number(), Some(3002));
    assert!(error.to_string().starts_with("a/b.txt: cannot be written"), "{error}");
    let mut silent = Shelf { silent: true, ..Shelf::new() };
    let mut file = Vec::new();
    let error = write_parameters(&mut silent, "f", &mut file).unwrap_err();
    assert_eq!((error.number(), file.len()), (Some(3004), 0));
    let mut secretive = Shelf { secretive: true, ..Shelf::new() };
    let error = write_parameters(&mut secretive, "f", &mut file).unwrap_err();
    assert_eq!((error.number(), file.len()), (Some(3003), 0));
    let error = read("a/b.txt", &mut std::fs::File::open(".").unwrap()).unwrap_err();
    assert!(error.to_string().starts_with("a/b.txt: cannot be read"), "{error}");
    // Half of a backup must not be restored.
    let error = read("a/b.txt", &mut std::io::repeat(b'#')).unwrap_err().to_string();
    assert!(error.contains("it has more than 4194304 bytes, the most that are read"), "{error}");
}
