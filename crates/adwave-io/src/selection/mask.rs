//! Masks in files: a number per vertex, or a list of vertices.

use std::path::Path;

use super::SelectionError;
use crate::model::format_descriptor::{MaskRequest, VertexMask};
use crate::model::grid_layout::GRID_VALUES;
use crate::registry::values::read_vertex_mask;
use crate::signal::values_of_file;
use crate::{Format, ReadLimits, ShapeFile, read_path};

/// Mask in a file, with a row per row of the shape's file.
///
/// In files of numbers (NPY, CSV, GIFTI, CIFTI, FreeSurfer's curv, MGH and MGZ) a number that is neither 0 nor NaN is
/// inside. A FreeSurfer label has its vertices inside, unless it is that of the medial wall (by its name). An
/// annotation has the regions of the cortex inside, or those that are named.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskFile {
    /// Path, optionally with `:NAME` for one of several columns, or for regions of an annotation with commas between.
    pub name: String,
    /// Side of the mask that takes part.
    pub side: MaskSide,
}

/// Side of a mask that takes part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MaskSide {
    /// Vertices inside.
    #[default]
    Inside,
    /// Vertices outside.
    Outside,
}

impl MaskFile {
    /// Flags of the rows that take part, for a file of `n_rows` rows that is not read as a whole. O(n).
    ///
    /// # Errors
    /// [`SelectionError`]: the mask cannot be read, has another number of rows, or several numbers per row.
    pub fn read_rows(&self, n_rows: usize) -> Result<Vec<bool>, SelectionError> {
        let mut found = match list_of_vertices(&self.name, n_rows)? {
            Some(found) => found.takes_part,
            None => numbers(&self.name, None, n_rows)?.takes_part,
        };
        if found.len() != n_rows {
            let mask = self.name.clone();
            return Err(SelectionError::MaskLength { mask, found: found.len(), n_rows });
        }
        if self.side == MaskSide::Outside {
            for takes_part in &mut found {
                *takes_part = !*takes_part;
            }
        }
        Ok(found)
    }
}

/// Reads a mask for the vertices of a shape.
pub(super) fn read_mask(file: &ShapeFile, mask: &MaskFile) -> Result<VertexMask, SelectionError> {
    let n_rows = file.n_file_rows();
    let name = mask.name.as_str();
    let mut found = if let Some(places) = grid_mask(file, name)? {
        places
    } else if let Some(list) = list_of_vertices(name, n_rows)? {
        list
    } else {
        numbers(name, file.structure(), n_rows)?
    };
    let n_found = found.takes_part.len();
    if n_found != n_rows && n_found != file.n_vertices() {
        return Err(SelectionError::MaskLength { mask: name.to_owned(), found: n_found, n_rows });
    }
    if let Some(rows) = file.file_rows().filter(|rows| rows.n_rows() == n_found) {
        found.takes_part = rows.vertex_rows().iter().map(|&row| found.takes_part[row as usize]).collect();
    }
    if mask.side == MaskSide::Outside {
        found.takes_part.iter_mut().for_each(|takes_part| *takes_part = !*takes_part);
        found.meaning = format!("the inverse of: {}", found.meaning);
    }
    Ok(found)
}

/// Reads an image or a volume as the mask of another one with the same places; `None` for another kind of file.
fn grid_mask(file: &ShapeFile, name: &str) -> Result<Option<VertexMask>, SelectionError> {
    let path = Path::new(name);
    let is_grid = Format::from_path(path).is_some_and(Format::holds_grids) && path.is_file();
    let Some(layout) = file.grid().filter(|_| is_grid) else { return Ok(None) };
    let mask = read_path(path, &ReadLimits::default())?;
    let Some(other) = mask.grid() else { return Ok(None) };
    if let Some(what) = layout.difference(other) {
        return Err(SelectionError::MaskGrid { mask: name.to_owned(), what });
    }
    let Some(values) = mask.field(GRID_VALUES) else { return Ok(None) };
    if values.n_channels != 1 {
        return Err(SelectionError::MaskChannels { mask: name.to_owned(), n_channels: values.n_channels });
    }
    let is_inside = |place: usize| {
        let value = values.get(place, 0);
        value != 0.0 && !value.is_nan() && other.kept.as_ref().is_none_or(|kept| kept[place])
    };
    Ok(Some(VertexMask {
        takes_part: (0..values.len()).map(is_inside).collect(),
        meaning: "places with a number other than 0 and NaN take part".to_owned(),
    }))
}

/// Reads a file that names vertices; `None` for a file of numbers.
fn list_of_vertices(name: &str, n_vertices: usize) -> Result<Option<VertexMask>, SelectionError> {
    let (path, regions) = match name.rsplit_once(':') {
        Some((path, regions)) if !Path::new(name).is_file() => (path, Some(regions)),
        _ => (name, None),
    };
    if !Path::new(path).is_file() {
        return Err(SelectionError::NoMask { mask: name.to_owned() });
    }
    let file_name = Path::new(path).file_name().unwrap_or_default().to_string_lossy();
    let request = MaskRequest { name: &file_name, regions, n_vertices };
    Ok(read_vertex_mask(Path::new(path), &request, &ReadLimits::default())?)
}

/// Reads a file of one number per vertex.
fn numbers(name: &str, structure: Option<&str>, n_rows: usize) -> Result<VertexMask, SelectionError> {
    let field = values_of_file(name, structure, n_rows)?
        .ok_or_else(|| SelectionError::NoMask { mask: name.to_owned() })?
        .field;
    if field.n_channels != 1 {
        return Err(SelectionError::MaskChannels { mask: name.to_owned(), n_channels: field.n_channels });
    }
    let is_inside = |value: f64| value != 0.0 && !value.is_nan();
    Ok(VertexMask {
        takes_part: (0..field.len()).map(|i| is_inside(field.get(i, 0))).collect(),
        meaning: "vertices with a number other than 0 and NaN take part".to_owned(),
    })
}
