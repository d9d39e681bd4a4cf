use super::*;
use adwave::Decomposer;
use adwave::bands::Schedule;
use adwave::sample::Sample;
use adwave::shape::{Graph, Mesh};

fn torus() -> Shape {
    let sample = Sample::from_name("torus", Some(1200)).unwrap();
    Shape::Mesh(Mesh::new(sample.points, sample.faces).unwrap())
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Rounding error times the condition number of the normal equations for 1,200 vertices.
const SOLVED: f64 = 1e-8;

#[test]
fn nothing_edited_gives_the_shape_back() {
    let shape = torus();
    let points = shape.points().unwrap().as_flattened();
    for weights in [Weights::Uniform, Weights::Cotangent] {
        let l = Differential::new(&shape, weights).unwrap();
        let delta = l.coordinates(points, 3).unwrap();
        let anchors: Vec<Anchor> = [0, 300, 900].map(|vertex| Anchor { vertex, weight: 1.0 }).to_vec();
        let targets: Vec<f64> = anchors.iter().flat_map(|a| points[3 * a.vertex..][..3].to_vec()).collect();
        let prepared = Reconstruction::new(&l, &anchors).unwrap();
        assert!(difference(&prepared.solve(&delta, &targets, 3).unwrap(), points) < SOLVED);
        // Moving all anchors equally moves the whole shape equally.
        let moved: Vec<f64> = targets.iter().map(|t| t + 5.0).collect();
        let shifted: Vec<f64> = points.iter().map(|p| p + 5.0).collect();
        assert!(difference(&prepared.solve(&delta, &moved, 3).unwrap(), &shifted) < SOLVED);
    }
}

#[test]
fn the_first_wavelets_are_half_the_differential_coordinates_of_the_walk() {
    // Eq. 16: Ψ₁ = ½(I − Q).
    let shape = torus();
    let points = shape.points().unwrap().as_flattened();
    let decomposer = Decomposer::new(&shape);
    let l = Differential::from_diffusion(decomposer.rows("a test").unwrap(), decomposer.vertex_map().clone());
    let delta = l.coordinates(points, 3).unwrap();
    let schedule = Schedule::dyadic(1).unwrap();
    let bands = decomposer.decompose(points, 3, &schedule).unwrap();
    let half: Vec<f64> = delta.iter().map(|d| 0.5 * d).collect();
    assert!(difference(&half, bands.wavelet(1)) < 1e-13);
}

#[test]
fn wrong_anchors_are_named() {
    let graph = Shape::Graph(Graph::new(4, &[(0, 1, 1.0), (2, 3, 1.0)]).unwrap());
    let l = Differential::new(&graph, Weights::Uniform).unwrap();
    let anchor = |vertex, weight| Anchor { vertex, weight };
    assert_eq!(
        Reconstruction::new(&l, &[anchor(0, 1.0)]).unwrap_err(),
        DifferentialError::NoAnchor { vertex: 2 }
    );
    for bad in [anchor(4, 1.0), anchor(0, 0.0), anchor(0, f64::NAN)] {
        assert!(matches!(
            Reconstruction::new(&l, &[bad]),
            Err(DifferentialError::BadAnchor { anchor: 0, .. })
        ));
    }
    let prepared = Reconstruction::new(&l, &[anchor(0, 1.0), anchor(2, 2.0)]).unwrap();
    assert!(prepared.solve(&[0.0; 3], &[0.0; 2], 1).is_err());
    assert!(prepared.solve(&[0.0; 4], &[0.0; 3], 1).is_err());
}
