//! Small irregular shapes: unequal edges and areas, borders, seams, non-manifold edges, several components.

use adwave::operator::{CloudGraph, OperatorKind, OperatorParams};
use adwave::shape::{CloudArea, Graph, Mesh, MeshArea, PointCloud, Polygons, Shape};

/// Elements of a shape, for the formulas.
#[derive(Clone, Debug)]
pub(crate) enum Parts {
    Mesh { points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]> },
    Cloud { points: Vec<[f64; 3]> },
    Graph { n_nodes: usize, edges: Vec<(u32, u32, f64)> },
}

impl Parts {
    pub(crate) fn n_vertices(&self) -> usize {
        match self {
            Self::Mesh { points, .. } | Self::Cloud { points } => points.len(),
            Self::Graph { n_nodes, .. } => *n_nodes,
        }
    }

    pub(crate) fn shape(&self) -> Shape {
        match self {
            Self::Mesh { points, triangles } => {
                Shape::Mesh(Mesh::new(points.clone(), Polygons::from_triangles(triangles)).unwrap())
            }
            Self::Cloud { points } => Shape::Cloud(PointCloud::new(points.clone()).unwrap()),
            Self::Graph { n_nodes, edges } => Shape::Graph(Graph::new(*n_nodes, edges).unwrap()),
        }
    }
}

/// A shape and how its operator is built.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) parts: Parts,
    pub(crate) params: OperatorParams,
}

/// Every shape with every option that the formulas cover.
pub(crate) fn cases() -> Vec<Case> {
    let default = OperatorParams::default();
    let case = |name, parts: &Parts, params| Case { name, parts: parts.clone(), params };
    let (open, closed, seam, cloud) = (open_mesh(), closed_mesh(), seam_mesh(), cloud());
    vec![
        case("open mesh", &open, default),
        case("open mesh, mixed Voronoi areas", &open, default.with_mesh_area(MeshArea::MixedVoronoi)),
        case("open mesh, 2 rings", &open, default.with_rings(2)),
        case("closed mesh", &closed, default),
        case("closed mesh, mixed Voronoi areas", &closed, default.with_mesh_area(MeshArea::MixedVoronoi)),
        case("closed mesh, 3 rings", &closed, default.with_rings(3)),
        case("mesh with a seam", &seam, default),
        case("mesh with a seam, mixed Voronoi areas", &seam, default.with_mesh_area(MeshArea::MixedVoronoi)),
        case("cloud", &cloud, default),
        case("cloud, areas of 1", &cloud, default.with_cloud_area(CloudArea::Unit)),
        case("cloud, Voronoi areas", &cloud, default.with_cloud_area(CloudArea::TangentVoronoi)),
        case("cloud, 4 neighbors", &cloud, default.with_neighbors(4)),
        case("directed cloud", &cloud, default.with_cloud_graph(CloudGraph::Directed)),
        case(
            "directed cloud, 4 neighbors",
            &cloud,
            default.with_cloud_graph(CloudGraph::Directed).with_neighbors(4),
        ),
        case("graph", &graph(), default),
    ]
}

/// Shapes for heat on the surface; those that start with "flat" lie in the plane z = 0.
pub(crate) fn surface_cases() -> Vec<Case> {
    let params = OperatorParams::default().with_kind(OperatorKind::Surface);
    let case = |name, parts| Case { name, parts, params };
    vec![
        case("closed mesh", closed_mesh()),
        case("open mesh with obtuse corners", open_mesh()),
        case("one obtuse triangle", one_triangle()),
        case("flat mesh", flat_mesh()),
        case("three sheets at an edge", three_sheets()),
        case("cloud", cloud()),
        case("flat cloud", flat_cloud()),
        case("graph", graph()),
        case("graph with a hub", hub_graph()),
    ]
}

/// Numbers in [0, 1) without pattern, the same in every run.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Splitmix64.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [−1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }
}

/// A signal without pattern, n_vertices × n_channels.
pub(crate) fn signal(n_vertices: usize, n_channels: usize, seed: u64) -> Vec<f64> {
    let mut noise = Noise::new(seed);
    (0..n_vertices * n_channels).map(|_| noise.signed()).collect()
}

