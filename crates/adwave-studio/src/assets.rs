//! The page, as it was built from `web`.

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Path, kind, and content of each file.
const FILES: &[(&str, &str, &[u8])] = &[
    ("/", "text/html; charset=utf-8", include_bytes!("../web/dist/index.html")),
    ("/index.js", SCRIPT, include_bytes!("../web/dist/index.js")),
    ("/main.js", SCRIPT, include_bytes!("../web/dist/main.js")),
    ("/worker.js", SCRIPT, include_bytes!("../web/dist/worker.js")),
    ("/studio.css", "text/css; charset=utf-8", include_bytes!("../web/dist/studio.css")),
];

/// The file of that path.
pub(crate) fn file(path: &str) -> Response {
    let path = if path == "/index.html" { "/" } else { path };
    match FILES.iter().find(|(name, ..)| *name == path) {
        Some((_, kind, content)) => {
            ([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], *content).into_response()
        }
        None => (StatusCode::NOT_FOUND, "there is no such page\n").into_response(),
    }
}
