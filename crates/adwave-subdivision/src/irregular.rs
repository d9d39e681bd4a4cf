//! Pyramid for any triangle mesh: on each level, vertices without a common edge are removed.
//!
//! A removed vertex is predicted from its ring by mean values (`floater2003`). Before that, the ring is laid out in the
//! plane with its lengths, and with its angles scaled to a full turn (`duchamp1997`). The vertex merges with the
//! neighbor that gives the best triangles there. Vertices are tried in the order of their areas, so that all regions
//! thin out together. A vertex on a border is predicted from its two neighbors along the border. Vertices at which the
//! surface is not a manifold remain.
//!
//! Another pyramid for the same purpose is that of `guskov1999`.

use crate::lifting::{StepRule, check_field};
use crate::rows::{Entry, RowBuilder};
use crate::{Family, LiftedWavelets, SubdivisionError};
use adwave::{Cancelled, Progress};
use rayon::slice::ParallelSliceMut;
use std::f64::consts::{PI, TAU};

/// Number of vertices below which no further level is created.
const LEAST_VERTICES: usize = 32;

/// Inverse of the share of the vertices that a level must remove.
const LEAST_PROGRESS: usize = 50;

/// Number of faces at a vertex above which the vertex is not removed on this level.
const MAX_NEIGHBORS: usize = 16;

/// Number of faces at a vertex above which no other vertex merges with it.
const MAX_TARGET_FACES: usize = 64;

/// Largest angle between two successive neighbors of a removed vertex, in radians, after scaling.
const MAX_ANGLE: f64 = 0.97 * PI;

/// Least quality of a new triangle in the plane: 4·√3·area divided by the sum of the squares of its sides, which is 1
/// for an equilateral triangle.
const LEAST_QUALITY: f64 = 0.02;

/// Number of vertices between two checks for cancellation.
const AT_A_TIME: usize = 1 << 10;

impl LiftedWavelets {
    /// Prepares the wavelets of any triangle mesh, for masses of its vertices; [`Family::Irregular`].
    ///
    /// The positions, in model units, only decide on the vertices that are removed and on their predictions. O(n log
    /// n).
    ///
    /// # Errors
    /// [`SubdivisionError`] for positions or masses that do not fit, for a mesh from which no vertex can be removed,
    /// and on cancellation.
    pub fn new_irregular(
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        masses: &[f64],
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        check_field(points.as_flattened(), points.len(), 3, "coordinates")?;
        if triangles.is_empty() {
            return Err(SubdivisionError::NoFaces);
        }
        let n_vertices = points.len();
        for (face, t) in triangles.iter().enumerate() {
            if let Some(&index) = t.iter().find(|&&v| v as usize >= n_vertices) {
                return Err(SubdivisionError::IndexOutOfRange { face, index, n_vertices });
            }
        }
        let mut mesh = DynamicMesh::new(points, triangles, progress)?;
        let mut areas = crate::lifting::usable_masses(masses, n_vertices, "areas of the vertices")?;
        let mut left: Vec<u32> = (0..n_vertices as u32).collect();
        let mut rounds = Vec::new();
        while left.len() > LEAST_VERTICES {
            let round = mesh.thin(&left, &mut areas, progress)?;
            if round.removed.len() * LEAST_PROGRESS < left.len() {
                break;
            }
            left.retain(|&v| !mesh.is_removed[v as usize]);
            rounds.push(round);
        }
        if rounds.is_empty() {
            return Err(SubdivisionError::Family {
                family: Family::Irregular.name(),
                reason: "found no vertices to remove; it needs a surface of more than 32 vertices",
            });
        }
        // The vertices of the coarsest level first, then what each round has removed, the last round first.
        let mut order = left;
        let mut n_coarse = vec![0; rounds.len()];
        for (k, round) in rounds.iter().enumerate().rev() {
            n_coarse[k] = order.len();
            order.extend(&round.removed);
        }
        let mut places = vec![0; n_vertices];
        for (place, &v) in (0..).zip(&order) {
            places[v as usize] = place;
        }
        let rules: Vec<StepRule> = rounds
            .into_iter()
            .zip(n_coarse)
            .map(|(round, n_coarse)| round.into_rule(&places, n_coarse, progress))
            .collect::<Result<_, _>>()?;
        Self::from_rules(Family::Irregular, order, rules.into_iter(), masses, progress)
    }
}

