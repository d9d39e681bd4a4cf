//! Side of a surface on which points lie.

use crate::ClosestPoint;
use crate::closest::sort_edge;
use adwave::shape::{PreparedGeometry, Shape, encloses_volume, nearest_neighbors};
use adwave::signal::{OutwardError, outward_normals};
use adwave::vector::{add_scaled, cross, dot, norm, subtract, unit};
use adwave::{Cancelled, Progress};
use nalgebra::{Matrix3, Vector3};
use std::collections::{HashMap, HashSet};

/// Largest number of neighbors over which the spread of the points of a cloud is measured; a fifth of a small cloud.
const SPREAD_NEIGHBORS: usize = 40;

/// Smallest number of neighbors over which the spread is measured.
const FEWEST_NEIGHBORS: usize = 10;

/// Number of points at which the spread is measured.
const SPREAD_SAMPLES: usize = 512;

/// Share of the least variance in the sum of all three above which points do not lie on a surface. Points in a volume
/// reach a quarter; points of a surface with noise of half their spacing reach a twentieth.
const VOLUME_SPREAD: f64 = 0.12;

/// Outward normals at the faces, edges and vertices of a mesh, or at the points of a cloud.
///
/// At an edge the normal is the sum of those of its faces, at a vertex their sum weighted by the angles. Let c be the
/// closest point to x: the sign of the product of `x − c` with the normal at c is the side of x (`baerentzen2005`).
pub struct SurfaceSides {
    /// Corners of the triangles that run clockwise seen from outside.
    turned: HashSet<[u32; 3]>,
    edges: HashMap<(u32, u32), [f64; 3]>,
    vertices: Vec<[f64; 3]>,
    /// True if the surface encloses a volume.
    pub is_closed: bool,
}

impl SurfaceSides {
    /// Finds the sides of a surface. Triangles that enclose a volume keep their orientation, up to the sign of the
    /// volume; others follow the outward normals of their corners, `outward`, one per welded vertex. O(n).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn new(
        geometry: &PreparedGeometry,
        outward: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let is_closed = encloses_volume(geometry, progress)?;
        let (points, triangles) = (geometry.points(), geometry.triangles());
        let is_inside_out = is_closed && volume_of(points, triangles) < 0.0;
        let mut sides = Self {
            turned: HashSet::new(),
            edges: HashMap::new(),
            vertices: if triangles.is_empty() { outward.to_vec() } else { vec![[0.0; 3]; points.len()] },
            is_closed,
        };
        for triangle in triangles {
            let [a, b, c] = triangle.map(|x| points[x as usize]);
            let Some(mut normal) = unit(&cross(&subtract(&b, &a), &subtract(&c, &a))) else { continue };
            let is_turned = if is_closed {
                is_inside_out
            } else {
                triangle.iter().map(|&x| dot(&normal, &outward[x as usize])).sum::<f64>() < 0.0
            };
            if is_turned {
                normal = normal.map(|c| -c);
                sides.turned.insert(*triangle);
            }
            for k in 0..3 {
                let [x, y, z] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
                let [p, q, r] = [x, y, z].map(|x| points[x as usize]);
                let (u, v) = (subtract(&q, &p), subtract(&r, &p));
                let angle = norm(&cross(&u, &v)).atan2(dot(&u, &v));
                let at_vertex = &mut sides.vertices[x as usize];
                *at_vertex = add_scaled(at_vertex, angle, &normal);
                let at_edge = sides.edges.entry(sort_edge([x, y])).or_default();
                *at_edge = add_scaled(at_edge, 1.0, &normal);
            }
        }
        Ok(sides)
    }

    /// Outward normal at a closest point of the surface; not a unit vector.
    pub fn normal(&self, closest: &ClosestPoint) -> [f64; 3] {
        let at: Vec<u32> = (0..3).filter(|&k| closest.weights[k] > 0.0).map(|k| closest.corners[k]).collect();
        match at[..] {
            [x] => self.vertices[x as usize],
            [x, y] => self.edges.get(&sort_edge([x, y])).copied().unwrap_or_default(),
            _ if self.turned.contains(&closest.corners) => closest.normal.map(|c| -c),
            _ => closest.normal,
        }
    }
}

/// Source of the signs of the distances from a shape to another one.
pub enum Signs {
    /// Outward normals of the shape, one per point: positive where the other shape lies on their side.
    Own(Vec<[f64; 3]>),
    /// Inside and outside of the other shape: positive where a point is inside of it, so that its surface lies farther
    /// out.
    Other(Box<SurfaceSides>),
    /// Neither shape has an outside: no distance is negative.
    Nothing,
}

