//! Pictures of shapes and fields, and charts, without a display or a graphics driver.

mod color_map;

pub use color_map::{ColorMap, value_range};
