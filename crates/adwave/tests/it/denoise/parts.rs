//! Parts of a surface are denoised as the whole is, to the last bit.

use crate::denoise::{mesh, rms};
use adwave::Progress;
use adwave::denoise::{Creases, DenoiseChoice, DenoiseError, DenoiseParams, denoise};
use adwave::rows::Pattern;
use adwave::shape::{Graph, PointCloud, Polygons, PreparedGeometry, Shape, WeldMode, nearest_neighbors};
use std::ops::Range;

/// A strip of so many points across.
const ACROSS: usize = 12;
const ALONG: usize = 900;
/// Indices of the points of the part.
const OWN: Range<usize> = 400..500;

/// A roof along the strip, with noise.
fn strip() -> Vec<[f64; 3]> {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let (n, half) = (ACROSS * ALONG, ACROSS as f64 / 2.0);
    let point = |i: usize| {
        let (x, y) = ((i / ACROSS) as f64, (i % ACROSS) as f64);
        [x + 0.3 * random(), y + 0.3 * random(), 0.6 * (half - (y - half).abs()) + 0.4 * random()]
    };
    (0..n).map(point).collect()
}

fn triangles(columns: usize) -> Vec<[u32; 3]> {
    let n = ACROSS as u32;
    let corners = (0..(columns as u32 - 1) * n).filter(|i| i % n < n - 1);
    corners.flat_map(|i| [[i, i + n, i + 1], [i + 1, i + n, i + n + 1]]).collect()
}

/// The part, with as many rings around it as decide it and where it begins among the points.
fn part() -> (Range<usize>, usize) {
    let rings = DenoiseChoice::reach().unwrap();
    (OWN.start - rings..OWN.end + rings, rings * ACROSS)
}

fn params(creases: Creases) -> DenoiseParams {
    DenoiseParams::default().with_creases(creases).with_noise(0.12)
}

#[test]
fn a_part_of_a_mesh_is_denoised_as_the_whole() {
    let points = strip();
    let shape = mesh(points.clone(), &Polygons::from_triangles(&triangles(ALONG)));
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    for creases in [Creases::Auto, Creases::Keep, Creases::None] {
        let choice = DenoiseChoice::estimate(&geometry, &params(creases), Progress::none()).unwrap();
        let whole = choice.denoise_mesh(&points, &triangles(ALONG), Progress::none()).unwrap();
        let (columns, own) = part();
        let of_part = &points[columns.start * ACROSS..columns.end * ACROSS];
        let found = choice.denoise_mesh(of_part, &triangles(columns.len()), Progress::none()).unwrap();
        let n = OWN.len() * ACROSS;
        assert!(found.points[own..][..n] == whole.points[OWN.start * ACROSS..][..n], "{creases:?}");
        let in_memory = denoise(&geometry, &params(creases), Progress::none()).unwrap();
        assert_eq!(choice.info.crease_weights, in_memory.info.crease_weights);
        let (off, moved) = (rms(&whole.points, &in_memory.points), rms(&points, &in_memory.points));
        println!("{creases:?}: {off:e} of {moved:e}");
        assert!(moved > 0.02 && off < 1e-4 * moved, "{creases:?}: {off:e} of {moved:e}");
    }
}

#[test]
fn a_part_of_a_mesh_with_impulses_is_denoised_as_the_whole() {
    let mut points = strip();
    let mut state = 9_u32;
    for p in &mut points {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        if state >> 29 == 0 {
            p[2] += if state & (1 << 20) == 0 { 1.5 } else { -1.5 };
        }
    }
    let shape = mesh(points.clone(), &Polygons::from_triangles(&triangles(ALONG)));
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let choice = DenoiseChoice::estimate(&geometry, &DenoiseParams::default(), Progress::none()).unwrap();
    let share = choice.info.mesh.as_ref().unwrap().impulse_share;
    assert!((0.06..0.2).contains(&share), "{share} instead of 1/8");
    let whole = choice.denoise_mesh(&points, &triangles(ALONG), Progress::none()).unwrap();
    let (columns, own) = part();
    let of_part = &points[columns.start * ACROSS..columns.end * ACROSS];
    let found = choice.denoise_mesh(of_part, &triangles(columns.len()), Progress::none()).unwrap();
    let n = OWN.len() * ACROSS;
    assert!(found.points[own..][..n] == whole.points[OWN.start * ACROSS..][..n]);
}

