//! Direction from which a shape is seen.

use adwave::vector::{Vector, add_scaled, cross};
use std::str::FromStr;
use thiserror::Error;

/// Direction from which a shape is seen, relative to its up axis.
///
/// ```
/// use adwave_render::View;
/// let view: View = "-30,20".parse().unwrap();
/// assert_eq!(view, View { azimuth: -30.0, elevation: 20.0 });
/// assert_eq!("left".parse::<View>().unwrap().azimuth, -90.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Azimuth of the viewer around the shape, counterclockwise as seen from above, in degrees; 0 is the front.
    pub azimuth: f64,
    /// Elevation of the viewer above the horizon, in degrees from −90 to 90.
    pub elevation: f64,
}

/// Named views: name, azimuth, elevation.
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
    /// View from the right of the front and slightly above, which shows most of most shapes.
    pub const THREE_QUARTER: Self = Self { azimuth: 30.0, elevation: 15.0 };

    /// View from the front.
    pub const FRONT: Self = Self { azimuth: 0.0, elevation: 0.0 };

    /// Names that can be parsed.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMED.iter().map(|n| n.0)
    }

    /// Unit vector that points to the right in the picture.
    pub fn right(self, up: Up) -> Vector {
        self.axes(up)[0]
    }

    /// Orthonormal, right-handed axes of the picture: right, up, and toward the viewer.
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

/// Reason for which a view is invalid.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The text is neither a name nor two numbers.
    #[error(
        "the view must be front, back, left, right, top, bottom, three-quarter, or AZIMUTH,ELEVATION in \
        degrees such as 30,15; got '{text}'"
    )]
    Unknown {
        /// Text given.
        text: String,
    },
    /// An angle is out of range.
    #[error(
        "azimuth and elevation must be finite and the elevation in -90..=90 degrees, got {azimuth} and \
        {elevation}"
    )]
    OutOfRange {
        /// Azimuth in degrees.
        azimuth: f64,
        /// Elevation in degrees.
        elevation: f64,
    },
}

/// Axis of the model that points up in the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Up {
    /// The x axis points up; the front is seen from −z.
    X,
    /// The y axis points up, the convention of most models; the front is seen from +z.
    #[default]
    Y,
    /// The z axis points up, the convention of maps and terrain scans; the front is seen from −y.
    Z,
}

impl Up {
    /// Directions in the front view: right, up, and toward the viewer.
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

/// The text does not name an axis.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the axis must be x, y or z, got '{text}'")]
pub struct UpError {
    /// Text given.
    pub text: String,
}
