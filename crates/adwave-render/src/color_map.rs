//! Named color maps from a scalar to a color.

use crate::diverging::coolwarm;
use colorous::Gradient;

/// Source of the colors of a map.
#[derive(Clone, Copy)]
enum Source {
    Library(Gradient),
    CoolWarm,
    Gray,
}

impl std::fmt::Debug for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Source")
    }
}

/// Color maps by name: first sequential maps, then diverging maps.
const MAPS: [(&str, Source); 12] = [
    ("viridis", Source::Library(colorous::VIRIDIS)),
    ("magma", Source::Library(colorous::MAGMA)),
    ("inferno", Source::Library(colorous::INFERNO)),
    ("plasma", Source::Library(colorous::PLASMA)),
    ("cividis", Source::Library(colorous::CIVIDIS)),
    ("turbo", Source::Library(colorous::TURBO)),
    ("cool", Source::Library(colorous::COOL)),
    ("warm", Source::Library(colorous::WARM)),
    ("gray", Source::Gray),
    ("coolwarm", Source::CoolWarm),
    ("red-blue", Source::Library(colorous::RED_BLUE)),
    ("spectral", Source::Library(colorous::SPECTRAL)),
];

/// Color of missing values.
const MISSING: [u8; 3] = [128, 128, 128];

/// Color map with a name.
#[derive(Clone, Copy, Debug)]
pub struct ColorMap {
    name: &'static str,
    source: Source,
}

impl PartialEq for ColorMap {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl ColorMap {
    /// Names of all color maps.
    pub fn names() -> impl Iterator<Item = &'static str> {
        MAPS.iter().map(|m| m.0)
    }

    /// Finds a color map by its name; `None` if there is none.
    ///
    /// ```
    /// use adwave_render::ColorMap;
    /// assert_eq!(ColorMap::from_name("viridis").unwrap().color(0.0), [68, 1, 84]);
    /// assert!(ColorMap::from_name("sepia").is_none());
    /// ```
    pub fn from_name(name: &str) -> Option<Self> {
        MAPS.iter().find(|m| m.0 == name).map(|&(name, source)| Self { name, source })
    }

    /// Returns a color map whose name is known to be in the list.
    pub(crate) fn built_in(name: &str) -> Self {
        Self::from_name(name).expect("the name is in the list")
    }

    /// Name of the map.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Red, green and blue at `t`, which is clamped to [0, 1]; gray for NaN.
    pub fn color(&self, t: f64) -> [u8; 3] {
        if t.is_nan() {
            return MISSING;
        }
        let t = t.clamp(0.0, 1.0);
        match self.source {
            Source::Library(gradient) => gradient.eval_continuous(t).as_array(),
            Source::CoolWarm => coolwarm(t),
            Source::Gray => [(40.0 + 200.0 * t).round() as u8; 3],
        }
    }

    /// Maps each value to a color, three bytes each. Values at or below `low` get one end of the map, values at or
    /// above `high` the other.
    pub fn colors(&self, values: &[f64], low: f64, high: f64) -> Vec<u8> {
        let span = if high > low { high - low } else { 1.0 };
        values.iter().flat_map(|v| self.color((v - low) / span)).collect()
    }
}

/// Quantiles of the finite values at the fractions `low` and `high` (in [0, 1]), as a color range that is robust
/// against a few extreme values. Returns (0, 1) if no value is finite. O(n).
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
    let mut at = |share: f64| {
        let place = (share.clamp(0.0, 1.0) * (finite.len() - 1) as f64).round() as usize;
        *finite.select_nth_unstable_by(place, f64::total_cmp).1
    };
    (at(low), at(high))
}
