//! Pictures.

use crate::arrays;
use crate::call::run;
use crate::error::value_error;
use crate::shape::ShapeData;
use adwave::shape::{Shape, triangulate};
use adwave_io::Format;
use adwave_render::{
    Background, Ball, ColorBar, ColorMap, FieldPaint, Framing, Paint, Picture, Projection, RenderParams,
    Surface, Up, ValueRange, View, render,
};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(render_picture, module)?)?;
    module.add_function(wrap_pyfunction!(encode_png, module)?)?;
    module.add_function(wrap_pyfunction!(color_map_names, module)?)
}

/// PNG of height × width × 4 bytes.
#[pyfunction]
fn encode_png<'py>(py: Python<'py>, array: PyReadonlyArray3<'py, u8>) -> PyResult<Bound<'py, PyBytes>> {
    let &[height, width, 4] = array.shape() else {
        return Err(value_error("array must have four bytes for each pixel"));
    };
    if !array.is_c_contiguous() {
        return Err(value_error("array must be C-contiguous"));
    }
    let bytes = array.as_slice()?;
    let png = run(py, usize::MAX, None, |_| {
        let mut picture = Picture::blank(width as u32, height as u32, [0; 4])?;
        picture.rgba.copy_from_slice(bytes);
        picture.png()
    })?;
    Ok(PyBytes::new(py, &png))
}

/// Center, radius and color of a ball.
type BallTuple = ([f64; 3], f64, [u8; 3]);

/// Names of the color maps.
#[pyfunction]
fn color_map_names() -> Vec<&'static str> {
    ColorMap::names().collect()
}

/// Everything that a picture of a shape depends on.
#[derive(FromPyObject)]
struct PictureOptions<'py> {
    width: u32,
    height: u32,
    values: Option<PyReadonlyArray1<'py, f64>>,
    colors: Option<PyReadonlyArray2<'py, u8>>,
    label: String,
    color_map: Option<String>,
    range: Option<(f64, f64)>,
    color_bar: bool,
    view: String,
    up: Option<String>,
    zoom: f64,
    focus: Option<[f64; 3]>,
    orthographic: bool,
    background: Option<[u8; 3]>,
    balls: Vec<BallTuple>,
}

/// Samples along each side of a pixel.
const SAMPLES: u32 = 3;

impl PictureOptions<'_> {
    fn paint(&self) -> PyResult<Paint<'_>> {
        let color_map = match &self.color_map {
            Some(name) => Some(ColorMap::from_name(name).ok_or_else(|| {
                let names: Vec<&str> = ColorMap::names().collect();
                value_error(format!("color_map must be one of {}, got '{name}'", names.join(", ")))
            })?),
            None => None,
        };
        Ok(match (&self.values, &self.colors) {
            (Some(values), _) => Paint::Field(FieldPaint {
                values: values.as_slice()?,
                label: self.label.clone(),
                color_map,
                range: self.range.map_or(ValueRange::Auto, |(low, high)| ValueRange::Fixed(low, high)),
            }),
            (None, Some(colors)) => Paint::Colors(arrays::rows(colors, "colors")?.as_chunks().0),
            (None, None) => Paint::CLAY,
        })
    }

    fn params(&self, up: Up) -> PyResult<RenderParams> {
        let default = RenderParams::default();
        let projection = if self.orthographic { Projection::Orthographic } else { default.projection };
        Ok(default
            .with_width(self.width)
            .with_height(self.height)
            .with_view(self.view.parse::<View>().map_err(|e| value_error(e.to_string()))?)
            .with_up(up)
            .with_projection(projection)
            .with_framing(Framing { zoom: self.zoom, focus: self.focus })
            .with_background(self.background.map_or(Background::Transparent, Background::Color))
            .with_color_bar(if self.color_bar { ColorBar::Shown } else { ColorBar::Hidden })
            .with_samples(SAMPLES))
    }
}

/// Draws a picture: its PNG, and height × width × 4 bytes.
#[pyfunction]
#[pyo3(signature = (shape, options, progress=None))]
fn render_picture<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    options: PictureOptions<'py>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
    let content = shape.get();
    let own = content.shape(py)?;
    let points = own.points().unwrap_or_default();
    let triangles = match own {
        Shape::Mesh(mesh) => triangulate(points, mesh.faces()),
        Shape::Cloud(_) | Shape::Graph(_) => Vec::new(),
    };
    let paint = options.paint()?;
    let up = match &options.up {
        Some(up) => up.parse::<Up>().map_err(|e| value_error(e.to_string()))?,
        None if matches!(
            content.file.format(),
            Some(Format::LAS | Format::LAZ | Format::EPT | Format::GIFTI | Format::FREESURFER)
        ) =>
        {
            Up::Z
        }
        None => Up::guess(points, || !own.is_mesh()),
    };
    let params = options.params(up)?;
    let ball = |(center, radius, color): &BallTuple| Ball { center: *center, radius: *radius, color: *color };
    let balls: Vec<Ball> = options.balls.iter().map(ball).collect();
    let surface = Surface { points, triangles: &triangles, paint };
    let (png, pixels) = run(py, usize::MAX, progress.as_ref(), |p| {
        let picture = render(&surface, &balls, &params, p)?;
        let png = picture.png()?;
        Ok::<_, adwave_render::RenderError>((png, (picture.height, picture.width, picture.rgba)))
    })?;
    let (height, width, bytes) = pixels;
    let array = arrays::matrix(py, bytes, 4)?;
    let array = numpy::PyArrayMethods::reshape(&array, [height as usize, width as usize, 4])?;
    Ok((PyBytes::new(py, &png), array.into_any()))
}
