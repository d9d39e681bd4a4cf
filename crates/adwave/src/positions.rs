//! What smoothing should not do to a shape: slide its points along the surface, draw its borders in, and take its volume.

use crate::parallel;
use crate::shape::{enclosed_volume, triangles_at_vertices, try_vertex_normals};
use crate::signal::aligned_normals;
use crate::vector::{add_scaled, dot, subtract, unit};
use crate::{Cancelled, ClassifiedError, Decomposer, ErrorKind, Progress};
use crate::named_values;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What becomes of the borders of an open mesh or cloud when its coordinates are filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Borders {
    /// Vertices of parts with a border move along the normals only, unless a direction is asked for: what is flat stays where it
    /// is, the outline is drawn neither in nor out, and next to it bumps are smoothed as elsewhere.
    #[default]
    Natural,
    /// The same, and vertices on the border stay where they are; the change grows to its full size over some edges.
    Keep,
    /// As the bands have it (the paper's): smoothing draws borders in, since neighbors stand on one side only.
    Free,
}

/// In which directions vertices may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Along {
    /// In all (the paper's): samples that are not even slide along the surface as well.
    Free,
    /// Along the normals only: the samples stay where they are on the surface.
    Normal,
    /// Within the surface only, which evens out its samples.
    Surface,
    /// Along x only.
    X,
    /// Along y only.
    Y,
    /// Along z only, as heights of a terrain should.
    Z,
}

named_values!(Borders, "border", {
    Natural => "natural", "Flat parts stay flat, and the outline is drawn neither in nor out";
    Keep => "keep", "As natural, and the outline stays where it is";
    Free => "free", "Borders follow the bands, as in the paper: smoothing draws them in";
});

named_values!(Along, "direction", {
    Normal => "normal", "Along the normals: samples stay where they are on the surface";
    Surface => "surface", "Within the surface: samples are evened out, the shape stays";
    X => "x", "Along x";
    Y => "y", "Along y";
    Z => "z", "Along z, as for the heights of a terrain";
    Free => "free", "In all directions, as in the paper: points of a cloud slide together where they are dense";
});

named_values!(Volume, "volume", {
    Free => "free", "As the filter leaves it";
    Keep => "keep", "Restored by one offset along the normals";
});

/// What becomes of the volume of a closed mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Volume {
    /// Whatever the filter makes of it.
    #[default]
    Free,
    /// The old one: all that moved moves by one common distance along the normals as well.
    Keep,
}

/// What is asked of new positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PositionParams {
    /// In which directions vertices move; `None` is along the normals on a cloud, and in all on a mesh.
    pub along: Option<Along>,
    /// What becomes of borders.
    pub borders: Borders,
    /// What becomes of the volume.
    pub volume: Volume,
}

/// Why positions cannot be had as asked for.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum PositionsError {
    /// A volume to keep needs a surface that encloses one.
    #[error(
        "the shape encloses no volume to keep: it is no mesh all of whose edges have two faces that agree on the orientation"
    )]
    NoVolume,
    /// No common distance gives the old volume.
    #[error("no offset along the normals gives the old volume; filter less strongly, or let the volume go")]
    VolumeLost,
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for PositionsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NoVolume | Self::VolumeLost => ErrorKind::Input,
            Self::Cancelled(cancelled) => cancelled.kind(),
        }
    }
}

/// Lazy steps by which normals are smoothed before positions move along them.
const NORMAL_STEPS: usize = 4;

/// Edges over which a change grows to its full size next to a border that is kept.
const KEPT_EDGES: f64 = 4.0;

/// Steps of Newton's method for the offset that restores the volume; it converges in three or four.
const MAX_OFFSET_STEPS: usize = 30;

/// Relative error of the volume that is left.
const VOLUME_ACCURACY: f64 = 1e-13;

