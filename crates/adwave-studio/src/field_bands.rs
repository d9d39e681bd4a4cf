//! Editing of fields: bands of a field, and values after the layers of an edit.

use crate::band_edit::BandEdit;
use crate::prepared_shape::PreparedShape;
use crate::region_weights::region_weights;
use crate::response::{ApiError, ApiResult, bytes_response, encode_f32};
use crate::session::Session;
use adwave::bands::DEFAULT_EXTENT;
use adwave::filter::{FilterError, Layer, WeightedLayer};
use adwave::local_fit::LocalFit;
use adwave::mask::missing;
use adwave::{Decomposer, Editor, LevelSpec, Progress};
use adwave_io::{
    ArrayValues, Field, ShapeFile, labels_of_field, write_csv_fields, write_gifti_fields, write_npy,
    written_signal,
};
use std::path::Path;

/// Local fit about which fields are smoothed, as in `adwave filter --signal`.
pub(crate) const FIELD_FIT: LocalFit = LocalFit::Linear;

/// Field with its bands for some levels.
pub(crate) struct FieldBands {
    pub(crate) name: String,
    levels: LevelSpec,
    n_levels: usize,
    editor: Editor,
}

/// True if the values of a field with one channel are numbers: at least one is known, none is infinite, and they are
/// not labels.
pub(crate) fn is_editable(field: &Field) -> bool {
    let values = field.to_f64();
    values.iter().any(|v| !v.is_nan())
        && values.iter().all(|v| !v.is_infinite())
        && labels_of_field(&field.name, 1, &values).is_none()
}

/// Returns the field of a name if its values can be edited; it belongs to the file or to a file of values that was
/// added.
pub(crate) fn editable_field<'a>(file: &'a ShapeFile, name: &str) -> Result<&'a Field, ApiError> {
    let field = file.vertex_fields().iter().find(|field| field.name == name && field.n_channels == 1);
    let field = field.ok_or_else(|| {
        let message = "only fields of the file and of added files with one value per vertex can be edited";
        ApiError::bad_request(format!("{message}, got '{name}'; see `editable` in `fields` of the shape"))
    })?;
    if labels_of_field(name, 1, &field.to_f64()).is_some() {
        return Err(ApiError::bad_request(format!(
            "'{name}' has labels, and a mean of labels is none; smooth them with `adwave filter --as-labels`"
        )));
    }
    Ok(field)
}

impl FieldBands {
    /// Computes the bands of a field. Vertices without a value do not take part in the diffusion.
    pub(crate) fn new(
        name: &str,
        file: &ShapeFile,
        decomposer: &Decomposer,
        levels: &LevelSpec,
        progress: Progress<'_>,
    ) -> Result<Self, ApiError> {
        let values = editable_field(file, name)?.to_f64();
        let masked = match missing(&values, 1) {
            None => decomposer.clone(),
            Some(flags) => {
                decomposer.masked(&flags).map_err(|e| ApiError::bad_request(format!("'{name}': {e}")))?
            }
        };
        let resolved = levels.resolve(&masked, DEFAULT_EXTENT).map_err(|e| ApiError::from_classified(&e))?;
        let schedule = resolved.schedule;
        let request = masked.request(&values, 1, &schedule).local_fit(FIELD_FIT).progress(progress);
        let editor = request.editor().map_err(|e| ApiError::from_classified(&e))?;
        Ok(Self { name: name.to_owned(), levels: levels.clone(), n_levels: schedule.n_levels(), editor })
    }

    /// True if these are the bands of the field `name` for `levels`.
    fn is_for(&self, name: &str, levels: &LevelSpec) -> bool {
        self.name == name && self.levels == *levels
    }

    /// Encodes the values and then W_1 … W_J, `f32 × n` each. A vertex without a value has NaN, and 0 in the bands.
    fn encode(&self) -> Vec<u8> {
        let map = self.editor.decomposer().vertex_map();
        let n = map.n_vertices();
        let mut content = encode_f32(n, |x| self.editor.signal()[x] as f32);
        for level in &self.editor.wavelets().levels {
            content.extend(encode_f32(n, |x| level[map.welded(x)] as f32));
        }
        content
    }

    /// Computes the values of the field after layers.
    fn edit(&mut self, layers: &[Layer], file: &ShapeFile) -> Result<Vec<f64>, ApiError> {
        let mut weighted = Vec::with_capacity(layers.len());
        for (k, layer) in layers.iter().enumerate() {
            let gains = layer.gains.resolve(self.n_levels).map_err(|e| ApiError::from_classified(&e))?;
            let decomposer = self.editor.decomposer();
            let weights = region_weights(&layer.region, file, decomposer, Progress::none())
                .map_err(|source| ApiError::from_classified(&FilterError::Region { layer: k + 1, source }))?;
            weighted.push(WeightedLayer { gains, weights });
        }
        self.editor.set_layers(weighted).map_err(|e| ApiError::from_classified(&e))?;
        Ok(self.editor.edited().to_vec())
    }
}

