//! Seams: open borders whose edges nearly coincide, because a program rounded the copies of a vertex differently.
//!
//! Vertices at exactly equal positions are welded before. Here two edges of open borders are matched if they run in
//! opposite directions and their ends are within a tolerance; the ends become one vertex each. Nothing inside a surface
//! and no two borders side by side in the same direction are joined, so that sheets stay apart.

use super::face_flags::{FaceFlags, visit_edges};
use super::{DisjointSets, Polygons, squared_distance};
use crate::{Cancelled, Progress, parallel};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use serde::Serialize;

/// Tolerance in steps of 32-bit floats at the largest coordinate of a vertex: the rounding error of a few products of
/// matrices.
const SINGLE_STEPS: f64 = 4.0;

/// Smallest tolerance, in shortest edges at a vertex.
const LEAST_SHARE: f64 = 1e-6;

/// Largest tolerance, in shortest edges at a vertex.
const MOST_SHARE: f64 = 1e-3;

/// Largest tolerance that is asked for, in shortest edges at a vertex: more would join the ends of an edge.
const MOST_ASKED_SHARE: f64 = 0.49;

/// Vertices that were welded although their positions differ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SeamWeld {
    /// Number of positions that became equal to another one.
    pub n_vertices: usize,
    /// Largest distance between matched vertices, in model units.
    pub distance: f64,
}

/// Welding of vertices along seams.
pub(super) struct SeamMatches {
    /// Smallest vertex of the set that each vertex belongs to.
    pub(super) roots: Vec<u32>,
    pub(super) weld: SeamWeld,
}

/// Directed edge of a face that no face has in the opposite direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct BorderEdge {
    start: u32,
    end: u32,
}

/// Matches the open borders of a mesh with different `points`. `tolerance` is in model units; by default it is four
/// steps of 32-bit floats or a millionth of the shortest edge at a vertex, and at most a thousandth of it. `None` if
/// nothing matches. O(corners) for a mesh without borders.
pub(super) fn match_seams(
    points: &[[f64; 3]],
    faces: &Polygons,
    flags: &FaceFlags,
    tolerance: Option<f64>,
    progress: Progress<'_>,
) -> Result<Option<SeamMatches>, Cancelled> {
    let FaceFlags { is_open, is_used } = flags;
    if !is_open.contains(&true) && !is_used.contains(&false) {
        return Ok(None);
    }
    let mut sets = DisjointSets::new(points.len());
    if let Some(edges) = border_edges(faces, is_open, progress)? {
        let tolerances = Tolerances::new(points, faces, is_open, tolerance);
        if let Some(near) = NearVertices::new(points, &edges, &tolerances, progress)? {
            for (one, other) in matched_edges(&edges, &near, progress)? {
                sets.join(one.start, other.end);
                sets.join(one.end, other.start);
            }
        }
    }
    for (unused, used) in match_unused(points, faces, is_used, tolerance, progress)? {
        sets.join(unused, used);
    }
    let mut roots: Vec<u32> = (0..points.len() as u32).map(|x| sets.root(x)).collect();
    if roots.iter().enumerate().all(|(x, &root)| x == root as usize) {
        return Ok(None);
    }
    split_collapsing_sets(&mut roots, faces);
    let mut weld = SeamWeld { n_vertices: 0, distance: 0.0 };
    for (x, &root) in roots.iter().enumerate().filter(|(x, root)| *x != **root as usize) {
        weld.n_vertices += 1;
        weld.distance = weld.distance.max(super::distance(&points[x], &points[root as usize]));
    }
    Ok((weld.n_vertices > 0).then_some(SeamMatches { roots, weld }))
}

/// True if edges of faces do not cancel at some vertex: the mesh has a border, or faces that disagree on the
/// orientation. O(corners).
pub(super) fn is_open(n: usize, faces: &Polygons) -> bool {
    FaceFlags::new(n, faces).is_open.contains(&true)
}

