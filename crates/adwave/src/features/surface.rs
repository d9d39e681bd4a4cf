//! Features of the coordinates of a mesh, independent of its triangles.
//!
//! On a smooth surface the band of the coordinates is the mean curvature at the width of the level. Two things make it
//! uneven where the surface is not: the triangles, which no diffusion on a mesh ignores completely, and noise. The first
//! is measured by a signal whose bands are known, the squared distance, and corrected; what is left of both shows on the
//! two finest levels as roughness between adjacent vertices, and how much of it reaches a coarser level follows from the
//! area of the kernel. A feature must stand out from the ring around it by many times as much.

use super::best::select_spread_by;
use super::cloud::{MOST_CORRECTION, ROUNDING};
use super::detect::{Neighborhood, first_members};
use super::disk::PointGrid;
use super::refine::{TangentNeighborhood, edge_ratio, parabola_peak, refined_position};
use super::response::ResponseLevel;
use super::{
    CoordinateFeatureError, CoordinateFeatures, Feature, FeatureParams, Refinement, ShapeCoordinates,
};
use crate::bands::Wavelets;
use crate::population::Population;
use crate::rows::Pattern;
use crate::saliency::{VARIANCE, noise_times_area, unit_length};
use crate::shape::{Adjacency, PreparedGeometry, squared_distance, triangles_at_vertices};
use crate::vector::{cross, dot, subtract};
use crate::{Cancelled, Decomposer, Progress, parallel};
use std::collections::{HashSet, VecDeque};

/// Least contrast of a feature, in standard deviations due to noise and to the triangles.
const SIGNIFICANT: f64 = 14.0;

/// Largest error of a level due to the triangles, relative to the response of a sphere that is curved as the surroundings
/// are, for short edges as long as σ, divided by [`SIGNIFICANT`]; it falls with the square of the length of the edges.
const SYSTEMATIC: f64 = 0.3 / SIGNIFICANT;

/// Increase of that error, relative to itself, for edges as long as σ; it falls with the length of the edges.
const LONG_EDGES: f64 = 2.5;

/// Response of a sphere divided by σ, relative to the root mean square difference between the normal at a point and those
/// of the disk around it: ½ by ½·2.5/√2.
const RESPONSE_OF_NORMALS: f64 = 0.283;

/// Radii of the ring that a feature is compared with, in σ.
const RING: [f64; 2] = [1.5, 2.5];

/// Fewest points of a ring.
const FEWEST: usize = 6;

/// Distance between the points of a ring, in σ; more of them tell no more.
const SPACING: f64 = 0.25;

/// Distance from the border in σ up to which a level has no features, unless another is given: where the border reaches
/// the ring.
const BORDER: f64 = RING[1] + RING_BORDER;

/// Distance from the border in σ below which the border changes the response, so that a point does not belong to a ring.
const RING_BORDER: f64 = 1.5;

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// Exponent of σ by which contrasts are divided to compare levels. The end of a limb has the same contrast on all levels
/// that are wider than it, and the finest of them is its size. With this exponent σ_j of the level of a Gaussian bump is
/// its standard deviation, too: 0.92 to 0.99 of it.
const PREFERENCE: f64 = 0.25;

/// Relative difference of responses that are equal.
const TIE: f64 = 1e-9;

/// Contrast beside a detail of the opposite sign, relative to its own: twice that of a Gaussian bump.
const SIDE_LOBE: f64 = 0.26;

/// Ratio of widths at which a side lobe has half of that contrast.
const SIDE_LOBE_WIDTHS: f64 = 2.2;

/// Distance within which side lobes lie, in the larger σ.
const SIDE_LOBE_REACH: f64 = 3.0;

/// Largest share of the surface around a feature that faces the other way and responds otherwise.
const OTHER_SIDE: f64 = 0.15;

/// Distance up to which surface belongs to that, in σ.
const SIDES_REACH: f64 = 1.5;

/// Largest number of levels between two features of which one describes the other.
const LEVELS_OF_ONE: usize = 2;

