//! Constraints on smoothed positions: no sliding along the surface, no shrinking of borders, no loss of volume.

mod part;

pub use part::{NORMAL_STEPS, NormalSign, smoothed_normals};

use crate::named_values;
use crate::parallel;
use crate::shape::NoShape;
use crate::shape::{PreparedGeometry, encloses_volume};
use crate::signal::aligned_normals;
use crate::vector::{add_scaled, dot, subtract, unit};
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Treatment of the borders of an open mesh or cloud, and of the end points of a curve, when coordinates are filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Borders {
    /// Vertices of parts with a border move along the normals only, unless a direction is set. Flat areas and the
    /// outline keep their place, and bumps near the outline are smoothed as elsewhere.
    #[default]
    Natural,
    /// Like `Natural`, except that vertices on the border do not move; the change reaches its full size over a few
    /// edges.
    Keep,
    /// No treatment, as in the paper: smoothing shrinks borders, because their neighbors are on one side only.
    Free,
}

named_values!(Borders, "border", {
    Natural => "natural", "Flat parts stay flat, and the outline is drawn neither in nor out";
    Keep => "keep", "As natural, and the outline stays where it is";
    Free => "free", "Borders follow the bands, as in the paper: smoothing draws them in";
});

/// Directions in which vertices may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum MoveDirection {
    /// All directions, as in the paper: unevenly spaced samples also slide along the surface.
    Free,
    /// Along the normals only: the samples do not slide.
    Normal,
    /// Within the surface only, which evens out the samples.
    Surface,
    /// Along x only.
    X,
    /// Along y only.
    Y,
    /// Along z only, for heights of a terrain.
    Z,
}

named_values!(MoveDirection, "direction", {
    Normal => "normal", "Along the normals: samples stay where they are on the surface";
    Surface => "surface", "Within the surface: samples are evened out, the shape stays";
    X => "x", "Along x";
    Y => "y", "Along y";
    Z => "z", "Along z, as for the heights of a terrain";
    Free => "free", "In all directions, as in the paper: points of a cloud slide together where they are dense";
});

impl MoveDirection {
    /// Index of the coordinate along which vertices move; `None` if it is not a single one.
    pub fn axis(self) -> Option<usize> {
        match self {
            Self::X => Some(0),
            Self::Y => Some(1),
            Self::Z => Some(2),
            Self::Free | Self::Normal | Self::Surface => None,
        }
    }
}

/// Treatment of the volume of a closed mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Volume {
    /// The volume that the filter gives.
    #[default]
    Free,
    /// The original volume: all moved vertices are shifted by one common distance along their normals.
    Keep,
}

named_values!(Volume, "volume", {
    Free => "free", "As the filter leaves it";
    Keep => "keep", "Restored by one offset along the normals";
});

/// Constraints on new positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PositionParams {
    /// Directions in which vertices move; `None` means along the normals on a cloud, and all directions on a mesh or
    /// a curve.
    pub along: Option<MoveDirection>,
    /// Treatment of borders.
    pub borders: Borders,
    /// Treatment of the volume.
    pub volume: Volume,
}

impl PositionParams {
    /// Sets [`along`](Self::along).
    #[must_use]
    pub fn with_along(self, along: Option<MoveDirection>) -> Self {
        Self { along, ..self }
    }

    /// Sets [`borders`](Self::borders).
    #[must_use]
    pub fn with_borders(self, borders: Borders) -> Self {
        Self { borders, ..self }
    }

    /// Sets [`volume`](Self::volume).
    #[must_use]
    pub fn with_volume(self, volume: Volume) -> Self {
        Self { volume, ..self }
    }
}

/// Error of constraining positions.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum PositionsError {
    /// The volume should be kept, but the surface does not enclose one.
    #[error(
        "the shape encloses no volume to keep: it is no mesh all of whose edges have two faces that agree on the orientation"
    )]
    NoVolume,
    /// No common distance restores the volume.
    #[error(
        "no offset along the normals restores the volume; filter less strongly, or do not keep the volume"
    )]
    VolumeLost,
    /// The domain is no shape.
    #[error(transparent)]
    NoShape(#[from] NoShape),
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for PositionsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoShape(no_shape) => no_shape.kind(),
            Self::NoVolume | Self::VolumeLost => ErrorKind::Input,
            Self::Cancelled(cancelled) => cancelled.kind(),
        }
    }
}

