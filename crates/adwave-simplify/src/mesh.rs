//! Simplification of meshes: to a largest distance, or to a number of vertices.

use crate::collapse::{collapse, to_single_precision};
use crate::deviation::{TriangleSurface, measure_triangles, measure_vertices, vertex_areas};
use crate::provenance;
use crate::wedges::{Wedges, rotate_to_smallest};
use crate::{Deviation, SimplifyError};
use adwave::shape::Mesh;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Target of a simplification.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshTarget {
    /// Largest measured distance, in model units, reached with as few vertices as possible.
    Error(f64),
    /// Number of vertices.
    Vertices(usize),
    /// Share of the vertices of the triangles after welding, in (0, 1].
    Ratio(f64),
}

/// Treatment of the borders of an open mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// Borders are simplified along themselves, and contribute to the error.
    #[default]
    Weighted,
    /// Border vertices are kept.
    Kept,
}

/// Options of a simplification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshParams {
    /// Target.
    pub target: MeshTarget,
    /// Treatment of borders.
    pub border: Border,
}

impl MeshParams {
    /// Options for a target, with weighted borders.
    pub fn new(target: MeshTarget) -> Self {
        Self { target, border: Border::default() }
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
    /// More vertices than requested are left: seams, kept borders, non-manifold edges and minimal components cannot be
    /// collapsed.
    Stuck,
}

/// A mesh with fewer vertices.
#[derive(Clone, Debug)]
pub struct SimplifiedMesh {
    /// Indices of the kept vertices of the original, increasing.
    pub kept: Vec<u32>,
    /// Triangles as indices into `kept`.
    pub triangles: Vec<[u32; 3]>,
    /// Corner of the original that each corner continues, counted through all faces of the original. It has the same
    /// position and label, and belongs to the face of most similar orientation.
    pub corners: Vec<[u32; 3]>,
    /// Face of the original nearest to the center of each triangle.
    pub faces: Vec<u32>,
    /// Distances between both surfaces, in model units.
    pub deviation: Deviation,
    /// Number of vertices of the triangles of the original, after welding.
    pub n_vertices_before: usize,
    /// Number of triangles of the original, without degenerate and repeated ones.
    pub n_triangles_before: usize,
    /// Number of degenerate or repeated triangles that were removed.
    pub n_left_out: usize,
    /// Reason why the simplification ended.
    pub why: Why,
}

/// Simplifies a mesh by edge collapses in the order of the quadric error (`garland1997`), and measures the deviation.
///
/// Vertices at equal positions are welded, polygons are triangulated, and degenerate triangles, repeated triangles and
/// unused vertices are removed. `labels`, if given, has one value per corner of the faces. Corners at one position with
/// different labels lie on opposite sides of a seam (of a texture, of two materials); seams stay closed and in place.
///
/// For [`MeshTarget::Error`] the estimated error of the collapses is raised until the measured largest distance reaches
/// the target. If the result is too far away at a few places, the vertices there are locked and the mesh is simplified
/// again, in at most 12 runs. For a number of vertices at most 6 runs come within 1 % if seams and borders permit.
///
/// Costs O(n log n) per run. A run on a million vertices takes about a second and is not interrupted; measuring takes as
/// long again. The result does not depend on the number of threads.
///
/// # Errors
/// Returns a [`SimplifyError`] for an invalid target, a wrong number of labels, a mesh without area, and on cancellation.
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
/// assert!(simplified.deviation.greatest() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn simplify_mesh(
    mesh: &Mesh,
    labels: Option<&[u32]>,
    params: &MeshParams,
    progress: Progress<'_>,
) -> Result<SimplifiedMesh, SimplifyError> {
    params.target.check()?;
    let job = SimplifyJob::new(mesh, labels, params.border, progress)?;
    let n_before = job.wedges.n_vertices(&job.wedges.triangles);
    let (candidate, why) = match params.target {
        MeshTarget::Error(error) => job.simplify_to_error(error / job.wedges.unit)?,
        MeshTarget::Vertices(n) => job.simplify_to_count(n, n_before)?,
        MeshTarget::Ratio(ratio) => {
            job.simplify_to_count(((n_before as f64) * ratio).round() as usize, n_before)?
        }
    };
    job.finish(mesh, candidate, why, n_before)
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
    deviation: Option<Deviation>,
}

/// State shared by all runs on one mesh.
struct SimplifyJob<'a> {
    wedges: Wedges,
    single: Vec<[f32; 3]>,
    areas: Vec<f64>,
    /// Triangles of the original, each rotated to its smallest wedge, sorted.
    sorted: Vec<[u32; 3]>,
    original: TriangleSurface,
    border: Border,
    progress: Progress<'a>,
}

