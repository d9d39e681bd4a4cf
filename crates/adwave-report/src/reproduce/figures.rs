//! The list of what can be made.

use super::{Context, FigureError, Outcome};

/// A figure or table of the paper.
#[derive(Clone, Copy)]
pub struct Figure {
    /// `fig1` … `fig15`, `table1`, `table2`.
    pub name: &'static str,
    /// The folder that its files go to: `fig01` … `table2`.
    pub folder: &'static str,
    /// What the paper shows.
    pub title: &'static str,
    /// The models that it can be made on; built-in shapes stand in for those that are missing.
    pub models: &'static [&'static str],
    /// Makes it.
    pub(super) make: fn(&Context<'_>) -> Result<Outcome, FigureError>,
}

impl std::fmt::Debug for Figure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Figure").field("name", &self.name).finish_non_exhaustive()
    }
}

/// All figures and tables in the order of the paper.
pub const FIGURES: &[Figure] = &[];

/// The figures that are named, in the order of the paper, each once; `all` names all, and so does no name.
///
/// # Errors
/// The first name that names nothing.
pub fn select(names: &[String]) -> Result<Vec<&'static Figure>, String> {
    let is = |figure: &Figure, name: &str| {
        let name = name.to_ascii_lowercase();
        name == figure.name || name == figure.folder
    };
    for name in names {
        if name != "all" && !FIGURES.iter().any(|f| is(f, name)) {
            return Err(name.clone());
        }
    }
    let all = names.is_empty() || names.iter().any(|n| n == "all");
    Ok(FIGURES.iter().filter(|f| all || names.iter().any(|n| is(f, n))).collect())
}
