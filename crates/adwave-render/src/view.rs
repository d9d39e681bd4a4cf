//! Where the viewer stands.

use adwave::vector::{Vector, add_scaled, cross};
use std::str::FromStr;
use thiserror::Error;

/// The direction from which a shape is seen, relative to its up axis.
///
/// ```
/// use adwave_render::View;
/// let view: View = "-30,20".parse().unwrap();
/// assert_eq!(view, View { azimuth: -30.0, elevation: 20.0 });
/// assert_eq!("left".parse::<View>().unwrap().azimuth, -90.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// How far the viewer has walked round the shape, counterclockwise as seen from above, degrees; 0 is the front.
    pub azimuth: f64,
    /// How far the viewer is above the horizon, degrees from −90 to 90.
    pub elevation: f64,
}

/// The views that have names: name, azimuth, elevation.
const NAMED: [(&str, f64, f64); 7] = [
    ("front", 0.0, 0.0),
    ("back", 180.0, 0.0),
    ("left", -90.0, 0.0),
    ("right", 90.0, 0.0),
    ("top", 0.0, 90.0),
    ("bottom", 0.0, -90.0),
    ("three-quarter", 30.0, 15.0),
];

impl View {
    /// From the right of the front and a little above: what shows most of most shapes.
    pub const THREE_QUARTER: Self = Self { azimuth: 30.0, elevation: 15.0 };

    /// Straight from the front.
    pub const FRONT: Self = Self { azimuth: 0.0, elevation: 0.0 };

    /// The names that parse.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMED.iter().map(|n| n.0)
    }

    /// The direction that points to the right in the picture, of length 1.
    pub fn right(self, up: Up) -> Vector {
        self.axes(up)[0]
    }

    /// The picture's right, its up, and the direction toward the viewer: orthonormal, right-handed.
    pub(crate) fn axes(self, up: Up) -> [Vector; 3] {
        let [right, up, front] = up.axes();
        let (azimuth, elevation) = (self.azimuth.to_radians(), self.elevation.to_radians());
        let level = add_scaled(&front.map(|c| c * azimuth.cos()), azimuth.sin(), &right);
        let toward = add_scaled(&level.map(|c| c * elevation.cos()), elevation.sin(), &up);
        let right = add_scaled(&right.map(|c| c * azimuth.cos()), -azimuth.sin(), &front);
        [right, cross(&toward, &right), toward]
    }

    pub(crate) fn check(self) -> Result<(), ViewError> {
        let Self { azimuth, elevation } = self;
        if azimuth.is_finite() && (-90.0..=90.0).contains(&elevation) {
            Ok(())
        } else {
            Err(ViewError::OutOfRange { azimuth, elevation })
        }
    }
}

impl FromStr for View {
    type Err = ViewError;

    fn from_str(text: &str) -> Result<Self, ViewError> {
        let text = text.trim();
        if let Some(&(_, azimuth, elevation)) = NAMED.iter().find(|n| n.0.eq_ignore_ascii_case(text)) {
            return Ok(Self { azimuth, elevation });
        }
        let unknown = || ViewError::Unknown { text: text.to_owned() };
        let (azimuth, elevation) = text.split_once(',').ok_or_else(unknown)?;
        let number = |part: &str| part.trim().parse::<f64>().map_err(|_| unknown());
        let view = Self { azimuth: number(azimuth)?, elevation: number(elevation)? };
        view.check()?;
        Ok(view)
    }
}

/// A view that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ViewError {
    /// Neither a name nor two numbers.
    #[error(
        "'{text}' is no view; it is front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in \
         degrees such as 30,15"
    )]
    Unknown {
        /// What was given.
        text: String,
    },
    /// Angles that are none.
    #[error(
        "a view of azimuth {azimuth} and elevation {elevation}: the elevation is from -90 to 90 degrees, both finite"
    )]
    OutOfRange {
        /// Degrees.
        azimuth: f64,
        /// Degrees.
        elevation: f64,
    },
}

/// Which axis of the model points up in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// x up; the front is seen from −z.
    X,
    /// y up, as most models have it; the front is seen from +z.
    #[default]
    Y,
    /// z up, as maps and scans of the ground have it; the front is seen from −y.
    Z,
}

impl Up {
    /// Right, up and the direction toward the viewer of the front view.
    fn axes(self) -> [Vector; 3] {
        match self {
            Self::X => [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
            Self::Y => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Self::Z => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        }
    }
}

impl FromStr for Up {
    type Err = UpError;

    fn from_str(text: &str) -> Result<Self, UpError> {
        match text {
            "x" | "X" => Ok(Self::X),
            "y" | "Y" => Ok(Self::Y),
            "z" | "Z" => Ok(Self::Z),
            _ => Err(UpError { text: text.to_owned() }),
        }
    }
}

/// An axis that is none.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("'{text}' is no axis; it is x, y or z")]
pub struct UpError {
    /// What was given.
    pub text: String,
}
