//! A work from its inputs to its results, stage by stage, each where it was left.

use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use adwave::Progress;
use adwave::denoise::{DenoiseChoice, DenoiseInfo};
use adwave::features::Feature;
use adwave::pages::release_freed;
use serde::{Deserialize, Serialize};

use crate::bands::bands_of_tile;
use crate::blocks::Blocks;
use crate::box_tree::BoxTree;
use crate::denoise::{Surface, choose, denoised_tile};
use crate::files::{At, write_whole};
use crate::layout::Layout;
use crate::maps::{Lengths, StoredFeature, features_of_tile, map_of_tile};
use crate::names::{CHOICE, FACES, LEVELS, LOCK, SIDES, is_faces, is_part, is_run, is_temporary};
use crate::neighbors::neighbors_of_tile;
use crate::part::Neighborhoods;
use crate::sides::{Sides, sides_of_tile};
use crate::sort::{records_of_a_run, sort, sort_run};
use crate::totals::{BlockOutcome, LevelSummary, Totals};
use crate::work::{Job, Work, read_json, write_json};
use crate::{TilesError, VERTICES_IN_A_BLOCK, cloud, mesh};

/// What came out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Points of all inputs, or vertices of the mesh.
    pub n_points: u64,
    /// Different positions among them.
    pub n_vertices: u64,
    /// Faces of the mesh; a strip in a PLY is one.
    pub n_faces: u64,
    /// Tiles.
    pub n_tiles: usize,
    /// E, the mean distance to a neighbor or the mean length of edges, in model units.
    pub mean_length: f64,
    /// Root mean square of the distances moved, and the largest one, in model units.
    pub moved: [f64; 2],
    /// The bands that were computed, with what counts in the map.
    pub levels: Vec<LevelSummary>,
    /// What was assumed of the noise, where it was taken off.
    pub noise: Option<DenoiseInfo>,
}

impl Work {
    fn neighbors(
        &self,
        blocks: &Blocks,
        tree: &BoxTree,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let (range, path) = (self.plan.tile(tile, blocks.len()), self.near(tile));
        if !self.is_mesh() {
            return neighbors_of_tile(blocks, tree, range, self.plan.params.neighbors, &path, progress);
        }
        let n_bytes = self.bytes_of_faces()?.get(tile).copied().unwrap_or(0);
        mesh::neighbors_of_tile(blocks, range, (&self.faces(tile), n_bytes), &path, progress)
    }

    fn sort_run(&self, run: usize, progress: Progress<'_>) -> Result<(), TilesError> {
        let n = self.n_runs();
        if run >= n {
            return Err(TilesError::Input(match n {
                0 => "a mesh is sorted in one job; leave out its runs".into(),
                n => format!("there is no run {run}; runs are 0 to {}", n - 1),
            }));
        }
        sort_run(&self.plan, &self.folder, records_of_a_run(&self.plan), run, progress)
    }

    fn sort(&self, progress: Progress<'_>) -> Result<(), TilesError> {
        self.sort_in_runs(records_of_a_run(&self.plan), mesh::places_at_a_time(&self.plan), progress)
    }

