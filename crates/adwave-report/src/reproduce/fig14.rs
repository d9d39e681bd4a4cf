//! Fig. 14: four global filters.

use super::draw::{Frame, Sheet};
use super::numbers::{bands, positions, prepare_model};
use super::{Context, FigureError, Model, Outcome, Table, Verdict, digits};
use adwave::bands::{BandsParams, Schedule};
use adwave::filter::{Edit, Gains, Layer, Preset};
use adwave::measure::rms;
use adwave::region::Region;
use adwave::shape::{diagonal, vertex_normals};
use std::ops::Range;
use std::sync::Arc;

/// As in Table 2 of the paper.
const N_LEVELS: usize = 7;
/// The coarsest bands lie at the edge of what a filter reaches: half of them is in S_f(J), which no filter changes.
const N_EDGE: usize = 2;
/// The titles of the columns.
const COLUMNS: [(&str, Preset); 4] = [
    ("suppression", Preset::SuppressPaper),
    ("enhancement", Preset::Enhance),
    ("band 1: fine kept, middle dropped", Preset::Band1),
    ("band 2: fine dropped, middle raised", Preset::Band2),
];

pub(super) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let wanted: [(&[&str], &str, usize); 2] = [
        (&["gargoyle", "armadillo", "skull"], "creature", 25_011),
        (&["buddha", "dinosaur", "bunny"], "plane", 25_003),
    ];
    let models: Vec<Arc<Model>> = wanted
        .iter()
        .map(|(names, sample, n)| context.model_or(names, sample, *n))
        .collect::<Result<_, _>>()?;
    let mut table = Table::new(
        "fig14.csv",
        "Detail after each filter by detail before: energy of the bands of the normals, split by the operator of the original",
        &["shape", "filter", "fine detail", "middle detail", "moved, rms (% of diagonal)"],
    );
    let n_fine = N_LEVELS.div_ceil(3);
    let schedule = Schedule::dyadic(N_LEVELS)?;
    let mut sheet = Sheet::new(5).own_cameras();
    let (mut as_named, mut failed) = (Vec::new(), Vec::new());
    for model in &models {
        let decomposer = prepare_model(model);
        // By the normals of a surface detail of every size counts as it is seen; in the coordinates the coarse bands are
        // larger by far and reach into the fine ones.
        let detail = |points: &[[f64; 3]]| -> Result<[f64; 2], FigureError> {
            let normals = vertex_normals(points, &model.triangles);
            let split = bands(context, &decomposer, normals.as_flattened(), 3, N_LEVELS)?;
            let energy =
                |levels: Range<usize>| levels.flat_map(|k| split.wavelet(k + 1)).map(|w| w * w).sum::<f64>();
            Ok([energy(0..n_fine), energy(n_fine..N_LEVELS - N_EDGE)])
        };
        let before = detail(model.points())?;
        sheet.push(Frame::new(model, format!("original {}", model.name)));
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
            });
            let short = name.split(':').next().unwrap_or(name);
            if as_named.last() == Some(&false) {
                failed.push(format!("{short} on the {}", model.name));
            }
            let moved = 100.0 * rms(after.as_flattened(), model.coordinates(), 3) / diagonal(model.points());
            table.push([model.name.clone(), short.to_owned(), digits(fine), digits(other), digits(moved)]);
            sheet.push(Frame::moved(model, after, name));
        }
    }
    let n = as_named.iter().filter(|&&holds| holds).count();
    let verdict = Verdict::from_parts(
        &as_named,
        format!(
            "{n} of {} results are what their filter is named after, measured by the bands of the normals: suppression \
             leaves less than half of the fine detail and less of the middle, enhancement has more of both, band 1 takes more than half of the middle \
             and less of the fine, band 2 raises the middle and has less of the fine.{}",
            as_named.len(),
            if failed.is_empty() { String::new() } else { format!(" Not: {}.", failed.join(", ")) }
        ),
    );
    let mut outcome = Outcome::new(verdict)
        .sheet(
            "fig14.png",
            "From left to right: the original, suppression, enhancement, and the two band filters.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "One gain a band, everywhere alike. Suppression takes all seven bands away; enhancement strengthens all, the \
             fine ones most; band 1 keeps the finest three and drops the rest, so that fine texture sits on a smooth body; \
             band 2 does the opposite and doubles what is in the middle. Bands overlap in frequency, so that no filter acts \
             on one size of detail alone.",
        );
    for model in &models {
        outcome = outcome.on(model.label());
    }
    Ok(outcome)
}
