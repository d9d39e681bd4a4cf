//! What several tests need: meshes to measure on, and single calls.

#![allow(dead_code)] // each test file uses a part of it

pub(crate) mod one_off;

use adwave::shape::Polygons;

/// The plane [−1, 1]² in n × n squares, each cut in two along diagonals that turn from square to square, so that no direction
/// is special.
pub(crate) fn plane(n: u32) -> (Vec<[f64; 3]>, Polygons) {
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let points = (0..=n).flat_map(|i| (0..=n).map(move |j| [at(i), at(j), 0.0])).collect();
    let mut faces = Polygons::new();
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| i * (n + 1) + j);
            let halves = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
            for half in &halves {
                faces.push(half);
            }
        }
    }
    (points, faces)
}
