//! Spacings, position and coordinate system of a GeoTIFF, and spacings of ImageJ.

use super::tags::{self, Container, Directory};
use crate::model::geo_keys::{GeoKeys, KEYS, NUMBERS, TEXTS};
use crate::model::grid_layout::{GridLayout, step_lengths};
use crate::{CoordinateSystem, LengthUnit};

/// Key of the place that coordinates of a pixel mean: its area or its center.
const RASTER_TYPE: u16 = 1025;
/// Coordinates of a pixel mean its center.
const IS_POINT: u16 = 2;

/// Place of an image on a map.
pub(super) struct MapPlace {
    pub(super) system: Option<CoordinateSystem>,
    /// Position of the first pixel, and steps from row to row and from column to column.
    pub(super) position: Option<([f64; 3], [[f64; 3]; 2])>,
}

/// Reads the tags of a GeoTIFF.
pub(super) fn map_place(container: &Container<'_>, directory: &Directory) -> MapPlace {
    let bytes = |tag: u16| -> Vec<u8> {
        let numbers = container.numbers(directory, tag);
        if tag == KEYS {
            numbers.iter().flat_map(|x| (*x as u16).to_le_bytes()).collect()
        } else {
            numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
        }
    };
    let (keys, numbers) = (bytes(KEYS), bytes(NUMBERS));
    let texts = container.text(directory, TEXTS);
    let texts = texts.as_deref().map(str::as_bytes);
    let keys = GeoKeys { keys: &keys, numbers: Some(&numbers), texts };
    let system = keys.system();
    let scale = container.numbers(directory, tags::PIXEL_SCALE);
    let ties = container.numbers(directory, tags::TIEPOINTS);
    let matrix = container.numbers(directory, tags::TRANSFORMATION);
    let corner_and_steps = if let [a, b, _, x, c, d, _, y, ..] = matrix[..] {
        Some(([x, y], [b, d], [a, c]))
    } else if let ([sx, sy, ..], [i, j, _, x, y, ..]) = (&scale[..], &ties[..]) {
        Some(([x - i * sx, y + j * sy], [0.0, -sy], [*sx, 0.0]))
    } else {
        None
    };
    let position = corner_and_steps.filter(|(corner, row, column)| {
        let is_step = |step: &[f64; 2]| step[0].hypot(step[1]).is_normal();
        corner.iter().all(|x| x.is_finite()) && is_step(row) && is_step(column)
    });
    let position = position.map(|(corner, row, column)| {
        let half = if keys.code(RASTER_TYPE) == Some(IS_POINT) { 0.0 } else { 0.5 };
        let first = |k: usize| corner[k] + half * (row[k] + column[k]);
        ([first(0), first(1), 0.0], [[row[0], row[1], 0.0], [column[0], column[1], 0.0]])
    });
    MapPlace { system, position }
}

/// Spacings in the description of an image by ImageJ: those of the stack, the rows and the columns, and their unit.
fn image_j(container: &Container<'_>, directory: &Directory) -> Option<([f64; 3], Option<LengthUnit>)> {
    let text = container.text(directory, tags::DESCRIPTION)?;
    let value = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
        line.map(str::trim)
    };
    value("ImageJ")?;
    let unit = match value("unit") {
        Some("\\u00B5m") => Some(LengthUnit::MICRON),
        unit => unit.and_then(LengthUnit::from_name),
    };
    let resolution = |tag: u16| container.numbers(directory, tag).first().map(|per_unit| 1.0 / per_unit);
    let spacings = [
        value("spacing").and_then(|spacing| spacing.parse().ok()),
        resolution(tags::Y_RESOLUTION),
        resolution(tags::X_RESOLUTION),
    ];
    let spacings = spacings.map(|h| h.map(f64::abs).filter(|h| h.is_normal()).unwrap_or(1.0));
    unit.is_some().then_some((spacings, unit))
}

/// Axes of the image or stack.
pub(super) fn layout(
    container: &Container<'_>,
    directory: &Directory,
    sizes: &[usize],
    notes: &mut Vec<String>,
) -> (GridLayout, Option<CoordinateSystem>) {
    let n = sizes.len();
    let MapPlace { system, position } = map_place(container, directory);
    let names = if n == 3 { vec!["page", "row", "column"] } else { vec!["row", "column"] };
    if let Some((origin, [row, column])) = position {
        let mut steps = vec![row, column];
        if n == 3 {
            steps.insert(0, [0.0, 0.0, 1.0]);
            notes.push("the pages of the stack are 1 apart, as the file does not state their spacing".into());
        }
        let spacings = step_lengths(&steps, notes);
        let unit = system.as_ref().and_then(|system| system.unit.clone());
        let layout = GridLayout {
            sizes: sizes.to_vec(),
            spacings,
            axis_names: names,
            origin,
            steps,
            unit,
            kept: None,
        };
        return (layout, system);
    }
    let (spacings, unit) = image_j(container, directory).unwrap_or(([1.0; 3], None));
    if unit.is_none() {
        notes.push("the file states no spacing; spacings are 1, so that lengths are in pixels".into());
    }
    (GridLayout { axis_names: names, unit, ..GridLayout::new(sizes, &spacings[3 - n..]) }, system)
}
