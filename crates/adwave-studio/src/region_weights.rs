//! Weights of regions with the fields of a file.

use adwave::region::{Region, RegionError, RegionWeights};
use adwave::{Decomposer, Progress};
use adwave_io::{ShapeFile, region_field};

/// Computes the weights of a region of a shape with the fields of `file`.
pub(crate) fn region_weights(
    region: &Region,
    file: &ShapeFile,
    decomposer: &Decomposer,
    progress: Progress<'_>,
) -> Result<RegionWeights, RegionError> {
    let names: Vec<String> = file.field_names().into_iter().map(str::to_owned).collect();
    let lookup = |name: &str| region_field(file, decomposer, name);
    region.weights(decomposer.metric(), &lookup, &names, progress)
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
            weights.to_vertices(decomposer.vertex_map())
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
