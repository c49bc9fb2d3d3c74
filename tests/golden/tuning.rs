//! Cams of points at rest and recordings of them, from closed forms, for the tests of `twin tune cam`.

/// The lift that most tests tune, up in another way than down.
pub(crate) const LIFT: &str = r#"name = "lift"  # as drawn
master = { min = 0, max = 360, unit = "deg" }
slave = { min = 0, max = 100, unit = "mm", period = 100 }
elements = [
  { master = 0, slave = 0 },      # down
  { master = 120, slave = 70 },   # on the way
  { master = 180, slave = 100 },  # up
  { master = 360, slave = 0 },
]
tappets = [
  { group = 1, master = 50, passage = "positive", action = "on" },
  { group = 1, master = 200, passage = "positive", action = "off" },
]
"#;

/// The shipped cam that picks and places, without its tappets.
pub(crate) const PICK: [(f64, f64); 7] = [
    (0.0, 0.0),
    (40.0, 0.0),
    (140.0, 80.0),
    (180.0, 80.0),
    (260.0, 12.0),
    (300.0, 12.0),
    (360.0, 0.0),
];

/// A slave that goes through points at rest, by the quintic between two of them; behind the last one it begins again.
pub(crate) fn through(points: &[(f64, f64)], master: f64) -> f64 {
    let at = master.rem_euclid(360.0);
    let pair = points.windows(2).find(|pair| at < pair[1].0).expect("on the cam");
    let part = (at - pair[0].0) / (pair[1].0 - pair[0].0);
    let ease = part.powi(3) * (10.0 - 15.0 * part + 6.0 * part * part);
    pair[0].1 + (pair[1].1 - pair[0].1) * ease
}

/// The slave of [`LIFT`].
pub(crate) fn lift(master: f64) -> f64 {
    through(&[(0.0, 0.0), (120.0, 70.0), (180.0, 100.0), (360.0, 0.0)], master)
}

/// Within ± 0.5: bits mixed so that neighbours have nothing to do with each other.
pub(crate) fn noise(index: u32) -> f64 {
    let mixed = u64::from(index + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40;
    f64::from(u32::try_from(mixed).expect("24 bits")) / 16_777_216.0 - 0.5
}

/// A recording: its header, and a row for each of its samples.
pub(crate) fn recording(header: &str, count: u32, row: impl Fn(u32) -> String) -> String {
    let rows = (0..count).map(|index| row(index) + "\n");
    format!("{header}\n{}", rows.collect::<String>())
}
