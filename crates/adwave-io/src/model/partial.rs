//! Shapes that are a part of their file: vertices without a position are left out on reading, others on request.
//! Results are numbered by the rows of the file, and vertices that were left out come back when the shape is written.

use std::sync::Arc;

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use crate::model::field::{COORDS, FieldValues};
use crate::model::subset::selected;
use crate::progress::{all, report_row};
use crate::{Field, ReadError, ShapeFile, ShapeFileError};

/// Rows of a file that are the vertices of a shape, in ascending order.
///
/// ```
/// use adwave_io::ShapeFile;
/// let file = ShapeFile::from_cloud(vec![[0.0; 3], [1.0; 3], [2.0; 3]]);
/// let part = file.select_rows(&[true, false, true])?;
/// let rows = part.file_rows().unwrap();
/// assert_eq!((rows.n_rows(), rows.row(1), rows.vertex(1), rows.vertex(2)), (3, 2, None, Some(1)));
/// # Ok::<(), adwave_io::ShapeFileError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FileRows {
    n_rows: usize,
    kept: Vec<u32>,
}

impl FileRows {
    /// Rows `kept` of `n_rows`.
    pub(crate) fn new(n_rows: usize, kept: Vec<u32>) -> Self {
        Self { n_rows, kept }
    }

    /// Number of rows of the file.
    pub fn n_rows(&self) -> usize {
        self.n_rows
    }

    /// Row of each vertex.
    pub fn vertex_rows(&self) -> &[u32] {
        &self.kept
    }

    /// Row of a vertex.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn row(&self, vertex: usize) -> usize {
        self.kept[vertex] as usize
    }

    /// Vertex in a row; `None` if the row is not part of the shape.
    pub fn vertex(&self, row: usize) -> Option<usize> {
        self.kept.binary_search(&u32::try_from(row).ok()?).ok()
    }

    /// Rows of a field of the whole file that are part of the shape.
    ///
    /// # Panics
    /// If the field has fewer than [`n_rows`](Self::n_rows) rows.
    pub fn select(&self, field: &Field) -> Field {
        selected(field, &self.kept)
    }

    /// Values with a row of `n_channels` for each row of the file, NaN where the row is not part of the shape. Several
    /// blocks of values, each with a row per vertex, give as many blocks.
    pub fn spread_values(&self, values: &[f64], n_channels: usize) -> Vec<f64> {
        let block = (self.kept.len() * n_channels).max(1);
        let mut all = vec![f64::NAN; values.len() / block * self.n_rows * n_channels];
        let blocks = all.chunks_exact_mut((self.n_rows * n_channels).max(1));
        for (all, some) in blocks.zip(values.chunks_exact(block)) {
            for (row, &to) in some.chunks_exact(n_channels).zip(&self.kept) {
                all[to as usize * n_channels..][..n_channels].copy_from_slice(row);
            }
        }
        all
    }

    /// Field with a row for each row of the file. Rows that are not part of the shape get the value of `old` if it
    /// has the same number of channels and the type of the field, else NaN; integers become 64-bit floats then.
    pub fn spread(&self, field: &Field, old: Option<&Field>) -> Field {
        let fits = |old: &&Field| old.n_channels == field.n_channels && old.len() == self.n_rows;
        let is_same = |old: &&Field| fits(old) && old.values.value_type() == field.values.value_type();
        if let Some(values) = old.filter(is_same) {
            return scattered(field, &self.kept, values.values.clone());
        }
        let n = self.n_rows * field.n_channels;
        let float = match &field.values {
            FieldValues::F32(_) | FieldValues::F64(_) => field.clone(),
            values => Field::new(field.name.clone(), field.n_channels, FieldValues::F64(values.to_f64()))
                .with_labels(field.labels.clone()),
        };
        let values = match (&float.values, old.filter(fits)) {
            (FieldValues::F32(_), Some(old)) => {
                FieldValues::F32(old.to_f64().into_iter().map(|x| x as f32).collect())
            }
            (FieldValues::F32(_), None) => FieldValues::F32(vec![f32::NAN; n]),
            (_, Some(old)) => FieldValues::F64(old.to_f64()),
            (_, None) => FieldValues::F64(vec![f64::NAN; n]),
        };
        scattered(&float, &self.kept, values)
    }
}

