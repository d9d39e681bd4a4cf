//! A CIFTI as a whole: the values of all of its parts, and the same file with other values.

use std::sync::Arc;

use adwave::Progress;

use super::models::{CiftiMaps, VoxelModel};
use super::read::{CiftiHead, read_head};
use super::update::float_type;
use crate::model::context::WriteContext;
use crate::model::f32_limits::check_range;
use crate::model::field::ByteOrder;
use crate::model::grid_layout::step_lengths;
use crate::model::numbers::Numbers;
use crate::model::source_document::{SourceDocument, Update};
use crate::progress::{BYTES_PER_STEP, extend};
use crate::{
    BRAIN_VALUES, BrainLayout, BrainPart, BrainPlaces, Field, FieldValues, Format, GridLayout, LengthUnit,
    ReadError, ReadLimits, ShapeFile, ValueType, WriteError,
};

/// Most places of the box around the voxels: these, or so many for each voxel, so that a small file cannot ask for a large
/// box.
const BOX_PLACES: u64 = 1 << 22;
const BOX_PLACES_PER_VOXEL: u64 = 256;

/// Bytes of the file around its numbers, and their type.
#[derive(Debug)]
struct CiftiDocument {
    before: Vec<u8>,
    after: Vec<u8>,
    kind: ValueType,
    order: ByteOrder,
    n_columns: usize,
}

/// Reads the values of all parts. Integers and scaled numbers become floats.
pub(super) fn read_whole(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let (head, maps) = read_head(bytes, progress)?;
    if maps.columns.is_none() {
        return Err(ReadError::Whole(
            "the columns of this CIFTI are neither scalars nor a series; use it as a field of a surface, or save it as \
             .dscalar.nii or .dtseries.nii"
                .into(),
        ));
    }
    let CiftiHead { kind: stored, order, start, n_bytes, n_columns, n_rows, is_scaled, scale } = head;
    limits.check_bytes((n_rows as u64).saturating_mul(n_columns as u64).saturating_mul(8))?;
    let (step, mut notes) = (maps.step, Vec::new());
    let layout = layout(maps, n_rows, n_columns, &mut notes)?;
    let kind = float_type(stored, is_scaled);
    let numbers = Numbers::Bytes { bytes: (&bytes[start..start + n_bytes]).into(), kind: stored, order };
    let value = |k: usize| if is_scaled { scale[0] * numbers.get(k) + scale[1] } else { numbers.get(k) };
    let values = if kind == ValueType::F32 {
        let mut single = Vec::new();
        extend(&mut single, n_rows * n_columns, progress, |k| value(k) as f32)?;
        FieldValues::F32(single)
    } else {
        let mut double = Vec::new();
        extend(&mut double, n_rows * n_columns, progress, value)?;
        FieldValues::F64(double)
    };
    let mut shape =
        ShapeFile::from_brain(layout, Field::new(BRAIN_VALUES, n_columns, values).with_frame_step(step));
    let mut before = bytes[..start].to_vec();
    head.state_floats(kind, &mut before);
    let after = bytes[start + n_bytes..].to_vec();
    shape.format = Some(Format::CIFTI);
    shape.notes = notes;
    shape.original = Some(Arc::new(CiftiDocument { before, after, kind, order, n_columns }));
    Ok(shape)
}

