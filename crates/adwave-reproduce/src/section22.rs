//! Section 2.2: subdivision wavelets compared with the bands, by compaction and by dependence on place.

use crate::draw::{Sheet, SheetPanel, ValueRange};
use crate::numbers::{decomposer, distance, extent, percent};
use crate::{Context, FigureError, Model, Outcome, Table, Verdict, digits};
use adwave::Progress;
use adwave::bands::{BandsParams, Schedule};
use adwave::shape::{MeshArea, diagonal, mesh_areas};
use adwave::vector::{Vector, add_scaled, cross, dot, norm, subtract};
use adwave_baselines::compare::{Comparison, ComparisonInput, Method, compare};
use adwave_io::ShapeFile;
use adwave_subdivision::{Family, HaarWavelets, Hierarchy, LiftedWavelets, SubdivisionError, subdivide};

/// Number of subdivisions of the ball; its vertices are more than enough for its finest bumps.
const N_LEVELS: usize = 5;
/// Number of vertices of the shape without levels.
const N_VERTICES: usize = 14_000;
/// Number of bands in the comparison.
const N_BANDS: usize = 8;
/// Level whose wavelets are drawn: those of the vertices that the ball with 162 vertices has in addition to the ball
/// with 42.
const DRAWN_LEVEL: usize = 4;
/// Largest rounding error of a lossless reconstruction, in model units of a ball of radius 1.
const LOSSLESS: f64 = 1e-12;
/// Share of a wavelet's energy that lies within its core.
const CORE: f64 = 0.99;

/// Beginnings of the names of the quantities on which the verdict is based, as in the comparison.
const COMPACTION: &str = "error with a tenth";
const PLACE: &str = "share of a bump's energy";
const RECONSTRUCTION: &str = "largest error";

pub(crate) fn make(context: &Context<'_>) -> Result<Outcome, FigureError> {
    let ball = ball_of_bumps(N_LEVELS)?;
    let creature = context.built_in("creature", N_VERTICES)?;
    let hierarchy = levels(&ball)?;
    let has_none = levels(&creature).is_err();
    let on_ball = comparison(context, &ball)?;
    let on_creature = comparison(context, &creature)?;

    let mut table = Table::new(
        "section22.csv",
        "Bands (ADW) and wavelets by lifting (LW) on the coordinates; LW are of the family butterfly on the ball and of \
         the family irregular on the creature",
        &["quantity", "ball: ADW", "ball: LW", "creature: ADW", "creature: LW"],
    );
    let shown = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), digits);
    for (a, b) in on_ball.rows.iter().zip(&on_creature.rows) {
        table.push([a.quantity.clone(), shown(a.adwave), shown(a.other), shown(b.adwave), shown(b.other)]);
    }

    let (waves, cores) = wavelets(&ball, &hierarchy)?;
    let [kept_a, kept_b] = [&on_ball, &on_creature].map(|c| quantity(c, COMPACTION));
    let [place_a, place_b] = [&on_ball, &on_creature].map(|c| quantity(c, PLACE));
    let [error_a, error_b] = [&on_ball, &on_creature].map(|c| quantity(c, RECONSTRUCTION));
    let lossless = [error_a, error_b].iter().flatten().all(|e| *e < LOSSLESS * creature_size(&creature));
    let local = cores.iter().all(|share| *share < 0.5);
    let verdict = Verdict::from_parts(
        &[
            lossless && local,
            has_none,
            kept_a[1] < kept_a[0] && kept_b[1] < kept_b[0],
            place_a[1] > place_a[0] && place_b[1] > place_b[0],
        ],
        format!(
            "Subdivision wavelets reconstruct the coordinates to {} and are local: 99 % of the energy of each of the \
             drawn ones lie on at most {} of the ball. They rely on subdivision connectivity: the creature {}. They suit compression: with a tenth \
             as many coefficients as values, {} and {} % of the deviation are lost, by the bands {} and {} %. They \
             depend on the meshing: moved to 60 places, the share of a bump's energy on its strongest level varies by \
             {} and {} %, on its strongest band by {} and {} %.",
            digits(error_a[1].max(error_b[1])),
            percent(cores.iter().copied().fold(0.0, f64::max)),
            if has_none {
                "has none, and wavelets on levels of removed vertices replace them"
            } else {
                "has it"
            },
            digits(kept_a[1]),
            digits(kept_b[1]),
            digits(kept_a[0]),
            digits(kept_b[0]),
            digits(place_a[1]),
            digits(place_b[1]),
            digits(place_a[0]),
            digits(place_b[0]),
        ),
    );
    let coarse = coarse_balls(&ball, &hierarchy)?;
    let mut sheet = Sheet::new(coarse.len()).facets();
    for model in &coarse {
        sheet.push(SheetPanel::new(model, format!("{} vertices", model.points().len())));
    }
    let mut functions = Sheet::new(3);
    for wave in &waves {
        let most = extent(&wave.values).1.max(-extent(&wave.values).0);
        functions.push(SheetPanel::new(&wave.model, wave.name.clone()).field_in_range(
            &wave.values,
            "ψ",
            ValueRange::Fixed(-0.6 * most, 0.6 * most),
        ));
    }
    Ok(Outcome::new(verdict)
        .add_shape(ball.label())
        .add_shape(creature.label())
        .sheet("section22-levels.png", "A ball with bumps and its exact coarser levels.", &sheet, context)?
        .sheet(
            "section22-wavelets.png",
            "One wavelet of each family around the same place, and the wavelet of a band of a similar width. Colors \
             saturate at 60 % of the largest value.",
            &functions,
            context,
        )?
        .table(table)
        .say(
            "The paper discusses wavelets on levels of subdivision as the older way: lifting predicts the vertices that \
             a level adds and updates the others, so that there are as many coefficients as values and each coarse level \
             is a mesh. The bands have no levels of vertices: J + 1 numbers per value, whose meaning does not depend on \
             how a place is meshed.",
        )
        .say(
            "Both directions are measured by `adwave compare --with subdivision`. The loss of the bands with few \
             coefficients is no fault of theirs, since they are redundant on purpose; neither is the dependence of \
             subdivision wavelets on place, since only some of the vertices have wide wavelets.",
        )
        .table(sizes(&hierarchy)))
}

