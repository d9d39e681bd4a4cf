//! Cells of an AnnData in an `.h5ad` file: counts, names of genes, neighbors, and a copy with imputed values.
//!
//! HDF5 is read and edited by a library without C. Sizes are checked before anything is allocated, so a damaged file
//! cannot exhaust the memory.

mod elements;
mod replace;

use crate::{CountMatrix, CountValues};
use adwave::rows::CompressedRows;
use adwave::{Cancelled, ClassifiedError, ErrorKind, Progress};
use elements::Elements;
use hdf5_pure::File;
pub use replace::{ReplacedMatrix, write_replaced};
use std::path::Path;
use thiserror::Error;

/// Error of reading or writing an `.h5ad` file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AnnDataError {
    /// The file is no HDF5, damaged, or uses a feature that is not supported.
    #[error("{what} cannot be read: {message}")]
    Hdf5 {
        /// Object in the file.
        what: String,
        /// Message of the library.
        message: String,
    },
    /// An object has another form than AnnData gives it.
    #[error("{what} {problem}")]
    Form {
        /// Object in the file.
        what: String,
        /// Requirement that is not met.
        problem: String,
    },
    /// A layer that is not there.
    #[error("there is no layer `{layer}`; the file has {present}")]
    NoLayer {
        /// Name of the layer.
        layer: String,
        /// Layers of the file.
        present: String,
    },
    /// A gene that is not there.
    #[error("there is no gene `{0}`; give names as in var, or columns counted from 0")]
    NoGene(String),
    /// More than the limit on memory.
    #[error("{what} takes {needed} bytes, more than the limit of {limit} (--max-input BYTES)")]
    TooLarge {
        /// Object in the file.
        what: String,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// A file cannot be read or written.
    #[error("the file cannot be copied: {0}")]
    Io(#[from] std::io::Error),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for AnnDataError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } => ErrorKind::Memory,
            Self::Io(_) => ErrorKind::Machine,
            Self::Cancelled(_) => ErrorKind::Cancelled,
            _ => ErrorKind::Input,
        }
    }
}

/// A matrix of the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnnDataMatrix {
    /// Values, row after row, and the number of columns.
    Dense(Vec<f64>, usize),
    /// A sparse matrix, of compressed rows or columns in the file.
    Sparse(CompressedRows<f64>),
}

impl AnnDataMatrix {
    /// The matrix as counts of channels.
    pub fn counts(&self) -> CountMatrix<'_> {
        match self {
            Self::Dense(values, n_channels) => {
                CountMatrix { values: CountValues::Dense(values), n_channels: *n_channels }
            }
            Self::Sparse(matrix) => {
                CountMatrix { values: CountValues::Sparse(matrix), n_channels: matrix.n_columns() }
            }
        }
    }
}

/// An open `.h5ad` file.
#[derive(Debug)]
pub struct AnnDataFile {
    elements: Elements,
    n_cells: usize,
    n_genes: usize,
}

impl AnnDataFile {
    /// Opens a file and reads the size of its matrix `X`. Objects of more than `max_bytes` are refused.
    ///
    /// # Errors
    /// [`AnnDataError`] if the file is no HDF5 or has no matrix `X`.
    pub fn open(path: &Path, max_bytes: u64) -> Result<Self, AnnDataError> {
        check_length(path)?;
        let file = File::open_streaming(path).map_err(|error| AnnDataError::Hdf5 {
            what: "the file".to_owned(),
            message: error.to_string(),
        })?;
        let elements = Elements { file, max_bytes };
        let [n_cells, n_genes] = elements.matrix_shape("X")?;
        Ok(Self { elements, n_cells, n_genes })
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.n_cells
    }

    /// Number of genes.
    pub fn n_genes(&self) -> usize {
        self.n_genes
    }

    /// The matrix `X`, or a layer, cells × genes. O(entries).
    ///
    /// # Errors
    /// [`AnnDataError`] if there is no such layer, its size is not that of `X` or exceeds the limit, an entry lies
    /// outside, or the call is cancelled.
    pub fn matrix(&self, layer: Option<&str>, progress: Progress<'_>) -> Result<AnnDataMatrix, AnnDataError> {
        let Some(layer) = layer else { return self.elements.matrix("X", progress) };
        let present = self.elements.members("layers");
        if !present.iter().any(|name| name == layer) {
            let present = if present.is_empty() { "none".to_owned() } else { present.join(", ") };
            return Err(AnnDataError::NoLayer { layer: layer.to_owned(), present });
        }
        let name = format!("layers/{layer}");
        let shape = self.elements.matrix_shape(&name)?;
        if shape != [self.n_cells, self.n_genes] {
            let problem = format!("must be {} × {} like X, got {shape:?}", self.n_cells, self.n_genes);
            return Err(AnnDataError::Form { what: name, problem });
        }
        self.elements.matrix(&name, progress)
    }

