//! The prepared object: a domain with its diffusion operator, for repeated use.

mod border;
mod creases;
mod default_schedule;
mod given_walk;
mod labels;
mod level_spec;
mod part;
mod request;
mod spectral;
mod union;

pub use level_spec::{LevelSpec, LevelSpecError, ResolvedLevels};
pub use request::BandsRequest;
pub use spectral::SpectralSeries;

use crate::bands::{Bands, BandsError, BandsParams, Schedule, Transform, levels_reaching};
use crate::basis::{BasisError, SparseRow, check_whole, one_vertex};
use crate::domain::{Domain, DomainError, ShapeDomain, WalkDomain, stated_neighbors, without_masked};
use crate::local_fit::{FitDomain, LinearTransform, LocalFit};
use crate::mask::{Mask, MaskError};
use crate::operator::{
    Diffusion, DiffusionError, EndPoints, NoRows, Operator, OperatorKind, OperatorParams, RowWeights,
    Semigroup, SurfaceDiffusion, SurfaceInfo, local_operator, surface_diffusion,
};
use crate::parallel::expect_not_cancelled;
use crate::region::{Length, MetricEdges, SurfaceMetric};
use crate::rows::CompressedRows;
use crate::shape::{Adjacency, Health, NoShape, PreparedGeometry, Shape, VertexMap, health, sphere_radius};
use crate::signal::{CloseSheets, OutwardError, OutwardNormals, close_sheets, outward_normals};
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

