//! Elements of an AnnData in HDF5: matrices, data frames and their index.

use super::{AnnDataError, AnnDataMatrix};
use adwave::Progress;
use adwave::rows::CompressedRows;
use hdf5_pure::{AttrValue, Dataset, Error, File};
use std::collections::HashMap;

/// Values that are read between two checks for cancellation.
const AT_A_TIME: u64 = 1 << 20;

/// The objects of a file.
#[derive(Debug)]
pub(super) struct Elements {
    pub(super) file: File,
    /// Largest size of an object in memory.
    pub(super) max_bytes: u64,
}

/// Arrays of a compressed matrix in the file.
struct CompressedArrays {
    offsets: Vec<usize>,
    indices: Vec<u32>,
    values: Vec<f64>,
}

impl Elements {
    /// Names of the members of a group; none if there is no such group.
    pub(super) fn members(&self, group: &str) -> Vec<String> {
        let Ok(group) = self.file.group(group) else { return Vec::new() };
        let mut names = group.datasets().unwrap_or_default();
        names.extend(group.groups().unwrap_or_default());
        names.sort_unstable();
        names
    }

    /// Attributes of a group; `None` if it is a dataset or absent.
    fn group_attributes(&self, name: &str) -> Option<HashMap<String, AttrValue>> {
        self.file.group(name).and_then(|group| group.attrs()).ok()
    }

    fn dataset(&self, name: &str) -> Result<Dataset, AnnDataError> {
        self.file.dataset(name).map_err(|error| unreadable(name, &error))
    }

    /// Numbers of rows and columns of a dense or sparse matrix.
    pub(super) fn matrix_shape(&self, name: &str) -> Result<[usize; 2], AnnDataError> {
        let shape: Vec<u64> = match self.group_attributes(name) {
            Some(attributes) => {
                // The second name is that of AnnData before version 0.7.
                let shape = attributes.get("shape").or_else(|| attributes.get("h5sparse_shape"));
                shape.and_then(whole_numbers).unwrap_or_default()
            }
            None => self.dataset(name)?.shape().map_err(|error| unreadable(name, &error))?,
        };
        match shape[..] {
            [rows, columns] if u32::try_from(rows).is_ok() && u32::try_from(columns).is_ok() => {
                Ok([rows as usize, columns as usize])
            }
            _ => Err(wrong(
                name,
                format!("must be a matrix of fewer than 2³² rows and columns, got {shape:?}"),
            )),
        }
    }

    /// A dense or sparse matrix.
    pub(super) fn matrix(&self, name: &str, progress: Progress<'_>) -> Result<AnnDataMatrix, AnnDataError> {
        let [n_rows, n_columns] = self.matrix_shape(name)?;
        let Some(attributes) = self.group_attributes(name) else {
            let needed = (8 * n_rows as u64).saturating_mul(n_columns as u64);
            self.check_size(name, needed)?;
            let values = self.read_rows(name, n_rows as u64, n_columns as u64, progress)?;
            return if values.len() == n_rows * n_columns {
                Ok(AnnDataMatrix::Dense(values, n_columns))
            } else {
                Err(wrong(name, format!("must have {n_rows} × {n_columns} values, got {}", values.len())))
            };
        };
        let kind = attributes.get("encoding-type").or_else(|| attributes.get("h5sparse_format"));
        let is_by_rows = match kind.and_then(text) {
            Some("csr_matrix" | "csr") => true,
            Some("csc_matrix" | "csc") => false,
            other => {
                let found = other.unwrap_or("none");
                return Err(wrong(
                    name,
                    format!("must be an array, a csr_matrix or a csc_matrix, got {found}"),
                ));
            }
        };
        // Empty rows take memory too.
        self.check_size(name, 8 * (n_rows as u64 + n_columns as u64))?;
        let (n_long, n_short) = if is_by_rows { (n_rows, n_columns) } else { (n_columns, n_rows) };
        let arrays = self.compressed_arrays(name, n_long, n_short, progress)?;
        let entries = if is_by_rows { arrays } else { arrays.transpose(n_rows) };
        let rows = entries.into_rows(n_columns).map_err(|error| wrong(name, error.to_string()))?;
        Ok(AnnDataMatrix::Sparse(rows))
    }

