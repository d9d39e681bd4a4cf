//! The folder of a work: its plan, its files, and what of it is done.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::blocks::Blocks;
use crate::files::write_whole;
use crate::layout::Layout;
use crate::mesh::{self, FaceFiles, is_mesh};
use crate::names::{FACES, PLAN, RECORDS, TABLE, is_own, is_temporary, is_tile, names};
use crate::near_file::NearFile;
use crate::part::{Kind, Neighborhoods};
use crate::plan::{Forecast, Params, Plan};
use crate::sort::{has_run, n_runs, records_of_a_run};
use crate::{TilesError, cloud};

/// One tile of one stage: what a process does on its own, in any order within the stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Job {
    /// Some points of a cloud, as the inputs have them, in the order of the curve; the sort does those that are missing.
    Run(usize),
    /// All points in the order of the curve, and the faces of a mesh to its tiles; there is one of these.
    Sort,
    /// The neighborhoods of a tile, after the sort.
    Neighbors(usize),
    /// Which normals of a tile are on one side, after all neighborhoods, where a cloud is denoised.
    Sides(usize),
    /// The bands of a tile or its positions without noise, after all neighborhoods and sides.
    Bands(usize),
    /// The saliency map and the features of a tile, after all bands, where there are to be any.
    Maps(usize),
}

/// A folder with a plan and what has been done of it.
#[derive(Debug)]
pub struct Work {
    pub(crate) folder: PathBuf,
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
    /// Tiles whose neighbors are found.
    pub neighbors_done: usize,
    /// Whether sides are to be found once all neighbors are.
    pub has_sides: bool,
    /// Tiles whose sides are found.
    pub sides_done: usize,
    /// Tiles whose bands are computed, or whose noise is taken off.
    pub bands_done: usize,
    /// Whether there are maps to be made once all bands are.
    pub has_maps: bool,
    /// Tiles whose maps are made.
    pub maps_done: usize,
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
        // Neighborhoods of other points would pass for those of these, and tiles, which may be inputs, would be replaced.
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

    pub(crate) fn records(&self) -> PathBuf {
        self.folder.join(RECORDS)
    }

    pub(crate) fn table(&self) -> PathBuf {
        self.folder.join(TABLE)
    }

    pub(crate) fn near(&self, tile: usize) -> PathBuf {
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
    pub(crate) fn faces(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("faces-{tile:05}.bin"))
    }

