//! Parameters of a tiling job: levels, gains, fields, memory.

use adwave::bands::{FixedSeries, Schedule};
use adwave::denoise::{DenoiseChoice, DenoiseParams};
use adwave::features::{FeatureError, FeatureParams};
use adwave::local_fit::{HeightSeries, LocalFit};
use adwave::named_values;
use adwave::positions::{Borders, MoveDirection, NORMAL_STEPS};
use adwave::saliency::{SaliencyError, SaliencyParams};
use adwave_io::{FieldCondition, FlaggedPoints, MaskFile, MaskSide, Selection};
use serde::{Deserialize, Serialize};

use crate::error::TilesError;

/// Weights α_j of an unsigned saliency map, `Λ = Σ_j α_j·‖W_j‖` over j > skip.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MapWeights {
    /// Number of the finest levels that the map skips.
    pub skip: usize,
    /// Formula of the α_j.
    pub kind: MapKind,
}

/// Formulas of α_j that need only sums and maxima of whole levels (see [`Weighting`](adwave::saliency::Weighting)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum MapKind {
    /// Unevenness of the level (its entropy below that of equal values), over its mean.
    Entropy,
    /// (max − mean)² (eq. 17).
    PerLevel,
    /// 1/mean.
    Normalized,
    /// 1.
    Uniform,
}

named_values!(MapKind, "weighting", {
    Entropy => "entropy", "1/mean, times how unevenly the level is spread";
    PerLevel => "paper", "(max − mean)² (eq. 17)";
    Normalized => "normalized", "1/mean, so that every level counts alike";
    Uniform => "none", "1 for every level";
});

impl MapWeights {
    /// The weights with the levels that a map of one shape skips: none by entropy, else as many as in the paper.
    pub fn new(kind: MapKind) -> Self {
        let skip = match kind {
            MapKind::Entropy => SaliencyParams::default().skip,
            MapKind::PerLevel | MapKind::Normalized | MapKind::Uniform => SaliencyParams::paper().skip,
        };
        Self { skip, kind }
    }
}

/// Vertices of the inputs that take part. The others keep their values and are nobody's neighbors; their new fields are
/// NaN, those of strays and placeholders 0.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileSelection {
    /// Conditions on fields, all of which must hold, as [`FieldCondition`] parses them.
    pub conditions: Vec<String>,
    /// File with a mask that has one number for each row of the inputs, one input after the other.
    pub mask: Option<String>,
    /// True if the rows outside of the mask take part.
    pub is_mask_inverted: bool,
    /// True if points that are flagged as withheld or classified as noise take part.
    pub includes_flagged: bool,
}

impl From<&Selection> for TileSelection {
    fn from(selection: &Selection) -> Self {
        Self {
            conditions: selection.conditions.iter().map(ToString::to_string).collect(),
            mask: selection.mask.as_ref().map(|mask| mask.name.clone()),
            is_mask_inverted: selection.is_mask_inverted(),
            includes_flagged: selection.flagged == FlaggedPoints::Included,
        }
    }
}

impl TileSelection {
    /// The selection of a file in memory that chooses the same vertices.
    ///
    /// # Errors
    /// [`TilesError`] if a condition cannot be parsed.
    pub fn to_selection(&self) -> Result<Selection, TilesError> {
        let parse = |text: &String| {
            text.parse::<FieldCondition>().map_err(|e| TilesError::Input(format!("--only: {e}")))
        };
        let side = if self.is_mask_inverted { MaskSide::Outside } else { MaskSide::Inside };
        Ok(Selection {
            conditions: self.conditions.iter().map(parse).collect::<Result<_, _>>()?,
            mask: self.mask.clone().map(|name| MaskFile { name, side }),
            flagged: if self.includes_flagged { FlaggedPoints::Included } else { FlaggedPoints::LeftOut },
        })
    }
}

/// Parameters of a tiling job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Params {
    /// J, the number of dyadic levels.
    pub levels: usize,
    /// Gain of each band from fine to coarse, one per level; 1 keeps a band. Empty: all gains are 1.
    pub gains: Vec<f64>,
    /// Vertices that take part.
    #[serde(default)]
    pub selection: TileSelection,
    /// Directions in which vertices move by the gains; `None` means along the normals on a cloud, and all directions on
    /// a mesh, as in [`PositionParams`](adwave::positions::PositionParams).
    #[serde(default)]
    pub along: Option<MoveDirection>,
    /// Treatment of the borders of a mesh by the gains. [`Borders::Keep`] is not available.
    #[serde(default)]
    pub borders: Borders,
    /// Local fit of coordinates that move along one axis.
    #[serde(default = "linear_fit")]
    pub local_fit: LocalFit,
    /// Bands, from 1, whose norm ‖W_j‖ is written to the field `wavelet_j`, in model units.
    pub magnitudes: Vec<usize>,
    /// Bands, from 1, whose vectors W_j are written to the fields `wavelet_j_x`, `wavelet_j_y` and `wavelet_j_z`, in
    /// model units.
    #[serde(default)]
    pub vectors: Vec<usize>,
    /// Weights of the saliency map, which is written to the field `saliency`; `None` for no map.
    #[serde(default)]
    pub saliency: Option<MapWeights>,
    /// Threshold θ of the features (see [`FeatureParams`]); `None` for no features.
    #[serde(default)]
    pub theta: Option<f64>,
    /// Parameters of denoising. A job that denoises computes no bands; `None` for a job that computes bands.
    #[serde(default)]
    pub denoise: Option<DenoiseParams>,
    /// Number of nearest neighbors in a cloud.
    pub neighbors: usize,
    /// Relative error of the bands (see [`FixedSeries`]).
    pub accuracy: f64,
    /// Number of tiles; `None` for as few as the memory allows.
    pub n_tiles: Option<usize>,
    /// Bytes of memory that may be used.
    pub memory: u64,
    /// Number of tiles that are computed at the same time; they share the memory.
    pub n_workers: usize,
}