    /// Once: of two processes the later one waits, and finds it done. Runs of at most `most` records, and the faces of a mesh by the places
    /// of at most `most_places` vertices at a time.
    pub(crate) fn sort_in_runs(
        &self,
        most: usize,
        most_places: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let path = self.folder.join(LOCK);
        let lock = File::create(&path).map_err(TilesError::io(&path))?;
        // Where the file system knows no locks nobody waits: runs that another process deletes are then an error, and no result.
        while matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) {
            progress.check()?;
            std::thread::sleep(PATIENCE);
        }
        if self.is_sorted() {
            return Ok(());
        }
        // What jobs that were killed left: nothing but runs is done in this folder before the sort.
        self.remove(|name| is_faces(name) || is_temporary(name))?;
        if !self.has_blocks() {
            sort(&self.plan, &self.folder, most, (&self.records(), &self.table()), progress)?;
            self.remove(is_run)?;
        }
        if self.is_mesh() {
            let blocks = self.read_blocks()?;
            let tiles = (0..self.plan.n_tiles(blocks.len())).map(|tile| self.faces(tile)).collect();
            mesh::deal(&self.plan, &blocks, (tiles, &self.folder.join(FACES)), most_places, progress)?;
        }
        Ok(())
    }

    fn sides_of_tile(
        &self,
        blocks: &Blocks,
        neighborhoods: &Neighborhoods,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        if !self.has_sides() {
            return Err(TilesError::Input(
                "no sides are asked for; they are where the noise of a cloud is taken off".into(),
            ));
        }
        let range = self.plan.tile(tile, blocks.len());
        sides_of_tile(blocks, neighborhoods, range, self.plan.limits()?, &self.sides(tile), progress)
    }

    /// What tiles are denoised by, where they are: what is not there yet is found by who comes first.
    fn denoiser(
        &self,
        blocks: &Blocks,
        progress: Progress<'_>,
    ) -> Result<Option<(DenoiseChoice, Surface)>, TilesError> {
        if self.plan.params.denoise.is_none() {
            return Ok(None);
        }
        let faces = if self.is_mesh() { Some(self.face_files()?) } else { None };
        let path = self.folder.join(CHOICE);
        if !path.exists() {
            write_json(&path, &choose(&self.plan, blocks, faces.as_ref(), progress)?)?;
            release_freed();
        }
        let surface = if let Some(faces) = faces {
            Surface::Mesh(faces)
        } else {
            let tiles: Vec<PathBuf> =
                (0..self.plan.n_tiles(blocks.len())).map(|tile| self.sides(tile)).collect();
            let per_tile = self.plan.blocks_per_tile * VERTICES_IN_A_BLOCK;
            let (path, n) = (self.folder.join(SIDES), blocks.n_vertices as usize);
            Surface::Cloud(Sides::open(&tiles, &path, n, per_tile, progress)?)
        };
        Ok(Some((read_json(&path)?, surface)))
    }

    fn bands(
        &self,
        blocks: &Blocks,
        neighborhoods: &Neighborhoods,
        denoiser: Option<&(DenoiseChoice, Surface)>,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let (whole, range) = ((&self.plan, blocks), self.plan.tile(tile, blocks.len()));
        let outcomes = if let Some((choice, surface)) = denoiser {
            let by = (choice, surface);
            self.write_tile(tile, |out| {
                denoised_tile(whole, neighborhoods, by, range, progress, |made| out(&made.records))
            })?
        } else if self.has_maps() {
            let paths = [self.made(tile), self.lengths(tile)];
            write_whole(&paths[0], |records| {
                write_whole(&paths[1], |lengths| {
                    bands_of_tile(whole, neighborhoods, range, progress, |made| {
                        records.write_all(&made.records).map_err(TilesError::io(&paths[0]))?;
                        lengths.write_all(&made.lengths).map_err(TilesError::io(&paths[1]))
                    })
                })
            })?
        } else {
            self.write_tile(tile, |out| {
                bands_of_tile(whole, neighborhoods, range, progress, |made| out(&made.records))
            })?
        };
        write_json(&self.outcome(tile), &outcomes)
    }

    /// Writes the points of a tile as they come out.
    fn write_tile<T>(
        &self,
        tile: usize,
        write: impl FnOnce(&mut dyn FnMut(&[u8]) -> Result<(), TilesError>) -> Result<T, TilesError>,
    ) -> Result<T, TilesError> {
        let path = self.tile(tile);
        if self.is_mesh() {
            return write_whole(&path, |out| {
                write(&mut |rows| out.write_all(rows).map_err(TilesError::io(&path)))
            });
        }
        let mut writer = cloud::writer(&self.plan, &path)?;
        let written = write(&mut |records| Ok(writer.write(records)?))?;
        writer.finish()?;
        Ok(written)
    }

    fn maps(
        &self,
        blocks: &Blocks,
        neighborhoods: &Neighborhoods,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        if !self.has_maps() {
            return Err(TilesError::Input(
                "no maps are asked for; the tiles are done with their bands".into(),
            ));
        }
        let n_tiles = self.plan.n_tiles(blocks.len());
        let levels = self.levels(blocks, neighborhoods)?;
        let paths = (0..n_tiles).map(|tile| self.lengths(tile)).collect();
        let vertices_per_tile = self.plan.blocks_per_tile * VERTICES_IN_A_BLOCK;
        let lengths = Lengths::new(paths, levels.len(), vertices_per_tile);
        let (whole, range) = ((&self.plan, blocks), self.plan.tile(tile, blocks.len()));
        let features = features_of_tile(whole, neighborhoods, range.clone(), &lengths, &levels, progress)?;
        let made = At::open(&self.made(tile))?;
        self.write_tile(tile, |out| map_of_tile(whole, range, (&made, &lengths), &levels, progress, out))?;
        write_json(&self.stored_features(tile), &features)
    }

    /// The numbers of whole levels, from those of all tiles by who comes first.
    fn levels(
        &self,
        blocks: &Blocks,
        neighborhoods: &Neighborhoods,
    ) -> Result<Vec<LevelSummary>, TilesError> {
        let path = self.folder.join(LEVELS);
        if !path.exists() {
            write_json(&path, &self.totals(blocks, neighborhoods)?.levels)?;
        }
        read_json(&path)
    }

    fn totals(&self, blocks: &Blocks, neighborhoods: &Neighborhoods) -> Result<Totals, TilesError> {
        let n_tiles = self.plan.n_tiles(blocks.len());
        let outcomes = (0..n_tiles).map(|tile| read_json::<Vec<BlockOutcome>>(&self.outcome(tile)));
        let outcomes: Vec<Vec<BlockOutcome>> = outcomes.collect::<Result<_, _>>()?;
        let (outcomes, unit) = (outcomes.into_iter().flatten(), self.plan.layout.unit());
        Totals::of(&self.plan.params, outcomes, blocks.n_vertices, neighborhoods.mean_length, unit)
    }

    fn summary(&self, blocks: &Blocks, neighborhoods: &Neighborhoods) -> Result<Summary, TilesError> {
        let Totals { moved, n_far, levels } = self.totals(blocks, neighborhoods)?;
        let noise = match self.plan.params.denoise {
            Some(_) => Some(self.noise(moved[1], n_far)?),
            None => None,
        };
        Ok(Summary {
            n_points: self.plan.n_points,
            n_vertices: blocks.n_vertices,
            n_faces: self.plan.n_faces,
            n_tiles: self.plan.n_tiles(blocks.len()),
            mean_length: neighborhoods.mean_length * self.plan.layout.unit(),
            moved,
            levels,
            noise,
        })
    }

    /// What was assumed of the noise and done, in model units.
    fn noise(&self, furthest: f64, n_far: u64) -> Result<DenoiseInfo, TilesError> {
        let DenoiseChoice { info, .. } = read_json(&self.folder.join(CHOICE))?;
        let noise = info.noise * self.plan.layout.unit();
        Ok(DenoiseInfo { noise, n_far: n_far as usize, furthest, ..info })
    }

    /// The features of all tiles, from fine to coarse, on each level the strongest first; `vertex` is of a mesh that of its file, of a
    /// cloud the point in the order of the curve, which is that of the joined tiles.
    ///
    /// # Errors
    /// When a tile is not done.
    pub fn features(&self) -> Result<Vec<Feature>, TilesError> {
        if self.plan.params.theta.is_none() {
            return Ok(Vec::new());
        }
        let blocks = self.blocks()?;
        let levels = self.levels(&blocks, &self.neighborhoods(&blocks)?)?;
        let n_tiles = self.plan.n_tiles(blocks.len());
        let mut all: Vec<StoredFeature> = Vec::new();
        for tile in 0..n_tiles {
            all.extend(read_json::<Vec<StoredFeature>>(&self.stored_features(tile))?);
        }
        all.sort_by(|a, b| {
            a.level.cmp(&b.level).then(b.response.total_cmp(&a.response)).then(a.place.cmp(&b.place))
        });
        let feature = |stored: StoredFeature| Feature {
            vertex: stored.vertex as usize,
            position: Some(stored.position),
            level: stored.level,
            sigma: levels.get(stored.level.wrapping_sub(1)).map_or(0.0, |level| level.sigma),
            response: stored.response,
            strength: stored.response,
            channel: None,
        };
        Ok(all.into_iter().map(feature).collect())
    }
}

