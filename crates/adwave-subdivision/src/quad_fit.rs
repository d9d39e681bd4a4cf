//! Agreement of positions with a step of subdivision: those of the coarse mesh, and the distance of the new vertices
//! from their predictions.

use crate::coarsening::Coarsening;
use crate::hierarchy::HierarchyLevel;
use crate::rows::add_product;
use crate::topology::{NONE, Topology};
use crate::{BorderCorners, SubdivisionError, quad_stencils};
use adwave::Progress;
use adwave::rows::CompressedRows;

/// Distance from the predictions, in lengths of edges, up to which positions count as made by subdivision: files with
/// six decimal places come to 10⁻⁴, and sculpted shapes to 10⁻² and more on the coarse levels that this decides.
const EXACT: f64 = 1e-3;

/// Coarse positions of a step, and their distance from the finer ones.
pub(crate) struct Fit {
    pub(crate) coarse: Vec<[f64; 3]>,
    /// Root mean square distance of the new vertices from their predictions, in root mean square lengths of edges.
    pub(crate) error: f64,
}

impl Fit {
    /// Tries the linear and the Catmull–Clark rule and takes the one with the smaller details.
    pub(crate) fn new(
        coarsening: &Coarsening,
        coarser: Topology,
        ranks: &[u32],
        points: &[[f64; 3]],
        corners: BorderCorners,
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        let n_coarse = coarsening.coarse.len() as u32;
        let centers = coarsening.face_points.iter().copied().filter(|&v| v != NONE);
        let odd: Vec<u32> = coarsening.midpoints.iter().copied().chain(centers).collect();
        let mut places = ranks.to_vec();
        for (place, &v) in (n_coarse..).zip(&odd) {
            places[v as usize] = place;
        }
        let place = |v: &u32| if *v == NONE { NONE } else { places[*v as usize] };
        let level = HierarchyLevel {
            topology: coarser,
            midpoint_of: coarsening.midpoint_of.iter().map(place).collect(),
            parents: coarsening.parents.iter().map(|pair| pair.map(|v| places[v as usize])).collect(),
            face_points: coarsening.face_points.iter().map(place).collect(),
            children: Vec::new(),
        };
        let at = |v: &u32| points[*v as usize];
        let even: Vec<[f64; 3]> = coarsening.coarse.iter().map(at).collect();
        let odd: Vec<[f64; 3]> = odd.iter().map(at).collect();
        let edges = level.parents.iter().zip(&odd).map(|(pair, p)| square(&even[pair[0] as usize], p));
        let unit = edges.sum::<f64>() / level.parents.len().max(1) as f64;
        let measure = |coarse: Vec<[f64; 3]>, rows: &CompressedRows<f64>| {
            let mut rest = odd.clone();
            add_product(rows, -1.0, coarse.as_flattened(), rest.as_flattened_mut(), 3, progress)?;
            let sum: f64 = rest.iter().map(|p| square(p, &[0.0; 3])).sum();
            let error = (sum / rest.len().max(1) as f64 / unit).sqrt();
            Ok::<Self, SubdivisionError>(Self { coarse, error: if error.is_nan() { 0.0 } else { error } })
        };
        let linear = measure(even.clone(), &quad_stencils::linear(&level))?;
        let rule = quad_stencils::even_rule(&level, corners);
        let mut coarse = even;
        rule.solve(coarse.as_flattened_mut(), 3, progress)?;
        let smooth = measure(coarse, &quad_stencils::catmull_clark(&level))?;
        Ok(if smooth.error < linear.error { smooth } else { linear })
    }

    /// True if subdivision made the positions, up to rounding.
    pub(crate) fn is_exact(&self) -> bool {
        self.error <= EXACT
    }
}

fn square(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    p.iter().zip(q).map(|(a, b)| (a - b) * (a - b)).sum()
}