/// Largest number of runs for an error target.
const MAX_RUNS_ERROR: u64 = 12;

/// Share of vertices beyond the limit above which the estimate is lowered instead of locking vertices.
const MAX_LOCKED_SHARE: f64 = 0.02;

/// Largest number of runs for a number of vertices.
const MAX_RUNS_COUNT: u64 = 6;

/// Accepted measured distance, relative to the target.
const ERROR_TOLERANCE: f64 = 0.8;

/// Accepted relative difference of the number of vertices.
const COUNT_TOLERANCE: f64 = 0.01;

/// Distances in the unit box that are caused by rounding.
const ROUNDING: f64 = 1e-12;

/// Smallest initial estimate in the unit box, the flatness limit of single precision.
const MIN_ESTIMATE: f64 = 1e-5;

/// Estimate in the unit box that no collapse reaches.
const NO_LIMIT: f64 = 1e6;

impl<'a> SimplifyJob<'a> {
    fn new(
        mesh: &Mesh,
        labels: Option<&[u32]>,
        border: Border,
        progress: Progress<'a>,
    ) -> Result<Self, SimplifyError> {
        let wedges = Wedges::new(mesh, labels, progress)?;
        let original =
            TriangleSurface::new(&wedges.points, &wedges.triangles).ok_or(SimplifyError::NoSurface)?;
        progress.check()?;
        let single = to_single_precision(&wedges.points);
        let areas = vertex_areas(&wedges.points, &wedges.triangles);
        let mut sorted: Vec<[u32; 3]> = wedges.triangles.iter().map(|&t| rotate_to_smallest(t)).collect();
        sorted.par_sort_unstable();
        Ok(Self { wedges, single, areas, sorted, original, border, progress })
    }

    fn collapse(&self, locked: &[bool], n_triangles: usize, error: f64) -> Result<Vec<[u32; 3]>, Cancelled> {
        self.progress.check()?;
        let left = collapse(&self.wedges, &self.single, locked, n_triangles, error, self.border);
        self.progress.check()?;
        Ok(left)
    }

    fn none_locked(&self) -> Vec<bool> {
        vec![false; self.wedges.points.len()]
    }

    /// Measures the deviation of triangles, and lists the wedges beyond the limit: vertices of the original, or, if those
    /// are all within it, the corners of triangles whose interior is beyond it.
    fn measure(&self, triangles: &[[u32; 3]], limit: f64) -> Result<(Deviation, Vec<u32>), Cancelled> {
        let progress = self.progress.quiet();
        let points = &self.wedges.points;
        let Some(simplified) = TriangleSurface::new(points, triangles) else {
            // No triangle is left: the distance is infinite.
            let far = crate::OneSided { greatest: f64::INFINITY, rms: f64::INFINITY };
            let all = (0..points.len() as u32).collect();
            return Ok((Deviation { of_original: far, of_simplified: far }, all));
        };
        let mut is_on = self.none_locked();
        for &wedge in triangles.as_flattened() {
            is_on[wedge as usize] = true;
        }
        let vertices = measure_vertices(points, &self.areas, &is_on, &simplified, limit, progress)?;
        let of_original = vertices.side;
        if !vertices.far.is_empty() {
            return Ok((Deviation { of_original, ..Deviation::default() }, vertices.far));
        }
        let is_of = |triangle| self.sorted.binary_search(&rotate_to_smallest(triangle)).is_ok();
        let inside = measure_triangles(points, triangles, is_of, &self.original, limit, progress)?;
        let far = inside.far.iter().flat_map(|&t| triangles[t as usize]).collect();
        Ok((Deviation { of_original, of_simplified: inside.side }, far))
    }

    /// Locks wedges and all wedges that share a triangle with them.
    fn lock_one_ring(&self, far: &[u32], locked: &mut [bool]) {
        let mut is_far = self.none_locked();
        for &wedge in far {
            is_far[wedge as usize] = true;
        }
        for triangle in self.wedges.triangles.iter().filter(|t| t.iter().any(|&w| is_far[w as usize])) {
            for &wedge in triangle {
                locked[wedge as usize] = true;
            }
        }
    }

