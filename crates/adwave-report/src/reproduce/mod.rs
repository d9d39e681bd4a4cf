//! Every figure and table of the paper, reproduced with this method and the baselines it is compared with.
//!
//! [`FIGURES`] lists them, [`reproduce()`] makes those that are asked for and writes each as it is done: its pictures and
//! numbers in a folder of its own, and a page of all. One file here for each figure.

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
mod table1;
mod table2;
mod write;

pub use crate::table::{Table, digits};
pub use context::Context;
pub use figures::{FIGURES, Figure, select};
pub use models::{MODELS, Model, ModelError, Models};
pub use outcome::{Outcome, PictureFile, Verdict};

use adwave::{ClassifiedError, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Instant;
use thiserror::Error;

/// Whatever a figure's making can fail with.
pub type FigureError = Box<dyn std::error::Error + Send + Sync>;

/// Why figures are not made.
#[derive(Debug, Error)]
pub enum ReproduceError {
    /// The folder or a file in it cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The folder or file.
        path: String,
        /// Why.
        source: FigureError,
    },
    /// Figures that cannot be made; the others are written.
    #[error("{} cannot be made: {}", .0.join(", "), .1)]
    Figures(
        /// Their names.
        Vec<&'static str>,
        /// Why the first of them cannot.
        FigureError,
    ),
    /// The call was told to stop; the figures before are written.
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

/// Where the files go.
#[derive(Clone, Debug)]
pub struct Target {
    /// The folder for pictures, numbers and `index.html`.
    pub folder: PathBuf,
    /// A Markdown file of the same, with small pictures in a folder beside it.
    pub markdown: Option<PathBuf>,
}

/// What is said while figures are made.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// A figure is begun.
    Started(&'a Figure),
    /// A figure is written.
    Finished(&'a Made),
}

/// A figure that is written.
#[derive(Clone, Debug)]
pub struct Made {
    /// What came of it.
    pub outcome: Outcome,
    /// How long it took.
    pub seconds: f64,
    /// Its folder's name.
    pub folder: &'static str,
    /// Its files, in the folder of all.
    pub files: Vec<PathBuf>,
}

/// Makes `figures` and writes them to `target`, each as it is done: `figNN/…`, `index.html`, and the Markdown file at the
/// end. Files of other names in the folder stay.
///
/// # Errors
/// [`ReproduceError`]; what cannot be written shows before the first figure is made.
pub fn reproduce(
    figures: &[&Figure],
    context: &Context<'_>,
    target: &Target,
    on: &mut dyn FnMut(Event<'_>),
) -> Result<Vec<Made>, ReproduceError> {
    let mut made: Vec<Made> = Vec::new();
    let (mut failed, mut cause) = (Vec::new(), None);
    write::check(target)?;
    write::index(&target.folder, &made)?;
    for figure in figures {
        on(Event::Started(figure));
        let start = Instant::now();
        let mut outcome = match (figure.make)(context) {
            _ if context.progress.step(1, 1).is_err() => return Err(ReproduceError::Cancelled),
            Ok(outcome) => outcome,
            // A model that one figure cannot be made on is no reason to leave out the others.
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
        made.push(Made { outcome, seconds, folder: figure.folder, files });
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

/// `path` for messages.
fn shown(path: &Path) -> String {
    path.display().to_string()
}
