//! Tests of the parameters by number.

#![allow(
    clippy::float_cmp,
    reason = "set-points that are exact: targets, values at rest, what was written"
)]

use super::{Access, PARAMETERS, Parameter, Value};
use crate::{Axis, AxisConfig, Movement, SmcError};

/// The numbers of manual 2.4.
const MANUAL: &str = "1000 1001 1002 1003 1004 1006 1007 1008 1010 1011 1012 1013 1015 1016 1020 1021 1022 1023 1024 \
     1025 1026 1030 1031 1032 1035 1040 1041 1042 1043 1044 1051 1052 1053 1054 1055 1056 1057 1058 1060 1061 1091 \
     1092 1100 1101 1105 1106 1107 1110 1111 1112 1113 1115 1116 1117 1120 1121 1122 1123 1125 1126 1127 1130 1131 \
     1132 1133 1135 1137 1140 1141 1142 1143 1146 1150 1151 1152 1153 1160 1161 1162 1200 1201 1202 1204 1205 1206 \
     1207 1208 1210 1211 1215 1220 1221 1222 1223 1230 1231 1232 1234 1235 1236 1237 1300 1301";

#[test]
fn every_parameter_of_the_manual_is_there() {
    let numbers: Vec<u16> =
        MANUAL.split_whitespace().map(|number| number.parse().unwrap()).collect();
    let ours: Vec<u16> = PARAMETERS.iter().map(|parameter| parameter.number).collect();
    assert_eq!(ours, numbers);
    for parameter in PARAMETERS {
        let begins = match parameter.initial {
            Value::Bool(_) => "b",
            Value::Real(_) => "f",
            Value::Integer(_) => "inwtd",
        };
        let named = parameter.name.starts_with(|first| begins.contains(first));
        assert!(
            named
                || parameter.number == 1035
                || parameter.number == 1091
                || parameter.number == 1092,
            "{parameter:?}"
        );
    }
}

#[test]
fn initial_values_and_aliases_are_the_manuals() {
    let axis = Axis::new(AxisConfig::default());
    for (number, plcopen, name, initial) in [
        (1100, Some(1), "fSetPosition", 0.0),
        (1200, Some(2), "fSWLimitPositive", 0.0),
        (1201, Some(3), "fSWLimitNegative", 0.0),
        (1112, Some(9), "fMaxVelocity", 100.0),
        (1111, Some(10), "fActVelocity", 0.0),
        (1110, Some(11), "fSetVelocity", 0.0),
        (1122, Some(13), "fMaxAcceleration", 100.0),
        (1132, Some(15), "fMaxDeceleration", 100.0),
        (1142, Some(16), "fMaxJerk", 100.0),
        (1000, None, "nAxisState", 3.0),
        (1040, None, "fContrRpmP", 1.0),
        (1043, None, "fContrPosP", 1.0),
        (1053, None, "nDirection", 1.0),
        (1060, None, "iMovementType", 1.0),
        (1061, None, "fPositionPeriod", 1000.0),
        (1091, None, "byControllerMode", 3.0),
        (1113, None, "fSWMaxVelocity", 100.0),
        (1152, None, "fMaxCurrent", 100.0),
        (1153, None, "fSWMaxCurrent", 0.0),
        (1162, None, "fMaxTorque", 0.0),
    ] {
        assert_eq!(Parameter::by_number(number).map(|it| it.name), Some(name));
        assert_eq!(axis.read_parameter(number), Ok(initial), "{name}");
        if let Some(plcopen) = plcopen {
            assert_eq!(Parameter::by_number(plcopen).map(|it| it.name), Some(name));
        }
    }
    assert_eq!(PARAMETERS.iter().filter(|it| it.plcopen != 0).count(), 9);
    assert_eq!(axis.read_bool_parameter(1205), Ok(false));
}

#[test]
fn the_configuration_is_in_the_parameters() {
    let axis = Axis::new(AxisConfig {
        movement: Movement::Rotary { period: 360.0 },
        cycle: 0.004,
        max_velocity: 7.0,
        software_limits: Some([-3.0, 4.0]),
        ratio: [360, 65_536],
        ..AxisConfig::default()
    });
    let read = |number| axis.read_parameter(number).expect("a number");
    assert_eq!([1060, 1061, 1025, 1113].map(read), [0.0, 360.0, 0.004, 7.0]);
    assert_eq!([1200, 1201, 1051, 1052].map(read), [4.0, -3.0, 65_536.0, 360.0]);
    assert_eq!(axis.read_bool_parameter(1205), Ok(true));
}

#[test]
fn wrong_numbers_and_types_are_refused() {
    let mut axis = Axis::new(AxisConfig::default());
    for number in [0, 4, 999, 1005, 1302, u16::MAX] {
        assert_eq!(axis.read_parameter(number), Err(SmcError::RpParamUnknown), "{number}");
        assert_eq!(axis.write_parameter(number, 1.0), Err(SmcError::WpParamInvalid), "{number}");
    }
    assert_eq!(axis.read_parameter(1205), Err(SmcError::RpParamUnknown), "a BOOL");
    assert_eq!(axis.read_bool_parameter(1100), Err(SmcError::RpParamUnknown), "no BOOL");
    assert_eq!(axis.write_parameter(1100, 1.0), Err(SmcError::WpParamInvalid), "protected");
    assert_eq!(axis.write_bool_parameter(1113, true), Err(SmcError::WpParamInvalid));
    assert_eq!(axis.write_parameter(1113, f64::NAN), Err(SmcError::WpParamInvalid));
    assert_eq!(axis.write_parameter(1051, 1.5), Err(SmcError::WpParamInvalid), "a whole number");
}

#[test]
fn what_may_be_written_reads_back() {
    let mut axis = Axis::new(AxisConfig::default());
    for parameter in PARAMETERS {
        let number = parameter.number;
        let written = match parameter.initial {
            Value::Bool(value) => axis.write_bool_parameter(number, !value),
            _ => axis.write_parameter(number, 7.0),
        };
        assert_eq!(written.is_ok(), parameter.access == Access::Write, "{}", parameter.name);
        if written.is_ok() {
            match parameter.initial {
                Value::Bool(value) => assert_eq!(axis.read_bool_parameter(number), Ok(!value)),
                _ => assert_eq!(axis.read_parameter(number), Ok(7.0)),
            }
        }
    }
    assert_eq!(axis.write_parameter(9, 3.0), Ok(()));
    assert_eq!(axis.read_parameter(1112), Ok(3.0), "PLCopen's number 9");
}

/// The manual's table has both wrong: `wCyclicDataR1` to `R3` are what is received, and `fLastCapturePosition` is the end of the
/// window.
#[test]
fn what_the_manual_describes_twice_is_told_apart() {
    let about = |number| Parameter::by_number(number).unwrap().about;
    for (sent, received) in [(1002, 1006), (1003, 1007), (1004, 1008)] {
        assert!(about(sent).contains("sent"), "{}", about(sent));
        assert!(about(received).contains("received"), "{}", about(received));
    }
    assert!(about(1220).contains("begin"), "{}", about(1220));
    assert!(about(1221).contains("end"), "{}", about(1221));
    // They are values of their own.
    let mut axis = Axis::new(AxisConfig::default());
    for number in [1002, 1006, 1007, 1008] {
        axis.write_parameter(number, f64::from(number)).unwrap();
    }
    for number in [1002, 1006, 1007, 1008] {
        assert_eq!(axis.read_parameter(number), Ok(f64::from(number)));
    }
}
