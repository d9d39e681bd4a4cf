//! Files of an edited image or volume: next to the opened one, or as a download.

use crate::grid_session::{GridSession, grid_signal};
use crate::response::{ApiError, ApiResult, bytes_response};
use crate::save::{SaveRequest, format_losses, saved_response, target_path};
use adwave::Progress;
use adwave_io::{
    Field, Format, GRID_VALUES, GridLayout, ShapeFile, ValueType, write_bytes, write_bytes_with, write_path,
    written_signal,
};
use std::collections::BTreeMap;
use std::path::Path;

/// Type of numbers of a name, such as `f32`.
fn value_type_of_name(name: &str) -> Result<ValueType, ApiError> {
    ValueType::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| {
        let known = ValueType::ALL.map(ValueType::name).join(", ");
        ApiError::bad_request(format!("the type of numbers must be one of {known}, got '{name}'"))
    })
}

impl GridSession {
    /// Returns the content of the file with the edited values, as `adwave filter` writes it in `format`.
    fn edited_file(&self, format: Format, value_type: Option<ValueType>) -> Result<ShapeFile, ApiError> {
        let signal = grid_signal(&self.file, &self.workspace.name)?;
        let mut values = self.lock_bands()?.edited().to_vec();
        signal.restore_unknown(&mut values);
        let field = written_signal(&self.file, GRID_VALUES, signal.n_channels, values);
        let mut file = self.file.clone();
        let own = self.file.field(GRID_VALUES).map(|field| field.values.value_type());
        if file.format() == Some(format) {
            file.set_value_type(value_type);
        } else {
            file.forget_original();
            file.set_value_type(value_type.or(own));
        }
        file.add_vertex_field(field).map_err(|e| ApiError::bad_request(e.to_string()))?;
        Ok(file)
    }

    /// Writes the edited image or volume with all other content of its file, and responds with the path.
    pub(crate) fn save(&self, request: &SaveRequest) -> ApiResult {
        let path = target_path(&self.workspace, self.default_name(), request)?;
        let value_type = request.value_type.as_deref().map(value_type_of_name).transpose()?;
        let format = Format::grid_from_path(&path).filter(|format| self.can_write(*format));
        let format = format.ok_or_else(|| {
            let known: Vec<String> = self.extensions().into_values().map(|e| format!(".{e}")).collect();
            ApiError::bad_request(format!(
                "{}: {} is saved as {}; choose another ending",
                path.file_name().unwrap_or_default().to_string_lossy(),
                self.kind_with_article(),
                known.join(", ")
            ))
        })?;
        let file = self.edited_file(format, value_type)?;
        let report = write_path(&file, &path, None).map_err(|e| ApiError::from_classified(&e))?;
        let mut notes = format_losses(&report.not_written);
        notes.extend(self.note_on_rounding(value_type));
        saved_response(&self.workspace, path, &notes)
    }

    /// Responds with the edited image or volume in a format; that of its file if `None`.
    pub(crate) fn download(&self, format: Option<&str>, value_type: Option<&str>) -> ApiResult {
        let format = match format {
            Some(name) => Format::from_name(name),
            None => self.file.format(),
        };
        let format = format.filter(|format| self.can_write(*format)).ok_or_else(|| {
            ApiError::bad_request(
                "the file cannot be written in that format; see `formats` of the image or volume",
            )
        })?;
        let file = self.edited_file(format, value_type.map(value_type_of_name).transpose()?)?;
        let mut content = Vec::new();
        write_bytes_with(&file, format, &mut content, Progress::none())
            .map_err(|e| ApiError::from_classified(&e))?;
        Ok(bytes_response(content))
    }

    /// Says that values were rounded to the whole numbers of the file.
    fn note_on_rounding(&self, value_type: Option<ValueType>) -> Option<String> {
        let own = self.file.field(GRID_VALUES)?.values.value_type();
        let kind = value_type.unwrap_or(own);
        let is_own =
            if value_type.is_none() { ", as in its file; 32-bit numbers keep fractions" } else { "" };
        kind.is_integer().then(|| format!("Values are rounded to whole numbers ({}){is_own}.", kind.name()))
    }

    /// True if a format stores grids with so many axes and channels.
    fn can_write(&self, format: Format) -> bool {
        // The command writes arrays in double precision, unless the file is one.
        if !format.holds_grids() || !format.can_write() {
            return false;
        }
        if format == Format::NPY && self.file.format() != Some(Format::NPY) {
            return false;
        }
        let (Some(field), n_axes) = (self.file.field(GRID_VALUES), self.layout().sizes.len()) else {
            return false;
        };
        let layout = GridLayout::new(&vec![2; n_axes], &vec![1.0; n_axes]);
        let Ok(mut probe) = ShapeFile::from_grid(layout) else { return false };
        let values = vec![0.0; (1 << n_axes) * field.n_channels];
        let field = Field::new(GRID_VALUES, field.n_channels, adwave_io::FieldValues::F64(values));
        probe.set_value_type(self.file.field(GRID_VALUES).map(|field| field.values.value_type()));
        probe.add_vertex_field(field).is_ok() && write_bytes(&probe, format, &mut std::io::sink()).is_ok()
    }

    /// Lists the formats that can store this image or volume.
    pub(crate) fn writable_formats(&self) -> Vec<Format> {
        Format::all().filter(|format| self.can_write(*format)).collect()
    }

    /// Endings of file names for these formats, by the names of the formats.
    pub(crate) fn extensions(&self) -> BTreeMap<&'static str, &'static str> {
        let named = |format: Format| Some((format.name(), *format.extensions().first()?));
        self.writable_formats().into_iter().filter_map(named).collect()
    }

    /// Default file name: `NAME-edited.EXT`; the ending is that of a format that can be written.
    fn default_name(&self) -> String {
        let name = &self.workspace.name;
        let (bare, gz) = name.strip_suffix(".gz").map_or((name.as_str(), ""), |bare| (bare, ".gz"));
        let (stem, ending) = bare.rsplit_once('.').unwrap_or((bare, ""));
        let stem = stem.replace([':', '.'], "-");
        let is_writable =
            Format::grid_from_path(Path::new(bare)).is_some_and(|format| self.can_write(format));
        if is_writable {
            return format!("{stem}-edited.{ending}{gz}");
        }
        let other = if self.kind() == "image" { "tif" } else { "nii.gz" };
        format!("{stem}-edited.{other}")
    }
}
