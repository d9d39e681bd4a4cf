//! Simplification of meshes: within a largest distance, or to a number of vertices.

use crate::appearance::Appearance;
use crate::colors::WedgeColors;
use crate::connectivity::Turning;
use crate::deviation::{SurfaceView, measure_original, measure_simplified, vertex_areas};
use crate::parts::{CollapseInput, DistanceLimit};
use crate::proof::ROUNDING;
use crate::provenance;
use crate::surface::{StartedSurface, TriangleSurface};
use crate::wedges::{Parts, Wedges, rotate_to_smallest};
use crate::{Deviation, OneSided, SimplifyError};
use adwave::shape::{Mesh, VertexMap, WeldMode};
use adwave::{Cancelled, Progress};
use std::sync::OnceLock;
use std::time::Instant;

/// Target of a simplification.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshTarget {
    /// Largest distance of any point of either surface from the other, in model units; the result has as few vertices
    /// as are found.
    Error(f64),
    /// Number of vertices.
    Vertices(usize),
    /// Share of the welded vertices of the triangles, in (0, 1].
    Ratio(f64),
}

/// Treatment of the borders of an open mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Border {
    /// Borders are simplified along themselves, and contribute to the error.
    #[default]
    Weighted,
    /// Border vertices are kept.
    Kept,
}

/// Options of a simplification.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MeshParams {
    /// Target.
    pub target: MeshTarget,
    /// Treatment of borders.
    pub border: Border,
    /// True for a measured [`SimplifiedMesh::deviation`], which takes a third more time and more than twice the memory.
    pub is_measured: bool,
    /// True for [`SimplifiedMesh::faces`] that are the nearest ones.
    pub has_nearest_faces: bool,
}

impl MeshParams {
    /// Creates options for a target, with weighted borders, a measured deviation and nearest faces.
    pub fn new(target: MeshTarget) -> Self {
        Self { target, border: Border::default(), is_measured: true, has_nearest_faces: true }
    }

    /// Sets whether the deviation is measured.
    #[must_use]
    pub fn with_measure(self, is_measured: bool) -> Self {
        Self { is_measured, ..self }
    }

    /// Sets whether the nearest face of the original is found for each triangle. Without attributes of faces nobody asks
    /// for it.
    #[must_use]
    pub fn with_nearest_faces(self, has_nearest_faces: bool) -> Self {
        Self { has_nearest_faces, ..self }
    }

    /// Sets the treatment of borders.
    #[must_use]
    pub fn with_border(self, border: Border) -> Self {
        Self { border, ..self }
    }
}

/// Reason why the simplification ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// The target was reached.
    Reached,
    /// The target allows no vertex to be dropped; the result is the original.
    Unchanged,
    /// More vertices than requested are left: every further collapse would change the topology, close a border or a
    /// seam, or move a fixed vertex (a junction of seams, a vertex of a kept border).
    Stuck,
}

/// A mesh with fewer vertices.
#[derive(Clone, Debug)]
pub struct SimplifiedMesh {
    /// Indices of the kept vertices of the original, increasing.
    pub kept: Vec<u32>,
    /// Triangles as indices into `kept`.
    pub triangles: Vec<[u32; 3]>,
    /// Corner of the original that each corner continues, as its number among the corners of all faces of the original.
    /// It has the same position and label, and belongs to the face of the most similar orientation.
    pub corners: Vec<[u32; 3]>,
    /// Face of the original nearest to the center of each triangle; without
    /// [`MeshParams::has_nearest_faces`] the one that the triangle was made from by moving its corners.
    pub faces: Vec<u32>,
    /// Distances between both surfaces, in model units; `None` if they were not measured.
    pub deviation: Option<Deviation>,
    /// Seconds that the measurement took.
    pub measure_seconds: f64,
    /// Distance that all points of both surfaces are proven to keep: that of [`MeshTarget::Error`], 0 if nothing changed.
    pub within: Option<f64>,
    /// Number of welded vertices of the original's triangles.
    pub n_vertices_before: usize,
    /// Number of triangles of the original, without degenerate and repeated triangles.
    pub n_triangles_before: usize,
    /// Number of degenerate or repeated triangles that were removed.
    pub n_left_out: usize,
    /// Reason why the simplification ended.
    pub why: Why,
    /// Number of parts of the original, if more vertices than requested are left.
    pub parts: Option<Parts>,
}

