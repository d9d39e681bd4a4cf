//! Made clouds of any size, to try the rest on: written as they are made, in the memory of some blocks.

mod scene;

use std::ops::Range;
use std::path::Path;

use adwave::Progress;
use adwave_io::{LasLayout, LasWriter};
use rayon::prelude::*;

use crate::TilesError;
use scene::{FORMAT, OFFSET, RECORD, SCALE, Scene};

/// Points that are made in one go, and by one thread.
const BLOCK: usize = 1 << 17;
const PART: usize = 1 << 13;

/// A landscape as a laser scanner sees it from the air: hills, houses and trees, in strips whose density differs by up to ten times.
///
/// Each point follows from its number, the number of points and the seed, by arithmetic that is the same on every machine.
pub struct Terrain {
    scene: Scene,
    n_points: u64,
}

impl Terrain {
    /// A landscape of `n_points` points, about ten to a square meter.
    pub fn new(n_points: u64, seed: u64) -> Self {
        Self { scene: Scene::new(n_points, seed), n_points }
    }

    /// Writes some of its points, in the order of the flight, as LAS or LAZ of point format 6. Reports points of all.
    ///
    /// # Errors
    /// [`TilesError`] when the file cannot be written, or when cancelled.
    ///
    /// # Panics
    /// Where it has fewer points.
    pub fn write(&self, path: &Path, points: Range<u64>, progress: Progress<'_>) -> Result<(), TilesError> {
        assert!(points.end <= self.n_points, "as many points as the landscape has");
        let layout = LasLayout {
            format: FORMAT,
            record_bytes: RECORD,
            scale: SCALE,
            offset: OFFSET,
            n_points: points.end - points.start,
            bounds: None,
        };
        // The same points are the same bytes: nothing says by which words they were asked for.
        let mut writer = LasWriter::new(path, &layout, &[], None)?;
        let mut records = Vec::new();
        for first in points.clone().step_by(BLOCK) {
            progress.step(first, self.n_points)?;
            records.resize((points.end - first).min(BLOCK as u64) as usize * RECORD, 0);
            let parts = records.par_chunks_mut(PART * RECORD).enumerate();
            parts.for_each(|(k, part)| self.scene.fill(first + (k * PART) as u64, part));
            writer.write(&records)?;
        }
        Ok(writer.finish()?)
    }
}
