//! Counts of the elements and defects of a shape, which explain surprising results.

use super::adjacency::{triangles_at_vertices, try_n_components};
use super::{Adjacency, Mesh, Polygons, PreparedGeometry, Shape};
use crate::{Cancelled, Progress, parallel};
use nalgebra::Vector3;

/// Counts of the elements of a mesh, cloud or graph, and of possible defects.
///
/// Edges, components and isolated vertices are counted after welding.
#[derive(Clone, Debug, PartialEq)]
pub struct Health {
    /// Number of vertices, points or nodes of the shape.
    pub n_vertices: usize,
    /// Number of faces of the shape.
    pub n_faces: usize,
    /// Number of faces with more than three corners.
    pub n_polygons: usize,
    /// Number of distinct undirected edges of the faces, of the neighbor graph, or of the graph.
    pub n_edges: usize,
    /// Number of connected components of these edges, ignoring their direction; a vertex without edges is a
    /// component.
    pub n_components: usize,
    /// Number of edges with one face.
    pub n_boundary_edges: usize,
    /// Number of edges with three faces or more.
    pub n_non_manifold_edges: usize,
    /// Number of edges that two faces traverse in the same direction, so that their normals disagree.
    pub n_misoriented_edges: usize,
    /// Number of faces without area, up to rounding.
    pub n_zero_area_faces: usize,
    /// Number of faces with the same vertices as an earlier face.
    pub n_repeated_faces: usize,
    /// Number of vertices at the position of an earlier vertex.
    pub n_welded: usize,
    /// Number of welded vertices without neighbors, which keep their value in every band.
    pub n_isolated: usize,
    /// Number of vertices without a face.
    pub n_unreferenced: usize,
    /// Surface area in squared model units; 0 without faces.
    pub area: f64,
    /// Enclosed volume in cubed model units, if every edge has two consistently oriented faces.
    pub volume: Option<f64>,
    /// Euler characteristic V − E + F of the welded mesh without unreferenced vertices; `None` without faces.
    pub euler_characteristic: Option<i64>,
}

/// Number of faces or half-edges that a thread processes at a time.
const AT_A_TIME: usize = 1 << 13;

/// Counts the elements of the shape of a [`PreparedGeometry`], given the neighbors of a diffusion step. O(n log n).
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
pub fn health(
    geometry: &PreparedGeometry,
    neighbors: &Adjacency,
    progress: Progress<'_>,
) -> Result<Health, Cancelled> {
    let shape = geometry.shape();
    let mut health = Health {
        n_vertices: shape.n_vertices(),
        n_faces: 0,
        n_polygons: 0,
        n_edges: 0,
        n_components: try_n_components(neighbors, progress)?,
        n_boundary_edges: 0,
        n_non_manifold_edges: 0,
        n_misoriented_edges: 0,
        n_zero_area_faces: 0,
        n_repeated_faces: 0,
        n_welded: shape.n_vertices() - geometry.n_vertices(),
        n_isolated: (0..neighbors.n_rows()).filter(|&x| neighbors.row(x).is_empty()).count(),
        n_unreferenced: 0,
        area: 0.0,
        volume: None,
        euler_characteristic: None,
    };
    progress.check()?;
    match shape {
        Shape::Mesh(mesh) => count_faces(mesh, geometry, &mut health, progress)?,
        _ => health.n_edges = n_pairs(neighbors, progress)?,
    }
    Ok(health)
}

/// Number of pairs of vertices that are connected in one direction or in both.
fn n_pairs(neighbors: &Adjacency, progress: Progress<'_>) -> Result<usize, Cancelled> {
    let counts_here =
        |x: usize, y: usize| x < y || (x > y && neighbors.row(y).binary_search(&(x as u32)).is_err());
    let counts = parallel::try_map_chunks(
        neighbors.n_rows(),
        AT_A_TIME,
        progress,
        || (),
        |(), range| {
            let of = |x: usize| neighbors.row(x).iter().filter(|&&y| counts_here(x, y as usize)).count();
            range.map(of).sum::<usize>()
        },
    )?;
    Ok(counts.into_iter().sum())
}