/// Positions after a filter, with what [`PositionParams`] ask for: `before` and `after` are n_vertices positions in the order of
/// the shape. Vertices that the filter left where they were stay there to the last bit. O(n log n).
///
/// Along the normals ([`Along::Normal`]) a vertex moves by `n·(n·d)` in place of d, n the unit normal there, smoothed over a few edges;
/// within the surface by `d − n·(n·d)`. On a cloud what is tangential pulls points together where they are dense: neighbors come
/// nearer and holes open.
///
/// With borders other than [`Borders::Free`], vertices of a mesh for which no direction is asked for move along the normals in each connected part that
/// has a border: what is tangential there is the drift of one-sided neighbors, which draws the outline in by σ/√π. Parts without a
/// border keep their bits. [`Volume::Keep`] then adds one offset δ times the vertex's
/// normal, weighted 1 where the filter moved anything and 0 elsewhere, δ from Newton's method on the enclosed volume (`desbrun1999`).
///
/// ```
/// use adwave::positions::{PositionParams, settle};
/// use adwave::shape::{Mesh, Polygons, Shape};
/// use adwave::{Decomposer, Progress};
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let faces = Polygons::from_triangles(&[[0, 1, 2], [0, 2, 3]]);
/// let decomposer = Decomposer::new(&Shape::Mesh(Mesh::new(square.clone(), faces)?));
/// let drawn_in: Vec<_> = square.iter().map(|p| p.map(|c| 0.8 * c)).collect();
/// assert_eq!(settle(&decomposer, &square, drawn_in, &PositionParams::default(), Progress::none())?, square);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`PositionsError`] when a volume should be kept and there is none, or when cancelled.
///
/// # Panics
/// When there are not n_vertices positions.
pub fn settle(
    decomposer: &Decomposer,
    before: &[[f64; 3]],
    after: Vec<[f64; 3]>,
    params: &PositionParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, PositionsError> {
    let n = decomposer.n_vertices();
    assert!(before.len() == n && after.len() == n, "a position for each vertex");
    let after = directed(decomposer, before, after, *params, progress)?;
    match params.volume {
        Volume::Free => Ok(after),
        Volume::Keep => with_volume_of(decomposer, before, &after, progress),
    }
}

/// The new positions with displacements in the directions that are asked for, and borders treated.
fn directed(
    decomposer: &Decomposer,
    before: &[[f64; 3]],
    after: Vec<[f64; 3]>,
    params: PositionParams,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let by_default = if decomposer.is_cloud() { Along::Normal } else { Along::Free };
    let along = params.along.unwrap_or(by_default);
    // Who asks for all directions gets them at borders too.
    let has_border_rule =
        params.borders == Borders::Keep || (params.borders == Borders::Natural && params.along.is_none());
    let border = if has_border_rule { decomposer.border(progress)? } else { Vec::new() };
    if along == Along::Free && border.is_empty() {
        return Ok(after);
    }
    let is_open = reached(decomposer, &border, progress)?;
    let needs_normals = matches!(along, Along::Free | Along::Normal | Along::Surface);
    let normals = if needs_normals { smooth_normals(decomposer, progress)? } else { Vec::new() };
    let width = KEPT_EDGES * decomposer.mean_length();
    let kept = match params.borders {
        Borders::Keep if !border.is_empty() => decomposer.distance_from_border(width, progress)?,
        _ => Vec::new(),
    };
    let welded = decomposer.geometry().vertex_map().as_slice();
    parallel::try_collect(after.len(), progress, |v| {
        let x = welded[v] as usize;
        if before[v] == after[v] || (along == Along::Free && !is_open[x]) {
            return after[v];
        }
        let moved = subtract(&after[v], &before[v]);
        let part = |axis: usize| std::array::from_fn(|c| if c == axis { moved[c] } else { 0.0 });
        let along_normal = |n: &[f64; 3]| n.map(|c| c * dot(&moved, n));
        let moved = match along {
            Along::Free if params.along.is_some() => moved,
            Along::Free | Along::Normal => along_normal(&normals[x]),
            Along::Surface => subtract(&moved, &along_normal(&normals[x])),
            Along::X => part(0),
            Along::Y => part(1),
            Along::Z => part(2),
        };
        let share = if is_open[x] { kept.get(x).map_or(1.0, |d| (d / width).min(1.0)) } else { 1.0 };
        // From 0 on the border to 1 without a corner at either end.
        add_scaled(&before[v], share * share * (3.0 - 2.0 * share), &moved)
    })
}

/// Which welded vertices are connected with one of `sources`.
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
        for &y in ring.of(x) {
            if !std::mem::replace(&mut is_reached[y as usize], true) {
                front.push(y as usize);
            }
        }
    }
    progress.check()?;
    Ok(is_reached)
}

/// Unit normals of the welded vertices, of the faces round them or of a cloud's tangent planes, after [`NORMAL_STEPS`] lazy steps to
/// each neighbor alike; zero where there is none. Of a cloud they have either sign, and neighbors count with that of the vertex itself:
/// what moves along a normal does not depend on its sign, and to orient a cloud takes longer than to filter it.
fn smooth_normals(decomposer: &Decomposer, progress: Progress<'_>) -> Result<Vec<[f64; 3]>, Cancelled> {
    let ring = decomposer.ring(progress)?;
    let is_cloud = decomposer.is_cloud();
    let mut normals = raw_normals(decomposer, decomposer.geometry().points(), progress)?;
    for _ in 0..NORMAL_STEPS {
        normals = parallel::try_collect(normals.len(), progress, |x| {
            let near = ring.of(x);
            let share = 0.5 / near.len().max(1) as f64;
            let own = if near.is_empty() { 1.0 } else { 0.5 };
            near.iter().fold(normals[x].map(|c| own * c), |sum, &y| {
                let other = &normals[y as usize];
                let turned = is_cloud && dot(&normals[x], other) < 0.0;
                add_scaled(&sum, if turned { -share } else { share }, other)
            })
        })?;
    }
    parallel::try_collect(normals.len(), progress, |x| unit(&normals[x]).unwrap_or_default())
}

/// Normals of the faces round each vertex; of a cloud those of its tangent planes, of either sign.
fn raw_normals(
    decomposer: &Decomposer,
    points: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    let triangles = decomposer.geometry().triangles();
    if decomposer.is_cloud() {
        return aligned_normals(
            points,
            &*decomposer.ring(progress)?,
            &vec![[0.0; 3]; points.len()],
            progress,
        );
    }
    let at_vertex = triangles_at_vertices(points.len(), triangles, progress)?;
    try_vertex_normals(points, triangles, &at_vertex, progress)
}

/// The new positions moved by one offset along their normals, so that the volume is that of the old ones.
fn with_volume_of(
    decomposer: &Decomposer,
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, PositionsError> {
    let geometry = decomposer.geometry();
    let (map, triangles) = (geometry.vertex_map(), geometry.triangles());
    let Some(wanted) = decomposer.health().volume else { return Err(PositionsError::NoVolume) };
    let points = map.try_positions(after, progress)?;
    let old = map.try_positions(before, progress)?;
    let mut normals = raw_normals(decomposer, &points, progress)?;
    for (x, n) in normals.iter_mut().enumerate() {
        if points[x] == old[x] {
            *n = [0.0; 3];
        }
    }
    let moved = |offset: f64| -> Result<f64, Cancelled> {
        let points =
            parallel::try_collect(points.len(), progress, |x| add_scaled(&points[x], offset, &normals[x]))?;
        Ok(enclosed_volume(&points, triangles))
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
