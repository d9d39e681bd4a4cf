//! Soft regions: a weight r(x) in [0, 1] for every vertex, for local edits.
//!
//! Every region is 0 outside and rises to 1 at the depth `falloff` inside, along the quintic 6t⁵ − 15t⁴ + 10t³. Its
//! first and second derivatives vanish at both ends, so an edit has no seam at the boundary of a region.

mod distance;
mod far;
mod front;
mod metric;
mod morph;
mod parse;
mod place;
mod stroke;
mod weights;

pub use distance::{SurfaceSearch, surface_distance};
pub use far::FarPoint;
pub(crate) use front::{FrontSource, SourceExtent};
pub(crate) use metric::MetricEdges;
pub use metric::SurfaceMetric;
pub use parse::{RegionSyntaxError, parse_region};
pub use weights::{FieldLookup, RegionWeights};

use crate::{Cancelled, ClassifiedError, ErrorKind};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A length, in model units or relative to the diagonal of the bounding box.
///
/// Written as a number (`0.25`) or as a percentage of the diagonal (`"5%"`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LengthText", into = "LengthText")]
pub enum Length {
    /// Length in model units (hops on a graph).
    Units(f64),
    /// Length in percent of the diagonal of the bounding box.
    PercentOfDiagonal(f64),
    /// Arc of a great circle in degrees, on a sphere about the origin.
    Degrees(f64),
}

impl Length {
    /// The length in model units, for a bounding box with that `diagonal`; an arc for the box of a whole sphere, whose
    /// diagonal is √12 radii. [`Decomposer::model_units`](crate::Decomposer::model_units) measures the radius.
    pub fn to_model_units(self, diagonal: f64) -> f64 {
        match self {
            Self::Units(length) => length,
            Self::PercentOfDiagonal(percent) => percent / 100.0 * diagonal,
            Self::Degrees(angle) => angle.to_radians() * diagonal / 12_f64.sqrt(),
        }
    }

    /// Reads the width of a level: a length as in [`FromStr`](std::str::FromStr), an arc such as `5deg`, or an arc of a
    /// sphere of a stated radius, such as `100km/6371` for 100 km on the earth.
    ///
    /// ```
    /// use adwave::region::Length;
    /// assert_eq!(Length::parse_width("5deg"), Ok(Length::Degrees(5.0)));
    /// assert_eq!(Length::parse_width("2%"), Ok(Length::PercentOfDiagonal(2.0)));
    /// let Length::Degrees(angle) = Length::parse_width("100km/6371")? else { panic!("an arc") };
    /// assert!((angle.to_radians() - 100.0 / 6371.0).abs() < 1e-15);
    /// assert!(Length::parse_width("5km").is_err()); // of which sphere?
    /// # Ok::<(), adwave::region::RegionSyntaxError>(())
    /// ```
    ///
    /// # Errors
    /// [`RegionSyntaxError::NotALength`] for other text.
    pub fn parse_width(text: &str) -> Result<Self, RegionSyntaxError> {
        if let Some((arc, radius)) = text.split_once("km/") {
            let radius = radius.trim().trim_end_matches("km");
            return match (arc.parse()?, radius.parse()?) {
                (Self::Units(arc), Self::Units(radius)) if radius > 0.0 => {
                    Ok(Self::Degrees((arc / radius).to_degrees()))
                }
                _ => Err(RegionSyntaxError::NotALength(text.trim().to_owned())),
            };
        }
        match text.trim().strip_suffix("deg").or_else(|| text.trim().strip_suffix('°')) {
            Some(angle) if !angle.trim_end().ends_with('%') => match angle.parse()? {
                Self::Units(angle) => Ok(Self::Degrees(angle)),
                other => Ok(other),
            },
            _ => text.parse(),
        }
    }
}

impl std::str::FromStr for Length {
    type Err = RegionSyntaxError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (number, wrap): (_, fn(f64) -> Self) = match text.trim().strip_suffix('%') {
            Some(number) => (number, Self::PercentOfDiagonal),
            None => (text, Self::Units),
        };
        match number.trim().parse::<f64>() {
            Ok(value) if value.is_finite() && value >= 0.0 => Ok(wrap(value)),
            _ => Err(RegionSyntaxError::NotALength(text.trim().to_owned())),
        }
    }
}

