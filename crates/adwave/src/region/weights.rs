//! Weights of a region on the vertices of a shape.

use super::metric::VerticesWithin;
use super::morph;
use super::{BrushStroke, Length, Location, Region, RegionError, SurfaceMetric, smooth_rise};
use crate::shape::VertexMap;
use crate::{Progress, parallel};
use nalgebra::Vector3;

/// Default width of the falloff of boxes and half-spaces.
const DEFAULT_FALLOFF: Length = Length::PercentOfDiagonal(5.0);

/// Look-up of vertex fields by name, returning `(n_channels, values)`.
pub type FieldLookup<'a> = dyn Fn(&str) -> Option<(usize, Vec<f64>)> + Sync + 'a;

/// Weights r(x) in [0, 1] of a region, in the form that costs least.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RegionWeights {
    /// Weight 1 at every vertex.
    Everywhere,
    /// Weights at some welded vertices, in ascending order; 0 at all others.
    Sparse {
        /// The welded vertices.
        vertices: Vec<u32>,
        /// Weight of each vertex in `vertices`.
        weights: Vec<f64>,
    },
    /// Weight of each welded vertex, in the analysis order.
    Welded(Vec<f64>),
    /// Weight of each vertex of the shape, in its order: weights given by the caller, or those of a field.
    Vertices(Vec<f64>),
}

impl RegionWeights {
    /// One weight per vertex of the shape, in its order. O(n).
    pub fn to_vertices(&self, vertex_map: &VertexMap) -> Vec<f64> {
        match self {
            Self::Everywhere => vec![1.0; vertex_map.n_vertices()],
            Self::Sparse { .. } => vertex_map.scatter(&self.to_welded(vertex_map.n_welded()), 1),
            Self::Welded(weights) => vertex_map.scatter(weights, 1),
            Self::Vertices(weights) => weights.clone(),
        }
    }

    /// One weight per welded vertex.
    ///
    /// # Panics
    /// If the weights are per vertex of the shape.
    fn to_welded(&self, n_welded: usize) -> Vec<f64> {
        match self {
            Self::Everywhere => vec![1.0; n_welded],
            Self::Sparse { vertices, weights } => {
                let mut dense = vec![0.0; n_welded];
                for (&x, &weight) in vertices.iter().zip(weights) {
                    dense[x as usize] = weight;
                }
                dense
            }
            Self::Welded(weights) => weights.clone(),
            Self::Vertices(_) => unreachable!("members of a welded vertex may differ"),
        }
    }

    /// One weight per welded vertex: the mean over its members.
    pub(super) fn to_mean(&self, vertex_map: &VertexMap) -> Vec<f64> {
        match self {
            Self::Vertices(weights) => vertex_map.mean(weights, 1),
            other => other.to_welded(vertex_map.n_welded()),
        }
    }

    /// Checks that the weights match the shape and are finite.
    ///
    /// # Errors
    /// [`RegionError::WrongLength`], [`RegionError::NoSuchVertex`] or [`RegionError::BadNumber`].
    pub fn check(&self, vertex_map: &VertexMap) -> Result<(), RegionError> {
        let (n_welded, n_vertices) = (vertex_map.n_welded(), vertex_map.n_vertices());
        let (weights, expected) = match self {
            Self::Everywhere => return Ok(()),
            Self::Sparse { vertices, weights } => {
                if let Some(&vertex) = vertices.iter().find(|&&x| x as usize >= n_welded) {
                    return Err(RegionError::NoSuchVertex { vertex, n_vertices: n_welded });
                }
                (weights, vertices.len())
            }
            Self::Welded(weights) => (weights, n_welded),
            Self::Vertices(weights) => (weights, n_vertices),
        };
        if weights.len() != expected {
            return Err(RegionError::WrongLength { n_values: weights.len(), expected });
        }
        check_finite("a weight", weights)
    }
}

