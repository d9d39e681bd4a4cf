//! One step to a coarser level of a mesh of quadrilaterals: coarse vertices, edge points, face points, coarse faces.
//!
//! Subdivision cuts a face of n corners into n quadrilaterals around a new point in its middle, each with the corners
//! coarse vertex, edge point, face point, edge point. So the roles of the corners of one face give those of all faces
//! of its part, in O(n) and in four ways at most: each corner of the first face may be the coarse vertex. An edge point
//! has four neighbors, on a border three; a face point lies inside and has as many neighbors as its face has corners.

use crate::Obstacle;
use crate::coarsening::Coarsening;
use crate::topology::{NONE, Topology};
use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

/// Number of faces between two checks for cancellation.
const AT_A_TIME: usize = 1 << 12;

/// Number of ways to begin with a face: each of its corners as the coarse vertex.
pub(crate) const N_CHOICES: usize = 4;

/// Role of a vertex in the step to the coarser level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Unknown,
    Coarse,
    Edge,
    Face,
}

impl Role {
    /// Role of the corner opposite a corner of this role.
    fn opposite(self) -> Self {
        match self {
            Self::Coarse => Self::Face,
            Self::Face => Self::Coarse,
            other => other,
        }
    }
}

/// Roles of the vertices of one level.
pub(crate) struct RoleSearch<'a> {
    topology: &'a Topology,
    roles: Vec<Role>,
    is_reached: Vec<bool>,
    queue: Vec<u32>,
    reached: Vec<u32>,
    progress: Progress<'a>,
}

impl<'a> RoleSearch<'a> {
    pub(crate) fn new(topology: &'a Topology, progress: Progress<'a>) -> Self {
        Self {
            topology,
            roles: vec![Role::Unknown; topology.n_vertices],
            is_reached: vec![false; topology.n_faces()],
            queue: Vec::new(),
            reached: Vec::new(),
            progress,
        }
    }

    /// Spreads the roles from corner `choice` of a face over its part; undoes all changes if they do not fit.
    pub(crate) fn flood(&mut self, face: u32, choice: usize) -> Result<Option<Obstacle>, Cancelled> {
        self.queue.clear();
        self.reached.clear();
        let found = match self.spread(face, choice)? {
            None => self.check_vertices(),
            found => found,
        };
        if found.is_some() {
            for &f in &self.reached {
                self.is_reached[f as usize] = false;
                for &v in self.topology.faces.get(f as usize) {
                    self.roles[v as usize] = Role::Unknown;
                }
            }
        }
        Ok(found)
    }

    fn spread(&mut self, face: u32, choice: usize) -> Result<Option<Obstacle>, Cancelled> {
        let topology = self.topology;
        self.reach(face);
        let corners = topology.faces.get(face as usize);
        if corners.len() != 4 {
            return Ok(Some(Obstacle::NotQuad { vertex: corners[0], n_corners: corners.len() }));
        }
        for (k, role) in [Role::Coarse, Role::Edge, Role::Face, Role::Edge].into_iter().enumerate() {
            self.roles[corners[(choice + k) % 4] as usize] = role;
        }
        let mut n_done = 0;
        while let Some(f) = self.queue.pop() {
            n_done += 1;
            if n_done % AT_A_TIME == 0 {
                self.progress.check()?;
            }
            let first = topology.first(f);
            for h in first..first + 4 {
                let twin = topology.twins[h as usize];
                if twin == NONE || self.is_reached[topology.face(twin) as usize] {
                    continue;
                }
                let neighbor = topology.face(twin);
                let corners = topology.faces.get(neighbor as usize);
                self.reach(neighbor);
                if corners.len() != 4 {
                    return Ok(Some(Obstacle::NotQuad { vertex: corners[0], n_corners: corners.len() }));
                }
                let k = (twin - topology.first(neighbor)) as usize;
                for (known, other) in [(k, (k + 2) % 4), ((k + 1) % 4, (k + 3) % 4)] {
                    let role = self.roles[corners[known] as usize].opposite();
                    let slot = &mut self.roles[corners[other] as usize];
                    if *slot != Role::Unknown && *slot != role {
                        return Ok(Some(Obstacle::Parity { vertex: corners[other] }));
                    }
                    *slot = role;
                }
            }
        }
        Ok(None)
    }

    fn reach(&mut self, face: u32) {
        self.is_reached[face as usize] = true;
        self.queue.push(face);
        self.reached.push(face);
    }

