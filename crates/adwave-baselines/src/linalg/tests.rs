use super::*;
use adwave::Progress;

fn grid(width: usize, height: usize) -> SymmetricMatrix {
    let mut entries = Vec::new();
    let at = |x: usize, y: usize| (y * width + x) as u32;
    for y in 0..height {
        for x in 0..width {
            for other in [(x + 1 < width).then(|| at(x + 1, y)), (y + 1 < height).then(|| at(x, y + 1))]
                .into_iter()
                .flatten()
            {
                let here = at(x, y);
                entries.extend([(here, here, 1.0), (other, other, 1.0), (here, other, -1.0)]);
            }
        }
    }
    SymmetricMatrix::from_halves(width * height, &entries).unwrap()
}

/// Eigenvalues of the grid, which are sums of those of two paths.
fn grid_spectrum(width: usize, height: usize) -> Vec<f64> {
    let path = |n: usize, k: usize| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / n as f64).cos();
    let mut all: Vec<f64> =
        (0..width).flat_map(|i| (0..height).map(move |j| path(width, i) + path(height, j))).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn a_factor_solves_and_counts() {
    for (width, height) in [(1, 1), (2, 1), (50, 1), (5, 7), (40, 30)] {
        let a = grid(width, height);
        let n = a.n();
        let spectrum = grid_spectrum(width, height);
        for shift in [-0.3, 0.517, 2.613, 9.0] {
            let factor = Ldlt::new(&a, shift).unwrap();
            assert_eq!(
                factor.n_below(),
                spectrum.iter().filter(|&&v| v < shift).count(),
                "{width} × {height} at {shift}"
            );
            let b: Vec<f64> = (0..n).map(|i| ((i * 37) % 11) as f64 - 3.0).collect();
            let x = factor.solve(&b).unwrap();
            let ax = a.product(&x);
            for i in 0..n {
                assert!((ax[i] - shift * x[i] - b[i]).abs() < 1e-9, "{width} × {height} at {shift}: {i}");
            }
        }
    }
}

#[test]
fn a_grid_has_its_spectrum() {
    for (width, height, k, band) in
        [(40, 35, 60, 320), (40, 40, 90, 320), (60, 30, 150, 30), (700, 1, 20, 320)]
    {
        let a = grid(width, height);
        let null = vec![1.0; a.n()];
        let params = EigenParams::default().with_band(band);
        for null in [Some(&null[..]), None] {
            let pairs = smallest_eigenpairs(&a, null, k, &params, Progress::none()).unwrap();
            let exact = grid_spectrum(width, height);
            for (i, (value, exact)) in pairs.values.iter().zip(&exact).enumerate() {
                assert!((value - exact).abs() < 1e-11, "{i}: {value} for {exact}");
            }
            assert!(pairs.info.residual < 1e-10, "{:?}", pairs.info);
        }
    }
}
