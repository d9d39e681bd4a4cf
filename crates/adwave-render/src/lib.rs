//! Pictures of shapes and fields, and charts, without a display or a graphics driver.
//!
//! A [`Surface`] is a mesh or a cloud with its colours; [`render`] draws one, [`grid`] a sheet of several. What is drawn is
//! sorted out by a depth buffer, several samples a pixel, from parallel rays; lit from the upper left of the viewer with
//! less light in hollows; and the same to the byte on any number of threads.

mod color_bar;
mod color_map;
mod color_range;
mod diverging;
mod error;
mod frame;
mod normals;
mod occlusion;
mod params;
mod picture;
pub mod plot;
mod raster;
mod render;
mod surface;
#[cfg(test)]
mod tests;
mod text;
mod vector;
mod view;

pub use color_map::{ColorMap, value_range};
pub use color_range::ValueRange;
pub use error::RenderError;
pub use params::{Background, ColorBar, MAX_PIXELS, MAX_SIDE, RenderParams};
pub use picture::Picture;
pub use render::{Panel, SharedCamera, grid, render};
pub use surface::{Ball, FieldPaint, Paint, Surface};
pub use view::{Up, UpError, View, ViewError};
