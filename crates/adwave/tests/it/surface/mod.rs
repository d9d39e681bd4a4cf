//! Heat on the surface: how near it is to heat on the surface that a mesh stands for, what holds for every shape, and what
//! becomes of shapes that are none.

mod accuracy;
mod bad_input;
mod laws;
mod meshes;
mod real_files;

use adwave::operator::{OperatorKind, OperatorParams};
use adwave::shape::{Mesh, PointCloud, Polygons, Shape};
use adwave::{Decomposer, Progress};

fn params() -> OperatorParams {
    OperatorParams::default().with_kind(OperatorKind::Surface)
}

fn decomposer(shape: &Shape) -> Decomposer {
    Decomposer::with_params(shape, &params(), Progress::none()).expect("nobody can stop this")
}

fn mesh(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Shape {
    Shape::Mesh(Mesh::new(points.to_vec(), Polygons::from_triangles(triangles)).expect("a mesh"))
}

fn cloud(points: &[[f64; 3]]) -> Shape {
    Shape::Cloud(PointCloud::new(points.to_vec()).expect("a cloud"))
}