/// Simplifies a mesh by edge collapses in the order of the quadric error (`garland1997`), and measures the deviation.
///
/// Vertices at equal positions are welded, polygons are triangulated, and degenerate triangles, repeated triangles and
/// unused vertices are removed. `labels`, if given, has one value per corner of the faces. Corners at one position with
/// different labels lie on opposite sides of a seam (of a texture, of two materials); seams stay closed and in place.
///
/// The topology is kept: parts, holes, handles and the parts between seams (link condition, `dey1999`). A manifold mesh
/// stays manifold, and no edge gets more than two faces. Curves of borders, seams and edges with more than two faces
/// collapse along themselves; their ends and junctions are kept.
///
/// For [`MeshTarget::Error`], each triangle of the original has a proof that all of its points are within the distance
/// of faces of the result, between the same seams. Each new face is proven to be within the distance of the original,
/// by branch and bound. Collapses that break a proof are refused. For a number of vertices, collapses end at this
/// number. Collapses that turn a face by more than 75° are carried out only if no others are left.
///
/// The deviation is measured by branch and bound, too (see [`OneSided`]), unless the options leave it out. The distance to a triangle is a convex
/// function, so that its values at the corners of a piece bound it on the piece. The bound holds up to rounding, 1e-12
/// of the longest side of the bounding box.
///
/// Costs O(n log n) for vertices of bounded degree. The result does not depend on the number of threads.
///
/// # Errors
/// Returns a [`SimplifyError`] for an invalid target, a wrong number of labels, a mesh without area, and on
/// cancellation.
///
/// ```
/// use adwave::shape::{Mesh, Polygons};
/// use adwave_simplify::{MeshParams, MeshTarget, simplify_mesh};
/// use adwave::Progress;
/// // A flat square of 20 × 20 squares: its four corners are enough.
/// let side = 21;
/// let points = (0..side * side).map(|k| [f64::from(k % side), f64::from(k / side), 0.0]).collect();
/// let square = |k: u32| [[k, k + 1, k + 21], [k + 1, k + 22, k + 21]];
/// let squares = (0..side * (side - 1)).filter(|k| k % side < side - 1).flat_map(|k| square(k as u32));
/// let mesh = Mesh::new(points, Polygons::from_triangles(&squares.collect::<Vec<_>>()))?;
/// let params = MeshParams::new(MeshTarget::Error(1e-6));
/// let simplified = simplify_mesh(&mesh, None, &params, Progress::none())?;
/// assert_eq!(simplified.kept, [0, 20, 420, 440]);
/// assert!(simplified.deviation.is_some_and(|deviation| deviation.greatest() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify_mesh(
    mesh: &Mesh,
    labels: Option<&[u32]>,
    params: &MeshParams,
    progress: Progress<'_>,
) -> Result<SimplifiedMesh, SimplifyError> {
    let appearance = Appearance { labels, ..Appearance::default() };
    simplify_mesh_with_appearance(mesh, appearance, params, progress)
}

/// Simplifies like [`simplify_mesh`], keeps colors and texture coordinates, and keeps more vertices where the weights
/// are large.
///
/// For [`MeshTarget::Error`], the value at every vertex of the original differs little from the value at the nearest
/// point of the result: by at most the target distance times the largest change per length at the vertex, plus 1/64 of
/// the full range. For a number of vertices, the change of a value times the length of the edge adds to the cost of a
/// collapse, as a distance by which a contour moves. Weights multiply the quadric error of the vertices (as in
/// `lee2005`); they affect the order of collapses, not the distance that is proven.
///
/// # Errors
/// Returns a [`SimplifyError`] as [`simplify_mesh`] does, for a wrong number of values or weights, and for a weight
/// that is not finite.
pub fn simplify_mesh_with_appearance(
    mesh: &Mesh,
    appearance: Appearance<'_>,
    params: &MeshParams,
    progress: Progress<'_>,
) -> Result<SimplifiedMesh, SimplifyError> {
    params.target.check()?;
    let job = SimplifyJob { params: *params, ..SimplifyJob::new(mesh, appearance, progress)? };
    let n_before = job.wedges.n_vertices(&job.wedges.triangles);
    let (candidate, why) = match params.target {
        MeshTarget::Error(error) => job.simplify_to_error(error / job.wedges.unit, n_before)?,
        MeshTarget::Vertices(n) => job.simplify_to_count(n, n_before)?,
        MeshTarget::Ratio(ratio) => {
            job.simplify_to_count(((n_before as f64) * ratio).round() as usize, n_before)?
        }
    };
    job.finish(mesh, candidate, why, n_before)
}

