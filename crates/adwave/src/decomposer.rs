//! The prepared object: a shape with its walk, ready to split any number of signals.

use crate::Progress;
use crate::bands::{
    Bands, BandsError, BandsParams, DEFAULT_REACH, Schedule, check_signal, decompose, levels_reaching,
    weighted_bands,
};
use crate::basis::{BasisError, SparseRow, check_whole, one_vertex};
use crate::filter::{Edit, FilterError};
use crate::mask::{Mask, MaskError};
use crate::operator::{Diffusion, OperatorParams, local_operator};
use crate::parallel::unstopped;
use crate::region::surface_distance;
use crate::shape::{Adjacency, Health, PreparedGeometry, Shape, health, one_ring, squared_distance};
use crate::signal::cloud_border;
use rayon::prelude::*;
use std::borrow::Cow;

/// The functions of one vertex on one level, one value a vertex of the shape; welded vertices have the value of the one
/// vertex that they are, so sums are over the vertices of the analysis.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexFunctions {
    /// φ: ≥ 0, sums to 1.
    pub scaling_function: Vec<f64>,
    /// ψ: sums to 0.
    pub wavelet: Vec<f64>,
    /// How many vertices of the analysis φ reaches.
    pub support: usize,
}

/// A shape with its walk. Preparing costs O(n log n) once; each signal then costs its products only.
///
/// ```
/// use adwave::bands::{BandsParams, Schedule};
/// use adwave::{Decomposer, Progress, operator::OperatorParams};
/// use adwave::shape::{PointCloud, Shape};
/// let points: Vec<_> = (0..100).map(|i| [f64::from(i), 0.0, 0.0]).collect();
/// let shape = Shape::Cloud(PointCloud::new(points.clone())?);
/// let decomposer = Decomposer::new(&shape, &OperatorParams::default());
/// let bands = decomposer.decompose(points.as_flattened(), 3, &Schedule::dyadic(4)?, &BandsParams::default(), Progress::none())?;
/// assert_eq!(bands.steps, [0.0, 1.0, 2.0, 4.0, 8.0]);
/// let rebuilt = bands.reconstruct();
/// assert!(rebuilt.iter().zip(points.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Decomposer {
    geometry: PreparedGeometry,
    diffusion: Diffusion,
    /// Areas of the vertices of the analysis.
    areas: Vec<f64>,
    mean_length: f64,
    diagonal: f64,
    /// Which vertices are left out of the walk.
    mask: Option<Mask>,
    /// The rings of a mesh that one step can reach.
    rings: usize,
}

impl Decomposer {
    /// Welds the shape and builds its walk. O(n log n).
    pub fn new(shape: &Shape, params: &OperatorParams) -> Self {
        let none = Progress::none();
        let geometry = unstopped(PreparedGeometry::new(shape, params.weld, none));
        let operator = unstopped(local_operator(&geometry, params, none));
        let (areas, mean_length) = (operator.areas().to_vec(), operator.mean_length());
        let diagonal = shape.diagonal();
        let diffusion = unstopped(Diffusion::new(operator, none));
        Self { geometry, diffusion, areas, mean_length, diagonal, mask: None, rings: params.rings }
    }