    /// Checks the neighbors of the edge points and face points that were reached.
    fn check_vertices(&self) -> Option<Obstacle> {
        let topology = self.topology;
        for &f in &self.reached {
            for &vertex in topology.faces.get(f as usize) {
                let (n_neighbors, is_border) = (topology.n_neighbors(vertex), topology.is_border(vertex));
                match self.roles[vertex as usize] {
                    Role::Edge if n_neighbors != if is_border { 3 } else { 4 } => {
                        return Some(Obstacle::EdgePoint { vertex, n_neighbors });
                    }
                    Role::Face if is_border => return Some(Obstacle::FacePoint { vertex }),
                    Role::Face if n_neighbors < 3 => return Some(Obstacle::Degenerate { vertex }),
                    _ => {}
                }
            }
        }
        None
    }

    /// Builds the coarse mesh. Vertices and faces that no search has reached remain. A vertex whose faces form several
    /// fans is an error.
    pub(crate) fn finish(self) -> Result<Coarsening, Obstacle> {
        let topology = self.topology;
        let with_role = |wanted: Role| -> Vec<u32> {
            (0..topology.n_vertices as u32).filter(|&v| self.roles[v as usize] == wanted).collect()
        };
        let is_odd = |v: u32| matches!(self.roles[v as usize], Role::Edge | Role::Face);
        let (midpoints, n_faces) = (with_role(Role::Edge), topology.n_faces());
        let mut parents_of = vec![[NONE; 2]; topology.n_vertices];
        let mut found = Coarsening {
            coarse: (0..topology.n_vertices as u32).filter(|&v| !is_odd(v)).collect(),
            midpoints: Vec::new(),
            parents: Vec::new(),
            faces: Polygons::with_capacity(n_faces / 4, n_faces),
            midpoint_of: Vec::with_capacity(n_faces),
            face_points: Vec::with_capacity(n_faces / 4),
            sharp: Vec::new(),
            children: Vec::new(),
        };
        let (mut is_built, mut corners) = (vec![false; topology.n_vertices], Vec::new());
        for f in 0..n_faces as u32 {
            let first = topology.first(f);
            if !self.is_reached[f as usize] {
                let own = topology.faces.get(f as usize);
                found.faces.push(own);
                found.midpoint_of.extend(own.iter().map(|_| NONE));
                found.face_points.push(NONE);
                found.sharp.extend((first..).take(own.len()).map(|h| topology.is_crease(h)));
                continue;
            }
            let at = (first..first + 4).find(|&h| self.roles[topology.origin(h) as usize] == Role::Face);
            let Some(start) = at else { continue };
            let center = topology.origin(start);
            if std::mem::replace(&mut is_built[center as usize], true) {
                continue;
            }
            self.push_corners(start, &mut corners)?;
            for (k, corner) in corners.iter().enumerate() {
                let next = &corners[(k + 1) % corners.len()];
                parents_of[corner.midpoint as usize] = [corner.vertex, next.vertex];
                found.midpoint_of.push(corner.midpoint);
                found.sharp.push(topology.is_crease(corner.out) && topology.is_crease(next.back));
            }
            found.faces.push(&corners.iter().map(|corner| corner.vertex).collect::<Vec<u32>>());
            found.face_points.push(center);
        }
        if topology.sharp.is_empty() {
            found.sharp.clear();
        }
        found.parents = midpoints.iter().map(|&w| parents_of[w as usize]).collect();
        found.midpoints = midpoints;
        Ok(found)
    }

    /// Replaces `corners` by the corners of the coarse face around a face point, from which half-edge `start` runs.
    fn push_corners(&self, start: u32, corners: &mut Vec<CoarseCorner>) -> Result<(), Obstacle> {
        let topology = self.topology;
        let center = topology.origin(start);
        corners.clear();
        let mut h = start;
        for _ in 0..topology.n_faces_at[center as usize] {
            let (next, previous) = (topology.next(h), topology.previous(h));
            let spoke = topology.turn(h, center);
            // In this face: the face point, the edge point of h, the coarse vertex, the edge point of the spoke.
            let corner = if topology.origin(h) == center {
                let out = topology.next(next);
                CoarseCorner { vertex: topology.origin(out), midpoint: spoke.neighbor, back: next, out }
            } else {
                let out = topology.previous(previous);
                CoarseCorner {
                    vertex: topology.origin(previous),
                    midpoint: spoke.neighbor,
                    back: previous,
                    out,
                }
            };
            corners.push(corner);
            h = topology.twins[spoke.half_edge as usize];
            if h == start {
                break;
            }
        }
        if h != start || corners.len() != topology.n_faces_at[center as usize] as usize {
            return Err(Obstacle::Pinched { vertex: center });
        }
        Ok(())
    }
}

/// Corner of a coarse face.
struct CoarseCorner {
    vertex: u32,
    /// Midpoint of the edge to the next corner.
    midpoint: u32,
    /// Half of the edge to the previous corner, and of the edge to the next corner.
    back: u32,
    out: u32,
}
