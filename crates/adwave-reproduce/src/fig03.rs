//! Fig. 3: a scaling function and a wavelet on a surface.

use crate::draw::{Sheet, SheetPanel, ValueRange, View};
use crate::numbers::{decomposer, distance, extent};
use crate::{Context, FigureError, Outcome, Table, Verdict, digits};
use adwave::bands::Schedule;
use adwave::shape::{diagonal, vertex_normals};

const N_VERTICES: usize = 14_000;
/// Number of levels in the table.
const N_LEVELS: usize = 10;
/// Smallest width of the wavelet that is drawn, as a share of the diagonal.
const WIDTH: f64 = 0.045;
/// Largest rounding error of sums that are 0 or 1.
const ROUNDING: f64 = 1e-9;
/// Share of the largest entry below which an entry does not count as support.
const NEGLIGIBLE: f64 = 1e-6;

#[expect(clippy::too_many_lines, reason = "one figure, from its first number to its verdict")]
pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let model = context.model_or(&["bunny", "kitten"], "creature", N_VERTICES)?;
    let decomposer = decomposer(&model);
    let size = diagonal(model.points());
    let sigma = |j: usize| decomposer.operator().step_length() * ((j as f64 - 1.0) / 2.0).exp2();
    let shown = (3..=N_LEVELS).find(|&j| sigma(j) >= WIDTH * size).unwrap_or(N_LEVELS);
    let vertex = facing_vertex(&model);
    let center = model.points()[vertex];
    let classes = decomposer.vertex_map().as_slice();
    let areas = decomposer.areas();
    // Sums are over welded vertices: only the first vertex of each counts.
    let mut first = vec![true; model.points().len()];
    let mut seen = vec![false; decomposer.n_places()];
    for (x, &class) in classes.iter().enumerate() {
        first[x] = !std::mem::replace(&mut seen[class as usize], true);
    }
    let each = |f: &[f64]| -> Vec<(usize, f64)> {
        f.iter().copied().enumerate().filter(|&(x, _)| first[x]).collect()
    };
    let mut table = Table::new(
        "fig03.csv",
        "The functions of one vertex, level by level",
        &[
            "level",
            "sigma (% of diagonal)",
            "sum of phi",
            "smallest phi",
            "vertices phi reaches (%)",
            "sum of psi",
            "psi at the vertex",
            "smallest psi",
            "share of |psi| within 4 sigma (%)",
        ],
    );
    let (mut sums_hold, mut local, mut oscillates) = (true, true, true);
    let mut pictured = None;
    for j in 1..=N_LEVELS {
        context.progress.step(j as u64, N_LEVELS as u64)?;
        let both = decomposer.basis_of_vertex(vertex, &Schedule::dyadic(j)?, adwave::Progress::none())?;
        let (phi, psi) = (each(&both.scaling_function), each(&both.wavelet));
        let sum = |f: &[(usize, f64)]| f.iter().map(|v| v.1).sum::<f64>();
        let low = extent(&both.scaling_function).0;
        let psi_low = extent(&both.wavelet).0;
        let highest = extent(&both.scaling_function).1;
        let reached = phi.iter().filter(|v| v.1 > NEGLIGIBLE * highest).count() as f64 / phi.len() as f64;
        let total: f64 = psi.iter().map(|v| v.1.abs()).sum();
        let within = psi.iter().filter(|(x, _)| distance(&model.points()[*x], &center) <= 4.0 * sigma(j));
        let share = within.map(|v| v.1.abs()).sum::<f64>() / total;
        sums_hold &= (sum(&phi) - 1.0).abs() < ROUNDING && sum(&psi).abs() < ROUNDING && low >= 0.0;
        if j <= shown {
            local &= reached < 0.5 && share > 0.95;
            oscillates &= both.wavelet[vertex] > 0.0 && psi_low < 0.0;
        }
        table.push([
            j.to_string(),
            digits(100.0 * sigma(j) / size),
            format!("{:.10}", sum(&phi)),
            digits(low),
            digits(100.0 * reached),
            digits(sum(&psi)),
            digits(both.wavelet[vertex]),
            digits(psi_low),
            digits(100.0 * share),
        ]);
        if j + 1 == shown || j == shown {
            pictured = Some((pictured.take().map(|(_, now)| now), both));
        }
    }
    let Some((Some(before), now)) = pictured else {
        return Err("a level and one before it are shown".into());
    };
    // Entries are masses of vertices. Divided by area they are densities, which do not depend on the sizes of vertices.
    let mean_area = areas.iter().sum::<f64>() / areas.len().max(1) as f64;
    let density = |f: &[f64]| -> Vec<f64> {
        f.iter().zip(&areas).map(|(v, a)| if *a > 0.0 { v / a * mean_area } else { f64::NAN }).collect()
    };
    let top = extent(&density(&before.scaling_function)).1;
    let wave = density(&now.wavelet);
    let most = wave.iter().copied().filter(|v| v.is_finite()).fold(0.0, |m: f64, v| m.max(v.abs()));
    // The colors saturate at half of the peak, so that the wide and shallow ring is visible.
    let range = ValueRange::Fixed(-0.5 * most, 0.5 * most);
    let mut sheet = Sheet::new(3).view(View { azimuth: 0.0, elevation: 10.0 });
    sheet.push(SheetPanel::new(&model, format!("φ_{}", shown - 1)).field_in_range(
        &density(&before.scaling_function),
        "φ by area",
        ValueRange::Fixed(0.0, top),
    ));
    sheet.push(SheetPanel::new(&model, format!("φ_{shown}")).field_in_range(
        &density(&now.scaling_function),
        "φ by area",
        ValueRange::Fixed(0.0, top),
    ));
    sheet.push(SheetPanel::new(&model, format!("ψ_{shown} = φ_{} − φ_{shown}", shown - 1)).field_in_range(
        &wave,
        "ψ by area",
        range,
    ));
    let verdict = Verdict::from_parts(
        &[sums_hold, local, oscillates],
        format!(
            "On all {N_LEVELS} levels, φ is not negative and sums to 1, and ψ sums to 0 within {ROUNDING:e}: {}. Up \
             to level {shown}, the support of φ is less than half of the vertices and 95 % of |ψ| lie within 4σ: {}. \
             ψ is positive at the vertex and negative around it: {}.",
            yes(sums_hold),
            yes(local),
            yes(oscillates)
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(model.label())
        .sheet(
            "fig03.png",
            format!(
                "The scaling functions of vertex {vertex} on levels {} and {shown}, in the same range of colors, and \
                 their difference, the wavelet of level {shown}.",
                shown - 1
            ),
            &sheet,
            context,
        )?
        .table(table)
        .say(
            "A scaling function is the distribution of a random walk from one vertex after 2^(j−1) steps: a bump that \
             becomes wider and flatter from level to level. The wavelet is the difference of two of them: a peak \
             surrounded by a ring of the opposite sign, as in one dimension.",
        ))
}

/// Finds the vertex near the upper center that faces the viewer most: the chest or forehead of a figure.
fn facing_vertex(model: &crate::Model) -> usize {
    let points = model.points();
    let normals = vertex_normals(points, &model.triangles);
    let middle = adwave::shape::bounding_box(points).map_or([0.0; 3], |(low, high)| {
        std::array::from_fn(|c| {
            if c == 1 { low[c] + 0.55 * (high[c] - low[c]) } else { 0.5 * (low[c] + high[c]) }
        })
    });
    let size = diagonal(points).max(f64::MIN_POSITIVE);
    let score = |x: usize| {
        let away = ((points[x][0] - middle[0]).powi(2) + (points[x][1] - middle[1]).powi(2)).sqrt() / size;
        normals[x][2] + points[x][2] / size - 6.0 * away
    };
    (0..points.len()).max_by(|&x, &y| score(x).total_cmp(&score(y))).unwrap_or(0)
}

fn yes(holds: bool) -> &'static str {
    if holds { "yes" } else { "no" }
}