/// Finds the levels of subdivision of a model.
fn levels(model: &Model) -> Result<Hierarchy, SubdivisionError> {
    Hierarchy::new(model.points().len(), &model.triangles, Progress::none())
}

/// Compares bands and wavelets by lifting on the coordinates.
fn comparison(context: &Context<'_>, model: &Model) -> Result<Comparison, FigureError> {
    let start = std::time::Instant::now();
    let decomposer = decomposer(model);
    let prepare_seconds = Some(start.elapsed().as_secs_f64());
    let schedule = Schedule::dyadic(N_BANDS)?;
    let params = BandsParams::default();
    let input = ComparisonInput {
        shape: &model.shape,
        grid: None,
        decomposer: &decomposer,
        prepare_seconds,
        schedule: &schedule,
        params: &params,
        signal: model.coordinates(),
        n_channels: 3,
        n_harmonics: 1,
    };
    Ok(compare(&input, Method::Subdivision, context.progress)?)
}

/// Numbers of adwave and of the other method for a quantity; NaN for a missing number, for which no claim holds.
fn quantity(comparison: &Comparison, beginning: &str) -> [f64; 2] {
    let row = comparison.rows.iter().find(|row| row.quantity.starts_with(beginning));
    row.map_or([f64::NAN; 2], |row| [row.adwave, row.other].map(|value| value.unwrap_or(f64::NAN)))
}

fn creature_size(model: &Model) -> f64 {
    diagonal(model.points()).max(1.0)
}

fn sizes(hierarchy: &Hierarchy) -> Table {
    let mut table = Table::new("section22-levels.csv", "Levels of the ball", &["level", "vertices", "faces"]);
    for level in 0..=hierarchy.n_levels() {
        table.push([
            level.to_string(),
            hierarchy.n_vertices(level).to_string(),
            hierarchy.n_faces(level).to_string(),
        ]);
    }
    table
}

/// Returns the ball and its coarser levels, down to 42 vertices, each as a mesh.
fn coarse_balls(ball: &Model, hierarchy: &Hierarchy) -> Result<Vec<Model>, FigureError> {
    let mut models = Vec::new();
    for level in 0..hierarchy.n_levels() {
        let points = hierarchy.vertices(level)?.iter().map(|&v| ball.points()[v as usize]).collect();
        let triangles = hierarchy.triangles(level)?;
        models.push(Model::from_file("level", ShapeFile::from_mesh(points, triangles.into()))?);
    }
    Ok(models)
}

