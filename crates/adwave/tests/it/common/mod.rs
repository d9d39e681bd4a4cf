//! Helpers of several tests: meshes to measure on, and single calls.

#![allow(dead_code)] // each test file uses a part of it

pub(crate) mod one_off;

use adwave::shape::{Mesh, Polygons, Shape};
use std::collections::HashMap;

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

/// A unit sphere of 4^(`subdivisions` + 1) + 2 vertices: the octahedron, its triangles cut into four again and again. More
/// regular than the built-in sphere, so its finest band is smaller.
pub(crate) fn octahedral_sphere(subdivisions: usize) -> Shape {
    let mut points: Vec<[f64; 3]> = vec![
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut triangles: Vec<[u32; 3]> =
        (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    for _ in 0..subdivisions {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut middle = |u: u32, v: u32| {
            *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                let (p, q) = (points[u as usize], points[v as usize]);
                let sum: [f64; 3] = std::array::from_fn(|c| p[c] + q[c]);
                let length = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
                points.push(sum.map(|c| c / length));
                points.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    Shape::Mesh(Mesh::new(points, Polygons::from_triangles(&triangles)).expect("a mesh"))
}
