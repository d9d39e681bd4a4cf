//! Distances between two surfaces, with proven bounds.

use crate::geometry::{Point, center, doubled_area};
use crate::proof::{Goal, PROOF_TOLERANCE, ROUNDING, bound_distance};
use crate::surface::{TriangleSearch, TriangleSurface};
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// One-sided distances from all points of one shape to the nearest points of another, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OneSided {
    /// Largest distance. For meshes it is an upper bound over all points of all triangles, not only over samples.
    pub greatest: f64,
    /// Largest distance that was found at a point, a lower bound of the largest distance. It is at least
    /// `greatest / 1.01`, except where the bounds needed too many pieces.
    pub at_least: f64,
    /// Root mean square `√(Σ a d² / Σ a)` over sample points, where a is the area that a sample point represents.
    pub rms: f64,
}

impl OneSided {
    /// Scales all distances.
    fn scaled_by(self, unit: f64) -> Self {
        Self { greatest: unit * self.greatest, at_least: unit * self.at_least, rms: unit * self.rms }
    }
}

/// Two-sided distances between a simplified shape and the original, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Distances from the original to the nearest point of the simplified shape; the samples of `rms` are the vertices
    /// of the original.
    pub of_original: OneSided,
    /// Distances from the simplified shape to the nearest point of the original; the samples of `rms` are the center
    /// and the edge midpoints of each triangle.
    pub of_simplified: OneSided,
}

impl Deviation {
    /// Larger of both largest distances; for meshes an upper bound of the Hausdorff distance.
    pub fn greatest(&self) -> f64 {
        self.of_original.greatest.max(self.of_simplified.greatest)
    }

    /// Larger of both lower bounds, a lower bound of the Hausdorff distance.
    pub fn lower_bound(&self) -> f64 {
        self.of_original.at_least.max(self.of_simplified.at_least)
    }

    /// Larger of both root mean squares.
    pub fn rms(&self) -> f64 {
        self.of_original.rms.max(self.of_simplified.rms)
    }

    /// Scales all distances.
    pub(crate) fn scaled_by(self, unit: f64) -> Self {
        Self {
            of_original: self.of_original.scaled_by(unit),
            of_simplified: self.of_simplified.scaled_by(unit),
        }
    }
}

/// Number of items that a thread processes at a time; the sums do not depend on the number of threads.
const ITEMS_PER_CHUNK: usize = 1 << 10;

/// Number of pieces into which every triangle may be divided.
const PIECES_PER_TRIANGLE: usize = 256;

/// Number of pieces per triangle of both surfaces, distributed by area. A common refinement has fewer.
const PIECES_BY_AREA: f64 = 64.0;

/// One of two compared surfaces, as triangles over points.
#[derive(Clone, Copy)]
pub(crate) struct SurfaceView<'a> {
    pub(crate) points: &'a [Point],
    pub(crate) triangles: &'a [[u32; 3]],
}

impl SurfaceView<'_> {
    fn corners(&self, t: usize) -> [Point; 3] {
        self.triangles[t].map(|x| self.points[x as usize])
    }

    /// Lists one triangle at each point, `u32::MAX` if there is none.
    pub(crate) fn triangle_at_points(&self) -> Vec<u32> {
        let mut found = vec![u32::MAX; self.points.len()];
        for (t, triangle) in self.triangles.iter().enumerate() {
            for &x in triangle {
                found[x as usize] = t as u32;
            }
        }
        found
    }
}

/// Distance of a sample point, the nearest triangle, and the area that the point represents.
#[derive(Clone, Copy)]
struct DistanceSample {
    distance: f64,
    near: u32,
    area: f64,
}

/// Computes the values of n items in parallel; `value` receives the index of an item and the value of the previous
/// item, if there is one in the chunk.
fn collect<T: Send>(
    n: usize,
    progress: Progress<'_>,
    value: impl Fn(usize, Option<&T>) -> T + Sync,
) -> Result<Vec<T>, Cancelled> {
    let chunks = (0..n.div_ceil(ITEMS_PER_CHUNK)).into_par_iter().map(|c| {
        progress.check()?;
        let mut values = Vec::with_capacity(ITEMS_PER_CHUNK);
        for k in c * ITEMS_PER_CHUNK..((c + 1) * ITEMS_PER_CHUNK).min(n) {
            values.push(value(k, values.last()));
        }
        Ok(values)
    });
    let chunks: Vec<Vec<T>> = chunks.collect::<Result<_, Cancelled>>()?;
    Ok(chunks.into_iter().flatten().collect())
}

