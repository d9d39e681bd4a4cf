//! Boundary of volumes: faces that belong to a single cell.

use adwave::{Cancelled, Progress};
use rayon::prelude::*;

use crate::progress::{at_row, collect};

/// Faces of volume cells, each with the index of its cell.
#[derive(Default)]
pub(crate) struct VolumeFaces {
    corners: Vec<u32>,
    ends: Vec<usize>,
    cells: Vec<u32>,
}

impl VolumeFaces {
    /// Adds a face. Collapsed cells repeat a corner: their face matches the neighbor's only without the repetition,
    /// and a face collapsed to an edge is dropped.
    pub(crate) fn push(&mut self, corners: impl Iterator<Item = u32>, cell: u32) {
        let start = self.corners.len();
        for corner in corners {
            if !self.corners[start..].contains(&corner) {
                self.corners.push(corner);
            }
        }
        if self.corners.len() < start + 3 {
            self.corners.truncate(start);
            return;
        }
        self.ends.push(self.corners.len());
        self.cells.push(cell);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    fn get(&self, f: usize) -> &[u32] {
        let start = if f == 0 { 0 } else { self.ends[f - 1] };
        &self.corners[start..self.ends[f]]
    }

    /// The four smallest corners in ascending order, which identify a face.
    fn key(&self, f: usize) -> [u32; 4] {
        let mut key = [u32::MAX; 4];
        for &corner in self.get(f) {
            let mut corner = corner;
            for place in &mut key {
                if corner < *place {
                    std::mem::swap(place, &mut corner);
                }
            }
        }
        key
    }

    /// Faces that occur once, in order, with their cells.
    pub(crate) fn boundary(
        &self,
        progress: Progress<'_>,
        mut take: impl FnMut(&[u32], u32),
    ) -> Result<(), Cancelled> {
        let n = self.cells.len();
        let mut keys = collect(n, progress, |f| (self.key(f), f))?;
        keys.par_sort_unstable();
        progress.check()?;
        let mut is_outside = vec![false; n];
        for group in keys.chunk_by(|a, b| a.0 == b.0) {
            is_outside[group[0].1] = group.len() == 1;
        }
        drop(keys);
        for (f, _) in is_outside.iter().enumerate().filter(|(_, is_outside)| **is_outside) {
            at_row(progress, f as u64, n as u64)?;
            take(self.get(f), self.cells[f]);
        }
        Ok(())
    }
}
