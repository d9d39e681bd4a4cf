//! From a region to its weights on the vertices of a shape.

use super::stroke::stroke_sources;
use super::{Length, Place, Region, RegionError, smooth_rise, surface_distance};
use crate::Decomposer;
use crate::shape::vertex_normals;
use nalgebra::Vector3;

/// The width of the fall where none is given, for boxes and half-spaces.
const DEFAULT_FALLOFF: Length = Length::PercentOfDiagonal(5.0);

/// Scalar and other fields of a shape's vertices, by name: `(n_channels, values)`.
pub type FieldLookup<'a> = dyn Fn(&str) -> Option<(usize, Vec<f64>)> + 'a;

impl Region {
    /// The weight r(x) in [0, 1] of every vertex, in the order of the shape.
    ///
    /// `field` gives the vertex fields of the shape by name, `field_names` is what an error lists.
    ///
    /// # Errors
    /// [`RegionError`] when the region names a vertex or field that does not exist, or numbers that make no sense.
    pub fn weights(
        &self,
        decomposer: &Decomposer,
        field: &FieldLookup<'_>,
        field_names: &[String],
    ) -> Result<Vec<f64>, RegionError> {
        let n = decomposer.n_vertices();
        Ok(match self {
            Self::Everywhere {} => vec![1.0; n],
            Self::Ball { centre, radius, falloff } => {
                line_weights(decomposer, std::slice::from_ref(centre), *radius, *falloff)?
            }
            Self::Stroke { path, radius, falloff } => line_weights(decomposer, path, *radius, *falloff)?,
            Self::Box { min, max, falloff } => {
                check_finite("a corner", min.iter().chain(max))?;
                by_depth(decomposer, "box", *falloff, |p| {
                    (0..3).map(|c| (p[c] - min[c]).min(max[c] - p[c])).fold(f64::INFINITY, f64::min)
                })?
            }
            Self::HalfSpace { point, normal, falloff } => {
                check_finite("the plane", point.iter().chain(normal))?;
                let Some(unit) = Vector3::from(*normal).try_normalize(0.0) else {
                    return Err(RegionError::BadNumber {
                        what: "the normal",
                        value: 0.0,
                        must: "of some length",
                    });
                };
                let origin = Vector3::from(*point);
                by_depth(decomposer, "half-space", *falloff, |p| unit.dot(&(Vector3::from(*p) - origin)))?
            }
            Self::Field { name, low, high } => {
                check_finite("a bound", [low, high])?;
                let available = || field_names.to_vec();
                let (_, values) = field(name)
                    .ok_or_else(|| RegionError::NoSuchField { name: name.clone(), available: available() })?;
                if values.len() != n {
                    return Err(RegionError::NotScalar {
                        name: name.clone(),
                        n_values: values.len(),
                        n_vertices: n,
                    });
                }
                if let Some(vertex) = values.iter().position(|v| v.is_nan()) {
                    return Err(RegionError::NotANumber { name: name.clone(), vertex });
                }
                let between = |v: f64| {
                    let t = (v - low) / (high - low);
                    if low == high { f64::from(v >= *high) } else { t.clamp(0.0, 1.0) }
                };
                values.into_iter().map(between).collect()
            }
            Self::Vertices { indices, radius } => {
                let sources = indices
                    .iter()
                    .map(|&v| Ok((welded(decomposer, v)?, 0.0)))
                    .collect::<Result<Vec<_>, _>>()?;
                let radius = radius.in_units(decomposer.diagonal());
                let away = surface_distance(
                    decomposer.neighbours(),
                    decomposer.geometry().points(),
                    &sources,
                    radius,
                );
                let rise = |d: f64| if d == 0.0 { 1.0 } else { smooth_rise(1.0 - d / radius) };
                decomposer.geometry().vertex_map().scatter(&away.into_iter().map(rise).collect::<Vec<_>>(), 1)
            }
            Self::Not(region) => {
                let mut weights = region.weights(decomposer, field, field_names)?;
                for r in &mut weights {
                    *r = 1.0 - *r;
                }
                weights
            }
            Self::Any(regions) => combine(regions, decomposer, field, field_names, 0.0, f64::max)?,
            Self::All(regions) => combine(regions, decomposer, field, field_names, 1.0, f64::min)?,
        })
    }
}

