//! Cells of an AnnData: counts, genes and walk that `adwave impute` reads from an `.h5ad` file, and the copy with the
//! result.

use super::ImputeArgs;
use crate::error::CliError;
use crate::global::Global;
use crate::output::progress::{with_progress, with_spinner};
use crate::output::{note, write_file_with};
use crate::resolve::walk::{
    ResolvedWalk, WalkContent, WalkDefaults, WalkSource, in_file, load_walk, load_walk_from,
};
use adwave_graph::{AnnDataFile, AnnDataMatrix, ReplacedMatrix, write_replaced};
use adwave_io::atomic_write;
use std::fs::File;
use std::path::{Path, PathBuf};

/// An open `.h5ad` file.
pub(super) struct CellsFile {
    path: PathBuf,
    file: AnnDataFile,
}

impl CellsFile {
    pub(super) fn open(path: &Path, global: &Global<'_>) -> Result<Self, CliError> {
        global.inputs.add_file(path);
        let file = AnnDataFile::open(path, global.limits.max_bytes).map_err(|e| in_file(path, &e))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// The counts, of `X` or of a layer.
    pub(super) fn counts(&self, layer: Option<&str>, global: &Global<'_>) -> Result<AnnDataMatrix, CliError> {
        with_progress(global, "reading", |progress| {
            self.file.matrix(layer, progress).map_err(|e| in_file(&self.path, &e))
        })
    }

    /// Columns of the genes that are asked for, by name or number; `None` for all.
    pub(super) fn genes(&self, args: &ImputeArgs) -> Result<Option<Vec<usize>>, CliError> {
        let Some(genes) = &args.genes else { return Ok(None) };
        Ok(Some(self.file.columns_of(genes).map_err(|e| in_file(&self.path, &e))?))
    }

    /// The walk that the arguments name, or that of the file's neighbors, or of its principal components; `None` if there
    /// is none.
    pub(super) fn walk(
        &self,
        args: &ImputeArgs,
        defaults: WalkDefaults,
        global: &Global<'_>,
    ) -> Result<Option<ResolvedWalk>, CliError> {
        let walk = &args.walk;
        if walk.graph.is_some() || walk.walk.is_some() || walk.points.is_some() {
            return load_walk(walk, defaults, global).map(Some);
        }
        let path = self.path.as_path();
        let weights = with_progress(global, "reading", |progress| {
            self.file.connectivities(progress).map_err(|e| in_file(path, &e))
        })?;
        if let Some(weights) = weights {
            let name = self.file.connectivities_name().unwrap_or_default();
            note(global, &format!("the walk is that of {name} (--graph, --walk or --points for another)"));
            let content = WalkContent::Graph(Some(weights));
            return load_walk_from(WalkSource { path, content }, walk, defaults, global).map(Some);
        }
        let points = with_progress(global, "reading", |progress| {
            self.file.principal_components(progress).map_err(|e| in_file(path, &e))
        })?;
        if points.is_none() {
            return Ok(None);
        }
        note(global, "the walk is that of obsm/X_pca (--graph, --walk or --points for another)");
        let source = WalkSource { path, content: WalkContent::Points(points) };
        load_walk_from(source, walk, defaults, global).map(Some)
    }

    /// Writes a copy of the file with the values as its `X`.
    pub(super) fn write(
        &self,
        output: &Path,
        values: &[f64],
        genes: Option<&[usize]>,
        global: &Global<'_>,
    ) -> Result<(), CliError> {
        let names = match genes {
            None => None,
            Some(genes) => {
                let names = self.file.gene_names().map_err(|e| in_file(&self.path, &e))?;
                Some(genes.iter().map(|&gene| names[gene].clone()).collect::<Vec<String>>())
            }
        };
        let matrix = ReplacedMatrix { values, n_cells: self.file.n_cells(), genes: names.as_deref() };
        let left_out = with_spinner(global, "writing", || {
            let folder = output.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
            let copy = tempfile::Builder::new().prefix(".adwave-").suffix(".tmp").tempfile_in(folder);
            let failed = |e: std::io::Error| {
                CliError::Environment(format!("cannot write beside {}: {e}", output.display()))
            };
            let copy = copy.map_err(failed)?;
            let left_out =
                write_replaced(&self.path, copy.path(), matrix).map_err(|e| in_file(&self.path, &e))?;
            let mut whole = File::open(copy.path()).map_err(failed)?;
            write_file_with(global, output, |path| {
                atomic_write(path, |out| Ok(std::io::copy(&mut whole, out).map(|_| ())?))
            })?;
            Ok::<_, CliError>(left_out)
        })?;
        if !left_out.is_empty() {
            let text = format!(
                "{} have a value per gene of the input and are left out (--genes)",
                left_out.join(", ")
            );
            note(global, &text);
        }
        Ok(())
    }
}
