//! Masked vertices, where a signal is unknown: the diffusion goes around them.

use crate::bands::BandsError;
use crate::operator::{DiffusionError, NoRows};
use crate::shape::VertexMap;
use crate::{ClassifiedError, ErrorKind};
use thiserror::Error;

/// Error of masking vertices.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MaskError {
    /// The number of flags does not match the shape.
    #[error("there are {n_flags} flags for {n_vertices} vertices")]
    WrongLength {
        /// Number of flags given.
        n_flags: usize,
        /// Number of vertices of the shape.
        n_vertices: usize,
    },
    /// All vertices are masked.
    #[error("the field is NaN at all {n_vertices} vertices; give one that has values")]
    NothingLeft {
        /// Number of vertices of the shape.
        n_vertices: usize,
    },
    /// The operator has no rows that could go around a vertex, and no other way.
    #[error(transparent)]
    NoRows(#[from] NoRows),
    /// The rows cannot go around these vertices.
    #[error(transparent)]
    Rows(#[from] DiffusionError),
    /// The operator without these vertices does not keep its promises.
    #[error(transparent)]
    Operator(#[from] BandsError),
}

impl ClassifiedError for MaskError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// Flags the vertices where a channel of the signal (n_vertices × n_channels, row-major) is NaN; `None` if there
/// are none.
///
/// ```
/// use adwave::mask::missing;
/// assert_eq!(missing(&[0.0, 1.0, f64::NAN, 2.0], 2), Some(vec![false, true]));
/// assert_eq!(missing(&[0.0, f64::INFINITY], 1), None);
/// ```
///
/// # Panics
/// If `n_channels` is 0.
pub fn missing(signal: &[f64], n_channels: usize) -> Option<Vec<bool>> {
    signal
        .iter()
        .any(|v| v.is_nan())
        .then(|| signal.chunks(n_channels).map(|row| row.iter().any(|v| v.is_nan())).collect())
}

/// Channels of a signal that are NaN at the same vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaskedChannels {
    /// Indices of the channels, ascending.
    pub channels: Vec<usize>,
    /// Flags of the vertices where they are NaN; `None` if there are none.
    pub missing: Option<Vec<bool>>,
}

/// Groups the channels of a signal (n_vertices × n_channels, row-major) by the vertices where they are NaN, in the
/// order of their first channels. Channels without any value are left out, because nothing can be computed of them,
/// unless no channel has one. O(n_vertices × n_channels), and once more for each group.
///
/// ```
/// use adwave::mask::channels_by_mask;
/// let groups = channels_by_mask(&[0.0, f64::NAN, 2.0, 1.0, 4.0, 3.0], 3);
/// assert_eq!((&groups[0].channels[..], &groups[0].missing), (&[0, 2][..], &None));
/// assert_eq!((&groups[1].channels[..], &groups[1].missing), (&[1][..], &Some(vec![true, false])));
/// let groups = channels_by_mask(&[0.0, f64::NAN, 2.0, f64::NAN], 2);
/// assert_eq!((groups.len(), &groups[0].channels[..]), (1, &[0][..]));
/// ```
///
/// # Panics
/// If `n_channels` is 0.
pub fn channels_by_mask(signal: &[f64], n_channels: usize) -> Vec<MaskedChannels> {
    // A chunk at once: an early end within it would compare value by value.
    let has_gap = |values: &[f64]| values.iter().fold(false, |any, v| any | v.is_nan());
    if !signal.chunks(1 << 12).any(has_gap) {
        return vec![MaskedChannels { channels: (0..n_channels).collect(), missing: None }];
    }
    let mut groups: Vec<MaskedChannels> = Vec::new();
    for channel in 0..n_channels {
        let values = || signal.iter().skip(channel).step_by(n_channels);
        let is_same = |missing: &[bool]| values().map(|v| v.is_nan()).eq(missing.iter().copied());
        let has_missing = values().any(|v| v.is_nan());
        let fits = |group: &&mut MaskedChannels| match &group.missing {
            Some(missing) => has_missing && is_same(missing),
            None => !has_missing,
        };
        match groups.iter_mut().find(fits) {
            Some(group) => group.channels.push(channel),
            None => groups.push(MaskedChannels {
                channels: vec![channel],
                missing: has_missing.then(|| values().map(|v| v.is_nan()).collect()),
            }),
        }
    }
    if groups.iter().any(|group| !group.is_empty()) {
        groups.retain(|group| !group.is_empty());
    }
    groups
}

impl MaskedChannels {
    /// True if the channels have no value at all.
    fn is_empty(&self) -> bool {
        self.missing.as_ref().is_some_and(|missing| missing.iter().all(|&is_missing| is_missing))
    }

    /// The channels of a signal of `n_channels`, row-major.
    pub fn select(&self, signal: &[f64], n_channels: usize) -> Vec<f64> {
        signal.chunks_exact(n_channels).flat_map(|row| self.channels.iter().map(|&c| row[c])).collect()
    }

    /// Puts new values of the channels into a signal of `n_channels`.
    ///
    /// # Panics
    /// If there are fewer values than vertices × channels.
    pub fn place(&self, values: &[f64], signal: &mut [f64], n_channels: usize) {
        for (row, new) in signal.chunks_exact_mut(n_channels).zip(values.chunks_exact(self.channels.len())) {
            for (&c, value) in self.channels.iter().zip(new) {
                row[c] = *value;
            }
        }
    }
}

/// Mask in the order of the shape and in the analysis order.
#[derive(Clone, Debug)]
pub(crate) struct Mask {
    vertices: Vec<bool>,
    welded: Vec<bool>,
}

impl Mask {
    pub(crate) fn new(masked: &[bool], vertex_map: &VertexMap) -> Result<Self, MaskError> {
        let n_vertices = vertex_map.n_vertices();
        if masked.len() != n_vertices {
            return Err(MaskError::WrongLength { n_flags: masked.len(), n_vertices });
        }
        let mut welded = vec![true; vertex_map.n_welded()];
        for (&x, &out) in vertex_map.as_slice().iter().zip(masked) {
            welded[x as usize] &= out;
        }
        if welded.iter().all(|&out| out) {
            return Err(MaskError::NothingLeft { n_vertices });
        }
        Ok(Self { vertices: masked.to_vec(), welded })
    }

    /// Flags of the vertices of the shape.
    pub(crate) fn vertices(&self) -> &[bool] {
        &self.vertices
    }

    /// Flags of the welded vertices.
    pub(crate) fn welded(&self) -> &[bool] {
        &self.welded
    }

    /// The signal with a value at every vertex: 0 at masked welded vertices, and the mean of the other members at a
    /// masked member of a welded vertex that is not masked.
    pub(crate) fn fill(
        &self,
        signal: &[f64],
        n_channels: usize,
        vertex_map: &VertexMap,
    ) -> Result<Vec<f64>, BandsError> {
        let n_vertices = vertex_map.n_vertices();
        if n_channels == 0 || n_vertices.checked_mul(n_channels) != Some(signal.len()) {
            return Err(BandsError::WrongLength { n_values: signal.len(), n_vertices, n_channels });
        }
        let mut filled = signal.to_vec();
        let mut mean = vec![0.0; vertex_map.n_welded() * n_channels];
        let mut count = vec![0_u32; vertex_map.n_welded()];
        for (x, row) in signal.chunks_exact(n_channels).enumerate().filter(|(x, _)| !self.vertices[*x]) {
            let x = vertex_map.welded(x);
            count[x] += 1;
            for (m, value) in mean[x * n_channels..].iter_mut().zip(row) {
                *m += (value - *m) / f64::from(count[x]);
            }
        }
        for (x, row) in filled.chunks_exact_mut(n_channels).enumerate().filter(|(x, _)| self.vertices[*x]) {
            row.copy_from_slice(&mean[vertex_map.welded(x) * n_channels..][..n_channels]);
        }
        Ok(filled)
    }

    /// Sets a result to NaN at masked vertices.
    pub(crate) fn clear(&self, values: &mut [f64], n_channels: usize) {
        for (row, _) in values.chunks_exact_mut(n_channels).zip(&self.vertices).filter(|(_, out)| **out) {
            row.fill(f64::NAN);
        }
    }

    /// Restores the original values at masked vertices.
    pub(crate) fn restore(&self, signal: &[f64], n_channels: usize, values: &mut [f64]) {
        let rows = values.chunks_exact_mut(n_channels).zip(signal.chunks_exact(n_channels));
        for ((row, before), _) in rows.zip(&self.vertices).filter(|(_, out)| **out) {
            row.copy_from_slice(before);
        }
    }
}
