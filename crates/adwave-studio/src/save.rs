//! Writing of the edited shape: next to the opened file, or as a download.

use crate::response::{ApiError, ApiResult, bytes_response, json_response};
use crate::session::Session;
use crate::workspace::Workspace;
use adwave::Progress;
use adwave_io::{Format, write_bytes_with, write_path};
use axum::http::StatusCode;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

/// Body of `POST save`.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SaveRequest {
    /// File name without folders; `NAME-edited.EXT` if `None`.
    name: Option<String>,
    /// True to permit the replacement of an existing file.
    #[serde(default)]
    replace: bool,
    /// Type of the numbers of an image or a volume, such as `f32`; that of its file if `None`.
    #[serde(default)]
    pub(crate) value_type: Option<String>,
}

/// Writes the edited shape with all other content of its file, and responds with the path.
pub(crate) fn save(session: &Session, request: &SaveRequest) -> ApiResult {
    if request.value_type.is_some() {
        let message = "the type of numbers is chosen for images and volumes alone; leave out value_type";
        return Err(ApiError::bad_request(message));
    }
    let path = target_path(&session.workspace, default_name(session), request)?;
    let mut prepared = session.lock_prepared()?;
    let file = session.saved_file(&mut prepared)?;
    drop(prepared);
    let report = write_path(&file, &path, None).map_err(|e| ApiError::from_classified(&e))?;
    saved_response(&session.workspace, path, &format_losses(&report.not_written))
}

/// Responds with the path of a file that was written, which may be overwritten from now on.
pub(crate) fn saved_response(workspace: &Workspace, path: PathBuf, notes: &[String]) -> ApiResult {
    let response = json_response(&serde_json::json!({"path": path.display().to_string(), "notes": notes}));
    workspace.written.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
    response
}

/// Formats the list of contents that the target format cannot store, as sentences.
pub(crate) fn format_losses(not_written: &[String]) -> Vec<String> {
    not_written
        .iter()
        .map(|what| format!("Not written, because the format cannot store it: {what}."))
        .collect()
}

/// Resolves and checks the path of the file to write.
pub(crate) fn target_path(
    workspace: &Workspace,
    default_name: String,
    request: &SaveRequest,
) -> Result<PathBuf, ApiError> {
    let opened = workspace.path.as_deref();
    let name = request.name.clone().unwrap_or(default_name);
    let path = Path::new(&name);
    let is_plain = path.file_name().is_some_and(|only| only == path.as_os_str());
    if !is_plain || name.starts_with('.') || name.contains(['/', '\\', ':', '\0']) {
        let message = "the file is written next to the opened one; give a name without folders";
        return Err(ApiError::bad_request(format!("{message}, got '{name}'")));
    }
    if Format::from_path(path).is_none() {
        return Err(ApiError::bad_request(format!(
            "the file name must end in the extension of a known format, such as .ply or .obj, got '{name}'"
        )));
    }
    let path = workspace.folder.join(path);
    if opened.is_some_and(|opened| is_same_file(opened, &path)) {
        return Err(ApiError::bad_request(format!(
            "'{name}' is the file that was opened; choose another name"
        )));
    }
    let is_from_studio = workspace.written.lock().unwrap_or_else(PoisonError::into_inner).contains(&path);
    if path.exists() && !is_from_studio && !request.replace {
        let message = "already exists; choose another name or allow replacing it";
        return Err(ApiError::new(StatusCode::CONFLICT, format!("{} {message}", path.display()))
            .with_fields(serde_json::json!({"exists": true})));
    }
    Ok(path)
}

fn is_same_file(a: &Path, b: &Path) -> bool {
    a == b || matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// Default file name: `NAME-edited.EXT`, or `.ply` if the format of the shape cannot be written.
fn default_name(session: &Session) -> String {
    let name = Path::new(&session.workspace.name);
    let stem = name.file_stem().and_then(|s| s.to_str()).unwrap_or("shape").replace([':', '.'], "-");
    let extension = name.extension().and_then(|e| e.to_str()).filter(|_| Format::from_path(name).is_some());
    format!("{stem}-edited.{}", extension.unwrap_or("ply"))
}

/// Responds with the edited shape in `format`.
pub(crate) fn download(session: &Session, format: &str) -> ApiResult {
    let format = Format::from_name(format).ok_or_else(|| {
        ApiError::bad_request(format!("cannot write the format '{format}'; see `formats` of the shape"))
    })?;
    let mut prepared = session.lock_prepared()?;
    let file = session.saved_file(&mut prepared)?;
    drop(prepared);
    let mut content = Vec::new();
    write_bytes_with(&file, format, &mut content, Progress::none())
        .map_err(|e| ApiError::from_classified(&e))?;
    Ok(bytes_response(content))
}
