//! Fig. 5: a shape and a field on it, from the finest to the coarsest scale.

use crate::draw::{ORANGE, Sheet, SheetPanel, ValueRange};
use crate::numbers::{bands, decomposer, extent, mean_curvature, positions};
use crate::{Context, FigureError, Model, Outcome, Table, Verdict, digits};
use adwave::Decomposer;
use adwave::shape::{Polygons, diagonal};
use adwave_io::ShapeFile;
use adwave_render::value_range;

const N_VERTICES: usize = 14_000;
/// Largest number of levels, at which the diffusion is stationary: 2^23 steps.
const MAX_LEVELS: usize = 24;
/// Levels that are drawn in addition to the coarsest.
const DRAWN_LEVELS: [usize; 4] = [0, 6, 9, 12];
/// Largest spread of a component that counts as constant, relative to the spread of the signal there.
const CONSTANT: f64 = 1e-3;

#[expect(clippy::too_many_lines, reason = "one figure, from its first number to its verdict")]
pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let model = context.model_or(&["dinosaur", "kitten", "bunny"], "creature", N_VERTICES)?;
    let model_decomposer = decomposer(&model);
    let size = diagonal(model.points());
    let n_levels = levels(&model_decomposer, size);
    let curvature = mean_curvature(&model_decomposer)?;
    let shape = bands(context, &model_decomposer, model.coordinates(), 3, n_levels)?;
    let field = bands(context, &model_decomposer, &curvature, 1, n_levels)?;

    let mut table = Table::new(
        "fig05.csv",
        "Spread of the scaling coefficients of one component, level by level",
        &[
            "level",
            "steps",
            "sigma (% of diagonal)",
            "extent of the shape (% of diagonal)",
            "spread of the curvature (%)",
        ],
    );
    let spread = |values: &[f64]| {
        let (low, high) = extent(values);
        high - low
    };
    let at_first = spread(&curvature);
    for j in 0..=n_levels {
        table.push([
            j.to_string(),
            shape.steps[j].to_string(),
            digits(100.0 * shape.sigma[j] / size),
            digits(100.0 * diagonal(&positions(&shape.scaling(j))) / size),
            digits(100.0 * spread(&field.scaling(j)) / at_first),
        ]);
    }

    let shown = [DRAWN_LEVELS[0], DRAWN_LEVELS[1], DRAWN_LEVELS[2], DRAWN_LEVELS[3], n_levels];
    let (low, high) = value_range(&curvature, 0.02, 0.98);
    let mut sheet = Sheet::new(shown.len());
    for j in shown {
        let points = positions(&shape.scaling(j));
        let extent = diagonal(&points) / size;
        let mut panel = SheetPanel::with_points(&model, points.clone(), format!("shape, S_f({j})"));
        if extent < 0.02 {
            // A single point is invisible.
            panel = panel.balls(&model, [(points[0], 0.012 * size)], ORANGE);
        }
        sheet.push(panel);
    }
    for j in shown {
        let panel = SheetPanel::new(&model, format!("curvature, S_f({j})"));
        sheet.push(panel.field_in_range(&field.scaling(j), "1/model unit", ValueRange::Fixed(low, high)));
    }

    let cases = [
        Case {
            name: model.name.clone(),
            decomposer: model_decomposer,
            signal: curvature,
            coarsest: field.coarsest().to_vec(),
        },
        two_components(context)?,
    ];
    let mut limits = Table::new(
        "fig05-limits.csv",
        "Constant of each connected component at the coarsest level",
        &[
            "shape",
            "component",
            "vertices",
            "mean by the stationary distribution",
            "mean by area",
            "smallest S_f(J)",
            "largest S_f(J)",
        ],
    );
    let (mut constant, mut stationary, mut by_area) = (true, true, true);
    for case in &cases {
        for one in case.limits() {
            constant &= one.high - one.low <= CONSTANT * one.spread;
            stationary &= one.low.min(one.stationary) + CONSTANT * one.spread >= one.high.max(one.stationary);
            by_area &= one.low.min(one.area) + CONSTANT * one.spread >= one.high.max(one.area);
            limits.push([
                case.name.clone(),
                one.component.to_string(),
                one.n_vertices.to_string(),
                format!("{:.6}", one.stationary),
                format!("{:.6}", one.area),
                format!("{:.6}", one.low),
                format!("{:.6}", one.high),
            ]);
        }
    }
    let yes = |holds: bool| if holds { "yes" } else { "no" };
    let verdict = Verdict::from_parts(
        &[constant, stationary, by_area],
        format!(
            "At the coarsest level the field is constant on every component (its spread is below {} % of that of the \
             signal): {}. The constant is the mean weighted by the stationary distribution: {}; it is the mean \
             weighted by area, as in eq. 10: {}. Every component has its own constant.",
            100.0 * CONSTANT,
            yes(constant),
            yes(stationary),
            yes(by_area)
        ),
    );
    Ok(Outcome::new(verdict)
        .add_shape(model.label())
        .sheet(
            "fig05.png",
            format!(
                "Top: the shape on levels 0, 6, 9, 12 and {n_levels}, at the same scale. A constant shape is a point, \
                 marked by a ball. Bottom: mean curvature on the same levels, on the original shape, in the same range of \
                 colors."
            ),
            &sheet,
            context,
        )?
        .table(table)
        .table(limits)
        .say(format!(
            "Level {n_levels} has {} steps of diffusion. The shape loses its details, then its limbs, and becomes a \
             point; the curvature becomes a constant.",
            shape.steps[n_levels]
        ))
        .say(
            "According to eq. 10 of the paper, the scaling functions converge to the constant 1/A(M). Instead they \
             converge to the stationary distribution of the operator, which is nearly but not exactly proportional to \
             area, separately on each component, since nothing diffuses from one component to another.",
        ))
}

