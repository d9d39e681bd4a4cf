//! Proof, maintained during collapses, that every point of the original is within a limit of the simplified surface.
//!
//! Each triangle t of the original keeps a list of faces, its cover: every point of t is within the limit of one of
//! them. A collapse changes the faces around one vertex. The triangles whose covers contain such a face need a new
//! cover; otherwise the collapse is refused. Hence the bound holds after every collapse, and errors do not add up. A
//! cover of one face is proven by three distances, because the distance to a triangle is convex (`proof`).
//!
//! Covers consist of faces of the same chart (part between seams), so that the limit holds for each material and for
//! the position of seams. For the opposite direction, new faces are compared with the whole original.

use crate::colors::WedgeColors;
use crate::connectivity::{Collapse, Connectivity};
use crate::geometry::{Point, nearest_weights, squared_distance};
use crate::proof::{Goal, bound_distance};
use crate::surface::{TriangleList, TriangleSearch, TriangleSurface};

/// Largest number of pieces into which a triangle is divided to find a cover.
const MAX_COVER_PIECES: usize = 96;

/// Largest number of pieces of a new face in the comparison with the original, plus 64 for each triangle with a new
/// cover.
const MIN_FACE_PIECES: usize = 256;

/// Original surface or a part of it, and the attributes that the proof covers.
pub(crate) struct Original<'a> {
    pub(crate) points: &'a [Point],
    /// Triangles over the points.
    pub(crate) triangles: &'a [[u32; 3]],
    /// Index of each triangle in the whole original, if the triangles are a part of it.
    pub(crate) names: Option<&'a [u32]>,
    /// Chart of each triangle, and of each face.
    pub(crate) charts: &'a [u32],
    pub(crate) face_charts: &'a [u32],
    /// The whole original.
    pub(crate) surface: &'a TriangleSurface,
    pub(crate) colors: Option<&'a WedgeColors>,
}

/// Covers of all triangles of the original by faces.
pub(crate) struct Certificates<'a> {
    original: Original<'a>,
    limit: f64,
    squared_limit: f64,
    /// Cover of each triangle of the original.
    cover: Vec<Cover>,
    /// Triangles of the original whose covers contain each face.
    covered: Vec<Vec<u32>>,
    /// Number of the last test in which the cover of each triangle was sought.
    seen: Vec<u32>,
    in_star: Vec<u32>,
    test: u32,
    new_covers: NewCovers,
    new_faces: TriangleList,
    /// Bounding boxes of the new faces, enlarged by the limit.
    boxes: Vec<[Point; 2]>,
    /// New faces within the limit of each wedge of the original.
    near_faces: Vec<NearFaces>,
    other_faces: TriangleList,
    /// Triangle that had no cover when the collapse of each position was last tried, or `NONE`.
    witnesses: Vec<u32>,
}

/// New faces within the limit of a point.
#[derive(Clone, Copy, Default)]
struct NearFaces {
    /// Number of the test in which the faces were found.
    test: u32,
    /// One bit for each of the first 64 faces.
    faces: u64,
}

/// Number of new faces up to which a triangle is compared with each as a whole.
const MAX_NEW_FACES: usize = 64;

/// Marker of a position whose collapse was never refused for a missing cover.
const NONE: u32 = u32::MAX;

/// Faces that cover a triangle, usually one.
#[derive(Clone)]
pub(crate) struct Cover {
    first: u32,
    others: Vec<u32>,
}

impl Cover {
    /// A cover by one face.
    pub(crate) fn single(face: u32) -> Self {
        Self { first: face, others: Vec::new() }
    }

    /// Gives the faces other numbers.
    pub(crate) fn renumbered(mut self, numbers: &[u32]) -> Self {
        self.first = numbers[self.first as usize];
        self.others.iter_mut().for_each(|face| *face = numbers[*face as usize]);
        self
    }

    pub(crate) fn faces(&self) -> impl Iterator<Item = u32> + '_ {
        std::iter::once(self.first).chain(self.others.iter().copied())
    }
}

/// Covers that replace the present ones if a collapse is carried out.
#[derive(Default)]
struct NewCovers {
    /// Triangle, and the end of its faces in `faces`.
    triangles: Vec<(u32, usize)>,
    faces: Vec<u32>,
}

impl<'a> Certificates<'a> {
    /// Starts with the covers of all triangles of the original.
    pub(crate) fn new(original: Original<'a>, limit: f64, cover: Vec<Cover>) -> Self {
        let (n, n_faces) = (original.triangles.len(), original.face_charts.len());
        let mut covered = vec![Vec::new(); n_faces];
        for (t, cover) in (0..).zip(&cover) {
            for face in cover.faces() {
                covered[face as usize].push(t);
            }
        }
        Self {
            limit,
            squared_limit: limit * limit,
            cover,
            covered,
            seen: vec![0; n],
            in_star: vec![0; n_faces],
            test: 0,
            new_covers: NewCovers::default(),
            new_faces: TriangleList::default(),
            boxes: Vec::new(),
            near_faces: vec![NearFaces::default(); original.points.len()],
            other_faces: TriangleList::default(),
            witnesses: vec![NONE; original.points.len()],
            original,
        }
    }