/// Text form of a [`Length`] in a recipe.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum LengthText {
    Number(f64),
    Text(String),
}

impl TryFrom<LengthText> for Length {
    type Error = RegionSyntaxError;

    fn try_from(text: LengthText) -> Result<Self, RegionSyntaxError> {
        match text {
            LengthText::Number(value) if value.is_finite() && value >= 0.0 => Ok(Self::Units(value)),
            LengthText::Number(value) => Err(RegionSyntaxError::NotALength(value.to_string())),
            LengthText::Text(text) => text.parse(),
        }
    }
}

impl From<Length> for LengthText {
    fn from(length: Length) -> Self {
        match length {
            Length::Units(value) => Self::Number(value),
            Length::PercentOfDiagonal(percent) => Self::Text(format!("{percent}%")),
            Length::Degrees(angle) => Self::Text(format!("{angle}deg")),
        }
    }
}

/// A location on a shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Location {
    /// The vertex with this index, from 0.
    Vertex(u32),
    /// The location on the shape nearest to this point, in model units.
    Point([f64; 3]),
}

/// A soft region of a shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[non_exhaustive]
pub enum Region {
    /// The whole shape.
    Everywhere {},
    /// All vertices within `radius` of a location, measured along the surface.
    Ball {
        /// The center.
        center: Location,
        /// Distance at which the weight has fallen to 0.
        radius: Length,
        /// Width of the falloff inside the radius; half the radius by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// All vertices within `radius` of a line over the surface through the given locations, measured along the
    /// surface.
    Stroke {
        /// Locations that the line passes through.
        path: Vec<Location>,
        /// Distance at which the weight has fallen to 0.
        radius: Length,
        /// Width of the falloff inside the radius; half the radius by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// All vertices inside an axis-aligned box.
    Box {
        /// Smallest coordinates.
        min: [f64; 3],
        /// Largest coordinates.
        max: [f64; 3],
        /// Width of the falloff inside the box; 5 % of the shape's diagonal by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// All vertices on the side of a plane to which its normal points.
    HalfSpace {
        /// A point of the plane.
        point: [f64; 3],
        /// Direction into the region, of any length except 0.
        normal: [f64; 3],
        /// Width of the falloff inside the region; 5 % of the shape's diagonal by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// A scalar vertex field: weight 0 at `low` or less, 1 at `high` or more, linear between.
    Field {
        /// Name of the field.
        name: String,
        /// Value with weight 0; 0 by default.
        #[serde(default)]
        low: f64,
        /// Value with weight 1; 1 by default. May be smaller than `low`.
        #[serde(default = "one")]
        high: f64,
    },
    /// The given vertices, and all vertices within `radius` of one of them along the surface.
    Vertices {
        /// Indices of the vertices, from 0.
        indices: Vec<u32>,
        /// Distance by which the region extends beyond them, falling to 0 there; 0 by default.
        #[serde(default = "no_length")]
        radius: Length,
        /// Width of the falloff inside the radius; the radius by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// Vertices that face a direction: S(n·d / (|d|·falloff)) with the vertex normal n and the rise S of all
    /// regions; without a falloff, 1 where n·d > 0. For meshes.
    Facing {
        /// Direction d, of any length except 0.
        direction: [f64; 3],
        /// Cosine between normal and direction from which the weight is 1; 0 by default.
        #[serde(default)]
        falloff: f64,
    },
    /// The connected component of a vertex.
    Component {
        /// The vertex, from 0.
        vertex: u32,
    },
    /// Another region, enlarged: S(max_y 2 t(y) − d(x, y)/by) with r = S(t) and the distance d along the surface.
    /// It is 1 up to the distance `by` from where r is 1, and falls to 0 over a further `by`.
    /// [`shrink`](Region::shrink) is the opposite.
    Grown {
        /// Distance, above 0.
        by: Length,
        /// The region to enlarge.
        region: Box<Region>,
    },
    /// Another region, blurred along the surface: the mean of r at the end of a lazy random walk over the edges
    /// with k = 4 (by/h)² steps (rounded up, h the root mean square edge length), which spreads by `by` in each
    /// direction. Constants do not change.
    Blurred {
        /// Standard deviation of the walk in each direction of the surface; at most 2000 h.
        by: Length,
        /// The region to blur.
        region: Box<Region>,
    },
    /// Another region, attenuated: factor·r.
    Faded {
        /// Factor in [0, 1].
        factor: f64,
        /// The region to attenuate.
        region: Box<Region>,
    },
    /// Brush strokes, applied in order, starting from 0 everywhere.
    Painted(Vec<BrushStroke>),
    /// The complement of another region: 1 − r.
    Not(Box<Region>),
    /// The union of regions: the largest r.
    Any(Vec<Region>),
    /// The intersection of regions: the smallest r.
    All(Vec<Region>),
}

/// One stroke of a brush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[non_exhaustive]
pub enum BrushStroke {
    /// The larger of the present weight and r.
    Add(Region),
    /// The smaller of the present weight and 1 − r.
    Subtract(Region),
    /// The present weights m, blurred by the fraction r: m + r·(m blurred − m).
    Smooth {
        /// Location and amount of the blur.
        region: Region,
        /// Length of the blur, as in [`Region::Blurred`].
        by: Length,
    },
}

impl Region {
    /// All lengths that the region names, those of its parts too.
    ///
    /// ```
    /// use adwave::region::{Length, parse_region};
    /// let region = parse_region("ball:vertex=0,radius=2,falloff=5%").unwrap();
    /// assert_eq!(region.lengths(), [Length::Units(2.0), Length::PercentOfDiagonal(5.0)]);
    /// ```
    pub fn lengths(&self) -> Vec<Length> {
        let with_falloff =
            |first: Option<Length>, falloff: Option<Length>| first.into_iter().chain(falloff).collect();
        let with_parts = |by: Option<Length>, region: &Self| by.into_iter().chain(region.lengths()).collect();
        match self {
            Self::Ball { radius, falloff, .. }
            | Self::Stroke { radius, falloff, .. }
            | Self::Vertices { radius, falloff, .. } => with_falloff(Some(*radius), *falloff),
            Self::Box { falloff, .. } | Self::HalfSpace { falloff, .. } => with_falloff(None, *falloff),
            Self::Grown { by, region } | Self::Blurred { by, region } => with_parts(Some(*by), region),
            Self::Faded { region, .. } | Self::Not(region) => region.lengths(),
            Self::Painted(strokes) => strokes
                .iter()
                .flat_map(|stroke| match stroke {
                    BrushStroke::Add(region) | BrushStroke::Subtract(region) => region.lengths(),
                    BrushStroke::Smooth { region, by } => with_parts(Some(*by), region),
                })
                .collect(),
            Self::Any(regions) | Self::All(regions) => regions.iter().flat_map(Self::lengths).collect(),
            Self::Everywhere {} | Self::Field { .. } | Self::Facing { .. } | Self::Component { .. } => {
                Vec::new()
            }
        }
    }

    /// Names of the fields that the region asks for, in its order.
    ///
    /// ```
    /// # use adwave::region::parse_region;
    /// assert_eq!(parse_region("field:name=height,low=0,high=5").unwrap().fields(), ["height"]);
    /// ```
    pub fn fields(&self) -> Vec<&str> {
        match self {
            Self::Field { name, .. } => vec![name],
            Self::Grown { region, .. }
            | Self::Blurred { region, .. }
            | Self::Faded { region, .. }
            | Self::Not(region) => region.fields(),
            Self::Painted(strokes) => strokes
                .iter()
                .flat_map(|stroke| match stroke {
                    BrushStroke::Add(region)
                    | BrushStroke::Subtract(region)
                    | BrushStroke::Smooth { region, .. } => region.fields(),
                })
                .collect(),
            Self::Any(regions) | Self::All(regions) => regions.iter().flat_map(Self::fields).collect(),
            _ => Vec::new(),
        }
    }

    /// Replaces the numbers of all vertices that the region names, such as rows of a file by vertices of a shape.
    ///
    /// # Errors
    /// The first error of `map`; the region is changed up to there.
    pub fn try_map_vertices<E>(&mut self, map: &mut dyn FnMut(u32) -> Result<u32, E>) -> Result<(), E> {
        let mut replace = |location: &mut Location| {
            if let Location::Vertex(vertex) = location {
                *vertex = map(*vertex)?;
            }
            Ok(())
        };
        match self {
            Self::Ball { center, .. } => replace(center),
            Self::Stroke { path, .. } => path.iter_mut().try_for_each(replace),
            Self::Vertices { indices, .. } => indices.iter_mut().try_for_each(|vertex| {
                *vertex = map(*vertex)?;
                Ok(())
            }),
            Self::Component { vertex } => {
                *vertex = map(*vertex)?;
                Ok(())
            }
            Self::Grown { region, .. }
            | Self::Blurred { region, .. }
            | Self::Faded { region, .. }
            | Self::Not(region) => region.try_map_vertices(map),
            Self::Painted(strokes) => strokes.iter_mut().try_for_each(|stroke| match stroke {
                BrushStroke::Add(region)
                | BrushStroke::Subtract(region)
                | BrushStroke::Smooth { region, .. } => region.try_map_vertices(map),
            }),
            Self::Any(regions) | Self::All(regions) => {
                regions.iter_mut().try_for_each(|region| region.try_map_vertices(map))
            }
            Self::Everywhere {}
            | Self::Box { .. }
            | Self::HalfSpace { .. }
            | Self::Field { .. }
            | Self::Facing { .. } => Ok(()),
        }
    }
}

fn one() -> f64 {
    1.0
}

fn no_length() -> Length {
    Length::Units(0.0)
}

/// Error of applying a region to a shape.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RegionError {
    /// The region names a vertex that does not exist.
    #[error("the region names vertex {vertex}, but the shape has {n_vertices} vertices, counted from 0")]
    NoSuchVertex {
        /// Index of the vertex.
        vertex: u32,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The region names a field that does not exist.
    #[error("the region names the field '{name}', but {}", available_fields(.name, .available))]
    NoSuchField {
        /// Name of the field.
        name: String,
        /// Names of the existing fields.
        available: Vec<String>,
    },
    /// The field does not have one value per vertex.
    #[error(
        "the field '{name}' has {n_values} values for {n_vertices} vertices; a region needs one per vertex"
    )]
    NotScalar {
        /// Name of the field.
        name: String,
        /// Number of its values.
        n_values: usize,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// The number of weights does not match the shape.
    #[error("there are {n_values} weights, and {expected} are needed: one per vertex")]
    WrongLength {
        /// Number of weights given.
        n_values: usize,
        /// Number of weights required.
        expected: usize,
    },
    /// A number is not finite, or a size is not positive.
    #[error("{what} of the region is {value}; it must be {must}")]
    BadNumber {
        /// Name of the number.
        what: &'static str,
        /// Value of the number.
        value: f64,
        /// Requirement on the number.
        must: &'static str,
    },
    /// The region is given by positions, but the shape has none.
    #[error("a {0} region needs positions, which a graph does not have; use vertices or a field")]
    NeedsPositions(&'static str),
    /// The region is given by normals, but the shape has none.
    #[error("a {0} region needs faces, which a cloud or a graph does not have; use a half-space")]
    NeedsFaces(&'static str),
    /// The stroke has no locations.
    #[error("a stroke needs at least one place")]
    EmptyStroke,
    /// The call was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for RegionError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}

/// Names of the available fields, for the error about the missing field `name`.
fn available_fields(name: &str, fields: &[String]) -> String {
    let (list, computed) =
        (fields.join(", "), "saliency, band-1 to band-16, curvatures and other signals of the shape");
    match (name.starts_with("band-"), fields.is_empty()) {
        (true, _) => {
            "a band must be band-1, band-2 and so on, up to the number of levels that a schedule can have"
                .to_owned()
        }
        (false, true) => format!("the shape has no fields of its own; there are {computed}"),
        (false, false) => format!("the shape has only {list}; there are {computed} too"),
    }
}

/// The quintic 6t⁵ − 15t⁴ + 10t³, from 0 at t ≤ 0 to 1 at t ≥ 1.
pub(crate) fn smooth_rise(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}

#[cfg(test)]
mod tests;