/// Number of levels until σ exceeds three diagonals, where the walk is stationary.
fn levels(decomposer: &Decomposer, size: f64) -> usize {
    let step = decomposer.operator().step_length();
    (DRAWN_LEVELS[3] + 1..MAX_LEVELS)
        .find(|&j| step * ((j as f64 - 1.0) / 2.0).exp2() >= 3.0 * size)
        .unwrap_or(MAX_LEVELS)
}

/// Signal and its coarsest level.
struct Case {
    name: String,
    decomposer: Decomposer,
    signal: Vec<f64>,
    coarsest: Vec<f64>,
}

/// Limit of the diffusion on a component.
struct Limit {
    component: usize,
    n_vertices: usize,
    stationary: f64,
    area: f64,
    low: f64,
    high: f64,
    /// Largest minus smallest value of the signal.
    spread: f64,
}

impl Case {
    /// Computes the limits on all components with more than one vertex.
    fn limits(&self) -> Vec<Limit> {
        let neighbors = self.decomposer.neighbors();
        let n = self.decomposer.n_places();
        let mut component = vec![usize::MAX; n];
        let mut n_components = 0;
        for start in 0..n {
            let mut open = vec![start];
            if component[start] != usize::MAX {
                continue;
            }
            component[start] = n_components;
            while let Some(x) = open.pop() {
                for &y in neighbors.row(x) {
                    if component[y as usize] == usize::MAX {
                        component[y as usize] = n_components;
                        open.push(y as usize);
                    }
                }
            }
            n_components += 1;
        }
        let vertex_map = self.decomposer.vertex_map();
        let (signal, coarsest) = (vertex_map.mean(&self.signal, 1), vertex_map.mean(&self.coarsest, 1));
        let mut areas = vec![0.0; n];
        for (&class, area) in vertex_map.as_slice().iter().zip(self.decomposer.areas()) {
            areas[class as usize] += area;
        }
        let operator = self.decomposer.operator();
        let law: Vec<f64> = (0..n).map(|x| operator.weights().weight(x, n)).collect();
        let of = |k: usize| -> Vec<usize> { (0..n).filter(|&x| component[x] == k).collect() };
        let mean = |vertices: &[usize], weight: &[f64]| {
            let total: f64 = vertices.iter().map(|&x| weight[x]).sum();
            vertices.iter().map(|&x| weight[x] * signal[x]).sum::<f64>() / total
        };
        let limit = |(k, vertices): (usize, Vec<usize>)| {
            let at = |values: &[f64]| extent(&vertices.iter().map(|&x| values[x]).collect::<Vec<_>>());
            let ((low, high), (least, most)) = (at(&coarsest), at(&signal));
            Limit {
                component: k + 1,
                n_vertices: vertices.len(),
                stationary: mean(&vertices, &law),
                area: mean(&vertices, &areas),
                low,
                high,
                spread: most - least,
            }
        };
        let parts = (0..n_components).map(of).filter(|vertices| vertices.len() > 1);
        parts.enumerate().map(limit).collect()
    }
}

/// Builds a torus and a distant plane with bumps: two components with different means.
fn two_components(context: &Context<'_>) -> Result<Case, FigureError> {
    const EACH: usize = 2500;
    let (torus, plane) = (context.built_in("torus", EACH)?, context.built_in("plane", EACH)?);
    let n = torus.points().len() as u32;
    let apart = plane.points().iter().map(|p| [p[0] + 5.0, p[1], p[2]]);
    let points: Vec<[f64; 3]> = torus.points().iter().copied().chain(apart).collect();
    let moved = plane.triangles.iter().map(|t| t.map(|v| v + n));
    let triangles: Vec<[u32; 3]> = torus.triangles.iter().copied().chain(moved).collect();
    let file = ShapeFile::from_mesh(points, Polygons::from_triangles(&triangles));
    let both = Model::from_file("torus and plane", file)?;
    let decomposer = decomposer(&both);
    let signal = mean_curvature(&decomposer)?;
    let n_levels = levels(&decomposer, diagonal(both.points()));
    let coarsest = bands(context, &decomposer, &signal, 1, n_levels)?.coarsest().to_vec();
    Ok(Case { name: both.name.clone(), decomposer, signal, coarsest })
}