/// Finds the features of the coordinates of a mesh; see [`coordinate_features`](super::coordinate_features).
pub(super) fn mesh_features(
    decomposer: &Decomposer,
    coordinates: &ShapeCoordinates<'_>,
    normals: &[[f64; 3]],
    params: &FeatureParams,
    progress: Progress<'_>,
) -> Result<CoordinateFeatures, CoordinateFeatureError> {
    let geometry = decomposer.geometry_for("a search for features of a mesh")?;
    let ring = decomposer.ring(progress.quiet())?;
    let wavelets = responses(decomposer, geometry, coordinates, normals, progress)?;
    let finest: Vec<&[f64]> = wavelets.levels.iter().take(2).map(Vec::as_slice).collect();
    let roughness = noise_times_area(decomposer, &finest, &ring);
    let points = decomposer.positions();
    let square_edges: Vec<f64> = parallel::collect(points.len(), |x| {
        let row = ring.row(x);
        let sum: f64 = row.iter().map(|&y| squared_distance(&points[x], &points[y as usize])).sum();
        sum / row.len().max(1) as f64
    });
    let border_sigmas = params.border_sigmas.unwrap_or(BORDER);
    let widest = wavelets.sigma.last().copied().unwrap_or(0.0);
    let from_border =
        decomposer.distance_from_border(border_sigmas.max(RING_BORDER) * widest, progress.quiet())?;
    let accuracy = coordinates.bands.accuracy;
    let population = Population::new(decomposer);
    let floors: Vec<f64> = (1..=wavelets.n_levels())
        .map(|j| {
            let (level, sigma) = (&wavelets.levels[j - 1], wavelets.sigma[j]);
            let square =
                population.mean_over(level.len(), |x| if level[x].is_nan() { 0.0 } else { level[x].powi(2) });
            accuracy * square.sqrt() / sigma + ROUNDING / SIGNIFICANT
        })
        .collect();
    let search = Search {
        decomposer,
        wavelets: &wavelets,
        roughness: &roughness,
        normals,
        ring: &ring,
        square_edges: &square_edges,
        from_border: &from_border,
        border_sigmas,
        floors: &floors,
    };
    let mut found = Vec::new();
    let mut disks: VecDeque<Disks<'_>> = VecDeque::new();
    for j in 1..=wavelets.n_levels() {
        progress.check()?;
        disks.push_back(Disks::new(&search, j, progress.quiet())?);
        if disks.len() == 3 {
            found.extend(search.level(j - 1, disks.make_contiguous(), params, progress.quiet())?);
            disks.pop_front();
        }
    }
    let points = decomposer.positions();
    let places: Vec<[f64; 3]> = found.iter().map(|feature| points[feature.vertex]).collect();
    let mut features = without_side_lobes(&found, &places, progress.quiet())?;
    features.sort_by(|a, b| {
        a.level.cmp(&b.level).then(b.strength.total_cmp(&a.strength)).then(a.vertex.cmp(&b.vertex))
    });
    let first = first_members(decomposer);
    for feature in &mut features {
        feature.vertex = first[feature.vertex] as usize;
    }
    if let Some(best) = params.best {
        // A standard deviation shrinks with σ, so that strengths of different widths don't compare; contrasts do.
        features = select_spread_by(&features, best, |feature| feature.response.abs());
    }
    Ok(CoordinateFeatures { features, wavelets })
}

