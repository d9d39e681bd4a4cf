//! The prepared object: a shape with its diffusion operator, for repeated use.

mod border;
mod creases;
mod default_schedule;
mod given_walk;
mod labels;
mod level_spec;
mod request;

pub use level_spec::{LevelSpec, LevelSpecError, ResolvedLevels};
pub use request::BandsRequest;

use crate::bands::{Bands, BandsError, BandsParams, Schedule, Transform, levels_reaching};
use crate::basis::{BasisError, SparseRow, check_whole, one_vertex};
use crate::local_fit::{FitDomain, LinearTransform, LocalFit};
use crate::mask::{Mask, MaskError};
use crate::operator::{
    Diffusion, EndPoints, NoRows, Operator, OperatorKind, OperatorParams, RowWeights, Semigroup,
    SurfaceDiffusion, SurfaceInfo, local_operator, surface_diffusion,
};
use crate::parallel::expect_not_cancelled;
use crate::region::{MetricEdges, SurfaceMetric};
use crate::shape::{Adjacency, Health, PreparedGeometry, Shape, health, squared_distance};
use crate::signal::{CloseSheets, close_sheets};
use crate::{Cancelled, Progress};
use creases::respect_creases;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// Scaling function and wavelet of one vertex on one level, one value per vertex of the shape. Welded vertices
/// share their value, so sums run over the welded vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexFunctions {
    /// Scaling function φ: entries ≥ 0 that sum to 1.
    pub scaling_function: Vec<f64>,
    /// Wavelet ψ: entries sum to 0.
    pub wavelet: Vec<f64>,
    /// Number of welded vertices at which φ is not 0.
    pub support: usize,
}

impl VertexFunctions {
    /// Smallest number of vertices of the shape whose values hold the fraction `share` in [0, 1] of the sum of φ
    /// over them. O(n log n).
    ///
    /// ```
    /// use adwave::VertexFunctions;
    /// let scaling_function = vec![0.5, 0.25, 0.2499, 0.0001];
    /// let functions = VertexFunctions { scaling_function, wavelet: vec![0.0; 4], support: 4 };
    /// assert_eq!((functions.n_holding(0.5), functions.n_holding(0.999), functions.n_holding(1.0)), (1, 3, 4));
    /// ```
    pub fn n_holding(&self, share: f64) -> usize {
        let mut sizes = self.scaling_function.clone();
        sizes.sort_by(|a, b| b.total_cmp(a));
        let needed = share * sizes.iter().sum::<f64>();
        let mut sum = 0.0;
        let less = sizes.iter().take_while(|&&v| {
            sum += v;
            sum < needed && v > 0.0
        });
        (less.count() + 1).min(sizes.len())
    }
}

/// A shape with its diffusion operator, prepared once in O(n log n). Each signal then costs only its products.
///
/// It owns its data and is cheap to clone; clones share everything and may be used from several threads at once.
/// Data that only some requests need (the tiles of the products, the search tree of regions) is built by the first
/// such request.
///
/// ```
/// use adwave::{Decomposer, bands::Schedule, shape::{PointCloud, Shape}};
/// let points: Vec<_> = (0..100).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points.clone())?));
/// let bands = decomposer.decompose(points.as_flattened(), 3, &Schedule::dyadic(4)?)?;
/// assert_eq!(bands.steps, [0.0, 1.0, 2.0, 4.0, 8.0]);
/// assert!(bands.reconstruct().iter().zip(points.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Decomposer {
    geometry: Arc<PreparedGeometry>,
    transform: Transform,
    /// The rows of the shape's own operator, if those of the given one are not known.
    own_rows: Option<Arc<Diffusion>>,
    /// Areas of the welded vertices.
    areas: Arc<[f64]>,
    mean_length: f64,
    /// Diagonal of the bounding box of all vertices.
    diagonal: f64,
    /// Size of the largest part without strays.
    extent: f64,
    /// Mask of the vertices without a value.
    mask: Option<Arc<Mask>>,
    params: OperatorParams,
    surface_info: Option<SurfaceInfo>,
    /// One-ring of a mesh without the masked vertices, if steps use other edges.
    ring: Arc<OnceLock<Arc<Adjacency>>>,
    metric: Arc<OnceLock<SurfaceMetric>>,
}

impl Decomposer {
    /// Prepares a shape with the default operator of the paper (eq. 1). O(n log n).
    pub fn new(shape: &Shape) -> Self {
        expect_not_cancelled(Self::with_params(shape, &OperatorParams::default(), Progress::none()))
    }