    /// The same shape with a walk that leaves out the vertices that are flagged (in the order of the shape), for a signal
    /// that is not known there (see [`missing`](crate::mask::missing)). O(entries).
    ///
    /// Rows are divided by what they keep of their steps; nothing crosses a gap but round it. Bands and results are NaN at
    /// what is left out, and a signal may be NaN there. A welded vertex stays while one of its members does.
    ///
    /// # Errors
    /// [`MaskError`] when there is not one flag a vertex, or all are left out.
    ///
    /// ```
    /// use adwave::bands::{BandsParams, Schedule};
    /// use adwave::shape::{Graph, Shape};
    /// use adwave::{Decomposer, Progress, operator::OperatorParams};
    /// let path = Shape::Graph(Graph::new(4, &[(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0)])?);
    /// let walk = Decomposer::new(&path, &OperatorParams::default()).masked(&[false, false, true, false])?;
    /// let signal = [0.0, 4.0, f64::NAN, 9.0];
    /// let bands = walk.decompose(&signal, 1, &Schedule::dyadic(1)?, &BandsParams::default(), Progress::none())?;
    /// assert_eq!((bands.scaling[1][0], bands.scaling[1][1], bands.scaling[1][3]), (2.0, 2.0, 9.0));
    /// assert!(bands.scaling[1][2].is_nan());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn masked(&self, masked: &[bool]) -> Result<Self, MaskError> {
        let mask = Mask::new(masked, self.geometry.vertex_map())?;
        let points = self.geometry.points();
        let squared_length = |x: usize, y: usize| {
            if points.is_empty() { 1.0 } else { squared_distance(&points[x], &points[y]) }
        };
        let restricted = self.diffusion.restricted(mask.classes(), squared_length, Progress::none());
        let Ok(diffusion) = restricted else { unreachable!("there is one flag per welded vertex") };
        let keep = |(x, a): (usize, &f64)| if mask.classes()[x] { 0.0 } else { *a };
        let areas = self.areas.iter().enumerate().map(keep).collect();
        Ok(Self { diffusion, areas, mask: Some(mask), geometry: self.geometry.clone(), ..*self })
    }

    /// Which vertices of the analysis are left out of the walk; `None` where all take part.
    pub fn mask_flags(&self) -> Option<&[bool]> {
        self.mask.as_ref().map(Mask::classes)
    }

    /// Areas of the vertices of the analysis.
    pub(crate) fn welded_areas(&self) -> &[f64] {
        &self.areas
    }

    /// Whether the shape has positions and no faces.
    pub(crate) fn is_cloud(&self) -> bool {
        !self.geometry.points().is_empty() && self.geometry.triangles().is_empty()
    }

    /// The vertices of the analysis on the border of a mesh (ends of edges of one triangle) or of a cloud (a gap between its
    /// neighbours), and those next to what is left out of the walk; by rising index.
    pub(crate) fn border(&self) -> Vec<usize> {
        if self.is_cloud() {
            return cloud_border(self.geometry.points(), self.neighbours());
        }
        let mut edges: Vec<(u32, u32)> = Vec::with_capacity(3 * self.geometry.triangles().len());
        for t in self.geometry.triangles().iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) {
            edges.extend([(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(a, b)| (a.min(b), a.max(b))));
        }
        edges.par_sort_unstable();
        let single = edges.chunk_by(|e, f| e == f).filter(|same| same.len() == 1);
        let mut border: Vec<usize> =
            single.flat_map(|same| [same[0].0 as usize, same[0].1 as usize]).collect();
        if let Some(masked) = self.mask_flags() {
            let whole = one_ring(self.geometry.n_vertices(), self.geometry.triangles());
            border.extend((0..masked.len()).filter(|&x| whole.of(x).iter().any(|&y| masked[y as usize])));
            border.retain(|&x| !masked[x]);
        }
        border.sort_unstable();
        border.dedup();
        border
    }

    /// How far each vertex of the analysis is from the border along the surface, in model units: infinite beyond `reach` and
    /// where there is no border.
    pub(crate) fn distance_from_border(&self, reach: f64) -> Vec<f64> {
        let sources: Vec<(usize, f64)> = self.border().into_iter().map(|x| (x, 0.0)).collect();
        surface_distance(&self.ring(), self.geometry.points(), &sources, reach)
    }

    /// The one-ring of a mesh without the vertices that are left out; of a cloud or graph what one step can reach.
    pub(crate) fn ring(&self) -> Cow<'_, Adjacency> {
        if self.rings == 1 || self.geometry.triangles().is_empty() {
            return Cow::Borrowed(self.neighbours());
        }
        let ring = one_ring(self.geometry.n_vertices(), self.geometry.triangles());
        Cow::Owned(match self.mask_flags() {
            Some(masked) => unstopped(ring.without(masked, Progress::none())),
            None => ring,
        })
    }

    /// The vertices of the analysis and how they belong to those of the shape.
    pub fn geometry(&self) -> &PreparedGeometry {
        &self.geometry
    }

    /// One step of the walk, Φ₁, in the numbering of [`geometry`](Self::geometry).
    pub fn diffusion(&self) -> &Diffusion {
        &self.diffusion
    }

    /// The vertices that one step of the walk can reach, in the numbering of [`geometry`](Self::geometry).
    pub fn neighbours(&self) -> &Adjacency {
        self.diffusion.neighbours()
    }

    /// Number of vertices of the shape.
    pub fn n_vertices(&self) -> usize {
        self.geometry.vertex_map().n_vertices()
    }

    /// Length of the bounding box's diagonal in model units; 0 for a graph.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// `E`, the mean length of edges or the mean distance to the nearest neighbours, in model units.
    pub fn mean_length(&self) -> f64 {
        self.mean_length
    }

    /// The area of every vertex of the shape in squared model units; welded vertices share theirs equally.
    pub fn areas(&self) -> Vec<f64> {
        let mut shares = vec![0_u32; self.geometry.n_vertices()];
        for &class in self.geometry.vertex_map().as_slice() {
            shares[class as usize] += 1;
        }
        let share: Vec<f64> = self.areas.iter().zip(shares).map(|(a, n)| a / f64::from(n)).collect();
        self.geometry.vertex_map().scatter(&share, 1)
    }

    /// Counts of what the shape consists of.
    pub fn health(&self) -> Health {
        unstopped(health(&self.geometry, self.neighbours(), Progress::none()))
    }

    /// The number of dyadic levels to take where none is asked for, and why (see
    /// [`default_levels`](crate::bands::default_levels)).
    pub fn default_levels(&self) -> (usize, String) {
        self.levels_reaching(DEFAULT_REACH)
    }

    /// The number of dyadic levels whose last is as wide as a share of the diagonal, and why (see [`levels_reaching`]).
    pub fn levels_reaching(&self, reach: f64) -> (usize, String) {
        levels_reaching(reach, self.diffusion.step_length(), self.diagonal)
    }

    /// Splits `signal` (n_vertices × n_channels, row-major, in the order of the shape) into bands.
    ///
    /// # Errors
    /// As [`decompose`].
    pub fn decompose(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        params: &BandsParams,
        progress: Progress<'_>,
    ) -> Result<Bands, BandsError> {
        let Some(mask) = &self.mask else {
            return decompose(
                &self.diffusion,
                self.geometry.vertex_map(),
                signal,
                n_channels,
                schedule,
                params,
                progress,
            );
        };
        let filled = mask.fill(signal, n_channels, self.geometry.vertex_map())?;
        let mut bands = decompose(
            &self.diffusion,
            self.geometry.vertex_map(),
            &filled,
            n_channels,
            schedule,
            params,
            progress,
        )?;
        bands.scaling.iter_mut().chain(&mut bands.wavelet).for_each(|band| mask.clear(band, n_channels));
        Ok(bands)
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
        let class = self.geometry.vertex_map().welded(vertex);
        check_whole(schedule)?;
        let [.., before, last] = schedule.steps_from_zero()[..] else {
            unreachable!("a schedule has a level")
        };
        let (before, last) = (before as u64, last as u64);
        let functions = one_vertex(&self.diffusion, class, before, last, 0.0, progress)?;
        let dense = |row: &SparseRow| {
            self.geometry.vertex_map().scatter(&row.to_dense(self.geometry.n_vertices()), 1)
        };
        Ok(VertexFunctions {
            scaling_function: dense(&functions.scaling),
            wavelet: dense(&functions.wavelet),
            support: functions.scaling.columns.len(),
        })
    }

    /// Edits a signal: `f′ = f + Σ_j (Γ(j,x) − 1)·W_f(j,x)` with `Γ(j,x) = Π_layers (1 + r(x)·(g_j − 1))`.
    ///
    /// The same as eq. 18, since `f = S_f(J) + Σ_j W_f(j)`, and exact where nothing is edited: a vertex outside all regions
    /// keeps its value to the last bit. The order of the layers does not matter.
    ///
    /// One layer by itself costs about as much as its coarsest band; several cost all bands.
    ///
    /// # Errors
    /// [`FilterError`] when gains or regions do not fit, or the bands cannot be computed.
    pub fn filter(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        edit: &Edit<'_>,
        params: &BandsParams,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, FilterError> {
        let n_levels = schedule.n_levels();
        let mut resolved = Vec::with_capacity(edit.layers.len());
        for (k, layer) in edit.layers.iter().enumerate() {
            let gains = layer.gains.resolve(n_levels)?;
            let weights = layer
                .region
                .weights(self, edit.field, edit.field_names)
                .map_err(|source| FilterError::Region { layer: k + 1, source })?;
            resolved.push((gains, weights));
        }
        let filled = match &self.mask {
            Some(mask) => Cow::Owned(mask.fill(signal, n_channels, self.geometry.vertex_map())?),
            None => Cow::Borrowed(signal),
        };
        let mut edited = self.filter_layers(&filled, n_channels, schedule, &resolved, params, progress)?;
        if let Some(mask) = &self.mask {
            mask.restore(signal, n_channels, &mut edited);
        }
        Ok(edited)
    }

    /// [`filter`](Self::filter) of a signal that has a value everywhere, by gains and weights.
    fn filter_layers(
        &self,
        signal: &[f64],
        n_channels: usize,
        schedule: &Schedule,
        resolved: &[(Vec<f64>, Vec<f64>)],
        params: &BandsParams,
        progress: Progress<'_>,
    ) -> Result<Vec<f64>, BandsError> {
        check_signal(signal, self.n_vertices(), n_channels)?;
        let mut edited = signal.to_vec();
        if let [(gains, weights)] = resolved {
            // Γ − 1 = r·(g − 1): the region's weight stands before the sum over the bands, which is one polynomial of Φ₁.
            let factors: Vec<f64> = gains.iter().map(|g| g - 1.0).collect();
            let (vertex_map, diffusion) = (self.geometry.vertex_map(), &self.diffusion);
            let (change, _) = weighted_bands(
                diffusion, vertex_map, signal, n_channels, schedule, &factors, params, progress,
            )?;
            edited.par_chunks_mut(n_channels).with_min_len(1 << 12).enumerate().for_each(|(x, row)| {
                for (value, change) in row.iter_mut().zip(&change[x * n_channels..]) {
                    let change = weights[x] * change;
                    if change != 0.0 {
                        *value += change; // adding 0 would turn −0 into 0, and a file's text with it
                    }
                }
            });
            return Ok(edited);
        }
        let bands = decompose(
            &self.diffusion,
            self.geometry.vertex_map(),
            signal,
            n_channels,
            schedule,
            params,
            progress,
        )?;
        edited.par_chunks_mut(n_channels).with_min_len(1 << 12).enumerate().for_each(|(x, row)| {
            for (j, band) in bands.wavelet.iter().enumerate() {
                let gamma: f64 = resolved.iter().map(|(gains, r)| 1.0 + r[x] * (gains[j] - 1.0)).product();
                if gamma != 1.0 {
                    for (value, w) in row.iter_mut().zip(&band[x * n_channels..]) {
                        *value += (gamma - 1.0) * w;
                    }
                }
            }
        });
        Ok(edited)
    }
}
