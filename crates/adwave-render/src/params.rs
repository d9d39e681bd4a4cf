//! Parameters of a picture.

use crate::error::RenderError;
use crate::view::{Up, View};

/// Largest number of pixels of a picture, that of an 8K screen. Drawing takes about 40 bytes per pixel.
pub const MAX_PIXELS: u64 = 7680 * 4320;

/// Largest number of pixels per side of a picture.
pub const MAX_SIDE: u32 = 16_384;

/// Background behind the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Background {
    /// Transparent: alpha 0.
    Transparent,
    /// One color: red, green and blue.
    Color([u8; 3]),
}

impl Background {
    /// Red, green, blue and alpha of an empty pixel.
    pub(crate) fn pixel(self) -> [u8; 4] {
        match self {
            Self::Transparent => [0; 4],
            Self::Color([r, g, b]) => [r, g, b, 255],
        }
    }
}

/// Projection of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Projection {
    /// Parallel rays: equal lengths appear equal at any depth.
    Orthographic,
    /// Rays from the eye.
    Perspective {
        /// Field of view along the picture's shorter side, in degrees, above 0 and at most 90.
        field_of_view: f64,
    },
}

/// Part of the shape that fills the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// Magnification relative to the framing of the whole shape; 1 shows all of it.
    pub zoom: f64,
    /// Point in the middle of the picture, in model units; `None` keeps the middle of the whole shape.
    pub focus: Option<[f64; 3]>,
}

impl Default for Framing {
    /// Shows the whole shape.
    fn default() -> Self {
        Self { zoom: 1.0, focus: None }
    }
}

/// Vertices that a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Frame {
    /// All vertices but placeholders and a few that are so far away that the rest would fill less than half of the
    /// picture.
    #[default]
    Main,
    /// All vertices.
    All,
}

adwave::named_values!(Frame, "frame", {
    Main => "main", "Leave out the few vertices that are far from all others";
    All => "all", "Show all vertices, however far away";
});

/// Largest distance between the focus and the middle of the shape, in diagonals of the shape.
pub(crate) const FARTHEST_FOCUS: f64 = 10.0;

/// Largest number of samples along a picture's longer side times zoom. Beyond it the rasterizer would misplace corners
/// outside its integer range.
const MAX_ZOOMED_SAMPLES: f64 = 1e6;

/// Visibility of a field's color bar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ColorBar {
    /// Drawn beside the shape if there is room for it.
    #[default]
    Shown,
    /// Not drawn; the shape fills the space.
    Hidden,
}

/// Parameters of a picture.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RenderParams {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Direction from which the shape is seen.
    pub view: View,
    /// Axis of the model that points up.
    pub up: Up,
    /// Projection of the camera.
    pub projection: Projection,
    /// Part of the shape that fills the picture.
    pub framing: Framing,
    /// Vertices that the picture shows.
    pub frame: Frame,
    /// Background behind the shape.
    pub background: Background,
    /// Visibility of a field's color bar.
    pub color_bar: ColorBar,
    /// Dihedral angle above which edges are drawn sharp, in degrees from 0 (all edges) to 180 (none).
    pub crease_angle: f64,
    /// Number of samples per pixel along each axis, 1 to 4; their mean smooths edges.
    pub samples: u32,
}

impl Default for RenderParams {
    /// Returns 1200 × 900 pixels, three-quarter view with y up, mild perspective, and white background.
    fn default() -> Self {
        Self {
            width: 1200,
            height: 900,
            view: View::THREE_QUARTER,
            up: Up::Y,
            projection: Projection::Perspective { field_of_view: 20.0 },
            framing: Framing::default(),
            frame: Frame::default(),
            background: Background::Color([255; 3]),
            color_bar: ColorBar::Shown,
            crease_angle: 50.0,
            samples: 3,
        }
    }
}

impl RenderParams {
    /// Sets [`width`](Self::width).
    #[must_use]
    pub fn with_width(self, width: u32) -> Self {
        Self { width, ..self }
    }

    /// Sets [`height`](Self::height).
    #[must_use]
    pub fn with_height(self, height: u32) -> Self {
        Self { height, ..self }
    }

    /// Sets the size in pixels.
    #[must_use]
    pub fn with_size(self, width: u32, height: u32) -> Self {
        Self { width, height, ..self }
    }

    /// Sets the view.
    #[must_use]
    pub fn with_view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// Sets the axis that points up.
    #[must_use]
    pub fn with_up(self, up: Up) -> Self {
        Self { up, ..self }
    }

    /// Sets the projection.
    #[must_use]
    pub fn with_projection(self, projection: Projection) -> Self {
        Self { projection, ..self }
    }

    /// Sets the part of the shape that fills the picture.
    #[must_use]
    pub fn with_framing(self, framing: Framing) -> Self {
        Self { framing, ..self }
    }

    /// Sets the vertices that the picture shows.
    #[must_use]
    pub fn with_frame(self, frame: Frame) -> Self {
        Self { frame, ..self }
    }

    /// Sets the background.
    #[must_use]
    pub fn with_background(self, background: Background) -> Self {
        Self { background, ..self }
    }

    /// Sets the visibility of the color bar.
    #[must_use]
    pub fn with_color_bar(self, color_bar: ColorBar) -> Self {
        Self { color_bar, ..self }
    }

    /// Sets the angle above which edges are sharp, in degrees.
    #[must_use]
    pub fn with_crease_angle(self, crease_angle: f64) -> Self {
        Self { crease_angle, ..self }
    }

    /// Sets the number of samples per pixel along each axis.
    #[must_use]
    pub fn with_samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// Largest zoom of a picture of this size.
    fn max_zoom(&self) -> f64 {
        let samples = f64::from(self.samples) * f64::from(self.width.max(self.height));
        (MAX_ZOOMED_SAMPLES / samples.max(1.0)).floor().max(1.0)
    }

    /// Checks the ranges of all parameters.
    ///
    /// # Errors
    ///
    /// Returns a [`RenderError`] for a picture without pixels or with more than [`MAX_PIXELS`], and for a view or a
    /// parameter out of its range.
    pub fn check(&self) -> Result<(), RenderError> {
        check_size(self.width, self.height)?;
        self.view.check()?;
        let refused = |name, value, range| Err(RenderError::BadParam { name, value, range });
        if let Projection::Perspective { field_of_view } = self.projection
            && !(field_of_view > 0.0 && field_of_view <= 90.0)
        {
            return refused("the field of view", field_of_view, "above 0 and at most 90 degrees");
        }
        let zoom = self.framing.zoom;
        if !(zoom > 0.0 && zoom <= self.max_zoom()) {
            return Err(RenderError::BadZoom { zoom, most: self.max_zoom() });
        }
        if !(0.0..=180.0).contains(&self.crease_angle) {
            return refused("the crease angle", self.crease_angle, "in 0..=180 degrees");
        }
        if !(1..=4).contains(&self.samples) {
            return refused("the number of samples", f64::from(self.samples), "in 1..=4");
        }
        Ok(())
    }
}

/// Checks that a picture is neither empty nor too large.
pub(crate) fn check_size(width: u32, height: u32) -> Result<(), RenderError> {
    if width == 0 || height == 0 {
        return Err(RenderError::NoPixels { width, height });
    }
    if width > MAX_SIDE || height > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(RenderError::TooLarge { width, height, most: MAX_PIXELS, side: MAX_SIDE });
    }
    Ok(())
}