/// Squares cut in two along diagonals that turn, as triangles over rows of `width` vertices.
fn sheet(width: u32, height: u32, first: u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for i in 0..height - 1 {
        for j in 0..width - 1 {
            let [a, b, c, d] =
                [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)].map(|(i, j)| first + i * width + j);
            if (i + 2 * j) % 3 == 0 {
                triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
    }
    triangles
}

/// Vertices of a sheet, moved about, with a bump; the squares grow along x.
fn bumpy(width: u32, height: u32, noise: &mut Noise) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for i in 0..height {
        for j in 0..width {
            let x = 1.2 * f64::from(j) + 0.09 * f64::from(j * j) + 0.3 * noise.signed();
            let y = 0.8 * f64::from(i) + 0.25 * noise.signed();
            let bump = 2.0 * (-((x - 4.0).powi(2) + (y - 2.0).powi(2)) / 2.0).exp();
            points.push([x, y, bump + 0.3 * noise.signed()]);
        }
    }
    points
}

/// A bumpy sheet with a border, and a vertex that no face names.
fn open_mesh() -> Parts {
    let mut points = bumpy(8, 7, &mut Noise::new(11));
    points.insert(20, [9.0, -3.0, 1.0]);
    let past = |v: u32| if v >= 20 { v + 1 } else { v };
    Parts::Mesh { points, triangles: sheet(8, 7, 0).into_iter().map(|t| t.map(past)).collect() }
}