/// Number of edges over which the change reaches its full size next to a fixed border.
const KEPT_EDGES: f64 = 4.0;

/// Maximal number of Newton steps for the offset that restores the volume; three or four are usual.
const MAX_OFFSET_STEPS: usize = 30;

/// Relative error of the restored volume.
const VOLUME_ACCURACY: f64 = 1e-13;

/// Constrains the positions after a filter by [`PositionParams`]. `before` and `after` hold n_vertices positions in
/// the order of the shape. Vertices that the filter did not move keep their positions exactly. O(n log n).
///
/// Along the normals ([`MoveDirection::Normal`]) a vertex moves by `n·(n·d)` instead of d, where n is the unit
/// normal smoothed over a few edges; within the surface it moves by `d − n·(n·d)`. On a cloud, tangential motion
/// pulls points together where they are dense, which opens holes.
///
/// With borders other than [`Borders::Free`], vertices of a mesh without a set direction move along the normals in
/// each connected part that has a border. There, tangential motion is the drift caused by one-sided neighbors,
/// which shrinks the outline by σ/√π. Parts without a border keep their bits. [`Volume::Keep`] then adds an offset
/// δ times the vertex normal at every vertex that the filter moved, with δ from Newton's method on the enclosed
/// volume (`desbrun1999`).
///
/// End points of a curve keep their places unless borders are free.
///
/// ```
/// use adwave::positions::{PositionParams, constrain_positions};
/// use adwave::shape::{Mesh, Polygons, Shape};
/// use adwave::{Decomposer, Progress};
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let faces = Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]);
/// let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(square.clone(), faces)?));
/// let drawn_in: Vec<_> = square.iter().map(|p| p.map(|c| 0.8 * c)).collect();
/// assert_eq!(constrain_positions(&decomposer, &square, drawn_in, &PositionParams::default(), Progress::none())?, square);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PositionsError`] if the volume should be kept but there is none, or if the call is cancelled.
///
/// # Panics
/// Unless there are n_vertices positions.
pub fn constrain_positions(
    decomposer: &Decomposer,
    before: &[[f64; 3]],
    after: Vec<[f64; 3]>,
    params: &PositionParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, PositionsError> {
    let n = decomposer.n_vertices();
    assert!(before.len() == n && after.len() == n, "a position for each vertex");
    let geometry = decomposer.geometry_for("a constraint on positions")?;
    let prepared = PreparedShape { decomposer, geometry };
    let after = if geometry.shape().is_graph() {
        directed_along_edges(prepared, before, &after, *params, progress)?
    } else {
        directed(prepared, before, after, *params, progress)?
    };
    match params.volume {
        Volume::Free => Ok(after),
        Volume::Keep => with_volume_of(prepared, before, &after, progress),
    }
}

/// Values between `before` (weight 0) and `after` (weight 1), with one weight per vertex; at weights 0 and 1 they are
/// those values bit for bit. Both have one row per vertex. O(n).
///
/// ```
/// let blended = adwave::positions::blend_by_weights(&[0.0, 0.0, 4.0], &[1.0, 1.0, 8.0], &[0.0, 1.0, 0.25]);
/// assert_eq!(blended, [0.0, 1.0, 5.0]);
/// ```
///
/// # Panics
/// If the values do not form complete rows, or their numbers differ.
pub fn blend_by_weights(before: &[f64], after: &[f64], weights: &[f64]) -> Vec<f64> {
    assert!(
        before.len() == after.len() && before.len().is_multiple_of(weights.len().max(1)),
        "a row for each weight"
    );
    let n_channels = before.len() / weights.len().max(1);
    let blend = |k: usize| match weights[k / n_channels] {
        0.0 => before[k],
        1.0 => after[k],
        weight => before[k] + weight * (after[k] - before[k]),
    };
    (0..before.len()).map(blend).collect()
}

/// A shape with its operator.
#[derive(Clone, Copy)]
struct PreparedShape<'a> {
    decomposer: &'a Decomposer,
    geometry: &'a PreparedGeometry,
}