    /// `data`, `indices` and `indptr` of `n_long` compressed rows (or columns) of `n_short` places.
    fn compressed_arrays(
        &self,
        name: &str,
        n_long: usize,
        n_short: usize,
        progress: Progress<'_>,
    ) -> Result<CompressedArrays, AnnDataError> {
        let part = |part: &str| format!("{name}/{part}");
        let offsets = self.read_vector(&part("indptr"), progress, whole_number)?;
        let indices = self.read_vector(&part("indices"), progress, whole_number)?;
        let values = self.read_vector(&part("data"), progress, Some)?;
        let n_entries = values.len();
        let is_ascending = offsets.windows(2).all(|pair| pair[0] <= pair[1]);
        let is_complete = offsets.len() == n_long + 1
            && offsets.first() == Some(&0)
            && offsets.last() == Some(&(n_entries as u64));
        if !is_ascending || !is_complete || indices.len() != n_entries {
            let problem = format!(
                "must have ascending indptr from 0 to the number of entries, {} of them, and an index per entry; got {} \
                 values, {} indices and {} offsets",
                n_long + 1,
                n_entries,
                indices.len(),
                offsets.len()
            );
            return Err(wrong(name, problem));
        }
        if let Some(index) = indices.iter().find(|&&index| index >= n_short as u64) {
            return Err(wrong(name, format!("has the index {index}, which must be less than {n_short}")));
        }
        Ok(CompressedArrays {
            offsets: offsets.into_iter().map(|offset| offset as usize).collect(),
            indices: indices.into_iter().map(|index| index as u32).collect(),
            values,
        })
    }

    /// A dataset of one dimension, number by number.
    fn read_vector<T>(
        &self,
        name: &str,
        progress: Progress<'_>,
        convert: impl Fn(f64) -> Option<T>,
    ) -> Result<Vec<T>, AnnDataError> {
        let shape = self.dataset(name)?.shape().map_err(|error| unreadable(name, &error))?;
        let [len] = shape[..] else {
            return Err(wrong(name, format!("must have one dimension, got the shape {shape:?}")));
        };
        self.check_size(name, len.saturating_mul(16))?;
        let values = self.read_rows(name, len, 1, progress)?;
        if values.len() as u64 != len {
            return Err(wrong(name, format!("must have {len} values, got {}", values.len())));
        }
        values
            .into_iter()
            .map(|v| convert(v).ok_or_else(|| wrong(name, format!("must hold whole numbers, got {v}"))))
            .collect()
    }

