//! Responses of the server: arrays, JSON, or a one-line error message.

use crate::StudioError;
use adwave::{ClassifiedError, ErrorKind};
use adwave_deform::DeformError;
use axum::body::Body;
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rayon::prelude::*;
use serde::Serialize;

/// Rejected or failed request: its status and its message.
#[derive(Debug)]
pub(crate) struct ApiError {
    status: StatusCode,
    message: String,
    /// Additional fields of the JSON body, which the page needs to recover.
    fields: serde_json::Value,
}

impl ApiError {
    pub(crate) fn new(status: StatusCode, message: impl Into<String>) -> Self {
        Self { status, message: message.into(), fields: serde_json::Value::Null }
    }

    /// Reports a malformed request (status 400).
    pub(crate) fn bad_request(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, message)
    }

    /// Adds words at the beginning of the message.
    pub(crate) fn with_prefix(mut self, prefix: &str) -> Self {
        self.message.insert_str(0, prefix);
        self
    }

    /// Adds fields to the JSON body, next to `error`.
    pub(crate) fn with_fields(mut self, fields: serde_json::Value) -> Self {
        self.fields = fields;
        self
    }

    /// Derives the status from the kind of a library error.
    pub(crate) fn from_classified(error: &impl ClassifiedError) -> Self {
        let status = match error.kind() {
            ErrorKind::Input => StatusCode::BAD_REQUEST,
            ErrorKind::Memory => StatusCode::PAYLOAD_TOO_LARGE,
            ErrorKind::Cancelled => StatusCode::SERVICE_UNAVAILABLE,
            _ => StatusCode::INTERNAL_SERVER_ERROR,
        };
        Self::new(status, error.to_string())
    }
}

impl From<DeformError> for ApiError {
    fn from(error: DeformError) -> Self {
        Self::from_classified(&error)
    }
}

impl From<StudioError> for ApiError {
    fn from(error: StudioError) -> Self {
        Self::from_classified(&error)
    }
}

impl From<ApiError> for StudioError {
    fn from(error: ApiError) -> Self {
        let kind = match error.status {
            StatusCode::PAYLOAD_TOO_LARGE => ErrorKind::Memory,
            StatusCode::SERVICE_UNAVAILABLE => ErrorKind::Cancelled,
            status if status.is_server_error() => ErrorKind::Machine,
            _ => ErrorKind::Input,
        };
        Self::Method { kind, text: error.message }
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut content = serde_json::json!({"error": self.message});
        if let (Some(object), serde_json::Value::Object(fields)) = (content.as_object_mut(), self.fields) {
            object.extend(fields);
        }
        (self.status, axum::Json(content)).into_response()
    }
}

/// Response, or the error that is sent instead.
pub(crate) type ApiResult = Result<Response, ApiError>;

/// Builds a JSON response.
#[expect(clippy::unnecessary_wraps, reason = "the last expression of most handlers, which may fail earlier")]
pub(crate) fn json_response(content: &impl Serialize) -> ApiResult {
    Ok(axum::Json(content).into_response())
}

/// Builds a binary response.
pub(crate) fn bytes_response(content: impl Into<Body>) -> Response {
    let content_type = HeaderValue::from_static("application/octet-stream");
    ([(header::CONTENT_TYPE, content_type)], content.into()).into_response()
}

/// Builds a binary response with JSON in one additional header. The JSON is ASCII, because browsers read headers as
/// Latin-1.
pub(crate) fn bytes_response_with_header(
    content: Vec<u8>,
    name: &'static str,
    value: &serde_json::Value,
) -> Response {
    let mut response = bytes_response(content);
    if let Ok(value) = HeaderValue::from_str(&to_ascii_json(value)) {
        response.headers_mut().insert(HeaderName::from_static(name), value);
    }
    response
}

/// Writes JSON with `\u` escapes for all characters beyond ASCII.
fn to_ascii_json(value: &serde_json::Value) -> String {
    let mut ascii = String::new();
    for c in value.to_string().chars() {
        if c.is_ascii() && c != '\u{7f}' {
            ascii.push(c);
        } else {
            let mut units = [0; 2];
            for unit in c.encode_utf16(&mut units) {
                ascii.push_str(&format!("\\u{unit:04x}"));
            }
        }
    }
    ascii
}

/// Number of rows that one thread encodes at a time.
const ROWS_PER_CHUNK: usize = 1 << 14;

/// Encodes `n` values in single precision, little-endian.
pub(crate) fn encode_f32(n: usize, value: impl Fn(usize) -> f32 + Sync) -> Vec<u8> {
    encode_rows(n, 4, |x, row| row.copy_from_slice(&value(x).to_le_bytes()))
}

/// Encodes `n` rows of `width` bytes each, in parallel.
pub(crate) fn encode_rows(n: usize, width: usize, encode: impl Fn(usize, &mut [u8]) + Sync) -> Vec<u8> {
    let mut out = vec![0; n * width];
    out.par_chunks_mut(ROWS_PER_CHUNK * width).enumerate().for_each(|(chunk, bytes)| {
        for (x, row) in (chunk * ROWS_PER_CHUNK..).zip(bytes.chunks_exact_mut(width)) {
            encode(x, row);
        }
    });
    out
}

/// Encodes positions relative to `center` as `f32 × 3 × n`.
pub(crate) fn encode_points(points: &[[f64; 3]], center: [f64; 3]) -> Vec<u8> {
    encode_rows(points.len(), 12, |x, row| {
        for c in 0..3 {
            row[4 * c..][..4].copy_from_slice(&((points[x][c] - center[c]) as f32).to_le_bytes());
        }
    })
}
