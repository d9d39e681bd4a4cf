//! Pictures of shapes and fields, and charts, without a display or a graphics driver.
//!
//! [`render`] draws one [`Surface`], [`grid`] draws several on one sheet. The stages of a picture are:
//!
//! - normals of the corners of a mesh (`normals`), discs for the points of a cloud (`splats`), or tubes for a curve
//!   (`tubes`),
//! - framing by the camera (`camera`),
//! - a z-buffer that finds the primitive of each sample (`raster`),
//! - lighting and colors (`scene`, `shade`),
//! - darkening of enclosed regions (`occlusion`),
//! - color bar and text (`color_bar`, `ticks`, `text`).

mod camera;
mod color_bar;
mod color_map;
mod color_range;
mod diverging;
mod error;
mod framed;
mod grid;
mod layout;
mod normals;
mod occlusion;
mod params;
mod picture;
pub mod plot;
mod raster;
mod render;
mod scene;
mod shade;
mod splats;
mod surface;
#[cfg(test)]
mod tests;
mod text;
mod ticks;
mod tubes;
mod up;
mod vector;
mod view;

pub use color_map::{ColorMap, value_range};
pub use color_range::ValueRange;
pub use error::RenderError;
pub use grid::{Panel, SharedCamera, grid};
pub use params::{Background, ColorBar, Frame, Framing, MAX_PIXELS, MAX_SIDE, Projection, RenderParams};
pub use picture::Picture;
pub use render::render;
pub use surface::{Ball, FieldPaint, Paint, Surface};
pub use tubes::Tubes;
pub use up::UpReason;
pub use view::{Up, UpError, View, ViewError};
