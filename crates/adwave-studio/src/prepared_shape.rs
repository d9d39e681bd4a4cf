//! Prepared state of a shape: its bands, its edit and the edited positions.

use crate::StudioError;
use crate::band_edit::{BandEdit, BandEditRequest};
use crate::document::Document;
use crate::field_bands::FieldBands;
use crate::pose::Poser;
use crate::region_weights::region_weights;
use crate::response::{ApiError, encode_rows};
use adwave::LevelSpec;
use adwave::filter::{FilterError, WeightedLayer, displacement};
use adwave::operator::{OperatorKind, OperatorParams};
use adwave::positions::constrain_positions;
use adwave::region::{Region, RegionWeights};
use adwave::shape::{Health, Shape, SurfacePart, SurfaceParts, enclosed_volume, surface_parts};
use adwave::signal::OutwardNormals;
use adwave::{Decomposer, Progress};
use adwave_io::{ShapeFile, file_normals};
use serde::Serialize;
use std::sync::{Arc, OnceLock};

/// Effect of an edit, for display.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct EditSummary {
    pub(crate) revision: u64,
    /// Largest displacement, in model units, or change of a value of a grid.
    pub(crate) greatest: f64,
    /// Root mean square displacement, or change of the values of a grid.
    pub(crate) rms: f64,
    /// Volume before and after the edit, in cubed model units; `None` for a shape that encloses no volume.
    pub(crate) volume: Option<[f64; 2]>,
}

/// Shape with its bands, the current edit and the edited positions.
pub(crate) struct PreparedShape {
    /// Bands of the positions, and the edit.
    pub(crate) bands: BandEdit,
    pub(crate) points: Arc<Vec<[f64; 3]>>,
    /// Edited positions before clones and the pose.
    pub(crate) unposed: Arc<Vec<[f64; 3]>>,
    /// Deformation by handles, which does not depend on the levels.
    pub(crate) poser: Arc<Poser>,
    health: OnceLock<Health>,
    /// Outward normals of the original shape; an edit does not change the outside.
    outward_normals: OnceLock<OutwardNormals>,
    /// Connected parts of a mesh.
    parts: OnceLock<SurfaceParts>,
    /// Regions of the active layers with their weights.
    regions: Vec<(Region, RegionWeights)>,
    /// Bands of the field that was edited last.
    pub(crate) field_bands: Option<FieldBands>,
}

