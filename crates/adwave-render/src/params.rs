//! How a picture is made.

use crate::error::RenderError;
use crate::view::{Up, View};

/// The most pixels of a picture: that of an 8K screen; what is held while drawing is some 40 bytes a pixel.
pub const MAX_PIXELS: u64 = 7680 * 4320;

/// The most pixels of a picture's side.
pub const MAX_SIDE: u32 = 16_384;

/// What stands behind the shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Nothing: alpha 0.
    Transparent,
    /// One color.
    Color([u8; 3]),
}

impl Background {
    /// Red, green, blue and alpha where nothing is.
    pub(crate) fn pixel(self) -> [u8; 4] {
        match self {
            Self::Transparent => [0; 4],
            Self::Color([r, g, b]) => [r, g, b, 255],
        }
    }
}

/// How depth shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Parallel rays: equal lengths are equal wherever they are.
    Orthographic,
    /// Rays from the eye; the field of view of the picture's shorter side in degrees, above 0 and at most 90.
    Perspective {
        /// Degrees.
        field_of_view: f64,
    },
}

/// What of the shape fills the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// How many times as large as the whole shape would fit; 1 shows all of it.
    pub zoom: f64,
    /// The place in the middle of the picture, model units; without one the middle is where it is with all of the shape.
    pub focus: Option<[f64; 3]>,
}

impl Default for Framing {
    /// All of the shape.
    fn default() -> Self {
        Self { zoom: 1.0, focus: None }
    }
}

/// How far from the middle of a shape a picture may have its own, in diagonals of the shape.
pub(crate) const FARTHEST_FOCUS: f64 = 10.0;

/// The most samples of a picture's longer side times zoom: corners beyond what the rasterizer can count would be misplaced.
const MAX_ZOOMED_SAMPLES: f64 = 1e6;

/// Whether a field gets a bar of its colors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorBar {
    /// Beside the shape, where there is room for it.
    #[default]
    Shown,
    /// None, and the room goes to the shape.
    Hidden,
}

/// The parameters of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderParams {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Where the viewer stands.
    pub view: View,
    /// Which axis of the model points up.
    pub up: Up,
    /// How depth shows.
    pub projection: Projection,
    /// What of the shape fills the picture.
    pub framing: Framing,
    /// What stands behind the shape.
    pub background: Background,
    /// The bar of a field's colors.
    pub color_bar: ColorBar,
    /// Edges whose faces meet at a larger angle are drawn sharp, degrees from 0 (all) to 180 (none).
    pub crease_angle: f64,
    /// Samples a pixel along each axis, 1 to 4; their mean smooths edges.
    pub samples: u32,
}

impl Default for RenderParams {
    /// 1200 × 900, three-quarter view with y up in mild perspective, on white.
    fn default() -> Self {
        Self {
            width: 1200,
            height: 900,
            view: View::THREE_QUARTER,
            up: Up::Y,
            projection: Projection::Perspective { field_of_view: 20.0 },
            framing: Framing::default(),
            background: Background::Color([255; 3]),
            color_bar: ColorBar::Shown,
            crease_angle: 50.0,
            samples: 3,
        }
    }
}

impl RenderParams {
    /// With this size in pixels.
    #[must_use]
    pub fn with_size(self, width: u32, height: u32) -> Self {
        Self { width, height, ..self }
    }

    /// With this view.
    #[must_use]
    pub fn with_view(self, view: View) -> Self {
        Self { view, ..self }
    }

    /// With this axis up.
    #[must_use]
    pub fn with_up(self, up: Up) -> Self {
        Self { up, ..self }
    }

    /// With this projection.
    #[must_use]
    pub fn with_projection(self, projection: Projection) -> Self {
        Self { projection, ..self }
    }

    /// With this part of the shape.
    #[must_use]
    pub fn with_framing(self, framing: Framing) -> Self {
        Self { framing, ..self }
    }

    /// With this background.
    #[must_use]
    pub fn with_background(self, background: Background) -> Self {
        Self { background, ..self }
    }

    /// With or without a bar of colors.
    #[must_use]
    pub fn with_color_bar(self, color_bar: ColorBar) -> Self {
        Self { color_bar, ..self }
    }

    /// With edges sharp from this angle on, degrees.
    #[must_use]
    pub fn with_crease_angle(self, crease_angle: f64) -> Self {
        Self { crease_angle, ..self }
    }

    /// With so many samples a pixel along each axis.
    #[must_use]
    pub fn with_samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// The largest zoom of a picture of this size.
    fn max_zoom(&self) -> f64 {
        let samples = f64::from(self.samples) * f64::from(self.width.max(self.height));
        (MAX_ZOOMED_SAMPLES / samples.max(1.0)).floor().max(1.0)
    }

    /// Refuses what cannot be drawn.
    ///
    /// # Errors
    ///
    /// A picture without pixels or with more than [`MAX_PIXELS`], a view or a parameter out of its range.
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
            return refused("the crease angle", self.crease_angle, "from 0 to 180 degrees");
        }
        if !(1..=4).contains(&self.samples) {
            return refused("the number of samples", f64::from(self.samples), "from 1 to 4");
        }
        Ok(())
    }
}

/// Refuses pictures that are empty or larger than is sensible.
pub(crate) fn check_size(width: u32, height: u32) -> Result<(), RenderError> {
    if width == 0 || height == 0 {
        return Err(RenderError::NoPixels { width, height });
    }
    if width > MAX_SIDE || height > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(RenderError::TooLarge { width, height, most: MAX_PIXELS, side: MAX_SIDE });
    }
    Ok(())
}
