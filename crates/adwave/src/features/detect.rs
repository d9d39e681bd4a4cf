//! Feature detection (Algorithm 2).

use super::components::Means;
use super::grid::grid_features;
use super::refine::{TangentNeighborhood, edge_ratio, refined_position, refined_sigma};
use super::response::{ResponseLayer, layers};
use super::{Feature, FeatureError, FeatureParams, Refinement, select_spread};
use crate::bands::Wavelets;
use crate::grid::Grid;
use crate::population::Population;
use crate::shape::Adjacency;
use crate::{Cancelled, Decomposer, Progress, parallel};

/// Relative difference below which responses are equal. On a symmetric shape whole orbits of vertices tie, and
/// rounding must not decide which of them is a feature.
const TIE: f64 = 1e-9;

/// Number of vertices that a thread processes at a time.
const VERTICES_AT_A_TIME: usize = 1 << 12;

/// Finds the features in the bands of a signal on the shape on which they were computed, from fine to coarse, on
/// each level the strongest first. O(n × levels × channels), and a neighborhood for each candidate.
///
/// If neighbors tie to within 1e-9 of the response, the finer level wins, then the vertex that comes first along
/// the space-filling curve of the analysis order. The features are the same for any order of the file's vertices
/// and any number of threads.
///
/// On a [grid](crate::grid::Grid), unless θ, a response or the scope is given, features are those that noise does not
/// explain: both `|W(j,x)|` and its contrast, which is W less its median over a ring of 1.5 to 2.5 σ_j around x, exceed 8
/// standard deviations of independent noise on level j, as large as the medians of the four finest dyadic levels around x
/// tell, less the part of each that an evenly bent background explains; W is extremal among the neighbors of x, and the
/// contrast among the levels; W exceeds all of W at 1.25 σ_j around x by 5.5 of the deviations and by a quarter of
/// itself, and by more if σ_j is a few places; and x is farther than σ_j from the border. Their response is the contrast,
/// their strength is in these standard deviations, and their σ is the standard deviation of a Gaussian blob.
///
/// Source: Algorithm 2, whose printed threshold lacks the bars of |R|; see [`Response`](super::Response) for R. On
/// a mesh the neighborhood is two rings, whatever one step of the diffusion covers.
///
/// # Errors
/// [`FeatureError`] for fewer than 3 levels, θ ≤ 0, an invalid option, or bands of another shape.
///
/// ```
/// use adwave::features::{FeatureParams, Response, features};
/// use adwave::sample::Sample;
/// use adwave::{Decomposer, Progress, bands::Schedule, shape::{Mesh, Shape}};
/// let sphere = Sample::from_name("sphere", Some(2000))?;
/// // A bump of the signal round the vertex 7.
/// let top = sphere.points[7];
/// let height = |p: &[f64; 3]| (-(0..3).map(|c| (p[c] - top[c]).powi(2)).sum::<f64>() / 0.04).exp();
/// let signal: Vec<f64> = sphere.points.iter().map(height).collect();
/// let shape = Shape::Mesh(Mesh::new(sphere.points, sphere.faces)?);
/// let decomposer = Decomposer::new(&shape);
/// let wavelets = decomposer.request(&signal, 1, &Schedule::dyadic(8)?).norms()?;
/// let params = FeatureParams::default().with_response(Response::Literal);
/// let found = features(&decomposer, &wavelets, &params, Progress::none())?;
/// let strongest = found.iter().max_by(|a, b| a.strength.total_cmp(&b.strength)).unwrap();
/// assert_eq!((strongest.vertex, strongest.sign()), (7, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn features(
    decomposer: &Decomposer,
    wavelets: &Wavelets,
    params: &FeatureParams,
    progress: Progress<'_>,
) -> Result<Vec<Feature>, FeatureError> {
    params.check()?;
    let n_levels = wavelets.n_levels();
    if n_levels < 3 {
        return Err(FeatureError::TooFewLevels { n_levels });
    }
    let (n_bands, n_vertices) = (wavelets.n_welded(), decomposer.n_places());
    if n_bands != n_vertices {
        return Err(FeatureError::OtherShape { n_bands, n_vertices });
    }
    if let Some(grid) = Grid::from_domain(&**decomposer.domain())
        && params.finds_significant(decomposer)
    {
        return grid_features(decomposer, grid, wavelets, params, progress);
    }
    let population = Population::new(decomposer);
    let ring = decomposer.ring(progress)?;
    let neighborhood = Neighborhood::new(&ring, decomposer.domain().feature_rings());
    let means = Means::new(&ring, params.scope, progress)?;
    let mut found: Vec<(usize, Feature)> = Vec::new();
    for layer in layers(&population, wavelets, params.response, progress)? {
        for j in 2..n_levels {
            progress.step(j as u64 - 2, n_levels as u64 - 2)?;
            let level = &layer.levels[j - 1];
            let mean = means.component_means(&population, level);
            let search = ExtremumSearch { layer: &layer, neighborhood: &neighborhood, j };
            let floor = |x: usize| params.theta() * mean[means.group(x)];
            for x in search.run(&floor, progress)? {
                let local = TangentNeighborhood::new(decomposer, &neighborhood.neighbors(x), x);
                if let Some(most) = params.max_edge_ratio
                    && edge_ratio(&local, level).is_none_or(|ratio| ratio > most)
                {
                    continue;
                }
                let response = level.value(x);
                let mut feature = Feature {
                    vertex: x,
                    position: decomposer.positions().get(x).copied(),
                    level: j,
                    sigma: wavelets.sigma[j],
                    response,
                    strength: response.abs() / mean[means.group(x)],
                    channel: layer.channel,
                };
                if params.refinement == Refinement::Quadratic {
                    feature.sigma = refined_sigma(&wavelets.sigma, &layer.levels, j, x);
                    feature.position = refined_position(&local, level).or(feature.position);
                }
                found.push((x, feature));
            }
        }
    }
    if let Some(sigmas) = params.border_sigmas {
        let widest = found.iter().map(|(_, f)| f.sigma).fold(0.0, f64::max);
        let distance = decomposer.distance_from_border(sigmas * widest, progress)?;
        found.retain(|(x, f)| distance[*x] > sigmas * f.sigma);
    }
    found.sort_by(|(x, a), (y, b)| {
        let by_level = a.level.cmp(&b.level).then(b.strength.total_cmp(&a.strength));
        by_level.then(x.cmp(y)).then(a.channel.cmp(&b.channel))
    });
    let first = first_members(decomposer);
    let of_shape = |(x, feature): (usize, Feature)| Feature { vertex: first[x] as usize, ..feature };
    let found: Vec<Feature> = found.into_iter().map(of_shape).collect();
    Ok(match params.best {
        Some(best) => select_spread(&found, best),
        None => found,
    })
}