fn linear_fit() -> LocalFit {
    LocalFit::Linear
}

/// Rule by which the gains move vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Movement {
    /// Motion in all directions.
    Free,
    /// Motion along the normals in parts of a mesh that have a border, in all directions elsewhere.
    OpenParts,
    /// Motion in one direction.
    Directed(MoveDirection),
    /// Motion along the axis with this index, about a local linear fit.
    Heights(usize),
}

impl Default for Params {
    fn default() -> Self {
        Self {
            levels: 8,
            gains: Vec::new(),
            selection: TileSelection::default(),
            along: None,
            borders: Borders::Natural,
            local_fit: linear_fit(),
            magnitudes: Vec::new(),
            vectors: Vec::new(),
            saliency: None,
            theta: None,
            denoise: None,
            neighbors: 10,
            accuracy: 1e-6,
            n_tiles: None,
            memory: 4 << 30,
            n_workers: 1,
        }
    }
}

/// Largest number of neighbors; more make rows that do not fit into a tile.
const MAX_NEIGHBORS: usize = 200;

/// Largest magnitude of a gain, so that squares of lengths stay finite.
const MAX_GAIN: f64 = 1e50;

/// Largest number of fields: a LAS record has at most 65 535 bytes, and a VLR of that size describes fields by 192
/// bytes each.
const MAX_FIELDS: usize = 300;

/// Largest number of halo rings: rings are 16-bit numbers, and a tile with this many is mostly halo.
const MAX_RINGS: usize = 60_000;

fn feature_error(error: FeatureError) -> TilesError {
    TilesError::Input(error.to_string())
}

impl Params {
    pub(crate) fn check(&self) -> Result<(), TilesError> {
        let input = |message: String| Err(TilesError::Input(message));
        if !self.gains.is_empty() && self.gains.len() != self.levels {
            return input(format!(
                "the number of gains must be that of the levels, {}, one per level from fine to coarse; got {}",
                self.levels,
                self.gains.len()
            ));
        }
        if let Some(gain) = self.gains.iter().find(|gain| !(gain.is_finite() && gain.abs() <= MAX_GAIN)) {
            return input(format!("gains must be finite, at most {MAX_GAIN:e} in magnitude, got {gain:?}"));
        }
        if self.borders == Borders::Keep {
            return input(
                "tiles cannot keep borders in place, which needs distances from them; use 'natural' or 'free', or filter the whole mesh in memory"
                    .into(),
            );
        }
        let mut bands = self.magnitudes.iter().chain(&self.vectors);
        if let Some(band) = bands.find(|band| !(1..=self.levels).contains(*band)) {
            return input(format!("bands must be in 1..={}, got {band}", self.levels));
        }
        if self.field_names().len() > MAX_FIELDS {
            return input(format!(
                "a point can have at most {MAX_FIELDS} new fields, got {}; request fewer bands",
                self.field_names().len()
            ));
        }
        if let Some(MapWeights { skip, .. }) = self.saliency
            && skip >= self.levels
        {
            return input(SaliencyError::NoLevelLeft { skip, n_levels: self.levels }.to_string());
        }
        if let Some(theta) = self.theta {
            FeatureParams::default().with_theta(theta).check().map_err(feature_error)?;
            if self.levels < 3 {
                return Err(feature_error(FeatureError::TooFewLevels { n_levels: self.levels }));
            }
        }
        if !(1..=MAX_NEIGHBORS).contains(&self.neighbors) {
            return input(format!(
                "the number of neighbors must be in 1..={MAX_NEIGHBORS}, got {}",
                self.neighbors
            ));
        }
        if let Some(denoise) = &self.denoise {
            denoise.check()?;
            if !self.gains.is_empty() || self.has_maps() || !self.computed_bands().is_empty() {
                return input(
                    "denoising is a separate job; compute gains, bands, maps and features of its result"
                        .into(),
                );
            }
        }
        if self.n_workers == 0 || self.n_tiles == Some(0) {
            return input("the numbers of workers and tiles must be at least 1, got 0".into());
        }
        Ok(())
    }

