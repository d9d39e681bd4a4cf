//! One run of edge collapses.
//!
//! The library is meshoptimizer by its bindings `meshopt`. What is written in Rust alone was looked at first: `meshopt-rs`, a
//! translation of an early version, has had no release since 2021; `baby_shark` and `alum` collapse half-edges, so that they
//! refuse or drop what is not manifold, and move vertices. meshoptimizer takes any triangles, keeps a subset of the vertices,
//! knows seams, and needs a second for a million vertices. It asks for a C++ compiler when adwave is built.

use crate::mesh::Border;
use crate::wedges::Wedges;
use meshopt::{SimplifyOptions, simplify_with_locks_decoder};

/// The triangles that are left when edges are collapsed until there are `n_triangles`, or the estimated error would be larger
/// than `error` in the unit box. Wedges that are locked stay.
///
/// The estimate is a mean over planes and says little of the greatest distance; that one is measured by the caller.
pub(crate) fn collapse(
    wedges: &Wedges,
    points: &[[f32; 3]],
    locked: &[bool],
    n_triangles: usize,
    error: f64,
    border: Border,
) -> Vec<[u32; 3]> {
    // The bindings pass indices and locks on unseen; those of `Wedges` are in range by construction.
    assert_eq!((points.len(), locked.len()), (wedges.points.len(), wedges.points.len()), "one per wedge");
    debug_assert!(wedges.triangles.as_flattened().iter().all(|&w| (w as usize) < points.len()));
    let options = match border {
        Border::Weighted => SimplifyOptions::ErrorAbsolute,
        Border::Kept => SimplifyOptions::ErrorAbsolute | SimplifyOptions::LockBorder,
    };
    let indices = wedges.triangles.as_flattened();
    let target = (3 * n_triangles).min(indices.len());
    let left = simplify_with_locks_decoder(indices, points, locked, target, error as f32, options, None);
    left.as_chunks().0.to_vec()
}

/// Positions in single precision, as the library takes them.
pub(crate) fn in_single_precision(points: &[[f64; 3]]) -> Vec<[f32; 3]> {
    points.iter().map(|p| p.map(|x| x as f32)).collect()
}
