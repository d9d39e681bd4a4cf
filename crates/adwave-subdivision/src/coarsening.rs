//! One step to a coarser level: coarse vertices, midpoints with their parents, and the coarse faces.
//!
//! Subdivision leaves marks. A midpoint of an edge inside the surface has six neighbors; two opposite ones are the ends
//! of its edge. A midpoint on a border has four neighbors; the two along the border are the ends. So any other vertex
//! is a coarse one, the neighbors of a coarse vertex are midpoints, and straight across a midpoint lies a coarse
//! vertex. From one coarse vertex these rules reach every vertex of its part in O(n), or contradict each other. If a
//! part has no irregular vertex, its first vertex and the neighbors of that vertex are tried in turn.

use crate::topology::{NONE, Topology, renamed};
use crate::{Obstacle, SubdivisionError};
use adwave::Progress;
use adwave::shape::Polygons;

/// Number of vertices between two checks for cancellation.
const AT_A_TIME: usize = 1 << 12;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Parity {
    Unknown,
    Coarse,
    Midpoint,
}

/// Step to a coarser level, in the numbering of the finer level.
pub(crate) struct Coarsening {
    /// Vertices that remain on the coarser level, increasing.
    pub(crate) coarse: Vec<u32>,
    /// Midpoints of edges, increasing.
    pub(crate) midpoints: Vec<u32>,
    /// Ends of the coarse edge of each midpoint, as vertices of the finer level.
    pub(crate) parents: Vec<[u32; 2]>,
    /// Coarse faces, with vertices of the finer level.
    pub(crate) faces: Polygons,
    /// Midpoint of each half-edge of the coarse faces, as a vertex of the finer level; [`NONE`] in a part without a
    /// coarser level.
    pub(crate) midpoint_of: Vec<u32>,
    /// Face point of each coarse face, or [`NONE`] in a part without a coarser level; empty for triangles.
    pub(crate) face_points: Vec<u32>,
    /// True for each half-edge of the coarse faces both halves of which are sharp; empty if there are none.
    pub(crate) sharp: Vec<bool>,
    /// Faces of the finer level in each coarse face: the central one, then those at its corners. An unchanged face has
    /// itself, then [`NONE`]. Empty for quadrilaterals.
    pub(crate) children: Vec<[u32; 4]>,
}

impl Coarsening {
    /// Index on the coarser level of each of `n_vertices` vertices of the finer level, or [`NONE`].
    pub(crate) fn ranks(&self, n_vertices: usize) -> Vec<u32> {
        let mut ranks = vec![NONE; n_vertices];
        for (k, &v) in (0..).zip(&self.coarse) {
            ranks[v as usize] = k;
        }
        ranks
    }

    /// Builds the topology of the coarse mesh.
    pub(crate) fn coarse_topology(
        &self,
        ranks: &[u32],
        progress: Progress<'_>,
    ) -> Result<Topology, SubdivisionError> {
        let faces = renamed(&self.faces, |v| ranks[v as usize]);
        let mut topology = Topology::new(self.coarse.len(), faces, progress)?;
        topology.sharp.clone_from(&self.sharp);
        Ok(topology)
    }
}

/// Search for the coarse vertices of one level.
pub(crate) struct ParitySearch<'a> {
    topology: &'a Topology,
    parity: Vec<Parity>,
    parents: Vec<[u32; 2]>,
    queue: Vec<u32>,
    reached: Vec<u32>,
    progress: Progress<'a>,
}

impl<'a> ParitySearch<'a> {
    pub(crate) fn new(topology: &'a Topology, progress: Progress<'a>) -> Self {
        let n = topology.n_vertices;
        let parity = vec![Parity::Unknown; n];
        Self {
            topology,
            parity,
            parents: vec![[NONE; 2]; n],
            queue: Vec::new(),
            reached: Vec::new(),
            progress,
        }
    }

    /// Finds the coarse vertices of the part of `first`, and returns the reason if there is no coarser level.
    /// `irregular` is a vertex of the part that cannot be a midpoint, if there is one.
    pub(crate) fn search_part(
        &mut self,
        first: u32,
        irregular: Option<u32>,
    ) -> Result<Option<Obstacle>, SubdivisionError> {
        if let Some(seed) = irregular {
            return self.flood(seed);
        }
        let mut seeds = vec![first];
        seeds.extend(self.topology.ring(first).map(|spoke| spoke.neighbor));
        let mut obstacle = None;
        for seed in seeds {
            match self.flood(seed)? {
                None => return Ok(None),
                Some(found) => obstacle = obstacle.or(Some(found)),
            }
        }
        Ok(obstacle)
    }

