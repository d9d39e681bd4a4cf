//! Predictions of midpoints that do not store the eight weights of the regular butterfly, and so read a third of the
//! memory.

use crate::rows::{RowBuilder, add_product, visit_rows};
use crate::topology::NONE;
use adwave::rows::CompressedRows;
use adwave::{Cancelled, Progress};

/// Weights of the regular butterfly: of the ends of the edge, of the opposite corners, and of the corners beyond.
const WEIGHTS: [f64; 8] = [0.5, 0.5, 0.125, 0.125, -0.0625, -0.0625, -0.0625, -0.0625];

/// Prediction matrix with compact regular rows.
#[derive(Clone, Debug)]
pub(crate) struct Prediction {
    /// Columns of the regular rows in the order of [`WEIGHTS`]; [`NONE`] in other rows. Empty if no row is regular.
    regular: Vec<[u32; 8]>,
    /// Rows that are not regular; the regular ones are empty.
    others: CompressedRows<f64>,
}

impl Prediction {
    pub(crate) fn new(rows: &CompressedRows<f64>) -> Self {
        let regular: Vec<[u32; 8]> = (0..rows.n_rows()).map(|i| regular_columns(rows, i)).collect();
        if regular.iter().all(|columns| columns[0] == NONE) {
            return Self { regular: Vec::new(), others: rows.clone() };
        }
        let mut others = RowBuilder::new();
        for (i, columns) in regular.iter().enumerate() {
            if columns[0] == NONE {
                let (columns, values) = rows.row(i);
                columns.iter().zip(values).for_each(|(&column, &value)| others.push(column, value));
            }
            others.end_row();
        }
        Self { regular, others: others.finish(rows.n_columns()) }
    }

    /// Adds `sign` times the prediction from `coarse` to `details`, both with `d` channels.
    pub(crate) fn add_product(
        &self,
        sign: f64,
        coarse: &[f64],
        details: &mut [f64],
        d: usize,
        progress: Progress<'_>,
    ) -> Result<(), Cancelled> {
        if !self.regular.is_empty() {
            visit_rows(details, d, progress, |first, rows| {
                for (columns, row) in self.regular[first..].iter().zip(rows.chunks_exact_mut(d)) {
                    if columns[0] == NONE {
                        continue;
                    }
                    for (channel, value) in row.iter_mut().enumerate() {
                        let at = |k: usize| coarse[columns[k] as usize * d + channel];
                        let [ends, corners] = [at(0) + at(1), at(2) + at(3)];
                        let beyond = (at(4) + at(5)) + (at(6) + at(7));
                        *value += sign * (WEIGHTS[0] * ends + WEIGHTS[2] * corners + WEIGHTS[4] * beyond);
                    }
                }
            })?;
        }
        if self.others.nnz() == 0 {
            return Ok(());
        }
        add_product(&self.others, sign, coarse, details, d, progress)
    }
}

/// Columns of a regular row in the order of [`WEIGHTS`]; [`NONE`] for any other row.
fn regular_columns(rows: &CompressedRows<f64>, i: usize) -> [u32; 8] {
    let (columns, values) = rows.row(i);
    if columns.len() != WEIGHTS.len() {
        return [NONE; 8];
    }
    let mut order: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    if order.map(|k| values[k]) == WEIGHTS { order.map(|k| columns[k]) } else { [NONE; 8] }
}
