//! Soft regions: a weight r(x) in [0, 1] for every vertex, to edit here and not there.
//!
//! Every region is 0 outside and rises to 1 at the depth `falloff` inside, along the quintic 6t⁵ − 15t⁴ + 10t³, whose
//! first and second derivatives vanish at both ends: an edit has no seam at a region's edge.

mod distance;
mod metric;
mod morph;
mod parse;
mod stroke;
mod weights;

pub use distance::{SurfaceSearch, surface_distance};
pub use metric::{Edges, SurfaceMetric};
pub use parse::{RegionSyntaxError, parse_region};
pub use weights::{FieldLookup, RegionWeights};

use crate::{Cancelled, ClassifiedError, ErrorKind};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A length, in model units or as a part of the bounding box's diagonal.
///
/// Written as a number (`0.25`) or as a percentage of the diagonal (`"5%"`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LengthText", into = "LengthText")]
pub enum Length {
    /// So many model units (hops on a graph).
    Units(f64),
    /// So many percent of the bounding box's diagonal.
    PercentOfDiagonal(f64),
}

impl Length {
    /// The length in model units.
    pub fn in_units(self, diagonal: f64) -> f64 {
        match self {
            Self::Units(length) => length,
            Self::PercentOfDiagonal(percent) => percent / 100.0 * diagonal,
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

/// How a [`Length`] is written in a recipe.
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
        }
    }
}

/// A place on a shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// The vertex of this index, from 0.
    Vertex(u32),
    /// The place of the shape nearest to this point, in model units.
    Point([f64; 3]),
}

