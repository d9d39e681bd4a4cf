//! NIfTI reader.

use std::sync::Arc;

use adwave::Progress;

use super::header::NiftiHeader;
use super::write::NiftiDocument;
use crate::model::grid_layout::{GridLayout, note_on_missing, step_lengths};
use crate::model::grid_values::{GridNumbers, GridValues};
use crate::{Format, LengthUnit, ReadError, ReadLimits, ShapeFile};

/// Relative difference of spacings beyond that of 32-bit floats that were computed from each other.
const ROUNDING: f64 = 1e-3;

pub(super) fn read_nifti(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let header = NiftiHeader::parse(&bytes)?;
    let (kind, n_components) = header.value_type().ok_or_else(|| {
        let message = format!(
            "values of type {} are not supported; save them as floats of 32 or 64 bits",
            header.datatype
        );
        ReadError::Whole(message)
    })?;
    let n_axes = header.sizes.len().min(3);
    let too_large =
        || ReadError::Whole("the sizes of the axes are beyond any file; get an intact file".into());
    let product = |sizes: &[usize]| sizes.iter().try_fold(1_usize, |n, size| n.checked_mul(*size));
    let n_places = product(&header.sizes[..n_axes]).ok_or_else(too_large)?;
    let n_planes = product(&header.sizes[n_axes..]).ok_or_else(too_large)?;
    let (slope, intercept) = header.scaling();
    let mut notes = Vec::new();
    if matches!(header.datatype, 32 | 1792) {
        notes.push("complex numbers are two channels, the real and the imaginary part".into());
        if intercept != 0.0 {
            let message = "complex numbers with an intercept are not supported; save them as floats";
            return Err(ReadError::Whole(message.into()));
        }
    }
    let numbers = GridNumbers {
        n_planes,
        slope,
        intercept,
        ..GridNumbers::new(kind, header.order, n_places, n_components)
    };
    let found = numbers.slice(&bytes, header.start, limits)?;
    let GridValues { field, kept, are_numbers } = numbers.read(found, progress)?;
    let layout = GridLayout { kept, ..layout(&header, &mut notes) };
    note_on_missing(&layout, None, &mut notes);
    let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.format = Some(Format::NIFTI);
    shape.vertex_fields.push(field.with_frame_step(frame_step(&header)));
    shape.notes = notes;
    shape.original = Some(Arc::new(NiftiDocument::new(bytes, header, numbers, are_numbers)));
    Ok(shape)
}

/// Axes k, j, i of the voxels, whose values run fastest along i.
fn layout(header: &NiftiHeader, notes: &mut Vec<String>) -> GridLayout {
    let n = header.sizes.len().min(3);
    let sizes: Vec<usize> = header.sizes[..n].iter().rev().copied().collect();
    let (columns, origin) = affine(header);
    let steps: Vec<[f64; 3]> = columns[..n].iter().rev().copied().collect();
    let spacings = step_lengths(&steps, notes);
    let stated: Vec<f64> = header.pixdim[1..=n].iter().rev().map(|h| h.abs()).collect();
    if spacings.iter().zip(&stated).any(|(h, stated)| (h / stated - 1.0).abs() > ROUNDING) {
        notes.push(format!(
            "the spacings {stated:?} in the header differ from the lengths {spacings:?} of its affine matrix, which are \
             used"
        ));
    }
    let unit = match header.units & 7 {
        1 => Some(LengthUnit::METER),
        2 => Some(LengthUnit::MILLIMETER),
        3 => Some(LengthUnit::MICRON),
        _ => None,
    };
    if unit.is_none() {
        notes.push("the header states no unit of length; most programs take millimeters".into());
    }
    let axis_names = ["z", "y", "x"][3 - n..].to_vec();
    GridLayout { sizes, spacings, axis_names, origin, steps, unit, kept: None }
}

/// Seconds from frame to frame, if the fourth axis is the last one and time in a unit that the header states.
fn frame_step(header: &NiftiHeader) -> Option<f64> {
    let is_last = header.sizes.len() > 3 && header.sizes[4..].iter().all(|&n| n == 1);
    let unit = match header.units & 0o70 {
        8 => 1.0,
        16 => 1e-3,
        24 => 1e-6,
        _ => return None,
    };
    is_last.then(|| header.pixdim[4] * unit)
}

/// Steps of the voxels along i, j and k, and position of the first voxel: the sform, else the qform, else the spacings
/// alone.
fn affine(header: &NiftiHeader) -> ([[f64; 3]; 3], [f64; 3]) {
    let NiftiHeader { pixdim, rows, quaternion, .. } = header;
    let is_finite = |columns: &[[f64; 3]; 3], origin: [f64; 3]| {
        origin.iter().all(|x| x.is_finite())
            && columns.iter().all(|column| column.iter().map(|x| x * x).sum::<f64>().sqrt().is_normal())
    };
    if header.sform_code > 0 {
        let columns = std::array::from_fn(|k| std::array::from_fn(|row| rows[row][k]));
        let origin = std::array::from_fn(|row| rows[row][3]);
        if is_finite(&columns, origin) {
            return (columns, origin);
        }
    }
    if header.qform_code > 0 {
        let [mut b, mut c, mut d, x, y, z] = *quaternion;
        let square = b * b + c * c + d * d;
        let a = (1.0 - square).max(0.0).sqrt();
        if square > 1.0 {
            [b, c, d] = [b, c, d].map(|part| part / square.sqrt());
        }
        let handedness = if pixdim[0] < 0.0 { -1.0 } else { 1.0 };
        let rotation = [
            [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
            [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
            [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - c * c - b * b],
        ];
        let lengths = [pixdim[1].abs(), pixdim[2].abs(), handedness * pixdim[3].abs()];
        let columns: [[f64; 3]; 3] = std::array::from_fn(|k| rotation[k].map(|x| x * lengths[k]));
        if is_finite(&columns, [x, y, z]) {
            return (columns, [x, y, z]);
        }
    }
    let column = |k: usize| {
        let mut column = [0.0; 3];
        let spacing = pixdim[k + 1].abs();
        column[k] = if spacing.is_finite() { spacing } else { 0.0 };
        column
    };
    ([column(0), column(1), column(2)], [0.0; 3])
}