/// Edges of open borders in ascending order; `None` if there are none.
fn border_edges(
    faces: &Polygons,
    is_open: &[bool],
    progress: Progress<'_>,
) -> Result<Option<Vec<BorderEdge>>, Cancelled> {
    progress.check()?;
    let mut edges = Vec::new();
    visit_edges(faces, |[start, end]| {
        if is_open[start as usize] && is_open[end as usize] {
            edges.push(BorderEdge { start, end });
        }
    });
    parallel::sort_unstable_by(&mut edges, progress, Ord::cmp)?;
    let is_border = |k: usize| {
        let edge = edges[k];
        let is_repeated =
            (k > 0 && edges[k - 1] == edge) || edges.get(k + 1).is_some_and(|next| *next == edge);
        !is_repeated && edges.binary_search(&BorderEdge { start: edge.end, end: edge.start }).is_err()
    };
    let borders: Vec<BorderEdge> = (0..edges.len()).filter(|&k| is_border(k)).map(|k| edges[k]).collect();
    Ok((!borders.is_empty()).then_some(borders))
}

/// Distances within which vertices may match.
struct Tolerances {
    limits: Vec<f64>,
}

impl Tolerances {
    fn new(points: &[[f64; 3]], faces: &Polygons, is_open: &[bool], asked: Option<f64>) -> Self {
        let mut limits = vec![f64::INFINITY; points.len()];
        visit_edges(faces, |edge| {
            let [start, end] = edge.map(|x| x as usize);
            if is_open[start] || is_open[end] {
                let length = super::distance(&points[start], &points[end]);
                limits[start] = limits[start].min(length);
                limits[end] = limits[end].min(length);
            }
        });
        for (shortest, p) in limits.iter_mut().zip(points) {
            let largest = p.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
            *shortest = match asked {
                Some(tolerance) => tolerance.min(MOST_ASKED_SHARE * *shortest),
                None => (SINGLE_STEPS * largest * f64::from(f32::EPSILON))
                    .clamp(LEAST_SHARE * *shortest, MOST_SHARE * *shortest),
            };
        }
        Self { limits }
    }

    fn are_near(&self, points: &[[f64; 3]], x: u32, y: u32) -> bool {
        let tolerance = self.limits[x as usize].min(self.limits[y as usize]);
        squared_distance(&points[x as usize], &points[y as usize]) <= tolerance * tolerance
    }
}

/// Vertices of open borders that are within their tolerances of each vertex.
struct NearVertices {
    /// Vertices of borders, ascending.
    vertices: Vec<u32>,
    /// Others near each of them, ascending; the vertex itself is left out.
    others: Vec<Vec<u32>>,
}

impl NearVertices {
    /// `None` if no vertex is near another one.
    fn new(
        points: &[[f64; 3]],
        edges: &[BorderEdge],
        tolerances: &Tolerances,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let mut vertices: Vec<u32> = edges.iter().flat_map(|edge| [edge.start, edge.end]).collect();
        parallel::sort_unstable_by(&mut vertices, progress, Ord::cmp)?;
        vertices.dedup();
        let scale = unit_scale(points);
        let own: Vec<[f64; 3]> = vertices.iter().map(|&x| points[x as usize].map(|c| c * scale)).collect();
        let tree: ImmutableKdTree<f64, 3> =
            ImmutableKdTree::new_from_slice(&own).expect("the tree of finitely many finite points");
        let others: Vec<Vec<u32>> = parallel::try_collect(vertices.len(), progress, |k| {
            let x = vertices[k];
            let reach = tolerances.limits[x as usize] * scale * (1.0 + 1e-9);
            let found =
                tree.query(&own[k]).within::<SquaredEuclidean<f64>>(reach * reach).unsorted().execute();
            let mut near: Vec<u32> = found
                .into_iter()
                .map(|found| vertices[found.item as usize])
                .filter(|&y| y != x && tolerances.are_near(points, x, y))
                .collect();
            near.sort_unstable();
            near
        })?;
        let is_any = others.iter().any(|near| !near.is_empty());
        Ok(is_any.then_some(Self { vertices, others }))
    }

    /// Vertices near `x`, itself first.
    fn list(&self, x: u32) -> impl Iterator<Item = u32> + '_ {
        let others = self.vertices.binary_search(&x).map_or(&[][..], |k| &self.others[k][..]);
        std::iter::once(x).chain(others.iter().copied())
    }
}

