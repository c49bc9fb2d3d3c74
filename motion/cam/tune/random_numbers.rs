//! Numbers as if by chance, the same in every run of the program.

/// Steele, Lea and Flood's `SplitMix64` (Fast Splittable Pseudorandom Number Generators, OOPSLA 2014).
#[derive(Debug)]
pub(super) struct Draws(u64);

impl Draws {
    pub(super) fn new(stream: u64) -> Self {
        Self(stream.wrapping_mul(0xD1B5_4A32_D192_ED03))
    }

    /// 0 to 1, neither included.
    pub(super) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let high = (bits >> 11) as f64;
        (high + 0.5) / 9_007_199_254_740_992.0
    }

    /// Two normal ones of variance 1 (Box and Muller).
    pub(super) fn normals(&mut self) -> [f64; 2] {
        let radius = (-2.0 * self.share().ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.share()).sin_cos();
        [radius * cos, radius * sin]
    }
}