/// Rows of a field, put into `values` at `rows`.
fn scattered(field: &Field, rows: &[u32], mut values: FieldValues) -> Field {
    let n = field.n_channels;
    macro_rules! scatter {
        ($($variant:ident),*) => {
            match (&field.values, &mut values) {
                $((FieldValues::$variant(some), FieldValues::$variant(all)) => {
                    for (from, &to) in rows.iter().enumerate() {
                        all[to as usize * n..][..n].copy_from_slice(&some[from * n..][..n]);
                    }
                })*
                _ => {}
            }
        };
    }
    scatter!(U8, I8, U16, I16, U32, I32, U64, I64, F32, F64);
    Field { name: field.name.clone(), values, labels: field.labels.clone(), ..*field }
}

/// File that a shape is a part of.
#[derive(Clone, Debug)]
pub(crate) struct WholeFile {
    pub(crate) file: ShapeFile,
    /// Row in `file` of each vertex.
    pub(crate) kept: Vec<u32>,
    /// Row in `file` of each face.
    pub(crate) faces: Vec<u32>,
    /// True if the vertices were left out because they have no position.
    pub(crate) is_missing: bool,
}

impl ShapeFile {
    /// Rows of the file that are the vertices of this shape; `None` if all are.
    pub fn file_rows(&self) -> Option<&FileRows> {
        self.rows.as_deref()
    }

    /// Number of rows of the file: the vertices of this shape, and those that were left out.
    pub fn n_file_rows(&self) -> usize {
        self.rows.as_deref().map_or(self.n_vertices, FileRows::n_rows)
    }

