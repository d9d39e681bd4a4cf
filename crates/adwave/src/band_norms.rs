//! Bands read in the order of the analysis, so that what is found in them does not depend on the order of the file.

use crate::Decomposer;
use rayon::prelude::*;

/// Vertices that a thread takes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// Reads bands of the vertices of a shape as bands of the vertices of its analysis.
pub(crate) struct BandNorms<'a> {
    masked: Option<&'a [bool]>,
    /// The members of each class, and where those of each begin.
    first_member: Vec<usize>,
    members: Vec<u32>,
    n_kept: usize,
}

impl<'a> BandNorms<'a> {
    pub(crate) fn new(decomposer: &'a Decomposer) -> Self {
        let masked = decomposer.mask_flags();
        let (first_member, members) = decomposer.geometry().vertex_map().members().into_parts();
        let n = first_member.len() - 1;
        let n_kept = masked.map_or(n, |out| out.iter().filter(|&&out| !out).count());
        Self { masked, first_member, members, n_kept }
    }

    fn members(&self, x: usize) -> &[u32] {
        &self.members[self.first_member[x]..self.first_member[x + 1]]
    }

    /// The first vertex of the shape that is vertex `x` of the analysis.
    pub(crate) fn vertex(&self, x: usize) -> usize {
        self.members(x)[0] as usize
    }

    pub(crate) fn is_masked(&self, x: usize) -> bool {
        self.masked.is_some_and(|out| out[x])
    }

    /// Channel `c` of a band.
    pub(crate) fn channel(&self, band: &[f64], n_channels: usize, c: usize) -> Vec<f64> {
        self.map(|x| match self.members(x) {
            &[only] => band[only as usize * n_channels + c],
            several => mean_of(several, |y| band[y * n_channels + c]),
        })
    }

    /// The Euclidean norm of a band over its channels; of the mean where a vertex is welded.
    pub(crate) fn norms(&self, band: &[f64], n_channels: usize) -> Vec<f64> {
        self.map(|x| match self.members(x) {
            &[only] => {
                let row = &band[only as usize * n_channels..][..n_channels];
                if let &[w] = row { w.abs() } else { row.iter().map(|w| w * w).sum::<f64>().sqrt() }
            }
            several => {
                let square = |c: usize| mean_of(several, |y| band[y * n_channels + c]).powi(2);
                (0..n_channels).map(square).sum::<f64>().sqrt()
            }
        })
    }

    /// Mean of |value| over the vertices that are not left out.
    pub(crate) fn mean(&self, values: &[f64]) -> f64 {
        let term = |x: usize| if self.is_masked(x) { 0.0 } else { values[x].abs() };
        crate::parallel::sum(values.len(), term) / self.n_kept as f64
    }

    /// Largest |value| over the vertices that are not left out.
    pub(crate) fn max(&self, values: &[f64]) -> f64 {
        crate::parallel::max(values.len(), 0.0, |x| if self.is_masked(x) { 0.0 } else { values[x].abs() })
    }

    fn map(&self, value: impl Fn(usize) -> f64 + Sync + Send) -> Vec<f64> {
        let value = |x: usize| if self.is_masked(x) { f64::NAN } else { value(x) };
        let n = self.first_member.len() - 1;
        (0..n).into_par_iter().with_min_len(VERTICES_AT_A_TIME).map(value).collect()
    }
}

/// Mean over the members that have a value.
fn mean_of(members: &[u32], value: impl Fn(usize) -> f64) -> f64 {
    let known = members.iter().map(|&y| value(y as usize)).filter(|v| !v.is_nan());
    let (sum, n) = known.fold((0.0, 0_u32), |(sum, n), v| (sum + v, n + 1));
    sum / f64::from(n)
}
