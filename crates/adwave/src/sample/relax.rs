//! Improves the triangles of a closed surface by edge flips, tangential smoothing and projection back to f = 0, in
//! turn.

use super::implicit::{Implicit, V3};
use super::polygonize::SampledSurface;
use rayon::prelude::*;

/// Fraction of the way to the mean of its neighborhood that a vertex moves per round.
const SMOOTHING: f64 = 0.7;
/// Number of rounds of flips, smoothing and one projection step.
const ROUNDS: usize = 6;
/// Number of projection steps at the end, each a secant step along the normal.
const PROJECTION_STEPS: usize = 3;
/// Largest projection step relative to the vertex's mean edge length, so that no face turns over.
const STEP_LIMIT: f64 = 0.3;
/// Number of flip sweeps per round.
const SWEEPS: usize = 3;
/// Cosine of the dihedral angle (about 53°) beyond which an edge is not flipped, before or after.
const FLAT_COSINE: f64 = 0.6;

/// Improves the triangles and moves every vertex to f = 0. The numbers of vertices and faces, the genus and the
/// orientation do not change. O(vertices).
pub(super) fn relax<F: Implicit>(field: &F, surface: &mut SampledSurface) {
    let mut opposite = opposite_corners(&surface.triangles);
    for _ in 0..ROUNDS {
        flip_edges(surface, &mut opposite);
        let stars = Stars::new(surface);
        surface.points = (0..surface.points.len())
            .into_par_iter()
            .map(|v| {
                let star = stars.measure(surface, v);
                let p = surface.points[v];
                let pull = (star.center - p) * SMOOTHING;
                let p = p + pull - star.normal * pull.dot(&star.normal);
                let reach = STEP_LIMIT * star.mean_edge;
                p - star.normal * field.value(p).clamp(-reach, reach)
            })
            .collect();
    }
    let stars = Stars::new(surface);
    surface.points = (0..surface.points.len())
        .into_par_iter()
        .map(|v| {
            let star = stars.measure(surface, v);
            project(field, surface.points[v], star.normal, STEP_LIMIT * star.mean_edge)
        })
        .collect();
    flip_edges(surface, &mut opposite);
}

/// The root of f on the line through `p` along `direction`, at most `reach` away, by the secant method.
fn project<F: Implicit>(field: &F, p: V3, direction: V3, reach: f64) -> V3 {
    let (mut s0, mut f0) = (0.0, field.value(p));
    let mut s1 = (-f0).clamp(-reach, reach);
    for _ in 0..PROJECTION_STEPS {
        let f1 = field.value(p + direction * s1);
        let slope = (f1 - f0) / (s1 - s0);
        // Away from a simple root the slope of a distance function, 1, is the better estimate.
        let slope = if slope.is_finite() && slope > 0.25 { slope } else { 1.0 };
        let next = (s1 - f1 / slope).clamp(-reach, reach);
        (s0, f0, s1) = (s1, f1, next);
        if s0 == s1 {
            break;
        }
    }
    p + direction * s1
}

/// Faces at each vertex: `corners[starts[v]..starts[v + 1]]` are corner numbers 3·face + k with value v.
struct Stars {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

/// Averages over the faces around one vertex.
struct Star {
    /// Mean of the faces' centroids, each weighted by its area.
    center: V3,
    /// Unit normal, faces weighted by area.
    normal: V3,
    mean_edge: f64,
}

impl Stars {
    fn new(surface: &SampledSurface) -> Self {
        let mut starts = vec![0_u32; surface.points.len() + 1];
        let all = surface.triangles.as_flattened();
        for &v in all {
            starts[v as usize + 1] += 1;
        }
        for v in 1..starts.len() {
            starts[v] += starts[v - 1];
        }
        let mut next = starts.clone();
        let mut corners = vec![0_u32; all.len()];
        for (corner, &v) in all.iter().enumerate() {
            corners[next[v as usize] as usize] = corner as u32;
            next[v as usize] += 1;
        }
        Self { starts, corners }
    }