    /// Name of the weights between cells, if the file has them: `obsp/connectivities`, or
    /// `uns/neighbors/connectivities` as before version 0.7 of AnnData.
    pub fn connectivities_name(&self) -> Option<&'static str> {
        ["obsp/connectivities", "uns/neighbors/connectivities"].into_iter().find(|path| {
            let (folder, name) = path.rsplit_once('/').unwrap_or_default();
            self.elements.members(folder).iter().any(|member| member == name)
        })
    }

    /// Weights between cells, cells × cells, if the file has them: see
    /// [`connectivities_name`](Self::connectivities_name).
    ///
    /// # Errors
    /// [`AnnDataError`] if they are not sparse, not square, or exceed the limit.
    pub fn connectivities(
        &self,
        progress: Progress<'_>,
    ) -> Result<Option<CompressedRows<f64>>, AnnDataError> {
        let Some(what) = self.connectivities_name() else { return Ok(None) };
        let wrong = |problem: &str| AnnDataError::Form { what: what.to_owned(), problem: problem.to_owned() };
        match self.elements.matrix(what, progress)? {
            AnnDataMatrix::Sparse(matrix)
                if matrix.n_columns() == self.n_cells && matrix.n_rows() == self.n_cells =>
            {
                Ok(Some(matrix))
            }
            AnnDataMatrix::Sparse(_) => Err(wrong("must have a row and a column per cell")),
            AnnDataMatrix::Dense(..) => Err(wrong("must be a sparse matrix")),
        }
    }

    /// Coordinates `obsm/X_pca` with their number of dimensions, if the file has them.
    ///
    /// # Errors
    /// [`AnnDataError`] if they are no dense matrix with a row per cell, or exceed the limit.
    pub fn principal_components(
        &self,
        progress: Progress<'_>,
    ) -> Result<Option<(Vec<f64>, usize)>, AnnDataError> {
        if !self.elements.members("obsm").iter().any(|name| name == "X_pca") {
            return Ok(None);
        }
        match self.elements.matrix("obsm/X_pca", progress)? {
            AnnDataMatrix::Dense(values, n) if n > 0 && values.len() == self.n_cells * n => {
                Ok(Some((values, n)))
            }
            _ => Err(AnnDataError::Form {
                what: "obsm/X_pca".to_owned(),
                problem: "must be a dense matrix with a row per cell".to_owned(),
            }),
        }
    }

    /// Names of the genes: the index of `var`.
    ///
    /// # Errors
    /// [`AnnDataError`] if `var` has no index of strings, one per gene.
    pub fn gene_names(&self) -> Result<Vec<String>, AnnDataError> {
        self.elements.index_of("var", self.n_genes)
    }

    /// Columns of genes that are given by name or by column, counted from 0. A name comes before a number.
    ///
    /// # Errors
    /// [`AnnDataError::NoGene`] for a gene that the file does not have, and the errors of
    /// [`gene_names`](Self::gene_names).
    pub fn columns_of(&self, genes: &[String]) -> Result<Vec<usize>, AnnDataError> {
        let column_of_number =
            |gene: &String| gene.parse().ok().filter(|&column: &usize| column < self.n_genes);
        let names = match self.gene_names() {
            Ok(names) => names,
            // Columns need no names.
            Err(error) => return genes.iter().map(column_of_number).collect::<Option<_>>().ok_or(error),
        };
        let column_of: std::collections::HashMap<&str, usize> =
            names.iter().enumerate().rev().map(|(column, name)| (name.as_str(), column)).collect();
        let column = |gene: &String| {
            let found = column_of.get(gene.as_str()).copied().or_else(|| column_of_number(gene));
            found.ok_or_else(|| AnnDataError::NoGene(gene.clone()))
        };
        genes.iter().map(column).collect()
    }
}

/// Checks that a file is as long as its header says. The library would read the rest of a truncated file without an
/// error.
///
/// The superblock of versions 0 and 1 has four addresses behind 24 and 28 bytes, that of versions 2 and 3 behind 12;
/// the third is the end of the file.
fn check_length(path: &Path) -> Result<(), AnnDataError> {
    use std::io::Read;
    let unread = |error: std::io::Error| AnnDataError::Hdf5 {
        what: "the file".to_owned(),
        message: error.to_string(),
    };
    let file = std::fs::File::open(path).map_err(unread)?;
    let length = file.metadata().map_err(unread)?.len();
    let mut head = Vec::new();
    file.take(64).read_to_end(&mut head).map_err(unread)?;
    let address = |at: usize, size: usize| -> Option<u64> {
        let mut bytes = [0; 8];
        bytes.get_mut(..size)?.copy_from_slice(head.get(at..at + size)?);
        Some(u64::from_le_bytes(bytes))
    };
    if !head.starts_with(b"\x89HDF\r\n\x1a\n") {
        // The library says what is wrong, and finds headers that stand further on.
        return Ok(());
    }
    let (version, size_at, first) = match head.get(8) {
        Some(0) => (0, 13, 24),
        Some(1) => (1, 13, 28),
        Some(&version @ 2..=3) => (version, 9, 12),
        _ => return Ok(()),
    };
    let size = usize::from(head.get(size_at).copied().unwrap_or(0));
    // The extension stands between base and end in new headers, the index of free space in old ones.
    let end = address(first + 2 * size, size);
    match end {
        Some(end) if end > length => Err(AnnDataError::Hdf5 {
            what: "the file".to_owned(),
            message: format!(
                "its header (version {version}) says {end} bytes, and it has {length}; it was cut"
            ),
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests;
