//! Tubes around the edges of a curve, which is drawn as round lines.

use adwave::vector::{Vector, add_scaled, cross, norm, subtract, unit};

/// Number of sides of a tube.
const SIDES: usize = 8;

/// Number of rings of a ball between its poles.
const RINGS: usize = 3;

/// Number of edges from which on tubes have three sides and no balls at their joints, so that a large network needs no
/// more memory than a mesh of its size.
const MANY_EDGES: usize = 100_000;

/// Surface of tubes with a ball at each vertex. Each vertex of this surface belongs to a vertex of the curve.
///
/// ```
/// use adwave_render::Tubes;
/// let tubes = Tubes::new(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]], 0.1);
/// assert_eq!(tubes.points().len(), tubes.spread(&[7, 8]).len());
/// let is_near = |p: &[f64; 3]| {
///     (p[1].hypot(p[2]) - 0.1).abs() < 1e-12 || !(0.0..=1.0).contains(&p[0]) || p[1].hypot(p[2]) < 0.1
/// };
/// assert!(tubes.points().iter().all(is_near));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tubes {
    points: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
    owner: Vec<u32>,
}

impl Tubes {
    /// Creates tubes of `radius` (model units) around the edges of the curve with vertices at `points`. Each vertex
    /// gets a ball, except the joints of a large curve. Edges with an end that is no vertex are left out. O(n).
    pub fn new(points: &[Vector], edges: &[[u32; 2]], radius: f64) -> Self {
        let is_large = edges.len() >= MANY_EDGES;
        let n_sides = if is_large { 3 } else { SIDES };
        let mut tubes = Self::default();
        for &[a, b] in edges {
            if let (Some(from), Some(to)) = (points.get(a as usize), points.get(b as usize))
                && let Some(along) = unit(&subtract(to, from))
            {
                tubes.add_tube([(a, *from), (b, *to)], along, n_sides, radius);
            }
        }
        let mut has_edge = vec![false; points.len()];
        for x in edges.iter().flatten() {
            if let Some(has_edge) = has_edge.get_mut(*x as usize) {
                *has_edge = true;
            }
        }
        for (x, center) in (0..).zip(points) {
            if !(is_large && has_edge[x as usize]) {
                tubes.add_ball(x, center, radius);
            }
        }
        tubes
    }

    /// Positions, in model units.
    pub fn points(&self) -> &[Vector] {
        &self.points
    }

    /// Triangles, as indices of the points.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Copies the values of the curve's vertices to the points of the tubes.
    ///
    /// # Panics
    /// Panics if a vertex of the curve has no value.
    pub fn spread<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.owner.iter().map(|&x| values[x as usize]).collect()
    }

    fn add_tube(&mut self, ends: [(u32, Vector); 2], along: Vector, n_sides: usize, radius: f64) {
        let across = perpendicular(&along);
        let up = cross(&along, &across);
        let first = self.points.len() as u32;
        for k in 0..n_sides {
            let angle = std::f64::consts::TAU * k as f64 / n_sides as f64;
            let out = add_scaled(&across.map(|c| c * angle.cos()), angle.sin(), &up);
            for (owner, center) in &ends {
                self.points.push(add_scaled(center, radius, &out));
                self.owner.push(*owner);
            }
        }
        let corner = |k: usize, end: u32| first + 2 * (k % n_sides) as u32 + end;
        for k in 0..n_sides {
            let [a, b, c, d] = [corner(k, 0), corner(k + 1, 0), corner(k + 1, 1), corner(k, 1)];
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    fn add_ball(&mut self, owner: u32, center: &Vector, radius: f64) {
        let first = self.points.len() as u32;
        let n = SIDES as u32;
        let mut add = |direction: Vector| {
            self.points.push(add_scaled(center, radius, &direction));
            self.owner.push(owner);
        };
        add([0.0, 0.0, -1.0]);
        for ring in 1..=RINGS {
            let polar = std::f64::consts::PI * ring as f64 / (RINGS + 1) as f64;
            for k in 0..SIDES {
                let angle = std::f64::consts::TAU * k as f64 / SIDES as f64;
                add([polar.sin() * angle.cos(), polar.sin() * angle.sin(), -polar.cos()]);
            }
        }
        add([0.0, 0.0, 1.0]);
        let at = |ring: u32, k: u32| first + 1 + ring * n + k % n;
        let rings = RINGS as u32;
        let top = first + 1 + rings * n;
        for k in 0..n {
            self.triangles.push([first, at(0, k + 1), at(0, k)]);
            for ring in 1..rings {
                let [a, b, c, d] = [at(ring - 1, k), at(ring - 1, k + 1), at(ring, k + 1), at(ring, k)];
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
            self.triangles.push([top, at(rings - 1, k), at(rings - 1, k + 1)]);
        }
    }
}

/// Unit vector perpendicular to a unit vector.
fn perpendicular(along: &Vector) -> Vector {
    let smallest = (0..3).min_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[smallest] = 1.0;
    let across = cross(along, &axis);
    let length = norm(&across);
    across.map(|c| c / length)
}