    /// Whether the work is on a mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self.plan.layout, Layout::Mesh(_))
    }

    /// Whether there is a stage of sides.
    pub fn has_sides(&self) -> bool {
        self.plan.params.denoise.is_some() && !self.is_mesh()
    }

    /// Which normals of a tile are on one side.
    pub(crate) fn sides(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("sides-{tile:05}.bin"))
    }

    /// Whether the last stage is that of maps.
    pub fn has_maps(&self) -> bool {
        self.plan.params.has_maps()
    }

    /// The records of a tile before its map.
    pub(crate) fn made(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("made-{tile:05}.bin"))
    }

    /// The lengths of all bands at the vertices of a tile.
    pub(crate) fn lengths(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("lengths-{tile:05}.bin"))
    }

    pub(crate) fn stored_features(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("features-{tile:05}.json"))
    }

    pub(crate) fn outcome(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("tile-{tile:05}.json"))
    }

    /// Whether all points are sorted, and the faces of a mesh dealt out; tiles can be counted then.
    pub fn is_sorted(&self) -> bool {
        self.has_blocks() && (!self.is_mesh() || self.folder.join(FACES).exists())
    }

    pub(crate) fn has_blocks(&self) -> bool {
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

    pub(crate) fn read_blocks(&self) -> Result<Blocks, TilesError> {
        Blocks::open(&self.table(), &self.records(), self.plan.layout)
    }

    /// How many tiles there are, once all points are sorted.
    ///
    /// # Errors
    /// When the sorted points are not there.
    pub fn n_tiles(&self) -> Result<usize, TilesError> {
        Ok(self.plan.n_tiles(self.blocks()?.len()))
    }

    pub(crate) fn neighborhoods(&self, blocks: &Blocks) -> Result<Neighborhoods, TilesError> {
        let n_tiles = self.plan.n_tiles(blocks.len());
        let open = |tile| NearFile::open(&self.near(tile), &self.plan.tile(tile, blocks.len()));
        let files = (0..n_tiles).map(open).collect::<Result<Vec<_>, _>>()?;
        let kind = match self.plan.layout {
            Layout::Las(_) => {
                Kind::Nearest(self.plan.params.neighbors.min((blocks.n_vertices as usize).saturating_sub(1)))
            }
            Layout::Mesh(_) => Kind::Faces,
        };
        Ok(Neighborhoods::new(files, blocks, self.plan.blocks_per_tile, kind))
    }

    /// The lengths of the files of faces, once all are written.
    pub(crate) fn bytes_of_faces(&self) -> Result<Vec<u64>, TilesError> {
        read_json(&self.folder.join(FACES))
    }

    /// The files of all tiles' faces.
    pub(crate) fn face_files(&self) -> Result<FaceFiles, TilesError> {
        let lengths = self.bytes_of_faces()?.into_iter().enumerate();
        let files = lengths.map(|(tile, n_bytes)| (self.faces(tile), n_bytes)).collect();
        Ok(FaceFiles { files, blocks_per_tile: self.plan.blocks_per_tile })
    }

    /// Whether a job is done: its file is there.
    pub fn is_done(&self, job: Job) -> bool {
        match job {
            Job::Run(run) => {
                self.is_sorted() || has_run(&self.plan, &self.folder, records_of_a_run(&self.plan), run)
            }
            Job::Sort => self.is_sorted(),
            Job::Neighbors(tile) => self.near(tile).exists(),
            Job::Sides(tile) => self.sides(tile).exists(),
            Job::Bands(tile) if self.has_maps() => {
                [self.outcome(tile), self.made(tile), self.lengths(tile)].iter().all(|path| path.exists())
            }
            Job::Bands(tile) => self.outcome(tile).exists() && self.tile(tile).exists(),
            Job::Maps(tile) => self.tile(tile).exists() && self.stored_features(tile).exists(),
        }
    }

    /// Refuses a job whose tiles want what has not been done of all tiles.
    pub(crate) fn check_ready(&self, job: Job, n_tiles: usize) -> Result<(), TilesError> {
        type OfTile = fn(usize) -> Job;
        let (before, named): (OfTile, _) = match job {
            Job::Bands(_) if self.has_sides() => (Job::Sides, "sides"),
            Job::Sides(_) | Job::Bands(_) => (Job::Neighbors, "neighbors"),
            Job::Maps(_) => (Job::Bands, "bands"),
            Job::Run(_) | Job::Sort | Job::Neighbors(_) => return Ok(()),
        };
        match (0..n_tiles).find(|&tile| !self.is_done(before(tile))) {
            Some(tile) => Err(TilesError::Input(format!(
                "{}: the {named} of tile {tile} are not there yet; do that first (adwave tile FOLDER {named} {tile})",
                self.folder.display()
            ))),
            None => Ok(()),
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
            neighbors_done: of_tiles(Job::Neighbors),
            has_sides: self.has_sides(),
            sides_done: if self.has_sides() { of_tiles(Job::Sides) } else { 0 },
            bands_done: of_tiles(Job::Bands),
            has_maps: self.has_maps(),
            maps_done: if self.has_maps() { of_tiles(Job::Maps) } else { 0 },
        })
    }

    /// Removes files of the folder.
    pub(crate) fn remove(&self, is_meant: impl Fn(&str) -> bool) -> Result<(), TilesError> {
        for name in names(&self.folder)?.iter().filter(|name| is_meant(name)) {
            let path = self.folder.join(name);
            match std::fs::remove_file(&path) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(TilesError::io(&path)(e)),
                _ => {}
            }
        }
        Ok(())
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

pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), TilesError> {
    let json = serde_json::to_vec(value).map_err(std::io::Error::from).map_err(TilesError::io(path))?;
    write_whole(path, |out| out.write_all(&json).map_err(TilesError::io(path)))
}

pub(crate) fn read_json<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, TilesError> {
    let json = std::fs::read(path).map_err(TilesError::io(path))?;
    serde_json::from_slice(&json).map_err(|e| TilesError::broken(path, e.to_string()))
}
