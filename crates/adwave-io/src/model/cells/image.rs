//! Images and volumes of VTK: grids with an origin and a step along each axis, which stay grids.

use adwave::Progress;

use super::grid::{Grid, row};
use crate::model::field::{ByteOrder, unused};
use crate::model::grid_layout::{GRID_VALUES, GridLayout, note_on_missing, step_lengths};
use crate::model::grid_values::GridNumbers;
use crate::model::numbers::collect_rows;
use crate::{Field, FieldValues, ReadError, ReadLimits, ShapeFile};

/// Array with the flags of places that other pieces or grids hold, or that have no data.
pub(crate) const GHOSTS: &str = "vtkGhostType";
/// Flag of a point without data.
const HIDDEN_POINT: u8 = 2;
/// Flags of a cell without data, and of a cell that a finer grid replaces.
const HIDDEN_CELL: u8 = 32 | 8;

/// Names of the axes, the fastest first.
const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// Relative difference of a stated spacing from the length of its step that is rounding.
const ROUNDING: f64 = 1e-12;

/// Origin and steps of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ImageFrame {
    /// Position of lattice position 0.
    pub(crate) origin: [f64; 3],
    /// Distance of neighbors along each axis.
    pub(crate) spacings: [f64; 3],
    /// Direction of each axis.
    pub(crate) directions: [[f64; 3]; 3],
    /// Lattice position of the first point.
    pub(crate) first: [i64; 3],
}

impl ImageFrame {
    fn step(&self, axis: usize) -> [f64; 3] {
        self.directions[axis].map(|x| x * self.spacings[axis])
    }

    /// Position of the point that is so many steps from the first one.
    pub(super) fn position(&self, at: [usize; 3]) -> [f64; 3] {
        let mut position = self.origin;
        for (axis, (first, at)) in self.first.iter().zip(at).enumerate() {
            let n_steps = (first + at as i64) as f64;
            position.iter_mut().zip(self.step(axis)).for_each(|(x, d)| *x += n_steps * d);
        }
        position
    }

    /// Checks that the axes with several places have a spacing and a direction.
    fn check(&self, dims: [usize; 3]) -> Result<(), ReadError> {
        let wrong = |message: String| Err(ReadError::Whole(message));
        for (axis, name) in AXIS_NAMES.iter().enumerate().filter(|(axis, _)| dims[*axis] > 1) {
            let (spacing, direction) = (self.spacings[axis], self.directions[axis]);
            if !(spacing.is_normal() && spacing > 0.0) {
                return wrong(format!(
                    "the spacing along {name} must be a number above 0, got {spacing}; correct it"
                ));
            }
            let length = self.step(axis).iter().map(|x| x * x).sum::<f64>().sqrt();
            if !length.is_normal() {
                return wrong(format!(
                    "the direction of the axis {name} must be a vector with a length, got {direction:?}; correct it"
                ));
            }
        }
        let first = self.position([0; 3]);
        if first.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        wrong(format!("the position of the first place must be finite, got {first:?}; correct it"))
    }
}

/// Arrays of a file that are the fields of a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct GridArrays {
    /// True if the places are the centers of cells.
    pub(crate) of_cells: bool,
    /// Name of the array that is the field `values`.
    pub(crate) values: String,
    /// Name of the field of another array that is named `values`.
    displaced: Option<String>,
}

impl GridArrays {
    /// Name of the array of a field.
    pub(crate) fn name_of<'a>(&'a self, field: &'a str) -> &'a str {
        match field {
            GRID_VALUES => &self.values,
            other if self.displaced.as_deref() == Some(other) => GRID_VALUES,
            other => other,
        }
    }
}

