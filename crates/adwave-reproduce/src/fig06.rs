//! Fig. 6: the cost of levels from fine to coarse, and of eigenfunctions from coarse to fine.

use crate::charts::logarithmic;
use crate::numbers::decomposer;
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::bands::Schedule;
use adwave_baselines::harmonics::Harmonics;
use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
use adwave_baselines::linalg::EigenParams;
use adwave_render::plot::{Chart, Mark, Series};
use std::time::Instant;

const N_VERTICES: usize = 8000;
const N_LEVELS: usize = 10;
const N_HARMONICS: [usize; 4] = [25, 50, 100, 200];
/// Number of repetitions of a measurement, of which the shortest is used.
const N_RUNS: usize = 3;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let model = context.model_or(&["hand", "dinosaur", "kitten"], "creature", N_VERTICES)?;
    let start = Instant::now();
    let decomposer = decomposer(&model);
    let preparing = start.elapsed().as_secs_f64();
    let head = [
        "method",
        "down to level or up to eigenfunction",
        "finest length σ or wave (model units)",
        "seconds",
    ];
    let mut table = Table::new("fig06.csv", "Seconds to reach a level or a frequency", &head);
    let mut ours = Vec::new();
    for j in 1..=N_LEVELS {
        let schedule = Schedule::dyadic(j)?;
        let mut least = f64::INFINITY;
        let mut sigma = 0.0;
        for _ in 0..N_RUNS {
            let start = Instant::now();
            let bands =
                decomposer.request(model.coordinates(), 3, &schedule).progress(context.progress).bands()?;
            least = least.min(preparing + start.elapsed().as_secs_f64());
            sigma = bands.sigma[j];
        }
        table.push(["bands".to_owned(), j.to_string(), digits(sigma), digits(least)]);
        ours.push([sigma, least]);
    }
    let start = Instant::now();
    let laplacian = LaplacianMatrices::new(&model.shape, &LaplacianParams::default())?;
    let assembling = start.elapsed().as_secs_f64();
    let most = model.points().len() / 4;
    let mut theirs = Vec::new();
    for k in N_HARMONICS.into_iter().filter(|&k| k <= most) {
        let (mut seconds, mut frequency) = (f64::INFINITY, 0.0);
        for _ in 0..N_RUNS {
            let start = Instant::now();
            let harmonics = Harmonics::new(&laplacian, k, &EigenParams::default(), context.progress)?;
            seconds = seconds.min(assembling + start.elapsed().as_secs_f64());
            frequency = harmonics.values.last().copied().unwrap_or(0.0).max(0.0).sqrt();
        }
        // The width of a Gaussian whose spectrum has fallen to 1/e at that frequency, as in Fig. 15.
        let sigma = 2.0 / frequency;
        table.push(["harmonics".to_owned(), k.to_string(), digits(sigma), digits(seconds)]);
        if sigma.is_finite() {
            theirs.push([sigma, seconds]);
        }
    }
    let rises = |points: &[[f64; 2]]| points.last().zip(points.first()).is_some_and(|(b, a)| b[1] > a[1]);
    // The finest length that the harmonics reach, and the cost of the bands up to there.
    let finest = theirs.last().copied().unwrap_or([0.0, 0.0]);
    let at_finest = ours.iter().find(|p| p[0] >= finest[0]).or(ours.last()).copied().unwrap_or([0.0; 2]);
    let verdict = Verdict::from_parts(
        &[rises(&ours), rises(&theirs), at_finest[1] < finest[1]],
        format!(
            "Bands take {} s for level 1 and {} s for {N_LEVELS} levels, including the operator. Eigenfunctions reach \
             their finest length, {}, in {} s; all bands up to this length take {} s.",
            digits(ours[0][1]),
            digits(ours[N_LEVELS - 1][1]),
            digits(finest[0]),
            digits(finest[1]),
            digits(at_finest[1]),
        ),
    );
    let series = |label: &str, points| Series { label: label.to_owned(), mark: Mark::Points, points };
    let mut all = vec![series("bands, from fine to coarse", ours)];
    if !theirs.is_empty() {
        all.push(series("harmonics, from coarse to fine", theirs));
    }
    let chart = Chart {
        title: "Seconds to reach a length".to_owned(),
        x: logarithmic("length reached (model units)"),
        y: logarithmic("seconds"),
        series: all,
    };
    let caption = "Cost of reaching a length. Bands start at the left, eigenfunctions at the right.";
    Ok(Outcome::new(verdict)
        .add_shape(model.label())
        .say(
            "Bands are computed from fine to coarse: each level doubles the number of steps. Eigenfunctions are \
             computed from coarse to fine: finer details need more of them.",
        )
        .chart("fig06", caption, &chart)?
        .table(table))
}
