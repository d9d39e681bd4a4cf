use super::*;
use crate::laplacian::{LaplacianMatrices, LaplacianParams};
use adwave::shape::{Graph, Shape};

/// Grid whose edges all have different weights.
fn grid(width: u32) -> SymmetricMatrix {
    let edges: Vec<_> = (0..width)
        .flat_map(|i| (0..width).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let here = i * width + j;
            let weight = 1.0 + f64::from((i * 7 + j * 3) % 5) / 5.0;
            [
                (i + 1 < width).then_some((here, here + width, weight)),
                (j + 1 < width).then_some((here, here + 1, weight)),
            ]
        })
        .flatten()
        .collect();
    let shape = Shape::Graph(Graph::new((width * width) as usize, &edges).unwrap());
    LaplacianMatrices::new(&shape, &LaplacianParams::default()).unwrap().stiffness
}

const FAMILIES: [KernelFamily; 4] =
    [KernelFamily::MexicanHat, KernelFamily::Abspline, KernelFamily::Itersine, KernelFamily::Meyer];

/// Bound of the error of a tight frame: twice the error of each of the two kernels that overlap.
const TIGHT: f64 = 4e-6;

/// Accuracy for a family. The second derivative of the spline and of itersine jumps, so that the error of a polynomial
/// falls only as 1/degree².
fn accuracy(family: KernelFamily) -> f64 {
    if matches!(family, KernelFamily::Abspline | KernelFamily::Itersine) { 9e-7 } else { 1e-8 }
}

fn signal(n: usize) -> Vec<f64> {
    (0..n).map(|i| (0.3 * i as f64).sin() + f64::from(u8::from(i % 11 == 2))).collect()
}

fn norm(f: &[f64]) -> f64 {
    f.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}

#[test]
fn polynomials_agree_with_the_exact_transform() {
    let laplacian = grid(18);
    let f = signal(laplacian.n());
    for family in FAMILIES {
        let kernels = Kernels::new(family, 6, largest_eigenvalue(&laplacian)).unwrap();
        let exact = ExactFrame::new(&laplacian, kernels.clone()).unwrap();
        let frame = Frame::new(laplacian.clone(), kernels, accuracy(family)).unwrap();
        let (a, b) = (exact.analyze(&f).unwrap(), frame.analyze(&f, Progress::none()).unwrap());
        for (i, (a, b)) in a.iter().zip(&b).enumerate() {
            let error = distance(a, b) / norm(&f);
            assert!(error < 1e-6, "{family:?} {i}: {error:e}");
            // The reported error holds.
            assert!(error <= 1.01 * frame.polynomials[i].error + 1e-13, "{family:?} {i}: {error:e}");
        }
        // The adjoint satisfies ⟨Wf, c⟩ = ⟨f, W*c⟩.
        let back = frame.adjoint(&b, Progress::none()).unwrap();
        let (left, right) = (
            b.iter().map(|c| norm(c).powi(2)).sum::<f64>(),
            back.iter().zip(&f).map(|(a, b)| a * b).sum::<f64>(),
        );
        assert!((left / right - 1.0).abs() < 1e-12);
    }
}

#[test]
fn coefficients_lie_within_the_frame_bounds_and_can_be_inverted() {
    let laplacian = grid(20);
    let f = signal(laplacian.n());
    for family in FAMILIES {
        let kernels = Kernels::new(family, 7, largest_eigenvalue(&laplacian)).unwrap();
        let frame = Frame::new(laplacian.clone(), kernels.clone(), accuracy(family)).unwrap();
        let c = frame.analyze(&f, Progress::none()).unwrap();
        let energy = c.iter().map(|c| norm(c).powi(2)).sum::<f64>() / norm(&f).powi(2);
        let (a, b) = frame.bounds;
        assert!(a * (1.0 - 1e-9) <= energy && energy <= b * (1.0 + 1e-9), "{family:?}: {a} {energy} {b}");
        if matches!(family, KernelFamily::Meyer | KernelFamily::Itersine) {
            assert!((a - 1.0).abs() < TIGHT && (b - 1.0).abs() < TIGHT, "{family:?} is tight: {a} {b}");
        }
        let (back, info) = frame.inverse(&c, 1e-12, Progress::none()).unwrap();
        assert!(distance(&back, &f) < 1e-8 * norm(&f), "{family:?}: {info:?}");
        let exact = ExactFrame::new(&laplacian, kernels).unwrap();
        let back = exact.inverse(&exact.analyze(&f).unwrap()).unwrap();
        assert!(distance(&back, &f) < 1e-10 * norm(&f), "{family:?}");
        assert!(exact.bounds.0 >= a - 1e-6 && exact.bounds.1 <= b + 1e-6);
    }
}

#[test]
fn wavelets_have_zero_mean_except_the_low_pass() {
    let laplacian = grid(12);
    let mut spike = vec![0.0; 144];
    spike[70] = 1.0;
    for family in FAMILIES {
        let kernels = Kernels::new(family, 6, largest_eigenvalue(&laplacian)).unwrap();
        let exact = ExactFrame::new(&laplacian, kernels).unwrap();
        let c = exact.analyze(&spike).unwrap();
        let from = if family == KernelFamily::Itersine { 2 } else { 1 };
        for wavelet in &c[from..] {
            assert!(wavelet.iter().sum::<f64>().abs() < 1e-12, "{family:?}");
        }
        assert!(c[0].iter().sum::<f64>() > 0.1);
    }
}

#[test]
fn the_largest_eigenvalue_is_bounded_from_above() {
    for width in [1, 2, 5, 15] {
        let laplacian = grid(width);
        let (spectrum, _) = symmetric_eigen(&laplacian.to_dense(), laplacian.n()).unwrap();
        let (top, bound) = (spectrum[spectrum.len() - 1], largest_eigenvalue(&laplacian));
        assert!(bound >= top && bound <= 2.1 * top + 1e-300, "{width}: {top} {bound}");
    }
}

#[test]
fn tiny_graphs_and_wrong_input() {
    for n in [1, 2, 50] {
        let shape = Shape::Graph(Graph::new(n, &[]).unwrap());
        let laplacian = LaplacianMatrices::new(&shape, &LaplacianParams::default()).unwrap().stiffness;
        let kernels = Kernels::new(KernelFamily::Meyer, 4, largest_eigenvalue(&laplacian)).unwrap();
        let frame = Frame::new(laplacian.clone(), kernels, 1e-6).unwrap();
        let f = signal(n);
        let c = frame.analyze(&f, Progress::none()).unwrap();
        let (back, _) = frame.inverse(&c, 1e-10, Progress::none()).unwrap();
        assert!(distance(&back, &f) <= 1e-6 * norm(&f));
        assert!(frame.analyze(&vec![0.0; n + 1], Progress::none()).is_err());
    }
    assert!(Kernels::new(KernelFamily::Meyer, 1, 1.0).is_err());
    let laplacian = grid(3);
    let kernels = Kernels::new(KernelFamily::Itersine, 200, largest_eigenvalue(&laplacian)).unwrap();
    assert!(matches!(Frame::new(laplacian.clone(), kernels, 1e-15), Err(SgwtError::Accuracy { .. })));
}
