//! Clouds: LAS and LAZ files in, point records out.

use std::path::{Path, PathBuf};

use adwave_io::{LasReader, LasWriter};
use rayon::prelude::*;

use super::input_shape::{InputFile, InputShape, input_error};
use super::vertex_values::VertexValues;
use crate::bounds::BoundingBox;
use crate::error::TilesError;
use crate::index::blocks::Blocks;
use crate::layout::{LasQuantization, RecordLayout, quantized_xyz, set_quantized_xyz};
use crate::params::Params;

/// Largest scale and offset, so that positions and their squares are finite.
const MAX_SCALE: f64 = 1e40;
const MAX_OFFSET: f64 = 1e50;

/// Largest distance of an offset from that of the first file, in multiples of the scale.
const MAX_SHIFT: f64 = 4.5e9;

/// Largest deviation of a shift from a whole number of steps.
const SHIFT_TOLERANCE: f64 = 1e-4;

/// Reads the headers of all files; `None` without files.
pub(crate) fn read_headers(paths: &[PathBuf]) -> Result<Option<InputShape>, TilesError> {
    let mut shape: Option<InputShape> = None;
    for path in paths {
        let reader = LasReader::open(path)?;
        let bytes = std::fs::metadata(path).map_err(TilesError::io(path))?.len();
        let las = reader.layout();
        let quantization = LasQuantization {
            format: las.format,
            record_bytes: las.record_bytes,
            scale: las.scale,
            offset: las.offset,
        };
        let path = std::path::absolute(path).map_err(TilesError::io(path))?;
        if !quantization.scale.iter().all(|s| s.is_normal() && s.abs() < MAX_SCALE)
            || !quantization.offset.iter().all(|o| o.abs() < MAX_OFFSET)
        {
            return Err(input_error(
                &path,
                "its header has an invalid scale or offset; get an undamaged file",
            ));
        }
        let shape = shape.get_or_insert_with(|| InputShape {
            files: Vec::new(),
            layout: RecordLayout::Las(quantization),
            bounds: BoundingBox::EMPTY,
            n_points: 0,
            n_faces: 0,
        });
        let RecordLayout::Las(first) = shape.layout else {
            return Err(input_error(&path, "it is not a cloud"));
        };
        let shift = shift_from_first(&path, quantization, first)?;
        if las.n_points > 0 {
            shape.bounds.include(&quantized_bounds(las.bounds, quantization.scale, first.offset));
        }
        shape.n_points = shape.n_points.saturating_add(las.n_points);
        shape.files.push(InputFile { path, bytes, n_points: las.n_points, shift });
    }
    Ok(shape)
}

/// Difference between the offset of a file and that of the first file, in steps of the scale.
fn shift_from_first(
    path: &Path,
    quantization: LasQuantization,
    first: LasQuantization,
) -> Result<[i64; 3], TilesError> {
    if (quantization.format, quantization.record_bytes, quantization.scale)
        != (first.format, first.record_bytes, first.scale)
    {
        return Err(input_error(
            path,
            "its point format, record length or scale differs from the first file; convert one of them, or process them separately",
        ));
    }
    let mut shift = [0; 3];
    for (c, shift) in shift.iter_mut().enumerate() {
        let steps = (quantization.offset[c] - first.offset[c]) / quantization.scale[c];
        // A fraction of a step would round the points.
        if (steps - steps.round()).abs() > SHIFT_TOLERANCE || steps.abs() > MAX_SHIFT {
            return Err(input_error(
                path,
                "its offset must differ from that of the first file by a whole number of steps of the scale; give all files the same offset",
            ));
        }
        *shift = steps.round() as i64;
    }
    Ok(shift)
}

/// Bounding box of a header in multiples of the scale; all 32-bit coordinates if the header has none.
fn quantized_bounds(
    bounds: Option<([f64; 3], [f64; 3])>,
    scale: [f64; 3],
    first_offset: [f64; 3],
) -> BoundingBox {
    let (least, most) = (f64::from(i32::MIN), f64::from(i32::MAX));
    let steps = |c: usize, v: f64| ((v - first_offset[c]) / scale[c]).round().clamp(least, most);
    let (lo, hi) = bounds.map_or(([least; 3], [most; 3]), |(lo, hi)| {
        (std::array::from_fn(|c| steps(c, lo[c])), std::array::from_fn(|c| steps(c, hi[c])))
    });
    // A negative scale swaps the two.
    BoundingBox {
        min: std::array::from_fn(|c| lo[c].min(hi[c])),
        max: std::array::from_fn(|c| lo[c].max(hi[c])),
    }
}

