//! Remeshing: another mesh of the same surface.

use crate::{MeshParams, MeshTarget, SimplifyError, simplify_mesh};
use adwave::Progress;
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::collections::HashMap;

/// Smallest distance of a cut from an end of its edge, relative to the edge.
const MIN_CUT: f64 = 0.3;
/// Bounds of the movement of a vertex into an adjacent triangle, as a share of each side of its corner piece.
const MOVE_RANGE: std::ops::Range<f64> = 0.05..0.3;

/// Remeshes a surface with about the same number of vertices, all at new positions, and irregular triangles, like
/// another scan of the same object.
///
/// Every edge is split at a random point, every inner vertex moves into an adjacent triangle, and edges are collapsed
/// to the former number of vertices ([`simplify_mesh`]). The same seed gives the same mesh. O(n log n).
///
/// # Errors
/// Returns a [`SimplifyError`] as for [`simplify_mesh`].
///
/// ```
/// use adwave::Progress;
/// use adwave::sample::Sample;
/// use adwave::shape::Mesh;
/// use adwave_simplify::resample_mesh;
/// let sphere = Sample::from_name("sphere", Some(2000))?;
/// let mesh = Mesh::new(sphere.points.clone(), sphere.faces)?;
/// let again = resample_mesh(&mesh, 1, Progress::none())?;
/// assert!((again.points().len() as f64 / 2000.0 - 1.0).abs() < 0.05);
/// assert!(again.points().iter().all(|p| !sphere.points.contains(p)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn resample_mesh(mesh: &Mesh, seed: u64, progress: Progress<'_>) -> Result<Mesh, SimplifyError> {
    let geometry = PreparedGeometry::new(&Shape::Mesh(mesh.clone()), WeldMode::EqualPositions, progress)?;
    let n = geometry.n_vertices();
    let split = split_triangles(&geometry, &mut Pcg64Mcg::seed_from_u64(seed));
    let fine = Mesh::new(split.points, Polygons::from_triangles(&split.triangles))
        .map_err(|_| SimplifyError::NoSurface)?;
    let simplified = simplify_mesh(&fine, None, &MeshParams::new(MeshTarget::Vertices(n)), progress)?;
    let points = simplified.kept.iter().map(|&v| fine.points()[v as usize]).collect();
    Mesh::new(points, Polygons::from_triangles(&simplified.triangles)).map_err(|_| SimplifyError::NoSurface)
}

/// Mesh in which every triangle is split into four.
struct SplitMesh {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// Splits every triangle into four at random points of its edges, and moves the old vertices.
fn split_triangles(geometry: &PreparedGeometry, random: &mut Pcg64Mcg) -> SplitMesh {
    let old = geometry.points();
    let mut points = old.to_vec();
    let mut number = |low: f64, high: f64| low + (high - low) * (random.next_u64() as f64 / u64::MAX as f64);
    // The new vertex of each edge, and its number of triangles.
    let mut on_edge: HashMap<(u32, u32), (u32, u32)> = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * geometry.triangles().len());
    // The new vertices on two edges of each old vertex, in one of its triangles.
    let mut adjacent_cuts = vec![None; old.len()];
    for &[a, b, c] in geometry.triangles() {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            let entry = on_edge.entry((p.min(q), p.max(q))).or_insert_with(|| {
                let (from, to) = (old[p.min(q) as usize], old[p.max(q) as usize]);
                let t = number(MIN_CUT, 1.0 - MIN_CUT);
                points.push(std::array::from_fn(|k| (1.0 - t) * from[k] + t * to[k]));
                (points.len() as u32 - 1, 0)
            });
            entry.1 += 1;
            entry.0
        });
        triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        for (v, first, second) in [(a, ab, ca), (b, bc, ab), (c, ca, bc)] {
            adjacent_cuts[v as usize] = Some((first, second));
        }
    }
    let mut is_border = vec![false; old.len()];
    for (&(p, q), &(_, n_triangles)) in &on_edge {
        if n_triangles != 2 {
            is_border[p as usize] = true;
            is_border[q as usize] = true;
        }
    }
    for v in 0..old.len() {
        let (Some((first, second)), false) = (adjacent_cuts[v], is_border[v]) else { continue };
        let (s, t) = (number(MOVE_RANGE.start, MOVE_RANGE.end), number(MOVE_RANGE.start, MOVE_RANGE.end));
        let (p, q) = (points[first as usize], points[second as usize]);
        points[v] = std::array::from_fn(|k| old[v][k] + s * (p[k] - old[v][k]) + t * (q[k] - old[v][k]));
    }
    SplitMesh { points, triangles }
}
