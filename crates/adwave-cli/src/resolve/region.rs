//! From region flags to weights on a shape.

use super::shape::{GivenLength, Input, vertex_in_row};
use super::signal::field_names;
use crate::error::CliError;
use crate::global::Global;
use crate::output::{count, note};
use adwave::region::{Length, Region};
use adwave::{Decomposer, Progress};
use adwave_io::{ShapeFile, region_field};

/// The name of the weights as a field.
pub(crate) const WEIGHT: &str = "weight";

/// The union of regions; everywhere if there are none.
pub(crate) fn union_of_regions(regions: &[Region]) -> Region {
    match regions {
        [] => Region::Everywhere {},
        [one] => one.clone(),
        several => Region::Any(several.to_vec()),
    }
}

/// The region with vertices of the shape, where `region` names rows of the file.
pub(crate) fn region_in_shape(region: &Region, input: &Input) -> Result<Region, CliError> {
    let given = |length: Length| GivenLength { option: "--region", length };
    input.check_lengths(&region.lengths().into_iter().map(given).collect::<Vec<_>>())?;
    let mut region = region.clone();
    if input.file.file_rows().is_some() {
        region.try_map_vertices(&mut |row| vertex_in_row(input, row as usize).map(|vertex| vertex as u32))?;
    }
    Ok(region)
}

/// The weights of a region in [0, 1], one for each vertex of the shape, as a filter uses them.
pub(crate) fn region_weights(
    region: &Region,
    input: &Input,
    decomposer: &Decomposer,
    progress: Progress<'_>,
) -> Result<Vec<f64>, CliError> {
    let region = &region_in_shape(region, input)?;
    let names = field_names(&input.file);
    let lookup = |name: &str| region_field(&input.file, decomposer, name);
    let weights = region.weights(decomposer.metric(), &lookup, &names, progress);
    let weights = weights.map_err(|e| CliError::classify(&e))?;
    Ok(weights.to_vertices(decomposer.vertex_map()))
}

/// Prints a note for each point of the region that lies off the shape, so that another place replaces it, and for each
/// field of the region without a value somewhere.
pub(crate) fn note_region(
    region: &Region,
    file: &ShapeFile,
    decomposer: &Decomposer,
    global: &Global<'_>,
) -> Result<(), CliError> {
    let far =
        region.far_points(decomposer.metric(), global.progress()).map_err(|e| CliError::classify(&e))?;
    for point in &far {
        note(global, &point.describe());
    }
    for name in region.fields() {
        let values = region_field(file, decomposer, name).map_or_else(Vec::new, |(_, values)| values);
        let n_unknown = values.iter().filter(|value| value.is_nan()).count();
        if n_unknown > 0 {
            let vertices = count(n_unknown, "vertex, which is", "vertices, which are");
            note(global, &format!("the field '{name}' is NaN at {vertices} no part of its region"));
        }
    }
    Ok(())
}
