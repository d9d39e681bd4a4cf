//! A part of a large surface, for decisions that all of it need not be looked at for.

use super::surface::{Kind, Surface};
use crate::{Cancelled, Progress};

/// Surfaces of more sites than this are sampled.
const MAX_SITES: usize = 48_000;

/// Pieces that a sample is of, evenly spread over the order of the sites.
const PIECES: usize = 8;

/// Sites in each piece.
const SITES_A_PIECE: usize = 4_000;

/// A surface with points of its own.
pub(super) type Sample = (Surface, Vec<[f64; 3]>);

impl Surface {
    /// Some connected pieces of a large surface, as a surface with points of its own; `None` of one that is small enough to be
    /// looked at whole. O(sites of the sample), and a mark for each point.
    pub(super) fn sample(
        &self,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Option<Sample>, Cancelled> {
        let n = self.n_sites();
        if n <= MAX_SITES {
            return Ok(None);
        }
        // Sites stand in the order of a curve through the shape, so that a range of them is a piece of it.
        let sites = (0..PIECES).flat_map(|k| {
            let first = k * n / PIECES + (n / PIECES - SITES_A_PIECE) / 2;
            first..first + SITES_A_PIECE
        });
        match &self.kind {
            Kind::Cloud { .. } => {
                let points: Vec<[f64; 3]> = sites.map(|x| points[x]).collect();
                Ok(Some((Self::cloud(&points, progress)?, points)))
            }
            Kind::Mesh { triangles, .. } => {
                let chosen: Vec<[u32; 3]> = sites.map(|t| triangles[t]).collect();
                let mut corners: Vec<u32> = chosen.as_flattened().to_vec();
                corners.sort_unstable();
                corners.dedup();
                let number = |v: u32| corners.partition_point(|&c| c < v) as u32;
                let chosen = chosen.iter().map(|t| t.map(number)).collect();
                let points: Vec<[f64; 3]> = corners.iter().map(|&v| points[v as usize]).collect();
                Ok(Some((Self::mesh(points.len(), chosen, progress)?, points)))
            }
        }
    }
}
