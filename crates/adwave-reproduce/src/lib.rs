//! All figures and tables of the paper, reproduced with this method and the baselines that it is compared with.
//!
//! [`FIGURES`] lists them. [`reproduce()`] makes the requested figures and writes each when it is finished: its
//! pictures and numbers to its own folder, and a page of all figures. Each figure has its own file in this crate.

mod charts;
mod context;
mod draw;
mod fig01;
mod fig02;
mod fig03;
mod fig04;
mod fig05;
mod fig06;
mod fig07;
mod fig08;
mod fig09;
mod fig10;
mod fig11;
mod fig12;
mod fig13;
mod fig14;
mod fig15;
mod figures;
mod index;
mod markdown;
mod models;
mod numbers;
mod outcome;
mod section22;
mod table1;
mod table2;
mod write;

pub use adwave_report::{Table, digits};
pub use context::Context;
pub use figures::{FIGURES, Figure, select};
pub use models::{MODELS, Model, ModelError, Models};
pub use outcome::{Outcome, PictureFile, Verdict};

use adwave::{ClassifiedError, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Instant;
use thiserror::Error;

/// Failure to make a figure.
pub type FigureError = Box<dyn std::error::Error + Send + Sync>;

/// Failure of [`reproduce()`].
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReproduceError {
    /// The folder or a file in it could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// Path of the folder or file.
        path: String,
        /// Reason.
        source: FigureError,
    },
    /// Some figures could not be made; the others are written.
    #[error("{} cannot be made: {}", .0.join(", "), .1)]
    Figures(
        /// Names of these figures.
        Vec<&'static str>,
        /// Reason for the first of these figures.
        FigureError,
    ),
    /// The caller cancelled the call; the finished figures are written.
    #[error("stopped on request")]
    Cancelled,
}

impl ClassifiedError for ReproduceError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Write { .. } => ErrorKind::Machine,
            Self::Figures(..) => ErrorKind::Input,
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }
}

/// Destination of the files.
#[derive(Clone, Debug)]
pub struct Target {
    /// Folder for pictures, numbers and `index.html`.
    pub folder: PathBuf,
    /// Markdown file of the same content; its small pictures go to a folder next to it.
    pub markdown: Option<PathBuf>,
}

/// Progress of [`reproduce()`].
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A figure is started.
    Started(&'a Figure),
    /// A figure is written.
    Finished(&'a ReproducedFigure),
}

/// Figure that has been written.
#[derive(Clone, Debug)]
pub struct ReproducedFigure {
    /// Pictures, numbers and verdict.
    pub outcome: Outcome,
    /// Seconds spent on making the figure.
    pub seconds: f64,
    /// Name of the figure's folder.
    pub folder: &'static str,
    /// Paths of the figure's files.
    pub files: Vec<PathBuf>,
}

/// Makes `figures` and writes each to `target` when it is finished: `figNN/…`, `index.html`, and the Markdown file at
/// the end. Other files in the folder are not changed.
///
/// # Errors
/// [`ReproduceError`]. A folder that cannot be written is reported before the first figure is made.
pub fn reproduce(
    figures: &[&Figure],
    context: &Context<'_>,
    target: &Target,
    on: &mut dyn FnMut(Event<'_>),
) -> Result<Vec<ReproducedFigure>, ReproduceError> {
    let mut made: Vec<ReproducedFigure> = Vec::new();
    let (mut failed, mut cause) = (Vec::new(), None);
    write::check(target)?;
    write::index(&target.folder, &made)?;
    for figure in figures {
        on(Event::Started(figure));
        let start = Instant::now();
        let mut outcome = match (figure.make)(context) {
            _ if context.progress.step(1, 1).is_err() => return Err(ReproduceError::Cancelled),
            Ok(outcome) => outcome,
            // The other figures are made even if a model does not suit this one.
            Err(error) => {
                failed.push(figure.name);
                cause.get_or_insert(error);
                continue;
            }
        };
        figure.name.clone_into(&mut outcome.id);
        figure.title.clone_into(&mut outcome.title);
        outcome.command = format!("adwave reproduce {} -o out", figure.name);
        let files = write::figure(&target.folder, figure.folder, &outcome)?;
        let seconds = start.elapsed().as_secs_f64();
        made.push(ReproducedFigure { outcome, seconds, folder: figure.folder, files });
        write::index(&target.folder, &made)?;
        on(Event::Finished(&made[made.len() - 1]));
    }
    if let Some(path) = &target.markdown {
        markdown::write(path, &made)?;
    }
    match cause {
        Some(cause) => Err(ReproduceError::Figures(failed, cause)),
        None => Ok(made),
    }
}

/// Converts a path to text for messages.
fn display_path(path: &Path) -> String {
    path.display().to_string()
}