/// Vertices removed on one level, with the weights of their neighbors as vertices of the mesh.
struct Round {
    removed: Vec<u32>,
    /// Number of predicting neighbors of each removed vertex.
    counts: Vec<usize>,
    entries: Vec<Entry>,
}

impl Round {
    fn into_rule(
        self,
        places: &[u32],
        n_coarse: usize,
        progress: Progress<'_>,
    ) -> Result<StepRule, Cancelled> {
        let (mut prediction, mut row, mut first) = (RowBuilder::new(), Vec::new(), 0);
        for (k, count) in self.counts.into_iter().enumerate() {
            if k % AT_A_TIME == 0 {
                progress.check()?;
            }
            let entries = &self.entries[first..first + count];
            row.extend(entries.iter().map(|e| Entry { column: places[e.column as usize], value: e.value }));
            prediction.push_row(&mut row);
            first += count;
        }
        let prediction = prediction.finish(n_coarse);
        let supports = prediction.clone();
        Ok(StepRule { n_coarse, prediction, supports, even: None })
    }
}

/// Triangle mesh from which vertices are removed.
struct DynamicMesh<'a> {
    points: &'a [[f64; 3]],
    triangles: Vec<[u32; 3]>,
    /// Triangles at each vertex; some may be removed.
    faces_at: Vec<Vec<u32>>,
    is_gone: Vec<bool>,
    is_removed: Vec<bool>,
}

/// Neighbors of a vertex in their order around it, closed or from border to border.
struct Fan {
    ring: Vec<u32>,
    is_closed: bool,
}

/// Ring in the plane around a vertex at the origin.
struct FlatRing {
    points: Vec<[f64; 2]>,
    radii: Vec<f64>,
    angles: Vec<f64>,
}

