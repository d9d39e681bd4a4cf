//! Brain models in the XML of a CIFTI: the assignment of rows and columns.

use std::sync::Arc;

use adwave::Progress;
use roxmltree::{Document, Node};

use super::write::CiftiColumns;
use crate::model::label_table::LabelTable;
use crate::model::numbers::{NumberError, from_text};
use crate::text::one_line;
use crate::{FieldValues, ReadError, ValueType};

/// Vertices of one surface among the rows.
pub(super) struct BrainModel {
    /// Name of the structure, such as `CORTEX_LEFT`.
    pub(super) structure: String,
    pub(super) n_vertices: u64,
    /// Index of its first row, and the vertex of each row.
    pub(super) first: u64,
    pub(super) vertices: Vec<u32>,
}

/// Voxels of one structure among the rows.
pub(super) struct VoxelModel {
    /// Name of the structure, such as `THALAMUS_LEFT`.
    pub(super) structure: String,
    /// Index of its first row, and the indices i, j, k of the voxel of each row.
    pub(super) first: u64,
    pub(super) indices: Vec<[u32; 3]>,
}

/// Sizes of the volume of the voxels, and the affine matrix that maps their indices to millimeters.
pub(super) struct CiftiVolume {
    pub(super) sizes: [u32; 3],
    pub(super) matrix: [[f64; 4]; 3],
}

/// Surfaces and voxels among the rows, and the meaning and names of the columns.
pub(super) struct CiftiMaps {
    pub(super) models: Vec<BrainModel>,
    pub(super) voxels: Vec<VoxelModel>,
    /// Place of the voxels, if the file states it in full.
    pub(super) volume: Option<CiftiVolume>,
    /// Meaning of the columns; `None` for labels and others that are not written.
    pub(super) columns: Option<CiftiColumns>,
    /// Seconds from column to column of a series.
    pub(super) step: Option<f64>,
    /// Names of the columns if they have any.
    pub(super) names: Option<Vec<String>>,
    /// Names and colors of the labels of each column; empty without labels.
    pub(super) labels: Vec<Option<Arc<LabelTable>>>,
}

fn broken(what: &str) -> ReadError {
    ReadError::Whole(format!("the XML of the CIFTI {what}; save the file again"))
}

fn number(node: Node<'_, '_>, name: &str) -> Result<u64, ReadError> {
    let text = node.attribute(name).ok_or_else(|| broken(&format!("has no {name}")))?;
    text.trim().parse().map_err(|_| broken(&format!("has a {name} that is not a number")))
}

/// Parses the XML.
pub(super) fn maps(xml: &[u8], progress: Progress<'_>) -> Result<CiftiMaps, ReadError> {
    // The extension is padded with zeros.
    let end = xml.iter().rposition(|&b| b != 0).map_or(0, |last| last + 1);
    let text = std::str::from_utf8(&xml[..end]).map_err(|_| broken("is not UTF-8"))?;
    let document = Document::parse(text).map_err(|e| broken(&format!("is malformed ({})", one_line(&e))))?;
    let mut rows = None;
    let (mut columns, mut names, mut step, mut labels) = (None, None, None, Vec::new());
    for map in document.descendants().filter(|node| node.has_tag_name("MatrixIndicesMap")) {
        let dimension = map.attribute("AppliesToMatrixDimension").unwrap_or("");
        match map.attribute("IndicesMapToDataType") {
            Some("CIFTI_INDEX_TYPE_BRAIN_MODELS") if dimension.trim() == "1" => rows = Some(map),
            Some("CIFTI_INDEX_TYPE_SERIES") if dimension.trim() == "0" => {
                columns = Some(CiftiColumns::Series);
                step = series_step(map);
            }
            Some(kind @ ("CIFTI_INDEX_TYPE_SCALARS" | "CIFTI_INDEX_TYPE_LABELS"))
                if dimension.trim() == "0" =>
            {
                columns = (kind == "CIFTI_INDEX_TYPE_SCALARS").then_some(CiftiColumns::Scalars);
                let maps = map.children().filter(|node| node.has_tag_name("NamedMap"));
                let name = |map: Node<'_, '_>| {
                    let name = map.children().find(|node| node.has_tag_name("MapName"))?;
                    name.text().map(|text| text.trim().to_owned())
                };
                let table = |map: Node<'_, '_>| {
                    map.children().find(|node| node.has_tag_name("LabelTable")).and_then(LabelTable::from_xml)
                };
                labels = maps.clone().map(table).collect();
                names = Some(maps.map(|map| name(map).unwrap_or_default()).collect());
            }
            _ => {}
        }
    }
    let Some(rows) = rows else {
        return Err(ReadError::Whole(
            "this CIFTI has no rows for vertices; use dense scalars, series or labels".into(),
        ));
    };
    let of_type = |kind: &'static str| {
        rows.children()
            .filter(move |node| node.has_tag_name("BrainModel") && node.attribute("ModelType") == Some(kind))
    };
    let surfaces = of_type("CIFTI_MODEL_TYPE_SURFACE").map(|node| model(node, progress));
    let models = surfaces.collect::<Result<_, _>>()?;
    let voxels = of_type("CIFTI_MODEL_TYPE_VOXELS").map(|node| voxel_model(node, progress));
    let voxels = voxels.collect::<Result<_, _>>()?;
    let volume = rows.children().find(|node| node.has_tag_name("Volume")).and_then(volume);
    Ok(CiftiMaps { models, voxels, volume, columns, step, names, labels })
}

