//! Features as small spheres, for display.

use super::Feature;
use crate::shape::Polygons;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Spheres as one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Spheres {
    /// Vertices in model units.
    pub points: Vec<[f64; 3]>,
    /// Triangles of all spheres.
    pub faces: Polygons,
    /// Index of the feature of each vertex.
    pub feature_of: Vec<u32>,
}

/// Builds a sphere of radius σ around every feature that has a position: an icosahedron subdivided once, with 42
/// vertices and 80 triangles. O(features).
///
/// ```
/// use adwave::features::{Feature, spheres};
/// let feature = Feature {
///     vertex: 0, position: Some([1.0, 2.0, 3.0]), level: 4, sigma: 0.5, response: 3.0, strength: 3.0, channel: None,
/// };
/// let sphere = spheres(&[feature]);
/// assert_eq!((sphere.points.len(), sphere.faces.len()), (42, 80));
/// let radius = |p: &[f64; 3]| ((p[0] - 1.0).powi(2) + (p[1] - 2.0).powi(2) + (p[2] - 3.0).powi(2)).sqrt();
/// assert!(sphere.points.iter().all(|p| (radius(p) - 0.5).abs() < 1e-12));
/// ```
pub fn spheres(features: &[Feature]) -> Spheres {
    let (unit, triangles) = unit_sphere();
    let mut spheres = Spheres { points: Vec::new(), faces: Polygons::new(), feature_of: Vec::new() };
    for (k, feature) in features.iter().enumerate() {
        let Some(center) = feature.position else { continue };
        let first = spheres.points.len() as u32;
        let place = |n: &Vector3<f64>| -> [f64; 3] { (Vector3::from(center) + feature.sigma * n).into() };
        spheres.points.extend(unit.iter().map(place));
        spheres.feature_of.extend(std::iter::repeat_n(k as u32, unit.len()));
        for t in &triangles {
            spheres.faces.push(&t.map(|v| first + v));
        }
    }
    spheres
}

fn unit_sphere() -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([Vector3::new(0.0, a, b), Vector3::new(a, b, 0.0), Vector3::new(b, 0.0, a)]);
    }
    // The 20 faces are the triples at the shortest distance, oriented outwards.
    let near = |i: usize, j: usize| (points[i] - points[j]).norm_squared() < 4.5;
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let out = (points[j] - points[i]).cross(&(points[k] - points[i])).dot(&points[i]) > 0.0;
                    let (j, k) = if out { (j, k) } else { (k, j) };
                    faces.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    let mut middle = HashMap::new();
    let mut fine = Vec::with_capacity(80);
    for [a, b, c] in faces {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            *middle.entry((p.min(q), p.max(q))).or_insert_with(|| {
                points.push(points[p as usize] + points[q as usize]);
                points.len() as u32 - 1
            })
        });
        fine.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    (points.iter().map(Vector3::normalize).collect(), fine)
}