    /// Bands to compute, in ascending order.
    pub(crate) fn computed_bands(&self) -> Vec<usize> {
        if self.has_maps() {
            return (1..=self.levels).collect();
        }
        let mut bands: Vec<usize> = self.magnitudes.iter().chain(&self.vectors).copied().collect();
        bands.sort_unstable();
        bands.dedup();
        bands
    }

    /// Returns true if a saliency map or features are requested, which depend on the bands of all tiles.
    pub(crate) fn has_maps(&self) -> bool {
        self.saliency.is_some() || self.theta.is_some()
    }

    /// Rule by which the gains move vertices.
    pub(crate) fn movement(&self, is_mesh: bool) -> Movement {
        match (self.along, self.along.and_then(MoveDirection::axis)) {
            (_, Some(axis)) if self.local_fit == LocalFit::Linear => Movement::Heights(axis),
            (Some(MoveDirection::Free), _) => Movement::Free,
            (Some(direction), _) => Movement::Directed(direction),
            (None, _) if !is_mesh => Movement::Directed(MoveDirection::Normal),
            (None, _) if self.borders == Borders::Free => Movement::Free,
            (None, _) => Movement::OpenParts,
        }
    }

    /// Returns true if vertices of a mesh may move along its normals.
    pub(crate) fn needs_mesh_normals(&self) -> bool {
        let needs_normals = match self.movement(true) {
            Movement::Free | Movement::Heights(_) => false,
            Movement::OpenParts => true,
            Movement::Directed(direction) => direction.axis().is_none(),
        };
        needs_normals && self.changes_positions() && self.denoise.is_none()
    }

    /// Returns true if the gains move heights about a local linear fit, which is no polynomial of Φ₁.
    pub(crate) fn moves_heights(&self) -> bool {
        self.denoise.is_none()
            && self.changes_positions()
            && matches!(self.movement(true), Movement::Heights(_))
    }

    /// The series by which heights are filtered about a local linear fit.
    pub(crate) fn height_series(&self) -> Result<HeightSeries, TilesError> {
        let factors: Vec<f64> = self.gains.iter().map(|gain| gain - 1.0).collect();
        Ok(HeightSeries::new(&Schedule::dyadic(self.levels)?, self.accuracy, &factors)?)
    }

    /// Polynomials of the outputs: the change of the positions, if any gain is not 1 and it is a polynomial, then the
    /// bands to compute.
    pub(crate) fn output_series(&self) -> Result<Vec<FixedSeries>, TilesError> {
        let bands = FixedSeries::bands(&Schedule::dyadic(self.levels)?, self.accuracy)?;
        let mut series = Vec::new();
        if self.changes_positions() && !self.moves_heights() {
            let factors: Vec<f64> = self.gains.iter().map(|gain| gain - 1.0).collect();
            series.push(FixedSeries::weighted(&bands, &factors));
        }
        series.extend(self.computed_bands().into_iter().map(|band| bands[band - 1].clone()));
        Ok(series)
    }

    /// Returns true if the job changes positions.
    pub(crate) fn changes_positions(&self) -> bool {
        self.denoise.is_some() || self.gains.iter().any(|&gain| gain != 1.0)
    }

    /// Names of the fields that are added to the points.
    pub(crate) fn field_names(&self) -> Vec<String> {
        let norms = self.magnitudes.iter().map(|band| format!("wavelet_{band}"));
        let vectors =
            self.vectors.iter().flat_map(|band| ["x", "y", "z"].map(|c| format!("wavelet_{band}_{c}")));
        norms.chain(vectors).chain(self.saliency.map(|_| "saliency".to_owned())).collect()
    }

    /// Bytes of the added fields of a point, which are 32-bit floats.
    pub(crate) fn field_bytes(&self) -> usize {
        4 * (self.magnitudes.len() + 3 * self.vectors.len() + usize::from(self.saliency.is_some()))
    }

    /// Number of rings in the halo of a tile.
    pub(crate) fn n_rings(&self, is_mesh: bool) -> Result<usize, TilesError> {
        if self.denoise.is_some() {
            return Ok(if is_mesh { DenoiseChoice::reach()? } else { DenoiseChoice::CLOUD_REACH });
        }
        let mut n_rings = self.output_series()?.iter().map(FixedSeries::reach).max().unwrap_or(0);
        if self.changes_positions() {
            n_rings = n_rings.max(match self.movement(is_mesh) {
                Movement::Heights(_) => self.height_series()?.reach(),
                // The normal of a point of a cloud depends on its neighbors.
                Movement::Directed(_) | Movement::OpenParts => NORMAL_STEPS + usize::from(!is_mesh),
                Movement::Free => 0,
            });
        }
        if n_rings > MAX_RINGS {
            return Err(TilesError::Input(format!(
                "a halo can have at most {MAX_RINGS} rings, and {} levels need {n_rings}; request fewer levels",
                self.levels
            )));
        }
        Ok(n_rings)
    }

    /// A copy with the parameters that do not affect the result set to 0: jobs that are equal in the rest can share a
    /// folder.
    pub(crate) fn result_params(&self) -> Self {
        Self { memory: 0, n_workers: 0, n_tiles: None, ..self.clone() }
    }
}