fn combine(
    regions: &[Region],
    decomposer: &Decomposer,
    field: &FieldLookup<'_>,
    field_names: &[String],
    start: f64,
    join: impl Fn(f64, f64) -> f64,
) -> Result<Vec<f64>, RegionError> {
    let mut weights = vec![start; decomposer.n_vertices()];
    for region in regions {
        for (r, other) in weights.iter_mut().zip(region.weights(decomposer, field, field_names)?) {
            *r = join(*r, other);
        }
    }
    Ok(weights)
}

fn welded(decomposer: &Decomposer, vertex: u32) -> Result<usize, RegionError> {
    let n_vertices = decomposer.n_vertices();
    if vertex as usize >= n_vertices {
        return Err(RegionError::NoSuchVertex { vertex, n_vertices });
    }
    Ok(decomposer.geometry().vertex_map().welded(vertex as usize))
}

/// Weights by distance along the surface from a line, which is a ball where it has one place.
fn line_weights(
    decomposer: &Decomposer,
    path: &[Place],
    radius: Length,
    falloff: Option<Length>,
) -> Result<Vec<f64>, RegionError> {
    let diagonal = decomposer.diagonal();
    let radius = radius.in_units(diagonal);
    if !(radius.is_finite() && radius > 0.0) {
        return Err(RegionError::BadNumber { what: "the radius", value: radius, must: "above 0" });
    }
    let falloff = falloff.map_or(0.5 * radius, |f| f.in_units(diagonal)).min(radius);
    if path.is_empty() {
        return Err(RegionError::EmptyStroke);
    }
    let geometry = decomposer.geometry();
    let sources = if geometry.points().is_empty() {
        path.iter()
            .map(|place| match place {
                Place::Vertex(v) => Ok((welded(decomposer, *v)?, 0.0)),
                Place::Point(_) => Err(RegionError::NeedsPositions("point")),
            })
            .collect::<Result<Vec<_>, _>>()?
    } else {
        let places = path
            .iter()
            .map(|place| match place {
                Place::Vertex(v) => Ok(geometry.points()[welded(decomposer, *v)?]),
                Place::Point(p) => check_finite("a point", p).map(|()| *p),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let normals = vertex_normals(geometry.points(), geometry.triangles());
        stroke_sources(
            geometry.points(),
            &normals,
            decomposer.neighbours(),
            decomposer.mean_length(),
            &places,
        )
    };
    let away = surface_distance(decomposer.neighbours(), geometry.points(), &sources, radius);
    let rise = |d: f64| {
        if falloff > 0.0 { smooth_rise((radius - d) / falloff) } else { f64::from(d <= radius) }
    };
    Ok(geometry.vertex_map().scatter(&away.into_iter().map(rise).collect::<Vec<_>>(), 1))
}

/// Weights by depth below the region's boundary.
fn by_depth(
    decomposer: &Decomposer,
    what: &'static str,
    falloff: Option<Length>,
    depth: impl Fn(&[f64; 3]) -> f64,
) -> Result<Vec<f64>, RegionError> {
    let geometry = decomposer.geometry();
    if geometry.points().is_empty() {
        return Err(RegionError::NeedsPositions(what));
    }
    let falloff = falloff.unwrap_or(DEFAULT_FALLOFF).in_units(decomposer.diagonal());
    let rise = |p: &[f64; 3]| {
        let depth = depth(p);
        if falloff > 0.0 { smooth_rise(depth / falloff) } else { f64::from(depth >= 0.0) }
    };
    Ok(geometry.vertex_map().scatter(&geometry.points().iter().map(rise).collect::<Vec<_>>(), 1))
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
