//! Files of features: tables, JSON, and spheres.

use super::values_file::unsuitable_format_among;
use super::{without_gzip, write_file, write_shape};
use crate::error::CliError;
use crate::global::Global;
use adwave::features::{Descriptor, Feature, spheres};
use adwave_io::{Field, FieldValues, Format, ShapeFile};
use adwave_render::ColorMap;
use adwave_report::Table;
use serde_json::{Value, json};
use std::path::Path;

/// Kind of a file of features.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum FeaturesFile {
    Csv,
    Json,
    Spheres,
}

impl FeaturesFile {
    /// The kind that the extension of a path asks for.
    pub(crate) fn from_path(path: &Path) -> Result<Self, CliError> {
        let extension = without_gzip(path).extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match (extension.as_deref(), Format::from_path(path)) {
            (Some("csv"), _) => Ok(Self::Csv),
            (Some("json"), _) => Ok(Self::Json),
            (_, Some(format)) if format.holds_fields() && format.holds_faces() => Ok(Self::Spheres),
            _ => Err(unsuitable_format_among(path, "features are", Format::holds_faces, &[".csv", ".json"])),
        }
    }
}

/// Features with their descriptors, if there are any, on bands with `n_levels` levels.
#[derive(Clone, Copy)]
pub(crate) struct FeatureList<'a> {
    pub(crate) features: &'a [Feature],
    pub(crate) descriptors: &'a [Descriptor],
    pub(crate) n_levels: usize,
}

impl FeatureList<'_> {
    /// Writes the features.
    pub(crate) fn write(&self, path: &Path, kind: FeaturesFile, global: &Global<'_>) -> Result<(), CliError> {
        match kind {
            FeaturesFile::Json => {
                let features: Vec<Value> = self.features.iter().map(feature_json).collect();
                write_file(global, path, format!("{:#}\n", json!({ "features": features })).as_bytes())
            }
            FeaturesFile::Csv => write_file(global, path, self.to_csv().as_bytes()),
            FeaturesFile::Spheres => write_shape(global, &self.to_spheres()?, path).map(|_| ()),
        }
    }

    fn to_csv(self) -> String {
        let head = ["vertex", "x", "y", "z", "level", "sigma", "response", "strength", "sign", "channel"];
        let mut table = Table::new("features.csv", "", &head);
        let n_numbers = self.descriptors.first().map_or(0, |d| d.len());
        table.head.extend((0..n_numbers).map(|k| format!("d{k}")));
        for (k, f) in self.features.iter().enumerate() {
            let mut row = vec![f.vertex.to_string()];
            row.extend(f.position.map_or(["", "", ""].map(str::to_owned), |p| p.map(|c| c.to_string())));
            row.push(f.level.to_string());
            row.extend([f.sigma, f.response, f.strength].map(|v| v.to_string()));
            row.extend([f.sign().to_string(), f.channel.map_or(String::new(), |c| c.to_string())]);
            row.extend(self.descriptors.get(k).into_iter().flatten().map(ToString::to_string));
            table.rows.push(row);
        }
        table.csv()
    }

    /// A sphere of radius σ for each feature, with its numbers as fields and colors by level.
    fn to_spheres(self) -> Result<ShapeFile, CliError> {
        let spheres = spheres(self.features);
        if spheres.points.is_empty() && !self.features.is_empty() {
            return Err(CliError::Input(
                "features of a graph have no positions; write them as .csv or .json".to_owned(),
            ));
        }
        let mut file = ShapeFile::from_mesh(spheres.points, spheres.faces);
        let values_of = |value: &dyn Fn(&Feature) -> f64| -> Vec<f64> {
            spheres.feature_of.iter().map(|&k| value(&self.features[k as usize])).collect()
        };
        let levels = values_of(&|f| f.level as f64);
        let color = ColorMap::from_name("turbo").expect("a name of the list").colors(
            &levels,
            1.0,
            self.n_levels as f64,
        );
        let numbers: [(&str, Vec<f64>); 5] = [
            ("vertex", values_of(&|f| f.vertex as f64)),
            ("level", levels),
            ("sigma", values_of(&|f| f.sigma)),
            ("response", values_of(&|f| f.response)),
            ("strength", values_of(&|f| f.strength)),
        ];
        for (name, values) in numbers {
            file.add_vertex_field(Field::new(name, 1, FieldValues::F64(values)))?;
        }
        file.add_vertex_field(Field::new("color", 3, FieldValues::U8(color)))?;
        Ok(file)
    }
}

/// A feature as an object.
pub(crate) fn feature_json(f: &Feature) -> Value {
    json!({
        "vertex": f.vertex, "position": f.position, "level": f.level, "sigma": f.sigma,
        "response": f.response, "strength": f.strength, "sign": f.sign(), "channel": f.channel,
    })
}
