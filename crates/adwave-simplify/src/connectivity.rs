//! Triangles around vertices, and collapses that keep the topology.

use crate::geometry::{Point, dot, doubled_normal, length, minus};
use crate::quadric::Quadric;
use crate::wedges::Wedges;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Marker of a removed face.
pub(crate) const REMOVED: u32 = u32::MAX;

/// Smallest cosine of the angle by which a collapse may turn a face, for [`Turning::Limited`].
const MIN_COSINE: f64 = 0.25;

/// Smallest doubled area of a moved face, relative to its squared longest side.
const MIN_RELATIVE_AREA: f64 = 1e-8;

/// Largest number of faces around a vertex that a collapse may remove.
const MAX_FACES: usize = 256;

/// Number of faces that the list of a vertex has room for beyond the initial ones.
const SPARE_FACES: usize = 4;

/// Number of faces around a vertex up to which a list is searched directly.
const FEW_FACES: usize = 32;

/// Number of faces or positions between two looks at whether the work is cancelled.
const AT_A_TIME: usize = 1 << 14;

/// Limit of the angle by which a collapse may turn faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turning {
    /// No face turns by more than 75°.
    Limited,
    /// Faces turn by any angle.
    Free,
}

/// Faces over wedges, and the faces around each position. A position is the common point of one or more wedges.
pub(crate) struct Connectivity {
    /// Wedges of each face, or `REMOVED`.
    pub(crate) faces: Vec<[u32; 3]>,
    /// Positions of each face that is not removed.
    at: Vec<[u32; 3]>,
    /// Faces around each position.
    pub(crate) around: Vec<Vec<u32>>,
    /// Position of each wedge.
    position: Vec<u32>,
    /// Coordinates of each position.
    points: Vec<Point>,
    kinds: Vec<VertexKind>,
    /// True if some positions lie at the rim.
    has_rim: bool,
    /// Face with the same corners in the opposite orientation for each face, or `REMOVED`; it is not among the faces
    /// around positions.
    back: Vec<u32>,
}

/// Freedom of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum VertexKind {
    /// May collapse along any edge.
    Smooth,
    /// Lies on a curve of border, seam or non-manifold edges, and may collapse along that curve.
    Curve,
    /// Lies at an end or a junction of such curves, and is kept.
    Fixed,
    /// Has faces outside the part of the mesh that is at hand: it is kept, and nothing collapses to it.
    Rim,
}

/// Collapse that keeps the topology: the faces that vanish, and those that move.
#[derive(Default)]
pub(crate) struct Collapse {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) vanishing: Vec<u32>,
    /// Wedges of the vanishing faces before the collapse.
    pub(crate) gone: Vec<[u32; 3]>,
    /// Moved faces, with their wedges after the collapse.
    pub(crate) moved: Vec<(u32, [u32; 3])>,
    /// Wedge at `to` that replaces each wedge at `from`.
    pub(crate) wedges: Vec<(u32, u32)>,
}

impl Connectivity {
    /// The connectivity of `faces` over wedges, some of which may be `REMOVED`. O(faces log faces).
    pub(crate) fn new(
        wedges: &Wedges,
        mut faces: Vec<[u32; 3]>,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let position = wedges.position.clone();
        let n = wedges.n_positions();
        let mut points = vec![[0.0; 3]; n];
        for (wedge, &p) in position.iter().enumerate() {
            points[p as usize] = wedges.points[wedge];
        }
        let mut back = vec![REMOVED; faces.len()];
        progress.check()?;
        for [front, other] in twins(&faces) {
            back[front as usize] = other;
            faces[other as usize] = [REMOVED; 3];
        }
        let place = |wedge: u32| if wedge == REMOVED { REMOVED } else { position[wedge as usize] };
        let at: Vec<[u32; 3]> = faces.par_iter().map(|face| face.map(place)).collect();
        progress.check()?;
        let left = || at.iter().enumerate().filter(|(_, face)| face[0] != REMOVED);
        let mut counts = vec![0_usize; n];
        for &x in left().flat_map(|(_, face)| face) {
            counts[x as usize] += 1;
        }
        let mut around: Vec<Vec<u32>> =
            counts.into_iter().map(|n| Vec::with_capacity(n + SPARE_FACES)).collect();
        progress.check()?;
        for (t, face) in left() {
            if t.is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            for &x in face {
                around[x as usize].push(t as u32);
            }
        }
        let (kinds, has_rim) = (Vec::new(), false);
        let mut connectivity = Self { faces, at, around, position, points, kinds, has_rim, back };
        let kind = |u: u32| {
            if (u as usize).is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            Ok(connectivity.classify(u))
        };
        connectivity.kinds = (0..n as u32).into_par_iter().map(kind).collect::<Result<_, Cancelled>>()?;
        Ok(connectivity)
    }