fn count_faces(
    mesh: &Mesh,
    geometry: &PreparedGeometry,
    health: &mut Health,
    progress: Progress<'_>,
) -> Result<(), Cancelled> {
    let faces = mesh.faces();
    let count = |is_counted: &(dyn Fn(&[u32]) -> bool + Sync)| {
        parallel::try_map_chunks(
            faces.len(),
            AT_A_TIME,
            progress,
            || (),
            |(), range| range.filter(|&f| is_counted(faces.get(f))).count(),
        )
        .map(|counts| counts.iter().sum::<usize>())
    };
    health.n_faces = faces.len();
    health.n_polygons = count(&|face| face.len() > 3)?;
    health.n_zero_area_faces = count(&|face| has_no_area(face.iter().map(|&c| &mesh.points()[c as usize])))?;
    health.n_unreferenced = mesh.points().len() - n_named(mesh.points().len(), faces, |c| c, progress)?;
    let welded = geometry.vertex_map().as_slice();
    let class = |corner: u32| welded[corner as usize];
    health.n_repeated_faces = n_repeated(faces, class, progress)?;
    let edges = EdgeCounts::new(faces, class, progress)?;
    health.n_edges = edges.all;
    health.n_boundary_edges = edges.boundary;
    health.n_non_manifold_edges = edges.non_manifold;
    health.n_misoriented_edges = edges.misoriented;
    health.area = geometry.area_of(geometry.points());
    if edges.enclose_volume() {
        health.volume = Some(geometry.volume_of(geometry.points()));
    }
    if !faces.is_empty() {
        let n_used = n_named(geometry.n_vertices(), faces, class, progress)?;
        health.euler_characteristic = Some(n_used as i64 - health.n_edges as i64 + faces.len() as i64);
    }
    Ok(())
}

/// Number of the `n` vertices that are a corner of a face.
fn n_named(
    n: usize,
    faces: &Polygons,
    name: impl Fn(u32) -> u32,
    progress: Progress<'_>,
) -> Result<usize, Cancelled> {
    let mut is_named = vec![false; n];
    for corners in faces.corners().chunks(1 << 16) {
        progress.check()?;
        for &corner in corners {
            is_named[name(corner) as usize] = true;
        }
    }
    Ok(is_named.iter().filter(|&&named| named).count())
}

/// Number of faces with the same vertices as an earlier one.
fn n_repeated(
    faces: &Polygons,
    name: impl Fn(u32) -> u32 + Sync + Send,
    progress: Progress<'_>,
) -> Result<usize, Cancelled> {
    // Triangles are handled separately, because millions of small vectors also take time to free.
    let sorted = |f: usize| {
        let mut corners = faces.get(f).iter().map(|&c| name(c)).collect::<Vec<u32>>();
        corners.sort_unstable();
        corners
    };
    let is_triangle = |f: &usize| faces.get(*f).len() == 3;
    let of_triangle = |f: usize| {
        let face = faces.get(f);
        let mut corners = [face[0], face[1], face[2]].map(&name);
        corners.sort_unstable();
        corners
    };
    let chunks = parallel::try_map_chunks(
        faces.len(),
        AT_A_TIME,
        progress,
        || (),
        |(), range| {
            let triangles: Vec<[u32; 3]> = range.clone().filter(is_triangle).map(of_triangle).collect();
            let others: Vec<Vec<u32>> = range.filter(|f| !is_triangle(f)).map(sorted).collect();
            (triangles, others)
        },
    )?;
    let (mut triangles, mut others) = (Vec::new(), Vec::new());
    for (some, more) in chunks {
        triangles.extend(some);
        others.extend(more);
    }
    parallel::sort_unstable_by(&mut triangles, progress, Ord::cmp)?;
    parallel::sort_unstable_by(&mut others, progress, Ord::cmp)?;
    let repeated = triangles.windows(2).filter(|pair| pair[0] == pair[1]).count();
    Ok(repeated + others.windows(2).filter(|pair| pair[0] == pair[1]).count())
}

/// True if a mesh encloses a volume: every edge has two faces, which run along it in opposite directions. O(corners)
/// for triangles, on all threads.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode, encloses_volume};
/// let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// for (n_faces, is_closed) in [(4, true), (3, false)] {
///     let mesh = Mesh::new(points.to_vec(), Polygons::from_triangles(&faces[..n_faces]))?;
///     let geometry = PreparedGeometry::new(&Shape::Mesh(mesh), WeldMode::default(), Progress::none())?;
///     assert_eq!(encloses_volume(&geometry, Progress::none())?, is_closed);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn encloses_volume(geometry: &PreparedGeometry, progress: Progress<'_>) -> Result<bool, Cancelled> {
    let Shape::Mesh(mesh) = geometry.shape() else { return Ok(false) };
    let welded = geometry.vertex_map().as_slice();
    match geometry.faces().triangles() {
        Some(triangles) if triangles.len() == mesh.faces().len() => {
            edges_cancel(geometry.n_vertices(), triangles, progress)
        }
        // Faces with placeholders were removed from the geometry, but count here.
        _ => Ok(EdgeCounts::new(mesh.faces(), |c| welded[c as usize], progress)?.enclose_volume()),
    }
}

