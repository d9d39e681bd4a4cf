//! A work from its inputs to its results, stage by stage, each where it was left.

use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use adwave::Progress;
use adwave::features::Feature;
use adwave::pages::release_freed;
use serde::{Deserialize, Serialize};

use crate::bands::bands_of_tile;
use crate::blocks::Blocks;
use crate::box_tree::BoxTree;
use crate::files::{At, write_whole};
use crate::layout::Layout;
use crate::maps::{Lengths, StoredFeature, features_of_tile, map_of_tile};
use crate::mesh::{self, is_mesh};
use crate::names::{
    FACES, LEVELS, LOCK, PLAN, RECORDS, TABLE, is_faces, is_own, is_part, is_run, is_temporary, is_tile,
    names,
};
use crate::near_file::NearFile;
use crate::neighbours::neighbours_of_tile;
use crate::part::{Kind, Neighbourhoods};
use crate::plan::{Forecast, Params, Plan};
use crate::sort::{has_run, n_runs, records_of_a_run, sort, sort_run};
use crate::totals::{BlockOutcome, LevelSummary, Totals};
use crate::{TilesError, VERTICES_IN_A_BLOCK, cloud};

/// One tile of one stage: what a process does on its own, in any order within the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Job {
    /// Some points of a cloud, as the inputs have them, in the order of the curve; the sort does those that are missing.
    Run(usize),
    /// All points in the order of the curve, and the faces of a mesh to its tiles; there is one of these.
    Sort,
    /// The neighbourhoods of a tile, after the sort.
    Neighbours(usize),
    /// The bands of a tile, after all neighbourhoods.
    Bands(usize),
    /// The saliency map and the features of a tile, after all bands, where there are to be any.
    Maps(usize),
}

/// A folder with a plan and what has been done of it.
#[derive(Debug)]
pub struct Work {
    folder: PathBuf,
    pub(crate) plan: Plan,
}

/// What is done of a work, and what there is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// Runs that a cloud is sorted in, and those that are done; 0 for a mesh.
    pub n_runs: usize,
    /// Of these.
    pub runs_done: usize,
    /// Tiles, known once all is sorted.
    pub n_tiles: Option<usize>,
    /// Tiles whose neighbours are found.
    pub neighbours_done: usize,
    /// Tiles whose bands are computed.
    pub bands_done: usize,
    /// Whether there are maps to be made once all bands are.
    pub has_maps: bool,
    /// Tiles whose maps are made.
    pub maps_done: usize,
}

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
    /// E, the mean distance to a neighbour or the mean length of edges, in model units.
    pub mean_length: f64,
    /// Root mean square of the distances moved, and the largest one, in model units.
    pub moved: [f64; 2],
    /// The bands that were computed, with what counts in the map.
    pub levels: Vec<LevelSummary>,
}

/// The most vertices that numbers of 32 bits name.
pub(crate) const MOST_POINTS: u64 = u32::MAX as u64 - 1;

/// What the work of some inputs will take.
///
/// # Errors
/// [`TilesError`] when an input cannot be read, the inputs do not fit together, or the memory does not suffice.
pub fn forecast(inputs: &[PathBuf], params: &Params) -> Result<Forecast, TilesError> {
    Ok(planned(inputs, params)?.1)
}

fn planned(inputs: &[PathBuf], params: &Params) -> Result<(Plan, Forecast), TilesError> {
    params.check()?;
    let inputs = &files_of(inputs)?;
    let plan = if inputs.iter().any(|path| is_mesh(path)) {
        Some(mesh::planned(inputs, params)?)
    } else {
        cloud::planned(inputs, params)?
    };
    let Some(mut plan) = plan else {
        return Err(TilesError::Input("no input; give one or several LAS or LAZ files, or a mesh".into()));
    };
    if plan.n_points == 0 {
        return Err(TilesError::Input("the inputs have no points; give others".into()));
    }
    if plan.n_points > MOST_POINTS {
        return Err(TilesError::Input(format!(
            "{} points, and places along the curve are numbers of 32 bits: at most {MOST_POINTS}; split the work",
            plan.n_points
        )));
    }
    let (blocks_per_tile, forecast) = plan.cut()?;
    plan.blocks_per_tile = blocks_per_tile;
    Ok((plan, forecast))
}

