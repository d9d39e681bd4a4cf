//! Wavelets of any mesh.

use crate::common::{TestMesh, areas, fan, grid, octahedron};
use adwave::Progress;
use adwave::sample::Sample;
use adwave_subdivision::{LiftedWavelets, SubdivisionError};

fn sample(name: &str, n_vertices: usize) -> TestMesh {
    let sample = Sample::from_name(name, Some(n_vertices)).unwrap();
    let triangles = sample.faces.triangles().expect("triangles").to_vec();
    TestMesh { points: sample.points, triangles }
}

fn wavelets(mesh: &TestMesh) -> LiftedWavelets {
    LiftedWavelets::new_irregular(&mesh.points, &mesh.triangles, &areas(mesh), Progress::none()).unwrap()
}

/// A mesh with an edge of three faces, a vertex where two fans touch, a repeated face, a face without area and a lone vertex.
fn broken() -> TestMesh {
    let mut mesh = sample("creature", 2000);
    let [a, b, c] = mesh.triangles[10];
    mesh.points.extend([[5.0, 5.0, 5.0], [6.0, 5.0, 5.0], [9.0; 3]]);
    let n = mesh.points.len() as u32;
    mesh.triangles.extend([[a, b, n - 3], [c, n - 3, n - 2], mesh.triangles[20], [a, a, b]]);
    mesh
}

#[test]
fn synthesis_is_the_inverse_and_the_mean_stays_new_irregular() {
    let meshes = [
        sample("creature", 3000),
        sample("bracket", 2000),
        broken(),
        grid(30, 20, false),
        fan(200),
        grid(40, 30, true),
    ];
    for (k, mesh) in meshes.iter().enumerate() {
        let wavelets = wavelets(mesh);
        let field = mesh.points.as_flattened();
        let coefficients = wavelets.analyze(field, 3, Progress::none()).unwrap();
        let back = wavelets.synthesize(&coefficients.values, 3, Progress::none()).unwrap();
        let size = field.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(back.iter().zip(field).all(|(a, b)| (a - b).abs() <= 1e-13 * size), "mesh {k}");
        let n_levels = wavelets.n_levels();
        let coarse = wavelets.coarse_field(field, 3, n_levels, Progress::none()).unwrap();
        let smooth = wavelets.fine_field(&coarse, 3, n_levels, Progress::none()).unwrap();
        for c in 0..3 {
            let mean = |f: &[f64]| -> f64 {
                wavelets.masses().iter().enumerate().map(|(x, m)| m * f[3 * x + c]).sum()
            };
            assert!((mean(&smooth) - mean(field)).abs() <= 1e-13 * size, "mesh {k}");
        }
    }
}

#[test]
fn constants_have_no_details_and_linear_fields_none_inside_a_plane() {
    let mesh = grid(24, 24, false);
    let wavelets = wavelets(&mesh);
    let analyze = |field: &[f64]| wavelets.analyze(field, 1, Progress::none()).unwrap();
    let is_detail = |level: u32| level as usize <= wavelets.n_levels();
    let constant = analyze(&vec![3.0; mesh.points.len()]);
    let rows = constant.levels.iter().zip(&constant.values);
    assert!(rows.clone().all(|(level, c)| !is_detail(*level) || c.abs() < 1e-13));
    // Mean values are exact for linear fields in the plane, and straight borders for those along them; corners are not straight.
    let linear = analyze(&mesh.points.iter().map(|p| p[0] - 0.5 * p[1]).collect::<Vec<_>>());
    let corners = [0, 24, 25 * 24, 25 * 25 - 1];
    let finest: Vec<f64> = (0..mesh.points.len())
        .filter(|v| linear.levels[*v] == 1 && !corners.contains(v))
        .map(|v| linear.values[v].abs())
        .collect();
    assert!(finest.len() > 100);
    assert!(finest.iter().all(|c| *c < 1e-12), "{:e}", finest.iter().fold(0.0_f64, |m, c| m.max(*c)));
}

#[test]
fn levels_thin_out_by_a_share_and_keep_a_coarse_mesh() {
    let mesh = sample("creature", 6000);
    let wavelets = wavelets(&mesh);
    let sizes: Vec<usize> = (0..=wavelets.n_levels()).map(|k| wavelets.n_vertices_at(k)).collect();
    assert!(sizes.windows(2).all(|pair| pair[1] < pair[0] && 2 * pair[1] > pair[0]), "{sizes:?}");
    assert!(*sizes.last().unwrap() <= 60, "{sizes:?}");
}

#[test]
fn meshes_that_cannot_be_thinned_are_refused() {
    let refused = |mesh: &TestMesh| {
        LiftedWavelets::new_irregular(
            &mesh.points,
            &mesh.triangles,
            &vec![1.0; mesh.points.len()],
            Progress::none(),
        )
        .unwrap_err()
    };
    assert!(refused(&octahedron()).to_string().contains("more than 32 vertices"));
    let empty = TestMesh { points: vec![[0.0; 3]; 40], triangles: Vec::new() };
    assert_eq!(refused(&empty), SubdivisionError::NoFaces);
    let mut far = octahedron().cut(3);
    far.points[3][1] = f64::INFINITY;
    assert!(matches!(refused(&far), SubdivisionError::NotFinite { .. }));
    // All points equal: no angles, so no vertex can be predicted.
    let mut equal = octahedron().cut(3);
    equal.points.fill([1.0; 3]);
    assert!(matches!(refused(&equal), SubdivisionError::Family { .. }));
}