/// A soft region of a shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Region {
    /// Everything.
    Everywhere {},
    /// All within `radius` of a place, measured along the surface.
    Ball {
        /// The center.
        center: Place,
        /// Where the weight has fallen to 0.
        radius: Length,
        /// Width of the fall inside the radius; half the radius by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// All within `radius` of a line drawn over the surface from place to place, measured along the surface.
    Stroke {
        /// Where the line runs.
        path: Vec<Place>,
        /// Where the weight has fallen to 0.
        radius: Length,
        /// Width of the fall inside the radius; half the radius by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// All inside an axis-aligned box.
    Box {
        /// Smallest coordinates.
        min: [f64; 3],
        /// Largest coordinates.
        max: [f64; 3],
        /// Width of the fall inside the box; 5 % of the shape's diagonal by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// All on the side of a plane that its normal points to.
    HalfSpace {
        /// A point of the plane.
        point: [f64; 3],
        /// The direction into the region, of any length but 0.
        normal: [f64; 3],
        /// Width of the fall inside the region; 5 % of the shape's diagonal by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// A scalar field of the vertices: 0 where it is `low` or less, 1 where it is `high` or more, linear between.
    Field {
        /// Name of the field.
        name: String,
        /// Where the weight is 0; 0 by default.
        #[serde(default)]
        low: f64,
        /// Where the weight is 1; 1 by default. May be smaller than `low`.
        #[serde(default = "one")]
        high: f64,
    },
    /// Some vertices, with all that is within `radius` of one of them along the surface.
    Vertices {
        /// Their indices, from 0.
        indices: Vec<u32>,
        /// How far the region extends beyond them, falling to 0 there; 0 by default.
        #[serde(default = "no_length")]
        radius: Length,
        /// Width of the fall inside the radius; the radius by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        falloff: Option<Length>,
    },
    /// What faces a direction: S(n·d / (|d|·falloff)) with the normal n of a vertex and the rise S of all regions, 1 where
    /// n·d > 0 without a falloff. For meshes.
    Facing {
        /// The direction d, of any length but 0.
        direction: [f64; 3],
        /// The cosine between normal and direction from which on the weight is 1; 0 by default.
        #[serde(default)]
        falloff: f64,
    },
    /// The connected part that holds a vertex.
    Component {
        /// The vertex, from 0.
        vertex: u32,
    },
    /// Another region, larger: S(max_y 2 t(y) − d(x, y)/by) with r = S(t) and the distance d along the surface, which is 1 up to
    /// `by` from where r is 1 and falls to 0 over `by` more. [`shrunk`](Region::shrunk) is the opposite.
    Grown {
        /// By how much, above 0.
        by: Length,
        /// The region.
        region: Box<Region>,
    },
    /// Another region, blurred along the surface: the mean of r where a lazy random walk over the edges ends after
    /// k = 4 (by/h)² steps (rounded up, h the root mean square length of an edge), which spreads by `by` in each direction. Constants are kept.
    Blurred {
        /// The standard deviation of the walk in each direction of the surface; at most 2000 h.
        by: Length,
        /// The region.
        region: Box<Region>,
    },
    /// Another region, fainter: factor·r.
    Faded {
        /// The factor, in [0, 1].
        factor: f64,
        /// The region.
        region: Box<Region>,
    },
    /// Strokes of a brush, one after the other, from 0 everywhere.
    Painted(Vec<BrushStroke>),
    /// Where another region is not: 1 − r.
    Not(Box<Region>),
    /// Where any of these is: the largest r.
    Any(Vec<Region>),
    /// Where all of these are: the smallest r.
    All(Vec<Region>),
}

/// One stroke of a brush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum BrushStroke {
    /// The larger of what is there and r.
    Add(Region),
    /// The smaller of what is there and 1 − r.
    Subtract(Region),
    /// What is there, blurred to the part r: m + r·(m blurred − m).
    Smooth {
        /// Where, and how much.
        region: Region,
        /// The length of the blur, as of [`Region::Blurred`].
        by: Length,
    },
}

fn one() -> f64 {
    1.0
}

fn no_length() -> Length {
    Length::Units(0.0)
}

/// Why a region does not fit a shape.
#[derive(Debug, Error, PartialEq)]
pub enum RegionError {
    /// A vertex that does not exist.
    #[error("the region names vertex {vertex}, but the shape has {n_vertices} vertices, counted from 0")]
    NoSuchVertex {
        /// The vertex.
        vertex: u32,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A field that does not exist.
    #[error("the region names the field '{name}', but the shape has {}", list(.available))]
    NoSuchField {
        /// The name.
        name: String,
        /// Fields that exist.
        available: Vec<String>,
    },
    /// A field that has several values per vertex, or not one for each.
    #[error(
        "the field '{name}' has {n_values} values for {n_vertices} vertices; a region needs one per vertex"
    )]
    NotScalar {
        /// The name.
        name: String,
        /// Values it has.
        n_values: usize,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// Weights that do not belong to this shape.
    #[error("there are {n_values} weights, and {expected} are needed: one per vertex")]
    WrongLength {
        /// Weights given.
        n_values: usize,
        /// Weights needed.
        expected: usize,
    },
    /// A field with a value that is no number.
    #[error("the field '{name}' is NaN at vertex {vertex}")]
    NotANumber {
        /// The name.
        name: String,
        /// The vertex, from 0.
        vertex: usize,
    },
    /// A number that is not finite, or a size that must be above 0 and is not.
    #[error("{what} of the region is {value}; it must be {must}")]
    BadNumber {
        /// What the number is.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A region by position on a shape that has no positions.
    #[error("a {0} region needs positions, which a graph does not have; use vertices or a field")]
    NeedsPositions(&'static str),
    /// A region by normals on a shape that has none.
    #[error("a {0} region needs faces, which a cloud or a graph does not have; use a half-space")]
    NeedsFaces(&'static str),
    /// A stroke without places.
    #[error("a stroke needs at least one place")]
    EmptyStroke,
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl ClassifiedError for RegionError {
    fn kind(&self) -> ErrorKind {
        if matches!(self, Self::Cancelled(_)) { ErrorKind::Cancelled } else { ErrorKind::Input }
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "no fields".to_owned() } else { format!("only {}", names.join(", ")) }
}

/// 6t⁵ − 15t⁴ + 10t³, from 0 at t ≤ 0 to 1 at t ≥ 1.
pub(crate) fn smooth_rise(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}
