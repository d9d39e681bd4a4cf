//! Sample of a large surface, for decisions that do not need all of it.

use super::surface::NoisySurface;
use crate::{Cancelled, Progress};

/// Number of sites beyond which a surface is sampled.
const MAX_SITES: usize = 48_000;

/// Number of pieces of a sample, evenly spread over the order of the sites.
const PIECES: usize = 8;

/// Number of sites in each piece.
const SITES_A_PIECE: usize = 4_000;

/// A surface and the positions of its points.
pub(super) type Sample = (NoisySurface, Vec<[f64; 3]>);

impl NoisySurface {
    /// Connected pieces of a large surface, as a surface with its own points; `None` if the surface is small enough
    /// to be used as a whole. O(sites of the sample), and one mark per point.
    pub(super) fn sample(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Option<Sample>, Cancelled> {
        if self.n_sites() <= MAX_SITES {
            Ok(None)
        } else {
            self.sample_of([PIECES, SITES_A_PIECE], points, progress)
        }
    }

    /// Connected pieces of the surface, with equal numbers of sites; `None` if these would be all of its sites.
    pub(super) fn sample_of(
        &self,
        [n_pieces, sites_a_piece]: [usize; 2],
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Option<Sample>, Cancelled> {
        let n = self.n_sites();
        if n <= n_pieces * sites_a_piece {
            return Ok(None);
        }
        // Sites are ordered along a curve through the shape, so a range of them is a connected piece.
        let sites = (0..n_pieces).flat_map(|k| {
            let first = k * n / n_pieces + (n / n_pieces - sites_a_piece) / 2;
            first..first + sites_a_piece
        });
        let chosen: Vec<[u32; 3]> = sites.map(|t| self.triangles[t]).collect();
        let mut corners: Vec<u32> = chosen.as_flattened().to_vec();
        corners.sort_unstable();
        corners.dedup();
        let number = |v: u32| corners.partition_point(|&c| c < v) as u32;
        let chosen = chosen.iter().map(|t| t.map(number)).collect();
        let points: Vec<[f64; 3]> = corners.iter().map(|&v| points[v as usize]).collect();
        Ok(Some((Self::mesh(points.len(), chosen, progress)?, points)))
    }
}
