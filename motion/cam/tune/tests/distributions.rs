//! Distributions against printed tables and closed forms.

use super::super::distributions::{
    correlation_exceeds, fisher_exceeds, student_975, student_exceeds,
};

/// From the printed tables of F.
#[test]
fn tables_of_fisher() {
    for (above, below, f, chance) in [
        (1.0, 1.0, 161.45, 0.05),
        (2.0, 8.0, 4.459, 0.05),
        (4.0, 20.0, 4.431, 0.01),
        (3.0, 12.0, 5.953, 0.01),
        (4.0, 120.0, 2.447, 0.05),
    ] {
        let found = fisher_exceeds(f, above, below);
        assert!((found / chance - 1.0).abs() < 2e-3, "{above} {below}: {found}");
    }
    // With two above it is closed: (1 + 2·f/n)^(−n/2).
    for (below, f) in [(8.0_f64, 36.0_f64), (5.0, 1.5), (400.0, 12.0), (2.0, 1e6)] {
        let closed = (1.0 + 2.0 * f / below).powf(-below / 2.0);
        let found = fisher_exceeds(f, 2.0, below);
        assert!((found / closed - 1.0).abs() < 1e-10, "{below} {f}: {found} {closed}");
    }
    assert!(fisher_exceeds(0.0, 2.0, 9.0) >= 1.0);
    assert!(fisher_exceeds(f64::INFINITY, 2.0, 9.0) <= 0.0);
}

#[test]
fn student_is_the_same_as_by_its_own_series() {
    for freedom in [1_u32, 2, 7, 30, 400] {
        let count = usize::try_from(freedom).expect("a count");
        let found = student_exceeds(student_975(count), f64::from(freedom));
        assert!((found - 0.05).abs() < 1e-9, "{freedom}: {found}");
    }
}

/// Of 200,000 draws of noise as many exceed a correlation as it says, a tenth more or less.
#[test]
fn correlations_of_noise() {
    let mut random = super::Random(11);
    for (samples, r) in [(6_usize, 0.6), (12, 0.5), (20, 0.45)] {
        let mut beyond = 0_u32;
        for _ in 0..200_000 {
            let (mut square, mut product, mut before) = (0.0, 0.0, 0.0);
            for _ in 0..samples {
                let e = random.normal();
                square += e * e;
                product += e * before;
                before = e;
            }
            beyond += u32::from((product / square).abs() > r);
        }
        let (found, said) = (f64::from(beyond) / 2e5, correlation_exceeds(r, samples));
        assert!((found / said - 1.0).abs() < 0.1, "{samples}: {found} {said}");
    }
    assert!(correlation_exceeds(1.0, 12) <= 0.0);
}
/// From the printed tables.
#[test]
fn tables_of_student() {
    for (freedom, value) in [
        (1, 12.706),
        (2, 4.303),
        (3, 3.182),
        (4, 2.776),
        (5, 2.571),
        (10, 2.228),
        (11, 2.201),
        (30, 2.042),
        (60, 2.000),
        (120, 1.980),
        (100_000, 1.960),
    ] {
        assert!((student_975(freedom) - value).abs() < 6e-4, "{freedom}: {}", student_975(freedom));
    }
    assert!(student_975(0).is_infinite());
    // Infinitely many have the normal distribution's.
    assert!((student_975(100_000_000) - 1.959_964).abs() < 1e-6);
}
