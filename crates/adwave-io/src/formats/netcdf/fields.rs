//! Variables on the cells or corners of a mesh as fields: an axis of time becomes channels, levels fields of their own.

use crate::formats::netcdf::variables::{Dimension, NetCdf, Variable};
use crate::{Field, FieldValues, ReadError, ReadLimits, ValueType};

/// Largest number of levels of a variable, each of which is a field.
const MAX_LEVELS: u64 = 4096;

/// Axis along which the places of a field lie.
pub(super) enum PlaceAxis<'a> {
    /// The axis of this name, with so many places.
    Named(&'a str, usize),
    /// The last axis with so many places.
    OfSize(usize),
}

impl PlaceAxis<'_> {
    fn find(&self, axes: &[Dimension]) -> Option<usize> {
        match *self {
            PlaceAxis::Named(name, n) => {
                axes.iter().position(|axis| axis.name == name && axis.size == n as u64)
            }
            PlaceAxis::OfSize(n) => axes.iter().rposition(|axis| axis.size == n as u64),
        }
    }
}

/// True for the name of an axis of time.
fn is_time(axis: &Dimension) -> bool {
    let name = axis.name.to_ascii_lowercase();
    name == "time" || name == "t" || name.starts_with("time_") || name.ends_with("_time")
}

/// Seconds between frames along an axis, if a variable of its name has equal steps in a known unit.
fn frame_step(file: &NetCdf<'_>, axis: &Dimension) -> Option<f64> {
    let variable = file.variable(&axis.name).filter(|v| v.axes.len() == 1)?;
    let unit = variable.text("units")?.split_whitespace().next()?.trim_end_matches('s').to_ascii_lowercase();
    let seconds = match unit.as_str() {
        "s" | "sec" | "second" | "" => 1.0,
        "min" | "minute" => 60.0,
        "h" | "hr" | "hour" => 3600.0,
        "d" | "day" => 86_400.0,
        _ => return None,
    };
    let times = file.values(variable).ok()?;
    let step = times.get(1)? - times[0];
    let is_even = times.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() <= 1e-6 * step.abs());
    (is_even && step > 0.0 && step.is_finite()).then_some(seconds * step)
}

/// Values in the type of the file where that holds them.
fn in_own_type(values: Vec<f64>, kind: Option<ValueType>) -> FieldValues {
    match kind {
        Some(ValueType::F32) if values.iter().all(|x| x.is_nan() || f64::from(*x as f32) == *x) => {
            FieldValues::F32(values.into_iter().map(|x| x as f32).collect())
        }
        Some(kind) if kind.is_integer() && kind.n_bytes() <= 4 && values.iter().all(|x| x.fract() == 0.0) => {
            let mut own = kind.empty();
            if values.iter().all(|x| own.push_f64(*x)) { own } else { FieldValues::F64(values) }
        }
        _ => FieldValues::F64(values),
    }
}

/// Fields of the places along an axis, those that change with time first. `is_of_mesh` names variables that are none.
pub(super) fn read_fields(
    file: &NetCdf<'_>,
    places: &PlaceAxis<'_>,
    is_of_mesh: impl Fn(&Variable) -> bool,
    limits: &ReadLimits,
) -> Result<Vec<Field>, ReadError> {
    let (mut in_time, mut constant) = (Vec::new(), Vec::new());
    let mut n_bytes = 0_u64;
    for variable in file.variables() {
        let Some(place) = places.find(&variable.axes) else { continue };
        let others = || variable.axes.iter().enumerate().filter(|(axis, _)| *axis != place);
        let time = others().find(|(_, axis)| is_time(axis)).map(|(axis, _)| axis);
        // Tables of neighbors and corners are integers.
        let is_table =
            variable.kind.is_some_and(ValueType::is_integer) && others().any(|(axis, _)| Some(axis) != time);
        if variable.kind.is_none() || is_table || is_of_mesh(variable) || variable.n_values() == 0 {
            continue;
        }
        n_bytes = n_bytes.saturating_add(variable.n_values().saturating_mul(8));
        limits.check_bytes(n_bytes)?;
        let fields = fields_of(file, variable, place, time)?;
        if time.is_some() { in_time.extend(fields) } else { constant.extend(fields) }
    }
    in_time.extend(constant);
    Ok(in_time)
}

/// A variable as a field for each of its levels, with a channel for each time.
fn fields_of(
    file: &NetCdf<'_>,
    variable: &Variable,
    place: usize,
    time: Option<usize>,
) -> Result<Vec<Field>, ReadError> {
    let n_levels = variable.axes.iter().enumerate().filter(|(axis, _)| *axis != place && Some(*axis) != time);
    let n_levels = n_levels.fold(1_u64, |n, (_, axis)| n.saturating_mul(axis.size));
    if n_levels > MAX_LEVELS {
        return Err(ReadError::Limit { what: "levels of a variable", found: n_levels, limit: MAX_LEVELS });
    }
    let values = file.values(variable)?;
    let sizes: Vec<usize> = variable.axes.iter().map(|axis| axis.size as usize).collect();
    let stride = |axis: usize| sizes[axis + 1..].iter().product::<usize>();
    let (n_places, n_times) = (sizes[place], time.map_or(1, |axis| sizes[axis]));
    // Offsets of the levels, in the order of the file.
    let mut levels = vec![0_usize];
    for axis in (0..sizes.len()).filter(|axis| *axis != place && Some(*axis) != time) {
        levels = levels
            .iter()
            .flat_map(|start| (0..sizes[axis]).map(move |k| (start, k)))
            .map(|(start, k)| start + k * stride(axis))
            .collect();
    }
    let frame_step = time.and_then(|axis| frame_step(file, &variable.axes[axis]));
    let field = |(level, start): (usize, usize)| {
        let at = |k: usize| {
            start + k / n_times * stride(place) + time.map_or(0, |axis| k % n_times * stride(axis))
        };
        let own: Vec<f64> = (0..n_places * n_times).map(|k| values[at(k)]).collect();
        let name = if n_levels == 1 {
            variable.name.clone()
        } else {
            format!("{}_level{}", variable.name, level + 1)
        };
        let mut field = Field::new(name, n_times, in_own_type(own, variable.kind));
        field.frame_step = frame_step;
        field
    };
    Ok(levels.into_iter().enumerate().map(field).collect())
}
