use super::*;
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh, Shape};
use adwave::{Decomposer, Progress};

fn line(n: u32) -> Shape {
    let edges: Vec<_> = (1..n).map(|i| (i - 1, i, 1.0)).collect();
    Shape::Graph(Graph::new(n as usize, &edges).unwrap())
}

fn sphere() -> Shape {
    let sample = Sample::from_name("sphere", Some(400)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

fn walk(shape: &Shape) -> Diffusion {
    Diffusion::clone(Decomposer::new(shape).rows("a test").unwrap())
}

fn signal(n: usize) -> Vec<f64> {
    (0..n).map(|i| (0.37 * i as f64).sin() + f64::from(u8::from(i % 7 == 3))).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Rounding error of products of orthogonal matrices.
const ORTHOGONAL: f64 = 1e-10;
/// Rounding error times the condition number 1/ε of a level.
const BIORTHOGONAL: f64 = 1e-8;

#[test]
fn diffusion_wavelets_are_orthonormal_fall_in_rank_and_reconstruct() {
    for shape in [line(100), sphere()] {
        let walk = walk(&shape);
        let wavelets = DiffusionWavelets::new(&walk, &MultiscaleParams::default(), Progress::none()).unwrap();
        let ranks = wavelets.ranks();
        assert!(ranks.is_sorted_by(|a, b| a >= b) && ranks[wavelets.n_levels()] < ranks[0] / 4, "{ranks:?}");
        for level in 1..=wavelets.n_levels() {
            assert!(wavelets.orthogonality_defect(level) < ORTHOGONAL);
            assert_eq!(wavelets.wavelets(level).len(), ranks[level - 1] - ranks[level]);
        }
        let f = signal(walk.n_vertices());
        let coefficients = wavelets.analyze(&f).unwrap();
        assert!(largest_difference(&f, &wavelets.synthesize(&coefficients).unwrap()) < ORTHOGONAL);
        // Parseval.
        let squares = |v: &[f64]| v.iter().map(|a| a * a).sum::<f64>();
        let total =
            squares(&coefficients.scaling) + coefficients.wavelets.iter().map(|w| squares(w)).sum::<f64>();
        let n = walk.n_vertices() as f64;
        let expected: f64 = f.iter().zip(walk.stationary()).map(|(f, p)| n * p * f * f).sum();
        assert!((total / expected - 1.0).abs() < ORTHOGONAL);
    }
}

#[test]
fn biorthogonal_wavelets_are_biorthogonal_and_reconstruct() {
    for shape in [line(100), sphere()] {
        let walk = walk(&shape);
        let wavelets =
            BiorthogonalDiffusionWavelets::new(&walk, &MultiscaleParams::default(), Progress::none())
                .unwrap();
        for level in 1..=wavelets.n_levels() {
            let defect = wavelets.biorthogonality_defect(level);
            assert!(defect < BIORTHOGONAL, "level {level}: {defect:e}");
        }
        let f = signal(walk.n_vertices());
        let back = wavelets.synthesize(&wavelets.analyze(&f).unwrap()).unwrap();
        assert!(largest_difference(&f, &back) < BIORTHOGONAL);
    }
}

#[test]
fn the_spaces_are_those_of_the_powers() {
    // T^(2^j − 1) of a spike lies in V_j up to the precision.
    let walk = walk(&line(60));
    let params = MultiscaleParams::default().with_levels(5);
    let wavelets = DiffusionWavelets::new(&walk, &params, Progress::none()).unwrap();
    let (t, _) = symmetric_walk(&walk).unwrap();
    let mut f = vec![0.0; 60];
    f[20] = 1.0;
    for level in 1..=5 {
        for _ in 0..1 << (level - 1) {
            f = t.apply(&f);
        }
        let basis = wavelets.ambient_for_test(level);
        let inside = basis.apply(&basis.apply_transposed(&f));
        let tolerance = 10.0 * params.precision * level as f64;
        assert!(largest_difference(&f, &inside) < tolerance, "level {level}");
    }
}

#[test]
fn small_and_broken_graphs_give_an_answer() {
    let lone = Shape::Graph(Graph::new(3, &[]).unwrap());
    for shape in [line(1), line(2), line(50), lone] {
        let walk = walk(&shape);
        let f = signal(walk.n_vertices());
        let a = DiffusionWavelets::new(&walk, &MultiscaleParams::default(), Progress::none()).unwrap();
        assert!(largest_difference(&f, &a.synthesize(&a.analyze(&f).unwrap()).unwrap()) < ORTHOGONAL);
        let b = BiorthogonalDiffusionWavelets::new(&walk, &MultiscaleParams::default(), Progress::none())
            .unwrap();
        assert!(largest_difference(&f, &b.synthesize(&b.analyze(&f).unwrap()).unwrap()) < BIORTHOGONAL);
        assert!(a.analyze(&[0.0; 77]).is_err());
    }
    let directed = Diffusion::from_rows(&[0, 1, 2], &[0, 0], &[1.0, 1.0]).unwrap();
    let refused = DiffusionWavelets::new(&directed, &MultiscaleParams::default(), Progress::none());
    assert_eq!(refused.unwrap_err(), MultiscaleError::NotReversible);
}