/// Returns a function that appends up to n of the next records of all files and returns their number, 0 at the end. The
/// first `n_skipped` points are skipped.
pub(crate) fn record_reader(
    files: &[InputFile],
    record_bytes: usize,
    mut n_skipped: u64,
) -> impl FnMut(usize, &mut Vec<u8>) -> Result<usize, TilesError> {
    let mut files = files.iter();
    let mut current: Option<(LasReader, &InputFile)> = None;
    move |max_records, records| {
        loop {
            let Some((reader, file)) = &mut current else {
                let Some(file) = files.next() else { return Ok(0) };
                let mut reader = open_unchanged(file)?;
                if n_skipped < file.n_points {
                    reader.skip(std::mem::take(&mut n_skipped))?;
                    current = Some((reader, file));
                } else {
                    n_skipped -= file.n_points;
                }
                continue;
            };
            let start = records.len();
            let n = reader.read(max_records, records)?;
            if n > 0 {
                apply_shift(&mut records[start..], record_bytes, file)?;
                return Ok(n);
            }
            current = None;
        }
    }
}

/// Checks that no file has changed since the job was planned.
pub(crate) fn check_unchanged(files: &[InputFile]) -> Result<(), TilesError> {
    files.iter().try_for_each(|file| open_unchanged(file).map(drop))
}

fn open_unchanged(file: &InputFile) -> Result<LasReader, TilesError> {
    let reader = LasReader::open(&file.path)?;
    let bytes = std::fs::metadata(&file.path).map_err(TilesError::io(&file.path))?.len();
    if bytes != file.bytes || reader.layout().n_points != file.n_points {
        return Err(file.changed());
    }
    Ok(reader)
}

/// Moves the quantized coordinates to the shared offset.
fn apply_shift(records: &mut [u8], record_bytes: usize, file: &InputFile) -> Result<(), TilesError> {
    if file.shift == [0; 3] {
        return Ok(());
    }
    let shift_record = |record: &mut [u8]| {
        let mut xyz = quantized_xyz(record);
        for (c, shift) in xyz.iter_mut().zip(file.shift) {
            *c = i32::try_from(i64::from(*c) + shift).ok()?;
        }
        set_quantized_xyz(record, xyz);
        Some(())
    };
    if records.par_chunks_exact_mut(record_bytes).any(|record| shift_record(record).is_none()) {
        return Err(input_error(
            &file.path,
            "its points are too far from those of the first file for 32-bit coordinates; process the files separately",
        ));
    }
    Ok(())
}

/// Creates a file for the results, with the header of the first input and the added fields.
pub(crate) fn create_writer(
    shape: &InputShape,
    params: &Params,
    path: &Path,
) -> Result<LasWriter, TilesError> {
    let template = LasReader::open(&shape.files[0].path)?;
    Ok(LasWriter::create(path, &template, &params.field_names(), None)?)
}

/// Output records of a block, without the saliency. `points` and `values` have an entry per vertex of the block.
pub(crate) fn output_records(
    quantization: LasQuantization,
    blocks: &Blocks,
    records: &[u8],
    points: &[[f64; 3]],
    values: &VertexValues<'_>,
) -> Result<Vec<u8>, TilesError> {
    let mut output = Vec::with_capacity(2 * records.len());
    for (vertex, record) in blocks.with_vertices(records) {
        let start = output.len();
        output.extend_from_slice(&record[..quantization.record_bytes]);
        if let (Some(changes), Some(vertex)) = (values.change, vertex) {
            let change = changes[vertex];
            let position: [f64; 3] = std::array::from_fn(|c| points[vertex][c] + change[c]);
            let Some(xyz) = quantization.quantize(position) else {
                return Err(TilesError::Input(format!(
                    "a point would move to {}, outside the range of 32-bit coordinates of this scale; use smaller gains",
                    position.map(|c| format!("{c:.3e}")).join(" ")
                )));
            };
            set_quantized_xyz(&mut output[start..], xyz);
        }
        match vertex {
            Some(vertex) => values.push_fields(vertex, &mut output),
            None => values.push_outsider_fields(blocks.outsider_value(record), &mut output),
        }
    }
    Ok(output)
}
