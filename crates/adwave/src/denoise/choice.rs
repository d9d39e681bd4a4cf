//! What is decided by looking at all of a surface, or a sample of it, so that parts of it can be denoised alone.

use super::smoothed_normals::{GUIDE_LEVELS, GUIDE_MOVES, GUIDE_STEPS, LEVELS, Scales, Walks, fixed};
use super::surface::{NEIGHBORS, Surface};
use super::{
    Creases, DenoiseError, DenoiseInfo, DenoiseParams, MOVES, best_mixture, is_anything_to_do, noise_of,
    surface_of, used,
};
use crate::Progress;
use crate::bands::FixedSeries;
use crate::shape::{Adjacency, PreparedGeometry, Shape};
use serde::{Deserialize, Serialize};

/// Everything that [`denoise`](super::denoise) looks at all of a surface for: how large the noise is, the weights of the mixture, and the
/// medians that the walks go by.
///
/// By it parts of a surface too large for memory are denoised one after the other, with the bits of the whole: a point of the result
/// depends on those within [`reach`](Self::reach) rings of neighbors, where these are in the same order.
///
/// ```
/// use adwave::denoise::{DenoiseChoice, DenoiseParams, denoise};
/// use adwave::shape::{Mesh, Polygons, PreparedGeometry, Shape, WeldMode};
/// use adwave::Progress;
/// let rough = |x: u32, y: u32| [f64::from(x), f64::from(y), 0.3 * f64::from((7 * x + 3 * y) % 5) / 5.0];
/// let points = (0..400).map(|i| rough(i % 20, i / 20)).collect();
/// let corners = (0..380_u32).filter(|i| i % 20 < 19);
/// let faces: Vec<_> = corners.flat_map(|i| [[i, i + 1, i + 20], [i + 1, i + 21, i + 20]]).collect();
/// let shape = Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&faces))?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
/// let choice = DenoiseChoice::of(&geometry, &DenoiseParams::default(), Progress::none())?;
/// let part = choice.denoise_mesh(geometry.points(), geometry.triangles(), Progress::none())?;
/// let whole = denoise(&geometry, &DenoiseParams::default(), Progress::none())?;
/// let part = geometry.vertex_map().scatter(&part, 1);
/// let off = |x: usize| (part[x][2] - whole.points[x][2]).abs();
/// assert!((0..400).all(|x| off(x) < 1e-3 * whole.info.noise));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DenoiseChoice {
    /// What is assumed of the noise, and the weights. What is counted of a result is 0.
    pub info: DenoiseInfo,
    creases: Creases,
    scales: Scales,
}

impl DenoiseChoice {
    /// Nearest neighbors that a point of a cloud has.
    pub const NEIGHBORS: usize = NEIGHBORS;

    /// From a surface, or a sample of one that is made of connected pieces, all of which is looked at: [`denoise`](super::denoise) estimates
    /// the risk of more than 48 000 triangles or points on a sample of its own. O(n log n).
    ///
    /// # Errors
    /// [`DenoiseError`] for a graph, a parameter out of its range, or when cancelled.
    pub fn of(
        geometry: &PreparedGeometry,
        params: &DenoiseParams,
        progress: Progress<'_>,
    ) -> Result<Self, DenoiseError> {
        params.check()?;
        if matches!(geometry.shape(), Shape::Graph(_)) {
            return Err(DenoiseError::NoPositions);
        }
        let (points, unit) = geometry.unit_points(progress)?;
        let surface = surface_of(geometry, &points, progress)?;
        let mut info = noise_of(&surface, (&points, unit), params, progress)?;
        let (noise, mut scales) = (info.noise / unit, Scales::default());
        if is_anything_to_do(&surface, noise, params)
            && let Some((walks, _)) =
                best_mixture(&surface, &points, None, noise, params, &mut info, progress.quiet())?
        {
            scales = Scales { distance: walks.scales.distance * unit * unit, ..walks.scales };
        }
        Ok(Self { info, creases: params.creases, scales })
    }

    /// How many rings of neighbors around a point decide its result, whatever is chosen: on a mesh by edges, on a cloud by
    /// [`NEIGHBORS`](Self::NEIGHBORS) nearest and those that name it.
    ///
    /// # Errors
    /// Never; the levels and the accuracy are fixed.
    pub fn reach() -> Result<usize, DenoiseError> {
        let rings = |n_levels| {
            let bands = fixed(n_levels)?;
            Ok::<_, DenoiseError>(bands.iter().map(FixedSeries::reach).max().unwrap_or(0))
        };
        // From the end: moves, the walk by its rows, whose entries ask for normals one ring on, of points that have moved by normals which
        // the first walk smoothed, and that for normals of points that have been smoothed; what is one ring for neighbors is
        // another for the planes or triangles that normals are of.
        Ok(MOVES + rings(LEVELS)? + 2 + GUIDE_MOVES + 1 + rings(GUIDE_LEVELS)? + 2 + GUIDE_STEPS + 2)
    }

    /// The points of a part of a mesh without noise; those that have fewer than [`reach`](Self::reach) rings around them are other than
    /// in the whole. `triangles` in any order.
    ///
    /// # Errors
    /// When cancelled.
    pub fn denoise_mesh(
        &self,
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        if self.info.kept >= 1.0 {
            return Ok(points.to_vec());
        }
        self.denoise(&Surface::mesh(points.len(), triangles.to_vec(), progress)?, points, progress)
    }

    /// The points of a part of a cloud without noise, as [`denoise_mesh`](Self::denoise_mesh). Points next to each other have `normals` on
    /// the same side; which one that is, is of no concern, nor is their length.
    ///
    /// # Errors
    /// When cancelled.
    ///
    /// # Panics
    /// Unless there are as many rows of neighbors and normals as points.
    pub fn denoise_cloud(
        &self,
        points: &[[f64; 3]],
        neighbors: Adjacency,
        normals: Vec<[f64; 3]>,
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        assert_eq!(neighbors.n_rows(), points.len(), "a row of neighbors for each point");
        assert_eq!(normals.len(), points.len(), "a normal for each point");
        if self.info.kept >= 1.0 {
            return Ok(points.to_vec());
        }
        self.denoise(&Surface::cloud_of_neighbors(neighbors, normals), points, progress)
    }

    fn denoise(
        &self,
        surface: &Surface,
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, DenoiseError> {
        let (wanted, weights) = used(&self.info, self.creases);
        let walks = Walks::new(surface, points, wanted, Some(&self.scales), progress)?;
        let normals = walks.mixture(&weights, progress)?;
        drop(walks);
        let mut moved = points.to_vec();
        surface.move_to(&mut moved, &normals, MOVES, progress)?;
        Ok(moved)
    }
}
