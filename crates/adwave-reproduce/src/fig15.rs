//! Fig. 15: global filters by this method and by manifold harmonics.

use crate::draw::{Sheet, SheetPanel};
use crate::numbers::{decomposer, norms, percent, positions};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::Decomposer;
use adwave::bands::{BandsParams, Schedule};
use adwave::measure::rms;
use adwave::shape::diagonal;
use adwave_baselines::harmonics::{Harmonics, Remainder};
use adwave_baselines::laplacian::{LaplacianMatrices, LaplacianParams};
use adwave_baselines::linalg::EigenParams;
use std::time::Instant;

const N_VERTICES: usize = 10_000;
/// Number of levels, as in Table 2 of the paper.
const N_LEVELS: usize = 7;
/// Number of eigenfunctions, chosen so that the low-pass filter is small above the last one.
const N_HARMONICS: usize = 500;
/// Gain of the enhanced middle band.
const GAIN: f64 = 2.0;
/// First and last level of the enhanced band.
const BAND: [usize; 2] = [5, 7];
/// Largest difference between results that count as similar, as a share of the change by the filter.
const SIMILAR: f64 = 0.35;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let model = context.model_or(&["hand", "dinosaur", "kitten"], "creature", N_VERTICES)?;
    let coords = model.coordinates();
    let size = diagonal(model.points());

    let start = Instant::now();
    let decomposer = decomposer(&model);
    let schedule = Schedule::dyadic(N_LEVELS)?;
    let our_preparing = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let bands = decomposer.request(coords, 3, &schedule).progress(context.progress).bands()?;
    let our_low = bands.coarsest().to_vec();
    let our_band = {
        let (fine, coarse) = (&bands.scaling(BAND[0]), &bands.scaling(BAND[1]));
        let raise = |((f, a), b): ((&f64, &f64), &f64)| f + (GAIN - 1.0) * (a - b);
        coords.iter().zip(fine.iter()).zip(coarse.iter()).map(raise).collect::<Vec<f64>>()
    };
    let our_filtering = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let laplacian = LaplacianMatrices::new(&model.shape, &LaplacianParams::default())?;
    let harmonics = Harmonics::new(&laplacian, N_HARMONICS, &EigenParams::default(), context.progress)?;
    let their_preparing = start.elapsed().as_secs_f64();
    let start = Instant::now();
    // The heat of width σ scales the frequency ω by e^(−ω²σ²/4).
    let heat = |frequency: f64, j: usize| (-(frequency * bands.sigma[j]).powi(2) / 4.0).exp();
    let their_low = harmonics.filter(coords, 3, |w| heat(w, N_LEVELS), Remainder::Drop)?;
    let band = |w: f64| 1.0 + (GAIN - 1.0) * (heat(w, BAND[0]) - heat(w, BAND[1]));
    let their_band = harmonics.filter(coords, 3, band, Remainder::Keep)?;
    let their_filtering = start.elapsed().as_secs_f64();
    let last = harmonics.values.last().copied().unwrap_or(0.0).max(0.0).sqrt();

    let mut table = Table::new(
        "fig15.csv",
        "Two filters by both methods",
        &["filter", "quantity", "ours", "manifold harmonics"],
    );
    let mut differences = Vec::new();
    let mut sheet = Sheet::new(4);
    for (name, ours, theirs) in
        [("low-pass", &our_low, &their_low), ("middle raised", &our_band, &their_band)]
    {
        let change = rms(ours, coords, 3);
        let difference = rms(ours, theirs, 3);
        differences.push(difference / change);
        let mut row = |quantity: &str, a: f64, b: Option<f64>| {
            table.push([name.to_owned(), quantity.to_owned(), digits(a), b.map_or_else(String::new, digits)]);
        };
        row(
            "change, rms (% of diagonal)",
            100.0 * change / size,
            Some(100.0 * rms(theirs, coords, 3) / size),
        );
        row("difference of the two, rms (% of diagonal)", 100.0 * difference / size, None);
        let apart: Vec<f64> = ours.iter().zip(theirs).map(|(a, b)| (a - b) / size * 100.0).collect();
        sheet.push(SheetPanel::new(&model, format!("original {}", model.name)));
        sheet.push(SheetPanel::with_points(&model, positions(ours), format!("{name}, ours")));
        sheet.push(SheetPanel::with_points(&model, positions(theirs), format!("{name}, harmonics")));
        let panel = SheetPanel::with_points(&model, positions(ours), "difference of the two");
        sheet.push(panel.field(&norms(&apart, 3), "% of diagonal"));
    }
    let mut row = |quantity: &str, a: String, b: String| {
        table.push(["both".to_owned(), quantity.to_owned(), a, b]);
    };
    row("prepare (s)", digits(our_preparing), digits(their_preparing));
    row("filter (s)", digits(our_filtering), digits(their_filtering));
    row("products or eigenfunctions", bands.info.products.to_string(), harmonics.len().to_string());
    row("gain of the low-pass at the last frequency", String::new(), digits(heat(last, N_LEVELS)));
    let locality = edit_one_half(&decomposer, coords, context, &schedule)?;
    row("vertices moved by an edit of one half (%)", digits(100.0 * locality), String::new());

    let (ours, theirs) = (our_preparing + our_filtering, their_preparing + their_filtering);
    let similar = differences.iter().all(|d| *d < SIMILAR);
    let verdict = Verdict::from_parts(
        &[similar, ours < theirs, locality < 0.6],
        format!(
            "The difference of the results is {} (low-pass) and {} (middle raised) of the change by the filter; below \
             {} they are similar. Our method takes {} s including all preparation, {} harmonics take {} s. Our method \
             can be confined to a region: an edit of one half moves {} of the vertices. Harmonics are global.",
            percent(differences[0]),
            percent(differences[1]),
            percent(SIMILAR),
            digits(ours),
            harmonics.len(),
            digits(theirs),
            percent(locality)
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(model.label())
        .sheet(
            "fig15.png",
            "Top: low-pass. Bottom: a middle band doubled. From left to right: the original, our method, manifold \
             harmonics, and their difference.",
            &sheet,
            context,
        )?
        .table(table)
        .say(format!(
            "Both methods apply the same frequency response: ours as a polynomial of the diffusion operator, the \
             other by {N_HARMONICS} eigenfunctions of the Laplacian. They differ in the Laplacian (one is based on \
             edge lengths, the other on angles) and, for the low-pass, in the frequencies above the last \
             eigenfunction. If only low frequencies are needed and the eigenfunctions are available, harmonics are an \
             equally good tool.",
        )))
}

/// Computes the share of the vertices that move when one half is smoothed.
fn edit_one_half(
    decomposer: &Decomposer,
    coords: &[f64],
    context: &Context<'_>,
    schedule: &Schedule,
) -> Result<f64, FigureError> {
    use adwave::filter::{Edit, Gains, Layer, Preset};
    let points = positions(coords);
    let mut xs: Vec<f64> = points.iter().map(|p| p[0]).collect();
    xs.sort_by(f64::total_cmp);
    let region = adwave::region::Region::HalfSpace {
        point: [xs[xs.len() / 2], 0.0, 0.0],
        normal: [1.0, 0.0, 0.0],
        falloff: None,
    };
    let layers = [Layer { gains: Gains::Preset(Preset::SuppressPaper), region }];
    let (edit, params) = (Edit::new(&layers), BandsParams::default());
    let after = positions(
        &decomposer.request(coords, 3, schedule).params(&params).progress(context.progress).filter(&edit)?,
    );
    let moved = points.iter().zip(&after).filter(|(a, b)| a != b).count();
    Ok(moved as f64 / points.len().max(1) as f64)
}