/// Components of the bands of the coordinates along the normals of the smoothed surface, corrected for the triangles, as
/// bands of one channel.
///
/// The component along the normal is multiplied by `m_j/M_j(x)` with `M_j(x) = Σ_y ψ_j(x,y)·|y − x|²`, the second moment
/// of the wavelet, and its value `m_j = −(σ_j² − σ_(j−1)²)` for heat on a plane. If both principal curvatures are equal,
/// what the triangles do to the component cancels. The normals are those of the surface smoothed by S(j), so that noise
/// does not tilt them. The squared distance from the center is the fourth channel, with which M_j is known.
fn responses(
    decomposer: &Decomposer,
    geometry: &PreparedGeometry,
    coordinates: &ShapeCoordinates<'_>,
    normals: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Wavelets, CoordinateFeatureError> {
    const CHANNELS: usize = 4;
    let points = decomposer.positions();
    let n = points.len();
    // In units of the extent, so that squares neither overflow nor underflow.
    let unit = if decomposer.extent().is_normal() { decomposer.extent() } else { 1.0 };
    let center: [f64; 3] =
        std::array::from_fn(|c| parallel::sum(n, |x| points[x][c] / unit) / n.max(1) as f64);
    let from_center: Vec<[f64; 3]> =
        parallel::collect(n, |x| std::array::from_fn(|c| points[x][c] / unit - center[c]));
    let row = |x: usize| {
        let p = from_center[x];
        [p[0], p[1], p[2], dot(&p, &p)]
    };
    let map = decomposer.vertex_map().as_slice();
    let signal: Vec<[f64; CHANNELS]> = parallel::collect(map.len(), |v| row(map[v] as usize));
    let request = decomposer.request(signal.as_flattened(), CHANNELS, coordinates.schedule);
    let mut wavelets = request.params(&coordinates.bands).progress(progress).wavelets()?;
    drop(signal);
    wavelets.n_channels = 1;
    let orientation = Orientation::new(geometry, &from_center, normals, progress.quiet())?;
    let mut smoothed = from_center.clone();
    let mut finer = 0.0;
    for (level, sigma) in wavelets.levels.iter_mut().zip(&wavelets.sigma[1..]) {
        let rows = level.as_chunks::<CHANNELS>().0;
        parallel::visit_rows(&mut smoothed, 1, VERTICES_AT_A_TIME, |first, points| {
            for (point, row) in points.iter_mut().zip(&rows[first..]) {
                (0..3).filter(|&c| !row[c].is_nan()).for_each(|c| point[c] -= row[c]);
            }
        });
        let level_normals = orientation.normals(&smoothed, normals);
        let square = (sigma / unit).powi(2);
        let usual = finer - square;
        finer = square;
        let response = |x: usize| {
            let [a, b, c, square] = rows[x];
            let band = [a, b, c];
            let moment = square - 2.0 * dot(&band, &from_center[x]);
            let correction = usual / moment;
            let correction = if correction > 0.0 && correction.is_finite() {
                correction.clamp(1.0 / MOST_CORRECTION, MOST_CORRECTION)
            } else {
                1.0
            };
            // Where a thin part has collapsed into its axis, the smoothed surface has no normal of this place.
            let is_same_side = dot(&level_normals[x], &normals[x]) > 0.0;
            let normal = if is_same_side { &level_normals[x] } else { &normals[x] };
            unit * correction * dot(&band, normal)
        };
        *level = parallel::collect(rows.len(), response);
    }
    Ok(wavelets)
}

/// Sides of the triangles, from which normals of the surface follow when its vertices move.
struct Orientation<'a> {
    triangles: &'a [[u32; 3]],
    at_vertex: Pattern,
    is_turned: Vec<bool>,
}

impl<'a> Orientation<'a> {
    /// The sides of which the given normals of the vertices are.
    fn new(
        geometry: &'a PreparedGeometry,
        points: &[[f64; 3]],
        normals: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let triangles = geometry.triangles();
        let at_vertex = triangles_at_vertices(points.len(), triangles, progress)?;
        let is_turned = parallel::collect(triangles.len(), |f| {
            let normal = triangle_normal(points, &triangles[f]);
            triangles[f].iter().map(|&x| dot(&normal, &normals[x as usize])).sum::<f64>() < 0.0
        });
        Ok(Self { triangles, at_vertex, is_turned })
    }

    /// Unit normals of the surface with its vertices at `points`: means over the triangles, weighted by their areas;
    /// where they cancel, those of `other`.
    fn normals(&self, points: &[[f64; 3]], other: &[[f64; 3]]) -> Vec<[f64; 3]> {
        parallel::collect(points.len(), |x| {
            let mut sum = [0.0; 3];
            for &f in self.at_vertex.row(x) {
                let normal = triangle_normal(points, &self.triangles[f as usize]);
                let sign = if self.is_turned[f as usize] { -1.0 } else { 1.0 };
                (0..3).for_each(|c| sum[c] += sign * normal[c]);
            }
            let length = dot(&sum, &sum).sqrt();
            if length.is_normal() { sum.map(|c| c / length) } else { other[x] }
        })
    }
}