/// Power of two by which the largest coordinate becomes about 1, so that squares neither overflow nor vanish.
fn unit_scale(points: &[[f64; 3]]) -> f64 {
    let largest = points.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    if largest == 0.0 { 1.0 } else { largest.log2().floor().clamp(-1000.0, 1000.0).exp2().recip() }
}

/// Vertices of no face, each with a vertex of a face within its tolerance: such copies, as exporters leave them at the
/// poles of a sphere, move along.
fn match_unused(
    points: &[[f64; 3]],
    faces: &Polygons,
    is_used: &[bool],
    tolerance: Option<f64>,
    progress: Progress<'_>,
) -> Result<Vec<(u32, u32)>, Cancelled> {
    let numbered = |flag: bool| (0..points.len() as u32).filter(|&x| is_used[x as usize] == flag).collect();
    let (used, unused): (Vec<u32>, Vec<u32>) = (numbered(true), numbered(false));
    if used.is_empty() || unused.is_empty() {
        return Ok(Vec::new());
    }
    let tolerances = Tolerances::new(points, faces, is_used, tolerance);
    let scale = unit_scale(points);
    let scaled = |x: u32| points[x as usize].map(|c| c * scale);
    let own: Vec<[f64; 3]> = used.iter().map(|&x| scaled(x)).collect();
    let tree: ImmutableKdTree<f64, 3> =
        ImmutableKdTree::new_from_slice(&own).expect("the tree of finitely many finite points");
    let nearest: Vec<Option<(u32, u32)>> = parallel::try_collect(unused.len(), progress, |k| {
        let x = unused[k];
        let found = tree.query(&scaled(x)).nearest_one::<SquaredEuclidean<f64>>().execute();
        let y = used[found.item as usize];
        let distance = super::distance(&points[x as usize], &points[y as usize]);
        (distance <= tolerances.limits[y as usize]).then_some((x, y))
    })?;
    Ok(nearest.into_iter().flatten().collect())
}

/// Pairs of edges that run in opposite directions between ends that are near each other, and have no other partner.
fn matched_edges(
    edges: &[BorderEdge],
    near: &NearVertices,
    progress: Progress<'_>,
) -> Result<Vec<(BorderEdge, BorderEdge)>, Cancelled> {
    let mut by_end: Vec<u32> = (0..edges.len() as u32).collect();
    parallel::sort_unstable_by(&mut by_end, progress, |&a, &b| {
        edges[a as usize].end.cmp(&edges[b as usize].end).then(a.cmp(&b))
    })?;
    let ending_in = |x: u32| {
        let start = by_end.partition_point(|&e| edges[e as usize].end < x);
        by_end[start..].iter().copied().take_while(move |&e| edges[e as usize].end == x)
    };
    // The only partner of each edge.
    let partners: Vec<Option<u32>> = parallel::try_collect(edges.len(), progress, |k| {
        let edge = edges[k];
        let mut found = near.list(edge.start).flat_map(ending_in).filter(|&other| {
            let start = edges[other as usize].start;
            other as usize != k && near.list(edge.end).any(|y| y == start)
        });
        let first = found.next()?;
        found.next().is_none().then_some(first)
    })?;
    let is_mutual = |(k, partner): &(usize, u32)| partners[*partner as usize] == Some(*k as u32);
    Ok(partners
        .iter()
        .enumerate()
        .filter_map(|(k, partner)| Some((k, (*partner)?)))
        .filter(|(k, partner)| *k < *partner as usize)
        .filter(is_mutual)
        .map(|(k, partner)| (edges[k], edges[partner as usize]))
        .collect())
}

/// Splits the sets that would make two corners of a face one vertex.
fn split_collapsing_sets(roots: &mut [u32], faces: &Polygons) {
    let mut collapsing = Vec::new();
    visit_edges(faces, |[start, end]| {
        let root = roots[start as usize];
        if root == roots[end as usize] {
            collapsing.push(root);
        }
    });
    collapsing.sort_unstable();
    collapsing.dedup();
    if collapsing.is_empty() {
        return;
    }
    for (x, root) in (0..).zip(roots) {
        if collapsing.binary_search(root).is_ok() {
            *root = x;
        }
    }
}
