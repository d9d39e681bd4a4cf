//! Layout of the records that are sorted: where the position of a record is and how it is encoded.

use adwave::shape::{KnownRange, OriginRule};
use serde::{Deserialize, Serialize};

use crate::bounds::BoundingBox;
use crate::bytes::u32_at;

/// Largest number of points of a job: vertices are indexed by 32-bit numbers.
pub(crate) const MAX_POINTS: u64 = u32::MAX as u64 - 1;

/// Mark of a record that conditions or a mask leave out.
pub(crate) const UNSELECTED: u8 = 1;

/// Mark of a point that is flagged as withheld or classified as noise.
pub(crate) const FLAGGED: u8 = 2;

/// Mark of a record whose position may be a placeholder.
pub(crate) const SUSPECT: u8 = 4;

/// Rule by which records take part. The others keep their values and are nobody's neighbors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MemberRule {
    /// True if flagged points take part, since there are no others.
    pub(crate) includes_flagged: bool,
    /// Range of the coordinates outside of which suspects are placeholders; `None` if there are none.
    pub(crate) known: Option<KnownRange>,
}

impl MemberRule {
    pub(crate) fn takes_part(&self, layout: &RecordLayout, record: &[u8]) -> bool {
        let marks = layout.marks(record);
        marks == 0 || (self.is_chosen(marks) && !self.is_placeholder(layout, record))
    }

    fn is_chosen(&self, marks: u8) -> bool {
        marks & UNSELECTED == 0 && (marks & FLAGGED == 0 || self.includes_flagged)
    }

    /// Value of the fields of a record that takes no part: NaN if it was not chosen, 0 for a placeholder, as for a
    /// vertex without neighbors.
    pub(crate) fn outsider_value(&self, layout: &RecordLayout, record: &[u8]) -> f32 {
        if self.is_chosen(layout.marks(record)) { 0.0 } else { f32::NAN }
    }

    pub(crate) fn is_placeholder(&self, layout: &RecordLayout, record: &[u8]) -> bool {
        let origin = match layout {
            RecordLayout::Las(_) => OriginRule::Placeholder,
            RecordLayout::Mesh(_) => OriginRule::Ordinary,
        };
        layout.marks(record) & SUSPECT != 0
            && self.known.is_some_and(|known| known.is_placeholder(&layout.model_position(record), origin))
    }
}

/// Layout of all records of a job. A record begins with its position; two records have the same position exactly if
/// these bytes are equal. Its last byte has the marks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum RecordLayout {
    /// Points of a cloud, as LAS point records.
    Las(LasQuantization),
    /// Vertices of a mesh.
    Mesh(MeshUnits),
}

impl RecordLayout {
    pub(crate) fn record_bytes(&self) -> usize {
        match self {
            Self::Las(quantization) => quantization.record_bytes + 1,
            Self::Mesh(_) => MeshUnits::RECORD_BYTES,
        }
    }

    /// Bytes of the position at the start of a record.
    pub(crate) fn position_bytes(&self) -> usize {
        match self {
            Self::Las(_) => LasQuantization::POSITION_BYTES,
            Self::Mesh(_) => MeshUnits::POSITION_BYTES,
        }
    }

    /// Position of a record, in multiples of [`unit`](Self::unit).
    pub(crate) fn position(&self, record: &[u8]) -> [f64; 3] {
        match self {
            Self::Las(quantization) => quantization.to_position(quantized_xyz(record)),
            Self::Mesh(units) => vertex_coordinates(record).map(|c| c / units.unit),
        }
    }

    /// Position of a record, in model units.
    pub(crate) fn model_position(&self, record: &[u8]) -> [f64; 3] {
        match self {
            Self::Las(quantization) => quantization.to_position(quantized_xyz(record)),
            Self::Mesh(_) => vertex_coordinates(record),
        }
    }

    /// Marks of a record.
    pub(crate) fn marks(&self, record: &[u8]) -> u8 {
        record.get(self.record_bytes() - 1).copied().unwrap_or(0)
    }