    /// Searches for the fewest vertices within a distance in the unit box.
    fn simplify_to_error(&self, error: f64) -> Result<(Candidate, Why), SimplifyError> {
        let limit = error + ROUNDING;
        // The largest distance is two or three times the estimated mean.
        let mut estimate = (0.5 * error).clamp(MIN_ESTIMATE, NO_LIMIT);
        let (mut locked, mut is_open) = (self.none_locked(), true);
        let mut best: Option<Candidate> = None;
        for run in 0..MAX_RUNS_ERROR {
            self.progress.step(run, MAX_RUNS_ERROR)?;
            let triangles = self.collapse(&locked, 0, estimate)?;
            let (deviation, far) = self.measure(&triangles, limit)?;
            let measured = deviation.greatest();
            if measured <= limit {
                let is_fewer = best.as_ref().is_none_or(|b| triangles.len() < b.triangles.len());
                if is_fewer {
                    best = Some(Candidate { triangles, deviation: Some(deviation) });
                }
                // Once vertices were locked or the estimate was too large, further runs gain little.
                if !is_open || !is_fewer || measured >= ERROR_TOLERANCE * error || estimate >= NO_LIMIT {
                    break;
                }
                estimate =
                    (estimate * (error / measured.max(f64::MIN_POSITIVE)).clamp(1.3, 4.0)).min(NO_LIMIT);
                continue;
            }
            is_open = false;
            let are_many = far.len() as f64 > MAX_LOCKED_SHARE * self.wedges.points.len() as f64;
            if are_many || run + 4 > MAX_RUNS_ERROR {
                estimate *= 0.5;
            }
            if !are_many {
                self.lock_one_ring(&far, &mut locked);
            }
        }
        Ok(match best.filter(|candidate| candidate.triangles.len() < self.wedges.triangles.len()) {
            Some(candidate) => (candidate, Why::Reached),
            None => (self.unchanged(), Why::Unchanged),
        })
    }

    /// Simplifies to about `n` vertices.
    fn simplify_to_count(&self, n: usize, n_before: usize) -> Result<(Candidate, Why), SimplifyError> {
        let n = n.max(1);
        if n >= n_before {
            return Ok((self.unchanged(), Why::Unchanged));
        }
        let unlocked = self.none_locked();
        let n_all = self.wedges.triangles.len() as f64;
        let mut n_triangles = n_all * n as f64 / n_before as f64;
        let mut best: Option<(f64, Vec<[u32; 3]>, usize)> = None;
        for run in 0..MAX_RUNS_COUNT {
            self.progress.step(run, MAX_RUNS_COUNT)?;
            let triangles = self.collapse(&unlocked, n_triangles.max(1.0) as usize, NO_LIMIT)?;
            let count = self.wedges.n_vertices(&triangles);
            // An empty result is never accepted, however near its count.
            let off =
                if triangles.is_empty() { f64::INFINITY } else { (count as f64 - n as f64).abs() / n as f64 };
            let more = 2.0 * (n as f64 - count as f64);
            let is_better = best.as_ref().is_none_or(|b| off < b.0);
            let is_stuck = count > n && triangles.len() as f64 > 1.01 * n_triangles + 2.0;
            if is_better {
                best = Some((off, triangles, count));
            }
            if off <= COUNT_TOLERANCE || !is_better || is_stuck {
                break;
            }
            // On a closed surface one more vertex means two more triangles.
            n_triangles = (n_triangles + more).clamp(1.0, n_all);
        }
        let Some((off, triangles, count)) = best.filter(|b| b.0.is_finite()) else {
            return Ok((self.unchanged(), Why::Stuck));
        };
        let why = if count > n && off > 5.0 * COUNT_TOLERANCE { Why::Stuck } else { Why::Reached };
        Ok((Candidate { triangles, deviation: None }, why))
    }

    fn unchanged(&self) -> Candidate {
        Candidate { triangles: self.wedges.triangles.clone(), deviation: Some(Deviation::default()) }
    }

    /// Translates a result to vertices, corners and faces of the original.
    fn finish(
        &self,
        mesh: &Mesh,
        candidate: Candidate,
        why: Why,
        n_vertices_before: usize,
    ) -> Result<SimplifiedMesh, SimplifyError> {
        let Candidate { triangles, deviation } = candidate;
        let deviation = match deviation {
            Some(deviation) => deviation,
            None => self.measure(&triangles, f64::INFINITY)?.0,
        };
        let nearest =
            provenance::nearest_triangles(&self.wedges, &triangles, &self.original, self.progress.quiet())?;
        let corners = provenance::corners(&self.wedges, &triangles);
        let face_of = faces_of_corners(mesh);
        let faces = nearest.iter().map(|&t| face_of(self.wedges.corners[t as usize][0])).collect();
        let (kept, triangles) = self.compact_vertices(&triangles);
        Ok(SimplifiedMesh {
            kept,
            triangles,
            corners,
            faces,
            deviation: deviation.scaled_by(self.wedges.unit),
            n_vertices_before,
            n_triangles_before: self.wedges.triangles.len(),
            n_left_out: self.wedges.n_left_out,
            why,
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

/// Returns the map from corners, counted through all faces, to faces.
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
