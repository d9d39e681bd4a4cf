//! List of figures and tables.

use crate::{
    Context, FigureError, Outcome, fig01, fig02, fig03, fig04, fig05, fig06, fig07, fig08, fig09, fig10,
    fig11, fig12, fig13, fig14, fig15, section22, table1, table2,
};

/// Figure or table of the paper.
#[derive(Clone, Copy)]
pub struct Figure {
    /// Name of the figure: `fig1` … `fig15`, `table1`, `table2`, `section2.2`.
    pub name: &'static str,
    /// Folder of the figure's files: `fig01` … `table2`, `section22`.
    pub folder: &'static str,
    /// Title of the figure.
    pub title: &'static str,
    /// Models on which the figure can be made; built-in shapes replace missing models.
    pub models: &'static [&'static str],
    /// Function that makes the figure.
    pub(crate) make: fn(&Context<'_>) -> Result<Outcome, FigureError>,
}

impl std::fmt::Debug for Figure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Figure").field("name", &self.name).finish_non_exhaustive()
    }
}

/// All figures and tables in the order of the paper, and a section with a claim that has no figure.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "fig1",
        folder: "fig01",
        title: "Framework: bands of a shape and what is done with them",
        models: &["armadillo"],
        make: fig01::make,
    },
    Figure {
        name: "fig2",
        folder: "fig02",
        title: "Scaling functions and wavelets of three kinds on a line",
        models: &[],
        make: fig02::make,
    },
    Figure {
        name: "fig3",
        folder: "fig03",
        title: "A scaling function and a wavelet on a surface",
        models: &["bunny", "kitten"],
        make: fig03::make,
    },
    Figure {
        name: "fig4",
        folder: "fig04",
        title: "Coefficients of a function on a line",
        models: &[],
        make: fig04::make,
    },
    Figure {
        name: "fig5",
        folder: "fig05",
        title: "A shape and a scalar field from fine to the coarsest scale",
        models: &["dinosaur", "kitten", "bunny"],
        make: fig05::make,
    },
    Figure {
        name: "fig6",
        folder: "fig06",
        title: "Cost from fine to coarse, against eigenfunctions from coarse to fine",
        models: &["hand", "dinosaur", "kitten"],
        make: fig06::make,
    },
    Figure {
        name: "fig7",
        folder: "fig07",
        title: "Sparse matrices of the line",
        models: &[],
        make: fig07::make,
    },
    Figure {
        name: "fig8",
        folder: "fig08",
        title: "How the saliency map comes about",
        models: &["dinosaur"],
        make: fig08::make,
    },
    Figure {
        name: "fig9",
        folder: "fig09",
        title: "Saliency of two poses, against Lee et al.",
        models: &["armadillo"],
        make: fig09::make,
    },
    Figure {
        name: "fig10",
        folder: "fig10",
        title: "Features by threshold and under noise",
        models: &["armadillo"],
        make: fig10::make,
    },
    Figure {
        name: "fig11",
        folder: "fig11",
        title: "Features of textures, against the feature map",
        models: &["spot"],
        make: fig11::make,
    },
    Figure {
        name: "fig12",
        folder: "fig12",
        title: "Saliency and features of point clouds",
        models: &["pegaso", "bunny", "kitten", "horse"],
        make: fig12::make,
    },
    Figure {
        name: "fig13",
        folder: "fig13",
        title: "Local edits: suppression and enhancement of regions",
        models: &["sphere", "skull", "armadillo", "gargoyle", "dinosaur"],
        make: fig13::make,
    },
    Figure {
        name: "fig14",
        folder: "fig14",
        title: "Four global filters",
        models: &["gargoyle", "armadillo", "skull", "buddha", "dinosaur", "bunny"],
        make: fig14::make,
    },
    Figure {
        name: "fig15",
        folder: "fig15",
        title: "Global filters against manifold harmonics",
        models: &["hand", "dinosaur", "kitten"],
        make: fig15::make,
    },
    Figure {
        name: "table1",
        folder: "table1",
        title: "Properties of three kinds of wavelets, as numbers",
        models: &[],
        make: table1::make,
    },
    Figure {
        name: "table2",
        folder: "table2",
        title: "Seconds for the twelve shapes of the paper",
        models: &[
            "dinosaur",
            "armadillo",
            "face",
            "pegaso",
            "kitten",
            "horse",
            "cow",
            "sphere",
            "skull",
            "gargoyle",
            "buddha",
            "hand",
        ],
        make: table2::make,
    },
    Figure {
        name: "section2.2",
        folder: "section22",
        title: "Subdivision wavelets beside the bands",
        models: &[],
        make: section22::make,
    },
];

/// Selects figures by name, in the order of the paper and each once. `all` selects all figures, and so does an empty
/// list.
///
/// # Errors
/// The first name that does not name a figure.
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