/// Normal of a triangle, as long as twice its area.
fn triangle_normal(points: &[[f64; 3]], triangle: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = triangle.map(|x| &points[x as usize]);
    cross(&subtract(b, a), &subtract(c, a))
}

/// Search on the levels of one shape.
struct Search<'a> {
    decomposer: &'a Decomposer,
    wavelets: &'a Wavelets,
    roughness: &'a [f64],
    normals: &'a [[f64; 3]],
    ring: &'a Adjacency,
    /// Mean square length of the edges at each vertex, in squared model units.
    square_edges: &'a [f64],
    from_border: &'a [f64],
    border_sigmas: f64,
    /// Error of the bands of each level, divided by σ.
    floors: &'a [f64],
}

/// Comparison of a point with its surroundings on a level.
#[derive(Clone, Copy)]
struct Contrast {
    /// Response less the median over the ring, divided by σ.
    value: f64,
    /// Standard deviation of the value due to noise and to the triangles.
    deviation: f64,
}

impl Search<'_> {
    /// Features of level `j`, in ascending order of vertices; `disks` are those of the levels j − 1, j and j + 1.
    fn level(
        &self,
        j: usize,
        disks: &[Disks<'_>],
        params: &FeatureParams,
        progress: Progress<'_>,
    ) -> Result<Vec<Feature>, Cancelled> {
        let wavelets = &self.wavelets;
        let here = &wavelets.levels[j - 1];
        let reach = self.border_sigmas * wavelets.sigma[j];
        let extrema = parallel::try_map_chunks(
            here.len(),
            VERTICES_AT_A_TIME,
            progress,
            || (),
            |(), range| {
                range
                    .filter(|&x| self.from_border[x] > reach && self.is_extremum(here, x))
                    .collect::<Vec<usize>>()
            },
        )?
        .concat();
        let level = ResponseLevel::plain(here);
        let candidates: Vec<Option<Feature>> = parallel::map_items(here.len(), extrema.len(), |k| {
            self.candidate(extrema[k], j, disks, &level, params)
        });
        Ok(candidates.into_iter().flatten().collect())
    }

    /// True if the response at `x` is the largest or the smallest within two rings; equal ones belong to the first.
    fn is_extremum(&self, level: &[f64], x: usize) -> bool {
        let value = level[x];
        let neighbors = self.ring.row(x);
        if value.is_nan() || neighbors.is_empty() {
            return false;
        }
        let tie = TIE * value.abs();
        [1.0, -1.0].into_iter().any(|sign| {
            let is_below = |y: u32| {
                let difference = sign * (value - level[y as usize]);
                y as usize == x || difference > tie || (difference >= -tie && x < y as usize)
            };
            neighbors.iter().all(|&y| is_below(y))
                && neighbors.iter().all(|&y| self.ring.row(y as usize).iter().all(|&z| is_below(z)))
        })
    }

    /// The feature at an extremum, if its contrast is significant and larger than on the levels beside it.
    fn candidate(
        &self,
        x: usize,
        j: usize,
        disks: &[Disks<'_>],
        level: &ResponseLevel<'_>,
        params: &FeatureParams,
    ) -> Option<Feature> {
        let here = disks[1].contrast(x)?;
        let strength = here.value.abs() / here.deviation;
        if strength <= SIGNIFICANT {
            return None;
        }
        let sign = here.value.signum();
        let sigma = [j - 1, j, j + 1].map(|level| self.wavelets.sigma[level]);
        let beside = |k: usize| disks[k].contrast(x).map_or(0.0, |contrast| sign * contrast.value);
        let contrasts = [beside(0), here.value.abs(), beside(2)];
        let compared: [f64; 3] =
            std::array::from_fn(|k| contrasts[k] * (sigma[1] / sigma[k]).powf(PREFERENCE));
        let tie = TIE * compared[1];
        if compared[0] >= compared[1] - tie || compared[2] > compared[1] + tie {
            return None;
        }
        // The extremum must be of the same kind as the contrast: a maximum above the ring, or a minimum below it.
        let is_peak = self
            .ring
            .row(x)
            .iter()
            .all(|&y| sign * (level.value(x) - level.value(y as usize)) >= -TIE * level.value(x).abs());
        if !is_peak {
            return None;
        }
        if !self.is_same_on_other_side(x, j, sign) {
            return None;
        }
        let mut feature = Feature {
            vertex: x,
            position: self.decomposer.positions().get(x).copied(),
            level: j,
            sigma: parabola_peak(sigma, compared),
            response: here.value,
            strength,
            channel: None,
        };
        if params.refinement == Refinement::Quadratic || params.max_edge_ratio.is_some() {
            let local = TangentNeighborhood::new(self.decomposer, &self.two_rings(x), x);
            if let Some(most) = params.max_edge_ratio
                && edge_ratio(&local, level).is_none_or(|ratio| ratio > most)
            {
                return None;
            }
            if params.refinement == Refinement::Quadratic {
                feature.position = refined_position(&local, level).or(feature.position);
            }
        }
        Some(feature)
    }

    /// True if most of the surface around `x` faces the same way on level `j`, or the response of the rest has the sign
    /// `sign` too. Around a part that is thinner than σ the band is one vector, so that where one side seems to be a dent
    /// the opposite one seems to be a bump, and neither is. The end of a limb is a bump on all sides.
    fn is_same_on_other_side(&self, x: usize, j: usize, sign: f64) -> bool {
        let (sigma, level) = (self.wavelets.sigma[j], &self.wavelets.levels[j - 1]);
        let points = self.decomposer.positions();
        let areas = self.decomposer.place_measure();
        let mut reached = HashSet::from([x as u32]);
        let mut next = vec![x as u32];
        let (mut whole, mut other, mut response) = (0.0, 0.0, 0.0);
        while let Some(y) = next.pop() {
            let y = y as usize;
            let squared_sigmas = squared_distance(&points[x], &points[y]) / (sigma * sigma);
            if squared_sigmas > SIDES_REACH * SIDES_REACH || level[y].is_nan() {
                continue;
            }
            let weight = areas.map_or(1.0, |areas| areas[y]) * (-0.5 * squared_sigmas).exp();
            whole += weight;
            if dot(&self.normals[x], &self.normals[y]) < 0.0 {
                other += weight;
                response += weight * level[y];
            }
            next.extend(self.ring.row(y).iter().filter(|&&z| reached.insert(z)));
        }
        other <= OTHER_SIDE * whole || sign * response > 0.0
    }

    /// Vertices within two rings of `x`, without `x`.
    fn two_rings(&self, x: usize) -> Vec<u32> {
        Neighborhood::new(self.ring, 2).neighbors(x)
    }
}

/// Points in which the surroundings of a place are measured on one level, spread evenly over the area.
struct Disks<'a> {
    search: &'a Search<'a>,
    grid: PointGrid,
    j: usize,
}