/// New positions with displacements in the allowed directions, and with borders treated.
fn directed(
    shape: PreparedShape<'_>,
    before: &[[f64; 3]],
    after: Vec<[f64; 3]>,
    params: PositionParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let decomposer = shape.decomposer;
    let by_default =
        if shape.geometry.shape().is_cloud() { MoveDirection::Normal } else { MoveDirection::Free };
    let along = params.along.unwrap_or(by_default);
    // An explicit request for all directions applies at borders too.
    let has_border_rule =
        params.borders == Borders::Keep || (params.borders == Borders::Natural && params.along.is_none());
    let border = if has_border_rule { decomposer.border(progress)? } else { Vec::new() };
    if along == MoveDirection::Free && border.is_empty() {
        return Ok(after);
    }
    let is_open = reached(decomposer, &border, progress)?;
    let needs_normals = matches!(along, MoveDirection::Free | MoveDirection::Normal | MoveDirection::Surface);
    let normals = if needs_normals { smooth_normals(shape, progress)? } else { Vec::new() };
    let width = KEPT_EDGES * decomposer.mean_length();
    let kept = match params.borders {
        Borders::Keep if !border.is_empty() => decomposer.distance_from_border(width, progress)?,
        _ => Vec::new(),
    };
    let welded = decomposer.vertex_map().as_slice();
    parallel::try_collect(after.len(), progress, |v| {
        let x = welded[v] as usize;
        if before[v] == after[v] || (along == MoveDirection::Free && !is_open[x]) {
            return after[v];
        }
        let moved = subtract(&after[v], &before[v]);
        let moved = match along {
            MoveDirection::Free if params.along.is_none() => MoveDirection::Normal,
            along => along,
        }
        .part_of(&moved, normals.get(x).unwrap_or(&[0.0; 3]));
        let share = if is_open[x] { kept.get(x).map_or(1.0, |d| (d / width).min(1.0)) } else { 1.0 };
        // Rises from 0 on the border to 1, smoothly at both ends.
        add_scaled(&before[v], share * share * (3.0 - 2.0 * share), &moved)
    })
}

/// New positions of a curve or graph with displacements in the allowed directions. Unless borders are free, the end
/// points of a curve keep their places; the operator keeps their neighbors from being drawn in
/// ([`EndPoints`](crate::operator::EndPoints)). The normal direction is across the curve, its surface the curve
/// itself; both are free at ends, branches and sharp returns, where the curve has no direction.
fn directed_along_edges(
    PreparedShape { decomposer, geometry }: PreparedShape<'_>,
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    params: PositionParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let (points, welded) = (geometry.points(), geometry.vertex_map().as_slice());
    let mut is_kept = vec![false; geometry.n_vertices()];
    if params.borders != Borders::Free {
        for x in geometry.curve_ends() {
            is_kept[x] = true;
        }
    }
    let tangent = |x: usize| match *decomposer.neighbors().row(x) {
        [y, z] => unit(&subtract(&points[z as usize], &points[y as usize])),
        _ => None,
    };
    parallel::try_collect(after.len(), progress, |v| {
        let x = welded[v] as usize;
        if before[v] == after[v] || is_kept[x] {
            return before[v];
        }
        let moved = subtract(&after[v], &before[v]);
        let along_tangent = |t: [f64; 3]| t.map(|c| c * dot(&moved, &t));
        let moved = match params.along {
            None | Some(MoveDirection::Free) => return after[v],
            Some(MoveDirection::Normal) => tangent(x).map(|t| subtract(&moved, &along_tangent(t))),
            Some(MoveDirection::Surface) => tangent(x).map(along_tangent),
            Some(direction) => {
                direction.axis().map(|axis| std::array::from_fn(|c| if c == axis { moved[c] } else { 0.0 }))
            }
        }
        .unwrap_or(moved);
        add_scaled(&before[v], 1.0, &moved)
    })
}