/// Measures the deviation of a mesh of other triangles over vertices of the original, such as a level of a hierarchy,
/// like that of a simplification. `triangles` are indices of vertices of the original; vertices at equal positions
/// count as one.
///
/// # Errors
/// Returns a [`SimplifyError`] if neither mesh has a face of positive area, and on cancellation.
pub fn measure_coarse_mesh(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<SimplifiedMesh, SimplifyError> {
    let appearance = Appearance::default();
    let job = SimplifyJob::new(mesh, appearance, progress)?;
    let n_before = job.wedges.n_vertices(&job.wedges.triangles);
    let vertex_map = VertexMap::new(mesh.points(), WeldMode::EqualPositions);
    let mut wedge_at = vec![u32::MAX; vertex_map.n_welded()];
    for (wedge, &vertex) in (0..).zip(&job.wedges.vertex) {
        wedge_at[vertex_map.welded(vertex as usize)] = wedge;
    }
    let wedge = |vertex: u32| wedge_at[vertex_map.welded(vertex as usize)];
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(wedge)).collect();
    // A vertex that only degenerate faces of the original have is on no surface.
    let is_known = triangles.as_flattened().iter().all(|&wedge| wedge != u32::MAX);
    if !is_known || TriangleSurface::new(&job.wedges.points, &triangles).is_none() {
        return Err(SimplifyError::NoSurface);
    }
    let origins = vec![0; triangles.len()];
    let candidate = Candidate { triangles, origins, deviation: None, within: None };
    job.finish(mesh, candidate, Why::Reached, n_before)
}

impl MeshTarget {
    fn check(self) -> Result<(), SimplifyError> {
        match self {
            Self::Error(error) if !(error.is_finite() && error >= 0.0) => Err(SimplifyError::Length(error)),
            Self::Vertices(0) => Err(SimplifyError::NoVertices),
            Self::Ratio(ratio) if !(ratio > 0.0 && ratio <= 1.0) => Err(SimplifyError::Ratio(ratio)),
            _ => Ok(()),
        }
    }
}

/// Simplified triangles over wedges, and their deviation if it was measured.
struct Candidate {
    triangles: Vec<[u32; 3]>,
    /// Triangle of the original from which each triangle was made by moving vertices.
    origins: Vec<u32>,
    /// The deviation and the seconds that measuring it took.
    deviation: Option<(Deviation, f64)>,
    /// Proven distance of all points of both surfaces.
    within: Option<f64>,
}

/// State shared by all runs on one mesh.
struct SimplifyJob<'a> {
    wedges: Wedges,
    colors: Option<WedgeColors>,
    /// Importance of each position, in [0, 1].
    importance: Option<Vec<f64>>,
    areas: Vec<f64>,
    charts: Vec<u32>,
    /// Search structure of the original, built on first use.
    surface: OnceLock<TriangleSurface>,
    params: MeshParams,
    progress: Progress<'a>,
}

/// Largest number of times that all remaining vertices are tried for a target distance.
const MAX_PASSES: u64 = 3;

/// Share of the target distance that is reserved for rounding.
const LIMIT_MARGIN: f64 = 1e-9;

impl<'a> SimplifyJob<'a> {
    /// The job with the options of a measured result.
    fn new(mesh: &Mesh, appearance: Appearance<'_>, progress: Progress<'a>) -> Result<Self, SimplifyError> {
        let wedges = Wedges::new(mesh, appearance, progress)?;
        let colors = appearance.values.map(|values| WedgeColors::new(&wedges, values));
        let importance = appearance.weights.map(|weights| wedges.importance(mesh, weights)).transpose()?;
        progress.check()?;
        let areas = vertex_areas(&wedges.points, &wedges.triangles);
        let charts = wedges.charts();
        let surface = OnceLock::new();
        let params = MeshParams::new(MeshTarget::Ratio(1.0));
        Ok(Self { wedges, colors, importance, areas, charts, surface, params, progress })
    }