    /// Row of the file of a vertex: the number by which people know it.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn file_row(&self, vertex: usize) -> usize {
        self.rows.as_deref().map_or(vertex, |rows| rows.row(vertex))
    }

    /// Field with a row for each row of the file. Rows that are not part of this shape keep the values of the file's
    /// field `name`, and are NaN if it has none.
    pub fn in_file_rows(&self, field: Field) -> Field {
        let Some(rows) = &self.rows else { return field };
        if field.len() != self.n_vertices {
            return field;
        }
        let Some(whole) = self.outermost() else { return rows.spread(&field, None) };
        if let Some(old) = whole.field(&field.name) {
            return rows.spread(&field, Some(old));
        }
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == field.name);
        let old = match (axis, field.name.as_str()) {
            (Some(axis), _) => whole.points.iter().map(|p| p[axis]).collect(),
            (None, COORDS) => whole.points.as_flattened().to_vec(),
            (None, _) => return rows.spread(&field, None),
        };
        let old = Field::new("", if axis.is_some() { 1 } else { 3 }, FieldValues::F64(old));
        rows.spread(&field, Some(&old))
    }

    /// Gives the rows that are not part of this shape their values of a field, of which `field` has a row for each row
    /// of the file. They come back with these values if a field of that name, type and number of channels is written.
    /// Without such rows nothing changes.
    ///
    /// ```
    /// use adwave_io::{Field, FieldValues, ShapeFile};
    /// let file = ShapeFile::from_cloud(vec![[0.0; 3], [1.0; 3], [2.0; 3]]);
    /// let heat = |values: &[f64]| Field::new("heat", 1, FieldValues::F64(values.to_vec()));
    /// let mut part = file.select_rows(&[true, false, true])?;
    /// part.set_left_out_values(&heat(&[5.0, 6.0, 7.0]));
    /// assert_eq!(part.in_file_rows(heat(&[0.0, 1.0])).to_f64(), [0.0, 6.0, 1.0]);
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    pub fn set_left_out_values(&mut self, field: &Field) {
        let Some(whole) =
            self.whole.as_mut().filter(|_| field.len() == self.rows.as_ref().map_or(0, |r| r.n_rows))
        else {
            return;
        };
        let file = &mut Arc::make_mut(whole).file;
        let rows = file.rows.clone();
        let own = rows.as_deref().map_or_else(|| field.clone(), |rows| rows.select(field));
        file.vertex_fields.retain(|old| old.name != field.name);
        file.vertex_fields.push(own);
        file.set_left_out_values(field);
    }

    /// File with all its rows; `None` if this shape is not a part of one, or the rest was not kept.
    pub(crate) fn outermost(&self) -> Option<&Self> {
        let whole = self.whole.as_deref()?;
        Some(whole.file.outermost().unwrap_or(&whole.file))
    }

    /// Part of the shape with the vertices for which `keep` is true, which may be all of them. Faces and edges stay if
    /// all their vertices do. The other vertices come back with their positions and values when the part is written.
    ///
    /// # Errors
    /// [`ShapeFileError::PointCount`] if `keep` does not have one entry per vertex,
    /// [`ShapeFileError::EmptySelection`] if it keeps no vertex.
    pub fn select_rows(&self, keep: &[bool]) -> Result<Self, ShapeFileError> {
        if keep.len() != self.n_vertices {
            return Err(ShapeFileError::PointCount { found: keep.len(), n_vertices: self.n_vertices });
        }
        let kept: Vec<u32> = (0..self.n_vertices as u32).filter(|&i| keep[i as usize]).collect();
        if kept.is_empty() {
            return Err(ShapeFileError::EmptySelection);
        }
        if kept.len() == self.n_vertices {
            return Ok(self.clone());
        }
        Ok(self.part(kept, false))
    }

    /// Makes this shape a file of its own: the vertices that were left out do not come back, and its rows are its
    /// vertices.
    pub fn forget_left_out(&mut self) {
        self.whole = None;
        self.rows = None;
    }

    fn part(&self, kept: Vec<u32>, is_missing: bool) -> Self {
        let mut new = vec![u32::MAX; self.n_vertices];
        for (vertex, &row) in kept.iter().enumerate() {
            new[row as usize] = vertex as u32;
        }
        let (mut faces, mut face_rows) = (Polygons::new(), Vec::new());
        for (f, face) in self.faces.iter().enumerate() {
            if face.iter().all(|&x| new.get(x as usize).is_some_and(|&x| x != u32::MAX)) {
                let corners: Vec<u32> = face.iter().map(|&x| new[x as usize]).collect();
                faces.push(&corners);
                face_rows.push(f as u32);
            }
        }
        let mut edges = crate::Edges { direction: self.edges.direction, ..crate::Edges::default() };
        for (k, pair) in self.edges.pairs.iter().enumerate() {
            let ends = pair.map(|x| new.get(x as usize).copied().unwrap_or(u32::MAX));
            if !ends.contains(&u32::MAX) {
                edges.pairs.push(ends);
                edges.weights.extend(self.edges.weights.get(k));
            }
        }
        let points = if self.points.is_empty() {
            Vec::new()
        } else {
            kept.iter().map(|&i| self.points[i as usize]).collect()
        };
        let rows = match self.rows.as_deref() {
            None => FileRows::new(self.n_vertices, kept.clone()),
            Some(rows) => FileRows::new(rows.n_rows, kept.iter().map(|&i| rows.kept[i as usize]).collect()),
        };
        Self {
            n_vertices: kept.len(),
            points: Arc::new(points),
            vertex_fields: self.vertex_fields.iter().map(|field| selected(field, &kept)).collect(),
            face_fields: self.face_fields.iter().map(|field| selected(field, &face_rows)).collect(),
            faces: Arc::new(faces),
            edges,
            original: self.original.as_deref().and_then(|source| source.subset(&kept)),
            rows: Some(Arc::new(rows)),
            whole: Some(Arc::new(WholeFile { file: self.clone(), kept, faces: face_rows, is_missing })),
            ..self.clone()
        }
    }

    /// Leaves out the vertices without a position, as written by depth cameras, if no face or edge uses them and some
    /// vertices have a position.
    pub(crate) fn without_missing(self, progress: Progress<'_>) -> Result<Self, ReadError> {
        let is_there = |i: usize| self.points[i].iter().all(|x| x.is_finite());
        if all(self.points.len(), progress, is_there)? {
            return Ok(self);
        }
        let mut kept = Vec::new();
        for i in 0..self.points.len() {
            report_row(progress, i as u64, self.n_vertices as u64)?;
            if is_there(i) {
                kept.push(i as u32);
            }
        }
        let is_missing =
            |x: u32| self.points.get(x as usize).is_none_or(|p| !p.iter().all(|c| c.is_finite()));
        let ends = self.edges.pairs.as_flattened();
        if kept.is_empty() || self.faces.corners().iter().chain(ends).any(|&x| is_missing(x)) {
            return Ok(self);
        }
        let n_missing = self.n_vertices - kept.len();
        let mut part = self.part(kept, true);
        part.extras.push(format!("{n_missing} points without a position"));
        Ok(part)
    }

    /// Shape with the vertices that were left out, as far as the format written can hold them; `None` if nothing
    /// changes.
    pub(crate) fn with_left_out(
        &self,
        holds_missing: bool,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let Some(whole) = self.whole.as_deref().filter(|whole| holds_missing || !whole.is_missing) else {
            return Ok(None);
        };
        progress.check()?;
        Ok(Some(whole.restore(self)))
    }

    /// Drops the original bytes of the whole file too.
    pub(crate) fn forget_original_of_whole(&mut self) {
        if let Some(whole) = &mut self.whole {
            Arc::make_mut(whole).file.forget_original();
        }
    }
}

