//! Tests of the number formats.

use super::{Short, apart, at_most, beside, exact_seconds, fixed, readable, significant};
use std::f64::consts::PI;

#[test]
fn short_numbers() {
    for (value, text) in [
        (5.999_999_999_999_999, "6"),
        (0.1 + 0.2, "0.3"),
        (-0.0, "0"),
        (-12.5, "-12.5"),
        (24.9, "24.9"),
        (1e-5 + 1e-22, "0.00001"),
        (1.25e-20, "1.25e-20"),
        (2e9, "2000000000"),
        (1e20, "1e20"),
        (f64::INFINITY, "inf"),
    ] {
        assert_eq!(Short(value).to_string(), text, "{value:e}");
    }
}

#[test]
fn people_get_powers_of_ten_instead_of_zeros() {
    for (value, text) in [
        (6e-16, "6e-16"),
        (-1.234_567_8e300, "-1.23457e300"),
        (9.999_999_9e-10, "1e-9"),
        (1e-9, "0.000000001"),
        (999_999_000_000_000.0, "999999000000000"),
        (1e15, "1e15"),
        (0.0, "0"),
        (f64::INFINITY, "inf"),
    ] {
        assert_eq!(readable(value, 6), text);
    }
}

#[test]
fn zero_has_no_sign() {
    for (value, decimals, text) in [
        (-0.04, 1, "0.0"),
        (-0.0, 1, "0.0"),
        (-0.4, 0, "0"),
        (-0.05, 2, "-0.05"),
        (-10.0, 1, "-10.0"),
        (0.04, 1, "0.0"),
    ] {
        assert_eq!(fixed(value, decimals), text);
    }
}

#[test]
fn rounding_of_a_larger_scale_is_zero() {
    for (value, scale, text) in [
        (4.4e-16, 360.0, "0"),
        (-4.4e-16, -1.0, "0"),
        (4.4e-16, 1e-15, "4.4e-16"),
        (0.0, 0.0, "0"),
        (1.999_999_967, 1.0, "2"),
    ] {
        assert_eq!(beside(value, scale, 6), text);
    }
}

#[test]
fn a_value_beyond_its_limit_differs_from_it() {
    for (value, limit, texts) in [
        (205.123_456_789, 205.0, ["205.123", "205"]),
        (205.000_000_4, 205.0, ["205.0000004", "205"]),
        (-3.0, 2.0, ["-3", "2"]),
        (1.0, 1.0, ["1", "1"]),
        (2e-12, 1.999_999_9e-12, ["2e-12", "1.9999999e-12"]),
    ] {
        assert_eq!(apart(value, limit), texts);
    }
}

#[test]
fn a_limit_is_not_rounded_up() {
    for (value, text) in [
        (361.127_73, "361.127"),
        (361.127_23, "361.127"),
        (0.000_999_999_7, "0.000999999"),
        (299.999_999_999_999_94, "300"),
        (7.0, "7"),
        (0.0, "0"),
        (f64::INFINITY, "inf"),
        (5.999_999_96e-16, "5.99999e-16"),
        (6e-16, "6e-16"),
    ] {
        assert_eq!(at_most(value, 6), text);
    }
}

#[test]
fn digits_are_significant_not_decimal() {
    for (value, digits, text) in [
        (0.0, 12, "0"),
        (-0.0, 12, "0"),
        (PI, 12, "3.14159265359"),
        (100.0 * PI, 12, "314.159265359"),
        (-PI * 1e-6, 12, "-0.00000314159265359"),
        (9.999_96, 5, "10"),
        (1234.5, 12, "1234.5"),
        (123_456.0, 3, "123456"),
        (f64::INFINITY, 3, "inf"),
    ] {
        assert_eq!(significant(value, digits), text);
    }
}

#[test]
fn times_are_exact() {
    for (ns, text) in [
        (0, "0"),
        (1, "0.000000001"),
        (1_500_000_000, "1.5"),
        (86_400_000_000_001, "86400.000000001"),
        (-2_000_000, "-0.002"),
        (i64::MAX, "9223372036.854775807"),
    ] {
        assert_eq!(exact_seconds(ns), text);
    }
}
