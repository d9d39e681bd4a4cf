//! Validated selection of a part of a cloud.

use crate::ReadError;
use crate::formats::las::part::CloudPart;
use crate::formats::las::part::octree::MOST_DEPTH;
use crate::formats::las::read::{Header, u32_at};

/// Valid part of a cloud.
pub(crate) struct Selection {
    low: [f64; 3],
    high: [f64; 3],
    is_bounded: bool,
    resolution: Option<f64>,
}

impl Selection {
    /// Selects the whole cloud.
    pub(crate) fn whole() -> Self {
        let (low, high) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
        Self { low, high, is_bounded: false, resolution: None }
    }

    pub(super) fn of(part: &CloudPart) -> Result<Self, ReadError> {
        let mut this = Self::whole();
        if let Some(resolution) = part.resolution {
            if !(resolution > 0.0 && resolution.is_finite()) {
                let message = format!("the resolution must be a length above 0, got {resolution:?}");
                return Err(ReadError::Whole(message));
            }
            this.resolution = Some(resolution);
        }
        if let Some((low, high)) = part.bounds {
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                // NaN has no order.
                if !matches!(low[axis].partial_cmp(&high[axis]), Some(order) if order.is_le()) {
                    return Err(ReadError::Whole(format!(
                        "the box must have ascending bounds along {name}, got {:?} to {:?}",
                        low[axis], high[axis]
                    )));
                }
            }
            this = Self { low, high, is_bounded: true, ..this };
        }
        Ok(this)
    }

    pub(super) fn resolution(&self) -> Option<f64> {
        self.resolution
    }

    /// Finest level needed, given the spacing of level 0.
    pub(super) fn depth(&self, mut spacing: f64) -> u32 {
        let Some(resolution) = self.resolution else { return MOST_DEPTH };
        let mut depth = 0;
        while spacing > resolution && depth < MOST_DEPTH {
            spacing /= 2.0;
            depth += 1;
        }
        depth
    }

    /// True if the box intersects another one, enlarged by `slack`.
    pub(super) fn meets(&self, low: [f64; 3], high: [f64; 3], slack: [f64; 3]) -> bool {
        (0..3).all(|a| self.low[a] <= high[a] + slack[a] && low[a] - slack[a] <= self.high[a])
    }

    /// Keeps the complete records in the box.
    pub(super) fn retain(&self, rows: &mut Vec<u8>, header: &Header) {
        if !self.is_bounded {
            return;
        }
        let (size, mut end) = (header.record_bytes, 0);
        for at in (0..rows.len()).step_by(size) {
            if self.contains(position(&rows[at..], header)) {
                rows.copy_within(at..at + size, end);
                end += size;
            }
        }
        rows.truncate(end);
    }

    fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|a| self.low[a] <= point[a] && point[a] <= self.high[a])
    }

    /// Error of a selection without points, in a cloud with these bounds.
    pub(super) fn empty(&self, bounds: Option<([f64; 3], [f64; 3])>) -> ReadError {
        let within = bounds.map_or(String::new(), |(low, high)| {
            format!("; its points lie from {} to {}", triple(low), triple(high))
        });
        ReadError::Whole(if self.is_bounded {
            let (low, high) = (triple(self.low), triple(self.high));
            format!("the box from {low} to {high} contains no points{within}; choose another box")
        } else {
            format!("the cloud has no points{within}; use a cloud with points")
        })
    }
}

/// Coordinates of a record, in model units.
pub(super) fn position(row: &[u8], header: &Header) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let steps = u32_at(row, 4 * axis).map_or(0, u32::cast_signed);
        f64::from(steps) * header.scale[axis] + header.offset[axis]
    })
}

/// Formats three coordinates for a message.
fn triple([x, y, z]: [f64; 3]) -> String {
    format!("({x:?}, {y:?}, {z:?})")
}