    /// Unit of positions and lengths during the computation, in model units: a power of two.
    pub(crate) fn unit(&self) -> f64 {
        match self {
            Self::Las(_) => 1.0,
            Self::Mesh(units) => units.unit,
        }
    }
}

/// LAS point records, whose first 12 bytes are the coordinates as 32-bit multiples of `scale` from `offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LasQuantization {
    pub(crate) format: u8,
    /// Bytes of a record in the file, without the marks.
    pub(crate) record_bytes: usize,
    pub(crate) scale: [f64; 3],
    pub(crate) offset: [f64; 3],
}

/// Coordinates of a LAS record, in multiples of the scale.
pub(crate) fn quantized_xyz(record: &[u8]) -> [i32; 3] {
    let at = |c: usize| <[u8; 4]>::try_from(&record[4 * c..][..4]).map_or(0, i32::from_le_bytes);
    [at(0), at(1), at(2)]
}

pub(crate) fn set_quantized_xyz(record: &mut [u8], xyz: [i32; 3]) {
    for (bytes, c) in record.chunks_exact_mut(4).zip(xyz) {
        bytes.copy_from_slice(&c.to_le_bytes());
    }
}

impl LasQuantization {
    pub(crate) const POSITION_BYTES: usize = 12;

    /// Position in model units.
    pub(crate) fn to_position(self, xyz: [i32; 3]) -> [f64; 3] {
        std::array::from_fn(|c| f64::from(xyz[c]) * self.scale[c] + self.offset[c])
    }

    /// Nearest multiples of the scale; `None` if they do not fit into 32 bits.
    pub(crate) fn quantize(&self, position: [f64; 3]) -> Option<[i32; 3]> {
        let mut xyz = [0; 3];
        for c in 0..3 {
            let steps = ((position[c] - self.offset[c]) / self.scale[c]).round();
            if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&steps) {
                return None;
            }
            xyz[c] = steps as i32;
        }
        Some(xyz)
    }
}

/// Vertex records of a mesh: three 64-bit coordinates in model units, the index of the vertex in its file, and the
/// marks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeshUnits {
    /// Unit of lengths during the computation, in model units: a power of two near the size of the mesh, so that
    /// squares neither overflow nor underflow. It is 1 for a mesh of moderate size.
    pub(crate) unit: f64,
}

/// Meshes of a size between 2⁻³² and 2³² model units are computed in model units.
const MODERATE_EXPONENT: f64 = 32.0;

impl MeshUnits {
    pub(crate) const POSITION_BYTES: usize = 24;
    pub(crate) const RECORD_BYTES: usize = Self::POSITION_BYTES + 4 + 1;

    /// The unit for a mesh with this bounding box.
    pub(crate) fn from_bounds(bounds: &BoundingBox) -> Self {
        let exponent = bounds.longest_side().log2().floor().clamp(-1000.0, 1000.0);
        let is_moderate = exponent.abs() <= MODERATE_EXPONENT || bounds.min == bounds.max;
        Self { unit: if is_moderate { 1.0 } else { exponent.exp2() } }
    }
}

/// Coordinates of a vertex record, in model units.
pub(crate) fn vertex_coordinates(record: &[u8]) -> [f64; 3] {
    let at = |c: usize| <[u8; 8]>::try_from(&record[8 * c..][..8]).map_or(0.0, f64::from_le_bytes);
    [at(0), at(1), at(2)]
}

/// Index of the vertex of a record in its file.
pub(crate) fn index_in_file(record: &[u8]) -> u32 {
    u32_at(record, MeshUnits::POSITION_BYTES)
}

/// Appends a vertex record without marks.
pub(crate) fn push_vertex_record(records: &mut Vec<u8>, position: [f64; 3], index_in_file: u32) {
    // Equal coordinates must have equal bytes: adding 0 turns −0 into 0.
    records.extend(position.iter().flat_map(|c| (c + 0.0).to_le_bytes()));
    records.extend(index_in_file.to_le_bytes());
    records.push(0);
}