    pub(crate) fn n_positions(&self) -> usize {
        self.points.len()
    }

    pub(crate) fn position(&self, wedge: u32) -> u32 {
        self.position[wedge as usize]
    }

    pub(crate) fn point(&self, position: u32) -> Point {
        self.points[position as usize]
    }

    pub(crate) fn is_removed(&self, face: u32) -> bool {
        self.faces[face as usize][0] == REMOVED
    }

    pub(crate) fn corners(&self, wedges: [u32; 3]) -> [Point; 3] {
        wedges.map(|wedge| self.points[self.position[wedge as usize] as usize])
    }

    /// Returns the remaining faces, as wedges, and their indices.
    pub(crate) fn triangles(&self) -> (Vec<[u32; 3]>, Vec<u32>) {
        let left = (0..self.faces.len() as u32).filter(|&face| !self.is_removed(face));
        let sides = left.flat_map(|face| {
            let ([a, b, c], back) = (self.faces[face as usize], self.back[face as usize]);
            let other = (back != REMOVED).then_some(([a, c, b], back));
            std::iter::once(([a, b, c], face)).chain(other)
        });
        sides.unzip()
    }

    pub(crate) fn positions_of(&self, face: u32) -> [u32; 3] {
        self.at[face as usize]
    }

    /// Points of the corners of a face that is not removed.
    pub(crate) fn corners_of(&self, face: u32) -> [Point; 3] {
        self.at[face as usize].map(|x| self.points[x as usize])
    }

    /// Lists the positions that share a face with `u`, without repetitions.
    pub(crate) fn neighbors(&self, u: u32, found: &mut Vec<u32>) {
        found.clear();
        for &face in &self.around[u as usize] {
            for v in self.positions_of(face) {
                if v != u && !found.contains(&v) {
                    found.push(v);
                }
            }
        }
    }

    /// Returns the wedges at the two ends of an edge in a face.
    fn ends(&self, face: u32, u: u32, v: u32) -> Option<(u32, u32)> {
        let at = self.at[face as usize];
        let find = |x: u32| at.into_iter().position(|y| y == x);
        let (k, l) = (find(u)?, find(v)?);
        let wedges = self.faces[face as usize];
        Some((wedges[k], wedges[l]))
    }

    /// True if an edge is on a border or a seam, or has more than two faces.
    fn is_feature(&self, u: u32, v: u32) -> bool {
        let (u, v) =
            if self.around[u as usize].len() > self.around[v as usize].len() { (v, u) } else { (u, v) };
        let (mut n, mut first, mut is_seam) = (0, None, false);
        for &face in &self.around[u as usize] {
            if let Some(ends) = self.ends(face, u, v) {
                n += 1;
                is_seam |= *first.get_or_insert(ends) != ends;
            }
        }
        n != 2 || is_seam
    }

    fn classify(&self, u: u32) -> VertexKind {
        if self.around[u as usize].len() > MAX_FACES {
            return VertexKind::Fixed;
        }
        let mut neighbors = Vec::new();
        self.neighbors(u, &mut neighbors);
        match neighbors.iter().filter(|&&v| self.is_feature(u, v)).count() {
            0 => VertexKind::Smooth,
            2 => VertexKind::Curve,
            _ => VertexKind::Fixed,
        }
    }

    pub(crate) fn kind(&self, u: u32) -> VertexKind {
        self.kinds[u as usize]
    }