impl<'a> DynamicMesh<'a> {
    /// Creates the mesh of the triangles with three different corners.
    fn new(
        points: &'a [[f64; 3]],
        triangles: &[[u32; 3]],
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let mut faces_at = vec![Vec::new(); points.len()];
        let proper: Vec<[u32; 3]> =
            triangles.iter().copied().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).collect();
        for (f, t) in (0_u32..).zip(&proper) {
            if (f as usize).is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            for &v in t {
                faces_at[v as usize].push(f);
            }
        }
        let (is_gone, is_removed) = (vec![false; proper.len()], vec![false; points.len()]);
        Ok(Self { points, triangles: proper, faces_at, is_gone, is_removed })
    }

    /// Removes vertices without a common edge, those of small areas first, and distributes their areas to their
    /// neighbors.
    fn thin(&mut self, left: &[u32], areas: &mut [f64], progress: Progress<'_>) -> Result<Round, Cancelled> {
        let mut candidates = left.to_vec();
        candidates
            .par_sort_unstable_by(|&a, &b| areas[a as usize].total_cmp(&areas[b as usize]).then(a.cmp(&b)));
        let mut is_kept = vec![false; self.points.len()];
        let mut round = Round { removed: Vec::new(), counts: Vec::new(), entries: Vec::new() };
        for (k, &v) in candidates.iter().enumerate() {
            if k % AT_A_TIME == 0 {
                progress.check()?;
            }
            if is_kept[v as usize] {
                continue;
            }
            let Some(fan) = self.fan(v) else { continue };
            let Some(weights) = self.remove(v, &fan) else { continue };
            for entry in &weights {
                is_kept[entry.column as usize] = true;
                areas[entry.column as usize] += areas[v as usize] * entry.value;
            }
            fan.ring.iter().for_each(|&w| is_kept[w as usize] = true);
            round.removed.push(v);
            round.counts.push(weights.len());
            round.entries.extend(weights);
        }
        Ok(round)
    }

    /// Returns the ring of a vertex; `None` unless its faces form one fan of at most [`MAX_NEIGHBORS`] faces.
    fn fan(&mut self, v: u32) -> Option<Fan> {
        let (is_gone, triangles) = (&self.is_gone, &self.triangles);
        let faces = &mut self.faces_at[v as usize];
        faces.retain(|&f| !is_gone[f as usize] && triangles[f as usize].contains(&v));
        if faces.is_empty() || faces.len() > MAX_NEIGHBORS {
            return None;
        }
        let mut sides: Vec<[u32; 2]> = faces
            .iter()
            .map(|&f| {
                let t = triangles[f as usize];
                let k = t.iter().position(|&c| c == v).unwrap_or(0);
                [t[(k + 1) % 3], t[(k + 2) % 3]]
            })
            .collect();
        // The walk begins at a neighbor of one face, if there is one.
        let n_faces_of = |w: u32| sides.iter().flatten().filter(|&&x| x == w).count();
        let neighbors: Vec<u32> = sides.iter().flatten().copied().collect();
        if neighbors.iter().any(|&w| n_faces_of(w) > 2) {
            return None;
        }
        let end = neighbors.iter().copied().filter(|&w| n_faces_of(w) == 1).min();
        let first = end.unwrap_or_else(|| neighbors.iter().copied().min().unwrap_or(v));
        let mut ring = vec![first];
        let mut at = first;
        while let Some(k) = sides.iter().position(|side| side.contains(&at)) {
            let side = sides.swap_remove(k);
            at = if side[0] == at { side[1] } else { side[0] };
            if at == first {
                break;
            }
            ring.push(at);
        }
        let is_closed = end.is_none();
        (sides.is_empty() && ring.len() >= if is_closed { 3 } else { 2 }).then_some(Fan { ring, is_closed })
    }

    /// Removes a vertex and returns the weights of its neighbors; `None` if no merge keeps the surface.
    fn remove(&mut self, v: u32, fan: &Fan) -> Option<Vec<Entry>> {
        let (target, weights) = if fan.is_closed {
            let flat = self.flatten(v, fan)?;
            let target = self.best_target(fan, &flat)?;
            (target, flat.mean_values(&fan.ring))
        } else {
            let ends = [0, fan.ring.len() - 1];
            let lengths = ends.map(|k| self.length(v, fan.ring[k]));
            let total = lengths[0] + lengths[1];
            let share = if total > 0.0 { lengths[1] / total } else { 0.5 };
            let weight = |k: usize, value: f64| Entry { column: fan.ring[ends[k]], value };
            let nearer = usize::from(lengths[1] < lengths[0]);
            let target =
                [nearer, 1 - nearer].map(|k| ends[k]).into_iter().find(|&k| self.may_merge(fan, k))?;
            (target, vec![weight(0, share), weight(1, 1.0 - share)])
        };
        self.merge(v, fan.ring[target]);
        Some(weights)
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        let (p, q) = (self.points[a as usize], self.points[b as usize]);
        let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        x.hypot(y).hypot(z)
    }

    /// Lays the ring out in the plane, with its lengths, and with its angles scaled to a full turn.
    fn flatten(&self, v: u32, fan: &Fan) -> Option<FlatRing> {
        let n = fan.ring.len();
        let radii: Vec<f64> = fan.ring.iter().map(|&w| self.length(v, w)).collect();
        let greatest = radii.iter().copied().fold(0.0, f64::max);
        if greatest == 0.0 || radii.iter().any(|r| *r < 1e-9 * greatest) {
            return None;
        }
        let mut angles: Vec<f64> = (0..n)
            .map(|k| {
                let next = (k + 1) % n;
                let (a, b) = (radii[k] / greatest, radii[next] / greatest);
                let c = self.length(fan.ring[k], fan.ring[next]) / greatest;
                ((a * a + b * b - c * c) / (2.0 * a * b)).clamp(-1.0, 1.0).acos().max(1e-6)
            })
            .collect();
        let scale = TAU / angles.iter().sum::<f64>();
        for angle in &mut angles {
            *angle *= scale;
        }
        if angles.iter().any(|&angle| angle > MAX_ANGLE) {
            return None;
        }
        let mut direction = 0.0_f64;
        let points = radii
            .iter()
            .zip(&angles)
            .map(|(r, angle)| {
                let point = [r / greatest * direction.cos(), r / greatest * direction.sin()];
                direction += angle;
                point
            })
            .collect();
        Some(FlatRing { points, radii, angles })
    }

    /// Finds the neighbor whose triangles with the rest of the ring have the largest minimum of the quality in the
    /// plane.
    fn best_target(&self, fan: &Fan, flat: &FlatRing) -> Option<usize> {
        let mut candidates: Vec<(f64, usize)> = (0..fan.ring.len())
            .map(|target| (flat.least_quality(target), target))
            .filter(|(quality, _)| *quality > LEAST_QUALITY)
            .collect();
        candidates.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        candidates.into_iter().map(|(_, target)| target).find(|&target| self.may_merge(fan, target))
    }

    /// True if the merge with a neighbor keeps the surface: both have no common neighbors other than those of their
    /// common faces (`dey1999`), and no triangle appears twice.
    fn may_merge(&self, fan: &Fan, target: usize) -> bool {
        let (u, n) = (fan.ring[target], fan.ring.len());
        if self.faces_at[u as usize].len() > MAX_TARGET_FACES {
            return false;
        }
        let is_beside = |k: usize| {
            let distance = k.abs_diff(target);
            distance == 1 || (fan.is_closed && distance == n - 1)
        };
        let at_target = || self.faces_at[u as usize].iter().filter(|&&f| !self.is_gone[f as usize]);
        let triangles = || at_target().map(|&f| self.triangles[f as usize]).filter(|t| t.contains(&u));
        let is_neighbor = |w: u32| triangles().any(|t| t.contains(&w));
        let strange = (0..n).any(|k| k != target && !is_beside(k) && is_neighbor(fan.ring[k]));
        if strange {
            return false;
        }
        if fan.is_closed && n == 3 {
            // The one new triangle must not exist: the other side of a tetrahedron.
            return !triangles().any(|t| fan.ring.iter().all(|w| t.contains(w)));
        }
        // A single triangle at a border needs another one beyond its third side.
        fan.is_closed || n > 2 || triangles().filter(|t| fan.ring.iter().all(|w| t.contains(w))).count() == 2
    }

    fn merge(&mut self, v: u32, u: u32) {
        self.is_removed[v as usize] = true;
        for f in std::mem::take(&mut self.faces_at[v as usize]) {
            let t = &mut self.triangles[f as usize];
            if t.contains(&u) {
                self.is_gone[f as usize] = true;
            } else {
                t.iter_mut().filter(|c| **c == v).for_each(|c| *c = u);
                self.faces_at[u as usize].push(f);
            }
        }
        let is_gone = &self.is_gone;
        self.faces_at[u as usize].retain(|&f| !is_gone[f as usize]);
    }
}

