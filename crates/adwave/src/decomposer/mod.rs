//! The prepared object: a shape with its diffusion operator, ready to be asked often.

mod border;
mod creases;
mod level_spec;
mod request;

pub use level_spec::{LevelSpec, LevelSpecError, ResolvedLevels};
pub use request::BandsRequest;

use crate::bands::{Bands, BandsError, BandsParams, DEFAULT_EXTENT, Schedule, Transform, levels_reaching};
use crate::basis::{BasisError, SparseRow, check_whole, one_vertex};
use crate::mask::{Mask, MaskError};
use crate::operator::{
    Diffusion, OperatorKind, OperatorParams, Semigroup, SurfaceDiffusion, SurfaceInfo, local_operator,
    surface_diffusion,
};
use crate::parallel::unstopped;
use crate::region::{Edges, SurfaceMetric};
use crate::shape::{Adjacency, Health, PreparedGeometry, Shape, health, squared_distance};
use crate::shape::{triangles_at_vertices, try_one_ring};
use crate::{Cancelled, Progress};
use creases::keeping_creases;
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// The functions of one vertex on one level, one value per vertex of the shape; welded vertices share theirs, so sums are
/// over the welded vertices.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexFunctions {
    /// φ: ≥ 0, sums to 1.
    pub scaling_function: Vec<f64>,
    /// ψ: sums to 0.
    pub wavelet: Vec<f64>,
    /// At how many welded vertices φ is not 0.
    pub support: usize,
}

impl VertexFunctions {
    /// The fewest vertices of the shape that hold `share`, in [0, 1], of the sum of φ over them. O(n log n).
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

/// A shape with its diffusion operator, prepared once: O(n log n). Each signal then costs its products only.
///
/// It owns all that runs on it and is cheap to clone; clones share everything and may be asked from several threads at once.
/// What only some questions need (the tiles of the products, the search tree of regions) is made by the first that does.
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
    /// Areas of the welded vertices.
    areas: Arc<[f64]>,
    mean_length: f64,
    diagonal: f64,
    /// Which vertices are masked.
    mask: Option<Arc<Mask>>,
    params: OperatorParams,
    surface_info: Option<SurfaceInfo>,
    /// The one-ring of a mesh, without the masked vertices, where steps go along other edges.
    ring: Arc<OnceLock<Arc<Adjacency>>>,
    metric: Arc<OnceLock<SurfaceMetric>>,
}

impl Decomposer {
    /// Prepares a shape with the default operator: the paper's (eq. 1). O(n log n).
    pub fn new(shape: &Shape) -> Self {
        unstopped(Self::with_params(shape, &OperatorParams::default(), Progress::none()))
    }

