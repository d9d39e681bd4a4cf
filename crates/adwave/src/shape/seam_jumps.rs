//! Fields that jump between the two sides of a seam.

use super::{PreparedGeometry, Shape};

/// Difference between the sides of a seam, in mean differences along the edges beside it, beyond which a field jumps
/// there.
const JUMP: f64 = 4.0;

/// Largest share of welded vertices with several members for which they form seams; with more of them the mesh is a
/// soup of triangles.
const MOST_AT_SEAMS: f64 = 0.34;

/// Difference relative to the largest value that is rounding.
const ROUNDING: f64 = 1e-9;

/// Jumps of a field at seams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamJumps {
    /// Number of places at which the field jumps.
    pub n_places: usize,
    /// Median jump, in the unit of the field.
    pub size: f64,
}

/// Jumps of a field (n_vertices × n_channels, row-major) where vertices of a mesh were welded; `None` if it does not
/// jump there, and for shapes without faces.
///
/// A field jumps if, at more than half of the places where welded vertices differ in a channel, they differ by more
/// than 4 times the change of the field along the edges of their own faces. Noise is no jump, because it is no larger
/// across a seam than along it. A mesh of which most vertices were welded, such as one of single triangles, has no
/// seams. O(n).
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode, jumps_at_seams};
/// // Two strips of 6 squares; their vertices on x = 1 are there twice.
/// let strip = |x: f64| (0..7).flat_map(move |k| [0.0, 0.5, 1.0].map(|dx| [x + dx, f64::from(k), 0.0]));
/// let points: Vec<[f64; 3]> = strip(0.0).chain(strip(1.0)).collect();
/// let corners = (0..12_u32).flat_map(|k| [0, 1].map(|c| 21 * (k / 6) + 3 * (k % 6) + c));
/// let faces: Vec<[u32; 3]> = corners.flat_map(|v| [[v, v + 1, v + 4], [v, v + 4, v + 3]]).collect();
/// let mesh = Mesh::new(points, Polygons::from_triangles(&faces))?;
/// let geometry = PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none())?;
/// let field = |jump: f64| (0..42).map(|v| if v < 21 { 10.0 } else { 10.0 + jump }).collect::<Vec<f64>>();
/// assert_eq!(jumps_at_seams(&geometry, &field(10.0), 1).map(|jumps| (jumps.n_places, jumps.size)), Some((7, 10.0)));
/// assert_eq!(jumps_at_seams(&geometry, &field(0.0), 1), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// Unless there is one row per vertex.
pub fn jumps_at_seams(geometry: &PreparedGeometry, values: &[f64], n_channels: usize) -> Option<SeamJumps> {
    let Shape::Mesh(mesh) = geometry.shape() else { return None };
    let map = geometry.vertex_map();
    let n = map.n_vertices();
    assert_eq!(values.len(), n * n_channels, "one row per vertex");
    if map.n_welded() == n {
        return None;
    }
    let mut n_members = vec![0_u32; map.n_welded()];
    map.as_slice().iter().for_each(|&x| n_members[x as usize] += 1);
    let n_seams = n_members.iter().filter(|&&members| members > 1).count();
    if n_seams as f64 > MOST_AT_SEAMS * map.n_welded() as f64 {
        return None;
    }
    (0..n_channels).find_map(|c| {
        let value = |v: usize| values[v * n_channels + c];
        let largest = (0..n).map(value).filter(|f| f.is_finite()).fold(0.0, |most: f64, f| most.max(f.abs()));
        let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; map.n_welded()];
        for v in (0..n).filter(|&v| value(v).is_finite()) {
            let [low, high] = &mut range[map.welded(v)];
            (*low, *high) = (low.min(value(v)), high.max(value(v)));
        }
        let mut along = vec![[0.0; 2]; map.n_welded()];
        for face in mesh.faces().iter() {
            for (k, &v) in face.iter().enumerate() {
                let (u, v) = (face[(k + 1) % face.len()] as usize, v as usize);
                let change = (value(u) - value(v)).abs();
                for x in [map.welded(u), map.welded(v)] {
                    if change.is_finite() {
                        along[x] = [along[x][0] + change, along[x][1] + 1.0];
                    }
                }
            }
        }
        let differs = |x: &usize| n_members[*x] > 1 && range[*x][1] - range[*x][0] > ROUNDING * largest;
        let places: Vec<usize> = (0..map.n_welded()).filter(differs).collect();
        let apart = |x: usize| range[x][1] - range[x][0];
        let is_jump = |x: &usize| apart(*x) * along[*x][1] > JUMP * along[*x][0];
        let mut sizes: Vec<f64> = places.iter().copied().filter(|x| is_jump(x)).map(apart).collect();
        if 2 * sizes.len() <= places.len() {
            return None;
        }
        let middle = sizes.len() / 2;
        let size = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        Some(SeamJumps { n_places: sizes.len(), size })
    })
}
