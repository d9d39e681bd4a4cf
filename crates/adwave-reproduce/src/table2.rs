//! Table 2: seconds for the twelve shapes of the paper.

use crate::charts::{categories, logarithmic};
use crate::numbers::decomposer;
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::bands::Schedule;
use adwave::basis::{BasisParams, basis, basis_by_squaring};
use adwave::features::FeatureParams;
use adwave_render::plot::{Chart, Mark, Series};
use adwave_report::analysis::features;
use std::time::Instant;

/// Rows of the table: model, number of vertices, number of levels, and the paper's seconds for the wavelets and for the
/// processing.
const ROWS: [(&str, usize, usize, f64, f64); 12] = [
    ("dinosaur", 14053, 8, 35.03, 0.03),
    ("armadillo", 50000, 6, 30.61, 5.52),
    ("face", 10156, 5, 1.67, 0.47),
    ("pegaso", 30000, 4, 7.12, 1.25),
    ("kitten", 28969, 4, 4.09, 1.18),
    ("horse", 10296, 4, 1.70, 0.39),
    ("cow", 16612, 4, 3.11, 0.62),
    ("sphere", 10242, 8, 30.34, 0.05),
    ("skull", 20002, 7, 19.39, 0.11),
    ("gargoyle", 25011, 7, 28.63, 0.11),
    ("buddha", 25003, 7, 30.15, 0.12),
    ("hand", 10000, 7, 14.66, 0.05),
];

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let mut table = Table::new(
        "table2.csv",
        "Seconds; those of the paper on a Core2 Duo at 2.53 GHz in Matlab",
        &[
            "shape",
            "vertices",
            "paper: vertices",
            "levels",
            "paper: ADW",
            "paper: processing",
            "Algorithm 1 as printed",
            "our explicit basis",
            "all bands of the coordinates",
            "features",
        ],
    );
    let (mut ratios, mut letters) = (Vec::new(), Vec::new());
    let mut bars: [Vec<[f64; 2]>; 4] = Default::default();
    let mut shapes = Vec::new();
    for (row, &(name, n_vertices, n_levels, paper, processing)) in ROWS.iter().enumerate() {
        context.progress.step(row as u64, ROWS.len() as u64)?;
        let sample = if name == "sphere" { "sphere" } else { "creature" };
        let model = context.model_or(&[name], sample, n_vertices)?;
        let start = Instant::now();
        let decomposer = decomposer(&model);
        let prepared = start.elapsed().as_secs_f64();
        let params = BasisParams::new(Schedule::dyadic(n_levels)?);
        let start = Instant::now();
        drop(basis_by_squaring(decomposer.rows("a basis")?, &params, context.progress)?);
        let letter = start.elapsed().as_secs_f64();
        let start = Instant::now();
        drop(basis(decomposer.rows("a basis")?, &params, context.progress)?);
        let fast = start.elapsed().as_secs_f64();
        let schedule = Schedule::dyadic(n_levels)?;
        let start = Instant::now();
        let bands =
            decomposer.request(model.coordinates(), 3, &schedule).progress(context.progress).bands()?;
        let ours = prepared + start.elapsed().as_secs_f64();
        let start = Instant::now();
        let found = features(&decomposer, &bands, &FeatureParams::default());
        let finding = start.elapsed().as_secs_f64();
        ratios.push(paper / fast);
        letters.push(letter / fast);
        for (bars, seconds) in bars.iter_mut().zip([paper, letter, fast, ours]) {
            bars.push([row as f64, seconds]);
        }
        table.push([
            if model.is_built_in() { format!("{} for {name}", model.name) } else { name.to_owned() },
            model.points().len().to_string(),
            n_vertices.to_string(),
            n_levels.to_string(),
            digits(paper),
            digits(processing),
            digits(letter),
            digits(fast),
            digits(ours),
            if found.is_ok() { digits(finding) } else { String::new() },
        ]);
        shapes.push(model.label());
    }
    let (least, most) = range(&ratios);
    let (least_letter, most_letter) = range(&letters);
    let verdict = Verdict::from_parts(
        &[least > 1.0],
        format!(
            "Our explicit basis, the same functions on all levels, is {} to {} times as fast as in the paper, on \
             another machine and with other numbers of vertices if a model is given. In this run it is {} to {} times \
             as fast as Algorithm 1 as printed.",
            digits(least),
            digits(most),
            digits(least_letter),
            digits(most_letter),
        ),
    );
    let labels =
        ["the paper, 2013", "Algorithm 1 as printed", "our explicit basis", "all bands of the coordinates"];
    let series = labels.iter().zip(bars).map(|(&label, points)| Series {
        label: label.to_owned(),
        mark: Mark::Bars,
        points,
    });
    let chart = Chart {
        title: "Seconds for all levels".to_owned(),
        x: categories("shape of the paper, or its substitute", ROWS.iter().map(|row| row.0.to_owned())),
        y: logarithmic("seconds"),
        series: series.collect(),
    };
    let outcome = shapes.into_iter().fold(Outcome::new(verdict), Outcome::add_shape);
    Ok(outcome
        .say(
            "The seconds of the paper are for the functions as sparse matrices. The bands of all levels do not need \
             these functions; their column includes the construction of the operator.",
        )
        .chart("table2", "Seconds for each shape, on a logarithmic scale.", &chart)?
        .table(table))
}

/// Smallest and largest value.
fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, 0.0), |(least, most), &v| (v.min(least), v.max(most)))
}