/// Time between two tries to have the lock.
const PATIENCE: Duration = Duration::from_millis(100);

/// Does one job of a work, whatever else has been done, and whether or not it has been done before. A process of its own may do it: it
/// reads the folder and writes one file there.
///
/// # Errors
/// [`TilesError`], also when what the job needs has not been done yet.
pub fn run_job(work: &Work, job: Job, progress: Progress<'_>) -> Result<(), TilesError> {
    match job {
        Job::Run(run) => return work.sort_run(run, progress),
        Job::Sort => return work.sort(progress),
        Job::Neighbors(_) | Job::Sides(_) | Job::Bands(_) | Job::Maps(_) => {}
    }
    let blocks = work.blocks()?;
    let n_tiles = work.plan.n_tiles(blocks.len());
    let (Job::Neighbors(tile) | Job::Sides(tile) | Job::Bands(tile) | Job::Maps(tile)) = job else {
        return Ok(());
    };
    if tile >= n_tiles {
        return Err(TilesError::Input(format!(
            "there is no tile {tile}; tiles are 0 to {}",
            n_tiles.max(1) - 1
        )));
    }
    work.check_ready(job, n_tiles)?;
    match job {
        Job::Sides(_) => return work.sides_of_tile(&blocks, &work.neighborhoods(&blocks)?, tile, progress),
        Job::Bands(_) => {
            let (neighborhoods, denoiser) =
                (work.neighborhoods(&blocks)?, work.denoiser(&blocks, progress.quiet())?);
            return work.bands(&blocks, &neighborhoods, denoiser.as_ref(), tile, progress);
        }
        Job::Maps(_) => return work.maps(&blocks, &work.neighborhoods(&blocks)?, tile, progress),
        _ => {}
    }
    work.neighbors(&blocks, &BoxTree::new(blocks.boxes.clone()), tile, progress)
}