    /// Marks positions as having faces that are not at hand.
    pub(crate) fn set_rim(&mut self, positions: impl Iterator<Item = u32>) {
        for u in positions {
            self.kinds[u as usize] = VertexKind::Rim;
            self.has_rim = true;
        }
    }

    /// Fixes the vertices on borders, so that they are kept.
    pub(crate) fn fix_borders(&mut self) {
        let mut neighbors = Vec::new();
        for u in 0..self.n_positions() as u32 {
            if self.kind(u) != VertexKind::Curve {
                continue;
            }
            self.neighbors(u, &mut neighbors);
            let n_faces = |v: u32| {
                self.around[u as usize].iter().filter(|&&face| self.positions_of(face).contains(&v)).count()
            };
            if neighbors.iter().any(|&v| n_faces(v) == 1) {
                self.kinds[u as usize] = VertexKind::Fixed;
            }
        }
    }

    /// Lists the positions that `u` may collapse to.
    pub(crate) fn targets(&self, u: u32, found: &mut Vec<u32>) {
        found.clear();
        let n_faces = self.around[u as usize].len();
        let is_kept = matches!(self.kind(u), VertexKind::Fixed | VertexKind::Rim);
        if n_faces == 0 || n_faces > MAX_FACES || is_kept {
            return;
        }
        self.neighbors(u, found);
        if self.has_rim {
            found.retain(|&v| self.kind(v) != VertexKind::Rim);
        }
        if self.kind(u) == VertexKind::Curve {
            found.retain(|&v| self.is_feature(u, v));
        }
    }

    /// Sum of the quadrics of the planes around a position and of the constraint planes of its curves.
    pub(crate) fn quadric(&self, u: u32) -> Quadric {
        let mut sum = Quadric::default();
        for &face in &self.around[u as usize] {
            sum.add(&Quadric::triangle(self.corners_of(face)));
            if self.kind(u) == VertexKind::Smooth {
                continue;
            }
            let at = self.positions_of(face);
            for k in 0..3 {
                let (a, b, c) = (at[k], at[(k + 1) % 3], at[(k + 2) % 3]);
                if (a == u || b == u) && self.is_feature(a, b) {
                    sum.add(&Quadric::edge([a, b, c].map(|x| self.point(x))));
                }
            }
        }
        sum
    }

    /// Quadrics of all positions, multiplied by their importance.
    pub(crate) fn quadrics(
        &self,
        importance: Option<&[f64]>,
        progress: Progress<'_>,
    ) -> Result<Vec<Quadric>, Cancelled> {
        let quadric = |u: u32| {
            if (u as usize).is_multiple_of(AT_A_TIME) {
                progress.check()?;
            }
            let quadric = self.quadric(u);
            Ok(importance.map_or(quadric, |of| quadric.multiply(of[u as usize])))
        };
        (0..self.n_positions() as u32).into_par_iter().map(quadric).collect()
    }

    /// Plans the collapse of `u` to `v`; `false` if it would change the topology or a seam, or turn or flatten a face.
    pub(crate) fn plan(&self, u: u32, v: u32, turning: Turning, plan: &mut Collapse) -> bool {
        (plan.from, plan.to) = (u, v);
        plan.vanishing.clear();
        plan.gone.clear();
        plan.moved.clear();
        plan.wedges.clear();
        for &face in &self.around[u as usize] {
            let Some(ends) = self.ends(face, u, v) else { continue };
            plan.vanishing.push(face);
            plan.gone.push(self.faces[face as usize]);
            match plan.wedges.iter().find(|(from, _)| *from == ends.0) {
                Some(&(_, to)) if to != ends.1 => return false,
                Some(_) => {}
                None => plan.wedges.push(ends),
            }
        }
        if plan.vanishing.is_empty() || !self.keeps_topology(plan) {
            return false;
        }
        for &face in &self.around[u as usize] {
            if plan.vanishing.contains(&face) {
                continue;
            }
            let (mut wedges, at) = (self.faces[face as usize], self.at[face as usize]);
            for (wedge, x) in wedges.iter_mut().zip(at) {
                if x == u {
                    match plan.wedges.iter().find(|(from, _)| from == wedge) {
                        Some(&(_, to)) => *wedge = to,
                        None => return false,
                    }
                }
            }
            if !self.keeps_direction(at, [u, v], turning) {
                return false;
            }
            plan.moved.push((face, wedges));
        }
        let n_left = plan.moved.len() + self.around[v as usize].len() - plan.vanishing.len();
        n_left > 0
    }

