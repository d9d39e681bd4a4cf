//! The report of the edited shape, at an address of its own.

use crate::answer::{Answer, Refused, json};
use crate::guard::random_word;
use crate::server::Studio;
use crate::session::Session;
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave_io::{ShapeFile, file_normals};
use adwave_report::shape_report::{COORDS, Subject, Viewpoint, shape_report};
use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::json;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Reports that are kept, the last ones.
const KEPT: usize = 4;
/// What a report may do: nothing but show what it has within itself.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// Reports by the random word in their address: a browser sends no token when a page is opened.
#[derive(Debug, Default)]
pub(crate) struct Reports(Mutex<VecDeque<(String, Arc<str>)>>);

impl Reports {
    /// Keeps a report, and says where it is.
    fn keep(&self, html: &str) -> Result<String, Refused> {
        let told = |e: std::io::Error| Refused::new(StatusCode::INTERNAL_SERVER_ERROR, e.to_string());
        let word = random_word().map_err(told)?;
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.push_back((word.clone(), html.into()));
        if kept.len() > KEPT {
            kept.pop_front();
        }
        Ok(format!("report/{word}"))
    }

    /// The report of an address.
    pub(crate) fn page(&self, word: &str) -> Response {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match kept.iter().find(|(known, _)| known == word) {
            Some((_, html)) => {
                let kind = (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8"));
                let policy = HeaderName::from_static("content-security-policy");
                ([kind, (policy, HeaderValue::from_static(POLICY))], html.to_string()).into_response()
            }
            None => {
                (StatusCode::NOT_FOUND, "this report is not kept any more; make it again\n").into_response()
            }
        }
    }
}

/// Makes the report of the shape after an edit.
pub(crate) fn report(studio: &Studio, session: &Session, file: &ShapeFile) -> Answer {
    let shape = file.to_shape_as(file.kind()).map_err(|e| Refused::wrong(e.to_string()))?;
    let points = shape.points().unwrap_or_default();
    let walk = Decomposer::new(&shape);
    let (n_levels, why) = walk.default_levels();
    let schedule = Schedule::dyadic(n_levels).map_err(|e| Refused::of(&e))?;
    let progress = session.progress();
    let bands = walk.request(points.as_flattened(), 3, &schedule).progress(progress).bands();
    let bands = bands.map_err(|e| Refused::of(&e))?;
    let names: Vec<String> = file.field_names().into_iter().map(str::to_owned).collect();
    let normals = file_normals(file);
    let format = file.format().map_or_else(|| "built-in".to_owned(), |format| format.to_string());
    let subject = Subject {
        name: &session.opened.name,
        format: &format,
        fields: &names,
        shape: &shape,
        decomposer: &walk,
        signal: COORDS,
        values: points.as_flattened(),
        normals: normals.as_deref(),
        bands: &bands,
        levels_reason: &why,
        command: "adwave studio",
        seconds: &[],
    };
    let made = shape_report(&subject, Viewpoint::default(), progress);
    let stopped = |_| Refused::new(StatusCode::SERVICE_UNAVAILABLE, "the studio ends");
    let path = studio.reports.keep(&made.map_err(stopped)?.page.html())?;
    json(&json!({"path": path}))
}