/// Wavelet on a model, with one value per vertex.
struct Wave {
    name: String,
    model: Model,
    values: Vec<f64>,
}

/// Computes a wavelet of each family and one of the bands, all around about the same place, and for each the share of
/// the ball that holds most of its energy.
fn wavelets(ball: &Model, hierarchy: &Hierarchy) -> Result<(Vec<Wave>, Vec<f64>), FigureError> {
    let (points, none) = (ball.points(), Progress::none);
    let areas = mesh_areas(points, &ball.triangles, MeshArea::Barycentric);
    let (mut waves, mut cores) = (Vec::new(), Vec::new());
    let mut push = |name: String, model: Model, values: Vec<f64>| {
        cores.push(core(&values));
        waves.push(Wave { name, model, values });
    };
    for family in [Family::Linear, Family::Butterfly, Family::Loop] {
        let lifted = LiftedWavelets::new(hierarchy, family, &areas, none())?;
        let vertex = facing_vertex(points, |v| lifted.levels()[v] as usize == DRAWN_LEVEL);
        let values = lifted.synthesize(&unit(points.len(), vertex), 1, none())?;
        push(family.to_string(), ball.clone(), values);
    }
    let lifted = LiftedWavelets::new_irregular(points, &ball.triangles, &areas, none())?;
    // This family has more levels: take the coarsest with at least as many vertices, and a vertex near that level.
    let fewest = hierarchy.n_vertices(DRAWN_LEVEL);
    let level = (1..=lifted.n_levels()).rev().find(|&k| lifted.n_vertices_at(k) >= fewest).unwrap_or(1);
    let vertex = facing_vertex(points, |v| (lifted.levels()[v] as usize).abs_diff(level) <= 2);
    push("irregular".to_owned(), ball.clone(), lifted.synthesize(&unit(points.len(), vertex), 1, none())?);

    let (soup, corners) = separate_faces(ball)?;
    let centers: Vec<[f64; 3]> =
        ball.triangles.iter().map(|t| center(t.map(|v| points[v as usize]))).collect();
    let face_areas: Vec<f64> = ball.triangles.iter().map(|t| area(t.map(|v| points[v as usize]))).collect();
    let haar = HaarWavelets::new(hierarchy, &face_areas)?;
    let zero = haar.analyze(&vec![0.0; centers.len()], 1, none())?;
    let face = facing_vertex(&centers, |f| zero.levels[f] as usize == DRAWN_LEVEL);
    let on_faces = haar.synthesize(&unit(centers.len(), face), 1, none())?;
    push("haar".to_owned(), soup, corners.iter().map(|&f| on_faces[f]).collect());

    let decomposer = decomposer(ball);
    // σ of band j is 2^((j − 1)/2) steps, and the edges to both parents of such a vertex are 2^(level − 1) fine ones.
    let band = 2 * DRAWN_LEVEL - 1;
    let vertex = facing_vertex(points, |_| true);
    let both = decomposer.basis_of_vertex(vertex, &Schedule::dyadic(band)?, none())?;
    let density = both.wavelet.iter().zip(decomposer.areas()).map(|(v, a)| v / a).collect();
    waves.push(Wave { name: format!("ADW, band {band}"), model: ball.clone(), values: density });
    Ok((waves, cores))
}

/// Share of the vertices that hold most of the energy of a function.
fn core(values: &[f64]) -> f64 {
    let mut squares: Vec<f64> = values.iter().map(|v| v * v).collect();
    squares.sort_by(|a, b| b.total_cmp(a));
    let total: f64 = squares.iter().sum();
    let mut sum = 0.0;
    let n_core = squares.iter().take_while(|square| {
        let is_short = sum < CORE * total;
        sum += **square;
        is_short
    });
    n_core.count() as f64 / values.len() as f64
}

/// Returns the signal of n values that is 1 at one vertex and 0 at the others.
fn unit(n: usize, at: usize) -> Vec<f64> {
    let mut signal = vec![0.0; n];
    signal[at] = 1.0;
    signal
}

