//! Colours for the singularity measure.

use twin_plot::Color;

/// Colour bands of the measure from dark (0) to bright: viridis, for any colour vision and in grey.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    step: f64,
    bands: u32,
}

impl Scale {
    /// Most bands there are.
    const MOST: f64 = 20.0;

    /// Ten to twenty bands of a round width, from 0 to the band that `best` is in.
    pub fn up_to(best: f64) -> Self {
        let steps = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5];
        let step = steps.into_iter().find(|step| best <= step * Self::MOST + 1e-6).unwrap_or(1.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 20")]
        let bands = (best / step - 1e-6).ceil().clamp(1.0, Self::MOST) as u32;
        Self { step, bands }
    }

    /// Number of bands.
    pub fn bands(&self) -> u32 {
        self.bands
    }

    /// Least measure in a band, from 0.
    pub fn least(&self, band: u32) -> f64 {
        self.step * f64::from(band)
    }

    /// The band of a measure.
    pub fn band(&self, measure: f64) -> u32 {
        (1..self.bands).rev().find(|band| measure >= self.least(*band)).unwrap_or(0)
    }

    /// The colour of a band.
    pub fn color(&self, band: u32) -> Color {
        self.shade(self.step * (f64::from(band) + 0.5))
    }

    /// The colour of a measure, without bands.
    pub fn shade(&self, measure: f64) -> Color {
        Color::viridis(measure / (self.step * f64::from(self.bands)))
    }
}

/// Colours of axes that are beyond their software limits, by place in the machine (Okabe and Ito 2008).
pub(super) const BEYOND: [Color; 8] = [
    Color::rgb(230, 159, 0),
    Color::rgb(204, 121, 167),
    Color::rgb(86, 180, 233),
    Color::rgb(213, 94, 0),
    Color::rgb(0, 158, 115),
    Color::rgb(240, 228, 66),
    Color::rgb(0, 114, 178),
    Color::rgb(120, 120, 120),
];

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn bands_are_round_and_reach_the_best() {
        for (best, step, bands) in
            [(1.0, 0.05, 20), (0.63, 0.05, 13), (0.4, 0.02, 20), (0.0, 0.001, 1)]
        {
            let scale = Scale::up_to(best);
            assert!((scale.least(1) - step).abs() < 1e-12, "{best}: {scale:?}");
            assert_eq!(scale.bands(), bands, "{best}");
            assert_eq!(scale.band(best), bands - 1);
            assert_eq!(scale.band(0.0), 0);
        }
        // From dark to bright.
        let scale = Scale::up_to(1.0);
        let bright = |band| scale.color(band).channels().map(u32::from).iter().sum::<u32>();
        assert!((1..20).all(|band| bright(band) > bright(band - 1)));
    }
}
