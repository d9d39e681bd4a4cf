//! The bands of a shape, kept for edit after edit.

use crate::StudioError;
use crate::answer::{Refused, rows};
use crate::document::Document;
use adwave::bands::{DEFAULT_EXTENT, Schedule};
use adwave::filter::{FilterError, WeightedLayer, displacement};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::positions::settle;
use adwave::region::{Length, Region, RegionWeights};
use adwave::shape::{Health, Shape, enclosed_volume};
use adwave::signal::{OutwardNormals, outward_normals};
use adwave::{Decomposer, Editor, LevelSpec, Progress};
use adwave_io::{ShapeFile, file_normals, region_field};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, OnceLock};

/// Levels where none are asked for, fewer on shapes that are small.
const N_LEVELS: usize = 8;
/// How wide the widest of these may be, in parts of the diagonal.
const WIDEST: f64 = 0.25;

/// Which levels, as the page asks for them.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LevelsAsked {
    levels: Option<usize>,
    voices: Option<usize>,
    lengths: Option<Vec<Length>>,
}

impl LevelsAsked {
    /// The same as a recipe says it.
    fn of(&self, walk: &Decomposer) -> Result<LevelSpec, Refused> {
        Ok(match self {
            Self { lengths: Some(lengths), levels: None, voices: None } => LevelSpec::Widths(lengths.clone()),
            Self { lengths: Some(_), .. } => return Err(Refused::wrong("give either levels or lengths")),
            Self { voices: Some(voices), levels, .. } => {
                let n = levels.unwrap_or(N_LEVELS);
                let schedule = Schedule::voices(n, *voices).map_err(|e| Refused::of(&e))?;
                LevelSpec::Steps(schedule.steps().to_vec())
            }
            Self { levels: Some(levels), .. } => LevelSpec::Dyadic(*levels),
            Self { .. } => LevelSpec::Dyadic(default_levels(walk)),
        })
    }
}

/// So many that the widest is a good part of the shape, and eight at the most.
fn default_levels(decomposer: &Decomposer) -> usize {
    decomposer.levels_reaching(WIDEST).0.clamp(3, N_LEVELS)
}

/// What an edit does.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Moved {
    revision: u64,
    greatest: f64,
    rms: f64,
    volume: Option<[f64; 2]>,
}

/// A level, as the page is told of it.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct LevelInfo {
    level: usize,
    steps: f64,
    sigma: f64,
    fwhm: f64,
}

/// The bands, the edit that is kept, and the positions after it.
pub(crate) struct Prepared {
    pub(crate) decomposer: Decomposer,
    pub(crate) levels: LevelSpec,
    pub(crate) schedule: Schedule,
    pub(crate) editor: Editor,
    pub(crate) document: Document,
    pub(crate) points: Arc<Vec<[f64; 3]>>,
    health: OnceLock<Health>,
    /// Of the shape as it was opened, which side is outside does not change with an edit.
    outward: OnceLock<OutwardNormals>,
    /// Weights of regions that were asked for before.
    regions: Vec<(Region, RegionWeights)>,
}

/// A shape with its diffusion.
pub(crate) fn decomposer(
    shape: &Shape,
    kind: OperatorKind,
    progress: Progress<'_>,
) -> Result<Decomposer, StudioError> {
    let params = OperatorParams { kind, ..OperatorParams::default() };
    Decomposer::with_params(shape, &params, progress).map_err(|e| StudioError::of(&e))
}

impl Prepared {
    /// With the levels that are asked for, and nothing edited.
    pub(crate) fn new(
        shape: &Shape,
        walk: &Decomposer,
        levels: LevelSpec,
        progress: Progress<'_>,
    ) -> Result<Self, StudioError> {
        let kind = levels.operator_task().default_kind();
        let decomposer =
            if kind == OperatorKind::Walk { walk.clone() } else { decomposer(shape, kind, progress)? };
        let resolved = levels.resolve(&decomposer, DEFAULT_EXTENT).map_err(|e| StudioError::of(&e))?;
        let schedule = resolved.schedule;
        let points = shape.points().unwrap_or_default();
        let request = decomposer.request(points.as_flattened(), 3, &schedule).progress(progress);
        let editor = request.editor().map_err(|e| StudioError::of(&e))?;
        Ok(Self {
            levels,
            schedule,
            editor,
            document: Document::default(),
            points: Arc::new(points.to_vec()),
            health: OnceLock::new(),
            outward: OnceLock::new(),
            regions: Vec::new(),
            decomposer,
        })
    }

    /// With as many levels as fit.
    pub(crate) fn with_default_levels(
        shape: &Shape,
        walk: &Decomposer,
        progress: Progress<'_>,
    ) -> Result<Self, StudioError> {
        Self::new(shape, walk, LevelSpec::Dyadic(default_levels(walk)), progress)
    }

    /// With the levels that the page asks for.
    pub(crate) fn asked(
        shape: &Shape,
        walk: &Decomposer,
        asked: &LevelsAsked,
        progress: Progress<'_>,
    ) -> Result<Self, Refused> {
        Ok(Self::new(shape, walk, asked.of(walk)?, progress)?)
    }

    /// What the shape consists of, counted once.
    pub(crate) fn health(&self) -> &Health {
        self.health.get_or_init(|| self.decomposer.health())
    }