/// The files that inputs stand for: of a folder the LAS and LAZ in it, by name; of an EPT (its folder, or the `ept.json` in it) its data.
fn files_of(inputs: &[PathBuf]) -> Result<Vec<PathBuf>, TilesError> {
    const EPT: &str = "ept.json";
    let mut files = Vec::new();
    for input in inputs {
        let of_ept = |folder: &Path| folder.join("ept-data");
        let folder = match input.parent() {
            Some(parent) if input.file_name().is_some_and(|name| name == EPT) => of_ept(parent),
            _ if input.join(EPT).exists() => of_ept(input),
            _ if input.is_dir() => input.clone(),
            _ => {
                files.push(input.clone());
                continue;
            }
        };
        let refused = |what: &str| Err(TilesError::Input(format!("{}: {what}", folder.display())));
        if folder.join(PLAN).exists() {
            let Status { n_tiles, bands_done, has_maps, maps_done, .. } = Work::open(&folder)?.status()?;
            if n_tiles != Some(if has_maps { maps_done } else { bands_done }) {
                return refused("its tiles are not all done; finish that work first");
            }
        }
        let mut names = names(&folder)?;
        names.retain(|name| {
            let ending = Path::new(name).extension().unwrap_or_default();
            ending.eq_ignore_ascii_case("las") || ending.eq_ignore_ascii_case("laz")
        });
        if names.is_empty() {
            return refused("no .las or .laz is in that folder; name the files");
        }
        names.sort();
        files.extend(names.iter().map(|name| folder.join(name)));
    }
    Ok(files)
}

impl Work {
    /// Begins a work in `folder`, or goes on with the one that is there, if it is the same.
    ///
    /// # Errors
    /// As [`forecast`], and when the folder holds another work or cannot be written.
    pub fn begin(folder: &Path, inputs: &[PathBuf], params: &Params) -> Result<(Self, Forecast), TilesError> {
        let (mut plan, forecast) = planned(inputs, params)?;
        std::fs::create_dir_all(folder).map_err(TilesError::io(folder))?;
        let path = folder.join(PLAN);
        if path.exists() {
            let there = Self::open(folder)?.plan;
            let same = |plan: &Plan| (plan.inputs.clone(), plan.params.decides());
            if same(&there) != same(&plan) {
                return Err(TilesError::Input(format!(
                    "{} holds another work (other files or parameters); delete it or name another folder",
                    folder.display()
                )));
            }
            if params.n_tiles.is_none() || params.n_tiles == there.params.n_tiles {
                plan.blocks_per_tile = there.blocks_per_tile;
            } else if plan.blocks_per_tile != there.blocks_per_tile {
                return Err(TilesError::Input(format!(
                    "{} holds this work in tiles of another size; leave --tiles out, or delete the folder",
                    folder.display()
                )));
            }
            return Ok((Self { folder: folder.to_owned(), plan }, forecast));
        }
        // Neighbourhoods of other points would pass for those of these, and tiles, which may be inputs, would be replaced.
        if let Some(name) = names(folder)?.iter().find(|name| is_own(name)) {
            return Err(TilesError::Input(format!(
                "{} is of an earlier work; move or delete such files, or name another folder",
                folder.join(name).display()
            )));
        }
        let json =
            serde_json::to_vec_pretty(&plan).map_err(std::io::Error::from).map_err(TilesError::io(&path))?;
        write_whole(&path, |out| out.write_all(&json).map_err(TilesError::io(&path)))?;
        Ok((Self { folder: folder.to_owned(), plan }, forecast))
    }

    /// The work of a folder.
    ///
    /// # Errors
    /// When there is no plan, or none that can be read.
    pub fn open(folder: &Path) -> Result<Self, TilesError> {
        let path = folder.join(PLAN);
        if !path.exists() {
            return Err(TilesError::Input(format!(
                "{} is not there; make a plan first (adwave tiles … --plan-only)",
                path.display()
            )));
        }
        let json = std::fs::read(&path).map_err(TilesError::io(&path))?;
        let plan: Plan =
            serde_json::from_slice(&json).map_err(|e| TilesError::broken(&path, e.to_string()))?;
        plan.params.check()?;
        let is_whole = plan.blocks_per_tile > 0
            && plan.layout.record_bytes() >= plan.layout.position_bytes()
            && plan.n_points <= MOST_POINTS
            && !plan.inputs.is_empty();
        if !is_whole {
            return Err(TilesError::broken(&path, "its numbers make no sense"));
        }
        Ok(Self { folder: folder.to_owned(), plan })
    }

