//! Fields of faces: heat on the dual graph of a mesh, weighted by the areas of the faces.

use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::local_fit::LocalFit;
use adwave::sample::Sample;
use adwave::shape::{Graph, GraphError, Mesh, Polygons, Shape, dual_graph};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

type Point = [f64; 3];

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = Pcg64Mcg::seed_from_u64(seed);
    move || f64::from(state.next_u32()) / f64::from(u32::MAX)
}

fn dual(points: Vec<Point>, faces: Polygons) -> Graph {
    dual_graph(&Mesh::new(points, faces).unwrap()).unwrap()
}

fn sphere() -> Graph {
    let sample = Sample::from_name("sphere", Some(2000)).unwrap();
    dual(sample.points, sample.faces)
}

/// A square of n × n cells with moved vertices, cells `stretch` times as wide as high, each cut along a random diagonal.
fn uneven_square(n: u32, stretch: f64, shift: f64, seed: u64) -> Graph {
    let mut random = random(seed);
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let mut points = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let [dx, dy] = [(); 2].map(|()| shift * (random() - 0.5));
            points.push([stretch * (f64::from(i) + dx), f64::from(j) + dy, 0.0]);
        }
    }
    let mut faces = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend(if random() < 0.5 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
    }
    dual(points, Polygons::from_triangles(&faces))
}

fn integral(graph: &Graph, values: &[f64]) -> f64 {
    graph.cell_areas().unwrap().iter().zip(values).map(|(a, f)| a * f).sum()
}

#[test]
fn the_integral_and_constants_stay() {
    let graph = sphere();
    let mut random = random(3);
    let field: Vec<f64> = (0..graph.n_nodes()).map(|_| random()).collect();
    let decomposer = Decomposer::new(&Shape::Graph(graph.clone()));
    let schedule = Schedule::dyadic(6).unwrap();
    let bands = decomposer.decompose(&field, 1, &schedule).unwrap();
    for (sum, f) in bands.reconstruct().iter().zip(&field) {
        assert!((sum - f).abs() < 1e-12);
    }
    let (before, after) = (integral(&graph, &field), integral(&graph, bands.coarsest()));
    // Masses of the smallest faces may be raised by the operator; the mean over the masses is exact.
    assert!((before - after).abs() < 2e-3 * before, "{before} {after}");
    let spread = |values: &[f64]| {
        let mean = integral(&graph, values) / graph.cell_areas().unwrap().iter().sum::<f64>();
        values.iter().map(|f| (f - mean).powi(2)).sum::<f64>()
    };
    assert!(spread(bands.coarsest()) < 0.1 * spread(&field));
    let constant = vec![2.5; field.len()];
    let bands = decomposer.decompose(&constant, 1, &schedule).unwrap();
    assert!(bands.coarsest().iter().all(|f| (f - 2.5).abs() < 1e-9));
}

#[test]
fn the_width_is_that_of_the_plane_on_any_cells() {
    for (stretch, shift, tolerance) in [(1.0, 0.0, 0.05), (1.0, 0.6, 0.1), (3.0, 0.0, 0.05), (3.0, 0.5, 0.1)]
    {
        let n = 80;
        let graph = uneven_square(n, stretch, shift, 7);
        let positions = graph.positions().unwrap().to_vec();
        let middle = [stretch * f64::from(n) / 2.0, f64::from(n) / 2.0];
        let square = |p: &Point| (p[0] - middle[0]).powi(2) + (p[1] - middle[1]).powi(2);
        let start = (0..positions.len())
            .min_by(|&f, &g| square(&positions[f]).total_cmp(&square(&positions[g])))
            .unwrap();
        let mut field = vec![0.0; positions.len()];
        field[start] = 1.0;
        let areas = graph.cell_areas().unwrap().to_vec();
        let decomposer = Decomposer::new(&Shape::Graph(graph));
        let schedule = Schedule::dyadic(8).unwrap();
        let bands = decomposer.decompose(&field, 1, &schedule).unwrap();
        let sigma = *schedule.sigma(decomposer.operator().step_length()).last().unwrap();
        let (mut mass, mut spread) = (0.0, 0.0);
        for ((p, a), f) in positions.iter().zip(&areas).zip(bands.coarsest()) {
            let from = positions[start];
            mass += a * f;
            spread += a * f * ((p[0] - from[0]).powi(2) + (p[1] - from[1]).powi(2));
        }
        let ratio = spread / mass / (sigma * sigma);
        assert!((ratio - 1.0).abs() < tolerance, "stretch {stretch}, shift {shift}: {ratio}");
    }
}