/// An octahedron cut twice, with a bumpy radius, stretched: a closed surface of 66 vertices, in units of 1e-3.
fn closed_mesh() -> Parts {
    let mut points: Vec<[f64; 3]> = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..2 {
        let mut midpoints: Vec<((u32, u32), u32)> = Vec::new();
        let mut finer = Vec::new();
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(u, v)| {
                let edge = (u.min(v), u.max(v));
                if let Some((_, at)) = midpoints.iter().find(|(e, _)| *e == edge) {
                    return *at;
                }
                let at = points.len() as u32;
                let (p, q) = (points[u as usize], points[v as usize]);
                let middle: [f64; 3] = std::array::from_fn(|i| p[i] + q[i]);
                let length = middle.iter().map(|m| m * m).sum::<f64>().sqrt();
                points.push(middle.map(|m| m / length));
                midpoints.push((edge, at));
                at
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    let mut noise = Noise::new(5);
    for p in &mut points {
        let radius = 1e-3 * (1.0 + 0.3 * noise.signed());
        *p = [radius * p[0], 0.6 * radius * p[1], 1.7 * radius * p[2]];
    }
    Parts::Mesh { points, triangles }
}

/// Two sheets that meet along a column of repeated positions, a fin on an edge inside, a face given twice, a face with a
/// repeated corner, and a vertex whose only face has no area.
fn seam_mesh() -> Parts {
    let mut noise = Noise::new(23);
    let mut points = bumpy(5, 6, &mut noise);
    let mut right = bumpy(4, 6, &mut noise);
    for i in 0..6 {
        let seam = points[5 * i + 4];
        for j in 0..4 {
            right[4 * i + j][0] += 6.0;
        }
        right[4 * i] = seam;
    }
    points.extend(right);
    let mut triangles = sheet(5, 6, 0);
    triangles.extend(sheet(4, 6, 30));
    let fin = points.len() as u32;
    let [a, b, ..] = triangles[12];
    points.push([2.0, 1.5, 3.0]);
    triangles.push([a, b, fin]);
    triangles.push(triangles[3]);
    triangles.push([7, 7, 8]);
    let flat = points.len() as u32;
    let (p, q) = (points[0], points[1]);
    points.push(std::array::from_fn(|c| p[c] + 2.0 * (q[c] - p[c])));
    // Exactly no area: two corners are at one position, by a second vertex at the place of vertex 0.
    points.push(p);
    triangles.push([0, flat + 1, flat]);
    // A third vertex there, which no face names.
    points.push(p);
    Parts::Mesh { points, triangles }
}

/// Points on a curved sheet, ever sparser, one of them twice and one far from all.
fn cloud() -> Parts {
    let mut noise = Noise::new(3);
    let mut points: Vec<[f64; 3]> = (0..70)
        .map(|_| {
            let (u, v) = (noise.next().powi(2) * 9.0, noise.next() * 4.0);
            [u, v, (0.6 * u).sin() + 0.1 * noise.signed()]
        })
        .collect();
    points.push(points[13]);
    points.push([14.0, 9.0, 2.0]);
    Parts::Cloud { points }
}

/// A tree with a few cycles and weights from 0.1 to 10, a triangle, a path, and a node by itself; an edge is given twice and
/// one is a loop.
fn graph() -> Parts {
    let mut noise = Noise::new(77);
    let weight = |noise: &mut Noise| 10.0_f64.powf(noise.signed());
    let mut edges = Vec::new();
    for v in 1..34_u32 {
        edges.push(((noise.next() * f64::from(v)) as u32, v, weight(&mut noise)));
    }
    for _ in 0..12 {
        let (u, v) = ((noise.next() * 34.0) as u32, (noise.next() * 34.0) as u32);
        edges.push((u, v, weight(&mut noise)));
    }
    edges.push((edges[4].1, edges[4].0, 0.7));
    edges.push((9, 9, 3.0));
    // The node 34 is by itself.
    edges.extend([(35, 36, 2.0), (36, 37, 0.5), (35, 37, 1.0), (38, 39, 4.0), (39, 40, 1.0), (40, 41, 2.0)]);
    Parts::Graph { n_nodes: 42, edges }
}

/// Obtuse, its longest side on the border as the others are.
fn one_triangle() -> Parts {
    Parts::Mesh {
        points: vec![[-1.0, 0.0, 0.2], [1.1, 0.0, 0.0], [0.1, 0.4, 0.0]],
        triangles: vec![[0, 1, 2]],
    }
}

/// A rectangle of 150 vertices, which are pushed about but for the corners, along the border on it; its triangles are not those
/// of Delaunay.
fn flat_mesh() -> Parts {
    let (width, height) = (15, 10);
    let mut noise = Noise::new(31);
    let mut points = Vec::new();
    for i in 0..height {
        for j in 0..width {
            let push = |k: u32, n: u32, v: f64| if k > 0 && k < n - 1 { 0.38 * v } else { 0.0 };
            let (x, y) = (noise.signed(), noise.signed());
            points.push([f64::from(j) + push(j, width, x), f64::from(i) + push(i, height, y), 0.0]);
        }
    }
    Parts::Mesh { points, triangles: sheet(width, height, 0) }
}

/// Three half-planes of nearly equilateral triangles that share a line.
fn three_sheets() -> Parts {
    let mut noise = Noise::new(41);
    let (length, width) = (6_u32, 4_u32);
    let mut points: Vec<[f64; 3]> = (0..length).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let mut triangles = Vec::new();
    for angle in [0.3_f64, 2.2, 4.5] {
        let first = points.len() as u32;
        for row in 1..=width {
            for i in 0..length {
                let across = 0.85 * f64::from(row) + 0.06 * noise.signed();
                let along = f64::from(i) + 0.5 * f64::from(row % 2) + 0.06 * noise.signed();
                points.push([along, across * angle.cos(), across * angle.sin()]);
            }
        }
        let at = |row: u32, i: u32| if row == 0 { i } else { first + (row - 1) * length + i };
        for row in 0..width {
            for i in 0..length - 1 {
                let [a, b, c, d] = [at(row, i), at(row, i + 1), at(row + 1, i), at(row + 1, i + 1)];
                triangles.extend(if row % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
            }
        }
    }
    Parts::Mesh { points, triangles }
}

/// Points of a square, pushed about.
fn flat_cloud() -> Parts {
    let mut noise = Noise::new(51);
    let mut points = Vec::new();
    for i in 0..11 {
        for j in 0..12 {
            points.push([f64::from(i) + 0.35 * noise.signed(), f64::from(j) + 0.35 * noise.signed(), 0.0]);
        }
    }
    Parts::Cloud { points }
}

/// A cycle of 119 nodes with a node in its middle that has an edge to all others of even number.
fn hub_graph() -> Parts {
    let mut noise = Noise::new(61);
    let mut edges: Vec<_> = (0..119).map(|i| (i, (i + 1) % 119, 0.2 + noise.next())).collect();
    edges.extend((0..119).step_by(2).map(|i| (i, 119, 0.5)));
    Parts::Graph { n_nodes: 120, edges }
}