    /// All rows of a dataset of numbers. Whole numbers are exact up to 2⁵³.
    fn read_rows(
        &self,
        name: &str,
        n_rows: u64,
        n_columns: u64,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, AnnDataError> {
        let dataset = self.dataset(name)?;
        let mut values = Vec::with_capacity((n_rows * n_columns) as usize);
        let step = (AT_A_TIME / n_columns.max(1)).max(1);
        let mut row = 0;
        while row < n_rows {
            progress.step(row, n_rows)?;
            values.extend(dataset.read_f64_rows(row, step).map_err(|error| unreadable(name, &error))?);
            row += step;
        }
        Ok(values)
    }

    /// Index of a data frame, `n` strings.
    pub(super) fn index_of(&self, frame: &str, n: usize) -> Result<Vec<String>, AnnDataError> {
        let attributes = self
            .group_attributes(frame)
            .ok_or_else(|| {
                let problem = "must be a data frame, as AnnData writes it since 0.7, got another object; read and write \
                               the file again with AnnData, or give columns by number and write .npy";
                wrong(frame, problem.to_owned())
            })?;
        let column = attributes.get("_index").and_then(text).unwrap_or("_index");
        let mut name = format!("{frame}/{column}");
        if self.group_attributes(&name).is_some() {
            // Strings that may be missing have their values beside a mask.
            name += "/values";
        }
        let dataset = self.dataset(&name)?;
        let shape = dataset.shape().map_err(|error| unreadable(&name, &error))?;
        if shape != [n as u64] {
            return Err(wrong(&name, format!("must have {n} strings, got the shape {shape:?}")));
        }
        self.check_size(&name, 64 * n as u64)?;
        dataset.read_string().map_err(|error| unreadable(&name, &error))
    }

    fn check_size(&self, what: &str, needed: u64) -> Result<(), AnnDataError> {
        let limit = self.max_bytes;
        if needed > limit {
            return Err(AnnDataError::TooLarge { what: what.to_owned(), needed, limit });
        }
        Ok(())
    }
}

impl CompressedArrays {
    /// Compressed rows of compressed columns, or the reverse; `n` is the number of places of the indices.
    fn transpose(self, n: usize) -> Self {
        let mut offsets = vec![0; n + 1];
        for &index in &self.indices {
            offsets[index as usize + 1] += 1;
        }
        for place in 0..n {
            offsets[place + 1] += offsets[place];
        }
        let mut next = offsets.clone();
        let (mut indices, mut values) = (vec![0; self.indices.len()], vec![0.0; self.values.len()]);
        for (place, range) in self.offsets.windows(2).enumerate() {
            for at in range[0]..range[1] {
                let to = &mut next[self.indices[at] as usize];
                (indices[*to], values[*to]) = (place as u32, self.values[at]);
                *to += 1;
            }
        }
        Self { offsets, indices, values }
    }

    /// Rows with ascending columns; entries of the same place are added.
    fn into_rows(self, n_columns: usize) -> Result<CompressedRows<f64>, adwave::rows::RowsError> {
        let ascends =
            |range: &[usize]| self.indices[range[0]..range[1]].windows(2).all(|pair| pair[0] < pair[1]);
        if self.offsets.windows(2).all(ascends) {
            return CompressedRows::new(self.offsets, self.indices, self.values, n_columns);
        }
        let (mut offsets, mut indices, mut values) = (vec![0], Vec::new(), Vec::<f64>::new());
        for range in self.offsets.windows(2) {
            let mut row: Vec<(u32, f64)> =
                (range[0]..range[1]).map(|at| (self.indices[at], self.values[at])).collect();
            row.sort_by_key(|entry| entry.0);
            let first = indices.len();
            for (index, value) in row {
                if indices.len() > first && indices.last() == Some(&index) {
                    values[indices.len() - 1] += value;
                } else {
                    indices.push(index);
                    values.push(value);
                }
            }
            offsets.push(indices.len());
        }
        CompressedRows::new(offsets, indices, values, n_columns)
    }
}

/// A whole number of at least 0.
fn whole_number(v: f64) -> Option<u64> {
    (v >= 0.0 && v.fract() == 0.0 && v < 9e15).then_some(v as u64)
}

/// Whole numbers of an attribute.
fn whole_numbers(value: &AttrValue) -> Option<Vec<u64>> {
    let of_signed = |values: &[i64]| values.iter().map(|&v| u64::try_from(v).ok()).collect();
    match value {
        AttrValue::I64Array(values) => of_signed(values),
        AttrValue::U64Array(values) => Some(values.clone()),
        AttrValue::I32Array(values) => of_signed(&values.iter().map(|&v| i64::from(v)).collect::<Vec<_>>()),
        AttrValue::U32Array(values) => Some(values.iter().map(|&v| u64::from(v)).collect()),
        _ => None,
    }
}

/// Text of an attribute.
fn text(value: &AttrValue) -> Option<&str> {
    match value {
        AttrValue::String(text)
        | AttrValue::AsciiString(text)
        | AttrValue::VarLenString(text)
        | AttrValue::VarLenAsciiString(text) => Some(text),
        _ => None,
    }
}

pub(super) fn unreadable(what: &str, error: &Error) -> AnnDataError {
    AnnDataError::Hdf5 { what: what.to_owned(), message: error.to_string() }
}

fn wrong(what: &str, problem: String) -> AnnDataError {
    AnnDataError::Form { what: what.to_owned(), problem }
}
