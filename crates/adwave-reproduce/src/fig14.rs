//! Fig. 14: four global filters.

use crate::draw::{Sheet, SheetPanel};
use crate::numbers::{bands, decomposer, positions};
use crate::{Context, FigureError, Model, Outcome, Table, Verdict, digits};
use adwave::bands::{BandsParams, Schedule};
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::measure::rms;
use adwave::region::Region;
use adwave::shape::{diagonal, vertex_normals};
use std::ops::Range;
use std::sync::Arc;

/// Number of levels, as in Table 2 of the paper.
const N_LEVELS: usize = 7;
/// Number of coarsest bands that are ignored, because half of their content is in S_f(J), which no filter changes.
const N_EDGE: usize = 2;
/// Titles of the columns, and their presets.
const COLUMNS: [(&str, Preset); 4] = [
    ("suppression", Preset::SuppressPaper),
    ("enhancement", Preset::Enhance),
    ("band 1: fine kept, middle dropped", Preset::Band1),
    ("band 2: fine dropped, middle raised", Preset::Band2),
];

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let requests: [(&[&str], &str, usize); 2] = [
        (&["gargoyle", "armadillo", "skull"], "creature", 25_011),
        (&["buddha", "dinosaur", "bunny"], "plane", 25_003),
    ];
    let models: Vec<Arc<Model>> = requests
        .iter()
        .map(|(names, sample, n)| context.model_or(names, sample, *n))
        .collect::<Result<_, _>>()?;
    let mut table = Table::new(
        "fig14.csv",
        "Detail after each filter divided by detail before: energy of the bands of the normals, with the operator \
         of the original",
        &["shape", "filter", "fine detail", "middle detail", "moved, rms (% of diagonal)"],
    );
    let n_fine = N_LEVELS.div_ceil(3);
    let schedule = Schedule::dyadic(N_LEVELS)?;
    let mut sheet = Sheet::new(5).own_cameras();
    let (mut as_named, mut failed) = (Vec::new(), Vec::new());
    for model in &models {
        let decomposer = decomposer(model);
        // In the normals, details of every size count as they are seen. In the coordinates, the coarse bands are far
        // larger and leak into the fine ones.
        let detail = |points: &[[f64; 3]]| -> Result<[f64; 2], FigureError> {
            let normals = vertex_normals(points, &model.triangles);
            let split = bands(context, &decomposer, normals.as_flattened(), 3, N_LEVELS)?;
            let energy =
                |levels: Range<usize>| levels.flat_map(|k| split.wavelet(k + 1)).map(|w| w * w).sum::<f64>();
            Ok([energy(0..n_fine), energy(n_fine..N_LEVELS - N_EDGE)])
        };
        let before = detail(model.points())?;
        sheet.push(SheetPanel::new(model, format!("original {}", model.name)));
        for (name, preset) in COLUMNS {
            let layers = [Layer { gains: Gains::Preset(preset), region: Region::Everywhere {} }];
            let edit = Edit::new(&layers);
            let params = BandsParams::default();
            let after = decomposer
                .request(model.coordinates(), 3, &schedule)
                .params(&params)
                .progress(context.progress)
                .filter(&edit)?;
            let after = positions(&after);
            let now = detail(&after)?;
            let [fine, other] = [now[0] / before[0], now[1] / before[1]];
            as_named.push(match preset {
                Preset::Suppress | Preset::SuppressPaper => fine < 0.5 && other < 1.0,
                Preset::Enhance => fine > 1.0 && other > 1.0,
                Preset::Band1 => fine > other && other < 0.5,
                Preset::Band2 => fine < other && other > 1.0,
                other => unreachable!("{other:?} is not in the figure"),
            });
            let short = name.split(':').next().unwrap_or(name);
            if as_named.last() == Some(&false) {
                failed.push(format!("{short} on the {}", model.name));
            }
            let moved = 100.0 * rms(after.as_flattened(), model.coordinates(), 3) / diagonal(model.points());
            table.push([model.name.clone(), short.to_owned(), digits(fine), digits(other), digits(moved)]);
            sheet.push(SheetPanel::with_points(model, after, name));
        }
    }
    let n = as_named.iter().filter(|&&holds| holds).count();
    let verdict = Verdict::from_parts(
        &as_named,
        format!(
            "{n} of {} filters do what their names say, measured by the bands of the normals: suppression leaves less \
             than half of the fine detail and reduces the middle, enhancement increases both, band 1 removes more \
             than half of the middle and less of the fine detail, band 2 increases the middle and reduces the fine \
             detail.{}",
            as_named.len(),
            if failed.is_empty() { String::new() } else { format!(" Not: {}.", failed.join(", ")) }
        ),
    );
    let mut outcome = Outcome::new(verdict)
        .sheet(
            "fig14.png",
            "From left to right: the original, suppression, enhancement and the two band filters.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "Each band has one gain for the whole shape. Suppression removes all seven bands. Enhancement amplifies \
             all, the fine ones most. Band 1 keeps the finest three and removes the rest, which gives fine texture on \
             a smooth body. Band 2 does the opposite and doubles the middle. Bands overlap in frequency, so that no \
             filter affects details of a single size only.",
        );
    for model in &models {
        outcome = outcome.add_shape(model.label());
    }
    Ok(outcome)
}
