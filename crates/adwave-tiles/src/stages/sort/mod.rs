//! Sort: all records along one Hilbert curve, in sorted runs that fit into memory and are then merged.
//!
//! The faces of a mesh are distributed to the tiles afterwards ([`faces`]).

mod curve;
pub(crate) mod faces;
mod members;
mod merge;
mod runs;

use std::io::Write;
use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave_io::SelectionError;

use crate::error::TilesError;
use crate::files::write_atomic;
use crate::index::blocks::BlockTableBuilder;
use crate::layout::{LasQuantization, MemberRule, RecordLayout};
use crate::params::Params;
use crate::sources::input_shape::InputShape;
use crate::sources::record_marker::RecordMarker;
use crate::sources::{cloud, mesh};
use curve::{HilbertCurve, LasOrder, RecordOrder, VertexOrder};
use members::SortedRecords;
use merge::{bytes_per_read, merge_runs};
use runs::{RECORDS_AT_A_TIME, RunPoints, write_run};
pub(crate) use runs::{RUN_NAME, records_per_run};

/// Records between two progress reports of the merge.
const RECORDS_PER_REPORT: u64 = 1 << 20;

/// The sort of a shape by runs of at most `run_length` records, which has no effect on the result.
pub(crate) struct Sorter<'a> {
    pub(crate) shape: &'a InputShape,
    pub(crate) params: &'a Params,
    /// Folder of the runs.
    pub(crate) folder: &'a Path,
    pub(crate) run_length: usize,
    pub(crate) progress: Progress<'a>,
}

impl Sorter<'_> {
    /// Number of runs of a cloud. A mesh has none that can be sorted on their own, since its vertices are found only by
    /// reading all before them.
    pub(crate) fn n_runs(&self) -> usize {
        match self.shape.layout {
            RecordLayout::Las(_) => self.shape.n_points.div_ceil(self.run_length as u64) as usize,
            RecordLayout::Mesh(_) => 0,
        }
    }

    /// Writes all records in order to `records` and then the table of their blocks to `table`.
    pub(crate) fn sort(&self, records: &Path, table: &Path) -> Result<(), TilesError> {
        let curve = HilbertCurve::from_bounds(&self.shape.bounds);
        match self.shape.layout {
            RecordLayout::Las(quantization) => {
                // If all runs exist, nothing else opens the inputs.
                cloud::check_unchanged(&self.shape.files)?;
                let order = LasOrder { curve, record_bytes: self.shape.layout.record_bytes() };
                let runs = (0..self.n_runs()).map(|run| self.sort_cloud_run(order, quantization, run));
                self.merge(order, &runs.collect::<Result<Vec<_>, _>>()?, records, table)
            }
            RecordLayout::Mesh(_) => {
                let order = VertexOrder { curve };
                self.merge(order, &self.sort_mesh_runs(order)?, records, table)
            }
        }
    }

    /// Sorts one run of a cloud, unless its file exists.
    pub(crate) fn sort_run(&self, run: usize) -> Result<(), TilesError> {
        let RecordLayout::Las(quantization) = self.shape.layout else { return Ok(()) };
        let curve = HilbertCurve::from_bounds(&self.shape.bounds);
        let order = LasOrder { curve, record_bytes: self.shape.layout.record_bytes() };
        self.sort_cloud_run(order, quantization, run).map(|_| ())
    }

    /// Returns true if the file of a run of a cloud exists and is complete.
    pub(crate) fn has_run(&self, run: usize) -> bool {
        let RunPoints { first, n } = self.run_points(run);
        let n_bytes = (n * self.shape.layout.record_bytes()) as u64;
        RUN_NAME.path(self.folder, first).metadata().is_ok_and(|file| file.len() == n_bytes)
    }

    fn run_points(&self, run: usize) -> RunPoints {
        RunPoints::new(run, self.run_length, self.shape.n_points)
    }

    fn merge(
        &self,
        order: impl RecordOrder,
        runs: &[PathBuf],
        records: &Path,
        table: &Path,
    ) -> Result<(), TilesError> {
        let Self { shape, params, folder, progress, .. } = *self;
        let n_points = shape.n_points;
        let mut builder = BlockTableBuilder::new(shape.layout, MemberRule::default());
        let n_merged = write_atomic(records, |out| {
            merge_runs(runs, order, bytes_per_read(params.memory, runs.len()), |record, n| {
                if n % RECORDS_PER_REPORT == 0 {
                    progress.step(n_points + n, 2 * n_points)?;
                }
                builder.push(record);
                out.write_all(record).map_err(TilesError::io(records))
            })
        })?;
        if n_merged != n_points {
            return Err(TilesError::Input(format!(
                "the sorted runs in {} have {n_merged} points instead of {n_points}; check the disk and start again",
                folder.display()
            )));
        }
        let builder = SortedRecords { path: records, layout: shape.layout, progress }.final_table(builder)?;
        if builder.n_vertices == 0 {
            let selection = params.selection.to_selection()?.describe().join(" and ");
            return Err(SelectionError::NothingLeft { selection }.into());
        }
        builder.write(table)
    }

    fn sort_cloud_run(
        &self,
        order: LasOrder,
        quantization: LasQuantization,
        run: usize,
    ) -> Result<PathBuf, TilesError> {
        let Self { shape, folder, progress, .. } = *self;
        let RunPoints { first, n } = self.run_points(run);
        if self.has_run(run) {
            return Ok(RUN_NAME.path(folder, first));
        }
        let marker = RecordMarker::new(shape, self.params)?;
        let mut read = cloud::record_reader(&shape.files, quantization.record_bytes, first);
        let (mut records, mut n_read) = (Vec::with_capacity(n * order.record_bytes), 0);
        let mut points = Vec::new();
        while n_read < n {
            progress.step(first + n_read as u64, 2 * shape.n_points)?;
            points.clear();
            let more = read(RECORDS_AT_A_TIME.min(n - n_read), &mut points)?;
            if more == 0 {
                return Err(self.too_few_points(first + n_read as u64));
            }
            marker.push_points(quantization, &points, first + n_read as u64, &mut records);
            n_read += more;
        }
        write_run(&records, order, folder, first, progress)
    }

    fn sort_mesh_runs(&self, order: VertexOrder) -> Result<Vec<PathBuf>, TilesError> {
        let Self { shape, folder, run_length, progress, .. } = *self;
        let marker = RecordMarker::new(shape, self.params)?;
        let mut read = mesh::record_reader(&shape.files[0], marker)?;
        let record_bytes = order.record_bytes();
        let (mut runs, mut records, mut n_read) = (Vec::new(), Vec::new(), 0);
        loop {
            progress.step(n_read, 2 * shape.n_points)?;
            let n = read(RECORDS_AT_A_TIME.min(run_length - records.len() / record_bytes), &mut records)?;
            n_read += n as u64;
            if records.len() / record_bytes >= run_length || n == 0 && !records.is_empty() {
                let first = n_read - (records.len() / record_bytes) as u64;
                runs.push(write_run(&records, order, folder, first, progress)?);
                records.clear();
            }
            if n == 0 {
                break;
            }
        }
        if n_read != shape.n_points {
            return Err(self.too_few_points(n_read));
        }
        Ok(runs)
    }

    fn too_few_points(&self, n_read: u64) -> TilesError {
        TilesError::Input(format!(
            "the inputs have {n_read} points instead of {}, the number in their headers; get undamaged files",
            self.shape.n_points
        ))
    }
}