    /// Which side of the shape as it was opened is outside, found once.
    pub(crate) fn outward(&self, file: &ShapeFile) -> Result<&OutwardNormals, Refused> {
        if let Some(found) = self.outward.get() {
            return Ok(found);
        }
        let normals = file_normals(file);
        let found = outward_normals(self.decomposer.geometry(), normals.as_deref(), Progress::none());
        let found = found.map_err(|e| Refused::of(&e))?;
        Ok(self.outward.get_or_init(|| found))
    }

    pub(crate) fn n_levels(&self) -> usize {
        self.schedule.n_levels()
    }

    /// What the page is told of the levels.
    pub(crate) fn level_list(&self) -> Vec<LevelInfo> {
        let sigma = self.schedule.sigma(self.decomposer.diffusion().step_length());
        let one = |(j, (&steps, &sigma)): (usize, (&f64, &f64))| LevelInfo {
            level: j + 1,
            steps,
            sigma,
            fwhm: adwave::bands::FWHM * sigma,
        };
        self.schedule.steps().iter().zip(&sigma[1..]).enumerate().map(one).collect()
    }

    /// The weights of a region.
    pub(crate) fn weights(
        &mut self,
        region: &Region,
        file: &ShapeFile,
    ) -> Result<RegionWeights, FilterError> {
        if let Some((_, weights)) = self.regions.iter().find(|(known, _)| known == region) {
            return Ok(weights.clone());
        }
        let field = |name: &str| region_field(file, &self.decomposer, name);
        let names: Vec<String> = file.field_names().into_iter().map(str::to_owned).collect();
        let weights = region.weights(self.decomposer.metric(), &field, &names, Progress::none());
        weights.map_err(|source| FilterError::Region { layer: 1, source })
    }

    /// Makes `document` the edit that is kept. When it does not fit, nothing changes.
    pub(crate) fn edit(&mut self, document: Document, file: &ShapeFile) -> Result<Moved, Refused> {
        document.check(self.n_levels())?;
        let (mut weighted, mut regions) = (Vec::new(), Vec::new());
        for (k, layer) in document.layers().into_iter().enumerate() {
            let gains = layer.gains.resolve(self.n_levels()).map_err(|e| Refused::of(&e))?;
            let weights = self.weights(&layer.region, file).map_err(|e| {
                let FilterError::Region { source, .. } = e else { return Refused::of(&e) };
                Refused::of(&FilterError::Region { layer: k + 1, source })
            })?;
            regions.push((layer.region, weights.clone()));
            weighted.push(WeightedLayer { gains, weights });
        }
        let before = self.kept_layers();
        self.editor.set_layers(weighted).map_err(|e| Refused::of(&e))?;
        let (points, moved) = match self.moved(&document, file.points()) {
            Ok(moved) => moved,
            Err(refused) => {
                self.editor.set_layers(before).map_err(|e| Refused::of(&e))?;
                return Err(refused);
            }
        };
        (self.document, self.points, self.regions) = (document, Arc::new(points), regions);
        Ok(moved)
    }

    /// The weights of the layers that are on, in their order.
    pub(crate) fn layer_weights(&self) -> impl Iterator<Item = &RegionWeights> {
        self.regions.iter().map(|(_, weights)| weights)
    }

    /// The layers of the edit that is kept, as the editor has them.
    fn kept_layers(&self) -> Vec<WeightedLayer> {
        let layers = self.document.layers().into_iter().zip(&self.regions);
        let weighted = layers.filter_map(|(layer, (_, weights))| {
            let gains = layer.gains.resolve(self.n_levels()).ok()?;
            Some(WeightedLayer { gains, weights: weights.clone() })
        });
        weighted.collect()
    }

    /// Where the editor's layers move the vertices, and how far.
    fn moved(&self, document: &Document, before: &[[f64; 3]]) -> Result<(Vec<[f64; 3]>, Moved), Refused> {
        let edited = self.editor.edited().as_chunks().0.to_vec();
        let points = settle(&self.decomposer, before, edited, &document.positions(), Progress::none())
            .map_err(|e| Refused::of(&e))?;
        let far = displacement(before, &points);
        // The page has single precision.
        if !(far.max as f32).is_finite() {
            let vertex = far.furthest;
            return Err(Refused::wrong(format!(
                "vertex {vertex} would move farther than numbers reach; take smaller gains"
            )));
        }
        let volume = self.volumes(&points);
        Ok((points, Moved { revision: document.revision, greatest: far.max, rms: far.rms, volume }))
    }

    /// The volume before and after, where the surface encloses one.
    fn volumes(&self, points: &[[f64; 3]]) -> Option<[f64; 2]> {
        let geometry = self.decomposer.geometry();
        self.health().volume.map(|before| {
            [before, enclosed_volume(&geometry.vertex_map().positions(points), geometry.triangles())]
        })
    }

    /// W_j at all vertices of the shape, as integers: scale and `i16 × 4 × n`.
    pub(crate) fn band(&self, level: usize) -> (f32, Vec<u8>) {
        let map = self.decomposer.geometry().vertex_map();
        let values = &self.editor.wavelets().levels[level - 1];
        let most = values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let scale = most / f64::from(i16::MAX);
        let per_unit = if scale > 0.0 { 1.0 / scale } else { 0.0 };
        let bytes = rows(map.n_vertices(), 8, |vertex, row| {
            let x = map.welded(vertex);
            for c in 0..3 {
                let value = (values[3 * x + c] * per_unit).round() as i16;
                row[2 * c..][..2].copy_from_slice(&value.to_le_bytes());
            }
        });
        (scale as f32, bytes)
    }
}