/// Largest distance and root mean square of the samples, summed in their order.
fn summarize<'a>(samples: impl Iterator<Item = &'a DistanceSample>) -> (f64, f64) {
    let (mut greatest, mut squares, mut area) = (0.0_f64, 0.0, 0.0);
    for sample in samples {
        greatest = greatest.max(sample.distance);
        squares += sample.area * sample.distance * sample.distance;
        area += sample.area;
    }
    (greatest, if area > 0.0 { f64::sqrt(squares / area) } else { 0.0 })
}

/// Bounds the distances of all triangles of a surface, given known distances, and for each triangle some triangles that
/// are near.
fn bound_all(
    from: SurfaceView<'_>,
    to: &TriangleSurface,
    known: OneSided,
    progress: Progress<'_>,
    hints: impl Fn(usize) -> Option<[u32; 3]> + Sync,
) -> Result<OneSided, Cancelled> {
    let areas: Vec<f64> = (0..from.triangles.len()).map(|t| doubled_area(from.corners(t))).collect();
    let total: f64 = areas.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let pieces = PIECES_BY_AREA * (from.triangles.len() + to.len()) as f64;
    let accepted = known.at_least * (1.0 + PROOF_TOLERANCE) + ROUNDING;
    let bounds = collect(from.triangles.len(), progress, |t, _| {
        let hints = hints(t)?;
        let max_pieces = PIECES_PER_TRIANGLE + (pieces * areas[t] / total) as usize;
        let goal = Goal { accepted, limit: f64::INFINITY, max_pieces, stops_beyond_limit: false };
        Some(bound_distance(from.corners(t), &hints, to, &goal, &mut |_| {}))
    })?;
    let mut side = known;
    for bounds in bounds.iter().flatten() {
        side.greatest = side.greatest.max(bounds.upper);
        side.at_least = side.at_least.max(bounds.lower);
    }
    // Rounding of nearly equal distances must not turn the bounds around.
    side.at_least = side.at_least.min(side.greatest);
    Ok(side)
}

/// Measures the distance from the original to a simplified surface; points with a triangle in `triangle_at` lie on that
/// triangle.
pub(crate) fn measure_original(
    original: SurfaceView<'_>,
    areas: &[f64],
    triangle_at: &[u32],
    to: &TriangleSurface,
    progress: Progress<'_>,
) -> Result<OneSided, Cancelled> {
    let samples = collect(original.points.len(), progress, |x, before: Option<&DistanceSample>| {
        // Successive points are often neighbors.
        let start = before.map_or(0, |sample| sample.near);
        let (squared, near) = if triangle_at[x] == u32::MAX {
            to.nearest_from(original.points[x], start)
        } else {
            (0.0, triangle_at[x])
        };
        DistanceSample { distance: squared.sqrt(), near, area: areas[x] }
    })?;
    let (greatest, rms) = summarize(samples.iter());
    let known = OneSided { greatest, at_least: greatest, rms };
    let hints = |t: usize| Some(original.triangles[t].map(|x| samples[x as usize].near));
    bound_all(original, to, known, progress, hints)
}

/// Measures the distance from a simplified surface to the original. The triangles for whose numbers `is_original` is
/// true belong to the original; `triangle_at` has a triangle of the original at each point.
pub(crate) fn measure_simplified(
    simplified: SurfaceView<'_>,
    is_original: impl Fn(usize) -> bool + Sync,
    triangle_at: &[u32],
    to: &TriangleSurface,
    progress: Progress<'_>,
) -> Result<OneSided, Cancelled> {
    let samples = collect(simplified.triangles.len(), progress, |t, _| {
        let corners = simplified.corners(t);
        let area = doubled_area(corners) / 8.0;
        if is_original(t) {
            return ([DistanceSample { distance: 0.0, near: u32::MAX, area }; 4], true);
        }
        let [a, b, c] = corners;
        let points = [center(&[a, b, c]), center(&[a, b]), center(&[b, c]), center(&[c, a])];
        let mut start = triangle_at[simplified.triangles[t][0] as usize];
        let sample = |p: Point| {
            let (squared, near) = to.nearest_from(p, start);
            start = near;
            DistanceSample { distance: squared.sqrt(), near, area }
        };
        (points.map(sample), false)
    })?;
    let (greatest, rms) = summarize(samples.iter().flat_map(|(samples, _)| samples));
    let known = OneSided { greatest, at_least: greatest, rms };
    let hints = |t: usize| {
        let (samples, is_original) = &samples[t];
        let corner = simplified.triangles[t][0];
        (!is_original).then(|| [samples[0].near, samples[1].near, triangle_at[corner as usize]])
    };
    bound_all(simplified, to, known, progress, hints)
}