    /// Finds new covers for all triangles that a planned collapse affects; `false` if a triangle has none, or if a new
    /// face is too far from the original.
    pub(crate) fn allows(&mut self, connectivity: &Connectivity, plan: &Collapse) -> bool {
        self.test += 1;
        self.list_new_faces(connectivity, plan);
        if self.new_faces.nearest(connectivity.point(plan.from)).0 > self.squared_limit {
            return false;
        }
        self.new_covers.triangles.clear();
        self.new_covers.faces.clear();
        let witness = self.witnesses[plan.from as usize];
        if witness != NONE && self.is_affected(witness) && !self.cover_again(witness, connectivity) {
            return false;
        }
        let star = plan.moved.iter().map(|(face, _)| face).chain(&plan.vanishing);
        for &face in star {
            for k in 0..self.covered[face as usize].len() {
                let t = self.covered[face as usize][k];
                if self.seen[t as usize] != self.test && !self.cover_again(t, connectivity) {
                    self.witnesses[plan.from as usize] = t;
                    return false;
                }
            }
        }
        self.are_near_original(plan.moved.len())
    }

    /// True if the collapse changes a face that covers the triangle.
    fn is_affected(&self, t: u32) -> bool {
        self.cover[t as usize].faces().any(|face| self.in_star[face as usize] == self.test)
    }

    /// Adds a new cover of a triangle to the new covers; `false` if there is none.
    fn cover_again(&mut self, t: u32, connectivity: &Connectivity) -> bool {
        self.seen[t as usize] = self.test;
        let is_covered = self.find_cover(t, connectivity);
        if is_covered {
            self.new_covers.triangles.push((t, self.new_covers.faces.len()));
        }
        is_covered
    }

    /// Lists the moved faces, and then the other faces around the target.
    fn list_new_faces(&mut self, connectivity: &Connectivity, plan: &Collapse) {
        self.new_faces.clear();
        for &(face, wedges) in &plan.moved {
            self.in_star[face as usize] = self.test;
            self.new_faces.push(face, wedges, connectivity.corners(wedges));
        }
        for &face in &plan.vanishing {
            self.in_star[face as usize] = self.test;
        }
        for &face in &connectivity.around[plan.to as usize] {
            if self.in_star[face as usize] != self.test {
                let wedges = connectivity.faces[face as usize];
                self.new_faces.push(face, wedges, connectivity.corners_of(face));
            }
        }
        let bounds = |corners: &[Point; 3]| {
            let fold =
                |c: usize, pick: fn(f64, f64) -> f64| pick(pick(corners[0][c], corners[1][c]), corners[2][c]);
            [
                std::array::from_fn(|c| fold(c, f64::min) - self.limit),
                std::array::from_fn(|c| fold(c, f64::max) + self.limit),
            ]
        };
        self.boxes.clear();
        self.boxes.extend(self.new_faces.corners.iter().map(bounds));
    }

    /// Finds the new faces within the limit of a wedge of the original; bit k stands for face k.
    fn faces_near(&mut self, wedge: u32) -> u64 {
        let known = self.near_faces[wedge as usize];
        if known.test == self.test {
            return known.faces;
        }
        let p = self.original.points[wedge as usize];
        let mut faces = 0;
        let all = self.new_faces.corners.iter().zip(&self.boxes).take(MAX_NEW_FACES);
        for (k, (corners, [low, high])) in all.enumerate() {
            let is_inside = (0..3).all(|c| low[c] <= p[c] && p[c] <= high[c]);
            if is_inside && squared_distance(p, corners) <= self.squared_limit {
                faces |= 1 << k;
            }
        }
        self.near_faces[wedge as usize] = NearFaces { test: self.test, faces };
        faces
    }

    fn is_in_chart(&self, face: u32, t: u32) -> bool {
        self.original.face_charts[face as usize] == self.original.charts[t as usize]
    }

