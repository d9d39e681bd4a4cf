//! Coefficients of a field, and a selection of the largest.

use crate::SubdivisionError;

/// Coefficients of a field: one row for each vertex or face of the mesh, as many values as the field has.
#[derive(Clone, Debug, PartialEq)]
pub struct LiftedCoefficients {
    /// Number of channels.
    pub n_channels: usize,
    /// Coefficients, row-major (n_rows × n_channels), in the order of the mesh.
    pub values: Vec<f64>,
    /// Level of each row: 1 for the finest details, one more than the number of levels for values of the coarsest
    /// level.
    pub levels: Vec<u32>,
    /// Norm of the basis function of each row.
    pub norms: Vec<f64>,
}

impl LiftedCoefficients {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.levels.len()
    }

    /// Keeps the share of the rows that contribute most, by coefficient times norm, and sets all others to 0. Of equal
    /// rows the first are kept. The number of kept rows is rounded up.
    ///
    /// # Errors
    /// [`SubdivisionError::Share`] unless the share is in [0, 1].
    pub fn keep(&self, share: f64) -> Result<Self, SubdivisionError> {
        if !(0.0..=1.0).contains(&share) {
            return Err(SubdivisionError::Share(share));
        }
        let d = self.n_channels;
        let n_kept = ((share * self.n_rows() as f64).ceil() as usize).min(self.n_rows());
        // Scaled by the greatest, so that squares do not overflow.
        let greatest = self.values.iter().fold(0.0_f64, |most, v| most.max(v.abs())).max(f64::MIN_POSITIVE);
        let weight = |i: usize| {
            let row = &self.values[i * d..][..d];
            self.norms[i] * row.iter().map(|c| (c / greatest) * (c / greatest)).sum::<f64>().sqrt()
        };
        let weights: Vec<f64> = (0..self.n_rows()).map(weight).collect();
        let mut rows: Vec<u32> = (0..self.n_rows() as u32).collect();
        if n_kept > 0 && n_kept < rows.len() {
            rows.select_nth_unstable_by(n_kept - 1, |&a, &b| {
                weights[b as usize].total_cmp(&weights[a as usize]).then(a.cmp(&b))
            });
        }
        let mut values = vec![0.0; self.values.len()];
        for &row in &rows[..n_kept] {
            let at = row as usize * d;
            values[at..at + d].copy_from_slice(&self.values[at..at + d]);
        }
        Ok(Self { values, ..self.clone() })
    }
}
