//! Fig. 1: the framework. A shape, its bands from fine to coarse, and their applications.

use crate::draw::{Sheet, SheetPanel};
use crate::numbers::{bands, decomposer, norms, positions};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::bands::Schedule;
use adwave::features::FeatureParams;
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::measure::rms;
use adwave::region::{Length, Region};
use adwave::saliency::SaliencyParams;
use adwave::shape::{bounding_box, diagonal};
use adwave_report::analysis::{features, saliency};

const N_VERTICES: usize = 50_000;
const N_LEVELS: usize = 8;
/// Levels that are drawn.
const DRAWN_LEVELS: [usize; 4] = [2, 4, 6, 8];
/// Largest rounding error of `S_f(J) + ΣW_f(j) − f`, relative to the size of the shape.
const ROUNDING: f64 = 1e-12;

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let model = context.model_or(&["armadillo"], "creature", N_VERTICES)?;
    let decomposer = decomposer(&model);
    let coords = model.coordinates();
    let bands = bands(context, &decomposer, coords, 3, N_LEVELS)?;
    let size = diagonal(model.points());
    let error = rms(&bands.reconstruct(), coords, 3) / size;

    let map = saliency(&decomposer, &bands, &SaliencyParams::paper())?.map;
    let found = features(&decomposer, &bands, &FeatureParams::default())?;
    let (low, high) = bounding_box(model.points()).ok_or("the model has no vertices")?;
    let middle = std::array::from_fn(|c| 0.5 * (low[c] + high[c]));
    let side = |sign: f64| Region::HalfSpace {
        point: middle,
        normal: [sign, 0.0, 0.0],
        falloff: Some(Length::PercentOfDiagonal(5.0)),
    };
    let layers = [
        Layer { gains: Gains::Preset(Preset::SuppressPaper), region: side(1.0) },
        Layer { gains: Gains::Preset(Preset::Enhance), region: side(-1.0) },
    ];
    let schedule = Schedule::dyadic(N_LEVELS)?;
    let edit = Edit::new(&layers);
    let edited = decomposer.request(coords, 3, &schedule).progress(context.progress).filter(&edit)?;

    let mut sheet = Sheet::new(4);
    for j in DRAWN_LEVELS {
        sheet.push(SheetPanel::with_points(&model, positions(&bands.scaling(j)), format!("S_f({j})")));
    }
    for j in DRAWN_LEVELS {
        let size_of_wavelet = norms(bands.wavelet(j), 3);
        let panel = SheetPanel::with_points(&model, positions(&bands.scaling(j)), format!("|W_f({j})|"));
        sheet.push(panel.field(&size_of_wavelet, "|W| (model units)"));
    }
    sheet.push(SheetPanel::new(&model, "f: the shape"));
    sheet.push(SheetPanel::new(&model, "saliency").saliency(&map));
    sheet.push(SheetPanel::new(&model, format!("{} features", found.len())).features(&model, &found));
    sheet.push(SheetPanel::with_points(&model, positions(&edited), "one half smoothed, the other enhanced"));

    let mut table = Table::new(
        "fig01.csv",
        "The bands of the coordinates",
        &["level", "steps", "sigma (% of diagonal)", "rms |W_f| (% of diagonal)", "features"],
    );
    for j in 1..=N_LEVELS {
        let zero = vec![0.0; coords.len()];
        table.push([
            j.to_string(),
            bands.steps[j].to_string(),
            digits(100.0 * bands.sigma[j] / size),
            digits(100.0 * rms(bands.wavelet(j), &zero, 3) / size),
            found.iter().filter(|f| f.level == j).count().to_string(),
        ]);
    }
    let verdict = Verdict::from_parts(
        &[error <= ROUNDING, !found.is_empty()],
        format!(
            "The sum of the bands differs from the shape by {} of its diagonal (rms), which is rounding error. The \
             map, {} features and the edit use the same bands.",
            digits(error),
            found.len()
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(model.label())
        .sheet(
            "fig01.png",
            "Top: the shape smoothed to levels 2, 4, 6 and 8. Middle: the bands of these levels. Bottom: the shape, \
             and three results of its bands.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "The coordinates of the shape are decomposed into bands: each level smooths with twice as many steps as \
             the one before, and its wavelet coefficients are the difference. Fine levels contain the skin, coarse \
             ones claws, ears and limbs. The features and the edit use the same bands, without another decomposition.",
        ))
}
