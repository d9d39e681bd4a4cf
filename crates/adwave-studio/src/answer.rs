//! What a request is answered with: arrays, JSON, or one line that says what is wrong.

use crate::StudioError;
use adwave::{ClassifiedError, ErrorKind};
use axum::body::Body;
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rayon::prelude::*;
use serde::Serialize;

/// A request that is not done, and why.
#[derive(Debug)]
pub(crate) struct Refused {
    status: StatusCode,
    text: String,
    /// What the page needs to go on, beside the text.
    beside: serde_json::Value,
}

impl Refused {
    pub(crate) fn new(status: StatusCode, text: impl Into<String>) -> Self {
        Self { status, text: text.into(), beside: serde_json::Value::Null }
    }

    /// The request is wrong.
    pub(crate) fn wrong(text: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, text)
    }

    pub(crate) fn with(mut self, beside: serde_json::Value) -> Self {
        self.beside = beside;
        self
    }

    pub(crate) fn of(error: &impl ClassifiedError) -> Self {
        let status = match error.kind() {
            ErrorKind::Input => StatusCode::BAD_REQUEST,
            ErrorKind::Memory => StatusCode::PAYLOAD_TOO_LARGE,
            ErrorKind::Machine => StatusCode::INTERNAL_SERVER_ERROR,
            ErrorKind::Cancelled => StatusCode::SERVICE_UNAVAILABLE,
        };
        Self::new(status, error.to_string())
    }
}

impl From<StudioError> for Refused {
    fn from(error: StudioError) -> Self {
        Self::of(&error)
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        let mut content = serde_json::json!({"error": self.text});
        if let (Some(object), serde_json::Value::Object(beside)) = (content.as_object_mut(), self.beside) {
            object.extend(beside);
        }
        (self.status, axum::Json(content)).into_response()
    }
}

pub(crate) type Answer = Result<Response, Refused>;

/// JSON.
#[expect(clippy::unnecessary_wraps, reason = "the last word of most requests, which may be refused")]
pub(crate) fn json(content: &impl Serialize) -> Answer {
    Ok(axum::Json(content).into_response())
}

/// Bytes as they are.
pub(crate) fn bytes(content: impl Into<Body>) -> Response {
    let kind = HeaderValue::from_static("application/octet-stream");
    ([(header::CONTENT_TYPE, kind)], content.into()).into_response()
}

/// The same with one header more.
pub(crate) fn bytes_with(content: Vec<u8>, name: &'static str, value: &str) -> Response {
    let mut answer = bytes(content);
    if let Ok(value) = HeaderValue::from_bytes(value.as_bytes()) {
        answer.headers_mut().insert(HeaderName::from_static(name), value);
    }
    answer
}

/// Rows that a thread turns into bytes at a time.
const AT_A_TIME: usize = 1 << 14;

/// Single precision, little-endian.
pub(crate) fn f32_bytes(n: usize, value: impl Fn(usize) -> f32 + Sync) -> Vec<u8> {
    rows(n, 4, |x, row| row.copy_from_slice(&value(x).to_le_bytes()))
}

/// Bytes of `n` rows, each `width` bytes long.
pub(crate) fn rows(n: usize, width: usize, row: impl Fn(usize, &mut [u8]) + Sync) -> Vec<u8> {
    let mut out = vec![0; n * width];
    out.par_chunks_mut(AT_A_TIME * width).enumerate().for_each(|(chunk, part)| {
        for (x, bytes) in (chunk * AT_A_TIME..).zip(part.chunks_exact_mut(width)) {
            row(x, bytes);
        }
    });
    out
}

/// Positions relative to a point.
pub(crate) fn points_bytes(points: &[[f64; 3]], center: [f64; 3]) -> Vec<u8> {
    rows(points.len(), 12, |x, row| {
        for c in 0..3 {
            row[4 * c..][..4].copy_from_slice(&((points[x][c] - center[c]) as f32).to_le_bytes());
        }
    })
}