impl FlatRing {
    /// Least quality of the triangles that remain after a merge with neighbor `target`; 0 if a triangle is turned over.
    fn least_quality(&self, target: usize) -> f64 {
        let n = self.points.len();
        let p = self.points[target];
        let mut least = 1.0_f64;
        for step in 1..n - 1 {
            let (q, r) = (self.points[(target + step) % n], self.points[(target + step + 1) % n]);
            let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
            let c = [r[0] - q[0], r[1] - q[1]];
            let squares: f64 = [a, b, c].iter().map(|s| s[0] * s[0] + s[1] * s[1]).sum();
            let area = 0.5 * (a[0] * b[1] - a[1] * b[0]);
            least = least.min(4.0 * 3.0_f64.sqrt() * area / squares);
        }
        least.max(0.0)
    }

    /// Mean value weights of the ring, which sum to 1.
    fn mean_values(&self, ring: &[u32]) -> Vec<Entry> {
        let n = ring.len();
        let half_tangent = |k: usize| (0.5 * self.angles[k % n]).tan();
        let weights: Vec<f64> =
            (0..n).map(|k| (half_tangent(k + n - 1) + half_tangent(k)) / self.radii[k]).collect();
        let total: f64 = weights.iter().sum();
        ring.iter().zip(weights).map(|(&column, w)| Entry { column, value: w / total }).collect()
    }
}
