//! Meshes: the fewest vertices within a distance, or so many vertices.

use crate::collapse::{collapse, in_single_precision};
use crate::deviation::{Surface, from_triangles, from_vertices, vertex_areas};
use crate::provenance;
use crate::wedges::{Wedges, smallest_first};
use crate::{Deviation, SimplifyError};
use adwave::shape::Mesh;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// What to aim at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshTarget {
    /// As few vertices as are found with a measured distance of at most this, in model units.
    Error(f64),
    /// So many vertices.
    Vertices(usize),
    /// This share of the vertices that the triangles have, counted after welding.
    Ratio(f64),
}

/// What becomes of the borders of an open mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Border {
    /// They are simplified along themselves, and count in the error.
    #[default]
    Weighted,
    /// Their vertices stay.
    Kept,
}

/// How a mesh is simplified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshParams {
    /// What to aim at.
    pub target: MeshTarget,
    /// What becomes of borders.
    pub border: Border,
}

impl MeshParams {
    /// Aims at a target, borders weighted.
    pub fn new(target: MeshTarget) -> Self {
        Self { target, border: Border::default() }
    }

    /// The same with borders treated so.
    #[must_use]
    pub fn with_border(self, border: Border) -> Self {
        Self { border, ..self }
    }
}

/// Whether the target was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// It was.
    Reached,
    /// No vertex can be dropped under it; the result is the original.
    Unchanged,
    /// More vertices than asked for are left: seams, borders that are kept, edges of three triangles, and parts that are as
    /// small as they can be are not collapsed.
    Stuck,
}

/// A mesh with fewer vertices.
#[derive(Clone, Debug)]
pub struct SimplifiedMesh {
    /// Which vertices of the original are kept, increasing.
    pub kept: Vec<u32>,
    /// The triangles; indices count in `kept`.
    pub triangles: Vec<[u32; 3]>,
    /// For each corner of the triangles the corner of the original's faces that it continues, counted through all faces: it
    /// stands at the same position, has the same label, and belongs to the face that is turned most alike.
    pub corners: Vec<[u32; 3]>,
    /// For each triangle the face of the original that is nearest to its center.
    pub faces: Vec<u32>,
    /// How far both surfaces are apart, in model units.
    pub deviation: Deviation,
    /// How many vertices the original's triangles have, after welding.
    pub n_vertices_before: usize,
    /// How many triangles the original has, those without area and repeated ones left out.
    pub n_triangles_before: usize,
    /// How many triangles were left out: without area, or the same as another.
    pub n_left_out: usize,
    /// Whether the target was reached.
    pub why: Why,
}

/// Fewer vertices for the same surface: edges are collapsed in the order of the quadric error (`garland1997`), and what that
/// costs is measured.
///
/// Vertices at exactly equal positions are one, polygons are cut into triangles, triangles without area and repeated ones are
/// left out, and so are vertices of no triangle. `labels` has a value for each corner of the faces, or is `None`: corners at one
/// position that differ in it lie on both sides of a seam (of a texture, of two materials), which stays closed and where it is.
///
/// For [`MeshTarget::Error`] the estimate that steers the collapses is raised until the measured greatest distance is the one
/// asked for, and where the result is farther away at few places, the vertices there are kept and the rest is simplified again: at
/// most 12 runs. For a number of vertices at most 6 runs come within 1 % where seams
/// and borders let them.
///
/// O(n log n) for each run; a run of a million vertices takes about a second, and is not interrupted, and measuring as much
/// again. The same input gives the same bits on any number of threads.
///
/// # Errors
/// [`SimplifyError`]: a target that cannot be, labels that are not one per corner, no triangle with an area, or a stop.
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
    let job = Job::new(mesh, labels, params.border, progress)?;
    let n_before = job.wedges.n_vertices(&job.wedges.triangles);
    let (found, why) = match params.target {
        MeshTarget::Error(error) => job.within(error / job.wedges.unit)?,
        MeshTarget::Vertices(n) => job.of_vertices(n, n_before)?,
        MeshTarget::Ratio(ratio) => {
            job.of_vertices(((n_before as f64) * ratio).round() as usize, n_before)?
        }
    };
    job.finish(mesh, found, why, n_before)
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

/// Triangles over wedges, and how far they are from the original where that was measured.
struct Found {
    triangles: Vec<[u32; 3]>,
    deviation: Option<Deviation>,
}

