//! Meshes of the tests.

use adwave_subdivision::{Hierarchy, subdivide};

/// Points and triangles.
#[derive(Clone)]
pub(crate) struct TestMesh {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl TestMesh {
    /// The mesh cut `n_levels` times, with the new points in the middle of their edges.
    pub(crate) fn cut(&self, n_levels: usize) -> Self {
        let mut mesh = self.clone();
        for _ in 0..n_levels {
            let finer = subdivide(mesh.points.len(), &mesh.triangles);
            for [a, b] in finer.parents {
                let (p, q) = (mesh.points[a as usize], mesh.points[b as usize]);
                mesh.points.push([0, 1, 2].map(|k| f64::midpoint(p[k], q[k])));
            }
            mesh.triangles = finer.triangles;
        }
        mesh
    }

    /// The mesh with its points on the unit sphere.
    pub(crate) fn on_sphere(mut self) -> Self {
        for p in &mut self.points {
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            *p = p.map(|x| x / length);
        }
        self
    }

    pub(crate) fn hierarchy(&self) -> Hierarchy {
        Hierarchy::new(self.points.len(), &self.triangles, adwave::Progress::none()).expect("levels")
    }

    /// The mesh with vertices and faces in another order, faces turned, and the place of each vertex.
    pub(crate) fn shuffled(&self, seed: u64) -> (Self, Vec<u32>) {
        let mut random = Random(seed);
        let mut places: Vec<u32> = (0..self.points.len() as u32).collect();
        random.shuffle(&mut places);
        let mut points = vec![[0.0; 3]; places.len()];
        for (p, &place) in self.points.iter().zip(&places) {
            points[place as usize] = *p;
        }
        let mut triangles: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .map(|t| {
                let mut t = t.map(|v| places[v as usize]);
                t.rotate_left(random.below(3));
                // Either orientation.
                if random.below(2) == 1 {
                    t.swap(0, 1);
                }
                t
            })
            .collect();
        random.shuffle(&mut triangles);
        (Self { points, triangles }, places)
    }

    pub(crate) fn euler(&self) -> i64 {
        let mut edges: Vec<[u32; 2]> = self
            .triangles
            .iter()
            .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        edges.dedup();
        self.points.len() as i64 - edges.len() as i64 + self.triangles.len() as i64
    }
}

/// Numbers that look random and are the same in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.next() as usize % n
    }

    pub(crate) fn number(&mut self) -> f64 {
        self.next() as f64 / (1_u64 << 31) as f64
    }

    pub(crate) fn shuffle<T>(&mut self, values: &mut [T]) {
        for k in (1..values.len()).rev() {
            values.swap(k, self.below(k + 1));
        }
    }
}

pub(crate) fn tetrahedron() -> TestMesh {
    let points = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    TestMesh { points, triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] }
}

pub(crate) fn octahedron() -> TestMesh {
    let points = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    TestMesh { points, triangles }
}

/// Triangles of a grid of `n` × `m` squares; sides that wrap around are glued.
pub(crate) fn grid(n: u32, m: u32, wraps: bool) -> TestMesh {
    let (columns, rows) = if wraps { (n, m) } else { (n + 1, m + 1) };
    let vertex = |i: u32, j: u32| j % rows * columns + i % columns;
    let point = |v: u32| {
        let (i, j) = (f64::from(v % columns), f64::from(v / columns));
        // Equilateral triangles in the plane, or any points of a torus.
        if wraps {
            [i.cos() * (3.0 + j.cos()), i.sin() * (3.0 + j.cos()), j.sin()]
        } else {
            [i + 0.5 * j, 0.75_f64.sqrt() * j, 0.0]
        }
    };
    let squares = (0..m).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = squares
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1));
            [[a, b, c], [b, d, c]]
        })
        .collect();
    TestMesh { points: (0..columns * rows).map(point).collect(), triangles }
}

/// A disk of seven points with a border of six edges.
pub(crate) fn fan(n: u32) -> TestMesh {
    let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let ring = (0..n).map(|k| [angle(k).cos(), angle(k).sin(), 0.0]);
    let points = std::iter::once([0.0; 3]).chain(ring).collect();
    TestMesh { points, triangles: (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect() }
}

pub(crate) fn areas(mesh: &TestMesh) -> Vec<f64> {
    adwave::shape::mesh_areas(&mesh.points, &mesh.triangles, adwave::shape::MeshArea::Barycentric)
}