impl WholeFile {
    /// Restores the whole file with the present positions and fields of its part.
    fn restore(&self, part: &ShapeFile) -> ShapeFile {
        let mut file = self.file.clone();
        if !file.points.is_empty() {
            let mut points = file.points.to_vec();
            for (from, &to) in self.kept.iter().enumerate() {
                points[to as usize] = part.points[from];
            }
            file.points = Arc::new(points);
        }
        file.moved |= part.moved;
        file.edited.clone_from(&part.edited);
        file.format = part.format;
        file.unit.clone_from(&part.unit);
        file.provenance.clone_from(&part.provenance);
        file.is_new_provenance = part.is_new_provenance;
        if file.precision != part.precision {
            file.set_precision(part.precision);
        }
        let spread = |field: &Field, rows: &[u32], n: usize, old: &[Field]| {
            let value_type = field.values.value_type();
            let is_same = |old: &&Field| {
                old.name == field.name
                    && old.n_channels == field.n_channels
                    && old.values.value_type() == value_type
            };
            let empty_rows = || {
                let mut values = value_type.empty();
                let nothing = if value_type.is_integer() { 0.0 } else { f64::NAN };
                for _ in 0..n * field.n_channels {
                    values.push_f64(nothing);
                }
                values
            };
            let values = old.iter().find(is_same).map_or_else(empty_rows, |old| old.values.clone());
            scattered(field, rows, values)
        };
        file.vertex_fields = (part.vertex_fields.iter())
            .map(|field| spread(field, &self.kept, self.file.n_vertices, &self.file.vertex_fields))
            .collect();
        if part.face_fields.len() != file.face_fields.len() {
            file.original = None;
        }
        file.face_fields = (part.face_fields.iter())
            .map(|field| spread(field, &self.faces, self.file.faces.len(), &self.file.face_fields))
            .collect();
        file
    }
}
