//! Contents of a tab of the page: a shape, an image or a volume.

use crate::StudioError;
use crate::grid_session::GridSession;
use crate::response::ApiError;
use crate::session::{Session, StudioInput};
use crate::workspace::{OpenedAt, Workspace};
use adwave::Progress;
use serde_json::Value;
use std::fmt;
use std::sync::Arc;

/// Open shape, or open image or volume.
#[derive(Clone)]
pub(crate) enum Opened {
    Shape(Arc<Session>),
    Grid(Arc<GridSession>),
}

impl fmt::Debug for Opened {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Opened").field(&self.workspace().name).finish()
    }
}

impl Opened {
    pub(crate) fn new(input: StudioInput, at: OpenedAt, progress: Progress<'_>) -> Result<Self, StudioError> {
        Ok(match input.file.grid() {
            Some(_) => Self::Grid(Arc::new(GridSession::new(input, at)?)),
            None => Self::Shape(Arc::new(Session::new(input, at, progress)?)),
        })
    }

    pub(crate) fn workspace(&self) -> &Workspace {
        match self {
            Self::Shape(session) => &session.workspace,
            Self::Grid(session) => &session.workspace,
        }
    }

    /// `shape` or `grid`.
    pub(crate) fn domain(&self) -> &'static str {
        match self {
            Self::Shape(_) => "shape",
            Self::Grid(_) => "grid",
        }
    }

    /// Describes what is open for the page, with the edit of the last session.
    pub(crate) fn describe(&self) -> Result<Value, ApiError> {
        match self {
            Self::Shape(session) => session.describe(),
            Self::Grid(session) => session.describe(),
        }
    }

    /// Computes the bands with the edit of the last session, unless they are there.
    pub(crate) fn prepare(&self) -> Result<(), ApiError> {
        match self {
            Self::Shape(session) => session.lock_prepared().map(|_| ()),
            Self::Grid(session) => session.lock_bands().map(|_| ()),
        }
    }

    /// Computes what the first levels are chosen by, unless it is there.
    pub(crate) fn prepare_levels(&self) -> Result<(), ApiError> {
        match self {
            Self::Shape(session) => session.walk_decomposer().map(|_| ()),
            Self::Grid(_) => Ok(()),
        }
    }

    /// Returns the shape, for a request that images and volumes do not have.
    pub(crate) fn into_shape(self) -> Result<Arc<Session>, ApiError> {
        match self {
            Self::Shape(session) => Ok(session),
            Self::Grid(session) => Err(ApiError::bad_request(format!(
                "this request is for shapes, and {} is {}; see PROTOCOL.md for the requests of images and volumes",
                session.workspace.name,
                session.kind_with_article()
            ))),
        }
    }

    /// Returns the image or volume, for a request that shapes do not have.
    pub(crate) fn into_grid(self) -> Result<Arc<GridSession>, ApiError> {
        match self {
            Self::Grid(session) => Ok(session),
            Self::Shape(session) => Err(ApiError::bad_request(format!(
                "this request is for images and volumes, and {} is a shape; see PROTOCOL.md for the requests of shapes",
                session.workspace.name
            ))),
        }
    }
}