/// True at the places that an array of ghosts hides; empty if there is no such array.
pub(crate) fn hidden_places(fields: &[Field], of_cells: bool) -> Vec<bool> {
    let flags = if of_cells { HIDDEN_CELL } else { HIDDEN_POINT };
    match fields.iter().find(|field| field.name == GHOSTS && field.n_channels == 1).map(|f| &f.values) {
        Some(FieldValues::U8(ghosts)) => ghosts.iter().map(|ghost| ghost & flags != 0).collect(),
        _ => Vec::new(),
    }
}

impl Grid {
    /// Converts the grid to an image or a volume in the frame, whose values are those of the points if there are any,
    /// else those of the cells. `active` names the array of each that is the field `values`; else it is the first one.
    pub(crate) fn into_image(
        self,
        frame: &ImageFrame,
        active: [Option<&str>; 2],
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<(ShapeFile, GridArrays), ReadError> {
        let Self { lattice, point_fields, cell_fields, point_rows, cell_rows, mut extras, .. } = self;
        let is_values = |field: &Field| field.name != GHOSTS;
        let of_cells = !point_fields.iter().any(is_values);
        let (mut fields, others, rows, dims) = if of_cells {
            (cell_fields, point_fields, cell_rows, lattice.cells())
        } else {
            (point_fields, cell_fields, point_rows, lattice.dims())
        };
        let Some(first) = fields.iter().position(is_values) else {
            let message =
                "the image must have an array of numbers at its points or cells, got none; save it with one";
            return Err(ReadError::Whole(message.into()));
        };
        let active = active[usize::from(of_cells)];
        let k = fields.iter().position(|f| is_values(f) && Some(f.name.as_str()) == active).unwrap_or(first);
        let n = dims.iter().product();
        limits.check_places(n as u64)?;
        frame.check(dims)?;
        let mut notes = Vec::new();
        if let Some(rows) = &rows {
            for field in &mut fields {
                *field = collect_rows(field, n, progress, &|i| row(Some(rows), i))?;
            }
        }
        let of_others = if of_cells { "points" } else { "cells" };
        extras.extend(others.iter().map(|field| format!("values of {of_others} in `{}`", field.name)));
        if of_cells {
            notes.push(
                "the file has values of cells alone, and the places are the centers of its cells".into(),
            );
        }
        let further: Vec<String> = fields
            .iter()
            .enumerate()
            .filter(|(i, f)| *i != k && is_values(f))
            .map(|(_, f)| f.name.clone())
            .collect();
        let values =
            std::mem::replace(&mut fields[k], Field::new(GRID_VALUES, 1, FieldValues::U8(Vec::new())));
        if !further.is_empty() {
            notes.push(format!(
                "the values are the array `{}`; further fields are `{}`",
                values.name,
                further.join("`, `")
            ));
        }
        let displaced = (0..fields.len()).find(|&i| i != k && fields[i].name == GRID_VALUES).map(|i| {
            let name = unused(GRID_VALUES, "_", |name| fields.iter().any(|field| field.name == name));
            fields[i].name.clone_from(&name);
            name
        });
        let hidden = hidden_places(&fields, of_cells);
        let numbers = GridNumbers::new(values.values.value_type(), ByteOrder::Little, n, values.n_channels);
        let arrays = GridArrays { of_cells, values: values.name, displaced };
        let values = numbers.decode(values.values, &hidden, progress)?;
        fields[k] = values.field;
        let mut layout = layout(frame, dims, &mut notes);
        if of_cells {
            // The center of the first cell.
            for axis in (0..3).filter(|&axis| lattice.dims()[axis] > 1) {
                layout.origin.iter_mut().zip(frame.step(axis)).for_each(|(x, d)| *x += 0.5 * d);
            }
        }
        layout.kept = values.kept;
        note_on_missing(&layout, (!hidden.is_empty()).then_some("NaN or a hidden place"), &mut notes);
        let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
        (shape.vertex_fields, shape.extras, shape.notes) = (fields, extras, notes);
        Ok((shape, arrays))
    }
}

/// Axes with several places, the slowest first.
fn layout(frame: &ImageFrame, dims: [usize; 3], notes: &mut Vec<String>) -> GridLayout {
    let mut axes: Vec<usize> = (0..3).rev().filter(|&axis| dims[axis] > 1).collect();
    if axes.is_empty() {
        axes.push(0);
    }
    let steps: Vec<[f64; 3]> = axes.iter().map(|&axis| frame.step(axis)).collect();
    let mut spacings = step_lengths(&steps, notes);
    for (spacing, &axis) in spacings.iter_mut().zip(&axes) {
        let stated = frame.spacings[axis];
        if (*spacing / stated - 1.0).abs() < ROUNDING {
            *spacing = stated;
        }
    }
    GridLayout {
        sizes: axes.iter().map(|&axis| dims[axis]).collect(),
        spacings,
        axis_names: axes.iter().map(|&axis| AXIS_NAMES[axis]).collect(),
        origin: frame.position([0; 3]),
        steps,
        unit: None,
        kept: None,
    }
}

/// The frame and the numbers of points along x, y and z by which a file of VTK states a grid.
pub(crate) fn frame_of(layout: &GridLayout) -> (ImageFrame, [usize; 3]) {
    let n = layout.sizes.len();
    // An axis along x, y or z is that one, if this keeps the order; else the fastest axis is x, and so on.
    let along = |axis: usize| {
        let step = layout.steps[axis];
        (0..3).find(|&c| (0..3).all(|row| if row == c { step[row] > 0.0 } else { step[row] == 0.0 }))
    };
    let own: Vec<Option<usize>> = (0..n).map(along).collect();
    let keeps_order =
        own.windows(2).all(|pair| pair[1].is_some() && pair[0] > pair[1]) && !own.contains(&None);
    let mut frame =
        ImageFrame { origin: layout.origin, spacings: [1.0; 3], directions: [[0.0; 3]; 3], first: [0; 3] };
    let mut dims = [1; 3];
    let mut is_free = [true; 3];
    for (axis, slot) in own.into_iter().enumerate() {
        let slot = slot.filter(|_| keeps_order).unwrap_or(n - 1 - axis);
        let length = layout.steps[axis].iter().map(|x| x * x).sum::<f64>().sqrt();
        dims[slot] = layout.sizes[axis];
        frame.spacings[slot] = layout.spacings[axis];
        if length.is_normal() {
            frame.directions[slot] = layout.steps[axis].map(|x| x / layout.spacings[axis]);
            is_free[slot] = false;
        }
    }
    complete(&mut frame.directions, is_free);
    (frame, dims)
}

/// Gives the free axes directions at right angles to the others.
fn complete(directions: &mut [[f64; 3]; 3], is_free: [bool; 3]) {
    let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    for slot in (0..3).filter(|&slot| is_free[slot]) {
        let [a, b] = [directions[(slot + 1) % 3], directions[(slot + 2) % 3]];
        let product: [f64; 3] = std::array::from_fn(|c| {
            let (d, e) = ((c + 1) % 3, (c + 2) % 3);
            a[d] * b[e] - a[e] * b[d]
        });
        let length = dot(&product, &product).sqrt();
        directions[slot] = if length > ROUNDING {
            product.map(|x| x / length)
        } else {
            // At most one direction is known so far: the axis that is farthest from it, without its part along it.
            let known = [a, b].into_iter().find(|v| dot(v, v) > 0.0).unwrap_or_default();
            let farthest =
                (0..3).fold(slot, |best, c| if known[c].abs() < known[best].abs() { c } else { best });
            let mut axis = [0.0; 3];
            axis[farthest] = 1.0;
            let part = dot(&known, &axis) / dot(&known, &known).max(f64::MIN_POSITIVE);
            let rest: [f64; 3] = std::array::from_fn(|c| axis[c] - part * known[c]);
            let length = dot(&rest, &rest).sqrt();
            rest.map(|x| x / length)
        };
    }
}
