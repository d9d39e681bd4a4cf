//! Pictures.

use crate::arrays;
use crate::call::run;
use crate::error::value;
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
    module.add_function(wrap_pyfunction!(png_of, module)?)?;
    module.add_function(wrap_pyfunction!(color_map_names, module)?)
}

/// The PNG of height × width × 4 bytes.
#[pyfunction]
fn png_of<'py>(py: Python<'py>, array: PyReadonlyArray3<'py, u8>) -> PyResult<Bound<'py, PyBytes>> {
    let &[height, width, 4] = array.shape() else {
        return Err(value("array: four bytes a pixel are needed"));
    };
    if !array.is_c_contiguous() {
        return Err(value("array: it is not C-contiguous"));
    }
    let bytes = array.as_slice()?;
    let png = run(py, usize::MAX, None, |_| {
        let mut picture = Picture::filled(width as u32, height as u32, [0; 4])?;
        picture.rgba.copy_from_slice(bytes);
        picture.png()
    })?;
    Ok(PyBytes::new(py, &png))
}

/// Center, radius and color of a ball.
type Marked = ([f64; 3], f64, [u8; 3]);

#[pyfunction]
fn color_map_names() -> Vec<&'static str> {
    ColorMap::names().collect()
}

/// A picture as PNG, and as height × width × 4 bytes.
#[pyfunction]
#[pyo3(signature = (
    shape, size, values=None, colors=None, label="", color_map=None, range=None, color_bar=true, view="three-quarter", up=None,
    zoom=1.0, focus=None, orthographic=false, background=None, balls=None, samples=3, progress=None
))]
fn render_picture<'py>(
    py: Python<'py>,
    shape: &Bound<'py, ShapeData>,
    size: (u32, u32),
    values: Option<PyReadonlyArray1<'py, f64>>,
    colors: Option<PyReadonlyArray2<'py, u8>>,
    label: &str,
    color_map: Option<&str>,
    range: Option<(f64, f64)>,
    color_bar: bool,
    view: &str,
    up: Option<&str>,
    zoom: f64,
    focus: Option<[f64; 3]>,
    orthographic: bool,
    background: Option<[u8; 3]>,
    balls: Option<Vec<Marked>>,
    samples: u32,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, Bound<'py, PyAny>)> {
    let content = shape.get();
    let own = content.shape(py)?;
    let points = own.points().unwrap_or_default();
    let triangles = match own {
        Shape::Mesh(mesh) => triangulate(points, mesh.faces()),
        Shape::Cloud(_) | Shape::Graph(_) => Vec::new(),
    };
    let color_map = match color_map {
        Some(name) => Some(ColorMap::from_name(name).ok_or_else(|| {
            let names: Vec<&str> = ColorMap::names().collect();
            value(format!("color_map: '{name}' is none of {}", names.join(", ")))
        })?),
        None => None,
    };
    let paint = match (&values, &colors) {
        (Some(values), _) => Paint::Field(FieldPaint {
            values: values.as_slice()?,
            label: label.to_owned(),
            color_map,
            range: range.map_or(ValueRange::Auto, |(low, high)| ValueRange::Fixed(low, high)),
        }),
        (None, Some(colors)) => Paint::Colors(arrays::rows(colors, "colors")?.as_chunks().0),
        (None, None) => Paint::CLAY,
    };
    let asked = up.map(|up| up.parse::<Up>().map_err(|e| value(e.to_string()))).transpose()?;
    let (up, _) = Up::choose(asked, content.file.format().and_then(Format::up_axis), own);
    let params = RenderParams {
        width: size.0,
        height: size.1,
        view: view.parse::<View>().map_err(|e| value(e.to_string()))?,
        up,
        projection: if orthographic { Projection::Orthographic } else { RenderParams::default().projection },
        framing: Framing { zoom, focus },
        background: background.map_or(Background::Transparent, Background::Color),
        color_bar: if color_bar { ColorBar::Shown } else { ColorBar::Hidden },
        samples,
        ..RenderParams::default()
    };
    let balls: Vec<Ball> = balls
        .unwrap_or_default()
        .into_iter()
        .map(|(center, radius, color)| Ball { center, radius, color })
        .collect();
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