/// The union of the nearest neighbors both ways.
fn neighbors(points: &[[f64; 3]]) -> Vec<Vec<u32>> {
    let near = nearest_neighbors(points, DenoiseChoice::NEIGHBORS).adjacency;
    let mut rows: Vec<Vec<u32>> = (0..points.len()).map(|x| near.row(x).to_vec()).collect();
    for x in 0..points.len() {
        near.row(x).iter().for_each(|&y| rows[y as usize].push(x as u32));
    }
    for row in &mut rows {
        row.sort_unstable();
        row.dedup();
    }
    rows
}

/// Some of the rows, of which the outermost are left empty where they would leave the part.
fn pattern(rows: &[Vec<u32>], part: Range<usize>) -> Pattern {
    let (mut offsets, mut columns) = (vec![0], Vec::new());
    for x in part.clone() {
        if rows[x].iter().all(|&y| part.contains(&(y as usize))) {
            columns.extend(rows[x].iter().map(|&y| y - part.start as u32));
        }
        offsets.push(columns.len());
    }
    Pattern::new(offsets, columns, part.len()).unwrap()
}

/// Heights of normal deviates of one distance between neighbors.
fn strongly_noisy_strip() -> Vec<[f64; 3]> {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let point = |i: usize| {
        let height = (0..12).map(|_| random()).sum();
        [(i / ACROSS) as f64 + random(), (i % ACROSS) as f64 + random(), height]
    };
    (0..ACROSS * ALONG).map(point).collect()
}

#[test]
fn a_part_of_a_cloud_is_denoised_as_the_whole() {
    check_cloud(&strip(), &[params(Creases::Auto), DenoiseParams::default()], 6, false);
}

#[test]
fn a_part_of_a_cloud_with_strong_noise_is_denoised_as_the_whole() {
    check_cloud(&strongly_noisy_strip(), &[DenoiseParams::default()], 8, true);
}

/// Checks that a part has the bits of the whole; a point may name one `reach` columns on.
fn check_cloud(points: &[[f64; 3]], params: &[DenoiseParams], reach: usize, is_strong: bool) {
    let geometry = {
        let shape = Shape::Cloud(PointCloud::new(points.to_vec()).unwrap());
        PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap()
    };
    for params in params {
        let choice = DenoiseChoice::estimate(&geometry, params, Progress::none()).unwrap();
        assert_eq!(choice.info.cloud.as_ref().unwrap().strong.is_some(), is_strong);
        let rows = neighbors(points);
        let whole = choice.denoise_cloud(points, &pattern(&rows, 0..points.len()), Progress::none()).unwrap();
        let rings = reach * DenoiseChoice::CLOUD_REACH;
        let first = OWN.start - rings;
        let part = first * ACROSS..(OWN.end + rings) * ACROSS;
        let found = choice
            .denoise_cloud(&points[part.clone()], &pattern(&rows, part.clone()), Progress::none())
            .unwrap();
        let (own, n) = ((OWN.start - first) * ACROSS, OWN.len() * ACROSS);
        assert!(found[own..][..n] == whole[OWN.start * ACROSS..][..n]);
        let in_memory = denoise(&geometry, params, Progress::none()).unwrap();
        let (off, moved) = (rms(&whole, &in_memory.points), rms(points, &in_memory.points));
        assert!(moved > 0.02 && off < 1e-9 * moved, "{off:e} of {moved:e}");
    }
}

#[test]
fn nothing_is_chosen_for_a_graph_and_nothing_moves_where_there_is_no_noise() {
    let graph = Shape::Graph(Graph::new(3, &[(0, 1, 1.0), (1, 2, 1.0)]).unwrap());
    let geometry = PreparedGeometry::new(&graph, WeldMode::EqualPositions, Progress::none()).unwrap();
    let refused = DenoiseChoice::estimate(&geometry, &DenoiseParams::default(), Progress::none());
    assert_eq!(refused.unwrap_err(), DenoiseError::NoPositions);
    let points = strip();
    let shape = mesh(points.clone(), &Polygons::from_triangles(&triangles(ALONG)));
    let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none()).unwrap();
    let choice =
        DenoiseChoice::estimate(&geometry, &DenoiseParams::default().with_noise(0.0), Progress::none())
            .unwrap();
    assert_eq!(choice.denoise_mesh(&points, &triangles(ALONG), Progress::none()).unwrap().points, points);
}
