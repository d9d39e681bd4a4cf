//! How a record says where its point is.

use serde::{Deserialize, Serialize};

/// The layout of all records of a work. What a record begins with says where its point is: points are at one position where these
/// bytes are the same.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Layout {
    /// Points of a cloud.
    Las(Steps),
    /// Vertices of a mesh.
    Mesh(Lengths),
}

impl Layout {
    pub(crate) fn record_bytes(&self) -> usize {
        match self {
            Self::Las(steps) => steps.record_bytes,
            Self::Mesh(_) => Lengths::RECORD_BYTES,
        }
    }

    /// Bytes that say where the point is.
    pub(crate) fn position_bytes(&self) -> usize {
        match self {
            Self::Las(_) => Steps::POSITION_BYTES,
            Self::Mesh(_) => Lengths::POSITION_BYTES,
        }
    }

    /// The position that a record begins with, in units of [`unit`](Self::unit).
    pub(crate) fn position(&self, record: &[u8]) -> [f64; 3] {
        match self {
            Self::Las(steps) => steps.position(whole(record)),
            Self::Mesh(lengths) => coordinates(record).map(|c| c / lengths.unit),
        }
    }

    /// How many model units the unit of positions is: a power of two.
    pub(crate) fn unit(&self) -> f64 {
        match self {
            Self::Las(_) => 1.0,
            Self::Mesh(lengths) => lengths.unit,
        }
    }
}

/// Records of LAS, whose first twelve bytes are the coordinates as whole numbers of a scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Steps {
    pub(crate) format: u8,
    pub(crate) record_bytes: usize,
    pub(crate) scale: [f64; 3],
    pub(crate) offset: [f64; 3],
}

/// The coordinates of a record in steps of the scale.
pub(crate) fn whole(record: &[u8]) -> [i32; 3] {
    let at = |c: usize| <[u8; 4]>::try_from(&record[4 * c..][..4]).map_or(0, i32::from_le_bytes);
    [at(0), at(1), at(2)]
}

pub(crate) fn set_whole(record: &mut [u8], whole: [i32; 3]) {
    for (bytes, c) in record.chunks_exact_mut(4).zip(whole) {
        bytes.copy_from_slice(&c.to_le_bytes());
    }
}

impl Steps {
    pub(crate) const POSITION_BYTES: usize = 12;

    /// A position in model units.
    pub(crate) fn position(&self, whole: [i32; 3]) -> [f64; 3] {
        std::array::from_fn(|c| f64::from(whole[c]) * self.scale[c] + self.offset[c])
    }

    /// The nearest steps of the scale, where there are such.
    pub(crate) fn nearest(&self, position: [f64; 3]) -> Option<[i32; 3]> {
        let mut whole = [0; 3];
        for c in 0..3 {
            let steps = ((position[c] - self.offset[c]) / self.scale[c]).round();
            if !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&steps) {
                return None;
            }
            whole[c] = steps as i32;
        }
        Some(whole)
    }
}

/// Records of vertices: the coordinates in model units, as doubles, and the number of the vertex in its file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lengths {
    /// What lengths are measured in, so that their squares neither overflow nor vanish: a power of two, and 1 for a mesh of moderate size.
    pub(crate) unit: f64,
}

/// Meshes of a size between 2⁻³² and 2³² model units are computed on as they are.
const MODERATE_EXPONENT: f64 = 32.0;

impl Lengths {
    pub(crate) const POSITION_BYTES: usize = 24;
    pub(crate) const RECORD_BYTES: usize = Self::POSITION_BYTES + 4;

    /// Those of a mesh in a box.
    pub(crate) fn of((lo, hi): ([f64; 3], [f64; 3])) -> Self {
        let exponent =
            (0..3).map(|c| hi[c] - lo[c]).fold(0.0, f64::max).log2().floor().clamp(-1000.0, 1000.0);
        let is_moderate = exponent.abs() <= MODERATE_EXPONENT || lo == hi;
        Self { unit: if is_moderate { 1.0 } else { exponent.exp2() } }
    }
}

/// The coordinates of the record of a vertex, in model units.
pub(crate) fn coordinates(record: &[u8]) -> [f64; 3] {
    let at = |c: usize| <[u8; 8]>::try_from(&record[8 * c..][..8]).map_or(0.0, f64::from_le_bytes);
    [at(0), at(1), at(2)]
}

/// The number of the vertex of a record in its file.
pub(crate) fn vertex_number(record: &[u8]) -> u32 {
    u32_at(record, Lengths::POSITION_BYTES)
}

/// The number of 32 bits at a place.
pub(crate) fn u32_at(bytes: &[u8], at: usize) -> u32 {
    <[u8; 4]>::try_from(&bytes[at..][..4]).map_or(0, u32::from_le_bytes)
}

/// Appends the record of a vertex.
pub(crate) fn push_vertex(records: &mut Vec<u8>, position: [f64; 3], number: u32) {
    // Equal coordinates have equal bytes: −0 becomes 0.
    records.extend(position.iter().flat_map(|c| (c + 0.0).to_le_bytes()));
    records.extend(number.to_le_bytes());
}
