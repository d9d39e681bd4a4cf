//! Prepared state of a shape: its bands, its edit and the edited positions.

use crate::StudioError;
use crate::document::Document;
use crate::field_bands::FieldBands;
use crate::pose::Poser;
use crate::region_weights::region_weights;
use crate::response::{ApiError, encode_rows};
use adwave::LevelSpec;
use adwave::bands::{DEFAULT_EXTENT, Schedule};
use adwave::filter::{FilterError, WeightedLayer, displacement};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::positions::constrain_positions;
use adwave::region::{Length, Region, RegionWeights};
use adwave::shape::{Health, Shape};
use adwave::signal::OutwardNormals;
use adwave::{Decomposer, Editor, Progress};
use adwave_io::{ShapeFile, file_normals};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, OnceLock};

/// Default number of levels; small shapes have fewer, large shapes as many as are needed to reach
/// [`MIN_RELATIVE_WIDTH`].
const DEFAULT_LEVELS: usize = 8;
/// Largest default number of levels: the number of bands that a shader can sum in addition to the masks of four layers.
const MAX_DEFAULT_LEVELS: usize = 12;
/// Largest width σ of a default level, relative to the diagonal.
const MAX_RELATIVE_WIDTH: f64 = 0.25;
/// Width σ, relative to the diagonal, that the coarsest default level of a large shape reaches.
const MIN_RELATIVE_WIDTH: f64 = 0.02;

/// Body of `PUT levels`: a count, a count with voices per octave, steps, or widths; if empty, the default levels.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LevelsRequest {
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    voices: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lengths: Option<Vec<Length>>,
}

impl LevelsRequest {
    /// Converts to the levels of a recipe.
    fn to_levels(&self, walk_decomposer: &Decomposer) -> Result<LevelSpec, ApiError> {
        Ok(match self {
            Self { lengths: Some(lengths), levels: None, voices: None, steps: None } => {
                LevelSpec::Widths(lengths.clone())
            }
            Self { steps: Some(steps), levels: None, voices: None, lengths: None } => {
                LevelSpec::Steps(steps.clone())
            }
            Self { lengths: Some(_), .. } | Self { steps: Some(_), .. } => {
                let message = "either levels, steps or lengths can be given, got several; give one";
                return Err(ApiError::bad_request(message));
            }
            Self { voices: Some(voices), levels, .. } => {
                let n = levels.unwrap_or(DEFAULT_LEVELS);
                let schedule = Schedule::voices(n, *voices).map_err(|e| ApiError::from_classified(&e))?;
                LevelSpec::Steps(schedule.steps().to_vec())
            }
            Self { levels: Some(levels), .. } => LevelSpec::Dyadic(*levels),
            Self { .. } => default_levels(walk_decomposer),
        })
    }

    /// Converts the levels of a prepared shape to a request.
    fn from_levels(levels: &LevelSpec, schedule: &Schedule) -> Self {
        match levels {
            LevelSpec::Dyadic(n) => Self { levels: Some(*n), ..Self::default() },
            LevelSpec::Widths(widths) => Self { lengths: Some(widths.clone()), ..Self::default() },
            _ => Self { steps: Some(schedule.steps().to_vec()), ..Self::default() },
        }
    }
}

/// Default levels: eight dyadic levels, fewer if the widest would exceed a quarter of the diagonal, and more if it
/// would stay below 2 % of it.
fn default_levels(decomposer: &Decomposer) -> LevelSpec {
    let most = decomposer.levels_reaching(MAX_RELATIVE_WIDTH).0;
    let least = decomposer.levels_reaching(MIN_RELATIVE_WIDTH).0;
    spread_levels(DEFAULT_LEVELS.max(least).min(most).max(3))
}

