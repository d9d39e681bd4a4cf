//! One run of edge collapses.
//!
//! Library: meshoptimizer, through its bindings `meshopt`. It accepts any triangles, keeps a subset of the vertices, supports
//! seams, and takes a second for a million vertices; building it needs a C++ compiler. Rust libraries were evaluated first:
//! `meshopt-rs`, a port of an early version, has had no release since 2021; `baby_shark` and `alum` collapse half-edges, and
//! therefore reject or drop non-manifold parts and move vertices.

use crate::mesh::Border;
use crate::wedges::Wedges;
use meshopt::{SimplifyOptions, simplify_with_locks_decoder};

/// Collapses edges until `n_triangles` remain or the estimated error would exceed `error` in the unit box; returns the
/// remaining triangles. Locked wedges are kept.
///
/// The estimate is a mean over planes and a poor predictor of the largest distance, which the caller measures.
pub(crate) fn collapse(
    wedges: &Wedges,
    points: &[[f32; 3]],
    locked: &[bool],
    n_triangles: usize,
    error: f64,
    border: Border,
) -> Vec<[u32; 3]> {
    // The bindings do not check indices and locks; those of `Wedges` are in range by construction.
    assert_eq!((points.len(), locked.len()), (wedges.points.len(), wedges.points.len()), "one per wedge");
    debug_assert!(wedges.triangles.as_flattened().iter().all(|&w| (w as usize) < points.len()));
    let options = match border {
        Border::Weighted => SimplifyOptions::ErrorAbsolute,
        Border::Kept => SimplifyOptions::ErrorAbsolute | SimplifyOptions::LockBorder,
    };
    let indices = wedges.triangles.as_flattened();
    let target = (3 * n_triangles).min(indices.len());
    let remaining = simplify_with_locks_decoder(indices, points, locked, target, error as f32, options, None);
    remaining.as_chunks().0.to_vec()
}

/// Converts positions to the single precision of the library.
pub(crate) fn to_single_precision(points: &[[f64; 3]]) -> Vec<[f32; 3]> {
    points.iter().map(|p| p.map(|x| x as f32)).collect()
}
