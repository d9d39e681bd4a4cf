//! Fig. 7: sparsity patterns of Φ₁ and Φ₄ of the line.

use crate::charts::{N_POINTS, line};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::basis::{BasisParams, basis_by_squaring};
use adwave_render::plot::SparsityPattern;

const N_LEVELS: usize = 8;
/// Share of nonzero entries below which a matrix counts as sparse.
const SPARSE: f64 = 0.25;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let decomposer = Decomposer::new(&line()?);
    let params = BasisParams::new(Schedule::dyadic(N_LEVELS)?);
    let basis = basis_by_squaring(decomposer.rows("a basis")?, &params, context.progress)?
        .to_shape_order(decomposer.vertex_map())?;
    let all = (N_POINTS * N_POINTS) as f64;
    let mut table =
        Table::new("fig07.csv", "Entries above ε = 1e-6", &["level", "steps", "entries", "part of all"]);
    for j in 1..=N_LEVELS {
        let nnz = basis.scaling[j - 1].nnz();
        table.push([j.to_string(), (1 << (j - 1)).to_string(), nnz.to_string(), digits(nnz as f64 / all)]);
    }
    let density = |j: usize| basis.scaling[j - 1].nnz() as f64 / all;
    let verdict = Verdict::from_parts(
        &[density(1) < SPARSE, density(4) < SPARSE],
        format!(
            "The share of nonzero entries is {} for Φ₁ and {} for Φ₄; on level {N_LEVELS} it is {}.",
            digits(density(1)),
            digits(density(4)),
            digits(density(N_LEVELS)),
        ),
    );
    let mut outcome = Outcome::new(verdict).add_shape(format!("a line of {N_POINTS} points"));
    for j in [1, 4] {
        let rows = 0..N_POINTS as u32;
        let entries: Vec<[u32; 2]> =
            rows.flat_map(|x| basis.scaling[j - 1].row(x as usize).0.iter().map(move |&y| [x, y])).collect();
        let pattern = SparsityPattern {
            title: format!("Φ of level {j}"),
            n_rows: N_POINTS,
            n_columns: N_POINTS,
            entries,
        };
        let caption = format!("Φ of level {j}: a square for each entry above 1e-6.");
        outcome = outcome.pattern(&format!("fig07-phi{j}"), &caption, &pattern)?;
    }
    Ok(outcome.say("The paper claims that the matrices of the first levels are sparse.").table(table))
}
