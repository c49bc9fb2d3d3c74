//! The normalised outputs of the manual's `TRAFOF` blocks for SCARAs, which its visualisation templates show
//! (`SMC_VISU_Scara2`, `SMC_VISU_Scara3`; SoftMotion manual 8.2.4 and 8.2.5).

use nalgebra::Vector2;

/// The outputs for a SCARA with N arms. Lengths are parts of the length of all arms together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaraView<const N: usize> {
    /// Angle of each arm relative to the one before, rad: `dAlpha`, `dBeta`, (`dGamma`).
    pub angles: [f64; N],
    /// The ends of the arms: (`dpx`, `dpy`), (`dppx`, `dppy`,) and last, of a tool at the end of the last arm, (`dnx`, `dny`).
    pub ends: [[f64; 2]; N],
    /// Lengths of the arms: `dR1`, `dR2`, (`dR3`).
    pub arms: [f64; N],
}

impl<const N: usize> ScaraView<N> {
    pub(super) fn new(arms: [f64; N], angles: [f64; N]) -> Self {
        let total: f64 = arms.iter().sum();
        let arms = arms.map(|arm| arm / total);
        let mut ends = [[0.0; 2]; N];
        let (mut end, mut direction) = (Vector2::zeros(), 0.0);
        for ((slot, arm), angle) in ends.iter_mut().zip(arms).zip(angles) {
            direction += angle;
            end += Vector2::new(f64::cos(direction), f64::sin(direction)) * arm;
            *slot = end.into();
        }
        Self { angles, ends, arms }
    }
}
