//! Brain models in the XML of a CIFTI: the assignment of rows and columns.

use adwave::Progress;
use roxmltree::{Document, Node};

use super::write::CiftiColumns;
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

/// Surfaces among the rows, and the meaning and names of the columns.
pub(super) struct CiftiMaps {
    pub(super) models: Vec<BrainModel>,
    /// Meaning of the columns; `None` for labels and others that are not written.
    pub(super) columns: Option<CiftiColumns>,
    /// Seconds from column to column of a series.
    pub(super) step: Option<f64>,
    /// Names of the columns if they have any.
    pub(super) names: Option<Vec<String>>,
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
    let (mut columns, mut names, mut step) = (None, None, None);
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
    let models = rows.children().filter(|node| {
        node.has_tag_name("BrainModel") && node.attribute("ModelType") == Some("CIFTI_MODEL_TYPE_SURFACE")
    });
    let models = models.map(|node| model(node, progress)).collect::<Result<_, _>>()?;
    Ok(CiftiMaps { models, columns, step, names })
}

/// Seconds from point to point of a series over time.
fn series_step(map: Node<'_, '_>) -> Option<f64> {
    let number = |name: &str| map.attribute(name)?.trim().parse::<f64>().ok();
    let is_time = map.attribute("SeriesUnit").is_none_or(|unit| unit.trim() == "SECOND");
    let power = number("SeriesExponent").unwrap_or(0.0);
    number("SeriesStep").filter(|_| is_time).map(|step| step * 10_f64.powf(power))
}

fn model(node: Node<'_, '_>, progress: Progress<'_>) -> Result<BrainModel, ReadError> {
    let structure = node.attribute("BrainStructure").unwrap_or("").trim_start_matches("CIFTI_STRUCTURE_");
    let list = node.children().find(|node| node.has_tag_name("VertexIndices")).and_then(|node| node.text());
    let vertices = match from_text(list.unwrap_or("").as_bytes(), ValueType::U32, progress) {
        Ok(FieldValues::U32(vertices)) => vertices,
        Err(NumberError::Cancelled(cancelled)) => return Err(cancelled.into()),
        _ => return Err(broken("has a vertex that is not a number")),
    };
    let n_vertices = number(node, "SurfaceNumberOfVertices")?;
    if vertices.len() as u64 != number(node, "IndexCount")? {
        return Err(broken("has another number of vertices than it states"));
    }
    if let Some(vertex) = vertices.iter().find(|&&v| u64::from(v) >= n_vertices) {
        return Err(broken(&format!("names vertex {vertex}, but there are {n_vertices}")));
    }
    Ok(BrainModel {
        structure: structure.to_owned(),
        n_vertices,
        first: number(node, "IndexOffset")?,
        vertices,
    })
}
