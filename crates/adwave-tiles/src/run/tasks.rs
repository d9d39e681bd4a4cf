//! The tasks of a job: each reads files of the work folder, runs a stage and writes its file.

use std::fs::{File, TryLockError};
use std::io::Write;
use std::time::Duration;

use adwave::Progress;
use adwave::pages::release_freed;

use crate::error::TilesError;
use crate::files::{RandomAccessFile, read_json, write_atomic, write_json};
use crate::index::blocks::{Blocks, VERTICES_IN_A_BLOCK};
use crate::index::bounds_tree::BoundsTree;
use crate::index::neighbor_index::NeighborIndex;
use crate::index::vertex_rows::VertexRows;
use crate::job::tiling_job::TilingJob;
use crate::params::Movement;
use crate::sources::cloud::create_writer;
use crate::stages::bands::compute_bands;
use crate::stages::denoise::{Denoiser, TileSurface, choose_weights, denoise_tile};
use crate::stages::features::find_features;
use crate::stages::maps::{BandNorms, BandResults, write_saliency};
use crate::stages::motion::{Motion, SURFACE_ROW_BYTES, fit_heights};
use crate::stages::neighbors::by_faces::{OneRingPaths, RingRule, write_one_rings};
use crate::stages::neighbors::nearest::write_nearest_neighbors;
use crate::stages::open_parts::OpenParts;
use crate::stages::sort::faces::{FaceDistributor, vertices_per_pass};

/// Time between two attempts to take the lock.
const LOCK_INTERVAL: Duration = Duration::from_millis(100);

/// Computation of the bands stage for a tile.
pub(crate) enum TileRule {
    /// Bands, and positions that the gains move.
    Bands(Motion),
    /// Positions without noise.
    Denoise(Box<Denoiser>),
}

impl TilingJob {
    pub(crate) fn sort_run(&self, run: usize, progress: Progress<'_>) -> Result<(), TilesError> {
        let n_runs = self.n_runs();
        if run >= n_runs {
            return Err(TilesError::Input(match n_runs {
                0 => "a mesh has no runs; its sort is one task".into(),
                n => format!("the index of a run must be in 0..={}, got {run}", n - 1),
            }));
        }
        self.sorter(self.default_run_length(), progress).sort_run(run)
    }

    pub(crate) fn sort(&self, progress: Progress<'_>) -> Result<(), TilesError> {
        let memory = self.plan.params.memory;
        self.sort_in_runs(self.default_run_length(), vertices_per_pass(memory), progress)
    }

