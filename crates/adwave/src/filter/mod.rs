//! Space-frequency filters (eq. 18): keep, remove, attenuate or amplify each band, everywhere or by region.

mod apply;
mod keep_volume;
mod layers;

pub(crate) use apply::FilterInput;
pub(crate) use apply::WeldedMembers;
pub use apply::{BandsView, filter_bands};
pub use keep_volume::{KeepVolume, KeepVolumeError};
pub(crate) use layers::LayerSlot;
pub use layers::WeightedLayer;

use crate::named_values;
use crate::region::{FieldLookup, Region, RegionError, parse_region};
use crate::{ClassifiedError, ErrorKind};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use thiserror::Error;

/// Presets: the four filters of the paper's Fig. 14 for any number of levels, and a smoothing that keeps limbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Preset {
    /// Smooths and keeps volume: gains 0, …, 0, 2, which is `2Φⁿ − Φ²ⁿ = 1 − (1 − Φⁿ)²` for dyadic levels, n =
    /// n_{J−1}. Wide features lose `(1 − λⁿ)²` of themselves; removing every band would take `1 − λⁿ`. With one
    /// level the gain is 0.
    #[serde(alias = "smooth")]
    Suppress,
    /// Removes every band (gains 0, as in the paper). Smooths, and shrinks thin parts.
    SuppressPaper,
    /// Amplifies every band, the fine ones most (gains above 1). Sharpens details.
    Enhance,
    /// Keeps the fine bands and removes the middle ones: fine texture on a smoothed body.
    Band1,
    /// Removes the fine bands and amplifies the middle ones: a caricature without texture.
    Band2,
}

named_values!(Preset, "preset", {
    Suppress => "suppress" | "smooth", "Smooth, and keep limbs and volume: 1 − (1 − Φⁿ)²; 'smooth' is the same";
    SuppressPaper => "suppress-paper", "Drop every band, as in the paper: thin parts shrink";
    Enhance => "enhance", "Strengthen every band, fine ones most";
    Band1 => "band1", "Keep the fine bands, drop the middle ones";
    Band2 => "band2", "Drop the fine bands, strengthen the middle ones";
});

impl Preset {
    /// Gains g_1 … g_J for `n_levels` = J levels. The fine bands of `Band1` and `Band2` are the finest third.
    ///
    /// ```
    /// use adwave::filter::Preset;
    /// assert_eq!(Preset::Band1.gains(6), [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    /// ```
    pub fn gains(self, n_levels: usize) -> Vec<f64> {
        let n_fine = n_levels.div_ceil(3);
        (1..=n_levels)
            .map(|level| match self {
                Self::Suppress if level == n_levels && n_levels > 1 => 2.0,
                Self::Suppress | Self::SuppressPaper => 0.0,
                // The gains decrease from the finest to the coarsest band, because coarse bands carry the shape
                // itself.
                Self::Enhance => {
                    let t = (level - 1) as f64 / n_levels as f64;
                    ENHANCE_FINEST + t * (ENHANCE_COARSEST - ENHANCE_FINEST)
                }
                Self::Band1 => f64::from(level <= n_fine),
                Self::Band2 => {
                    if level <= n_fine {
                        0.0
                    } else {
                        BAND2_GAIN
                    }
                }
            })
            .collect()
    }
}

/// Gain of the finest band under [`Preset::Enhance`].
const ENHANCE_FINEST: f64 = 2.0;
/// Gain that the bands of [`Preset::Enhance`] approach towards the coarsest.
const ENHANCE_COARSEST: f64 = 1.2;
/// Gain of the middle bands under [`Preset::Band2`].
const BAND2_GAIN: f64 = 2.0;

/// Gains of the bands, fine to coarse.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Gains {
    /// The gains of a preset, for any number of levels.
    Preset(Preset),
    /// Gains g_1 … g_J, fine to coarse.
    Gains(Vec<f64>),
}

impl Gains {
    /// Resolves to the gains g_1 … g_J.
    ///
    /// # Errors
    /// [`FilterError`] unless there are `n_levels` finite gains.
    pub fn resolve(&self, n_levels: usize) -> Result<Vec<f64>, FilterError> {
        let gains = match self {
            Self::Preset(preset) => preset.gains(n_levels),
            Self::Gains(gains) => gains.clone(),
        };
        check_gains(&gains, n_levels)?;
        Ok(gains)
    }
}

/// Checks that there is one finite gain per level.
pub(crate) fn check_gains(gains: &[f64], n_levels: usize) -> Result<(), FilterError> {
    if gains.len() != n_levels {
        return Err(FilterError::WrongNumberOfGains { n_gains: gains.len(), n_levels });
    }
    match gains.iter().position(|g| !g.is_finite()) {
        Some(at) => Err(FilterError::BadGain { level: at + 1, gain: gains[at] }),
        None => Ok(()),
    }
}

/// One layer of an edit: gains, and the region where they apply.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LayerTable", into = "LayerTable")]
pub struct Layer {
    /// Gains of the bands.
    pub gains: Gains,
    /// Region where the gains apply.
    pub region: Region,
}