/// Returns the dyadic levels 1 … n; if n exceeds [`MAX_DEFAULT_LEVELS`], this number of them, spread evenly from first
/// to last.
fn spread_levels(n: usize) -> LevelSpec {
    if n <= MAX_DEFAULT_LEVELS {
        return LevelSpec::Dyadic(n);
    }
    let doublings = |j: usize| (j * (n - 1)) as f64 / (MAX_DEFAULT_LEVELS - 1) as f64;
    LevelSpec::Steps((0..MAX_DEFAULT_LEVELS).map(|j| doublings(j).round().exp2()).collect())
}

/// Effect of an edit, for display.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct EditSummary {
    revision: u64,
    /// Largest displacement, in model units.
    greatest: f64,
    /// Root mean square displacement, in model units.
    rms: f64,
    /// Volume before and after the edit, in cubed model units; `None` for a shape that encloses no volume.
    volume: Option<[f64; 2]>,
}

/// Description of a level for the page.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct LevelInfo {
    level: usize,
    steps: f64,
    sigma: f64,
    fwhm: f64,
}

/// Shape with its bands, the current edit and the edited positions.
pub(crate) struct PreparedShape {
    pub(crate) decomposer: Decomposer,
    pub(crate) levels: LevelSpec,
    pub(crate) schedule: Schedule,
    pub(crate) editor: Editor,
    pub(crate) document: Document,
    pub(crate) points: Arc<Vec<[f64; 3]>>,
    /// Edited positions before clones and the pose.
    pub(crate) unposed: Arc<Vec<[f64; 3]>>,
    /// Deformation by handles, which does not depend on the levels.
    pub(crate) poser: Arc<Poser>,
    health: OnceLock<Health>,
    /// Outward normals of the original shape; an edit does not change the outside.
    outward_normals: OnceLock<OutwardNormals>,
    /// Regions of the active layers with their weights.
    regions: Vec<(Region, RegionWeights)>,
    /// Bands of the field that was edited last.
    pub(crate) field_bands: Option<FieldBands>,
}

/// Positions after an edit, in model units.
struct EditedPoints {
    points: Arc<Vec<[f64; 3]>>,
    unposed: Arc<Vec<[f64; 3]>>,
    summary: EditSummary,
}

/// Operator of maps, features and reports of a shape that does not change while one looks at it: on a mesh heat on the
/// surface, as in the commands.
pub(crate) fn analysis_operator(shape: &Shape) -> OperatorKind {
    LevelSpec::Default.analysis_task(shape).default_kind()
}

/// Builds the diffusion of a shape.
pub(crate) fn build_decomposer(
    shape: &Shape,
    kind: OperatorKind,
    progress: Progress<'_>,
) -> Result<Decomposer, StudioError> {
    let params = OperatorParams::default().with_kind(kind);
    Decomposer::with_params(shape, &params, progress).map_err(|e| StudioError::from_classified(&e))
}

impl PreparedShape {
    /// Computes the bands of `levels`; the edit is empty.
    pub(crate) fn new(
        shape: &Shape,
        walk_decomposer: &Decomposer,
        levels: LevelSpec,
        progress: Progress<'_>,
    ) -> Result<Self, StudioError> {
        let kind = levels.operator_task().default_kind();
        let decomposer = if kind == OperatorKind::Walk {
            walk_decomposer.clone()
        } else {
            build_decomposer(shape, kind, progress)?
        };
        let resolved =
            levels.resolve(&decomposer, DEFAULT_EXTENT).map_err(|e| StudioError::from_classified(&e))?;
        let schedule = resolved.schedule;
        let points = shape.points().unwrap_or_default();
        let request = decomposer.request(points.as_flattened(), 3, &schedule).progress(progress);
        let editor = request.editor().map_err(|e| StudioError::from_classified(&e))?;
        let points = Arc::new(points.to_vec());
        Ok(Self {
            levels,
            schedule,
            editor,
            document: Document::default(),
            unposed: Arc::clone(&points),
            points,
            poser: Arc::new(Poser::new(walk_decomposer.clone())),
            health: OnceLock::new(),
            outward_normals: OnceLock::new(),
            regions: Vec::new(),
            field_bands: None,
            decomposer,
        })
    }