/// The volume of the voxels, in millimeters; `None` unless all of its numbers are there.
fn volume(node: Node<'_, '_>) -> Option<CiftiVolume> {
    let sizes: Vec<u32> = node
        .attribute("VolumeDimensions")?
        .split(',')
        .map(|size| size.trim().parse().ok())
        .collect::<Option<_>>()?;
    let matrix =
        node.children().find(|node| node.has_tag_name("TransformationMatrixVoxelIndicesIJKtoXYZ"))?;
    let exponent: f64 = matrix.attribute("MeterExponent").unwrap_or("-3").trim().parse().ok()?;
    let numbers: Vec<f64> = matrix
        .text()?
        .split_whitespace()
        .map(|number| number.parse().ok().filter(|number: &f64| number.is_finite()))
        .collect::<Option<_>>()?;
    let to_millimeters = 10_f64.powf(exponent + 3.0);
    let row = |k: usize| -> Option<[f64; 4]> {
        let row: [f64; 4] = numbers.get(4 * k..4 * k + 4)?.try_into().ok()?;
        Some(row.map(|number| number * to_millimeters))
    };
    let matrix = [row(0)?, row(1)?, row(2)?];
    let is_finite = matrix.iter().flatten().all(|number| number.is_finite());
    Some(CiftiVolume { sizes: sizes.try_into().ok()?, matrix }).filter(|_| is_finite)
}

/// Seconds from point to point of a series over time.
fn series_step(map: Node<'_, '_>) -> Option<f64> {
    let number = |name: &str| map.attribute(name)?.trim().parse::<f64>().ok();
    let is_time = map.attribute("SeriesUnit").is_none_or(|unit| unit.trim() == "SECOND");
    let power = number("SeriesExponent").unwrap_or(0.0);
    number("SeriesStep").filter(|_| is_time).map(|step| step * 10_f64.powf(power))
}

/// Whole numbers in the text of the child of that name.
fn whole_numbers(node: Node<'_, '_>, name: &str, progress: Progress<'_>) -> Result<Vec<u32>, ReadError> {
    let list = node.children().find(|node| node.has_tag_name(name)).and_then(|node| node.text());
    match from_text(list.unwrap_or("").as_bytes(), ValueType::U32, progress) {
        Ok(FieldValues::U32(numbers)) => Ok(numbers),
        Err(NumberError::Cancelled(cancelled)) => Err(cancelled.into()),
        _ => Err(broken(&format!("has numbers in {name} that are not whole"))),
    }
}

fn structure(node: Node<'_, '_>) -> String {
    node.attribute("BrainStructure").unwrap_or("").trim_start_matches("CIFTI_STRUCTURE_").to_owned()
}

fn voxel_model(node: Node<'_, '_>, progress: Progress<'_>) -> Result<VoxelModel, ReadError> {
    let numbers = whole_numbers(node, "VoxelIndicesIJK", progress)?;
    let (indices, rest) = numbers.as_chunks::<3>();
    if !rest.is_empty() || indices.len() as u64 != number(node, "IndexCount")? {
        return Err(broken("has another number of voxels than it states"));
    }
    Ok(VoxelModel {
        structure: structure(node),
        first: number(node, "IndexOffset")?,
        indices: indices.to_vec(),
    })
}

fn model(node: Node<'_, '_>, progress: Progress<'_>) -> Result<BrainModel, ReadError> {
    let vertices = whole_numbers(node, "VertexIndices", progress)?;
    let n_vertices = number(node, "SurfaceNumberOfVertices")?;
    if vertices.len() as u64 != number(node, "IndexCount")? {
        return Err(broken("has another number of vertices than it states"));
    }
    if let Some(vertex) = vertices.iter().find(|&&v| u64::from(v) >= n_vertices) {
        return Err(broken(&format!("names vertex {vertex}, but there are {n_vertices}")));
    }
    Ok(BrainModel { structure: structure(node), n_vertices, first: number(node, "IndexOffset")?, vertices })
}
