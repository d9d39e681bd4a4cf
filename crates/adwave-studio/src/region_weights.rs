//! Weights of regions. A vertex at which a field has no value is outside the regions of that field.

use adwave::region::{BrushStroke, Region, RegionError, RegionWeights};
use adwave::{Decomposer, Progress};
use adwave_io::{ShapeFile, region_field};

/// Last letter of the name of a field whose weight falls with its values.
const FALLING: char = '\u{0}';

/// Computes the weights of a region of a shape with the fields of `file`.
pub(crate) fn region_weights(
    region: &Region,
    file: &ShapeFile,
    decomposer: &Decomposer,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    let names: Vec<String> = file.field_names().into_iter().map(str::to_owned).collect();
    let mut marked = region.clone();
    mark_falling(&mut marked);
    let lookup = |name: &str| {
        let (name, lowest) = match name.strip_suffix(FALLING) {
            Some(name) => (name, f64::MAX),
            None => (name, f64::MIN),
        };
        let (n_channels, mut values) = region_field(file, decomposer, name)?;
        for value in values.iter_mut().filter(|value| value.is_nan()) {
            *value = lowest;
        }
        Some((n_channels, values))
    };
    marked.weights(decomposer.metric(), &lookup, &names, progress).map_err(without_marks)
}

/// Marks the names of fields whose weight falls with their values.
fn mark_falling(region: &mut Region) {
    match region {
        Region::Field { name, low, high } if *high < *low => name.push(FALLING),
        Region::Grown { region, .. }
        | Region::Blurred { region, .. }
        | Region::Faded { region, .. }
        | Region::Not(region) => mark_falling(region),
        Region::Painted(strokes) => strokes.iter_mut().for_each(|stroke| match stroke {
            BrushStroke::Add(region) | BrushStroke::Subtract(region) | BrushStroke::Smooth { region, .. } => {
                mark_falling(region);
            }
        }),
        Region::Any(regions) | Region::All(regions) => regions.iter_mut().for_each(mark_falling),
        _ => {}
    }
}

/// The error with the name of the field as it was given.
fn without_marks(error: RegionError) -> RegionError {
    let plain = |name: String| name.trim_end_matches(FALLING).to_owned();
    match error {
        RegionError::NoSuchField { name, available } => {
            RegionError::NoSuchField { name: plain(name), available }
        }
        RegionError::NotScalar { name, n_values, n_vertices } => {
            RegionError::NotScalar { name: plain(name), n_values, n_vertices }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::shape::{PointCloud, Shape};
    use adwave_io::{Field, FieldValues};

    #[test]
    fn vertices_without_a_value_are_outside_of_rising_and_of_falling_fields() {
        let points: Vec<[f64; 3]> = (0..20).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        let mut file = ShapeFile::from_cloud(points.clone());
        let values = (0..20).map(|k| if k == 3 { f64::NAN } else { f64::from(k) }).collect();
        file.add_vertex_field(Field::new("t", 1, FieldValues::F64(values))).unwrap();
        let decomposer = Decomposer::new(&Shape::Cloud(PointCloud::new(points).unwrap()));
        let weights = |region: &Region| {
            let weights = region_weights(region, &file, &decomposer, Progress::none()).unwrap();
            weights.to_vertices(decomposer.geometry().vertex_map())
        };
        let rising = Region::Field { name: "t".to_owned(), low: 0.0, high: 10.0 };
        let falling = Region::Field { name: "t".to_owned(), low: 10.0, high: 0.0 };
        assert_eq!(weights(&rising)[2..5], [0.2, 0.0, 0.4]);
        assert_eq!(weights(&falling)[2..5], [0.8, 0.0, 0.6]);
        let both = Region::Any(vec![rising, Region::Faded { factor: 0.5, region: Box::new(falling) }]);
        assert_eq!(weights(&both)[2..5], [0.4, 0.0, 0.4]);
        let unknown = Region::Field { name: "u".to_owned(), low: 1.0, high: 0.0 };
        let error = region_weights(&unknown, &file, &decomposer, Progress::none()).unwrap_err();
        assert!(matches!(error, RegionError::NoSuchField { name, .. } if name == "u"));
    }
}
