//! Meshes for measurements: subdivided OBJ files, and spheres of any size.

use adwave::shape::{Mesh, Polygons, Shape};
use std::collections::HashMap;
use std::path::Path;

/// Triangle mesh.
#[derive(Clone)]
pub struct Triangles {
    /// Positions in model units.
    pub points: Vec<[f64; 3]>,
    /// Corners, from 0.
    pub faces: Vec<[u32; 3]>,
}

impl Triangles {
    /// Reads the vertices and triangles of an OBJ file, without the vertices that no triangle uses.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn from_obj(path: &Path) -> std::io::Result<Self> {
        let text = std::fs::read_to_string(path)?;
        let (mut points, mut faces) = (Vec::new(), Vec::new());
        for line in text.lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => {
                    let mut next = || words.next().and_then(|w| w.parse().ok()).unwrap_or(0.0);
                    points.push([next(), next(), next()]);
                }
                Some("f") => {
                    let corners: Vec<u32> = words
                        .filter_map(|w| w.split('/').next().and_then(|i| i.parse::<u32>().ok()))
                        .map(|i| i - 1)
                        .collect();
                    for k in 2..corners.len() {
                        faces.push([corners[0], corners[k - 1], corners[k]]);
                    }
                }
                _ => {}
            }
        }
        let mut number = vec![u32::MAX; points.len()];
        let mut used = Vec::new();
        for corner in faces.as_flattened_mut() {
            let at = *corner as usize;
            if number[at] == u32::MAX {
                number[at] = used.len() as u32;
                used.push(points[at]);
            }
            *corner = number[at];
        }
        Ok(Self { points: used, faces })
    }

    /// Octahedron projected onto the unit sphere.
    pub fn octahedron() -> Self {
        let points = vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let faces = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
        Self { points, faces }
    }

    /// Unit sphere of 4^(`subdivisions` + 1) + 2 vertices.
    pub fn sphere(subdivisions: usize) -> Self {
        (0..subdivisions).fold(Self::octahedron(), |sphere, _| sphere.subdivide().project_to_unit_sphere())
    }

    /// Divides every triangle into four at the midpoints of its edges.
    #[must_use]
    pub fn subdivide(mut self) -> Self {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut faces = Vec::with_capacity(4 * self.faces.len());
        for &[a, b, c] in &self.faces {
            let mut middle = |u: u32, v: u32| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let (p, q) = (self.points[u as usize], self.points[v as usize]);
                    self.points.push(std::array::from_fn(|i| 0.5 * (p[i] + q[i])));
                    self.points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            faces.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        self.faces = faces;
        self
    }

    /// Moves every vertex to distance 1 from the origin.
    #[must_use]
    pub fn project_to_unit_sphere(mut self) -> Self {
        for p in &mut self.points {
            let length = p.iter().map(|c| c * c).sum::<f64>().sqrt();
            *p = p.map(|c| c / length);
        }
        self
    }

    /// Converts to a shape.
    ///
    /// # Panics
    /// If a coordinate is not finite or a triangle names a vertex that does not exist.
    pub fn into_shape(self) -> Shape {
        let faces = Polygons::from_triangles(&self.faces);
        Shape::Mesh(Mesh::new(self.points, faces).expect("the points are finite and the faces use them"))
    }
}