impl Region {
    /// Computes the weights r(x) in [0, 1] of the region on a shape. Balls, strokes and lists of vertices cost what
    /// they cover, other regions O(n).
    ///
    /// `field` returns the vertex fields of the shape by name, and `field_names` lists them for error messages.
    ///
    /// # Errors
    /// [`RegionError`] if the region names a vertex or field that does not exist, has an invalid number, or the
    /// call is cancelled.
    pub fn weights(
        &self,
        metric: &SurfaceMetric,
        field: &FieldLookup<'_>,
        field_names: &[String],
        progress: Progress<'_>,
    ) -> Result<RegionWeights, RegionError> {
        progress.check()?;
        Ok(match self {
            Self::Everywhere {} => RegionWeights::Everywhere,
            Self::Ball { center, radius, falloff } => {
                line_weights(metric, std::slice::from_ref(center), *radius, *falloff, progress)?
            }
            Self::Stroke { path, radius, falloff } => {
                line_weights(metric, path, *radius, *falloff, progress)?
            }
            Self::Box { min, max, falloff } => {
                check_finite("a corner", min.iter().chain(max))?;
                weights_from_depth(metric, "box", *falloff, progress, |p| {
                    (0..3).map(|c| (p[c] - min[c]).min(max[c] - p[c])).fold(f64::INFINITY, f64::min)
                })?
            }
            Self::HalfSpace { point, normal, falloff } => {
                check_finite("the plane", point.iter().chain(normal))?;
                let Some(unit) = Vector3::from(*normal).try_normalize(0.0) else {
                    let (what, must) = ("the normal", "of some length");
                    return Err(RegionError::BadNumber { what, value: 0.0, must });
                };
                let origin = Vector3::from(*point);
                weights_from_depth(metric, "half-space", *falloff, progress, |p| {
                    unit.dot(&(Vector3::from(*p) - origin))
                })?
            }
            Self::Field { name, low, high } => {
                check_finite("a bound", [low, high])?;
                field_weights(metric.n_vertices(), name, *low, *high, field, field_names)?
            }
            Self::Vertices { indices, radius, falloff } => {
                let source = |&v: &u32| Ok(metric.vertex_source(welded(metric, v)?, 0.0));
                let sources = indices.iter().map(source).collect::<Result<Vec<_>, RegionError>>()?;
                let radius = radius.to_model_units(metric.diagonal());
                let fall = falloff.map(|falloff| falloff.to_model_units(metric.diagonal()).min(radius));
                let rise = |d: f64| match fall {
                    _ if d == 0.0 => 1.0,
                    None => smooth_rise(1.0 - d / radius),
                    Some(0.0) => 1.0,
                    Some(fall) => smooth_rise((radius - d) / fall),
                };
                sparse(metric.find_within(&sources, radius, progress)?, rise)
            }
            Self::Facing { direction, falloff } => {
                morph::facing_weights(metric, direction, *falloff, progress)?
            }
            Self::Component { vertex } => morph::component(metric, *vertex, progress)?,
            Self::Grown { by, region } => {
                morph::grow(metric, &region.weights(metric, field, field_names, progress)?, *by, progress)?
            }
            Self::Blurred { by, region } => morph::blur_weights(
                metric,
                &region.weights(metric, field, field_names, progress)?,
                *by,
                progress,
            )?,
            Self::Faded { factor, region } => {
                if !(0.0..=1.0).contains(factor) {
                    let must = "in [0, 1]";
                    return Err(RegionError::BadNumber { what: "the factor", value: *factor, must });
                }
                fade(region.weights(metric, field, field_names, progress)?, *factor, metric)
            }
            Self::Painted(strokes) => {
                paint(strokes, metric, progress, |r| r.weights(metric, field, field_names, progress))?
            }
            Self::Not(region) => invert(region.weights(metric, field, field_names, progress)?, metric),
            Self::Any(regions) => {
                combine(regions, metric, 0.0, f64::max, |r| r.weights(metric, field, field_names, progress))?
            }
            Self::All(regions) => {
                combine(regions, metric, 1.0, f64::min, |r| r.weights(metric, field, field_names, progress))?
            }
        })
    }
}

/// The complement 1 − r.
fn invert(weights: RegionWeights, metric: &SurfaceMetric) -> RegionWeights {
    let less = |mut weights: Vec<f64>| {
        for r in &mut weights {
            *r = 1.0 - *r;
        }
        weights
    };
    match weights {
        RegionWeights::Vertices(weights) => RegionWeights::Vertices(less(weights)),
        other => RegionWeights::Welded(less(other.to_welded(metric.n_places()))),
    }
}

