//! Colours for a scalar, by named colour maps.

use colorous::Gradient;

/// The colour maps by name: perceptually even ones first, then diverging ones.
const MAPS: [(&str, Gradient); 10] = [
    ("viridis", colorous::VIRIDIS),
    ("magma", colorous::MAGMA),
    ("inferno", colorous::INFERNO),
    ("plasma", colorous::PLASMA),
    ("cividis", colorous::CIVIDIS),
    ("turbo", colorous::TURBO),
    ("cool", colorous::COOL),
    ("warm", colorous::WARM),
    ("red-blue", colorous::RED_BLUE),
    ("spectral", colorous::SPECTRAL),
];

/// What has no value.
const MISSING: [u8; 3] = [128, 128, 128];

/// A named colour map.
#[derive(Clone, Copy, Debug)]
pub struct ColorMap {
    name: &'static str,
    gradient: Gradient,
}

impl ColorMap {
    /// Every name.
    pub fn names() -> impl Iterator<Item = &'static str> {
        MAPS.iter().map(|m| m.0)
    }

    /// The map of that name.
    ///
    /// ```
    /// use adwave_render::ColorMap;
    /// assert_eq!(ColorMap::from_name("viridis").unwrap().color(0.0), [68, 1, 84]);
    /// assert!(ColorMap::from_name("sepia").is_none());
    /// ```
    pub fn from_name(name: &str) -> Option<Self> {
        MAPS.iter().find(|m| m.0 == name).map(|&(name, gradient)| Self { name, gradient })
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Red, green and blue at `t`, which is taken to [0, 1]; grey for NaN.
    pub fn color(&self, t: f64) -> [u8; 3] {
        if t.is_nan() { MISSING } else { self.gradient.eval_continuous(t.clamp(0.0, 1.0)).as_array() }
    }

    /// A colour for each value, `low` and below at one end, `high` and above at the other.
    pub fn colors(&self, values: &[f64], low: f64, high: f64) -> Vec<u8> {
        let span = if high > low { high - low } else { 1.0 };
        values.iter().flat_map(|v| self.color((v - low) / span)).collect()
    }
}

/// The values below which `low` and `high` (in [0, 1]) of the finite values lie: a range for colours that a few extreme
/// values do not spoil. (0, 1) without finite values. O(n log n).
///
/// ```
/// use adwave_render::value_range;
/// assert_eq!(value_range(&[5.0, f64::NAN, 1.0, 3.0], 0.0, 1.0), (1.0, 5.0));
/// ```
pub fn value_range(values: &[f64], low: f64, high: f64) -> (f64, f64) {
    let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if finite.is_empty() {
        return (0.0, 1.0);
    }
    finite.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| finite[(share.clamp(0.0, 1.0) * (finite.len() - 1) as f64).round() as usize];
    (at(low), at(high))
}
