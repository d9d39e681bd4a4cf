//! A square with bumps: the sample with a border.

use super::implicit::V3;

/// Half the side, model units.
pub(super) const HALF_SIDE: f64 = 1.0;
/// Bumps as (x, z, height, width), model units: height·exp(−d²/(2·width²)).
const BUMPS: [(f64, f64, f64, f64); 6] = [
    (-0.35, -0.25, 0.30, 0.25),
    (0.45, 0.35, -0.22, 0.20),
    (0.50, -0.50, 0.12, 0.08),
    (-0.55, 0.50, 0.12, 0.08),
    (0.05, 0.10, 0.06, 0.04),
    (-0.10, 0.70, -0.06, 0.04),
];

/// Height field y = Σ bumps(x, z) over [−1, 1]² with normals up, as a grid of rows × columns with alternating
/// diagonals.
pub(super) fn plane(n_vertices: usize) -> (Vec<V3>, Vec<[u32; 3]>) {
    let (rows, columns) = grid_shape(n_vertices);
    let along = |i: usize, n: usize| HALF_SIDE * (2.0 * i as f64 / (n - 1) as f64 - 1.0);
    let mut points = Vec::with_capacity(rows * columns);
    let mut triangles = Vec::with_capacity(2 * (rows - 1) * (columns - 1));
    for i in 0..rows {
        for j in 0..columns {
            let (x, z) = (along(j, columns), along(i, rows));
            points.push(V3::new(x, height(x, z), z));
            if i + 1 < rows && j + 1 < columns {
                let [a, b] = [i * columns + j, (i + 1) * columns + j].map(|v| v as u32);
                if (i + j) % 2 == 0 {
                    triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
                } else {
                    triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
                }
            }
        }
    }
    (points, triangles)
}

/// Height over (x, z).
pub(super) fn height(x: f64, z: f64) -> f64 {
    BUMPS
        .iter()
        .map(|&(cx, cz, h, w)| h * (-((x - cx).powi(2) + (z - cz).powi(2)) / (2.0 * w * w)).exp())
        .sum()
}

/// Numbers of rows and columns, within a tenth of each other if possible, whose product is nearest to `n_vertices`.
fn grid_shape(n_vertices: usize) -> (usize, usize) {
    let side = (n_vertices as f64).sqrt();
    ((0.9 * side) as usize..=side.ceil() as usize)
        .map(|rows| rows.max(2))
        .map(|rows| (rows, ((n_vertices as f64 / rows as f64).round() as usize).max(2)))
        .min_by_key(|&(rows, columns)| ((rows * columns).abs_diff(n_vertices), rows.abs_diff(columns)))
        .expect("the range holds at least one number")
}
