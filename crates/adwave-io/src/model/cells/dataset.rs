//! Conversion of points, cells and their values to a shape.

use adwave::Progress;

use super::Cells;
use super::surface::{CellSurface, FaceSources};
use crate::model::numbers::collect_rows;
use crate::progress::collect;
use crate::{CoordinatePrecision, Edges, Field, FieldValues, Format, ReadError, ShapeFile};

/// Content of a VTK file.
pub(crate) struct Dataset {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) precision: CoordinatePrecision,
    /// Cells in the order in which the cell values are stored.
    pub(crate) cells: Vec<Cells>,
    pub(crate) point_fields: Vec<Field>,
    pub(crate) cell_fields: Vec<Field>,
    pub(crate) extras: Vec<String>,
}

impl Dataset {
    /// Extracts the surface of the cells; points that are corners of volumes only are dropped.
    pub(crate) fn into_shape(self, format: Format, progress: Progress<'_>) -> Result<ShapeFile, ReadError> {
        let Self { points, precision, cells, point_fields, cell_fields, mut extras } = self;
        let n_points = points.len();
        let is_used = used_points(&cells, n_points);
        let mut surface = CellSurface::from_cells(cells, progress)?;
        let mut shape = ShapeFile::from_cloud(points);
        shape.vertex_fields = point_fields;
        if surface.n_volumes > 0 {
            extras.push(format!("{} volumes (their boundary is read)", surface.n_volumes));
        }
        if surface.has_other_points {
            keep_corners(&mut shape, &mut surface, &is_used, &mut extras, progress)?;
        }
        cell_values(&mut shape, &surface, cell_fields, &mut extras, progress)?;
        shape.faces = surface.faces.into();
        shape.edges = Edges { pairs: surface.edges, ..Edges::default() };
        shape.format = Some(format);
        shape.precision = precision;
        shape.extras = extras;
        Ok(shape)
    }
}

/// Marks the points named by a cell.
fn used_points(cells: &[Cells], n_points: usize) -> Vec<bool> {
    if !cells.iter().any(|block| matches!(block.kind, super::CellKind::Each(_))) {
        return Vec::new();
    }
    let mut is_used = vec![false; n_points];
    for &corner in cells.iter().flat_map(|block| &block.corners) {
        is_used[corner as usize] = true;
    }
    is_used
}

/// Drops the points of cells that are not on the surface; points that no cell names stay.
fn keep_corners(
    shape: &mut ShapeFile,
    surface: &mut CellSurface,
    is_used: &[bool],
    extras: &mut Vec<String>,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let mut keeps: Vec<bool> = is_used.iter().map(|is_used| !is_used).collect();
    let of_edges = surface.edges.as_flattened();
    for &corner in surface.faces.corners().iter().chain(of_edges).chain(&surface.vertices) {
        keeps[corner as usize] = true;
    }
    let kept: Vec<u32> = (0..keeps.len() as u32).filter(|&i| keeps[i as usize]).collect();
    let n_left = keeps.len() - kept.len();
    if n_left == 0 {
        return Ok(());
    }
    let mut number = vec![0; keeps.len()];
    for (new, &old) in kept.iter().enumerate() {
        number[old as usize] = new as u32;
    }
    let (offsets, corners) = std::mem::take(&mut surface.faces).into_parts();
    let corners = collect(corners.len(), progress, |k| number[corners[k] as usize])?;
    surface.faces = adwave::shape::Polygons::from_parts(offsets, corners).unwrap_or_default();
    for corner in surface.edges.as_flattened_mut().iter_mut().chain(&mut surface.vertices) {
        *corner = number[*corner as usize];
    }
    let points = &shape.points;
    let points = collect(kept.len(), progress, |i| points[kept[i] as usize])?;
    for field in &mut shape.vertex_fields {
        *field = collect_rows(field, kept.len(), progress, &|i| kept[i] as usize)?;
    }
    shape.n_vertices = points.len();
    shape.points = points.into();
    extras.push(format!("{n_left} points inside volumes or between the corners of cells"));
    Ok(())
}

/// Turns the values of the cells that are faces into face fields.
fn cell_values(
    shape: &mut ShapeFile,
    surface: &CellSurface,
    cell_fields: Vec<Field>,
    extras: &mut Vec<String>,
    progress: Progress<'_>,
) -> Result<(), ReadError> {
    let n_faces = surface.faces.len();
    let is_cloud = n_faces == 0
        && surface.edges.is_empty()
        && surface.vertex_cells.len() == shape.n_vertices
        && surface.vertices.iter().copied().eq(0..shape.n_vertices as u32);
    for field in cell_fields {
        let name = field.name.clone();
        if is_cloud && field.len() == shape.n_vertices && shape.field(&name).is_none() {
            shape.vertex_fields.push(field);
            continue;
        }
        let has_value = |cell: &u32| {
            let k = field.n_channels;
            (0..k).any(|c| !is_filling(&field.values, *cell as usize * k + c))
        };
        if surface.line_cells.iter().any(has_value) {
            extras.push(format!("values of lines in `{name}`"));
        }
        if surface.vertex_cells.iter().any(has_value) {
            extras.push(format!("values of points as cells in `{name}`"));
        }
        if n_faces == 0 {
            continue;
        }
        shape.face_fields.push(match &surface.sources {
            FaceSources::From(0) if field.len() == n_faces => field,
            FaceSources::From(first) => collect_rows(&field, n_faces, progress, &|f| first + f)?,
            FaceSources::List(cells) => collect_rows(&field, n_faces, progress, &|f| cells[f] as usize)?,
        });
    }
    Ok(())
}

/// True for the value that is written where there is none: NaN, or zero for integers.
fn is_filling(values: &FieldValues, i: usize) -> bool {
    let x = values.get(i);
    if values.value_type().is_integer() { x == 0.0 } else { x.is_nan() }
}