/// A layer in a recipe: `preset` or `gains`, and a `region` that defaults to everywhere.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LayerTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    preset: Option<Preset>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gains: Option<Vec<f64>>,
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "region_or_text")]
    region: Option<Region>,
}

impl TryFrom<LayerTable> for Layer {
    type Error = &'static str;

    fn try_from(table: LayerTable) -> Result<Self, Self::Error> {
        let gains = match (table.preset, table.gains) {
            (Some(preset), None) => Gains::Preset(preset),
            (None, Some(gains)) => Gains::Gains(gains),
            _ => return Err("a layer needs either a preset or gains"),
        };
        Ok(Self { gains, region: table.region.unwrap_or(Region::Everywhere {}) })
    }
}

impl From<Layer> for LayerTable {
    fn from(layer: Layer) -> Self {
        let (preset, gains) = match layer.gains {
            Gains::Preset(preset) => (Some(preset), None),
            Gains::Gains(gains) => (None, Some(gains)),
        };
        Self { preset, gains, region: Some(layer.region).filter(|r| *r != Region::Everywhere {}) }
    }
}

/// An edit: layers in any order, and the fields that their regions may name.
#[derive(Clone, Copy)]
pub struct Edit<'a> {
    /// Layers of the edit.
    pub layers: &'a [Layer],
    /// Look-up of a vertex field of the shape by its name.
    pub field: &'a FieldLookup<'a>,
    /// Names of the available fields, for error messages.
    pub field_names: &'a [String],
}

impl<'a> Edit<'a> {
    /// An edit whose regions name no fields.
    pub fn new(layers: &'a [Layer]) -> Self {
        Self { layers, field: &|_| None, field_names: &[] }
    }

    /// Sets the fields that its regions may name.
    #[must_use]
    pub fn with_fields(self, field: &'a FieldLookup<'a>, field_names: &'a [String]) -> Self {
        Self { field, field_names, ..self }
    }
}

/// Reads a region from a table, or from text as on a command line.
fn region_or_text<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Region>, D::Error> {
    #[derive(Deserialize)]
    #[serde(
        untagged,
        expecting = "no such region; write it as on the command line, as in 'ball:vertex=3,radius=5%'"
    )]
    enum Form {
        Text(String),
        Tree(Region),
    }
    match Form::deserialize(deserializer)? {
        Form::Text(text) => parse_region(&text).map(Some).map_err(D::Error::custom),
        Form::Tree(region) => Ok(Some(region)),
    }
}

/// Error of applying an edit.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FilterError {
    /// The number of gains does not match the number of levels.
    #[error(
        "the number of gains must be that of the levels, {n_levels}, one per level from fine to coarse; got {n_gains}"
    )]
    WrongNumberOfGains {
        /// Number of gains given.
        n_gains: usize,
        /// Number of levels.
        n_levels: usize,
    },
    /// A gain is NaN or infinite.
    #[error("the gain of level {level} is {gain}, which is not finite")]
    BadGain {
        /// The level, from 1.
        level: usize,
        /// The gain.
        gain: f64,
    },
    /// A region does not match the shape.
    #[error("layer {layer}: {source}")]
    Region {
        /// The layer, from 1.
        layer: usize,
        /// Error of its region.
        source: RegionError,
    },
    /// The layer does not exist.
    #[error("there is no layer {layer}; there are {n_layers}, counted from 1")]
    NoSuchLayer {
        /// The layer, from 1.
        layer: usize,
        /// Number of layers.
        n_layers: usize,
    },
    /// The bands could not be computed.
    #[error(transparent)]
    Bands(#[from] crate::bands::BandsError),
}

impl ClassifiedError for FilterError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Bands(source) => source.kind(),
            Self::Region { source, .. } => source.kind(),
            Self::WrongNumberOfGains { .. } | Self::BadGain { .. } | Self::NoSuchLayer { .. } => {
                ErrorKind::Input
            }
        }
    }
}

/// Displacement of the vertices of a shape by an edit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Displacement {
    /// Root mean square distance between the positions before and after, in model units.
    pub rms: f64,
    /// Largest distance, in model units.
    pub max: f64,
    /// Index of the vertex that moved furthest, from 0.
    pub furthest: usize,
}

/// Measures the displacement of the vertices of a shape.
///
/// # Panics
/// If the numbers of points before and after differ, or are 0.
pub fn displacement(before: &[[f64; 3]], after: &[[f64; 3]]) -> Displacement {
    assert_eq!(before.len(), after.len(), "as many points after as before");
    let moved = |x: usize| crate::shape::squared_distance(&before[x], &after[x]);
    let furthest_of = |range: std::ops::Range<usize>| range.max_by(|&x, &y| moved(x).total_cmp(&moved(y)));
    let chunks = crate::parallel::map_chunks(before.len(), 1 << 14, furthest_of);
    let furthest = chunks.into_iter().flatten().max_by(|&x, &y| moved(x).total_cmp(&moved(y)));
    let furthest = furthest.expect("at least one point");
    let mean_square = crate::parallel::sum(before.len(), moved) / before.len() as f64;
    Displacement { rms: mean_square.sqrt(), max: moved(furthest).sqrt(), furthest }
}
