//! Mirror planes of a shape, so that nodes are placed symmetrically.

use crate::front::SourceOrder;
use crate::rotation::{add_outer, symmetric_eigen};
use adwave::Decomposer;
use adwave::vector::{Vector, add_scaled, dot, norm, subtract};

/// Number of vertices that are compared with their mirror images.
const N_COMPARED: usize = 512;

/// Share of the compared vertices that must lie near a vertex after mirroring.
const SYMMETRIC: f64 = 0.99;

/// Distance of a mirrored vertex from the nearest one, in mean edges at that one, that counts as near.
const NEAR: f64 = 0.75;

/// Distance from a plane, relative to the extent, at which a vertex lies on it.
const ON_PLANE: f64 = 1e-7;

/// Largest cosine between the normals of two planes of one shape.
const ORTHOGONAL: f64 = 1e-3;

/// Mirror planes of a shape through its center, at right angles to each other: at most three.
pub(crate) struct MirrorPlanes<'a> {
    decomposer: &'a Decomposer,
    takes_part: &'a [bool],
    center: Vector,
    normals: Vec<Vector>,
    thickness: f64,
}

impl<'a> MirrorPlanes<'a> {
    /// Compares the shape with its images in the planes of the coordinates and of its principal axes.
    pub(crate) fn find(decomposer: &'a Decomposer, takes_part: &'a [bool]) -> Self {
        let points = decomposer.positions();
        let mut masses = vec![0.0; points.len()];
        for (a, &x) in decomposer.areas().iter().zip(decomposer.vertex_map().as_slice()) {
            masses[x as usize] += if takes_part[x as usize] { *a } else { 0.0 };
        }
        let total: f64 = masses.iter().sum();
        let thickness = ON_PLANE * decomposer.extent();
        let mut own = Self { decomposer, takes_part, center: [0.0; 3], normals: Vec::new(), thickness };
        if !(total > 0.0 && total.is_finite()) {
            return own;
        }
        for (p, m) in points.iter().zip(&masses) {
            own.center = add_scaled(&own.center, m / total, p);
        }
        let mut moments = [[0.0; 3]; 3];
        for (p, m) in points.iter().zip(&masses).filter(|(_, m)| **m > 0.0) {
            let d = subtract(p, &own.center);
            add_outer(&mut moments, m / total, &d, &d);
        }
        let (_, axes) = symmetric_eigen(moments);
        let coordinates = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let principal = [0, 1, 2].map(|k| [axes[0][k], axes[1][k], axes[2][k]]);
        for normal in coordinates.into_iter().chain(principal) {
            let is_apart = own.normals.iter().all(|other| dot(other, &normal).abs() < ORTHOGONAL);
            if is_apart && own.is_mirror(&normal) {
                own.normals.push(normal);
            }
        }
        own
    }

    fn mirrored(&self, p: &Vector, normal: &Vector) -> Vector {
        add_scaled(p, -2.0 * dot(&subtract(p, &self.center), normal), normal)
    }

    /// Vertex nearest to the image of a point, if it takes part, and its distance.
    fn nearest(&self, image: &Vector) -> Option<(u32, f64)> {
        let y = self.decomposer.metric().nearest(image).filter(|&y| self.takes_part[y])?;
        Some((y as u32, norm(&subtract(image, &self.decomposer.positions()[y]))))
    }

    fn is_mirror(&self, normal: &Vector) -> bool {
        let points = self.decomposer.positions();
        let neighbors = self.decomposer.neighbors();
        let stride = (points.len() / N_COMPARED).max(1);
        let (mut n_compared, mut n_near) = (0.0, 0.0);
        for x in (0..points.len()).step_by(stride).filter(|&x| self.takes_part[x]) {
            n_compared += 1.0;
            let Some((y, distance)) = self.nearest(&self.mirrored(&points[x], normal)) else { continue };
            let around = neighbors.row(y as usize);
            let length = |z: &u32| norm(&subtract(&points[*z as usize], &points[y as usize]));
            let mean = around.iter().map(length).sum::<f64>() / around.len().max(1) as f64;
            n_near += f64::from(u8::from(distance <= NEAR * mean));
        }
        n_compared > 0.0 && n_near >= SYMMETRIC * n_compared
    }
}

impl SourceOrder for MirrorPlanes<'_> {
    /// Vertices on most planes first, so that those beside a plane keep their distance from it.
    fn order(&self) -> Vec<u32> {
        let points = self.decomposer.positions();
        let mut order: Vec<u32> = (0..points.len() as u32).filter(|&x| self.takes_part[x as usize]).collect();
        if !self.normals.is_empty() {
            let d = |x: u32| subtract(&points[x as usize], &self.center);
            let on = |x: u32| self.normals.iter().filter(|n| dot(&d(x), n).abs() <= self.thickness).count();
            order.sort_by_cached_key(|&x| std::cmp::Reverse(on(x)));
        }
        order
    }

    /// Vertices nearest to the images of a vertex in all planes.
    fn images(&self, x: u32) -> Vec<u32> {
        let mut places = vec![self.decomposer.positions()[x as usize]];
        for normal in &self.normals {
            let mirrored: Vec<Vector> = places.iter().map(|p| self.mirrored(p, normal)).collect();
            places.extend(mirrored);
        }
        places[1..].iter().filter_map(|p| self.nearest(p)).map(|(y, _)| y).filter(|&y| y != x).collect()
    }
}