    /// Returns the search structure of the original. O(n log n) for the first call.
    fn surface(&self) -> &TriangleSurface {
        self.surface.get_or_init(|| {
            let surface = TriangleSurface::new(&self.wedges.points, &self.wedges.triangles);
            surface.expect("a mesh without triangles is refused")
        })
    }

    /// Starts to build the search structure of the original.
    fn start_surface(&self) -> Option<StartedSurface> {
        StartedSurface::new(&self.wedges.points, &self.wedges.triangles)
    }

    /// Waits for the search structure. Without one it is built where it is needed.
    fn finish_surface(&self, started: Option<StartedSurface>) -> Result<(), Cancelled> {
        if let Some(started) = started
            && let Some(surface) =
                started.finish(&self.wedges.points, &self.wedges.triangles, self.progress)?
        {
            self.surface.get_or_init(|| surface);
        }
        Ok(())
    }

    /// Input of collapses, within a limit in units of the unit box if there is one.
    fn collapses(&self, limit: Option<f64>) -> CollapseInput<'_> {
        CollapseInput {
            wedges: &self.wedges,
            colors: self.colors.as_ref(),
            importance: self.importance.as_deref(),
            keeps_borders: self.params.border == Border::Kept,
            limit: limit.map(|limit| DistanceLimit { surface: self.surface(), charts: &self.charts, limit }),
            progress: self.progress,
        }
    }

    fn view<'b>(&'b self, triangles: &'b [[u32; 3]]) -> SurfaceView<'b> {
        SurfaceView { points: &self.wedges.points, triangles }
    }

    /// Measures the distances between triangles and the original; `origins` has the triangle of the original for each.
    /// Also returns the seconds that it took.
    fn measure(&self, triangles: &[[u32; 3]], origins: &[u32]) -> Result<(Deviation, f64), Cancelled> {
        let start = Instant::now();
        let progress = self.progress.quiet();
        let (original, view) = (self.view(&self.wedges.triangles), self.view(triangles));
        let Some(simplified) = TriangleSurface::new(&self.wedges.points, triangles) else {
            unreachable!("collapses leave a triangle of each part");
        };
        let at_points = view.triangle_at_points();
        let of_original = measure_original(original, &self.areas, &at_points, &simplified, progress)?;
        let at_points = original.triangle_at_points();
        let is_original = |k: usize| {
            let origin = self.wedges.triangles[origins[k] as usize];
            rotate_to_smallest(origin) == rotate_to_smallest(triangles[k])
        };
        let of_simplified = measure_simplified(view, is_original, &at_points, self.surface(), progress)?;
        Ok((Deviation { of_original, of_simplified }, start.elapsed().as_secs_f64()))
    }

    /// Simplifies to few vertices within a distance, in units of the unit box.
    fn simplify_to_error(&self, error: f64, n_before: usize) -> Result<(Candidate, Why), SimplifyError> {
        let limit = (error * (1.0 - LIMIT_MARGIN)).max(ROUNDING);
        self.finish_surface(self.start_surface())?;
        let collapses = self.collapses(Some(limit));
        let mesh = collapses.collapse_in_parts(collapses.start(n_before), None)?;
        let mut count = mesh.n_vertices;
        let mut collapser = collapses.collapser(mesh)?;
        for _ in 0..MAX_PASSES {
            let before = count;
            collapser.start(Turning::Limited, self.progress)?;
            count = collapser.run(count, 0, f32::INFINITY, &self.wedges.vertex, self.progress)?;
            if count == before {
                break;
            }
        }
        let (triangles, origins) = collapser.connectivity.triangles();
        if count == n_before {
            return Ok((self.unchanged(), Why::Unchanged));
        }
        // The collapses have proven the limit; the measure may need too many pieces to prove it again.
        let within = |side: OneSided| OneSided {
            greatest: side.greatest.min(limit),
            at_least: side.at_least.min(limit),
            ..side
        };
        let deviation = if self.params.is_measured {
            let (deviation, seconds) = self.measure(&triangles, &origins)?;
            let deviation = Deviation {
                of_original: within(deviation.of_original),
                of_simplified: within(deviation.of_simplified),
            };
            Some((deviation, seconds))
        } else {
            None
        };
        Ok((Candidate { triangles, origins, deviation, within: Some(limit) }, Why::Reached))
    }

    /// Simplifies to `n` vertices, or to as few as possible.
    fn simplify_to_count(&self, n: usize, n_before: usize) -> Result<(Candidate, Why), SimplifyError> {
        let n = n.max(1);
        if n >= n_before {
            return Ok((self.unchanged(), Why::Unchanged));
        }
        // The search structure is needed for the measurement and for the nearest faces.
        let is_needed = self.params.is_measured || self.params.has_nearest_faces;
        let started = if is_needed { self.start_surface() } else { None };
        let collapses = self.collapses(None);
        let mesh = collapses.collapse_in_parts(collapses.start(n_before), Some(n))?;
        let mut count = mesh.n_vertices;
        let mut collapser = collapses.collapser(mesh)?;
        for turning in [Turning::Limited, Turning::Free] {
            if count > n {
                collapser.start(turning, self.progress)?;
                count = collapser.run(count, n, f32::INFINITY, &self.wedges.vertex, self.progress)?;
            }
        }
        self.finish_surface(started)?;
        let (triangles, origins) = collapser.connectivity.triangles();
        let why = if count > n { Why::Stuck } else { Why::Reached };
        Ok((Candidate { triangles, origins, deviation: None, within: None }, why))
    }

    fn unchanged(&self) -> Candidate {
        let triangles = self.wedges.triangles.clone();
        let origins = (0..triangles.len() as u32).collect();
        Candidate { triangles, origins, deviation: Some((Deviation::default(), 0.0)), within: Some(0.0) }
    }

    /// Translates a result to vertices, corners and faces of the original.
    fn finish(
        &self,
        mesh: &Mesh,
        candidate: Candidate,
        why: Why,
        n_vertices_before: usize,
    ) -> Result<SimplifiedMesh, SimplifyError> {
        let Candidate { triangles, origins, deviation, within } = candidate;
        let deviation = match deviation {
            None if self.params.is_measured => Some(self.measure(&triangles, &origins)?),
            found => found,
        };
        let nearest = if self.params.has_nearest_faces {
            let (charts, progress) = (&self.charts, self.progress.quiet());
            let surface = self.surface();
            provenance::nearest_triangles(&self.wedges, &triangles, &origins, charts, surface, progress)?
        } else {
            origins
        };
        let corners = provenance::corners(&self.wedges, &triangles);
        let face_of = faces_of_corners(mesh);
        let faces = nearest.iter().map(|&t| face_of(self.wedges.corners[t as usize][0])).collect();
        let (kept, triangles) = self.compact_vertices(&triangles);
        Ok(SimplifiedMesh {
            kept,
            triangles,
            corners,
            faces,
            deviation: deviation.map(|(deviation, _)| deviation.scaled_by(self.wedges.unit)),
            measure_seconds: deviation.map_or(0.0, |(_, seconds)| seconds),
            within: within.map(|within| within * self.wedges.unit),
            n_vertices_before,
            n_triangles_before: self.wedges.triangles.len(),
            n_left_out: self.wedges.n_left_out,
            why,
            parts: (why == Why::Stuck).then(|| self.wedges.count_parts()),
        })
    }

    /// Lists the used vertices, increasing, and renumbers the triangles.
    fn compact_vertices(&self, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
        let vertex = |wedge: u32| self.wedges.vertex[wedge as usize];
        let mut kept: Vec<u32> = triangles.as_flattened().iter().map(|&wedge| vertex(wedge)).collect();
        kept.sort_unstable();
        kept.dedup();
        let index = |wedge: u32| kept.partition_point(|&x| x < vertex(wedge)) as u32;
        let triangles = triangles.iter().map(|triangle| triangle.map(index)).collect();
        (kept, triangles)
    }
}

/// Returns the map from the number of a corner among those of all faces to its face.
fn faces_of_corners(mesh: &Mesh) -> impl Fn(u32) -> u32 {
    let ends: Vec<u32> = if mesh.faces().triangles().is_some() {
        Vec::new()
    } else {
        let mut end = 0;
        mesh.faces()
            .iter()
            .map(|face| {
                end += face.len() as u32;
                end
            })
            .collect()
    };
    move |corner| if ends.is_empty() { corner / 3 } else { ends.partition_point(|&end| end <= corner) as u32 }
}