/// Finds the vertex on the side of the viewer, among those with a property.
fn facing_vertex(points: &[Vector], has: impl Fn(usize) -> bool) -> usize {
    const TOWARDS_VIEWER: Vector = [0.45, 0.35, 0.82];
    let score = |v: &usize| dot(&points[*v], &TOWARDS_VIEWER);
    (0..points.len()).filter(|&v| has(v)).max_by(|a, b| score(a).total_cmp(&score(b))).unwrap_or(0)
}

/// Separates the faces of a model, so that each has its own corners, and returns the face of each corner.
fn separate_faces(model: &Model) -> Result<(Model, Vec<usize>), FigureError> {
    let points = model.triangles.iter().flatten().map(|&v| model.points()[v as usize]).collect();
    let n = model.triangles.len() as u32;
    let triangles: Vec<[u32; 3]> = (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let soup = Model::from_file("faces", ShapeFile::from_mesh(points, triangles.into()))?;
    Ok((soup, (0..3 * n as usize).map(|corner| corner / 3).collect()))
}

fn center([a, b, c]: [Vector; 3]) -> Vector {
    [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0)
}

fn area([a, b, c]: [Vector; 3]) -> f64 {
    0.5 * norm(&cross(&subtract(&b, &a), &subtract(&c, &a)))
}

/// Subdivides an icosahedron `n_levels` times and moves its vertices to a unit sphere with bumps of several sizes.
fn ball_of_bumps(n_levels: usize) -> Result<Model, FigureError> {
    let (mut points, mut triangles) = icosahedron();
    for _ in 0..n_levels {
        let finer = subdivide(points.len(), &triangles);
        let middles: Vec<Vector> = finer
            .parents
            .iter()
            .map(|&[a, b]| project_to_sphere(&add_scaled(&points[a as usize], 1.0, &points[b as usize])))
            .collect();
        points.extend(middles);
        triangles = finer.triangles;
    }
    // Bumps around the directions of a golden spiral, the more of them the smaller they are.
    let bumps = [(5, 0.16, 0.45), (17, 0.05, 0.2), (61, 0.015, 0.09)];
    let height = |u: &Vector| -> f64 {
        let all = bumps.iter().flat_map(|&(n, height, width)| (0..n).map(move |k| (k, n, height, width)));
        all.map(|(k, n, height, width)| height * (-0.5 * (distance(u, &spiral(k, n)) / width).powi(2)).exp())
            .sum()
    };
    let points: Vec<Vector> = points.iter().map(|u| u.map(|x| x * (1.0 + height(u)))).collect();
    Ok(Model::from_file(
        "ball with bumps, made by subdivision",
        ShapeFile::from_mesh(points, triangles.into()),
    )?)
}

/// Returns the `k`-th of `n` unit vectors that cover the sphere evenly.
fn spiral(k: usize, n: usize) -> Vector {
    let z = 1.0 - (2 * k + 1) as f64 / n as f64;
    let radius = (1.0 - z * z).sqrt();
    let (sin, cos) = (k as f64 * std::f64::consts::PI * (3.0 - 5.0_f64.sqrt())).sin_cos();
    [radius * cos, radius * sin, z]
}

fn project_to_sphere(p: &Vector) -> Vector {
    p.map(|x| x / norm(p))
}

/// Builds the regular icosahedron on the unit sphere, with faces oriented outward.
fn icosahedron() -> (Vec<Vector>, Vec<[u32; 3]>) {
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut points: Vec<Vector> = Vec::new();
    for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        for turn in 0..3 {
            let mut p = [0.0, signs[0], signs[1] * golden];
            p.rotate_right(turn);
            points.push(p);
        }
    }
    let is_edge = |a: usize, b: usize| (distance(&points[a], &points[b]) - 2.0).abs() < 1e-6;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|&c| is_edge(a, b) && is_edge(b, c) && is_edge(a, c)) {
                let outward = dot(&points[a], &cross(&points[b], &points[c])) > 0.0;
                let face = if outward { [a, b, c] } else { [a, c, b] };
                triangles.push(face.map(|v| v as u32));
            }
        }
    }
    (points.iter().map(project_to_sphere).collect(), triangles)
}
