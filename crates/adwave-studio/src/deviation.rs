//! Signed distances from the edited shape to the shape of another tab.

use crate::prepared_shape::build_decomposer;
use crate::response::{ApiError, ApiResult, bytes_response_with_header, encode_f32};
use adwave::Progress;
use adwave::operator::OperatorKind;
use adwave::shape::{PreparedGeometry, Shape, WeldMode};
use adwave_io::{ShapeFile, file_normals};
use adwave_register::{ClosestPointSearch, Signs, Summary, signed_distances};
use serde::Deserialize;
use serde_json::json;

/// Body of `POST deviation`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct DeviationRequest {
    /// Number of the other shape.
    pub(crate) from: u64,
}

/// Responds with the signed distance of each vertex of `file` to the closest point of `other_file`, as `adwave diff`
/// measures it: positive where the other shape lies outside, NaN beyond a border. The header `X-Deviation` has a
/// summary.
pub(crate) fn deviation_response(
    file: &ShapeFile,
    other_file: &ShapeFile,
    progress: Progress<'_>,
) -> ApiResult {
    // The areas of the summary are those of the diffusion.
    let decomposer = build_decomposer(&shape_of(file)?, OperatorKind::Walk, progress)?;
    let geometry = decomposer.geometry_for("a comparison").map_err(|e| ApiError::from_classified(&e))?;
    let other = PreparedGeometry::new(&shape_of(other_file)?, WeldMode::default(), progress)
        .map_err(|e| ApiError::from_classified(&e))?;
    let surface = ClosestPointSearch::new(&other, progress)
        .map_err(|e| ApiError::from_classified(&e))?
        .ok_or_else(|| ApiError::bad_request("the other shape has no points"))?;
    let stored = [file, other_file].map(file_normals);
    let signs = Signs::choose([geometry, &other], [stored[0].as_deref(), stored[1].as_deref()], progress)
        .map_err(|e| ApiError::from_classified(&e))?;
    let distances = signed_distances(geometry.points(), &signs, &surface, f64::INFINITY, progress)
        .map_err(|e| ApiError::from_classified(&e))?;
    let values = geometry.vertex_map().scatter(&distances.values, 1);
    let summary = Summary::new(&values, 1, &decomposer.areas());
    // JSON has no NaN: a shape that lies beyond the borders of the other has no summary.
    let number = |x: f64| Some(x).filter(|x| x.is_finite());
    let description = json!({
        "signed": signs.is_signed(), "rms": number(summary.rms), "mean": number(summary.mean),
        "greatest": number(summary.greatest), "beyond_border": distances.n_beyond_border,
    });
    let content = encode_f32(values.len(), |x| values[x] as f32);
    Ok(bytes_response_with_header(content, "x-deviation", &description))
}

fn shape_of(file: &ShapeFile) -> Result<Shape, ApiError> {
    file.to_shape_as(file.kind()).map_err(|e| ApiError::bad_request(e.to_string()))
}
