//! Synthetic clouds of any size for tests, generated and written block by block in little memory.

mod scene;

use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use adwave_io::{LasLayout, LasWriter};
use rayon::prelude::*;

use crate::error::TilesError;
use scene::{FORMAT, OFFSET, RECORD_BYTES, SCALE, Scene};

/// Number of points that are generated before they are written, and by one thread at a time.
const POINTS_PER_BLOCK: usize = 1 << 17;
const POINTS_PER_THREAD: usize = 1 << 13;

/// A synthetic landscape as an airborne laser scanner sees it: hills, houses and trees, in strips whose densities
/// differ by up to a factor of ten.
///
/// Each point depends on its index, the number of points and the seed alone, by arithmetic that is the same on every
/// machine.
pub struct Terrain {
    scene: Scene,
    n_points: u64,
}

impl Terrain {
    /// A landscape of `n_points` points, about ten to a square meter.
    pub fn new(n_points: u64, seed: u64) -> Self {
        Self { scene: Scene::new(n_points, seed), n_points }
    }

    /// Writes the points `points`, in the order of the flight, as LAS or LAZ of point format 6. Reports progress in
    /// points of the whole landscape.
    ///
    /// # Errors
    /// [`TilesError`] if the file cannot be written, or the call is cancelled.
    ///
    /// # Panics
    /// If the range exceeds the number of points.
    pub fn write(&self, path: &Path, points: Range<u64>, progress: Progress<'_>) -> Result<(), TilesError> {
        assert!(points.end <= self.n_points, "the range of points exceeds the landscape");
        let layout = LasLayout {
            format: FORMAT,
            record_bytes: RECORD_BYTES,
            scale: SCALE,
            offset: OFFSET,
            n_points: points.end - points.start,
            bounds: None,
        };
        // No provenance is written, so that the same points are the same bytes.
        let mut writer = LasWriter::new(path, &layout, &[], None)?;
        let mut records = Vec::new();
        for first in points.clone().step_by(POINTS_PER_BLOCK) {
            progress.step(first, self.n_points)?;
            let n = (points.end - first).min(POINTS_PER_BLOCK as u64) as usize;
            records.resize(n * RECORD_BYTES, 0);
            let parts = records.par_chunks_mut(POINTS_PER_THREAD * RECORD_BYTES).enumerate();
            parts.for_each(|(k, part)| self.scene.fill(first + (k * POINTS_PER_THREAD) as u64, part));
            writer.write(&records)?;
        }
        Ok(writer.finish()?)
    }
}
