//! MRC reader.

use std::sync::Arc;

use super::header::MrcHeader;
use super::write::MrcDocument;
use crate::model::context::ReadContext;
use crate::model::grid_layout::{GridLayout, note_on_missing, step_lengths};
use crate::model::grid_values::GridNumbers;
use crate::{Format, LengthUnit, ReadError, ShapeFile};

/// Length of an ångström in meters.
const ANGSTROM: f64 = 1e-10;

/// The unit of maps.
pub(super) fn angstrom() -> Option<LengthUnit> {
    LengthUnit::from_meters("angstrom", ANGSTROM)
}

pub(super) fn read_mrc(bytes: Vec<u8>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let header = MrcHeader::parse(&bytes)?;
    let too_large =
        || ReadError::Whole("the sizes of the axes are beyond any file; get an intact file".into());
    let n_places =
        header.sizes.iter().try_fold(1_usize, |n, size| n.checked_mul(*size)).ok_or_else(too_large)?;
    let numbers = GridNumbers::new(header.kind, header.order, n_places, 1);
    let values = numbers.read(numbers.slice(&bytes, header.start, c.limits)?, c.progress)?;
    let mut notes = Vec::new();
    let layout = GridLayout { kept: values.kept, ..layout(&header, &mut notes) };
    note_on_missing(&layout, None, &mut notes);
    let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.vertex_fields.push(values.field);
    shape.format = Some(Format::MRC);
    shape.notes = notes;
    shape.original = Some(Arc::new(MrcDocument { bytes, header, numbers }));
    Ok(shape)
}

fn layout(header: &MrcHeader, notes: &mut Vec<String>) -> GridLayout {
    let MrcHeader { sizes, starts, intervals, cell, axes, origin, .. } = header;
    let [a, b, c] = [cell[0], cell[1], cell[2]];
    let angle = |k: usize| {
        if cell[k] > 0.0 && cell[k] < 180.0 && cell[k] != 90.0 { cell[k].to_radians().cos() } else { 0.0 }
    };
    let [alpha, beta, gamma] = [angle(3), angle(4), angle(5)];
    let sine = (1.0 - gamma * gamma).sqrt();
    let third = (alpha - beta * gamma) / sine;
    let height = (1.0 - beta * beta - third * third).max(0.0).sqrt();
    // Vectors of the cell along x, y and z.
    let vectors = [[a, 0.0, 0.0], [b * gamma, b * sine, 0.0], [c * beta, c * third, c * height]];
    let is_known = (0..3).all(|k| {
        let length: f64 = vectors[k].iter().map(|x| x * x).sum();
        length.sqrt().is_normal() && intervals[k] > 0.0
    });
    let step = |k: usize| -> [f64; 3] {
        let axis = axes[k];
        if is_known {
            vectors[axis].map(|x| x / intervals[axis])
        } else {
            std::array::from_fn(|row| if row == axis { 1.0 } else { 0.0 })
        }
    };
    let steps = [step(2), step(1), step(0)];
    let mut first = origin.map(|x| if x.is_finite() { x } else { 0.0 });
    for (k, start) in starts.iter().enumerate() {
        for (x, d) in first.iter_mut().zip(step(k)) {
            *x += start * d;
        }
    }
    if !is_known {
        notes.push("the file states no cell; spacings are 1".into());
    }
    if header.space_group == 0 && sizes[2] > 1 {
        notes.push("the file is a stack of images, which is taken as a volume".into());
    }
    let spacings = step_lengths(&steps, notes);
    let names = ["x", "y", "z"];
    GridLayout {
        sizes: vec![sizes[2], sizes[1], sizes[0]],
        spacings,
        axis_names: vec![names[axes[2]], names[axes[1]], names[axes[0]]],
        origin: first,
        steps: steps.to_vec(),
        unit: if is_known { angstrom() } else { None },
        kept: None,
    }
}
