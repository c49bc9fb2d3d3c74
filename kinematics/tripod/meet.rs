//! Intersection of three spheres.

use nalgebra::Vector3;

/// The lower of the two points at the distances `radii` from `centers`; `None` if the spheres do not meet or their
/// centres are in line.
///
/// In a frame with its origin at the first centre, x towards the second and the third in the x-y plane, the differences
/// of the three equations are linear in x and y; the first one then gives z².
pub(super) fn below(centers: &[Vector3<f64>; 3], radii: [f64; 3]) -> Option<Vector3<f64>> {
    let start = about_below(centers, radii, 0.0)?;
    // One step of Newton's method takes away what the square root has lost.
    Some(polished(start, centers, radii).unwrap_or(start))
}

/// [`below`] before the last digits; spheres that miss each other by less than `slack` (of the square of the first radius) count as
/// touching.
pub(super) fn about_below(
    centers: &[Vector3<f64>; 3],
    radii: [f64; 3],
    slack: f64,
) -> Option<Vector3<f64>> {
    let [first, second, third] = centers;
    let [r1, r2, r3] = radii;
    let (to_second, to_third) = (second - first, third - first);
    let d = to_second.norm();
    let ex = to_second / d;
    let i = ex.dot(&to_third);
    let rest = to_third - ex * i;
    let j = rest.norm();
    let ey = rest / j;
    let ez = ex.cross(&ey);
    let x = ((r1 - r2) * (r1 + r2) + d * d) / (2.0 * d);
    let y = ((r1 - r3) * (r1 + r3) + i * i + j * j - 2.0 * i * x) / (2.0 * j);
    let squared = r1 * r1 - x * x - y * y;
    if !(squared >= -slack * r1 * r1 && y.is_finite()) {
        return None;
    }
    let height = squared.max(0.0).sqrt();
    let z = if ez.z > 0.0 { -height } else { height };
    Some(first + ex * x + ey * y + ez * z)
}

fn polished(
    point: Vector3<f64>,
    centers: &[Vector3<f64>; 3],
    radii: [f64; 3],
) -> Option<Vector3<f64>> {
    let spokes = centers.map(|center| point - center);
    let mut off = [0.0; 3];
    for ((off, spoke), radius) in off.iter_mut().zip(&spokes).zip(radii) {
        let length = spoke.norm();
        *off = (radius - length) * f64::midpoint(radius, length);
    }
    let step = solve(&spokes, off)?;
    // Where the spheres hardly meet a step leads anywhere.
    let small = step.norm() <= 1e-6 * radii.iter().sum::<f64>();
    small.then(|| point + step)
}

/// The v with `rows[i]`·v = `values[i]`; `None` if there is none, or no single one.
#[inline]
pub(super) fn solve(rows: &[Vector3<f64>; 3], values: [f64; 3]) -> Option<Vector3<f64>> {
    let [first, second, third] = rows;
    let [a, b, c] = values;
    let cross = second.cross(third);
    let sum = cross * a + third.cross(first) * b + first.cross(second) * c;
    let result = sum / first.dot(&cross);
    result.iter().all(|value| value.is_finite()).then_some(result)
}

#[cfg(test)]
mod tests {
    use super::below;
    use nalgebra::Vector3;

    /// (0, 0, 0) seen from three points half as high above it as they are beside it; the other solution is above them.
    #[test]
    fn the_lower_of_two_points() {
        let centers = [
            Vector3::new(1.0, 0.0, 0.5),
            Vector3::new(0.0, 1.0, 0.5),
            Vector3::new(-1.0, 0.0, 0.5),
        ];
        let radius = 1.25_f64.sqrt();
        let found = below(&centers, [radius; 3]).unwrap();
        assert!(found.norm() < 1e-15, "{found}");
        let [a, b, c] = centers;
        let found = below(&[a, c, b], [radius; 3]).unwrap();
        assert!(found.norm() < 1e-15, "{found}");
        assert!(below(&centers, [0.1; 3]).is_none());
        assert!(below(&[a, a * 2.0, a * 3.0], [1.0; 3]).is_none());
    }
}