/// The parts in the order of their rows, which must be all rows.
fn layout(
    maps: CiftiMaps,
    n_rows: usize,
    n_columns: usize,
    notes: &mut Vec<String>,
) -> Result<BrainLayout, ReadError> {
    let surfaces = maps.models.into_iter().map(|model| {
        let places = BrainPlaces::Surface { n_vertices: model.n_vertices as usize, vertices: model.vertices };
        (model.first, model.structure, places)
    });
    let mut parts: Vec<(u64, String, BrainPlaces)> = surfaces.collect();
    let volume = if maps.voxels.is_empty() {
        None
    } else {
        let volume = maps.volume.ok_or_else(|| {
            ReadError::Whole(
                "the CIFTI has voxels and does not say where they are (Volume); save it again".into(),
            )
        })?;
        let n_voxels: u64 = maps.voxels.iter().map(|model| model.indices.len() as u64).sum();
        let Some([low, high]) = bounds(&maps.voxels) else {
            return Err(ReadError::Whole("the CIFTI names structures without voxels; save it again".into()));
        };
        let sizes: [usize; 3] = std::array::from_fn(|axis| (high[axis] - low[axis]) as usize + 1);
        if high.iter().zip(volume.sizes).any(|(high, size)| *high >= size) {
            let message = format!("the CIFTI has a voxel {high:?} beyond its volume of {:?}", volume.sizes);
            return Err(ReadError::Whole(message));
        }
        let n_places = sizes.iter().fold(1_u64, |n, size| n.saturating_mul(*size as u64));
        if n_places > BOX_PLACES.max(BOX_PLACES_PER_VOXEL * n_voxels) {
            let message = format!(
                "the {n_voxels} voxels of the CIFTI must lie close together, and they spread over a box of {sizes:?}; save \
                 them in the volume that they were measured in"
            );
            return Err(ReadError::Whole(message));
        }
        let place = |v: &[u32; 3]| {
            let at: [usize; 3] = std::array::from_fn(|axis| (v[axis] - low[axis]) as usize);
            ((at[2] * sizes[1] + at[1]) * sizes[0] + at[0]) as u32
        };
        for VoxelModel { structure, first, indices } in &maps.voxels {
            let voxels = indices.iter().map(place).collect();
            parts.push((*first, structure.clone(), BrainPlaces::Voxels { voxels }));
        }
        // The last axis of a layout is contiguous, and the first index of a voxel runs fastest.
        let steps: Vec<[f64; 3]> = (0..3).rev().map(|axis| volume.matrix.map(|row| row[axis])).collect();
        let position =
            |row: &[f64; 4]| row[3] + (0..3).map(|axis| row[axis] * f64::from(low[axis])).sum::<f64>();
        let spacings = step_lengths(&steps, notes);
        let box_sizes = [sizes[2], sizes[1], sizes[0]];
        Some(GridLayout {
            origin: std::array::from_fn(|c| position(&volume.matrix[c])),
            steps,
            unit: Some(LengthUnit::MILLIMETER),
            ..GridLayout::new(&box_sizes, &spacings)
        })
    };
    parts.sort_by_key(|part| part.0);
    let mut at = 0;
    let mut ordered = Vec::with_capacity(parts.len());
    for (first, structure, places) in parts {
        let n = match &places {
            BrainPlaces::Surface { vertices, .. } => vertices.len(),
            BrainPlaces::Voxels { voxels } => voxels.len(),
        };
        if first != at as u64 || n == 0 {
            let message =
                format!("the rows of {structure} begin at {first} instead of {at}; save the CIFTI again");
            return Err(ReadError::Whole(message));
        }
        ordered.push(BrainPart { structure, rows: at..at + n, places });
        at += n;
    }
    if at != n_rows {
        return Err(ReadError::Whole(format!(
            "the CIFTI has {n_rows} rows, and its parts have {at}; save it again"
        )));
    }
    Ok(BrainLayout { parts: ordered, volume, n_columns })
}

/// Smallest and largest index along each axis; `None` without voxels.
fn bounds(models: &[VoxelModel]) -> Option<[[u32; 3]; 2]> {
    let ends = models.iter().flat_map(|model| &model.indices).map(|index| [*index, *index]);
    ends.reduce(|[low, high], [index, _]| {
        [
            std::array::from_fn(|axis| low[axis].min(index[axis])),
            std::array::from_fn(|axis| high[axis].max(index[axis])),
        ]
    })
}

impl SourceDocument for CiftiDocument {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        let fits = |field: &&Field| field.n_channels == self.n_columns;
        let Some(field) = shape.field(BRAIN_VALUES).filter(fits) else { return Ok(Update::DoesNotFit) };
        let n = field.values.len();
        if self.kind == ValueType::F32 {
            let value = |i: usize| field.values.get(i);
            check_range(Format::CIFTI, "values", n, context.progress, value)?;
        }
        context.out.write_all(&self.before)?;
        let mut bytes = Vec::with_capacity(BYTES_PER_STEP + 8);
        for k in 0..n {
            let value = field.values.get(k);
            if self.kind == ValueType::F32 {
                FieldValues::F32(vec![value as f32]).write_bytes(0, self.order, &mut bytes);
            } else {
                FieldValues::F64(vec![value]).write_bytes(0, self.order, &mut bytes);
            }
            if bytes.len() >= BYTES_PER_STEP {
                context.out.write_all(&bytes)?;
                bytes.clear();
                context.progress.step(k as u64, n as u64)?;
            }
        }
        context.out.write_all(&bytes)?;
        context.progress.step(n as u64, n as u64)?;
        context.out.write_all(&self.after)?;
        context.report.report_vertex_fields(shape, &[BRAIN_VALUES]);
        Ok(Update::Written)
    }
}

/// A new CIFTI is one that was read, with other values.
pub(super) fn write_new(_: &ShapeFile, context: &mut WriteContext<'_>) -> Result<(), WriteError> {
    let what = "other columns than those of the CIFTI that was read; use .npy".into();
    Err(WriteError::CannotHold { format: context.format, what })
}
