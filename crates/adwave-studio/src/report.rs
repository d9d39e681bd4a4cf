//! Reports of edited shapes, each at its own address.

use crate::guard::generate_token;
use crate::prepared_shape::{analysis_operator, build_decomposer};
use crate::response::{ApiError, ApiResult, json_response};
use crate::server::Studio;
use crate::session::Session;
use adwave::features::feature_extent;
use adwave::{LevelSpec, ResolvedLevels};
use adwave_io::{DEGREE, ShapeFile, file_normals};
use adwave_report::shape_report::{COORDS, Subject, Viewpoint, shape_report};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::json;
use std::borrow::Cow;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of reports that remain available.
const MAX_REPORTS: usize = 4;
/// Content security policy, by which a report loads nothing.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// Reports by the random token in their address. A token is needed because a browser sends no header when a link is
/// opened.
#[derive(Debug, Default)]
pub(crate) struct Reports(Mutex<VecDeque<(String, Arc<str>)>>);

impl Reports {
    /// Stores a report and returns its path.
    fn store(&self, html: &str) -> Result<String, ApiError> {
        let to_error = |e: std::io::Error| ApiError::new(StatusCode::INTERNAL_SERVER_ERROR, e.to_string());
        let token = generate_token().map_err(to_error)?;
        let mut reports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        reports.push_back((token.clone(), html.into()));
        if reports.len() > MAX_REPORTS {
            reports.pop_front();
        }
        Ok(format!("report/{token}"))
    }

    /// Responds with the report of a token, or with an error if it has expired.
    pub(crate) fn page_response(&self, token: &str) -> Response {
        let reports = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match reports.iter().find(|(known, _)| known == token) {
            Some((_, html)) => {
                let content_type =
                    (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8"));
                let policy = HeaderName::from_static("content-security-policy");
                ([content_type, (policy, HeaderValue::from_static(POLICY))], html.to_string()).into_response()
            }
            None => (StatusCode::NOT_FOUND, "this report has expired; create it again in the studio\n")
                .into_response(),
        }
    }
}

/// Builds the report of an edited shape and responds with its path.
pub(crate) fn build_report(studio: &Studio, session: &Session, file: &ShapeFile) -> ApiResult {
    let shape = file.to_shape_as(file.kind()).map_err(|e| ApiError::bad_request(e.to_string()))?;
    // A graph without positions is described by the default signal of the command.
    let (signal, n_channels, values) = match (shape.points(), file.field(DEGREE)) {
        (None, Some(degree)) => (DEGREE, 1, Cow::Owned(degree.to_f64())),
        (points, _) => (COORDS, 3, Cow::Borrowed(points.unwrap_or_default().as_flattened())),
    };
    let progress = session.progress();
    let decomposer = build_decomposer(&shape, analysis_operator(&shape), progress)?;
    let levels = LevelSpec::Default.resolve(&decomposer, feature_extent(&decomposer));
    let ResolvedLevels { schedule, reason: levels_reason } =
        levels.map_err(|e| ApiError::from_classified(&e))?;
    let bands = decomposer.request(&values, n_channels, &schedule).progress(progress).bands();
    let bands = bands.map_err(|e| ApiError::from_classified(&e))?;
    let names: Vec<String> = file.field_names().into_iter().map(str::to_owned).collect();
    let normals = file_normals(file);
    let format = file.format().map_or_else(|| "built-in".to_owned(), |format| format.to_string());
    let subject = Subject {
        name: &session.workspace.name,
        format: &format,
        fields: &names,
        shape: &shape,
        grid: None,
        decomposer: &decomposer,
        signal,
        values: &values,
        normals: normals.as_deref(),
        bands: &bands,
        levels_reason: &levels_reason,
        command: "adwave studio",
        seconds: &[],
    };
    let report = shape_report(&subject, Viewpoint::default(), progress);
    let to_error = |_| ApiError::new(StatusCode::SERVICE_UNAVAILABLE, "the studio is shutting down");
    let path = studio.reports.store(&report.map_err(to_error)?.page.html())?;
    json_response(&json!({"path": path}))
}