impl PreparedShape {
    /// Stores the bands of a field if they are for the current levels.
    pub(crate) fn set_field_bands(&mut self, bands: FieldBands) {
        if bands.levels == self.bands.levels {
            self.field_bands = Some(bands);
        }
    }

    /// True if the bands of the field `name` for the current levels are stored.
    pub(crate) fn has_field_bands(&self, name: &str) -> bool {
        self.field_bands.as_ref().is_some_and(|bands| bands.is_for(name, &self.bands.levels))
    }

    /// Computes a field after its layers, with the number type that it has in the file.
    pub(crate) fn edited_field(
        &mut self,
        name: &str,
        file: &ShapeFile,
        progress: Progress<'_>,
    ) -> Result<Field, ApiError> {
        let layers = self.bands.document.active_field_layers(name);
        let stored = self.field_bands.take().filter(|bands| bands.is_for(name, &self.bands.levels));
        let mut bands = match stored {
            Some(bands) => bands,
            None => FieldBands::new(name, file, &self.bands.decomposer, &self.bands.levels, progress)?,
        };
        let edited = bands.edit(&layers, file);
        self.field_bands = Some(bands);
        Ok(written_signal(file, name, 1, edited?))
    }

    /// Replaces the fields of `file` that the edit changes by their edited values.
    pub(crate) fn replace_edited_fields(
        &mut self,
        file: &mut ShapeFile,
        progress: Progress<'_>,
    ) -> Result<(), ApiError> {
        let original = file.clone();
        for name in self.bands.document.changed_fields() {
            // A field whose file is not there any more stays in the edit.
            if original.field(&name).is_some() {
                let field = self.edited_field(&name, &original, progress)?;
                file.add_vertex_field(field).map_err(|e| ApiError::bad_request(e.to_string()))?;
            }
        }
        Ok(())
    }
}

/// Returns the operator and the levels for the bands of a field; `None` if its bands are stored.
pub(crate) fn unstored_levels(
    session: &Session,
    name: &str,
) -> Result<Option<(Decomposer, LevelSpec)>, ApiError> {
    let prepared = session.lock_prepared()?;
    let BandEdit { decomposer, levels, .. } = &prepared.bands;
    Ok((!prepared.has_field_bands(name)).then(|| (decomposer.clone(), levels.clone())))
}

/// Computes the bands of a field for the levels that are not stored, outside the shape's turn.
pub(crate) fn compute_bands(
    session: &Session,
    name: &str,
    levels: Option<(Decomposer, LevelSpec)>,
    progress: Progress<'_>,
) -> Result<Option<FieldBands>, ApiError> {
    let compute =
        |(decomposer, levels)| FieldBands::new(name, &session.file(), &decomposer, &levels, progress);
    levels.map(compute).transpose()
}

/// Stores the bands of a field and responds with them.
pub(crate) fn bands_response(session: &Session, name: &str, computed: Option<FieldBands>) -> ApiResult {
    let mut prepared = session.lock_prepared()?;
    if let Some(bands) = computed {
        prepared.set_field_bands(bands);
    }
    let stored = prepared.field_bands.take().filter(|bands| bands.is_for(name, &prepared.bands.levels));
    let bands = if let Some(bands) = stored {
        bands
    } else {
        // The levels were replaced while the bands were computed.
        let BandEdit { decomposer, levels, .. } = &prepared.bands;
        FieldBands::new(name, &session.file(), decomposer, levels, session.progress())?
    };
    let response = bytes_response(bands.encode());
    prepared.field_bands = Some(bands);
    Ok(response)
}

/// Responds with an edited field: as `f32 × n`, or as a file of values in double precision.
pub(crate) fn edited_field_response(session: &Session, name: &str, format: Option<&str>) -> ApiResult {
    let file = session.file();
    let field = session.lock_prepared()?.edited_field(name, &file, session.progress())?;
    let Some(format) = format else {
        let values = field.to_f64();
        return Ok(bytes_response(encode_f32(values.len(), |x| values[x] as f32)));
    };
    let folder = tempfile::tempdir().map_err(crate::StudioError::from)?;
    let path = folder.path().join("values").with_extension(format);
    write_values(&path, format, file.in_file_rows(field), &file)?;
    let content = std::fs::read(&path).map_err(crate::StudioError::from)?;
    Ok(bytes_response(content))
}

/// Writes a single field, as `adwave filter` does.
fn write_values(path: &Path, format: &str, field: Field, file: &ShapeFile) -> Result<(), ApiError> {
    let written = match format {
        "npy" => {
            let values = field.to_f64();
            write_npy(path, &[values.len()], ArrayValues::F64(&values))
        }
        "csv" => write_csv_fields(path, &[field]),
        "gii" => write_gifti_fields(path, &[field], file.structure()),
        other => {
            let message = "a file of values is written as npy, csv or gii";
            return Err(ApiError::bad_request(format!("{message}, got '{other}'")));
        }
    };
    written.map_err(|e| ApiError::from_classified(&e))
}