    /// Computes the bands of the default levels.
    pub(crate) fn with_default_levels(
        shape: &Shape,
        walk_decomposer: &Decomposer,
        progress: Progress<'_>,
    ) -> Result<Self, StudioError> {
        Self::new(shape, walk_decomposer, default_levels(walk_decomposer), progress)
    }

    /// Computes the bands of the levels that the page requests.
    pub(crate) fn with_requested_levels(
        shape: &Shape,
        walk: &Decomposer,
        request: &LevelsRequest,
        progress: Progress<'_>,
    ) -> Result<Self, ApiError> {
        Ok(Self::new(shape, walk, request.to_levels(walk)?, progress)?)
    }

    /// Returns the counts of components and defects, which are computed once.
    pub(crate) fn health(&self) -> &Health {
        self.health.get_or_init(|| self.decomposer.health())
    }

    /// Returns the outward normals of the original shape, which are computed once.
    pub(crate) fn outward_normals(&self, file: &ShapeFile) -> Result<&OutwardNormals, ApiError> {
        if let Some(normals) = self.outward_normals.get() {
            return Ok(normals);
        }
        let stored = file_normals(file);
        let normals = self.decomposer.outward_normals(stored.as_deref(), Progress::none());
        let normals = normals.map_err(|e| ApiError::from_classified(&e))?;
        Ok(self.outward_normals.get_or_init(|| normals))
    }

    pub(crate) fn n_levels(&self) -> usize {
        self.schedule.n_levels()
    }

    /// Returns the request that leads to the current levels.
    pub(crate) fn levels_request(&self) -> LevelsRequest {
        LevelsRequest::from_levels(&self.levels, &self.schedule)
    }

    /// Widths σ of the levels in model units, fine to coarse.
    pub(crate) fn sigmas(&self) -> Vec<f64> {
        self.schedule.sigma(self.decomposer.operator().step_length())[1..].to_vec()
    }

    /// Describes the levels for the page, fine to coarse.
    pub(crate) fn level_infos(&self) -> Vec<LevelInfo> {
        let sigma = self.sigmas();
        let one = |(j, (&steps, &sigma)): (usize, (&f64, &f64))| LevelInfo {
            level: j + 1,
            steps,
            sigma,
            fwhm: adwave::bands::FWHM * sigma,
        };
        self.schedule.steps().iter().zip(&sigma).enumerate().map(one).collect()
    }

    /// Computes the weights of a region, or returns those of an active layer with an equal region.
    pub(crate) fn region_weights(
        &mut self,
        region: &Region,
        file: &ShapeFile,
    ) -> Result<RegionWeights, FilterError> {
        if let Some((_, weights)) = self.regions.iter().find(|(known, _)| known == region) {
            return Ok(weights.clone());
        }
        let weights = region_weights(region, file, &self.decomposer, Progress::none());
        weights.map_err(|source| FilterError::Region { layer: 1, source })
    }

    /// Replaces the current edit by `document`; on an error nothing changes.
    pub(crate) fn apply_edit(
        &mut self,
        document: Document,
        file: &ShapeFile,
    ) -> Result<EditSummary, ApiError> {
        document.check(self.n_levels())?;
        let (mut weighted, mut regions) = (Vec::new(), Vec::new());
        for (k, layer) in document.active_layers().into_iter().enumerate() {
            let gains = layer.gains.resolve(self.n_levels()).map_err(|e| ApiError::from_classified(&e))?;
            let weights = self.region_weights(&layer.region, file).map_err(|e| {
                let FilterError::Region { source, .. } = e else { return ApiError::from_classified(&e) };
                ApiError::from_classified(&FilterError::Region { layer: k + 1, source })
            })?;
            regions.push((layer.region, weights.clone()));
            weighted.push(WeightedLayer { gains, weights });
        }
        let previous = self.current_layers();
        self.editor.set_layers(weighted).map_err(|e| ApiError::from_classified(&e))?;
        let edited = match self.edited_points(&document, file) {
            Ok(edited) => edited,
            Err(error) => {
                self.editor.set_layers(previous).map_err(|e| ApiError::from_classified(&e))?;
                return Err(error);
            }
        };
        (self.document, self.regions) = (document, regions);
        (self.points, self.unposed) = (edited.points, edited.unposed);
        Ok(edited.summary)
    }