impl<'a> Disks<'a> {
    fn new(search: &'a Search<'a>, j: usize, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let sigma = search.wavelets.sigma[j];
        let level = &search.wavelets.levels[j - 1];
        let least = (SPACING * sigma).powi(2);
        let mut area = least;
        let is_chosen = |x: &u32| {
            let x = *x as usize;
            area += search.decomposer.place_measure().map_or(least, |areas| areas[x]);
            let is_chosen =
                area >= least && !level[x].is_nan() && search.from_border[x] > RING_BORDER * sigma;
            if is_chosen {
                area = if area < 2.0 * least { area - least } else { area % least };
            }
            is_chosen
        };
        let points = search.decomposer.positions();
        let chosen: Vec<u32> = (0..points.len() as u32).filter(is_chosen).collect();
        Ok(Self { search, grid: PointGrid::new(points, &chosen, RING[1] * sigma, progress)?, j })
    }

    /// Contrast of `x` on the level; `None` if too few points surround it. Points of an opposite side of the surface do
    /// not count.
    fn contrast(&self, x: usize) -> Option<Contrast> {
        let Search { decomposer, wavelets, roughness, normals, square_edges, floors, .. } = self.search;
        let (sigma, level) = (wavelets.sigma[self.j], &wavelets.levels[self.j - 1]);
        let points = decomposer.positions();
        let inner = (RING[0] * sigma).powi(2);
        let mut around: Vec<f64> = Vec::new();
        let (mut squares, mut bends, mut edges, mut n_disk) = (0.0, 0.0, 0.0, 0_usize);
        self.grid.visit_within(points, &points[x], RING[1] * sigma, |y, away| {
            let cosine = dot(&normals[x], &normals[y]);
            if cosine < 0.0 {
                return;
            }
            squares += roughness[y];
            bends += 2.0 * (1.0 - cosine);
            edges += square_edges[y];
            n_disk += 1;
            if away >= inner {
                around.push(level[y]);
            }
        });
        if around.len() < FEWEST {
            return None;
        }
        let middle = around.len() / 2;
        let median = *around.select_nth_unstable_by(middle, f64::total_cmp).1;
        let share = 1.0 / n_disk as f64;
        let noise = (VARIANCE * share * squares).sqrt() / sigma * (unit_length(decomposer) / sigma);
        let square = share * edges / (sigma * sigma);
        let systematic = SYSTEMATIC
            * RESPONSE_OF_NORMALS
            * (share * bends).sqrt()
            * square
            * (1.0 + LONG_EDGES * square.sqrt());
        let deviation = noise.hypot(systematic).hypot(floors[self.j - 1]);
        Some(Contrast { value: (level[x] - median) / sigma, deviation })
    }
}