    fn records(&self) -> PathBuf {
        self.folder.join(RECORDS)
    }

    fn table(&self) -> PathBuf {
        self.folder.join(TABLE)
    }

    fn near(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("near-{tile:05}.bin"))
    }

    /// The points of a tile, as they come out; of a mesh what becomes of its vertices, to be joined.
    pub fn tile(&self, tile: usize) -> PathBuf {
        let ending = match self.plan.layout {
            Layout::Las(_) => "laz",
            Layout::Mesh(_) => "bin",
        };
        self.folder.join(format!("tile-{tile:05}.{ending}"))
    }

    /// The faces of a tile.
    fn faces(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("faces-{tile:05}.bin"))
    }

    /// Whether the work is on a mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self.plan.layout, Layout::Mesh(_))
    }

    /// Whether the last stage is that of maps.
    pub fn has_maps(&self) -> bool {
        self.plan.params.has_maps()
    }

    /// The records of a tile before its map.
    fn made(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("made-{tile:05}.bin"))
    }

    /// The lengths of all bands at the vertices of a tile.
    fn lengths(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("lengths-{tile:05}.bin"))
    }

    fn stored_features(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("features-{tile:05}.json"))
    }

    fn outcome(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("tile-{tile:05}.json"))
    }

    /// Whether all points are sorted, and the faces of a mesh dealt out; tiles can be counted then.
    pub fn is_sorted(&self) -> bool {
        self.has_blocks() && (!self.is_mesh() || self.folder.join(FACES).exists())
    }

    fn has_blocks(&self) -> bool {
        self.table().exists() && self.records().exists()
    }

    pub(crate) fn blocks(&self) -> Result<Blocks, TilesError> {
        if !self.is_sorted() {
            return Err(TilesError::Input(format!(
                "{}: its points are not sorted yet; do that first (adwave tile FOLDER sort)",
                self.folder.display()
            )));
        }
        self.read_blocks()
    }

    fn read_blocks(&self) -> Result<Blocks, TilesError> {
        Blocks::open(&self.table(), &self.records(), self.plan.layout)
    }

    /// How many tiles there are, once all points are sorted.
    ///
    /// # Errors
    /// When the sorted points are not there.
    pub fn n_tiles(&self) -> Result<usize, TilesError> {
        Ok(self.plan.n_tiles(self.blocks()?.len()))
    }

    pub(crate) fn neighbourhoods(&self, blocks: &Blocks) -> Result<Neighbourhoods, TilesError> {
        let n_tiles = self.plan.n_tiles(blocks.len());
        let open = |tile| NearFile::open(&self.near(tile), &self.plan.tile(tile, blocks.len()));
        let files = (0..n_tiles).map(open).collect::<Result<Vec<_>, _>>()?;
        let kind = match self.plan.layout {
            Layout::Las(_) => {
                Kind::Nearest(self.plan.params.neighbours.min((blocks.n_vertices as usize).saturating_sub(1)))
            }
            Layout::Mesh(_) => Kind::Faces,
        };
        Ok(Neighbourhoods::new(files, blocks, self.plan.blocks_per_tile, kind))
    }

    /// The lengths of the files of faces, once all are written.
    fn bytes_of_faces(&self) -> Result<Vec<u64>, TilesError> {
        read_json(&self.folder.join(FACES))
    }

    fn neighbours(
        &self,
        blocks: &Blocks,
        tree: &BoxTree,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let (range, path) = (self.plan.tile(tile, blocks.len()), self.near(tile));
        if !self.is_mesh() {
            return neighbours_of_tile(blocks, tree, range, self.plan.params.neighbours, &path, progress);
        }
        let n_bytes = self.bytes_of_faces()?.get(tile).copied().unwrap_or(0);
        mesh::neighbours_of_tile(blocks, range, (&self.faces(tile), n_bytes), &path, progress)
    }

    /// Whether a job is done: its file is there.
    pub fn is_done(&self, job: Job) -> bool {
        match job {
            Job::Run(run) => {
                self.is_sorted() || has_run(&self.plan, &self.folder, records_of_a_run(&self.plan), run)
            }
            Job::Sort => self.is_sorted(),
            Job::Neighbours(tile) => self.near(tile).exists(),
            Job::Bands(tile) if self.has_maps() => {
                [self.outcome(tile), self.made(tile), self.lengths(tile)].iter().all(|path| path.exists())
            }
            Job::Bands(tile) => self.outcome(tile).exists() && self.tile(tile).exists(),
            Job::Maps(tile) => self.tile(tile).exists() && self.stored_features(tile).exists(),
        }
    }

    /// How many runs a cloud is sorted in, which can be jobs of their own; 0 for a mesh.
    pub fn n_runs(&self) -> usize {
        n_runs(&self.plan, records_of_a_run(&self.plan))
    }

    /// What is done.
    ///
    /// # Errors
    /// When the sorted points cannot be read.
    pub fn status(&self) -> Result<Status, TilesError> {
        let (n_runs, n_tiles) = (self.n_runs(), if self.is_sorted() { Some(self.n_tiles()?) } else { None });
        let done = |n: usize, job: fn(usize) -> Job| (0..n).filter(|&i| self.is_done(job(i))).count();
        let of_tiles = |job| done(n_tiles.unwrap_or(0), job);
        Ok(Status {
            n_runs,
            runs_done: done(n_runs, Job::Run),
            n_tiles,
            neighbours_done: of_tiles(Job::Neighbours),
            bands_done: of_tiles(Job::Bands),
            has_maps: self.has_maps(),
            maps_done: if self.has_maps() { of_tiles(Job::Maps) } else { 0 },
        })
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

    /// Removes files of the folder.
    fn remove(&self, is_meant: impl Fn(&str) -> bool) -> Result<(), TilesError> {
        for name in names(&self.folder)?.iter().filter(|name| is_meant(name)) {
            let path = self.folder.join(name);
            match std::fs::remove_file(&path) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(TilesError::io(&path)(e)),
                _ => {}
            }
        }
        Ok(())
    }

    fn bands(
        &self,
        blocks: &Blocks,
        neighbourhoods: &Neighbourhoods,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let (plan, range) = (&self.plan, self.plan.tile(tile, blocks.len()));
        let outcomes = if self.has_maps() {
            let paths = [self.made(tile), self.lengths(tile)];
            write_whole(&paths[0], |records| {
                write_whole(&paths[1], |lengths| {
                    bands_of_tile(plan, blocks, neighbourhoods, range, progress, |made| {
                        records.write_all(&made.records).map_err(TilesError::io(&paths[0]))?;
                        lengths.write_all(&made.lengths).map_err(TilesError::io(&paths[1]))
                    })
                })
            })?
        } else {
            self.write_tile(tile, |out| {
                bands_of_tile(plan, blocks, neighbourhoods, range, progress, |made| out(&made.records))
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
        neighbourhoods: &Neighbourhoods,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        if !self.has_maps() {
            return Err(TilesError::Input(
                "no maps are asked for; the tiles are done with their bands".into(),
            ));
        }
        let n_tiles = self.plan.n_tiles(blocks.len());
        let levels = self.levels(blocks, neighbourhoods)?;
        let paths = (0..n_tiles).map(|tile| self.lengths(tile)).collect();
        let vertices_per_tile = self.plan.blocks_per_tile * VERTICES_IN_A_BLOCK;
        let lengths = Lengths::new(paths, levels.len(), vertices_per_tile);
        let (whole, range) = ((&self.plan, blocks), self.plan.tile(tile, blocks.len()));
        let features = features_of_tile(whole, neighbourhoods, range.clone(), &lengths, &levels, progress)?;
        let made = At::open(&self.made(tile))?;
        self.write_tile(tile, |out| map_of_tile(whole, range, (&made, &lengths), &levels, progress, out))?;
        write_json(&self.stored_features(tile), &features)
    }

    /// The numbers of whole levels, from those of all tiles by who comes first.
    fn levels(
        &self,
        blocks: &Blocks,
        neighbourhoods: &Neighbourhoods,
    ) -> Result<Vec<LevelSummary>, TilesError> {
        let path = self.folder.join(LEVELS);
        if !path.exists() {
            write_json(&path, &self.totals(blocks, neighbourhoods)?.levels)?;
        }
        read_json(&path)
    }

    fn totals(&self, blocks: &Blocks, neighbourhoods: &Neighbourhoods) -> Result<Totals, TilesError> {
        let n_tiles = self.plan.n_tiles(blocks.len());
        let outcomes = (0..n_tiles).map(|tile| read_json::<Vec<BlockOutcome>>(&self.outcome(tile)));
        let outcomes: Vec<Vec<BlockOutcome>> = outcomes.collect::<Result<_, _>>()?;
        let (outcomes, unit) = (outcomes.into_iter().flatten(), self.plan.layout.unit());
        Totals::of(&self.plan.params, outcomes, blocks.n_vertices, neighbourhoods.mean_length, unit)
    }

    fn summary(&self, blocks: &Blocks, neighbourhoods: &Neighbourhoods) -> Result<Summary, TilesError> {
        let Totals { moved, levels } = self.totals(blocks, neighbourhoods)?;
        Ok(Summary {
            n_points: self.plan.n_points,
            n_vertices: blocks.n_vertices,
            n_faces: self.plan.n_faces,
            n_tiles: self.plan.n_tiles(blocks.len()),
            mean_length: neighbourhoods.mean_length * self.plan.layout.unit(),
            moved,
            levels,
        })
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
        let levels = self.levels(&blocks, &self.neighbourhoods(&blocks)?)?;
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

    /// Deletes what only the work itself needed, and what jobs that were killed left half written; the tiles stay.
    ///
    /// # Errors
    /// When a file cannot be deleted.
    pub fn clean(&self) -> Result<(), TilesError> {
        // First what says that the rest can be relied on, last what says that there is a work.
        self.remove(|name| name == TABLE || name == FACES)?;
        self.remove(|name| is_own(name) && name != PLAN && !is_tile(name) || is_temporary(name))?;
        self.remove(|name| name == PLAN)
    }

    /// Deletes the tiles, after they were joined.
    ///
    /// # Errors
    /// When a file cannot be deleted.
    pub fn remove_tiles(&self) -> Result<(), TilesError> {
        self.remove(is_tile)
    }
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<(), TilesError> {
    let json = serde_json::to_vec(value).map_err(std::io::Error::from).map_err(TilesError::io(path))?;
    write_whole(path, |out| out.write_all(&json).map_err(TilesError::io(path)))
}

fn read_json<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, TilesError> {
    let json = std::fs::read(path).map_err(TilesError::io(path))?;
    serde_json::from_slice(&json).map_err(|e| TilesError::broken(path, e.to_string()))
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
        Job::Neighbours(_) | Job::Bands(_) | Job::Maps(_) => {}
    }
    let blocks = work.blocks()?;
    let n_tiles = work.plan.n_tiles(blocks.len());
    let (Job::Neighbours(tile) | Job::Bands(tile) | Job::Maps(tile)) = job else { return Ok(()) };
    if tile >= n_tiles {
        return Err(TilesError::Input(format!(
            "there is no tile {tile}; tiles are 0 to {}",
            n_tiles.max(1) - 1
        )));
    }
    match job {
        Job::Bands(_) => return work.bands(&blocks, &work.neighbourhoods(&blocks)?, tile, progress),
        Job::Maps(_) => return work.maps(&blocks, &work.neighbourhoods(&blocks)?, tile, progress),
        _ => {}
    }
    work.neighbours(&blocks, &BoxTree::new(blocks.boxes.clone()), tile, progress)
}

/// Does all that is not done yet. Reports vertices, of as many times what there are as there are stages.
///
/// # Errors
/// [`TilesError`]; what was done stays, and the next call goes on there.
pub fn run(work: &Work, progress: Progress<'_>) -> Result<Summary, TilesError> {
    let n = work.plan.n_points;
    let all = n * if work.has_maps() { 4 } else { 3 };
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
        if !work.is_done(Job::Neighbours(tile)) {
            work.neighbours(&blocks, &tree, tile, progress.quiet())?;
        }
        Ok(finished(tile)?)
    })?;
    drop(tree);
    release_freed();
    let neighbourhoods = work.neighbourhoods(&blocks)?;
    each(work, n_tiles, |tile| {
        if !work.is_done(Job::Bands(tile)) {
            work.bands(&blocks, &neighbourhoods, tile, progress.quiet())?;
        }
        Ok(finished(tile)?)
    })?;
    if work.has_maps() {
        each(work, n_tiles, |tile| {
            if !work.is_done(Job::Maps(tile)) {
                work.maps(&blocks, &neighbourhoods, tile, progress.quiet())?;
            }
            Ok(finished(tile)?)
        })?;
    }
    work.summary(&blocks, &neighbourhoods)
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