fn fade(weights: RegionWeights, factor: f64, metric: &SurfaceMetric) -> RegionWeights {
    let times = |mut weights: Vec<f64>| {
        for weight in &mut weights {
            *weight *= factor;
        }
        weights
    };
    match weights {
        RegionWeights::Everywhere => RegionWeights::Welded(vec![factor; metric.n_places()]),
        RegionWeights::Sparse { vertices, weights } => {
            RegionWeights::Sparse { vertices, weights: times(weights) }
        }
        RegionWeights::Welded(weights) => RegionWeights::Welded(times(weights)),
        RegionWeights::Vertices(weights) => RegionWeights::Vertices(times(weights)),
    }
}

/// Applies stroke after stroke, each at the cost of what it covers.
fn paint(
    strokes: &[BrushStroke],
    metric: &SurfaceMetric,
    progress: Progress<'_>,
    weights_of: impl Fn(&Region) -> Result<RegionWeights, RegionError>,
) -> Result<RegionWeights, RegionError> {
    let (vertex_map, n_welded) = (metric.vertex_map(), metric.n_places());
    let mut welded = vec![0.0; n_welded];
    // One weight per vertex of the shape, from the first stroke that may differ within a welded vertex.
    let mut by_vertex: Option<Vec<f64>> = None;
    for stroke in strokes {
        let (region, join): (_, fn(f64, f64) -> f64) = match stroke {
            BrushStroke::Add(region) => (region, f64::max),
            BrushStroke::Subtract(region) => (region, |there, r| there.min(1.0 - r)),
            BrushStroke::Smooth { region, by } => {
                let there =
                    by_vertex.take().map_or_else(|| welded.clone(), |weights| vertex_map.mean(&weights, 1));
                let blurred = morph::blur(metric, &there, by.to_model_units(metric.diagonal()), progress)?;
                let part = weights_of(region)?.to_mean(vertex_map);
                for x in 0..n_welded {
                    welded[x] = there[x] + part[x] * (blurred[x] - there[x]);
                }
                continue;
            }
        };
        let part = weights_of(region)?;
        if let (RegionWeights::Sparse { vertices, weights }, None) = (&part, &by_vertex) {
            for (&x, &r) in vertices.iter().zip(weights) {
                welded[x as usize] = join(welded[x as usize], r);
            }
            continue;
        }
        if by_vertex.is_none() && matches!(part, RegionWeights::Vertices(_)) {
            by_vertex = Some(vertex_map.scatter(&welded, 1));
        }
        let (there, part) = match &mut by_vertex {
            Some(there) => (there, part.to_vertices(vertex_map)),
            None => (&mut welded, part.to_welded(n_welded)),
        };
        for (there, r) in there.iter_mut().zip(part) {
            *there = join(*there, r);
        }
    }
    Ok(by_vertex.map_or(RegionWeights::Welded(welded), RegionWeights::Vertices))
}

fn combine(
    regions: &[Region],
    metric: &SurfaceMetric,
    start: f64,
    join: impl Fn(f64, f64) -> f64,
    weights_of: impl Fn(&Region) -> Result<RegionWeights, RegionError>,
) -> Result<RegionWeights, RegionError> {
    let parts = regions.iter().map(weights_of).collect::<Result<Vec<_>, _>>()?;
    let by_vertex = parts.iter().any(|part| matches!(part, RegionWeights::Vertices(_)));
    let (vertex_map, n_welded) = (metric.vertex_map(), metric.n_places());
    let mut weights = vec![start; if by_vertex { metric.n_vertices() } else { n_welded }];
    for part in parts {
        let part = if by_vertex { part.to_vertices(vertex_map) } else { part.to_welded(n_welded) };
        for (r, other) in weights.iter_mut().zip(part) {
            *r = join(*r, other);
        }
    }
    Ok(if by_vertex { RegionWeights::Vertices(weights) } else { RegionWeights::Welded(weights) })
}