    /// Finds a cover of a triangle and appends its faces to the new covers; `false` if there is none.
    fn find_cover(&mut self, t: u32, connectivity: &Connectivity) -> bool {
        let near = self.original.triangles[t as usize].map(|wedge| self.faces_near(wedge));
        let has_few = self.new_faces.ids.len() <= MAX_NEW_FACES;
        if has_few && near.contains(&0) && self.cover[t as usize].others.is_empty() {
            return false;
        }
        if self.original.colors.is_none() {
            let first = self.cover[t as usize].first;
            let first = self.new_faces.ids.iter().position(|&face| face == first).unwrap_or(0);
            let mut common = near[0] & near[1] & near[2];
            while common != 0 {
                // The present cover comes first, then the faces after it.
                let rest = common.checked_shr(first as u32).unwrap_or(0);
                let k = if rest != 0 {
                    first + rest.trailing_zeros() as usize
                } else {
                    common.trailing_zeros() as usize
                };
                let face = self.new_faces.ids[k];
                if self.is_in_chart(face, t) {
                    self.new_covers.faces.push(face);
                    return true;
                }
                common &= !(1 << k);
            }
        }
        let corners = self.original.triangles[t as usize];
        let triangle = corners.map(|wedge| self.original.points[wedge as usize]);
        self.find_cover_by_pieces(t, &triangle, connectivity)
    }

    /// Finds a cover by several faces, by dividing the triangle, and appends these faces; `false` if there is none.
    fn find_cover_by_pieces(&mut self, t: u32, triangle: &[Point; 3], connectivity: &Connectivity) -> bool {
        let mut faces = std::mem::take(&mut self.other_faces);
        faces.clear();
        for face in self.cover[t as usize].faces() {
            if self.in_star[face as usize] != self.test {
                let wedges = connectivity.faces[face as usize];
                faces.push(face, wedges, connectivity.corners_of(face));
            }
        }
        for (k, &face) in self.new_faces.ids.iter().enumerate() {
            if self.is_in_chart(face, t) && !faces.ids.contains(&face) {
                faces.push(face, self.new_faces.wedges[k], self.new_faces.corners[k]);
            }
        }
        let start = self.new_covers.faces.len();
        let mut is_covered = false;
        if !faces.ids.is_empty() && self.keeps_colors(t, &faces) {
            let (used, ids) = (&mut self.new_covers.faces, &faces.ids);
            let mut use_face = |k: u32| {
                let face = ids[k as usize];
                if !used[start..].contains(&face) {
                    used.push(face);
                }
            };
            let goal = Goal::decision(self.limit, MAX_COVER_PIECES);
            let bounds = bound_distance(*triangle, &[], &faces, &goal, &mut use_face);
            is_covered = bounds.upper <= self.limit;
        }
        self.other_faces = faces;
        is_covered
    }

    /// True if the nearest faces keep the colors at the corners of a triangle.
    fn keeps_colors(&self, t: u32, faces: &TriangleList) -> bool {
        let Some(colors) = self.original.colors else { return true };
        self.original.triangles[t as usize].iter().all(|&wedge| {
            let p = self.original.points[wedge as usize];
            let near = faces.nearest(p).1;
            let weights = nearest_weights(p, faces.corners(near));
            colors.is_kept(wedge, faces.wedges[near as usize], weights, self.limit)
        })
    }

    /// True if every moved face is within the limit of the original.
    fn are_near_original(&self, n_moved: usize) -> bool {
        let max_pieces = MIN_FACE_PIECES + 64 * self.new_covers.triangles.len();
        let goal = Goal::decision(self.limit, max_pieces);
        let name = |t: u32| self.original.names.map_or(t, |names| names[t as usize]);
        let hints = self.new_covers.triangles.first().map(|&(t, _)| name(t));
        self.new_faces.corners[..n_moved].iter().all(|&corners| {
            let (surface, hints) = (self.original.surface, hints.as_slice());
            bound_distance(corners, hints, surface, &goal, &mut |_| {}).upper <= self.limit
        })
    }

    /// The covers of all triangles of the original.
    pub(crate) fn into_covers(self) -> Vec<Cover> {
        self.cover
    }

    /// Stores the covers found by the last test, whose collapse is carried out.
    pub(crate) fn commit(&mut self, plan: &Collapse) {
        for &face in plan.moved.iter().map(|(face, _)| face).chain(&plan.vanishing) {
            self.covered[face as usize].clear();
        }
        let mut start = 0;
        for &(t, end) in &self.new_covers.triangles {
            let new = &self.new_covers.faces[start..end];
            start = end;
            let cover = &mut self.cover[t as usize];
            for face in cover.faces() {
                if self.in_star[face as usize] != self.test && !new.contains(&face) {
                    self.covered[face as usize].retain(|&other| other != t);
                }
            }
            for &face in new {
                if self.in_star[face as usize] == self.test || !cover.faces().any(|other| other == face) {
                    self.covered[face as usize].push(t);
                }
            }
            if let Some((&first, others)) = new.split_first() {
                cover.first = first;
                cover.others.clear();
                cover.others.extend_from_slice(others);
            }
        }
    }
}
