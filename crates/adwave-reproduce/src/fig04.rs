//! Fig. 4: scaling and wavelet coefficients of a function on a line.

use crate::charts::{N_POINTS, line, linear, row};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::measure::rms;
use adwave_render::plot::Chart;

const LEVELS: [usize; 3] = [0, 3, 6];

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let decomposer = Decomposer::new(&line()?);
    let f: Vec<f64> = (0..N_POINTS).map(function).collect();
    let schedule = Schedule::dyadic(LEVELS[2])?;
    let bands = decomposer.request(&f, 1, &schedule).progress(context.progress).bands()?;
    let mut head = vec!["point".to_owned()];
    head.extend((0..=LEVELS[2]).map(|j| format!("S_f({j})")));
    head.extend((1..=LEVELS[2]).map(|j| format!("W_f({j})")));
    let mut table = Table::new("fig04.csv", "All coefficients", &[]);
    table.head = head;
    let scaling = bands.all_scaling();
    for x in 0..N_POINTS {
        let values = scaling.chunks_exact(N_POINTS).chain(bands.wavelets()).map(|band| digits(band[x]));
        table.rows.push(std::iter::once(x.to_string()).chain(values).collect());
    }
    let rebuilt = bands.reconstruct();
    let error = rms(&rebuilt, &f, 1);
    let roughness = |s: &[f64]| s.windows(2).map(|w| (w[1] - w[0]).abs()).sum::<f64>();
    let rough: Vec<f64> = scaling.chunks_exact(N_POINTS).map(roughness).collect();
    let falls = rough.windows(2).all(|w| w[1] <= w[0]);
    let verdict = Verdict::from_parts(
        &[falls, error < 1e-12],
        format!(
            "The total variation of S_f decreases from {} at level 0 to {} at level {}. The bands add up to the \
             function within {}.",
            digits(rough[0]),
            digits(rough[LEVELS[2]]),
            LEVELS[2],
            digits(error),
        ),
    );
    let scaling = LEVELS.map(|j| row(format!("S_f({j})"), &bands.scaling(j))).to_vec();
    let wavelet = [1, LEVELS[1], LEVELS[2]].map(|j| row(format!("W_f({j})"), bands.wavelet(j))).to_vec();
    let chart = |title: &str, series| Chart {
        title: title.to_owned(),
        x: linear("point"),
        y: linear("value"),
        series,
    };
    Outcome::new(verdict)
        .add_shape(format!("a line of {N_POINTS} points"))
        .say(
            "A step, a hat and two waves are smoothed level by level; the wavelet coefficients of a level are the \
             part that it removes. The paper shows W_f at j = 0, which eq. 5 does not define; this figure shows level \
             1 instead.",
        )
        .chart("fig04-scaling", "The function and its scaling coefficients.", &chart("Scaling coefficients", scaling))?
        .chart("fig04-wavelet", "Its wavelet coefficients.", &chart("Wavelet coefficients", wavelet))
        .map(|outcome| outcome.table(table))
}

/// Value of the function at a point: a slow wave plus a fast one, a hat and a step.
fn function(x: usize) -> f64 {
    let t = x as f64 / N_POINTS as f64;
    let fast = if t < 0.35 { 0.25 * (50.0 * t).sin() } else { 0.0 };
    let hat = (1.0 - (t - 0.55).abs() / 0.08).max(0.0);
    let step = if t > 0.75 { 0.8 } else { 0.0 };
    (5.0 * t).sin() + fast + hat + step
}
