//! Arrays to and from Python without a copy.

use crate::error::value_error;
use adwave_io::{Field, FieldValues};
use numpy::ndarray::ArrayView2;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

/// Numbers of a C-contiguous array.
///
/// `as_slice` also accepts transposed arrays, whose numbers have another order, so the order is checked here.
pub(crate) fn rows<'a, T: Element>(array: &'a PyReadonlyArray2<'_, T>, name: &str) -> PyResult<&'a [T]> {
    if !array.is_c_contiguous() {
        return Err(value_error(format!(
            "{name} must be C-contiguous; pass numpy.ascontiguousarray({name})"
        )));
    }
    array.as_slice().map_err(|e| value_error(format!("{name}: {e}")))
}

/// Points of a C-contiguous n × 3 array.
pub(crate) fn points<'a>(array: &'a PyReadonlyArray2<'_, f64>, name: &str) -> PyResult<&'a [[f64; 3]]> {
    if array.shape()[1] != 3 {
        return Err(value_error(format!("{name} must have three columns, got shape {:?}", array.shape())));
    }
    Ok(rows(array, name)?.as_chunks().0)
}

/// A vector as a NumPy array.
pub(crate) fn vector<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    values.into_pyarray(py)
}

/// A vector as a matrix.
pub(crate) fn matrix<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    n_columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let n_rows = values.len().checked_div(n_columns).unwrap_or(0);
    values.into_pyarray(py).reshape([n_rows, n_columns])
}

/// Bands as an array of levels × vertices × channels.
pub(crate) fn levels(
    py: Python<'_>,
    values: Vec<f64>,
    n_vertices: usize,
    n_channels: usize,
) -> PyResult<Bound<'_, PyArray3<f64>>> {
    let n_levels = values.len() / (n_vertices * n_channels).max(1);
    values.into_pyarray(py).reshape([n_levels, n_vertices, n_channels])
}

/// Points as an n × 3 array.
pub(crate) fn point_rows(py: Python<'_>, points: Vec<[f64; 3]>) -> PyResult<Bound<'_, PyArray2<f64>>> {
    matrix(py, points.into_flattened(), 3)
}

/// A read-only view of numbers that belong to `owner`.
///
/// # Safety
/// `owner` must neither change nor free the numbers while it lives.
#[allow(unsafe_code)]
pub(crate) unsafe fn view<'py, T: Element>(
    owner: Bound<'py, PyAny>,
    values: &[T],
    n_columns: usize,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let view = ArrayView2::from_shape((values.len() / n_columns, n_columns), values)
        .map_err(|e| value_error(e.to_string()))?;
    // SAFETY: the caller promises that the numbers stay in place while `owner` lives, and the array holds `owner`.
    let array = unsafe { PyArray2::borrow_from_array(&view, owner) };
    array.call_method1("setflags", (false,))?;
    Ok(array)
}

/// A field in its own number type, with one dimension if it has one channel.
pub(crate) fn field<'py>(py: Python<'py>, field: &Field) -> PyResult<Bound<'py, PyAny>> {
    fn shaped<'py, T: Element>(py: Python<'py>, values: &[T], d: usize) -> PyResult<Bound<'py, PyAny>> {
        let array = PyArray1::from_slice(py, values);
        if d == 1 { Ok(array.into_any()) } else { Ok(array.reshape([values.len() / d, d])?.into_any()) }
    }
    let d = field.n_channels.max(1);
    match &field.values {
        FieldValues::U8(v) => shaped(py, v, d),
        FieldValues::I8(v) => shaped(py, v, d),
        FieldValues::U16(v) => shaped(py, v, d),
        FieldValues::I16(v) => shaped(py, v, d),
        FieldValues::U32(v) => shaped(py, v, d),
        FieldValues::I32(v) => shaped(py, v, d),
        FieldValues::U64(v) => shaped(py, v, d),
        FieldValues::I64(v) => shaped(py, v, d),
        FieldValues::F32(v) => shaped(py, v, d),
        FieldValues::F64(v) => shaped(py, v, d),
    }
}

/// A field from a C-contiguous array of one or two dimensions, in one of the ten number types.
pub(crate) fn to_field(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Field> {
    fn values<T: Element + Copy>(array: &Bound<'_, PyArrayDyn<T>>) -> PyResult<Vec<T>> {
        Ok(array.try_readonly().map_err(|e| value_error(e.to_string()))?.as_slice()?.to_vec())
    }
    macro_rules! first_that_fits {
        ($($type:ty => $kind:ident),*) => {
            $(if let Ok(array) = array.cast::<PyArrayDyn<$type>>() {
                if !array.is_c_contiguous() {
                    return Err(value_error(format!("field {name} must be C-contiguous")));
                }
                let d = if array.ndim() == 2 { array.shape()[1] } else { 1 };
                return Field::try_new(name, d, FieldValues::$kind(values(array)?)).map_err(|e| value_error(e.to_string()));
            })*
        };
    }
    first_that_fits!(
        f64 => F64, f32 => F32, u8 => U8, i32 => I32, i64 => I64, u16 => U16, u32 => U32, i16 => I16, i8 => I8, u64 => U64
    );
    Err(value_error(format!("field {name} must be numbers of 8 to 64 bits")))
}