/// True if there is an edge, and each belongs to two triangles, once in each direction.
fn edges_cancel(n: usize, triangles: &[[u32; 3]], progress: Progress<'_>) -> Result<bool, Cancelled> {
    let at_vertex = triangles_at_vertices(n, triangles, progress)?;
    let lists = || (Vec::new(), Vec::new());
    let counts = parallel::try_map_chunks(n, AT_A_TIME, progress, lists, |(next, before), range| {
        let mut n_edges = Some(0_usize);
        for x in range {
            next.clear();
            before.clear();
            let around = at_vertex.row(x);
            for (k, &f) in around.iter().enumerate() {
                if k > 0 && around[k - 1] == f {
                    continue; // a triangle with a repeated corner is listed once for each of them
                }
                let triangle = triangles[f as usize];
                for corner in (0..3).filter(|&corner| triangle[corner] as usize == x) {
                    let is_other = |y: &u32| *y as usize != x;
                    next.extend(Some(triangle[(corner + 1) % 3]).filter(is_other));
                    before.extend(Some(triangle[(corner + 2) % 3]).filter(is_other));
                }
            }
            next.sort_unstable();
            before.sort_unstable();
            let cancels = next == before && next.windows(2).all(|pair| pair[0] < pair[1]);
            n_edges = n_edges.filter(|_| cancels).map(|n_edges| n_edges + next.len());
        }
        n_edges
    })?;
    Ok(counts.into_iter().sum::<Option<usize>>().is_some_and(|n_edges| n_edges > 0))
}

/// Numbers of edges by their faces.
struct EdgeCounts {
    all: usize,
    boundary: usize,
    non_manifold: usize,
    misoriented: usize,
}

impl EdgeCounts {
    /// True if every edge has two faces, which run along it in opposite directions.
    fn enclose_volume(&self) -> bool {
        self.all > 0 && self.boundary + self.non_manifold + self.misoriented == 0
    }

    /// Counts the edges of all faces by their number of faces.
    fn new(
        faces: &Polygons,
        name: impl Fn(u32) -> u32 + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        // Every edge of every face as (smaller end, larger end, ascending).
        let chunks = parallel::try_map_chunks(
            faces.len(),
            AT_A_TIME,
            progress,
            || (),
            |(), range| {
                let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * range.len());
                for face in range.map(|f| faces.get(f)).filter(|face| face.len() > 2) {
                    for k in 0..face.len() {
                        let (a, b) = (name(face[k]), name(face[(k + 1) % face.len()]));
                        if a != b {
                            edges.push((a.min(b), a.max(b), a < b));
                        }
                    }
                }
                edges
            },
        )?;
        let mut half_edges = Vec::with_capacity(chunks.iter().map(Vec::len).sum());
        for chunk in chunks {
            progress.check()?;
            half_edges.extend(chunk);
        }
        parallel::sort_unstable_by(&mut half_edges, progress, Ord::cmp)?;
        let mut counts = Self { all: 0, boundary: 0, non_manifold: 0, misoriented: 0 };
        for edge in half_edges.chunk_by(|e, f| (e.0, e.1) == (f.0, f.1)) {
            counts.all += 1;
            if counts.all.is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            match edge {
                [_] => counts.boundary += 1,
                [e, f] => counts.misoriented += usize::from(e.2 == f.2),
                _ => counts.non_manifold += 1,
            }
        }
        Ok(counts)
    }
}

/// True if the corners of a face span no area beyond rounding, or are fewer than three.
fn has_no_area<'a>(corners: impl ExactSizeIterator<Item = &'a [f64; 3]> + Clone) -> bool {
    let count = corners.len();
    let Some(first) = corners.clone().next().filter(|_| count > 2) else { return true };
    let origin = Vector3::from(*first);
    let around = corners.map(|p| Vector3::from(*p) - origin);
    let size = around.clone().map(|d| d.amax()).fold(0.0, f64::max);
    if size == 0.0 {
        return true;
    }
    let around: Vec<_> = around.map(|d| d / size).collect();
    let newell: Vector3<f64> = (0..count).map(|k| around[k].cross(&around[(k + 1) % count])).sum();
    newell.norm() <= 4.0 * f64::EPSILON * count as f64
}

impl Health {
    /// True if every edge has exactly two faces.
    pub fn is_closed(&self) -> bool {
        self.n_faces > 0 && self.n_boundary_edges == 0 && self.n_non_manifold_edges == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_counts_once_whichever_way_it_points() {
        // 0 ↔ 1, 1 → 2, 2 → 0; 3 has no edges.
        let directed = Adjacency::new(vec![0, 1, 3, 4, 4], vec![1, 0, 2, 0], 4).unwrap();
        assert_eq!(n_pairs(&directed, Progress::none()), Ok(3));
        let both = Adjacency::new(vec![0, 2, 4, 6], vec![1, 2, 0, 2, 0, 1], 3).unwrap();
        assert_eq!(n_pairs(&both, Progress::none()), Ok(3));
    }
}