/// First vertex of the shape in each welded vertex.
pub(super) fn first_members(decomposer: &Decomposer) -> Vec<u32> {
    let mut first = vec![u32::MAX; decomposer.n_places()];
    for (&x, vertex) in decomposer.vertex_map().as_slice().iter().zip(0..) {
        first[x as usize] = vertex.min(first[x as usize]);
    }
    first
}

/// Neighborhood in which a response is compared.
pub(super) struct Neighborhood<'a> {
    ring: &'a Adjacency,
    rings: usize,
}

impl<'a> Neighborhood<'a> {
    /// The given number of rings.
    pub(super) fn new(ring: &'a Adjacency, rings: usize) -> Self {
        Self { ring, rings }
    }

    /// The neighbors of `x`, nearest ring first, without `x`.
    pub(super) fn neighbors(&self, x: usize) -> Vec<u32> {
        let mut found = self.ring.row(x).to_vec();
        if self.rings > 1 {
            for k in 0..found.len() {
                found.extend(self.ring.row(found[k] as usize).iter().filter(|&&y| y as usize != x));
            }
            let n_first = self.ring.row(x).len();
            let (first, second) = found.split_at_mut(n_first);
            second.sort_unstable();
            let mut kept: Vec<u32> =
                second.iter().copied().filter(|y| first.binary_search(y).is_err()).collect();
            kept.dedup();
            found.truncate(n_first);
            found.append(&mut kept);
        }
        found
    }
}

/// Search for extrema on one level.
struct ExtremumSearch<'a> {
    layer: &'a ResponseLayer<'a>,
    neighborhood: &'a Neighborhood<'a>,
    j: usize,
}

impl ExtremumSearch<'_> {
    /// The features, in ascending order of vertices: |R(j,x)| above the threshold and an extremum in space and
    /// scale.
    fn run(
        &self,
        floor: &(dyn Fn(usize) -> f64 + Sync),
        progress: Progress<'_>,
    ) -> Result<Vec<usize>, Cancelled> {
        let here = &self.layer.levels[self.j - 1];
        let found = parallel::try_map_chunks(
            here.len(),
            VERTICES_AT_A_TIME,
            progress,
            || (),
            |(), range| {
                // Algorithm 2: |R(j,x)| > θ·mean|R(j)|, and an extremum over place and scale
                range
                    .filter(|&x| here.value(x).abs() > floor(x) && self.is_extremum(x))
                    .collect::<Vec<usize>>()
            },
        )?;
        Ok(found.concat())
    }

    /// True if R(j,x) is the largest or the smallest of its neighborhood in space and scale.
    fn is_extremum(&self, x: usize) -> bool {
        let levels = |y: usize| self.levels(y);
        is_extremum(x, self.neighborhood.ring.row(x), TIE, levels)
            && (self.neighborhood.rings == 1 || is_extremum(x, &self.neighborhood.neighbors(x), TIE, levels))
    }

    fn levels(&self, x: usize) -> [f64; 3] {
        [self.j - 2, self.j - 1, self.j].map(|level| self.layer.levels[level].value(x))
    }
}

/// True if R(j,x) is larger, or smaller, than R at the `neighbors` of `x` on level j, and at `x` and its neighbors
/// on levels j − 1 and j + 1 (Algorithm 2). `responses(y)` is R(j − 1, y), R(j, y) and R(j + 1, y). O(neighbors).
///
/// If two responses differ by at most `tie` of R(j,x), the finer level wins, then the smaller index.
///
/// ```
/// use adwave::features::is_extremum;
/// let responses = |y: usize| [[0.1, 0.4, 0.2], [0.3, 0.9, 0.5], [0.2, 0.8, 0.4]][y];
/// assert!(is_extremum(1, &[0, 2], 1e-9, responses));
/// assert!(!is_extremum(2, &[1], 1e-9, responses));
/// ```
pub fn is_extremum(x: usize, neighbors: &[u32], tie: f64, responses: impl Fn(usize) -> [f64; 3]) -> bool {
    let at_x = responses(x);
    [1.0, -1.0].into_iter().any(|sign| {
        let [finer, here, coarser] = at_x.map(|r| sign * r);
        let tie = tie * here.abs();
        // The finer and the coarser value at x itself exclude most candidates.
        let over_scale = |finer: f64, coarser: f64| here > finer + tie && here >= coarser - tie;
        over_scale(finer, coarser)
            && neighbors.iter().all(|&y| {
                let [finer, level, coarser] = responses(y as usize).map(|r| sign * r);
                let first = here > level + tie || (here >= level - tie && x < y as usize);
                first && over_scale(finer, coarser)
            })
    })
}