/// Shape with its positions, or places of its nodes, and the diffusion of the walk operator.
pub(crate) struct PreparedSource<'a> {
    pub(crate) shape: &'a Shape,
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) walk: &'a Decomposer,
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
    /// Prepares a shape for the bands of `levels`, which `bands` computes; the edit is empty.
    pub(crate) fn new(
        source: &PreparedSource<'_>,
        levels: LevelSpec,
        progress: Progress<'_>,
    ) -> Result<Self, StudioError> {
        let PreparedSource { shape, points, walk } = *source;
        let kind = levels.operator_task().default_kind();
        let decomposer =
            if kind == OperatorKind::Walk { walk.clone() } else { build_decomposer(shape, kind, progress)? };
        let request = BandEditRequest { values: points.as_flattened(), n_channels: 3, levels };
        let bands = BandEdit::new(decomposer, request)?;
        let points = Arc::new(points.to_vec());
        Ok(Self {
            bands,
            unposed: Arc::clone(&points),
            points,
            poser: Arc::new(Poser::new(walk.clone())),
            health: OnceLock::new(),
            outward_normals: OnceLock::new(),
            parts: OnceLock::new(),
            regions: Vec::new(),
            field_bands: None,
        })
    }

    /// Returns the counts of components and defects, which are computed once.
    pub(crate) fn health(&self) -> &Health {
        self.health.get_or_init(|| self.bands.decomposer.health())
    }

    /// Returns the connected parts of a mesh, which are found once; other shapes have none.
    pub(crate) fn parts(&self) -> Result<&SurfaceParts, ApiError> {
        if let Some(parts) = self.parts.get() {
            return Ok(parts);
        }
        let parts = match self.bands.decomposer.geometry() {
            Some(geometry) => {
                surface_parts(geometry, Progress::none()).map_err(|e| ApiError::from_classified(&e))?
            }
            None => SurfaceParts::default(),
        };
        Ok(self.parts.get_or_init(|| parts))
    }

    /// Lists the closed parts whose faces point inward, those with the most faces first.
    pub(crate) fn inward_parts(&self) -> Result<Vec<SurfacePart>, ApiError> {
        let health = self.health();
        if health.n_components == 1 {
            // The usual shape: its only part begins at the first vertex.
            let volume = health.volume.filter(|volume| *volume < 0.0);
            let part = |volume| SurfacePart {
                first_vertex: 0,
                n_faces: health.n_faces,
                volume: Some(volume),
                is_inward: true,
            };
            return Ok(volume.map(part).into_iter().collect());
        }
        let mut parts: Vec<SurfacePart> =
            self.parts()?.parts.iter().filter(|part| part.is_inward).copied().collect();
        parts.sort_by_key(|part| (std::cmp::Reverse(part.n_faces), part.first_vertex));
        Ok(parts)
    }

    /// True for each face of the file that is turned over by an edit.
    pub(crate) fn turned_faces(&self, turned: &[u32], file: &ShapeFile) -> Result<Vec<bool>, ApiError> {
        self.parts()?.faces_of(turned, file.faces()).map_err(|e| ApiError::from_classified(&e))
    }

    /// Returns the triangles with those of the turned parts turned over.
    pub(crate) fn turned_triangles(&self, triangles: &[[u32; 3]]) -> Result<Vec<[u32; 3]>, ApiError> {
        let turned = &self.bands.document.turned;
        if turned.is_empty() {
            return Ok(triangles.to_vec());
        }
        let parts = self.parts()?;
        let is_turned = |v: u32| {
            let part = parts.parts.get(parts.of_vertex[v as usize] as usize);
            part.is_some_and(|part| turned.binary_search(&part.first_vertex).is_ok())
        };
        Ok(triangles.iter().map(|&[a, b, c]| if is_turned(a) { [a, c, b] } else { [a, b, c] }).collect())
    }

    /// Returns the outward normals of the original shape, which are computed once.
    pub(crate) fn outward_normals(&self, file: &ShapeFile) -> Result<&OutwardNormals, ApiError> {
        if let Some(normals) = self.outward_normals.get() {
            return Ok(normals);
        }
        let stored = file_normals(file);
        let normals = self.bands.decomposer.outward_normals(stored.as_deref(), Progress::none());
        let normals = normals.map_err(|e| ApiError::from_classified(&e))?;
        Ok(self.outward_normals.get_or_init(|| normals))
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
        let weights = region_weights(region, file, &self.bands.decomposer, Progress::none());
        weights.map_err(|source| FilterError::Region { layer: 1, source })
    }

    /// Replaces the current edit by `document`; on an error nothing changes.
    pub(crate) fn apply_edit(
        &mut self,
        document: Document,
        file: &ShapeFile,
    ) -> Result<EditSummary, ApiError> {
        document.check(self.bands.n_levels())?;
        if self.bands.decomposer.points().is_none() && document.changes_positions() {
            return Err(ApiError::bad_request(
                "a graph without positions is edited by its fields alone; remove the layers, clones, poses and turned parts",
            ));
        }
        if !document.turned.is_empty() {
            self.turned_faces(&document.turned, file)?;
        }
        let (mut weighted, mut regions) = (Vec::new(), Vec::new());
        for (k, layer) in document.active_layers().into_iter().enumerate() {
            let gains =
                layer.gains.resolve(self.bands.n_levels()).map_err(|e| ApiError::from_classified(&e))?;
            let weights = self.region_weights(&layer.region, file).map_err(|e| {
                let FilterError::Region { source, .. } = e else { return ApiError::from_classified(&e) };
                ApiError::from_classified(&FilterError::Region { layer: k + 1, source })
            })?;
            regions.push((layer.region, weights.clone()));
            weighted.push(WeightedLayer { gains, weights });
        }
        let previous = self.current_layers();
        self.bands.editor_mut().set_layers(weighted).map_err(|e| ApiError::from_classified(&e))?;
        let edited = match self.edited_points(&document, file) {
            Ok(edited) => edited,
            Err(error) => {
                self.bands.editor_mut().set_layers(previous).map_err(|e| ApiError::from_classified(&e))?;
                return Err(error);
            }
        };
        (self.bands.document, self.regions) = (document, regions);
        (self.points, self.unposed) = (edited.points, edited.unposed);
        Ok(edited.summary)
    }

    /// Returns the weights of the active layers, in order.
    pub(crate) fn layer_weights(&self) -> impl Iterator<Item = &RegionWeights> {
        self.regions.iter().map(|(_, weights)| weights)
    }

    /// Returns the active layers of the current edit, with their weights.
    fn current_layers(&self) -> Vec<WeightedLayer> {
        let layers = self.bands.document.active_layers().into_iter().zip(&self.regions);
        let weighted = layers.filter_map(|(layer, (_, weights))| {
            let gains = layer.gains.resolve(self.bands.n_levels()).ok()?;
            Some(WeightedLayer { gains, weights: weights.clone() })
        });
        weighted.collect()
    }

    /// Computes the positions after the layers of the editor, then applies the constraints, clones and pose of
    /// `document`.
    fn edited_points(&self, document: &Document, file: &ShapeFile) -> Result<EditedPoints, ApiError> {
        if self.bands.decomposer.points().is_none() {
            // The places of the picture stay.
            let points = Arc::clone(&self.points);
            let summary = EditSummary { revision: document.revision, greatest: 0.0, rms: 0.0, volume: None };
            return Ok(EditedPoints { unposed: Arc::clone(&points), points, summary });
        }
        let before = file.points();
        let edited = self.bands.editor().edited().as_chunks().0.to_vec();
        let points = constrain_positions(
            &self.bands.decomposer,
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
        let volume = self.volumes(&points, &document.turned)?;
        let summary =
            EditSummary { revision: document.revision, greatest: moved.max, rms: moved.rms, volume };
        Ok(EditedPoints { points, unposed, summary })
    }

    /// Returns the volume before and after the edit, in cubed model units, both with the parts that are turned over;
    /// `None` for a surface that encloses no volume.
    fn volumes(&self, points: &[[f64; 3]], turned: &[u32]) -> Result<Option<[f64; 2]>, ApiError> {
        let (Some(geometry), Some(before)) = (self.bands.decomposer.geometry(), self.health().volume) else {
            return Ok(None);
        };
        let edited = geometry.vertex_map().positions(points);
        let after = geometry.volume_of(&edited);
        if turned.is_empty() {
            return Ok(Some([before, after]));
        }
        // Each turned part is subtracted instead of added.
        let parts = self.parts()?;
        let mut is_turned = vec![false; geometry.n_vertices()];
        for (&welded, &part) in geometry.vertex_map().as_slice().iter().zip(&parts.of_vertex) {
            let part = parts.parts.get(part as usize);
            is_turned[welded as usize] |=
                part.is_some_and(|part| turned.binary_search(&part.first_vertex).is_ok());
        }
        let triangles: Vec<[u32; 3]> =
            geometry.triangles().iter().filter(|t| is_turned[t[0] as usize]).copied().collect();
        let twice = |points: &[[f64; 3]]| 2.0 * enclosed_volume(points, &triangles);
        Ok(Some([before - twice(geometry.points()), after - twice(&edited)]))
    }

    /// Encodes W_j at all vertices as a scale and integers `i16 × 4 × n`, of which every fourth is 0.
    pub(crate) fn encode_band(&self, level: usize) -> (f32, Vec<u8>) {
        let map = self.bands.decomposer.vertex_map();
        let values = &self.bands.editor().wavelets().levels[level - 1];
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