/// What all runs on one mesh share.
struct Job<'a> {
    wedges: Wedges,
    single: Vec<[f32; 3]>,
    areas: Vec<f64>,
    /// The triangles, each from its smallest wedge, in order.
    sorted: Vec<[u32; 3]>,
    original: Surface,
    border: Border,
    progress: Progress<'a>,
}

/// Runs for one distance.
const RUNS_FOR_ERROR: u64 = 12;

/// Where more than this share of the vertices is too far away, the estimate is too large; fewer are kept where they are.
const MANY: f64 = 0.02;

/// Runs for one number of vertices.
const RUNS_FOR_VERTICES: u64 = 6;

/// A measured distance above this share of the one asked for is near enough.
const NEAR_ENOUGH: f64 = 0.8;

/// A number of vertices that differs by less than this share is near enough.
const COUNT_NEAR_ENOUGH: f64 = 0.01;

/// Distances in the unit box that rounding alone makes.
const ROUNDING: f64 = 1e-12;

/// The least estimate that a search begins at in the unit box: to single precision nothing is flatter than this.
const LEAST_ESTIMATE: f64 = 1e-5;

/// An estimate in the unit box that no collapse reaches.
const NO_LIMIT: f64 = 1e6;

impl<'a> Job<'a> {
    fn new(
        mesh: &Mesh,
        labels: Option<&[u32]>,
        border: Border,
        progress: Progress<'a>,
    ) -> Result<Self, SimplifyError> {
        let wedges = Wedges::new(mesh, labels, progress)?;
        let original = Surface::new(&wedges.points, &wedges.triangles).ok_or(SimplifyError::NoSurface)?;
        progress.check()?;
        let single = in_single_precision(&wedges.points);
        let areas = vertex_areas(&wedges.points, &wedges.triangles);
        let mut sorted: Vec<[u32; 3]> = wedges.triangles.iter().map(|&t| smallest_first(t)).collect();
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

    /// How far these triangles are from the original, and the wedges where that is beyond the limit: those of the original, or
    /// where they are all near the corners of triangles whose inside is far away.
    fn measure(&self, triangles: &[[u32; 3]], limit: f64) -> Result<(Deviation, Vec<u32>), Cancelled> {
        let progress = self.progress.quiet();
        let points = &self.wedges.points;
        let Some(simplified) = Surface::new(points, triangles) else {
            // Nothing is left, which is as far as can be.
            let far = crate::OneSided { greatest: f64::INFINITY, rms: f64::INFINITY };
            let all = (0..points.len() as u32).collect();
            return Ok((Deviation { of_original: far, of_simplified: far }, all));
        };
        let mut is_on = self.none_locked();
        for &wedge in triangles.as_flattened() {
            is_on[wedge as usize] = true;
        }
        let vertices = from_vertices(points, &self.areas, &is_on, &simplified, limit, progress)?;
        let of_original = vertices.side;
        if !vertices.far.is_empty() {
            return Ok((Deviation { of_original, ..Deviation::default() }, vertices.far));
        }
        let is_of = |triangle| self.sorted.binary_search(&smallest_first(triangle)).is_ok();
        let inside = from_triangles(points, triangles, is_of, &self.original, limit, progress)?;
        let far = inside.far.iter().flat_map(|&t| triangles[t as usize]).collect();
        Ok((Deviation { of_original, of_simplified: inside.side }, far))
    }

    /// Keeps these wedges and all that share a triangle with them.
    fn lock_round(&self, far: &[u32], locked: &mut [bool]) {
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

    /// As few vertices as are found within a distance in the unit box.
    fn within(&self, error: f64) -> Result<(Found, Why), SimplifyError> {
        let limit = error + ROUNDING;
        // The greatest distance is two or three times the mean that is estimated.
        let mut estimate = (0.5 * error).clamp(LEAST_ESTIMATE, NO_LIMIT);
        let (mut locked, mut is_open) = (self.none_locked(), true);
        let mut best: Option<Found> = None;
        for run in 0..RUNS_FOR_ERROR {
            self.progress.step(run, RUNS_FOR_ERROR)?;
            let triangles = self.collapse(&locked, 0, estimate)?;
            let (deviation, far) = self.measure(&triangles, limit)?;
            let measured = deviation.greatest();
            if measured <= limit {
                let is_fewer = best.as_ref().is_none_or(|b| triangles.len() < b.triangles.len());
                if is_fewer {
                    best = Some(Found { triangles, deviation: Some(deviation) });
                }
                // Once places are locked or the estimate was too large, this is about as far as it goes.
                if !is_open || !is_fewer || measured >= NEAR_ENOUGH * error || estimate >= NO_LIMIT {
                    break;
                }
                estimate =
                    (estimate * (error / measured.max(f64::MIN_POSITIVE)).clamp(1.3, 4.0)).min(NO_LIMIT);
                continue;
            }
            is_open = false;
            let are_many = far.len() as f64 > MANY * self.wedges.points.len() as f64;
            if are_many || run + 4 > RUNS_FOR_ERROR {
                estimate *= 0.5;
            }
            if !are_many {
                self.lock_round(&far, &mut locked);
            }
        }
        Ok(match best.filter(|found| found.triangles.len() < self.wedges.triangles.len()) {
            Some(found) => (found, Why::Reached),
            None => (self.unchanged(), Why::Unchanged),
        })
    }

    /// About `n` vertices.
    fn of_vertices(&self, n: usize, n_before: usize) -> Result<(Found, Why), SimplifyError> {
        let n = n.max(1);
        if n >= n_before {
            return Ok((self.unchanged(), Why::Unchanged));
        }
        let unlocked = self.none_locked();
        let n_all = self.wedges.triangles.len() as f64;
        let mut wanted = n_all * n as f64 / n_before as f64;
        let mut best: Option<(f64, Vec<[u32; 3]>, usize)> = None;
        for run in 0..RUNS_FOR_VERTICES {
            self.progress.step(run, RUNS_FOR_VERTICES)?;
            let triangles = self.collapse(&unlocked, wanted.max(1.0) as usize, NO_LIMIT)?;
            let count = self.wedges.n_vertices(&triangles);
            // Nothing at all is no answer, however near to the number.
            let off =
                if triangles.is_empty() { f64::INFINITY } else { (count as f64 - n as f64).abs() / n as f64 };
            let more = 2.0 * (n as f64 - count as f64);
            let is_better = best.as_ref().is_none_or(|b| off < b.0);
            let is_stuck = count > n && triangles.len() as f64 > 1.01 * wanted + 2.0;
            if is_better {
                best = Some((off, triangles, count));
            }
            if off <= COUNT_NEAR_ENOUGH || !is_better || is_stuck {
                break;
            }
            // On a closed surface a vertex more is two triangles more.
            wanted = (wanted + more).clamp(1.0, n_all);
        }
        let Some((off, triangles, count)) = best.filter(|b| b.0.is_finite()) else {
            return Ok((self.unchanged(), Why::Stuck));
        };
        let why = if count > n && off > 5.0 * COUNT_NEAR_ENOUGH { Why::Stuck } else { Why::Reached };
        Ok((Found { triangles, deviation: None }, why))
    }

    fn unchanged(&self) -> Found {
        Found { triangles: self.wedges.triangles.clone(), deviation: Some(Deviation::default()) }
    }

    /// The result in the words of the original.
    fn finish(
        &self,
        mesh: &Mesh,
        found: Found,
        why: Why,
        n_vertices_before: usize,
    ) -> Result<SimplifiedMesh, SimplifyError> {
        let Found { triangles, deviation } = found;
        let deviation = match deviation {
            Some(deviation) => deviation,
            None => self.measure(&triangles, f64::INFINITY)?.0,
        };
        let nearest =
            provenance::nearest_triangles(&self.wedges, &triangles, &self.original, self.progress.quiet())?;
        let corners = provenance::corners(&self.wedges, &triangles);
        let face_of = faces_of_corners(mesh);
        let faces = nearest.iter().map(|&t| face_of(self.wedges.corners[t as usize][0])).collect();
        let (kept, triangles) = self.kept(&triangles);
        Ok(SimplifiedMesh {
            kept,
            triangles,
            corners,
            faces,
            deviation: deviation.times(self.wedges.unit),
            n_vertices_before,
            n_triangles_before: self.wedges.triangles.len(),
            n_left_out: self.wedges.n_left_out,
            why,
        })
    }

    /// The vertices that are left, increasing, and the triangles over them.
    fn kept(&self, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<[u32; 3]>) {
        let vertex = |wedge: u32| self.wedges.vertex[wedge as usize];
        let mut kept: Vec<u32> = triangles.as_flattened().iter().map(|&wedge| vertex(wedge)).collect();
        kept.sort_unstable();
        kept.dedup();
        let place = |wedge: u32| kept.partition_point(|&x| x < vertex(wedge)) as u32;
        let triangles = triangles.iter().map(|triangle| triangle.map(place)).collect();
        (kept, triangles)
    }
}

/// From a corner, counted through all faces, to its face.
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
