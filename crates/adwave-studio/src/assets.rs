//! Files of the page, as built from `web`.

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Path, content type and content of each file.
const FILES: &[(&str, &str, &[u8])] = &[
    ("/", "text/html; charset=utf-8", include_bytes!("../web/dist/index.html")),
    ("/index.js", SCRIPT, include_bytes!("../web/dist/index.js")),
    ("/main.js", SCRIPT, include_bytes!("../web/dist/main.js")),
    ("/worker.js", SCRIPT, include_bytes!("../web/dist/worker.js")),
    (
        "/third-party-notices.txt",
        "text/plain; charset=utf-8",
        include_bytes!("../web/dist/third-party-notices.txt"),
    ),
    ("/studio.css", "text/css; charset=utf-8", include_bytes!("../web/dist/studio.css")),
];

/// Responds with the file at `path`.
pub(crate) fn asset_response(path: &str) -> Response {
    let path = if path == "/index.html" { "/" } else { path };
    match FILES.iter().find(|(name, ..)| *name == path) {
        Some((_, content_type, content)) => {
            ([(header::CONTENT_TYPE, HeaderValue::from_static(content_type))], *content).into_response()
        }
        None => (StatusCode::NOT_FOUND, "page not found\n").into_response(),
    }
}