    fn measure(&self, surface: &SampledSurface, v: usize) -> Star {
        let mut weighted = V3::zeros();
        let mut normal = V3::zeros();
        let mut total_area = 0.0;
        let mut total_edge = 0.0;
        let corners = &self.corners[self.starts[v] as usize..self.starts[v + 1] as usize];
        for &corner in corners {
            let [a, b, c] = surface.triangles[corner as usize / 3].map(|v| surface.points[v as usize]);
            let area_normal = (b - a).cross(&(c - a));
            let area = area_normal.norm();
            weighted += (a + b + c) * (area / 3.0);
            total_area += area;
            normal += area_normal;
            let next = surface.triangles[corner as usize / 3][(corner as usize + 1) % 3];
            total_edge += (surface.points[next as usize] - surface.points[v]).norm();
        }
        let center = if total_area > 0.0 { weighted / total_area } else { surface.points[v] };
        let normal = normal.try_normalize(0.0).unwrap_or_else(V3::zeros);
        Star { center, normal, mean_edge: total_edge / corners.len().max(1) as f64 }
    }
}

/// For each corner 3·face + k, the corner across the opposite edge.
///
/// # Panics
/// If an edge does not have exactly two faces.
pub(super) fn opposite_corners(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut sides: Vec<(u64, u32)> = (0..3 * triangles.len())
        .into_par_iter()
        .map(|corner| {
            let t = triangles[corner / 3];
            let (a, b) = (t[(corner + 1) % 3], t[(corner + 2) % 3]);
            (u64::from(a.min(b)) << 32 | u64::from(a.max(b)), corner as u32)
        })
        .collect();
    sides.par_sort_unstable();
    let mut opposite = vec![0; sides.len()];
    for pair in sides.chunks(2) {
        assert!(pair.len() == 2 && pair[0].0 == pair[1].0, "a closed surface has two faces at each edge");
        opposite[pair[0].1 as usize] = pair[1].1;
        opposite[pair[1].1 as usize] = pair[0].1;
    }
    opposite
}

/// Flips edges whose two opposite angles sum to more than 180°, in at most [`SWEEPS`] sweeps. The order is that of
/// the faces, on one thread, because each flip depends on those before.
fn flip_edges(surface: &mut SampledSurface, opposite: &mut [u32]) {
    for _ in 0..SWEEPS {
        let wanted: Vec<u32> = (0..opposite.len() as u32)
            .into_par_iter()
            .filter(|&corner| {
                corner < opposite[corner as usize] && improves(surface, opposite, corner as usize)
            })
            .collect();
        let mut n_flips = 0_usize;
        for corner in wanted {
            let corner = corner as usize;
            if improves(surface, opposite, corner) && !has_edge(surface, opposite, corner) {
                flip(surface, opposite, corner);
                n_flips += 1;
            }
        }
        if n_flips == 0 {
            break;
        }
    }
}

/// The ends a, b of the edge and the two corners across it: c at `corner`, d beyond; a → b counter-clockwise in the
/// face of c.
fn diamond(surface: &SampledSurface, opposite: &[u32], corner: usize) -> [u32; 4] {
    let (face, k) = (surface.triangles[corner / 3], corner % 3);
    let beyond = opposite[corner] as usize;
    [face[(k + 1) % 3], face[(k + 2) % 3], face[k], surface.triangles[beyond / 3][beyond % 3]]
}

fn improves(surface: &SampledSurface, opposite: &[u32], corner: usize) -> bool {
    let [a, b, c, d] = diamond(surface, opposite, corner).map(|v| surface.points[v as usize]);
    // cos γ sin δ + sin γ cos δ < 0, without a division: the Delaunay criterion for a diamond unfolded into a
    // plane.
    let (ca, cb, da, db) = (a - c, b - c, a - d, b - d);
    let (cross_c, cross_d) = (ca.cross(&cb), db.cross(&da));
    let sum = ca.dot(&cb) * cross_d.norm() + cross_c.norm() * da.dot(&db);
    // Rounding must not make two equally good diagonals alternate.
    let scale = ca.norm() * cb.norm() * da.norm() * db.norm();
    if sum >= -1e-9 * scale {
        return false;
    }
    let flat = |m: V3, n: V3| m.dot(&n) > FLAT_COSINE * m.norm() * n.norm();
    let (after_a, after_b) = ((d - a).cross(&(c - a)), (c - b).cross(&(d - b)));
    flat(cross_c, cross_d) && flat(after_a, after_b) && flat(after_a, cross_c + cross_d)
}

/// True if the two vertices that the flipped edge would connect already share an edge.
fn has_edge(surface: &SampledSurface, opposite: &[u32], corner: usize) -> bool {
    let [_, _, c, d] = diamond(surface, opposite, corner);
    let mut at = corner;
    // Around c: across the edge from c to the next corner, the next face of the fan has c after the corner across.
    for _ in 0..surface.triangles.len() {
        let k = at % 3;
        let face = at - k;
        if surface.triangles[face / 3][(k + 1) % 3] == d {
            return true;
        }
        let across = opposite[face + (k + 2) % 3] as usize;
        let next_face = across - across % 3;
        // The shared edge runs c → next here and next → c there, so c follows the corner across by two.
        at = next_face + (across + 2 - next_face) % 3;
        debug_assert_eq!(surface.triangles[at / 3][at % 3], c);
        if at == corner {
            return false;
        }
    }
    true
}

/// Replaces faces (c, a, b), (d, b, a) by (c, a, d), (d, b, c).
fn flip(surface: &mut SampledSurface, opposite: &mut [u32], corner: usize) {
    let beyond = opposite[corner] as usize;
    let [a, b, c, d] = diamond(surface, opposite, corner);
    let at = |base: usize, k: usize| base - base % 3 + (base + k) % 3;
    // Corners across the edges b–c (it faces a), and a–d (it faces b beyond).
    let over_bc = opposite[at(corner, 1)];
    let over_ad = opposite[at(beyond, 1)];
    let rotate = |base: usize, first: u32, second: u32, third: u32| {
        let mut face = [0; 3];
        face[base % 3] = first;
        face[(base + 1) % 3] = second;
        face[(base + 2) % 3] = third;
        face
    };
    surface.triangles[corner / 3] = rotate(corner, c, a, d);
    surface.triangles[beyond / 3] = rotate(beyond, d, b, c);
    let mut tie = |x: usize, y: u32| {
        opposite[x] = y;
        opposite[y as usize] = x as u32;
    };
    // In (c, a, d) corner c faces a–d; in (d, b, c) corner d faces b–c; corners a and b face the new edge c–d.
    tie(corner, over_ad);
    tie(beyond, over_bc);
    tie(at(corner, 1), at(beyond, 1) as u32);
}