/// A surface as triangles over points.
#[derive(Clone, Copy, Debug)]
pub struct Triangles<'a> {
    /// Positions in model units.
    pub points: &'a [[f64; 3]],
    /// Corners of each triangle.
    pub triangles: &'a [[u32; 3]],
}

/// Measures the distance from all points of all triangles of one surface to another, in model units; `None` if one has
/// no triangles. The samples of `rms` are the vertices of `from`. O(n log n), with more pieces where the surfaces are
/// nearly equally far apart.
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// ```
/// use adwave::Progress;
/// use adwave_simplify::{Triangles, surface_distance};
/// // The middle of a long edge is above a valley whose two slopes meet at depth 1.
/// let points =
///     [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 4.0, 0.0], [1.0, 4.0, 0.0], [0.0, 4.0, -1.0]];
/// let plane = Triangles { points: &points, triangles: &[[0, 1, 4], [0, 4, 3]] };
/// let valley = Triangles { points: &points, triangles: &[[0, 2, 5], [0, 5, 3], [2, 1, 4], [2, 4, 5]] };
/// let found = surface_distance(plane, valley, Progress::none())?.expect("both have triangles");
/// assert!((found.at_least - 0.5_f64.sqrt()).abs() < 0.01 && found.greatest >= 0.5_f64.sqrt() - 1e-12);
/// # Ok::<(), adwave::Cancelled>(())
/// ```
pub fn surface_distance(
    from: Triangles<'_>,
    to: Triangles<'_>,
    progress: Progress<'_>,
) -> Result<Option<OneSided>, Cancelled> {
    let all = || from.points.iter().chain(to.points);
    let bound = |pick: fn(f64, f64) -> f64, start: f64| -> Point {
        std::array::from_fn(|c| all().map(|p| p[c]).fold(start, pick))
    };
    let (low, high) = (bound(f64::min, f64::INFINITY), bound(f64::max, f64::NEG_INFINITY));
    let extent = (0..3).map(|c| high[c] - low[c]).fold(0.0, f64::max);
    // A power of two: the positions keep their digits, but for the shift to the middle.
    let unit = if extent > 0.0 { extent.log2().ceil().exp2() } else { 1.0 };
    let boxed = |points: &[Point]| -> Vec<Point> {
        let place = |p: &Point| std::array::from_fn(|c| (p[c] - 0.5 * (low[c] + high[c])) / unit);
        points.iter().map(place).collect()
    };
    let (from_points, to_points) = (boxed(from.points), boxed(to.points));
    let Some(surface) = TriangleSurface::new(&to_points, to.triangles) else { return Ok(None) };
    if from.triangles.is_empty() {
        return Ok(None);
    }
    let areas = vertex_areas(&from_points, from.triangles);
    let whole = SurfaceView { points: &from_points, triangles: from.triangles };
    let is_used = whole.triangle_at_points();
    // Points without a triangle are no part of the surface.
    let used: Vec<u32> = (0..from_points.len() as u32).filter(|&x| is_used[x as usize] != u32::MAX).collect();
    let mut number = vec![0; from_points.len()];
    used.iter().zip(0..).for_each(|(&x, k)| number[x as usize] = k);
    let pick = |x: &u32| *x as usize;
    let points: Vec<Point> = used.iter().map(|x| from_points[pick(x)]).collect();
    let areas: Vec<f64> = used.iter().map(|x| areas[pick(x)]).collect();
    let triangles: Vec<[u32; 3]> = from.triangles.iter().map(|t| t.map(|x| number[x as usize])).collect();
    let view = SurfaceView { points: &points, triangles: &triangles };
    let unknown = vec![u32::MAX; points.len()];
    Ok(Some(measure_original(view, &areas, &unknown, &surface, progress)?.scaled_by(unit)))
}

/// Vertex areas: a third of the area of the adjacent triangles, in the squared unit of the points.
pub(crate) fn vertex_areas(points: &[Point], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for triangle in triangles {
        let share = doubled_area(triangle.map(|x| points[x as usize])) / 6.0;
        for &x in triangle {
            areas[x as usize] += share;
        }
    }
    areas
}