    /// Returns the weights of the active layers, in order.
    pub(crate) fn layer_weights(&self) -> impl Iterator<Item = &RegionWeights> {
        self.regions.iter().map(|(_, weights)| weights)
    }

    /// Returns the active layers of the current edit, with their weights.
    fn current_layers(&self) -> Vec<WeightedLayer> {
        let layers = self.document.active_layers().into_iter().zip(&self.regions);
        let weighted = layers.filter_map(|(layer, (_, weights))| {
            let gains = layer.gains.resolve(self.n_levels()).ok()?;
            Some(WeightedLayer { gains, weights: weights.clone() })
        });
        weighted.collect()
    }

    /// Computes the positions after the layers of the editor, then applies the constraints, clones and pose of
    /// `document`.
    fn edited_points(&self, document: &Document, file: &ShapeFile) -> Result<EditedPoints, ApiError> {
        let before = file.points();
        let edited = self.editor.edited().as_chunks().0.to_vec();
        let points = constrain_positions(
            &self.decomposer,
            before,
            edited,
            &document.position_params(),
            Progress::none(),
        )
        .map_err(|e| ApiError::from_classified(&e))?;
        let unposed = Arc::new(points);
        let by = document.reshaped_by();
        let points = if by.is_neutral() {
            Arc::clone(&unposed)
        } else {
            Arc::new(self.poser.carry(&by, file, unposed.to_vec(), Progress::none())?)
        };
        let moved = displacement(before, &points);
        // The page computes in single precision.
        if !(moved.max as f32).is_finite() {
            let vertex = moved.furthest;
            return Err(ApiError::bad_request(format!(
                "vertex {vertex} would move beyond the range of single precision; choose smaller gains or motions"
            )));
        }
        let volume = self.volumes(&points);
        let summary =
            EditSummary { revision: document.revision, greatest: moved.max, rms: moved.rms, volume };
        Ok(EditedPoints { points, unposed, summary })
    }

    /// Returns the volume before and after the edit, in cubed model units; `None` for a surface that encloses no
    /// volume.
    fn volumes(&self, points: &[[f64; 3]]) -> Option<[f64; 2]> {
        let geometry = self.decomposer.geometry()?;
        self.health()
            .volume
            .map(|before| [before, geometry.volume_of(&geometry.vertex_map().positions(points))])
    }

    /// Encodes W_j at all vertices as a scale and integers `i16 × 4 × n`, of which every fourth is 0.
    pub(crate) fn encode_band(&self, level: usize) -> (f32, Vec<u8>) {
        let map = self.decomposer.vertex_map();
        let values = &self.editor.wavelets().levels[level - 1];
        let max = values.iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        let scale = max / f64::from(i16::MAX);
        let per_unit = if scale > 0.0 { 1.0 / scale } else { 0.0 };
        let bytes = encode_rows(map.n_vertices(), 8, |vertex, row| {
            let x = map.welded(vertex);
            for c in 0..3 {
                let value = (values[3 * x + c] * per_unit).round() as i16;
                row[2 * c..][..2].copy_from_slice(&value.to_le_bytes());
            }
        });
        (scale as f32, bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_levels_are_spread_over_the_same_widths() {
        assert_eq!(spread_levels(9), LevelSpec::Dyadic(9));
        let LevelSpec::Steps(steps) = spread_levels(16) else { panic!("no steps") };
        assert_eq!((steps.len(), steps[0], steps[11]), (12, 1.0, 32768.0));
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
    }
}
