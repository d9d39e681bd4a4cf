//! Fig. 8: the construction of a saliency map.

use crate::draw::{Sheet, SheetPanel};
use crate::numbers::{bands, decomposer, mean_curvature};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::measure::correlation;
use adwave::saliency::SaliencyParams;
use adwave::shape::diagonal;
use adwave_report::analysis::{saliency, saliency_per_level};

const N_VERTICES: usize = 14_000;
/// Number of levels, as in Table 2 of the paper.
const N_LEVELS: usize = 8;
/// Largest rounding error of the sum of the levels, relative to the map.
const ROUNDING: f64 = 1e-12;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let model = context.model_or(&["dinosaur"], "creature", N_VERTICES)?;
    let decomposer = decomposer(&model);
    let size = diagonal(model.points());
    let curvature = mean_curvature(&decomposer)?;
    let bands = bands(context, &decomposer, &curvature, 1, N_LEVELS)?;
    let params = SaliencyParams::paper();
    let map = saliency(&decomposer, &bands, &params)?.map;
    let levels = saliency_per_level(&decomposer, &bands, &params)?;

    let mut sheet = Sheet::new(4);
    sheet.push(SheetPanel::new(&model, "f: mean curvature").field(&curvature, "1/model unit"));
    let mut table = Table::new(
        "fig08.csv",
        "Contribution of each level to the map",
        &[
            "level",
            "sigma (% of diagonal)",
            "mean |W|",
            "largest |W|",
            "alpha",
            "share of the map (%)",
            "correlation of |W| at neighbors",
        ],
    );
    let total: f64 = map.iter().sum();
    let mut sum = vec![0.0; map.len()];
    let mut correlations = Vec::new();
    for (level, part) in &levels {
        let size_of_wavelet: Vec<f64> = bands.wavelet(level.level).iter().map(|w| w.abs()).collect();
        correlations.push(neighbor_correlation(&model.triangles, &size_of_wavelet));
        sum.iter_mut().zip(part).for_each(|(s, p)| *s += p);
        table.push([
            level.level.to_string(),
            digits(100.0 * level.sigma / size),
            digits(level.mean),
            digits(level.max),
            digits(level.alpha),
            digits(100.0 * part.iter().sum::<f64>() / total),
            format!("{:.4}", correlations[correlations.len() - 1]),
        ]);
        let panel = SheetPanel::new(&model, format!("|W_f({})|", level.level));
        sheet.push(panel.field(&size_of_wavelet, "1/model unit"));
    }
    sheet.push(SheetPanel::new(&model, "Λ: saliency").saliency(&map));
    let largest = map.iter().copied().fold(0.0, f64::max);
    let error = map.iter().zip(&sum).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
    let widening = correlations.windows(2).all(|l| l[1] > l[0]);
    let verdict = Verdict::from_parts(
        &[error <= ROUNDING, widening],
        format!(
            "The map is the sum of its levels within {} of its largest value. Coarser levels have larger structures: \
             the correlation of |W| at the two ends of an edge goes from {:.2} on level {} to {:.2} on level \
             {N_LEVELS}{}.",
            digits(error),
            correlations[0],
            levels[0].0.level,
            correlations[correlations.len() - 1],
            if widening { ", rising from level to level" } else { ", but does not rise from level to level" }
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(model.label())
        .sheet(
            "fig08.png",
            "Mean curvature, the magnitudes of its wavelet coefficients on levels 3 to 8, and their weighted sum, the \
             saliency map.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "The two finest levels are skipped, since they contain the noise. Each of the others shows where the \
             curvature differs at its size: first wrinkles, then toes and ears, then limbs. The map weights a level \
             by the squared difference between its largest value and its mean, which has a strong effect: see the \
             shares in the table.",
        ))
}

/// Correlation between the values of a field at the two ends of edges, close to 1 for a field that varies slowly.
fn neighbor_correlation(triangles: &[[u32; 3]], field: &[f64]) -> f64 {
    let edges = || triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for (x, y) in edges().chain(edges().map(|(x, y)| (y, x))) {
        a.push(field[x as usize]);
        b.push(field[y as usize]);
    }
    correlation(&a, &b)
}
