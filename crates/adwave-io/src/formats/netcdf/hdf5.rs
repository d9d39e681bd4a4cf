//! Variables of NetCDF-4, which is HDF5.
//!
//! The dimensions of a variable are the datasets of the class `DIMENSION_SCALE`, by the numbers that the library of
//! NetCDF writes with each variable, else by their sizes.

use hdf5_pure::{AttrValue, DType, Dataset, File};

use crate::formats::netcdf::variables::{Attribute, Content, Dimension, Place, Variable};
use crate::model::units::show;
use crate::{ReadError, ValueType};

/// Largest number of variables.
const MAX_VARIABLES: usize = 10_000;

/// Error of the library as one line.
pub(super) fn unreadable(what: &str, error: &dyn std::fmt::Display) -> ReadError {
    let error: String = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    ReadError::Whole(format!("{} cannot be read from the HDF5 ({error}); get the whole file", show(what)))
}

fn attribute(value: &AttrValue) -> Option<Attribute> {
    if let Some(texts) = value.as_strings() {
        return texts.first().map(|text| Attribute::Text(text.trim_end_matches('\0').to_owned()));
    }
    let integers = || Some(value.to_i64s()?.iter().map(|v| *v as f64).collect());
    value.to_f64s().or_else(integers).map(Attribute::Numbers)
}

/// Number type of a dataset that holds numbers.
fn value_type(dtype: &DType) -> Option<ValueType> {
    Some(match dtype {
        DType::F32 => ValueType::F32,
        DType::F64 => ValueType::F64,
        DType::I8 => ValueType::I8,
        DType::I16 => ValueType::I16,
        DType::I32 => ValueType::I32,
        DType::I64 => ValueType::I64,
        DType::U8 => ValueType::U8,
        DType::U16 => ValueType::U16,
        DType::U32 => ValueType::U32,
        DType::U64 => ValueType::U64,
        _ => return None,
    })
}

/// A dataset of the root with its sizes and attributes.
struct RootDataset {
    name: String,
    shape: Vec<u64>,
    attributes: Vec<(String, Attribute)>,
    kind: Option<ValueType>,
}

impl RootDataset {
    fn read(name: String, dataset: &Dataset) -> Option<Self> {
        let (shape, dtype) = (dataset.shape().ok()?, dataset.dtype().ok()?);
        // References among the attributes are of no use here.
        let attributes = dataset.attrs().unwrap_or_default();
        let mut attributes: Vec<_> =
            attributes.iter().filter_map(|(name, value)| Some((name.clone(), attribute(value)?))).collect();
        attributes.sort_by(|a, b| a.0.cmp(&b.0));
        Some(Self { name, shape, attributes, kind: value_type(&dtype) })
    }

    fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, value)| value)
    }

    fn text(&self, name: &str) -> Option<&str> {
        if let Attribute::Text(text) = self.attribute(name)? { Some(text) } else { None }
    }

    fn numbers(&self, name: &str) -> Option<&[f64]> {
        if let Attribute::Numbers(numbers) = self.attribute(name)? { Some(numbers) } else { None }
    }

    fn is_scale(&self) -> bool {
        self.text("CLASS").is_some_and(|class| class == "DIMENSION_SCALE")
    }

    /// True for a dimension that has no values of its own.
    fn is_bare_dimension(&self) -> bool {
        self.text("NAME").is_some_and(|name| name.starts_with("This is a netCDF dimension but not"))
    }
}

/// Attributes and variables of the root of a NetCDF-4.
pub(super) fn read_root(file: &File) -> Result<Content, ReadError> {
    let root = file.root();
    let mut names = root.datasets().map_err(|error| unreadable("the list of variables", &error))?;
    names.sort_unstable();
    if names.len() > MAX_VARIABLES {
        let found = names.len() as u64;
        return Err(ReadError::Limit { what: "variables", found, limit: MAX_VARIABLES as u64 });
    }
    let mut datasets = Vec::new();
    for name in names {
        let dataset = file.dataset(&name).map_err(|error| unreadable(&name, &error))?;
        datasets.extend(RootDataset::read(name, &dataset));
    }
    let scales: Vec<&RootDataset> = datasets.iter().filter(|dataset| dataset.is_scale()).collect();
    let axis_name = |dataset: &RootDataset, axis: usize, size: u64| -> String {
        if dataset.is_scale() && dataset.shape.len() == 1 {
            return dataset.name.clone();
        }
        let id = dataset.numbers("_Netcdf4Coordinates").and_then(|ids| ids.get(axis));
        let by_id = id.and_then(|id| {
            scales
                .iter()
                .find(|scale| scale.numbers("_Netcdf4Dimid").is_some_and(|own| own.first() == Some(id)))
        });
        let found = by_id.or_else(|| scales.iter().find(|scale| scale.shape == [size]));
        found.map_or_else(|| format!("axis {axis}"), |scale| scale.name.clone())
    };
    let variables = datasets.iter().filter(|dataset| !dataset.is_bare_dimension()).map(|dataset| {
        let axes = dataset.shape.iter().enumerate();
        Variable {
            name: dataset.name.clone(),
            axes: axes.map(|(k, &size)| Dimension { name: axis_name(dataset, k, size), size }).collect(),
            attributes: dataset.attributes.clone(),
            kind: dataset.kind,
            place: Place::Dataset,
        }
    });
    let variables = variables.collect();
    let attributes = root.attrs().unwrap_or_default();
    let attributes = attributes.iter().filter_map(|(name, value)| Some((name.clone(), attribute(value)?)));
    Ok(Content { attributes: attributes.collect(), variables })
}

/// Values of a dataset, of which there must be `n`.
pub(super) fn read_values(file: &File, name: &str, n: u64) -> Result<Vec<f64>, ReadError> {
    let dataset = file.dataset(name).map_err(|error| unreadable(name, &error))?;
    let values = dataset.read_f64().map_err(|error| unreadable(name, &error))?;
    if values.len() as u64 != n {
        return Err(unreadable(name, &format!("{} of {n} values", values.len())));
    }
    Ok(values)
}