/// Flags of the welded vertices that are connected to one of `sources`.
fn reached(
    decomposer: &Decomposer,
    sources: &[usize],
    progress: Progress<'_>,
) -> Result<Vec<bool>, Cancelled> {
    let ring = decomposer.ring(progress)?;
    let mut is_reached = vec![false; ring.n_rows()];
    let mut front: Vec<usize> = sources.to_vec();
    for &x in sources {
        is_reached[x] = true;
    }
    while let Some(x) = front.pop() {
        for &y in ring.row(x) {
            if !std::mem::replace(&mut is_reached[y as usize], true) {
                front.push(y as usize);
            }
        }
    }
    progress.check()?;
    Ok(is_reached)
}

/// Unit normals of the welded vertices, from the surrounding faces or from a cloud's tangent planes, after
/// [`NORMAL_STEPS`] lazy steps with equal weights; zero if there is none. On a cloud they have either sign, and
/// neighbors count with the sign of the vertex itself: motion along a normal does not depend on its sign, and
/// orienting a cloud takes longer than filtering it.
fn smooth_normals(shape: PreparedShape<'_>, progress: Progress<'_>) -> Result<Vec<[f64; 3]>, Cancelled> {
    let PreparedShape { decomposer, geometry } = shape;
    let ring = decomposer.ring(progress)?;
    let sign = if geometry.shape().is_cloud() { NormalSign::Arbitrary } else { NormalSign::Side };
    smoothed_normals(raw_normals(shape, geometry.points(), progress)?, &ring, sign, progress)
}

/// Normals from the faces around each vertex; on a cloud from its tangent planes, with either sign.
fn raw_normals(
    PreparedShape { decomposer, geometry }: PreparedShape<'_>,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    if geometry.shape().is_cloud() {
        return aligned_normals(
            points,
            &*decomposer.ring(progress)?,
            &vec![[0.0; 3]; points.len()],
            progress,
        );
    }
    geometry.incidence(progress)?.normals(points, progress)
}

/// New positions shifted along their normals by one offset, so that the volume equals that of the old positions.
fn with_volume_of(
    shape: PreparedShape<'_>,
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, PositionsError> {
    let PreparedShape { decomposer, geometry } = shape;
    let map = geometry.vertex_map();
    if !encloses_volume(geometry, progress)? {
        return Err(PositionsError::NoVolume);
    }
    let wanted = geometry.volume_of(geometry.points());
    let points = map.try_positions(after, progress)?;
    let old = map.try_positions(before, progress)?;
    let mut normals = raw_normals(shape, &points, progress)?;
    for (x, n) in normals.iter_mut().enumerate() {
        if points[x] == old[x] {
            *n = [0.0; 3];
        }
    }
    let moved = |offset: f64| -> Result<f64, Cancelled> {
        let points =
            parallel::try_collect(points.len(), progress, |x| add_scaled(&points[x], offset, &normals[x]))?;
        Ok(geometry.volume_of(&points))
    };
    let mut offset = 0.0;
    let step = 1e-3 * decomposer.mean_length();
    let mut left = moved(0.0)? - wanted;
    for _ in 0..MAX_OFFSET_STEPS {
        if left.abs() <= VOLUME_ACCURACY * wanted.abs() {
            break;
        }
        let slope = (moved(offset + step)? - moved(offset - step)?) / (2.0 * step);
        let next = offset - left / slope;
        let left_then = moved(next)? - wanted;
        if left_then.is_nan() || left_then.abs() >= left.abs() {
            break;
        }
        (offset, left) = (next, left_then);
    }
    if left.is_nan() || left.abs() > 1e-9 * wanted.abs() {
        return Err(PositionsError::VolumeLost);
    }
    let welded = map.as_slice();
    Ok(parallel::try_collect(after.len(), progress, |v| {
        add_scaled(&after[v], offset, &normals[welded[v] as usize])
    })?)
}