    /// Sorts by runs of at most `run_length` records, and distributes the faces of a mesh in passes of
    /// `vertices_per_pass` vertices. Of two processes, the second one waits and finds the sort done.
    pub(crate) fn sort_in_runs(
        &self,
        run_length: usize,
        vertices_per_pass: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let folder = &self.folder;
        let path = folder.sort_lock();
        let lock = File::create(&path).map_err(TilesError::io(&path))?;
        // If the file system has no locks, nobody waits: runs that another process deletes then cause an error, not a
        // wrong result.
        while matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) {
            progress.check()?;
            std::thread::sleep(LOCK_INTERVAL);
        }
        if self.is_sorted() {
            return Ok(());
        }
        folder.remove_before_sort()?;
        if !self.has_blocks() {
            self.sorter(run_length, progress).sort(&folder.records(), &folder.block_table())?;
            folder.remove_runs()?;
        }
        if self.is_mesh() {
            let blocks = self.open_blocks()?;
            let n_tiles = self.plan.n_tiles(blocks.len());
            let distributor = FaceDistributor {
                shape: &self.plan.shape,
                blocks: &blocks,
                blocks_per_tile: self.plan.blocks_per_tile,
                memory: self.plan.params.memory,
                folder: &folder.path,
                vertices_per_pass,
                progress,
            };
            let lengths =
                distributor.distribute_faces((0..n_tiles).map(|tile| folder.faces(tile)).collect())?;
            write_json(&folder.face_file_lengths(), &lengths)?;
        }
        Ok(())
    }

    /// Finds the neighbors of a tile; `tree` holds the boxes of all blocks.
    pub(crate) fn find_neighbors(
        &self,
        blocks: &Blocks,
        tree: &BoundsTree,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let (interior, path) = (self.plan.blocks_of_tile(tile, blocks.len()), self.folder.neighbors(tile));
        if !self.is_mesh() {
            return write_nearest_neighbors(
                blocks,
                tree,
                interior,
                self.plan.params.neighbors,
                &path,
                progress,
            );
        }
        let faces = self.face_files()?;
        let Some(file) = faces.files.get(tile) else {
            return Err(TilesError::broken(&self.folder.face_file_lengths(), "it has too few tiles"));
        };
        let ring_rule =
            if self.plan.params.denoise.is_some() { RingRule::Triangles } else { RingRule::Sides };
        let surface = self.plan.params.needs_mesh_normals().then(|| self.folder.surface(tile));
        let paths = OneRingPaths { neighbors: &path, surface: surface.as_deref() };
        write_one_rings(blocks, interior, file, ring_rule, paths, progress)
    }

    /// The denoiser of the job; `None` for a job that computes bands. The first task that needs its files computes and
    /// stores them.
    pub(crate) fn denoiser(
        &self,
        blocks: &Blocks,
        progress: Progress<'_>,
    ) -> Result<Option<Denoiser>, TilesError> {
        if self.plan.params.denoise.is_none() {
            return Ok(None);
        }
        let faces = if self.is_mesh() { Some(self.face_files()?) } else { None };
        let path = self.folder.denoise_choice();
        if !path.exists() {
            let unit = self.plan.shape.layout.unit();
            write_json(&path, &choose_weights(&self.plan.params, blocks, faces.as_ref(), unit, progress)?)?;
            release_freed();
        }
        let surface = if let Some(faces) = faces { TileSurface::Mesh(faces) } else { TileSurface::Cloud };
        Ok(Some(Denoiser { choice: read_json(&path)?, surface }))
    }

    /// The rule by which vertices move. The first task that needs its files computes and stores them.
    pub(crate) fn motion(
        &self,
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
        progress: Progress<'_>,
    ) -> Result<Motion, TilesError> {
        let params = &self.plan.params;
        let movement = params.movement(self.is_mesh());
        let mut motion = Motion { movement, mesh_rows: None, open_parts: None, height_fit: None };
        if params.denoise.is_some() || !params.changes_positions() {
            return Ok(motion);
        }
        if let Movement::Heights(axis) = movement {
            let path = self.folder.height_fit();
            if !path.exists() {
                write_json(&path, &fit_heights(&self.context(blocks, neighbor_index)?, axis, progress)?)?;
                release_freed();
            }
            motion.height_fit = Some(read_json(&path)?);
        }
        if self.is_mesh() && params.needs_mesh_normals() {
            let n_tiles = self.plan.n_tiles(blocks.len());
            let paths = (0..n_tiles).map(|tile| self.folder.surface(tile)).collect();
            let rows = VertexRows::new(paths, SURFACE_ROW_BYTES, self.vertices_per_tile());
            if movement == Movement::OpenParts {
                let path = self.folder.open_parts();
                if !path.exists() {
                    write_json(&path, &OpenParts::find(blocks, neighbor_index, &rows, progress)?)?;
                }
                motion.open_parts = Some(read_json(&path)?);
            }
            motion.mesh_rows = Some(rows);
        }
        Ok(motion)
    }

    fn vertices_per_tile(&self) -> usize {
        self.plan.blocks_per_tile * VERTICES_IN_A_BLOCK
    }

    /// The computation of the bands stage, with all that it depends on beyond a tile. The first task that needs its
    /// files computes and stores them.
    pub(crate) fn tile_rule(
        &self,
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
        progress: Progress<'_>,
    ) -> Result<TileRule, TilesError> {
        Ok(match self.denoiser(blocks, progress)? {
            Some(denoiser) => TileRule::Denoise(Box::new(denoiser)),
            None => TileRule::Bands(self.motion(blocks, neighbor_index, progress)?),
        })
    }

    /// Computes the bands of a tile, or denoises its positions.
    pub(crate) fn compute_bands(
        &self,
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
        rule: &TileRule,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        let context = self.context(blocks, neighbor_index)?;
        let interior = self.plan.blocks_of_tile(tile, blocks.len());
        let motion = match rule {
            TileRule::Denoise(denoiser) => {
                let sums = self.write_tile(tile, |write| {
                    denoise_tile(&context, denoiser, interior, progress, |output| write(&output.rows))
                })?;
                return write_json(&self.folder.block_sums(tile), &sums);
            }
            TileRule::Bands(motion) => motion,
        };
        let sums = if self.has_maps() {
            let (rows_path, norms_path) = (self.folder.rows_before_maps(tile), self.folder.band_norms(tile));
            write_atomic(&rows_path, |rows| {
                write_atomic(&norms_path, |norms| {
                    compute_bands(&context, motion, interior, progress, |output| {
                        rows.write_all(&output.rows).map_err(TilesError::io(&rows_path))?;
                        norms.write_all(&output.band_norms).map_err(TilesError::io(&norms_path))
                    })
                })
            })?
        } else {
            self.write_tile(tile, |write| {
                compute_bands(&context, motion, interior, progress, |output| write(&output.rows))
            })?
        };
        write_json(&self.folder.block_sums(tile), &sums)
    }

    /// Writes the result of a tile: `fill` passes its output rows to the function that it is given.
    fn write_tile<T>(
        &self,
        tile: usize,
        fill: impl FnOnce(&mut dyn FnMut(&[u8]) -> Result<(), TilesError>) -> Result<T, TilesError>,
    ) -> Result<T, TilesError> {
        let path = self.tile(tile);
        if self.is_mesh() {
            return write_atomic(&path, |out| {
                fill(&mut |rows| out.write_all(rows).map_err(TilesError::io(&path)))
            });
        }
        let mut writer = create_writer(&self.plan.shape, &self.plan.params, &path)?;
        let result = fill(&mut |records| Ok(writer.write(records)?))?;
        writer.finish()?;
        Ok(result)
    }

    pub(crate) fn compute_maps(
        &self,
        blocks: &Blocks,
        neighbor_index: &NeighborIndex,
        tile: usize,
        progress: Progress<'_>,
    ) -> Result<(), TilesError> {
        if !self.has_maps() {
            return Err(TilesError::Input(
                "the job has no maps stage; only saliency and features have one".into(),
            ));
        }
        let context = self.context(blocks, neighbor_index)?;
        let n_tiles = self.plan.n_tiles(blocks.len());
        let levels = self.levels(blocks, neighbor_index)?;
        let norm_files = (0..n_tiles).map(|tile| self.folder.band_norms(tile)).collect();
        let norms = BandNorms::new(norm_files, levels.len(), self.vertices_per_tile());
        let bands = BandResults { norms: &norms, levels: &levels };
        let interior = self.plan.blocks_of_tile(tile, blocks.len());
        let features = find_features(&context, interior.clone(), bands, progress)?;
        let rows = RandomAccessFile::open(&self.folder.rows_before_maps(tile))?;
        self.write_tile(tile, |write| write_saliency(&context, interior, &rows, bands, progress, write))?;
        write_json(&self.folder.features(tile), &features)
    }
}
