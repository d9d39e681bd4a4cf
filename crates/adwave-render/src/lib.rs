//! Pictures of shapes and fields, and charts, without a display or a graphics driver.
//!
//! [`render`] draws one [`Surface`], [`grid`] several on one sheet. A picture is made in the order of the files: the shape's
//! corners get normals (`normals`; for a cloud, discs: `splats`), the camera frames them (`camera`), a z-buffer finds what
//! each sample shows (`raster`), lights and colors make it visible (`scene`, `shade`), depth darkens what is enclosed
//! (`occlusion`), and bar and words are laid over (`color_bar`, `text`).

mod camera;
mod color_bar;
mod color_map;
mod color_range;
mod diverging;
mod error;
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
mod up;
mod vector;
mod view;

pub use color_map::{ColorMap, value_range};
pub use color_range::ValueRange;
pub use error::RenderError;
pub use grid::{Panel, SharedCamera, grid};
pub use params::{Background, ColorBar, Framing, MAX_PIXELS, MAX_SIDE, Projection, RenderParams};
pub use picture::Picture;
pub use render::render;
pub use surface::{Ball, FieldPaint, Paint, Surface};
pub use up::UpReason;
pub use view::{Up, UpError, View, ViewError};