pub(super) fn welded(metric: &SurfaceMetric, vertex: u32) -> Result<usize, RegionError> {
    let n_vertices = metric.n_vertices();
    if vertex as usize >= n_vertices {
        return Err(RegionError::NoSuchVertex { vertex, n_vertices });
    }
    Ok(metric.vertex_map().welded(vertex as usize))
}

/// Weights by distance, 0 outside the given vertices.
fn sparse(within: VerticesWithin, rise: impl Fn(f64) -> f64) -> RegionWeights {
    let weights = within.distances.into_iter().map(rise).collect();
    RegionWeights::Sparse { vertices: within.vertices, weights }
}

/// Weights by distance along the surface from a line; with one location it is a ball.
fn line_weights(
    metric: &SurfaceMetric,
    path: &[Location],
    radius: Length,
    falloff: Option<Length>,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    let diagonal = metric.diagonal();
    let radius = radius.to_model_units(diagonal);
    if !(radius.is_finite() && radius > 0.0) {
        return Err(RegionError::BadNumber { what: "the radius", value: radius, must: "above 0" });
    }
    let falloff = falloff.map_or(0.5 * radius, |f| f.to_model_units(diagonal)).min(radius);
    if path.is_empty() {
        return Err(RegionError::EmptyStroke);
    }
    let points = metric.positions();
    let within = if points.is_empty() {
        let source = |place: &Location| match place {
            Location::Vertex(v) => Ok(metric.vertex_source(welded(metric, *v)?, 0.0)),
            Location::Point(_) => Err(RegionError::NeedsPositions("point")),
        };
        metric.find_within(&path.iter().map(source).collect::<Result<Vec<_>, _>>()?, radius, progress)?
    } else {
        let position = |place: &Location| match place {
            Location::Vertex(v) => Ok(points[welded(metric, *v)?]),
            Location::Point(p) => check_finite("a point", p).map(|()| *p),
        };
        metric.find_around_line(
            &path.iter().map(position).collect::<Result<Vec<_>, _>>()?,
            radius,
            progress,
        )?
    };
    let rise = |d: f64| {
        if falloff > 0.0 { smooth_rise((radius - d) / falloff) } else { f64::from(d <= radius) }
    };
    Ok(sparse(within, rise))
}

/// Weights by depth below the region's boundary.
fn weights_from_depth(
    metric: &SurfaceMetric,
    what: &'static str,
    falloff: Option<Length>,
    progress: Progress<'_>,
    depth: impl Fn(&[f64; 3]) -> f64 + Sync + Send,
) -> Result<RegionWeights, RegionError> {
    let points = metric.positions();
    if points.is_empty() {
        return Err(RegionError::NeedsPositions(what));
    }
    let falloff = falloff.unwrap_or(DEFAULT_FALLOFF).to_model_units(metric.diagonal());
    let rise = |x: usize| {
        let depth = depth(&points[x]);
        if falloff > 0.0 { smooth_rise(depth / falloff) } else { f64::from(depth >= 0.0) }
    };
    Ok(RegionWeights::Welded(parallel::try_collect(points.len(), progress, rise)?))
}

/// Weights by the values of a field: 0 at the first bound, 1 at the second, and 0 where the field is NaN.
fn field_weights(
    n: usize,
    name: &str,
    low: f64,
    high: f64,
    field: &FieldLookup<'_>,
    field_names: &[String],
) -> Result<RegionWeights, RegionError> {
    let name = name.to_owned();
    let Some((_, values)) = field(&name) else {
        return Err(RegionError::NoSuchField { name, available: field_names.to_vec() });
    };
    if values.len() != n {
        return Err(RegionError::NotScalar { name, n_values: values.len(), n_vertices: n });
    }
    let between = |v: f64| {
        let t = (v - low) / (high - low);
        if v.is_nan() {
            0.0
        } else if low == high {
            f64::from(v >= high)
        } else {
            t.clamp(0.0, 1.0)
        }
    };
    Ok(RegionWeights::Vertices(values.into_iter().map(between).collect()))
}

fn check_finite<'a>(
    what: &'static str,
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), RegionError> {
    match values.into_iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(RegionError::BadNumber { what, value, must: "finite" }),
        None => Ok(()),
    }
}