#[test]
fn a_slope_stays_on_uneven_faces() {
    let graph = uneven_square(24, 1.0, 0.6, 11);
    let slope: Vec<f64> = graph.positions().unwrap().iter().map(|p| 0.5 * p[0] - p[1]).collect();
    let decomposer = Decomposer::new(&Shape::Graph(graph));
    let schedule = Schedule::dyadic(5).unwrap();
    let bands = decomposer.request(&slope, 1, &schedule).local_fit(LocalFit::Linear).bands().unwrap();
    let worst = bands.coarsest().iter().zip(&slope).map(|(s, f)| (s - f).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-8, "{worst}");
}

#[test]
fn separate_triangles_have_the_bands_of_the_welded_mesh() {
    let sample = Sample::from_name("creature", Some(2500)).unwrap();
    let field: Vec<f64> = (0..sample.faces.len()).map(|f| (f as f64 * 0.7).sin()).collect();
    let corners = sample.faces.corners();
    let soup: Vec<Point> = corners.iter().map(|&v| sample.points[v as usize]).collect();
    let own: Vec<[u32; 3]> = (0..sample.faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let schedule = Schedule::dyadic(4).unwrap();
    let coarsest = |graph: Graph| {
        let bands = Decomposer::new(&Shape::Graph(graph)).decompose(&field, 1, &schedule).unwrap();
        bands.coarsest().to_vec()
    };
    let welded = coarsest(dual(sample.points.clone(), sample.faces.clone()));
    let separate = coarsest(dual(soup, Polygons::from_triangles(&own)));
    assert!(welded.iter().zip(&separate).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn bad_faces_give_finite_values() {
    let points = vec![
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.5, 0.0, 0.0],
        [9.0, 9.0, 9.0],
    ];
    // Four faces at one side, a face without area, one with a repeated corner, and faces of one and two corners.
    let faces: Polygons =
        [&[0_u32, 1, 2][..], &[0, 1, 3], &[1, 0, 4], &[0, 1, 6], &[0, 5, 1], &[2, 2, 3], &[4], &[1, 2]]
            .into_iter()
            .collect();
    for scale in [1e-90, 1.0, 1e90] {
        let scaled = points.iter().map(|p: &Point| p.map(|c| c * scale)).collect();
        let graph = dual(scaled, faces.clone());
        let field: Vec<f64> = (0..graph.n_nodes()).map(|f| f as f64).collect();
        let decomposer = Decomposer::new(&Shape::Graph(graph));
        let bands = decomposer.decompose(&field, 1, &Schedule::dyadic(4).unwrap()).unwrap();
        assert!(
            bands.coarsest().iter().all(|f| f.is_finite() && (0.0..=7.0).contains(f)),
            "{:?}",
            bands.coarsest()
        );
        assert_eq!(bands.coarsest()[6], 6.0);
    }
    let crowd: Vec<[u32; 3]> = (0..1000).map(|_| [0, 1, 2]).collect();
    let graph = dual(points.clone(), Polygons::from_triangles(&crowd));
    assert!(graph.rows().nnz() < 10_000, "{}", graph.rows().nnz());
    let cloud = Mesh::new(points, Polygons::new()).unwrap();
    assert_eq!(dual_graph(&cloud).unwrap_err(), GraphError::NoNodes);
    let pair = Graph::new(2, &[(0, 1, 1.0)]).unwrap();
    assert!(matches!(
        pair.clone().with_cells(vec![[0.0; 3]; 2], vec![1.0]),
        Err(GraphError::AreaCount { found: 1, n_nodes: 2 })
    ));
    assert!(matches!(
        pair.with_cells(vec![[0.0; 3]; 2], vec![1.0, f64::NAN]),
        Err(GraphError::BadArea { node: 1, .. })
    ));
}