impl Signs {
    /// Chooses the signs of the distances from `shape` to `other`, given the normals in their files, one per vertex. A
    /// mesh with an outside uses its own normals. For other shapes, `other` decides if it encloses a volume. Otherwise,
    /// a cloud whose points lie on a surface ([`lies_on_a_surface`]) uses its own normals; without them, the normals of
    /// `other` decide if it is a surface with an outside. O(n log n).
    ///
    /// # Errors
    /// [`OutwardError`] if `shape` is a graph, if the number of normals differs from that of the vertices, or if the
    /// call is cancelled.
    pub fn choose(
        [shape, other]: [&PreparedGeometry; 2],
        [normals, other_normals]: [Option<&[f64]>; 2],
        progress: Progress<'_>,
    ) -> Result<Self, OutwardError> {
        if matches!(shape.shape(), Shape::Graph(_)) {
            return Err(OutwardError::NoPositions);
        }
        let is_cloud = shape.triangles().is_empty();
        let encloses = encloses_volume(other, progress)?;
        if !(is_cloud && encloses) && has_surface(shape) {
            let own = outward_normals(shape, normals, progress)?;
            if own.info.has_outside() {
                return Ok(Self::Own(own.normals));
            }
        }
        if encloses || has_surface(other) {
            let outward = outward_normals(other, other_normals, progress)?;
            if encloses || outward.info.has_outside() {
                let sides = SurfaceSides::new(other, &outward.normals, progress)?;
                return Ok(Self::Other(Box::new(sides)));
            }
        }
        Ok(Self::Nothing)
    }

    /// Applies the sign to the distance of point `x`, where `offset` leads from the point to its closest point.
    pub(crate) fn sign(&self, distance: f64, x: usize, offset: &[f64; 3], closest: &ClosestPoint) -> f64 {
        match self {
            Self::Own(normals) => distance.copysign(dot(offset, &normals[x])),
            Self::Other(sides) => distance.copysign(dot(offset, &sides.normal(closest))),
            Self::Nothing => distance,
        }
    }

    /// True if distances have signs.
    pub fn is_signed(&self) -> bool {
        !matches!(self, Self::Nothing)
    }
}

/// True if a shape is a mesh or a cloud whose points lie on a surface.
fn has_surface(shape: &PreparedGeometry) -> bool {
    match shape.shape() {
        Shape::Graph(_) => false,
        _ => !shape.triangles().is_empty() || lies_on_a_surface(shape.points()),
    }
}

/// Six times the signed volume enclosed by the triangles.
fn volume_of(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let Some(origin) = points.first() else { return 0.0 };
    let at = |x: u32| subtract(&points[x as usize], origin);
    triangles.iter().map(|&[a, b, c]| dot(&at(a), &cross(&at(b), &at(c)))).sum()
}

/// True if the points of a cloud lie on a surface, not in a volume. The neighbors of a point, up to 40, spread over a
/// surface if their least variance is below 0.12 of the sum of all three. The median over about 512 points decides. O(n
/// log n).
///
/// ```
/// use adwave_register::lies_on_a_surface;
/// let fraction = |k: i32, step: f64| (f64::from(k) * step).fract();
/// let point = |k| [fraction(k, 0.819_172_513), fraction(k, 0.671_043_607), fraction(k, 0.549_700_478)];
/// let volume: Vec<[f64; 3]> = (0..2000).map(point).collect();
/// assert!(!lies_on_a_surface(&volume));
/// let dome: Vec<[f64; 3]> = volume.iter().map(|p| [p[0], p[1], p[0] * p[1]]).collect();
/// assert!(lies_on_a_surface(&dome));
/// ```
pub fn lies_on_a_surface(points: &[[f64; 3]]) -> bool {
    let near = nearest_neighbors(points, SPREAD_NEIGHBORS.min(points.len() / 5).max(FEWEST_NEIGHBORS));
    let step = points.len().div_ceil(SPREAD_SAMPLES).max(1);
    let mut spreads: Vec<f64> = (0..points.len())
        .step_by(step)
        .map(|x| {
            let around: Vec<Vector3<f64>> = near
                .adjacency
                .row(x)
                .iter()
                .map(|&y| Vector3::from(subtract(&points[y as usize], &points[x])))
                .chain([Vector3::zeros()])
                .collect();
            let size = around.iter().map(nalgebra::Matrix::amax).fold(0.0, f64::max);
            if size == 0.0 {
                return 0.0;
            }
            let mean = around.iter().sum::<Vector3<f64>>() / around.len() as f64;
            let spread = |m: Matrix3<f64>, d: &Vector3<f64>| {
                let d = (d - mean) / size;
                m + d * d.transpose()
            };
            let variances = around.iter().fold(Matrix3::zeros(), spread).symmetric_eigenvalues();
            variances.min() / variances.sum()
        })
        .collect();
    if spreads.is_empty() {
        return true;
    }
    let middle = spreads.len() / 2;
    *spreads.select_nth_unstable_by(middle, f64::total_cmp).1 < VOLUME_SPREAD
}
