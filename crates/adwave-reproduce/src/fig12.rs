//! Fig. 12: clouds of points.

use crate::draw::{Sheet, SheetPanel};
use crate::numbers::{bands, decomposer};
use crate::{Context, FigureError, Model, Outcome, Table, Verdict, digits};
use adwave::features::{FeatureParams, Response};
use adwave::measure::{correlation, rank_correlation};
use adwave::saliency::SaliencyParams;
use adwave::sample::{SAMPLE_NAMES, Sample};
use adwave_io::ShapeFile;
use adwave_report::analysis::{features, saliency};
use std::sync::Arc;

/// Number of levels in the paper, with which only levels 2 and 3 can have features.
const PAPER_LEVELS: usize = 4;
/// Number of levels with which five levels can have features.
const N_LEVELS: usize = 7;
/// Smallest correlation at which the map of a cloud equals that of its mesh.
const AGREES: f64 = 0.8;

/// Name of the cloud of points sampled at random from the surface of the creature, which are not its vertices.
const SAMPLED: &str = "points sampled from the creature";

#[expect(clippy::too_many_lines, reason = "one figure, from its first number to its verdict")]
pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    // The paper's clouds, and sizes like theirs.
    let requests: [(&[&str], &str, usize); 3] = [
        (&["pegaso", "bunny"], "creature", 30_000),
        (&["kitten"], SAMPLED, 16_612),
        (&["horse"], "plane", 10_296),
    ];
    let mut table = Table::new(
        "fig12.csv",
        "Clouds compared with their meshes",
        &[
            "cloud",
            "points",
            "correlation with the map of the mesh",
            "of ranks",
            "with equal steps instead of equal widths",
            "features, 7 levels",
            "features, 4 levels",
            "features, 4 levels, as printed",
        ],
    );
    let model = |(names, sample, n): &(&[&str], &str, usize)| match context.model(names) {
        None if *sample == SAMPLED => sample_creature((*n).min(context.most_vertices)),
        _ => Ok(context.model_or(names, sample, *n)?),
    };
    let models: Vec<Arc<Model>> = requests.iter().map(model).collect::<Result<_, FigureError>>()?;
    let clouds: Vec<Model> =
        models.iter().map(|m| if m.triangles.is_empty() { Model::clone(m) } else { m.cloud() }).collect();
    let mut sheet = Sheet::new(models.len()).own_cameras();
    let mut below = Vec::new();
    let (mut least, mut found_in_all) = (1.0_f64, true);
    for (model, cloud) in models.iter().zip(&clouds) {
        let cloud_decomposer = decomposer(cloud);
        let split = bands(context, &cloud_decomposer, cloud.coordinates(), 3, N_LEVELS)?;
        let map = saliency(&cloud_decomposer, &split, &SaliencyParams::paper())?.map;
        let found = features(&cloud_decomposer, &split, &FeatureParams::default())?;
        let short = bands(context, &cloud_decomposer, cloud.coordinates(), 3, PAPER_LEVELS)?;
        let few = features(&cloud_decomposer, &short, &FeatureParams::default())?;
        let printed = FeatureParams::default().with_response(Response::Literal);
        let printed = features(&cloud_decomposer, &short, &printed)?;
        // The walk on the mesh has another step length: the levels of the mesh get the widths of those of the cloud.
        let mesh_decomposer = decomposer(model);
        let alike = if model.triangles.is_empty() {
            (f64::NAN, f64::NAN, f64::NAN)
        } else {
            let widths = &split.sigma[1..];
            let schedule =
                adwave::bands::Schedule::lengths(widths, mesh_decomposer.operator().step_length())?;
            let params = adwave::bands::BandsParams::default();
            let of_mesh = mesh_decomposer
                .request(model.coordinates(), 3, &schedule)
                .params(&params)
                .progress(context.progress)
                .bands()?;
            let skip = SaliencyParams::paper().skip.min(of_mesh.n_levels() - 1);
            let of_mesh = saliency(&mesh_decomposer, &of_mesh, &SaliencyParams::paper().with_skip(skip))?.map;
            let by_steps = bands(context, &mesh_decomposer, model.coordinates(), 3, N_LEVELS)?;
            let by_steps = saliency(&mesh_decomposer, &by_steps, &SaliencyParams::paper())?.map;
            (correlation(&map, &of_mesh), rank_correlation(&map, &of_mesh), correlation(&map, &by_steps))
        };
        least = if alike.0.is_nan() { least } else { least.min(alike.0) };
        found_in_all &= !found.is_empty();
        table.push([
            model.name.clone(),
            cloud.points().len().to_string(),
            digits(alike.0),
            digits(alike.1),
            digits(alike.2),
            found.len().to_string(),
            few.len().to_string(),
            printed.len().to_string(),
        ]);
        sheet.push(SheetPanel::new(cloud, format!("saliency, {}", cloud.name)).saliency(&map));
        below.push(SheetPanel::new(cloud, format!("{} features", found.len())).features(cloud, &found));
    }
    for panel in below {
        sheet.push(panel);
    }
    let verdict = Verdict::from_parts(
        &[least >= AGREES, found_in_all],
        format!(
            "If the levels of the mesh have the widths of those of the cloud, the maps of clouds and meshes agree: \
             the correlation is at least {least:.2} (they agree from {AGREES} on). Features are found on {} cloud.",
            if found_in_all { "every" } else { "not every" }
        ),
    );
    let mut outcome = Outcome::new(verdict)
        .sheet(
            "fig12.png",
            "Points without faces. Top: saliency of the coordinates. Bottom: features with their sizes.",
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "The diffusion operator connects the 10 nearest points, in both directions, and W_f(j, x) is the \
             Euclidean norm over the three coordinates. The paper has 4 levels, with which only levels 2 and 3 can \
             have features; the pictures have 7 levels. The response as printed finds almost no features of \
             coordinates; the pictures show the normalized response. Borders of a surface are salient too, since \
             borders are not filtered, as in the paper.",
        );
    for model in &models {
        outcome = outcome.add_shape(model.label());
    }
    Ok(outcome)
}

fn sample_creature(n_points: usize) -> Result<Arc<Model>, FigureError> {
    const SEED: u64 = 12;
    let fewest = SAMPLE_NAMES.iter().find(|s| s.name == "creature").map_or(0, |s| s.min_vertices);
    let cloud = Sample::from_name("creature", Some(n_points.max(fewest)))?.draw_cloud(n_points, SEED)?;
    Ok(Arc::new(Model::from_file(SAMPLED, ShapeFile::from_cloud(cloud.points))?))
}