/// A shape, or another [`Domain`], with its diffusion operator, prepared once in O(n log n). Each signal then costs
/// only its products.
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
    domain: Arc<dyn Domain>,
    transform: Transform,
    /// The rows of the shape's own operator, if those of the given one are not known.
    own_rows: Option<Arc<Diffusion>>,
    /// Measure of the places, 0 at masked ones; `None` if it is 1 everywhere.
    measure: Option<Arc<[f64]>>,
    /// Size of the largest part without strays and masked places.
    extent: f64,
    /// Mask of the places without a value.
    mask: Option<Arc<Mask>>,
    params: OperatorParams,
    surface_info: Option<SurfaceInfo>,
    /// Neighbors that the domain states, without masked places.
    neighbors: Arc<OnceLock<Adjacency>>,
    /// Rows of a walk over the neighbors, for methods that need rows where the operator has none.
    neighbor_walk: Arc<OnceLock<Arc<Diffusion>>>,
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
        let has_measure =
            shape.as_graph().is_some_and(|graph| graph.is_curve() || graph.cell_areas().is_some());
        let kind = if has_measure { OperatorKind::Surface } else { params.kind };
        let params = &params.with_kind(kind);
        let (diffusion, areas, mean_length, surface_info) = match params.kind {
            OperatorKind::Walk => {
                let operator = local_operator(&geometry, params, progress)?;
                let (areas, mean_length) = (operator.areas().to_vec(), operator.mean_length());
                (Diffusion::new(operator, progress)?, areas, mean_length, None)
            }
            OperatorKind::Surface => {
                let SurfaceDiffusion { diffusion, areas, mean_length, info } =
                    surface_diffusion(&geometry, params, progress)?;
                (diffusion, areas, mean_length, Some(info))
            }
        };
        let diffusion =
            if params.keep_creases { respect_creases(diffusion, &geometry, progress)? } else { diffusion };
        let domain = ShapeDomain::new(geometry, areas, mean_length, params);
        Ok(Self { surface_info, params: *params, ..Self::join(Arc::new(domain), transform(diffusion)) })
    }

    /// Joins any domain with any operator over its places (see [`Domain`] and [`Operator`]). O(one product).
    ///
    /// Bands, masks, filters, saliency, features and the denoising of signals follow. Methods that need rows where the
    /// operator has none take those of a walk over the neighbors of the domain.
    ///
    /// # Errors
    /// [`DomainError`] unless the operator has a row and the domain a measure for each place, one of them states which
    /// places are neighbors, and the operator passes the checks of [`Transform::from_operator`].
    pub fn from_domain(
        domain: impl Domain + 'static,
        operator: impl Operator + 'static,
    ) -> Result<Self, DomainError> {
        let (n_rows, n_places) = (operator.n_rows(), domain.vertex_map().n_welded());
        if n_rows != n_places {
            return Err(DomainError::RowCount { n_rows, n_places });
        }
        let positions = Some(domain.n_positions()).filter(|n| *n > 0);
        let lengths = [("the measure", domain.measure().map(<[_]>::len)), ("the positions", positions)];
        for (what, n_found) in lengths {
            if let Some(n_found) = n_found.filter(|n_found| *n_found != n_places) {
                return Err(DomainError::Length { what, n_found, n_places });
            }
        }
        if !domain.has_neighbors() && operator.rows().is_none() {
            return Err(DomainError::NoNeighbors);
        }
        let kind = match operator.semigroup() {
            Semigroup::Heat { .. } => OperatorKind::Surface,
            _ => OperatorKind::Walk,
        };
        let transform = Transform::from_operator(operator, &BandsParams::default())?;
        let params = OperatorParams { kind, ..OperatorParams::default() };
        Ok(Self { params, ..Self::join(Arc::new(domain), transform) })
    }

    /// Prepares a walk that is given by its rows, n × n with its diagonal (see [`Diffusion::from_walk`]): the domain of
    /// its states ([`WalkDomain`]). O(entries · log).
    ///
    /// # Errors
    /// [`DiffusionError`] unless the matrix is square, entries are finite and ≥ 0, and rows sum to 1; or if the call is
    /// cancelled.
    ///
    /// ```
    /// use adwave::{Decomposer, Progress, bands::Schedule, rows::CompressedRows};
    /// let swap = CompressedRows::new(vec![0, 1, 2], vec![1, 0], vec![1.0, 1.0], 2)?;
    /// let walk = Decomposer::from_walk(&swap, Progress::none())?;
    /// assert_eq!(walk.decompose(&[1.0, 3.0], 1, &Schedule::dyadic(1)?)?.coarsest(), [3.0, 1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_walk(walk: &CompressedRows<f64>, progress: Progress<'_>) -> Result<Self, DiffusionError> {
        let (domain, diffusion) = WalkDomain::new(walk, progress)?;
        Ok(Self::join(Arc::new(domain), transform(diffusion)))
    }

    fn join(domain: Arc<dyn Domain>, transform: Transform) -> Self {
        Self {
            measure: domain.measure().map(Arc::from),
            extent: domain.extent(None),
            domain,
            transform,
            own_rows: None,
            mask: None,
            params: OperatorParams::default(),
            surface_info: None,
            neighbors: Arc::default(),
            neighbor_walk: Arc::default(),
            metric: Arc::default(),
        }
    }

    /// This domain with another operator on the same places.
    fn with_transform(&self, transform: Transform) -> Self {
        let own_rows = match transform.operator().rows() {
            Some(_) => None,
            None => self.own_rows.clone().or_else(|| self.operator().rows().cloned()),
        };
        Self { transform, own_rows, surface_info: None, ..self.without_caches() }
    }

    /// This prepared domain without the data that depends on its operator or its mask.
    fn without_caches(&self) -> Self {
        Self {
            neighbors: Arc::default(),
            neighbor_walk: Arc::default(),
            metric: Arc::default(),
            ..self.clone()
        }
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
        let mask = Mask::new(masked, self.vertex_map())?;
        let (domain, none) = (Arc::clone(&self.domain), Progress::none());
        let squared_length = move |x: usize, y: usize| domain.squared_length(x, y);
        let transform = without_places(&self.transform, mask.welded(), squared_length, none)?;
        let keep = |(x, a): (usize, &f64)| if mask.welded()[x] { 0.0 } else { *a };
        let measure = match &self.measure {
            Some(measure) => measure.iter().enumerate().map(keep).collect(),
            None => mask.welded().iter().map(|out| f64::from(u8::from(!out))).collect(),
        };
        Ok(Self {
            transform,
            extent: self.domain.extent(Some(mask.welded())),
            measure: Some(measure),
            mask: Some(Arc::new(mask)),
            ..self.without_caches()
        })
    }

    /// Flags of the masked welded vertices; `None` if no vertex is masked.
    pub fn mask_flags(&self) -> Option<&[bool]> {
        self.mask.as_deref().map(Mask::welded)
    }

    pub(crate) fn mask(&self) -> Option<&Mask> {
        self.mask.as_deref()
    }

    /// Measure of the places, 0 at masked ones; `None` if it is 1 everywhere.
    pub(crate) fn place_measure(&self) -> Option<&[f64]> {
        self.measure.as_deref()
    }

    /// The local fit that smoothing a field about `fit` has on this domain ([`Domain::local_fit`]); directions have a
    /// constant one.
    pub fn applied_local_fit(&self, fit: LocalFit) -> LocalFit {
        if self.operator().channels_at_place() > 1 { LocalFit::Constant } else { self.domain.local_fit(fit) }
    }

    /// Domain over which a field with a value at each place is fitted.
    pub(crate) fn fit_domain(&self, field: &[f64]) -> FitDomain {
        FitDomain::from_field(field, self.positions(), self.mask_flags())
    }

    /// A transform of this domain's places prepared for bands about a local linear fit.
    pub(crate) fn linear_transform<'t>(
        &'t self,
        transform: &'t Transform,
        domain: FitDomain,
        progress: Progress<'_>,
    ) -> Result<LinearTransform<'t>, BandsError> {
        let points = match self.geometry() {
            Some(geometry) => geometry.unit_points(progress)?.0,
            None => Cow::Borrowed(self.positions()),
        };
        let rows = match transform.operator().rows() {
            Some(rows) => rows,
            None => self.step_rows(progress)?,
        };
        LinearTransform::new(transform, rows, &points, domain, !self.domain.may_fill_volume(), progress)
    }

    /// Rows of steps between neighbors: those of the operator, or of a walk over the neighbors of the domain.
    pub(crate) fn step_rows(&self, progress: Progress<'_>) -> Result<&Diffusion, Cancelled> {
        if let Some(rows) = self.operator().rows() {
            return Ok(rows);
        }
        if self.neighbor_walk.get().is_none() {
            let walk = Diffusion::from_neighbor_lists(self.try_neighbors(progress)?, progress)?;
            let _ = self.neighbor_walk.set(Arc::new(walk));
        }
        Ok(self.neighbor_walk.get().expect("set above"))
    }

    /// One-ring of a mesh without the masked vertices; elsewhere the neighbors of one step.
    pub(crate) fn ring(&self, progress: Progress<'_>) -> Result<Cow<'_, Adjacency>, Cancelled> {
        match self.domain.one_ring(progress)? {
            Some(ring) => Ok(Cow::Owned(without_masked(ring, self.mask_flags(), progress)?)),
            None => Ok(Cow::Borrowed(self.try_neighbors(progress)?)),
        }
    }

    pub(crate) fn try_neighbors(&self, progress: Progress<'_>) -> Result<&Adjacency, Cancelled> {
        match stated_neighbors(&*self.domain, self.mask_flags(), &self.neighbors, progress)? {
            Some(stated) => Ok(stated),
            None => Ok(self.neighbor_rows().expect("a domain states its neighbors, or has rows").neighbors()),
        }
    }

    /// The domain whose places carry the signal.
    pub fn domain(&self) -> &Arc<dyn Domain> {
        &self.domain
    }

    /// The prepared mesh, cloud or graph; `None` for another domain.
    pub fn geometry(&self) -> Option<&PreparedGeometry> {
        self.domain.geometry()
    }

    /// [`geometry`](Self::geometry) for the method `needed_by`, which the error names.
    ///
    /// # Errors
    /// [`NoShape`] for a domain that is no shape.
    pub fn geometry_for(&self, needed_by: &'static str) -> Result<&PreparedGeometry, NoShape> {
        self.geometry().ok_or(NoShape { needed_by })
    }

    /// The shape, in the order of its file; `None` for another domain.
    pub fn shape(&self) -> Option<&Shape> {
        self.geometry().map(PreparedGeometry::shape)
    }

    /// Coordinates of the vertices of the shape in model units, in its order; `None` without positions.
    pub fn points(&self) -> Option<&[[f64; 3]]> {
        self.shape().and_then(Shape::points)
    }

    /// Map from the vertices of the shape, or the places in the caller's order, to the rows of the operator.
    pub fn vertex_map(&self) -> &VertexMap {
        self.domain.vertex_map()
    }

    /// Number of rows of the operator: of welded vertices, or of places.
    pub fn n_places(&self) -> usize {
        self.vertex_map().n_welded()
    }

    /// Positions of the welded vertices or places in model units; empty without positions.
    pub fn positions(&self) -> &[[f64; 3]] {
        self.domain.positions()
    }

    /// Kind of operator that smooths signals.
    pub fn operator_kind(&self) -> OperatorKind {
        self.params.kind
    }

    /// Default accuracy of the bands of maps and features: 1e-4 for heat on a mesh, whose triangles cause larger errors,
    /// and on a grid, whose coarse bands of noise would take hundreds of products otherwise; that of [`BandsParams`] in
    /// all other cases.
    pub fn analysis_accuracy(&self) -> f64 {
        let is_mesh = self.shape().is_some_and(Shape::is_mesh);
        let is_grid = self.shape().is_none() && matches!(self.operator().semigroup(), Semigroup::Heat { .. });
        if is_grid || is_mesh && self.operator_kind() == OperatorKind::Surface {
            1e-4
        } else {
            BandsParams::default().accuracy
        }
    }

    /// Parameters of the diffusion operator.
    pub fn operator_params(&self) -> &OperatorParams {
        &self.params
    }

    /// Changes made to the shape for the heat operator; `None` for a walk.
    pub fn surface_info(&self) -> Option<&SurfaceInfo> {
        self.surface_info.as_ref()
    }

    /// The rows of the diffusion operator Φ₁ of one step, in the order of [`vertex_map`](Self::vertex_map), for the
    /// method `needed_by`, which the error names with its article.
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
    fn neighbor_rows(&self) -> Option<&Arc<Diffusion>> {
        self.own_rows.as_ref().or_else(|| self.operator().rows())
    }

    /// The transform with default parameters, in the order of [`vertex_map`](Self::vertex_map). It shares its tiles
    /// with everything computed here.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// Neighbors of each place in one diffusion step, in the order of [`vertex_map`](Self::vertex_map). For heat on a
    /// mesh they are the neighbors along mesh edges, although heat flows along the edges of another triangulation.
    pub fn neighbors(&self) -> &Adjacency {
        expect_not_cancelled(self.try_neighbors(Progress::none()))
    }

    /// Distances along the domain, for regions.
    pub fn metric(&self) -> &SurfaceMetric {
        self.metric.get_or_init(|| {
            let (stated, mask) = (Arc::clone(&self.neighbors), self.mask.clone());
            let edges = MetricEdges { stated, mask, rows: self.neighbor_rows().cloned() };
            SurfaceMetric::new(Arc::clone(&self.domain), edges, self.extent, self.mean_length())
        })
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.vertex_map().n_vertices()
    }

    /// Length of the bounding box's diagonal in model units; 0 for a graph.
    pub fn diagonal(&self) -> f64 {
        self.domain.diagonal()
    }

    /// Size of the shape in model units, from which default levels and lengths in percent follow: the diagonal of the
    /// bounding box of its largest part, without vertices that are masked or take no part
    /// ([`PreparedGeometry::extent`]); 0 for a graph.
    pub fn extent(&self) -> f64 {
        self.extent
    }

    /// Radius of the sphere about the origin on which all places lie, to 1e-5 of it, in model units; `None` if there is
    /// none. O(n).
    pub fn sphere_radius(&self) -> Option<f64> {
        sphere_radius(self.positions())
    }

    /// A width in model units; `None` for an arc if the places lie on no sphere about the origin. O(n) for an arc.
    ///
    /// ```
    /// use adwave::{Decomposer, region::Length, sample::Sample, shape::{Mesh, Shape}};
    /// let sphere = Sample::from_name("sphere", Some(300))?;
    /// let shape = Shape::Mesh(Mesh::new(sphere.points, sphere.faces)?);
    /// let arc = Decomposer::new(&shape).model_units(Length::Degrees(180.0)).unwrap();
    /// assert!((arc - std::f64::consts::PI).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn model_units(&self, width: Length) -> Option<f64> {
        match width {
            Length::Degrees(angle) => self.sphere_radius().map(|radius| radius * angle.to_radians()),
            other => Some(other.to_model_units(self.extent())),
        }
    }

    /// Mean edge length E, or mean distance to the nearest neighbors, in model units.
    pub fn mean_length(&self) -> f64 {
        self.domain.spacings().first().copied().unwrap_or(1.0)
    }

    /// Area of each vertex of the shape in squared model units, on a curve its length in model units; welded vertices
    /// share theirs equally.
    pub fn areas(&self) -> Vec<f64> {
        match &self.measure {
            Some(measure) => self.share_among_copies(measure),
            None => self.share_among_copies(&vec![1.0; self.n_places()]),
        }
    }

    /// True if all [`areas`](Self::areas) are 1, as those of an image or a volume without a mask.
    pub fn has_even_areas(&self) -> bool {
        self.measure.is_none() && self.vertex_map().is_identity()
    }

    /// Stationary distribution π of the diffusion operator at each vertex of the shape, with sum 1; welded vertices
    /// share theirs equally. Smoothing keeps the mean of a signal with these weights
    /// ([`Diffusion::stationary`]).
    pub fn stationary(&self) -> Vec<f64> {
        match self.operator().weights() {
            RowWeights::Each(weights) => self.share_among_copies(weights),
            RowWeights::Uniform => {
                let n = self.n_places();
                self.share_among_copies(&vec![1.0 / n as f64; n])
            }
        }
    }

    /// Weights of welded vertices, divided among the vertices of the shape.
    fn share_among_copies(&self, weights: &[f64]) -> Vec<f64> {
        let mut shares = vec![0_u32; self.n_places()];
        for &x in self.vertex_map().as_slice() {
            shares[x as usize] += 1;
        }
        let share: Vec<f64> = weights.iter().zip(shares).map(|(a, n)| a / f64::from(n)).collect();
        self.vertex_map().scatter(&share, 1)
    }

    /// Sheets of a cloud that are closer to each other than its points, found by its neighbors ([`close_sheets`]);
    /// `None` if the given normals keep them apart, or for another shape.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn close_sheets(&self, progress: Progress<'_>) -> Result<Option<CloseSheets>, Cancelled> {
        match self.geometry() {
            Some(geometry) if geometry.shape().is_cloud() && !geometry.has_separate_sheets() => {
                close_sheets(geometry.points(), self.neighbors(), progress)
            }
            _ => Ok(None),
        }
    }

    /// Outward normals of the welded vertices ([`outward_normals`]); `file` has those of the file, n_vertices × 3.
    ///
    /// # Errors
    /// As for [`outward_normals`]; [`OutwardError::NoPositions`] also for a domain that is no shape.
    pub fn outward_normals(
        &self,
        file: Option<&[f64]>,
        progress: Progress<'_>,
    ) -> Result<OutwardNormals, OutwardError> {
        outward_normals(self.geometry_for("an outside")?, file, progress)
    }

    /// Number of entries of the rows of the operator; `None` if it stores none.
    pub fn n_entries(&self) -> Option<usize> {
        self.operator().rows().map(|rows| rows.nnz())
    }

    /// Counts of the elements of the shape; of a domain without one, of the graph of its neighbors.
    pub fn health(&self) -> Health {
        let graph;
        let geometry = if let Some(geometry) = self.geometry() {
            geometry
        } else {
            graph = PreparedGeometry::from_neighbors(self.neighbors());
            &graph
        };
        expect_not_cancelled(health(geometry, self.neighbors(), Progress::none()))
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
        if let Some(curve) = self.geometry().filter(|geometry| !geometry.curve_ends().is_empty())
            && self.params.end_points == EndPoints::Keep
        {
            // An operator that keeps values is not self-adjoint, by which a row is computed.
            let params = self.params.with_end_points(EndPoints::Free);
            let free = Self::with_params(curve.shape(), &params, progress)?;
            return free.basis_of_vertex(vertex, schedule, progress);
        }
        let x = self.vertex_map().welded(vertex);
        let has_rows = self.operator().rows().is_some();
        if self.operator().semigroup() != Semigroup::Steps || !has_rows && self.operator().is_reversible() {
            return self.adjoint_of_vertex(x, schedule, progress);
        }
        let rows = self.rows("a function of one vertex of a walk that is not reversible")?;
        check_whole(schedule)?;
        let [.., before, last] = schedule.steps_from_zero()[..] else {
            unreachable!("a schedule has a level")
        };
        let (before, last) = (before as u64, last as u64);
        let functions = one_vertex(rows, x, before, last, 0.0, progress)?;
        let dense = |row: &SparseRow| self.vertex_map().scatter(&row.to_dense(self.n_places()), 1);
        Ok(VertexFunctions {
            scaling_function: dense(&functions.scaling),
            wavelet: dense(&functions.wavelet),
            support: functions.scaling.columns.len(),
        })
    }

    /// Functions of one place under a reversible operator: `φ_x(y) = P(x,y) = π(y)·P(y,x)/π(x)`. P is self-adjoint, so
    /// the bands of the unit vector at x give them.
    fn adjoint_of_vertex(
        &self,
        x: usize,
        schedule: &Schedule,
        progress: Progress<'_>,
    ) -> Result<VertexFunctions, BasisError> {
        let (n, weights) = (self.n_places(), self.operator().weights());
        let pi = |y: usize| weights.weight(y, n);
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
                BandsError::NotWhole { level, steps } => BasisError::NotWhole { level, steps },
                other => unreachable!("{other}"),
            },
        )?;
        let mut scaling = unit;
        for band in &bands {
            scaling.iter_mut().zip(band).for_each(|(s, w)| *s -= w);
        }
        let mut wavelet = bands.pop().expect("a schedule has a level");
        let share = |y: usize| if pi(x) > 0.0 { pi(y) / pi(x) } else { f64::from(u8::from(x == y)) };
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
        let map = self.vertex_map();
        Ok(VertexFunctions {
            scaling_function: map.scatter(&scaling, 1),
            wavelet: map.scatter(&wavelet, 1),
            support,
        })
    }
}

/// A transform whose operator goes around the flagged places.
fn without_places(
    of: &Transform,
    masked: &[bool],
    squared_length: impl Fn(usize, usize) -> f64 + Sync + Send,
    progress: Progress<'_>,
) -> Result<Transform, MaskError> {
    match of.operator().masked(masked, &squared_length, progress)? {
        Some(operator) => Ok(Transform::from_shared_operator(operator, &BandsParams::default())?),
        None => Ok(transform(of.rows("a mask")?.remove_masked(masked, squared_length, progress)?)),
    }
}

/// The transform of an operator with the default parameters.
fn transform(diffusion: Diffusion) -> Transform {
    Transform::new(diffusion, &BandsParams::default()).expect("the default accuracy can be promised")
}
