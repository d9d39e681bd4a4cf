//! Another mesh of the same surface.

use crate::{MeshParams, MeshTarget, SimplifyError, simplify_mesh};
use adwave::Progress;
use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::collections::HashMap;

/// Where an edge is cut: between this share of it and the rest.
const NEAREST_CUT: f64 = 0.3;
/// How far an old vertex moves into a triangle beside it at least and at most, as a share of the way along each side.
const MOVES: (f64, f64) = (0.05, 0.3);

/// A mesh of about as many vertices on the same surface, none of them where one was, and triangles that are not even: what another scan
/// of the same thing would give. Every edge is cut at a random place, every old vertex that is not on a border moves into a
/// triangle beside it, and edges are collapsed until there are as many vertices as before ([`simplify_mesh`]). The same seed gives
/// the same mesh. O(n log n).
///
/// # Errors
/// [`SimplifyError`] as for [`simplify_mesh`].
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
    let cut = cut(&geometry, &mut Pcg64Mcg::seed_from_u64(seed));
    let fine = Mesh::new(cut.points, Polygons::from_triangles(&cut.triangles))
        .map_err(|_| SimplifyError::NoSurface)?;
    let found = simplify_mesh(&fine, None, &MeshParams::new(MeshTarget::Vertices(n)), progress)?;
    let points = found.kept.iter().map(|&v| fine.points()[v as usize]).collect();
    Mesh::new(points, Polygons::from_triangles(&found.triangles)).map_err(|_| SimplifyError::NoSurface)
}

struct Cut {
    points: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// Every triangle in four, at random places of its edges, the old vertices moved.
fn cut(geometry: &PreparedGeometry, random: &mut Pcg64Mcg) -> Cut {
    let old = geometry.points();
    let mut points = old.to_vec();
    let mut number = |low: f64, high: f64| low + (high - low) * (random.next_u64() as f64 / u64::MAX as f64);
    // The vertex on each edge, and how many triangles the edge has.
    let mut on_edge: HashMap<(u32, u32), (u32, u32)> = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * geometry.triangles().len());
    // For each old vertex the cuts of its two edges in one of its triangles.
    let mut beside = vec![None; old.len()];
    for &[a, b, c] in geometry.triangles() {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            let entry = on_edge.entry((p.min(q), p.max(q))).or_insert_with(|| {
                let (from, to) = (old[p.min(q) as usize], old[p.max(q) as usize]);
                let t = number(NEAREST_CUT, 1.0 - NEAREST_CUT);
                points.push(std::array::from_fn(|k| (1.0 - t) * from[k] + t * to[k]));
                (points.len() as u32 - 1, 0)
            });
            entry.1 += 1;
            entry.0
        });
        triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        for (v, first, second) in [(a, ab, ca), (b, bc, ab), (c, ca, bc)] {
            beside[v as usize] = Some((first, second));
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
        let (Some((first, second)), false) = (beside[v], is_border[v]) else { continue };
        let (s, t) = (number(MOVES.0, MOVES.1), number(MOVES.0, MOVES.1));
        let (p, q) = (points[first as usize], points[second as usize]);
        points[v] = std::array::from_fn(|k| old[v][k] + s * (p[k] - old[v][k]) + t * (q[k] - old[v][k]));
    }
    Cut { points, triangles }
}
