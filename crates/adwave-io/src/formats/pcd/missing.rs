//! Points without a place, as depth cameras write them where they saw nothing: the shape is without them, and they come back as they
//! were when it is written as a PCD.

use adwave::{Cancelled, Progress};

use crate::model::field::FieldValues;
use crate::model::subset::selected;
use crate::progress::{all, at_row};
use crate::{Field, ReadError, ShapeFile};

/// Cloud with all its points, and the indices of those with a position.
#[derive(Debug)]
pub(crate) struct Whole {
    file: ShapeFile,
    kept: Vec<u32>,
}

/// Drops the points without a position, if there are some with and some without one.
pub(crate) fn without_missing(file: ShapeFile, progress: Progress<'_>) -> Result<ShapeFile, ReadError> {
    let is_there = |i: usize| file.points[i].iter().all(|x| x.is_finite());
    if all(file.n_vertices, progress, is_there)? {
        return Ok(file);
    }
    let mut kept = Vec::new();
    for i in 0..file.n_vertices {
        at_row(progress, i as u64, file.n_vertices as u64)?;
        if is_there(i) {
            kept.push(i as u32);
        }
    }
    if kept.is_empty() {
        return Ok(file);
    }
    let mut shape = ShapeFile::from_cloud(kept.iter().map(|&i| file.points[i as usize]).collect());
    shape.format = file.format;
    shape.precision = file.precision;
    shape.vertex_fields = file.vertex_fields.iter().map(|field| selected(field, &kept)).collect();
    shape.extras.push(format!("{} points without a place", file.n_vertices - kept.len()));
    let Some(own) = file.source::<super::read::PcdSource>() else { return Ok(shape) };
    let (viewpoint, width, height) = (own.viewpoint.clone(), own.width, own.height);
    let whole = Some(Box::new(Whole { file, kept }));
    let original = super::read::PcdSource { viewpoint, width, height, rows: None, whole };
    shape.set_source(original);
    Ok(shape)
}

impl Whole {
    /// Restores the whole cloud with the present positions and fields of the shape. A new field is 0 or NaN at points
    /// that are not part of the shape.
    pub(crate) fn with(&self, shape: &ShapeFile, progress: Progress<'_>) -> Result<ShapeFile, Cancelled> {
        let mut file = self.file.clone();
        let mut points = file.points.to_vec();
        for (row, &i) in self.kept.iter().enumerate() {
            at_row(progress, row as u64, self.kept.len() as u64)?;
            points[i as usize] = shape.points[row];
        }
        file.points = points.into();
        file.moved = shape.moved;
        file.edited.clone_from(&shape.edited);
        file.format = shape.format;
        let fields = shape.vertex_fields.iter().map(|field| self.spread(field)).collect();
        file.vertex_fields = fields;
        Ok(file)
    }

    fn spread(&self, field: &Field) -> Field {
        let n = field.n_channels;
        let is_same = |old: &&Field| {
            old.name == field.name
                && old.n_channels == n
                && old.values.value_type() == field.values.value_type()
        };
        let old = self.file.vertex_fields.iter().find(is_same).map(|old| old.values.clone());
        let mut values = old.unwrap_or_else(|| {
            let mut values = field.values.value_type().empty();
            let nothing = if field.values.value_type().is_integer() { 0.0 } else { f64::NAN };
            for _ in 0..self.file.n_vertices * n {
                values.push_f64(nothing);
            }
            values
        });
        macro_rules! scatter {
            ($($variant:ident),*) => {
                match (&field.values, &mut values) {
                    $((FieldValues::$variant(some), FieldValues::$variant(all)) => {
                        for (row, &i) in self.kept.iter().enumerate() {
                            all[i as usize * n..(i as usize + 1) * n].copy_from_slice(&some[row * n..(row + 1) * n]);
                        }
                    })*
                    _ => {}
                }
            };
        }
        scatter!(U8, I8, U16, I16, U32, I32, U64, I64, F32, F64);
        Field::new(field.name.clone(), n, values)
    }
}