    /// Prepares a shape: welds it and builds its diffusion operator. O(n log n).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn with_params(
        shape: &Shape,
        params: &OperatorParams,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let geometry = PreparedGeometry::new(shape, params.weld, progress)?;
        let has_measure = match shape {
            Shape::Graph(graph) => graph.is_curve() || graph.cell_areas().is_some(),
            Shape::Mesh(_) | Shape::Cloud(_) => false,
        };
        let kind = if has_measure { OperatorKind::Surface } else { params.kind };
        let params = &params.with_kind(kind);
        let (diffusion, areas, mean_length, surface_info): (_, Arc<[f64]>, _, _) = match params.kind {
            OperatorKind::Walk => {
                let operator = local_operator(&geometry, params, progress)?;
                let (areas, mean_length) = (operator.areas().into(), operator.mean_length());
                (Diffusion::new(operator, progress)?, areas, mean_length, None)
            }
            OperatorKind::Surface => {
                let SurfaceDiffusion { diffusion, areas, mean_length, info } =
                    surface_diffusion(&geometry, params, progress)?;
                (diffusion, areas.into(), mean_length, Some(info))
            }
        };
        let diffusion =
            if params.keep_creases { respect_creases(diffusion, &geometry, progress)? } else { diffusion };
        Ok(Self {
            extent: geometry.extent(),
            geometry: Arc::new(geometry),
            transform: transform(diffusion),
            own_rows: None,
            areas,
            mean_length,
            diagonal: shape.diagonal(),
            mask: None,
            params: *params,
            surface_info,
            ring: Arc::default(),
            metric: Arc::default(),
        })
    }

    /// This shape with the flagged vertices masked (flags in the order of the shape), for a signal that is
    /// unknown there (see [`missing`](crate::mask::missing)). The diffusion goes around masked vertices.
    /// O(entries).
    ///
    /// Each row is divided by the sum of its remaining steps, so nothing crosses a gap. Bands and results are NaN
    /// at masked vertices, and the signal may be NaN there. A welded vertex is kept if one of its members is.
    ///
    /// # Errors
    /// [`MaskError`] unless there is one flag per vertex and at least one vertex is not masked.
    ///
    /// ```
    /// use adwave::{Decomposer, bands::Schedule, shape::{Graph, Shape}};
    /// let path = Shape::Graph(Graph::new(4, &[(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0)])?);
    /// let masked = Decomposer::new(&path).masked(&[false, false, true, false])?;
    /// let bands = masked.decompose(&[0.0, 4.0, f64::NAN, 9.0], 1, &Schedule::dyadic(1)?)?;
    /// assert_eq!((bands.coarsest()[0], bands.coarsest()[1], bands.coarsest()[3]), (2.0, 2.0, 9.0));
    /// assert!(bands.coarsest()[2].is_nan());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn masked(&self, masked: &[bool]) -> Result<Self, MaskError> {
        let mask = Mask::new(masked, self.geometry.vertex_map())?;
        let points = self.geometry.points();
        let squared_length = |x: usize, y: usize| {
            if points.is_empty() { 1.0 } else { squared_distance(&points[x], &points[y]) }
        };
        let rows = self.transform.rows("a mask")?;
        let diffusion = rows.remove_masked(mask.welded(), squared_length, Progress::none());
        let Ok(diffusion) = diffusion else { unreachable!("there is one flag per welded vertex") };
        let extent = self.geometry.extent_without(mask.welded());
        let keep = |(x, a): (usize, &f64)| if mask.welded()[x] { 0.0 } else { *a };
        Ok(Self {
            transform: transform(diffusion),
            areas: self.areas.iter().enumerate().map(keep).collect(),
            mask: Some(Arc::new(mask)),
            ring: Arc::default(),
            metric: Arc::default(),
            extent,
            ..self.clone()
        })
    }

    /// Flags of the masked welded vertices; `None` if no vertex is masked.
    pub fn mask_flags(&self) -> Option<&[bool]> {
        self.mask.as_deref().map(Mask::welded)
    }

    pub(crate) fn mask(&self) -> Option<&Mask> {
        self.mask.as_deref()
    }

    /// Areas of the welded vertices, in the analysis order.
    pub(crate) fn welded_areas(&self) -> &[f64] {
        &self.areas
    }

    /// True if the shape has positions and no faces.
    pub(crate) fn is_cloud(&self) -> bool {
        matches!(self.geometry.shape(), Shape::Cloud(_))
    }

    /// The local fit that smoothing a field about `fit` has on this shape: a constant one on a graph or a curve, where
    /// slopes along the curve are no bias, unless the nodes are cells of a surface.
    pub fn applied_local_fit(&self, fit: LocalFit) -> LocalFit {
        match self.geometry.shape() {
            Shape::Graph(graph) if graph.cell_areas().is_none() => LocalFit::Constant,
            _ => fit,
        }
    }

    /// Domain over which a field with a value at each welded vertex is fitted.
    pub(crate) fn fit_domain(&self, field: &[f64]) -> FitDomain {
        FitDomain::from_field(field, self.geometry.points(), self.mask_flags())
    }

    /// A transform of this shape's welded vertices prepared for bands about a local linear fit.
    pub(crate) fn linear_transform<'t>(
        &self,
        transform: &'t Transform,
        domain: FitDomain,
        progress: Progress<'_>,
    ) -> Result<LinearTransform<'t>, BandsError> {
        let (points, _) = self.geometry.unit_points(progress)?;
        LinearTransform::new(transform, &points, domain, !self.is_cloud(), progress)
    }

    /// One-ring of a mesh without the masked vertices; for a cloud or graph, the neighbors of one step.
    pub(crate) fn ring(&self, progress: Progress<'_>) -> Result<Cow<'_, Adjacency>, Cancelled> {
        if self.has_own_ring() {
            return Ok(Cow::Borrowed(self.mesh_ring(progress)?));
        }
        if self.params.rings == 1 || self.geometry.triangles().is_empty() {
            return Ok(Cow::Borrowed(self.neighbors()));
        }
        Ok(Cow::Owned(self.new_ring(progress)?))
    }

    fn new_ring(&self, progress: Progress<'_>) -> Result<Adjacency, Cancelled> {
        let ring = self.geometry.incidence(progress)?.ring(progress)?;
        match self.mask_flags() {
            Some(masked) => ring.remove_masked(masked, progress),
            None => Ok(ring),
        }
    }

    /// Cached one-ring of a mesh whose steps do not follow its edges.
    fn mesh_ring(&self, progress: Progress<'_>) -> Result<&Arc<Adjacency>, Cancelled> {
        if let Some(ring) = self.ring.get() {
            return Ok(ring);
        }
        let ring = Arc::new(self.new_ring(progress)?);
        Ok(self.ring.get_or_init(|| ring))
    }

    /// True if steps use other edges than those of the mesh.
    fn has_own_ring(&self) -> bool {
        let by_length = self.params.kind == OperatorKind::Surface || self.params.density_invariant;
        by_length && !self.geometry.triangles().is_empty()
    }

    /// The welded vertices and their relation to the vertices of the shape.
    pub fn geometry(&self) -> &PreparedGeometry {
        &self.geometry
    }

    /// Kind of operator that smooths signals.
    pub fn operator_kind(&self) -> OperatorKind {
        self.params.kind
    }

    /// Parameters of the diffusion operator.
    pub fn operator_params(&self) -> &OperatorParams {
        &self.params
    }

    /// Changes made to the shape for the heat operator; `None` for a walk.
    pub fn surface_info(&self) -> Option<&SurfaceInfo> {
        self.surface_info.as_ref()
    }

    /// The rows of the diffusion operator Φ₁ of one step, in the numbering of [`geometry`](Self::geometry).
    ///
    /// # Panics
    /// If a given operator has none ([`with_operator`](Self::with_operator)); [`rows`](Self::rows) returns an error then.
    pub fn diffusion(&self) -> &Arc<Diffusion> {
        self.transform.diffusion()
    }

    /// [`diffusion`](Self::diffusion) for a method, which is named with an article in the error.
    ///
    /// # Errors
    /// [`NoRows`] if a given operator has none.
    pub fn rows(&self, needed_by: &'static str) -> Result<&Arc<Diffusion>, NoRows> {
        self.transform.rows(needed_by)
    }

    /// The operator whose bands are computed, with or without rows.
    pub fn operator(&self) -> &Arc<dyn Operator> {
        self.transform.operator()
    }

    /// The rows whose entries join neighbors: those of the operator, or, if it has none, those of the shape's own.
    fn neighbor_rows(&self) -> &Arc<Diffusion> {
        self.own_rows.as_ref().unwrap_or_else(|| self.diffusion())
    }

    /// The transform with default parameters, in the numbering of [`geometry`](Self::geometry). It shares its tiles
    /// with everything computed here.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// Neighbors of each vertex in one diffusion step, in the numbering of [`geometry`](Self::geometry). For heat
    /// on a mesh they are the neighbors along mesh edges, although heat flows along the edges of another
    /// triangulation.
    pub fn neighbors(&self) -> &Adjacency {
        if self.has_own_ring() {
            return expect_not_cancelled(self.mesh_ring(Progress::none())).as_ref();
        }
        self.neighbor_rows().neighbors()
    }

    /// Distances along the shape, for regions.
    pub fn metric(&self) -> &SurfaceMetric {
        self.metric.get_or_init(|| {
            let edges = if self.has_own_ring() {
                MetricEdges::Mesh(Arc::clone(expect_not_cancelled(self.mesh_ring(Progress::none()))))
            } else {
                MetricEdges::Diffusion(Arc::clone(self.neighbor_rows()))
            };
            SurfaceMetric::new(Arc::clone(&self.geometry), edges, self.extent, self.mean_length)
        })
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.geometry.vertex_map().n_vertices()
    }

    /// Length of the bounding box's diagonal in model units; 0 for a graph.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Size of the shape in model units, from which default levels and lengths in percent follow: the diagonal of the
    /// bounding box of its largest part, without vertices that are masked or take no part
    /// ([`PreparedGeometry::extent`]); 0 for a graph.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Mean edge length E, or mean distance to the nearest neighbors, in model units.
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// Area of each vertex of the shape in squared model units, on a curve its length in model units; welded vertices
    /// share theirs equally.
    pub fn areas(&self) -> Vec<f64> {
        self.share_among_copies(&self.areas)
    }

    /// Stationary distribution π of the diffusion operator at each vertex of the shape, with sum 1; welded vertices
    /// share theirs equally. Smoothing keeps the mean of a signal with these weights
    /// ([`Diffusion::stationary`]).
    pub fn stationary(&self) -> Vec<f64> {
        match self.operator().weights() {
            RowWeights::Each(weights) => self.share_among_copies(weights),
            RowWeights::Uniform => {
                let n = self.geometry.n_vertices();
                self.share_among_copies(&vec![1.0 / n as f64; n])
            }
        }
    }

    /// Weights of welded vertices, divided among the vertices of the shape.
    fn share_among_copies(&self, weights: &[f64]) -> Vec<f64> {
        let mut shares = vec![0_u32; self.geometry.n_vertices()];
        for &x in self.geometry.vertex_map().as_slice() {
            shares[x as usize] += 1;
        }
        let share: Vec<f64> = weights.iter().zip(shares).map(|(a, n)| a / f64::from(n)).collect();
        self.geometry.vertex_map().scatter(&share, 1)
    }

    /// Sheets of a cloud that are closer to each other than its points, found by its neighbors ([`close_sheets`]); `None`
    /// if the given normals keep them apart, or for another shape.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn close_sheets(&self, progress: Progress<'_>) -> Result<Option<CloseSheets>, Cancelled> {
        if !self.is_cloud() || self.geometry.has_separate_sheets() {
            return Ok(None);
        }
        close_sheets(self.geometry.points(), self.neighbors(), progress)
    }

    /// Counts of the elements of the shape.
    pub fn health(&self) -> Health {
        expect_not_cancelled(health(&self.geometry, self.neighbors(), Progress::none()))
    }

    /// Default number of levels and the reason for it (see [`default_schedule`](Self::default_schedule)).
    pub fn default_levels(&self) -> (usize, String) {
        let ResolvedLevels { schedule, reason } = self.default_schedule();
        (schedule.n_levels(), reason)
    }

    /// Number of dyadic levels whose last is as wide as a share of the diagonal, and the reason for it (see
    /// [`levels_reaching`]).
    pub fn levels_reaching(&self, share: f64) -> (usize, String) {
        levels_reaching(share, self.operator().step_length(), self.extent)
    }

    /// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into bands (eq. 11) with the
    /// default accuracy. [`request`](Self::request) takes options and offers other forms.
    ///
    /// # Errors
    /// As for [`Transform::bands`].
    pub fn decompose(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
    ) -> Result<Bands, BandsError> {
        self.request(signal, n_channels, schedule).bands()
    }

    /// Starts a request for the bands of `signal` (n_vertices × n_channels, row-major, in the order of the shape).
    /// The last call of the request selects the result.
    ///
    /// ```
    /// use adwave::{Decomposer, bands::Schedule, shape::{Graph, Shape}};
    /// let path = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)])?);
    /// let (decomposer, schedule) = (Decomposer::new(&path), Schedule::dyadic(2)?);
    /// let request = decomposer.request(&[0.0, 4.0, 0.0], 1, &schedule).accuracy(1e-6);
    /// let mut buffer = [0.0; 9];
    /// request.bands_into(&mut buffer)?;
    /// assert_eq!(buffer, [-2.0, 2.0, -2.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0]); // W_1, W_2, S_2
    /// assert_eq!(request.weighted(&[0.5, 1.0])?.0, [-1.0, 1.0, -1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn request<'a>(
        &'a self,
        signal: &'a [f64],
        n_channels: usize,
        schedule: &'a Schedule,
    ) -> BandsRequest<'a> {
        BandsRequest::new(self, signal, n_channels, schedule)
    }

    /// Scaling function and wavelet of one vertex of the shape on the last level of `schedule`, as functions on the
    /// vertices of the shape; see [`one_vertex`]. On a curve, end points count as free.
    ///
    /// # Errors
    /// [`BasisError`] if the vertex does not exist or the call is cancelled.
    pub fn basis_of_vertex(
        &self,
        vertex: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<VertexFunctions, BasisError> {
        let n_vertices = self.n_vertices();
        if vertex >= n_vertices {
            return Err(BasisError::NoVertex { vertex, n_vertices });
        }
        if self.params.end_points == EndPoints::Keep && !self.geometry.curve_ends().is_empty() {
            // An operator that keeps values is not self-adjoint, by which a row is computed.
            let params = self.params.with_end_points(EndPoints::Free);
            let free = Self::with_params(self.geometry.shape(), &params, progress)?;
            return free.basis_of_vertex(vertex, schedule, progress);
        }
        let rows = self.rows("a function of one vertex")?;
        let x = self.geometry.vertex_map().welded(vertex);
        if rows.semigroup() != Semigroup::Steps {
            return self.heat_of_vertex(x, schedule, progress);
        }
        check_whole(schedule)?;
        let [.., before, last] = schedule.steps_from_zero()[..] else {
            unreachable!("a schedule has a level")
        };
        let (before, last) = (before as u64, last as u64);
        let functions = one_vertex(rows, x, before, last, 0.0, progress)?;
        let dense = |row: &SparseRow| {
            self.geometry.vertex_map().scatter(&row.to_dense(self.geometry.n_vertices()), 1)
        };
        Ok(VertexFunctions {
            scaling_function: dense(&functions.scaling),
            wavelet: dense(&functions.wavelet),
            support: functions.scaling.columns.len(),
        })
    }

    /// Functions of heat from one welded vertex: `φ_x(y) = P(x,y) = π(y)·P(y,x)/π(x)`. P is self-adjoint, so the
    /// bands of the unit vector at x give them.
    fn heat_of_vertex(
        &self,
        x: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<VertexFunctions, BasisError> {
        let (n, pi) = (self.geometry.n_vertices(), self.diffusion().stationary());
        let mut unit = vec![0.0; n];
        unit[x] = 1.0;
        let steps = schedule.steps();
        let last_two =
            Schedule::real(steps[steps.len().saturating_sub(2)..].to_vec()).expect("part of a schedule");
        let mut bands = vec![vec![0.0; n]; last_two.n_levels()];
        let mut outs: Vec<&mut [f64]> = bands.iter_mut().map(Vec::as_mut_slice).collect();
        self.transform.wavelets_into(&unit, 1, &last_two, &mut outs, progress).map_err(
            |error| match error {
                BandsError::Cancelled(cancelled) => BasisError::Cancelled(cancelled),
                other => unreachable!("{other}"),
            },
        )?;
        let mut scaling = unit;
        for band in &bands {
            scaling.iter_mut().zip(band).for_each(|(s, w)| *s -= w);
        }
        let mut wavelet = bands.pop().expect("a schedule has a level");
        let share = |y: usize| if pi[x] > 0.0 { pi[y] / pi[x] } else { f64::from(u8::from(x == y)) };
        for (y, (s, w)) in scaling.iter_mut().zip(&mut wavelet).enumerate() {
            *s = (*s * share(y)).max(0.0); // far away only rounding is left, of either sign
            *w *= share(y);
        }
        // At a vertex with almost no mass, errors that are small relative to the signal are not small relative to
        // the result.
        let sum: f64 = scaling.iter().sum();
        for s in &mut scaling {
            *s /= if sum > 0.0 { sum } else { 1.0 };
        }
        let largest = scaling.iter().copied().fold(0.0, f64::max);
        let floor = self.transform.params().accuracy * largest;
        let support = scaling.iter().filter(|s| **s > floor).count();
        let map = self.geometry.vertex_map();
        Ok(VertexFunctions {
            scaling_function: map.scatter(&scaling, 1),
            wavelet: map.scatter(&wavelet, 1),
            support,
        })
    }
}

/// The transform of an operator with the default parameters.
fn transform(diffusion: Diffusion) -> Transform {
    Transform::new(diffusion, &BandsParams::default()).expect("the default accuracy can be promised")
}
