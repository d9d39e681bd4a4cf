//! Cotangent weights of triangles.

use adwave::vector::{cross, dot, norm, subtract};

/// Computes the weight `w = ½ cot(opposite angle)` of each side of each triangle (`pinkall1993`). A side of several
/// triangles is listed once per triangle; triangles without area are skipped.
pub(super) fn cotangent_weights(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<(u32, u32, f64)> {
    let mut weights = Vec::with_capacity(3 * triangles.len());
    for &t in triangles {
        let p = t.map(|v| points[v as usize]);
        for k in 0..3 {
            let (a, b) = (subtract(&p[(k + 1) % 3], &p[k]), subtract(&p[(k + 2) % 3], &p[k]));
            let doubled_area = norm(&cross(&a, &b));
            if doubled_area > f64::EPSILON * norm(&a) * norm(&b) {
                weights.push((t[(k + 1) % 3], t[(k + 2) % 3], 0.5 * dot(&a, &b) / doubled_area));
            }
        }
    }
    weights
}