    /// Spreads the rules from one coarse vertex over its part; undoes all changes if they contradict each other.
    fn flood(&mut self, seed: u32) -> Result<Option<Obstacle>, SubdivisionError> {
        self.queue.clear();
        self.reached.clear();
        self.set(seed, Parity::Coarse);
        self.queue.push(seed);
        let mut n_done = 0;
        while let Some(v) = self.queue.pop() {
            n_done += 1;
            if n_done % AT_A_TIME == 0 {
                self.progress.check()?;
            }
            if let Err(obstacle) = self.visit_coarse(v) {
                for &w in &self.reached {
                    self.parity[w as usize] = Parity::Unknown;
                    self.parents[w as usize] = [NONE; 2];
                }
                return Ok(Some(obstacle));
            }
        }
        Ok(None)
    }

    fn set(&mut self, v: u32, parity: Parity) {
        self.parity[v as usize] = parity;
        self.reached.push(v);
    }

    /// Marks the neighbors of a coarse vertex as midpoints, and the vertices straight across them as coarse.
    fn visit_coarse(&mut self, v: u32) -> Result<(), Obstacle> {
        let topology = self.topology;
        let mut n_spokes = 0;
        for spoke in topology.ring(v) {
            n_spokes += 1;
            let (w, is_border) = (spoke.neighbor, topology.is_border(spoke.neighbor));
            let n_neighbors = topology.n_neighbors(w);
            if n_neighbors != if is_border { 4 } else { 6 } {
                return Err(Obstacle::Valence { vertex: w, n_neighbors });
            }
            if is_border != (topology.twins[spoke.half_edge as usize] == NONE) {
                return Err(Obstacle::Border { vertex: w });
            }
            match self.parity[w as usize] {
                Parity::Coarse => return Err(Obstacle::Parity { vertex: w }),
                Parity::Midpoint if !self.parents[w as usize].contains(&v) => {
                    return Err(Obstacle::Parity { vertex: w });
                }
                Parity::Midpoint => continue,
                Parity::Unknown => self.set(w, Parity::Midpoint),
            }
            let Some(across) = topology.opposite(spoke.half_edge, w) else {
                return Err(Obstacle::Border { vertex: w });
            };
            // Two fans of three faces lead back to the vertex.
            if across == v {
                return Err(Obstacle::Pinched { vertex: w });
            }
            self.parents[w as usize] = [v, across];
            match self.parity[across as usize] {
                Parity::Midpoint => return Err(Obstacle::Parity { vertex: across }),
                Parity::Coarse => {}
                Parity::Unknown => {
                    self.set(across, Parity::Coarse);
                    self.queue.push(across);
                }
            }
        }
        if n_spokes != topology.n_neighbors(v) {
            return Err(Obstacle::Pinched { vertex: v });
        }
        Ok(())
    }

    /// Builds the coarse mesh. Vertices that no search has reached remain.
    pub(crate) fn finish(self) -> Coarsening {
        let topology = self.topology;
        let is_midpoint = |v: u32| self.parity[v as usize] == Parity::Midpoint;
        let (midpoints, coarse): (Vec<u32>, Vec<u32>) =
            (0..topology.n_vertices as u32).partition(|&v| is_midpoint(v));
        let n_faces = topology.n_faces();
        let mut found = Coarsening {
            parents: midpoints.iter().map(|&w| self.parents[w as usize]).collect(),
            coarse,
            midpoints,
            faces: Polygons::with_capacity(n_faces / 4, 3 * (n_faces / 4)),
            midpoint_of: Vec::with_capacity(n_faces),
            face_points: Vec::new(),
            sharp: Vec::new(),
            children: Vec::with_capacity(n_faces / 4),
        };
        for (f, t) in topology.faces.iter().enumerate() {
            if t.iter().all(|&v| is_midpoint(v)) {
                // Beyond each edge of a central face lies the face at a corner.
                let twin = |k: usize| topology.twins[3 * f + k];
                let corners = [twin(2), twin(0), twin(1)];
                found.faces.push(&corners.map(|h| topology.apex(h)));
                found.midpoint_of.extend(t);
                let [a, b, c] = corners.map(|h| h / 3);
                found.children.push([f as u32, a, b, c]);
            } else if !t.iter().any(|&v| is_midpoint(v)) {
                found.faces.push(t);
                found.midpoint_of.extend([NONE; 3]);
                found.children.push([f as u32, NONE, NONE, NONE]);
            }
        }
        found
    }
}
