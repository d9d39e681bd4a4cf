//! Sort keys of records: the cell along a Hilbert curve, then the exact position.

use adwave::shape::{HILBERT_BITS, hilbert};

use crate::bounds::BoundingBox;
use crate::layout::{MeshUnits, quantized_xyz, vertex_coordinates};

/// Cell along the curve, then position, so that equal positions are consecutive and nothing else ties.
pub(crate) type CurveKey<P> = (u64, P);

/// Order of records along the curve.
pub(crate) trait RecordOrder: Copy + Sync {
    /// Exact position of a record, as integers.
    type Position: Copy + Ord + Send + Sync;
    fn record_bytes(self) -> usize;
    fn key(self, record: &[u8]) -> CurveKey<Self::Position>;
}

/// The Hilbert curve through the cells of a box.
#[derive(Clone, Copy)]
pub(crate) struct HilbertCurve {
    pub(crate) min: [f64; 3],
    /// Cells per unit of length.
    pub(crate) scale: f64,
}

/// Largest index of a cell along an axis.
const MAX_CELL: f64 = ((1_u32 << HILBERT_BITS) - 1) as f64;

impl HilbertCurve {
    pub(crate) fn from_bounds(bounds: &BoundingBox) -> Self {
        let extent = bounds.longest_side();
        Self { min: bounds.min, scale: if extent > 0.0 { MAX_CELL / extent } else { 0.0 } }
    }

    fn cell(&self, point: [f64; 3]) -> u64 {
        // Points outside the box, if a header is wrong, go to its boundary: the cast saturates at 0.
        let cell = |c: usize| ((point[c] - self.min[c]) * self.scale).min(MAX_CELL) as u32;
        hilbert([cell(0), cell(1), cell(2)])
    }
}

/// Order of LAS records, by their quantized coordinates.
#[derive(Clone, Copy)]
pub(crate) struct LasOrder {
    pub(crate) curve: HilbertCurve,
    pub(crate) record_bytes: usize,
}

impl RecordOrder for LasOrder {
    type Position = [i32; 3];

    fn record_bytes(self) -> usize {
        self.record_bytes
    }

    fn key(self, record: &[u8]) -> CurveKey<[i32; 3]> {
        let xyz = quantized_xyz(record);
        (self.curve.cell(xyz.map(f64::from)), xyz)
    }
}

/// Order of vertex records, by their coordinates.
#[derive(Clone, Copy)]
pub(crate) struct VertexOrder {
    pub(crate) curve: HilbertCurve,
}

impl RecordOrder for VertexOrder {
    type Position = [i64; 3];

    fn record_bytes(self) -> usize {
        MeshUnits::RECORD_BYTES
    }

    fn key(self, record: &[u8]) -> CurveKey<[i64; 3]> {
        let position = vertex_coordinates(record);
        // Integers in the order of the coordinates.
        let rank = |c: f64| {
            let bits = c.to_bits().cast_signed();
            bits ^ (((bits >> 63).cast_unsigned()) >> 1).cast_signed()
        };
        (self.curve.cell(position), position.map(rank))
    }
}