    /// True if a collapse meets the link condition (`dey1999`), counted on all faces: a position next to both ends is
    /// opposite to the edge in a face that vanishes, no two faces become one, and no curve closes.
    fn keeps_topology(&self, plan: &Collapse) -> bool {
        let (u, v) = (plan.from, plan.to);
        let opposite = |face: u32| self.positions_of(face).into_iter().find(|&x| x != u && x != v);
        let is_opposite = |x: u32| plan.vanishing.iter().any(|&face| opposite(face) == Some(x));
        let are_neighbors = |x: u32| {
            let (few, other) = if self.around[v as usize].len() <= FEW_FACES { (v, x) } else { (x, v) };
            self.around[few as usize].iter().any(|&face| self.positions_of(face).contains(&other))
        };
        for &face in &self.around[u as usize] {
            if plan.vanishing.contains(&face) {
                continue;
            }
            let at = self.positions_of(face);
            let others = at.into_iter().filter(|&x| x != u);
            let mut n_opposite = 0;
            for x in others {
                if is_opposite(x) {
                    n_opposite += 1;
                } else if are_neighbors(x) {
                    return false;
                }
            }
            let is_same = |other: &u32| {
                let other = self.positions_of(*other);
                other.contains(&v) && at.iter().all(|x| *x == u || other.contains(x))
            };
            if n_opposite == 2 {
                let x = at.into_iter().find(|&x| x != u).unwrap_or(v);
                if self.around[x as usize].iter().any(is_same) {
                    return false;
                }
            }
        }
        if self.kind(u) == VertexKind::Smooth {
            return true;
        }
        let closes = |x: u32| self.is_feature(u, x) && self.is_feature(v, x);
        !plan.vanishing.iter().filter_map(|&face| opposite(face)).any(closes)
    }

    /// True if a face keeps its direction and has an area after the position `u` moves to `v`.
    fn keeps_direction(&self, at: [u32; 3], [u, v]: [u32; 2], turning: Turning) -> bool {
        let old = at.map(|x| self.points[x as usize]);
        let new = at.map(|x| self.points[if x == u { v } else { x } as usize]);
        let (before, after) = (doubled_normal(old), doubled_normal(new));
        let sides = [0, 1, 2].map(|k| minus(new[(k + 1) % 3], new[k]));
        let longest = sides.map(|side| dot(side, side)).into_iter().fold(0.0, f64::max);
        let area = length(after);
        let is_wide = area > MIN_RELATIVE_AREA * longest;
        is_wide && (turning == Turning::Free || dot(before, after) > MIN_COSINE * length(before) * area)
    }

    /// Carries out a planned collapse.
    pub(crate) fn apply(&mut self, plan: &Collapse) {
        let (u, v) = (plan.from as usize, plan.to as usize);
        for &face in &plan.vanishing {
            for x in self.positions_of(face) {
                if x as usize != u {
                    self.around[x as usize].retain(|&other| other != face);
                }
            }
            self.faces[face as usize] = [REMOVED; 3];
        }
        for &(face, wedges) in &plan.moved {
            self.faces[face as usize] = wedges;
            self.at[face as usize] = wedges.map(|wedge| self.position[wedge as usize]);
            self.around[v].push(face);
        }
        self.around[u] = Vec::new();
    }
}

/// Lists pairs of faces with equal wedges and opposite orientations, the smaller index first. O(faces log faces).
fn twins(faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sorted = |(t, &face): (usize, &[u32; 3])| {
        let mut face = face;
        face.sort_unstable();
        (face, t as u32)
    };
    let left = faces.par_iter().enumerate().filter(|(_, face)| face[0] != REMOVED);
    let mut keyed: Vec<([u32; 3], u32)> = left.map(sorted).collect();
    keyed.par_sort_unstable();
    keyed.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]).collect()
}