    /// Prepares a shape: welds it and builds its diffusion operator. O(n log n).
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn with_params(
        shape: &Shape,
        params: &OperatorParams,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let geometry = PreparedGeometry::new(shape, params.weld, progress)?;
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
            if params.keep_creases { keeping_creases(diffusion, &geometry, progress)? } else { diffusion };
        Ok(Self {
            geometry: Arc::new(geometry),
            transform: transform(diffusion),
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

    /// The same shape with the flagged vertices masked (in the order of the shape): the diffusion goes round them, for a signal
    /// that is not known there (see [`missing`](crate::mask::missing)). O(entries).
    ///
    /// Rows are divided by what they keep of their steps; nothing crosses a gap but round it. Bands and results are NaN at
    /// masked vertices, and a signal may be NaN there. A welded vertex stays while one of its members does.
    ///
    /// # Errors
    /// [`MaskError`] when there is not one flag per vertex, or all are masked.
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
        let diffusion = self.diffusion().restricted(mask.welded(), squared_length, Progress::none());
        let Ok(diffusion) = diffusion else { unreachable!("there is one flag per welded vertex") };
        let keep = |(x, a): (usize, &f64)| if mask.welded()[x] { 0.0 } else { *a };
        Ok(Self {
            transform: transform(diffusion),
            areas: self.areas.iter().enumerate().map(keep).collect(),
            mask: Some(Arc::new(mask)),
            ring: Arc::default(),
            metric: Arc::default(),
            ..self.clone()
        })
    }

    /// Which welded vertices are masked; `None` where all take part.
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

    /// Whether the shape has positions and no faces.
    pub(crate) fn is_cloud(&self) -> bool {
        !self.geometry.points().is_empty() && self.geometry.triangles().is_empty()
    }

    /// The one-ring of a mesh without the masked vertices; of a cloud or graph what one step takes in.
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
        let (n, triangles) = (self.geometry.n_vertices(), self.geometry.triangles());
        let ring = try_one_ring(triangles, &triangles_at_vertices(n, triangles, progress)?, progress)?;
        match self.mask_flags() {
            Some(masked) => ring.without(masked, progress),
            None => Ok(ring),
        }
    }

    /// The one-ring that is kept where steps are not along the edges of the mesh.
    fn mesh_ring(&self, progress: Progress<'_>) -> Result<&Arc<Adjacency>, Cancelled> {
        if let Some(ring) = self.ring.get() {
            return Ok(ring);
        }
        let ring = Arc::new(self.new_ring(progress)?);
        Ok(self.ring.get_or_init(|| ring))
    }

    /// Whether steps go along other edges than those of the mesh.
    fn has_own_ring(&self) -> bool {
        let by_length = self.params.kind == OperatorKind::Surface || self.params.density_invariant;
        by_length && !self.geometry.triangles().is_empty()
    }

    /// The welded vertices and how they belong to those of the shape.
    pub fn geometry(&self) -> &PreparedGeometry {
        &self.geometry
    }

    /// By what signals are smoothed.
    pub fn operator_kind(&self) -> OperatorKind {
        self.params.kind
    }

    /// How the diffusion operator was built.
    pub fn operator_params(&self) -> &OperatorParams {
        &self.params
    }

    /// What was done to the shape on the way to heat on it; `None` of a walk.
    pub fn surface_info(&self) -> Option<&SurfaceInfo> {
        self.surface_info.as_ref()
    }

    /// One step of the diffusion, Φ₁, in the numbering of [`geometry`](Self::geometry).
    pub fn diffusion(&self) -> &Arc<Diffusion> {
        self.transform.diffusion()
    }

    /// The transform with its default parameters, in the numbering of [`geometry`](Self::geometry); it shares its tiles with
    /// all that runs here.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// The vertices that one step of the diffusion takes in, in the numbering of [`geometry`](Self::geometry); of heat on a mesh
    /// those at its edges, while heat flows along those of another triangulation.
    pub fn neighbors(&self) -> &Adjacency {
        if self.has_own_ring() {
            return unstopped(self.mesh_ring(Progress::none())).as_ref();
        }
        self.diffusion().neighbors()
    }

    /// Distances along the shape, for regions.
    pub fn metric(&self) -> &SurfaceMetric {
        self.metric.get_or_init(|| {
            let edges = if self.has_own_ring() {
                Edges::Mesh(Arc::clone(unstopped(self.mesh_ring(Progress::none()))))
            } else {
                Edges::Diffusion(Arc::clone(self.diffusion()))
            };
            SurfaceMetric::new(Arc::clone(&self.geometry), edges, self.diagonal, self.mean_length)
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

    /// `E`, the mean length of edges or the mean distance to the nearest neighbors, in model units.
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// The area of every vertex of the shape in squared model units; welded vertices share theirs equally.
    pub fn areas(&self) -> Vec<f64> {
        let mut shares = vec![0_u32; self.geometry.n_vertices()];
        for &x in self.geometry.vertex_map().as_slice() {
            shares[x as usize] += 1;
        }
        let share: Vec<f64> = self.areas.iter().zip(shares).map(|(a, n)| a / f64::from(n)).collect();
        self.geometry.vertex_map().scatter(&share, 1)
    }

    /// Counts of what the shape consists of.
    pub fn health(&self) -> Health {
        unstopped(health(&self.geometry, self.neighbors(), Progress::none()))
    }

    /// The number of dyadic levels to take where none is asked for, and why (see
    /// [`default_levels`](crate::bands::default_levels)).
    pub fn default_levels(&self) -> (usize, String) {
        self.levels_reaching(DEFAULT_EXTENT)
    }

    /// The number of dyadic levels whose last is as wide as a share of the diagonal, and why (see [`levels_reaching`]).
    pub fn levels_reaching(&self, share: f64) -> (usize, String) {
        levels_reaching(share, self.diffusion().step_length(), self.diagonal)
    }

    /// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into bands (eq. 11), with the default
    /// accuracy. [`request`](Self::request) takes options and gives other forms of the same.
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

    /// Asks for something of the bands of `signal` (n_vertices × n_channels, row-major, in the order of the shape): say what
    /// at the end of the request.
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

    /// The scaling function and the wavelet of one vertex of the shape on the last level of `schedule`, as functions on the
    /// vertices of the shape; see [`one_vertex`].
    ///
    /// # Errors
    /// [`BasisError`] when there is no such vertex, or when cancelled.
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
        let x = self.geometry.vertex_map().welded(vertex);
        if self.diffusion().semigroup() != Semigroup::Steps {
            return self.heat_of_vertex(x, schedule, progress);
        }
        check_whole(schedule)?;
        let [.., before, last] = schedule.steps_from_zero()[..] else {
            unreachable!("a schedule has a level")
        };
        let (before, last) = (before as u64, last as u64);
        let functions = one_vertex(self.diffusion(), x, before, last, 0.0, progress)?;
        let dense = |row: &SparseRow| {
            self.geometry.vertex_map().scatter(&row.to_dense(self.geometry.n_vertices()), 1)
        };
        Ok(VertexFunctions {
            scaling_function: dense(&functions.scaling),
            wavelet: dense(&functions.wavelet),
            support: functions.scaling.columns.len(),
        })
    }

    /// The functions of heat from one welded vertex: `φ_x(y) = P(x,y) = π(y)·P(y,x)/π(x)`, P being self-adjoint, so that the bands of
    /// the unit vector at x give them.
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
        // At a vertex with next to no mass, errors that are small beside the signal are not small beside what is left of it.
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