/// The features that are neither a side lobe of others nor a weaker answer to the same detail, in the given order;
/// `places` are their positions.
///
/// Beside a bump of Gaussian section its band is negative, by 13 % of its height at the width of the bump and by less on
/// coarser levels. A feature stays if its contrast is at least twice what all details of the opposite sign explain.
pub(super) fn without_side_lobes(
    found: &[Feature],
    places: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<Feature>, Cancelled> {
    let n_levels = found.iter().map(|feature| feature.level).max().unwrap_or(0);
    let grid = |j: usize| {
        let of_level: Vec<u32> = (0..found.len() as u32).filter(|&k| found[k as usize].level == j).collect();
        let widest = of_level.iter().map(|&k| found[k as usize].sigma).fold(0.0, f64::max);
        let size = (SIDE_LOBE_REACH * widest).max(f64::MIN_POSITIVE);
        Ok((widest, PointGrid::new(places, &of_level, size, progress)?))
    };
    let grids: Vec<(f64, PointGrid)> = (0..=n_levels).map(grid).collect::<Result<_, Cancelled>>()?;
    let is_explained = |k: usize| {
        let own = &found[k];
        let (mut explained, mut is_same) = (0.0, false);
        for (j, (widest, grid)) in grids.iter().enumerate() {
            let reach = SIDE_LOBE_REACH * widest.max(own.sigma);
            grid.visit_within(places, &places[k], reach, |m, away| {
                let other = &found[m];
                let (own_size, other_size) = (own.response.abs(), other.response.abs());
                let sigma = own.sigma.max(other.sigma);
                let away = away.sqrt();
                if m == k || away > SIDE_LOBE_REACH * sigma {
                    return;
                }
                if own.response.signum() == other.response.signum() {
                    let is_stronger = other_size > own_size || (other_size == own_size && m < k);
                    is_same |= is_stronger && away <= sigma && j.abs_diff(own.level) <= LEVELS_OF_ONE;
                } else if other_size > own_size {
                    let widths = sigma / own.sigma.min(other.sigma);
                    explained += SIDE_LOBE * other_size / (1.0 + (widths / SIDE_LOBE_WIDTHS).powi(3));
                }
            });
        }
        is_same || own.response.abs() < explained
    };
    let explained: Vec<bool> = parallel::map_items(found.len(), found.len(), is_explained);
    let kept = found.iter().zip(explained).filter(|(_, is_explained)| !is_explained);
    Ok(kept.map(|(feature, _)| feature.clone()).collect())
}