/// Does all that is not done yet. Reports vertices, of as many times what there are as there are stages.
///
/// # Errors
/// [`TilesError`]; what was done stays, and the next call goes on there.
pub fn run(work: &Work, progress: Progress<'_>) -> Result<Summary, TilesError> {
    let n = work.plan.n_points;
    let all = n * (3 + u64::from(work.has_maps()) + u64::from(work.has_sides()));
    let sorting = |done: u64, total: u64| {
        // Who is asked to stop is asked by the call itself.
        let _ = progress.step(done * n / total.max(1), all);
    };
    if !work.is_sorted() {
        work.sort(progress.quiet().with_report(&sorting))?;
    }
    let blocks = work.blocks()?;
    let n_tiles = work.plan.n_tiles(blocks.len());
    let done = AtomicU64::new(n);
    let finished = |tile: usize| {
        let range = work.plan.tile(tile, blocks.len());
        let more = (range.len() * VERTICES_IN_A_BLOCK) as u64;
        progress.step((done.fetch_add(more, Ordering::Relaxed) + more).min(all), all)
    };
    let tree = BoxTree::new(blocks.boxes.clone());
    each(work, n_tiles, |tile| {
        if !work.is_done(Job::Neighbors(tile)) {
            work.neighbors(&blocks, &tree, tile, progress.quiet())?;
        }
        Ok(finished(tile)?)
    })?;
    drop(tree);
    release_freed();
    let neighborhoods = work.neighborhoods(&blocks)?;
    if work.has_sides() {
        each(work, n_tiles, |tile| {
            if !work.is_done(Job::Sides(tile)) {
                work.sides_of_tile(&blocks, &neighborhoods, tile, progress.quiet())?;
            }
            Ok(finished(tile)?)
        })?;
    }
    let denoiser = work.denoiser(&blocks, progress.quiet())?;
    each(work, n_tiles, |tile| {
        if !work.is_done(Job::Bands(tile)) {
            work.bands(&blocks, &neighborhoods, denoiser.as_ref(), tile, progress.quiet())?;
        }
        Ok(finished(tile)?)
    })?;
    if work.has_maps() {
        each(work, n_tiles, |tile| {
            if !work.is_done(Job::Maps(tile)) {
                work.maps(&blocks, &neighborhoods, tile, progress.quiet())?;
            }
            Ok(finished(tile)?)
        })?;
    }
    work.summary(&blocks, &neighborhoods)
}

/// `job(tile)` for all tiles, by as many workers as were asked for; the first error ends the others after their tile.
fn each(
    work: &Work,
    n_tiles: usize,
    job: impl Fn(usize) -> Result<(), TilesError> + Sync,
) -> Result<(), TilesError> {
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(None));
    let worker = || loop {
        let tile = next.fetch_add(1, Ordering::Relaxed);
        if tile >= n_tiles {
            return;
        }
        if let Err(error) = job(tile) {
            next.store(n_tiles, Ordering::Relaxed);
            failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner).get_or_insert(error);
            return;
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..work.plan.params.n_workers.min(n_tiles) {
            scope.spawn(worker);
        }
        worker();
    });
    failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).map_or(Ok(()), Err)
}

/// All tiles as one file: a cloud in the order of the curve, a mesh in its own order and format.
///
/// # Errors
/// [`TilesError`] when a tile is not there, or the file cannot be written.
pub fn join(work: &Work, path: &Path, progress: Progress<'_>) -> Result<(), TilesError> {
    let tiles: Vec<PathBuf> = (0..work.n_tiles()?).map(|tile| work.tile(tile)).collect();
    // What the tiles took: joining takes half of the memory.
    release_freed();
    match work.plan.layout {
        Layout::Las(_) => cloud::join(&work.plan, &tiles, path, progress),
        Layout::Mesh(_) => {
            work.remove(is_part)?;
            let memory = work.plan.params.memory as usize / 2;
            mesh::join(&work.plan, &tiles, (&work.folder, memory), path, progress)
        }
    }
}
