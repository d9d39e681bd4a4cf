//! Faces and the partner of each half-edge, for meshes whose edges have at most two faces.
//!
//! A half-edge is a place in the list of all corners and runs from that corner to the next one of its face. Faces may
//! have any orientation: walks around a vertex go from edge to edge and do not depend on the front side.

use crate::SubdivisionError;
use adwave::Progress;
use adwave::shape::Polygons;

/// Marker of an index that does not exist, such as the partner of a half-edge on a border.
pub(crate) const NONE: u32 = u32::MAX;

/// Number of half-edges between two checks for cancellation.
const AT_A_TIME: usize = 1 << 16;

/// Faces and the partners of their half-edges.
#[derive(Clone, Debug)]
pub(crate) struct Topology {
    pub(crate) n_vertices: usize,
    pub(crate) faces: Polygons,
    /// Face of each half-edge; empty if all faces are triangles.
    face_of: Vec<u32>,
    /// Partner of each half-edge, on the other side of its edge, or [`NONE`].
    pub(crate) twins: Vec<u32>,
    /// One half-edge at each vertex, without a partner if there is one such; [`NONE`] for a vertex without faces.
    pub(crate) starts: Vec<u32>,
    /// Number of faces at each vertex.
    pub(crate) n_faces_at: Vec<u32>,
    /// True for the half-edges of sharp edges inside the surface; empty if there are none.
    pub(crate) sharp: Vec<bool>,
}

/// Edge reached by a step of a walk around a vertex.
#[derive(Clone, Copy)]
pub(crate) struct Spoke {
    /// Half-edge of the face that was crossed.
    pub(crate) half_edge: u32,
    /// Other end of the edge.
    pub(crate) neighbor: u32,
}

impl Topology {
    /// Finds the partner of each half-edge in O(n), by a bucket for each vertex.
    pub(crate) fn new(
        n_vertices: usize,
        faces: Polygons,
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        let mut counts = vec![0_u32; n_vertices + 1];
        let mut n_faces_at = vec![0_u32; n_vertices];
        for (face, corners) in faces.iter().enumerate() {
            if face % AT_A_TIME == 0 {
                progress.check()?;
            }
            if let Some(&index) = corners.iter().find(|&&v| v as usize >= n_vertices) {
                return Err(SubdivisionError::IndexOutOfRange { face, index, n_vertices });
            }
            if corners.len() < 3 {
                return Err(SubdivisionError::FewCorners { face, n_corners: corners.len() });
            }
            if let Some(vertex) = repeated_corner(corners) {
                return Err(SubdivisionError::RepeatedCorner { face, vertex });
            }
            for (&v, &next) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                counts[v.min(next) as usize + 1] += 1;
                n_faces_at[v as usize] += 1;
            }
        }
        for v in 0..n_vertices {
            counts[v + 1] += counts[v];
        }
        let face_of = if faces.triangles().is_some() {
            Vec::new()
        } else {
            (0..).zip(faces.iter()).flat_map(|(f, corners)| std::iter::repeat_n(f, corners.len())).collect()
        };
        let starts = vec![NONE; n_vertices];
        let (twins, sharp) = (Vec::new(), Vec::new());
        let mut topology = Self { n_vertices, faces, face_of, twins, starts, n_faces_at, sharp };
        topology.twins = topology.match_half_edges(&counts, progress)?;
        topology.find_starts();
        Ok(topology)
    }

    /// Number of faces.
    pub(crate) fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// Face of a half-edge.
    pub(crate) fn face(&self, half_edge: u32) -> u32 {
        if self.face_of.is_empty() { half_edge / 3 } else { self.face_of[half_edge as usize] }
    }

    /// First half-edge of a face.
    pub(crate) fn first(&self, face: u32) -> u32 {
        if face == 0 { 0 } else { self.faces.end(face as usize - 1) as u32 }
    }

    /// Next half-edge of the same face.
    pub(crate) fn next(&self, half_edge: u32) -> u32 {
        if self.face_of.is_empty() {
            return if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 };
        }
        let face = self.face(half_edge);
        if half_edge as usize + 1 == self.faces.end(face as usize) { self.first(face) } else { half_edge + 1 }
    }

    /// Previous half-edge of the same face.
    pub(crate) fn previous(&self, half_edge: u32) -> u32 {
        let face = self.face(half_edge);
        if half_edge == self.first(face) { self.faces.end(face as usize) as u32 - 1 } else { half_edge - 1 }
    }

    /// Vertex from which a half-edge runs.
    pub(crate) fn origin(&self, half_edge: u32) -> u32 {
        self.faces.corners()[half_edge as usize]
    }

    fn find_starts(&mut self) {
        for (h, &v) in (0..).zip(self.faces.corners()) {
            let start = &mut self.starts[v as usize];
            if *start == NONE {
                *start = h;
            }
        }
        for (h, twin) in (0..).zip(&self.twins) {
            if *twin == NONE {
                for v in self.ends(h) {
                    self.starts[v as usize] = h;
                }
            }
        }
    }

    /// Ends of a half-edge.
    pub(crate) fn ends(&self, half_edge: u32) -> [u32; 2] {
        [self.origin(half_edge), self.origin(self.next(half_edge))]
    }

    /// Corner opposite a half-edge in its triangle.
    pub(crate) fn apex(&self, half_edge: u32) -> u32 {
        self.origin(self.previous(half_edge))
    }

    /// True for an edge on a border and for a sharp edge.
    pub(crate) fn is_crease(&self, half_edge: u32) -> bool {
        self.twins[half_edge as usize] == NONE
            || self.sharp.get(half_edge as usize).is_some_and(|&sharp| sharp)
    }

    /// True if an edge at the vertex has only one face.
    pub(crate) fn is_border(&self, v: u32) -> bool {
        let start = self.starts[v as usize];
        start != NONE && self.twins[start as usize] == NONE
    }

    /// Number of neighbors of a vertex.
    pub(crate) fn n_neighbors(&self, v: u32) -> usize {
        self.n_faces_at[v as usize] as usize + usize::from(self.is_border(v))
    }

    /// Returns the other edge at `v` in the face of a half-edge at `v`.
    pub(crate) fn turn(&self, half_edge: u32, v: u32) -> Spoke {
        if self.origin(half_edge) == v {
            let previous = self.previous(half_edge);
            return Spoke { half_edge: previous, neighbor: self.origin(previous) };
        }
        let next = self.next(half_edge);
        Spoke { half_edge: next, neighbor: self.origin(self.next(next)) }
    }

    /// Vertex straight across `w` from the other end of a half-edge: the third neighbor around a midpoint.
    pub(crate) fn opposite(&self, half_edge: u32, w: u32) -> Option<u32> {
        let mut at = half_edge;
        let mut spoke = self.turn(at, w);
        for _ in 0..2 {
            at = self.twins[spoke.half_edge as usize];
            if at == NONE {
                return None;
            }
            spoke = self.turn(at, w);
        }
        Some(spoke.neighbor)
    }

    /// Iterates over the edges at a vertex in their order around it, from border to border if the vertex lies on a
    /// border.
    pub(crate) fn ring(&self, v: u32) -> Ring<'_> {
        let start = self.starts[v as usize];
        Ring { topology: self, v, start, at: start, is_first: true, left: self.n_faces_at[v as usize] + 1 }
    }

    /// Faces at a vertex, increasing.
    pub(crate) fn faces_at(&self, v: u32) -> Vec<u32> {
        let sides = self.ring(v).flat_map(|spoke| [spoke.half_edge, self.twins[spoke.half_edge as usize]]);
        let mut faces: Vec<u32> = sides.filter(|&side| side != NONE).map(|side| self.face(side)).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// Third corner of the face on the other side of a half-edge; `None` on a border.
    pub(crate) fn apex_across(&self, half_edge: u32) -> Option<u32> {
        let twin = self.twins[half_edge as usize];
        (twin != NONE).then(|| self.apex(twin))
    }
}

impl Topology {
    /// Finds the partner of each half-edge; `offsets` has the start of the bucket of the smaller end of each edge.
    fn match_half_edges(
        &self,
        offsets: &[u32],
        progress: Progress<'_>,
    ) -> Result<Vec<u32>, SubdivisionError> {
        let n_half_edges = self.faces.corners().len();
        let mut filled: Vec<u32> = offsets[..offsets.len() - 1].to_vec();
        let mut bucket = vec![[NONE; 2]; n_half_edges];
        for h in 0..n_half_edges as u32 {
            let [a, b] = self.ends(h);
            let at = &mut filled[a.min(b) as usize];
            bucket[*at as usize] = [a.max(b), h];
            *at += 1;
        }
        let mut twins = vec![NONE; n_half_edges];
        for (a, range) in offsets.windows(2).enumerate() {
            if a % AT_A_TIME == 0 {
                progress.check()?;
            }
            let half_edges = &mut bucket[range[0] as usize..range[1] as usize];
            half_edges.sort_unstable();
            for same in half_edges.chunk_by(|x, y| x[0] == y[0]) {
                match *same {
                    [_] => {}
                    [[_, h], [_, g]] => {
                        twins[h as usize] = g;
                        twins[g as usize] = h;
                    }
                    _ => {
                        let (b, n_faces) = (same[0][0], same.len());
                        return Err(SubdivisionError::ManyFaces { a: a as u32, b, n_faces });
                    }
                }
            }
        }
        Ok(twins)
    }
}

/// A vertex that a face has twice.
fn repeated_corner(corners: &[u32]) -> Option<u32> {
    if corners.len() <= 4 {
        let pairs = corners.iter().enumerate();
        return pairs.into_iter().find(|(k, v)| corners[k + 1..].contains(v)).map(|(_, v)| *v);
    }
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

/// Walk around a vertex.
pub(crate) struct Ring<'a> {
    topology: &'a Topology,
    v: u32,
    start: u32,
    at: u32,
    is_first: bool,
    left: u32,
}

impl Iterator for Ring<'_> {
    type Item = Spoke;

    fn next(&mut self) -> Option<Spoke> {
        if self.start == NONE || self.left == 0 {
            return None;
        }
        self.left -= 1;
        let topology = self.topology;
        if self.is_first {
            self.is_first = false;
            let [a, b] = topology.ends(self.start);
            return Some(Spoke { half_edge: self.start, neighbor: if a == self.v { b } else { a } });
        }
        if self.at == NONE {
            return None;
        }
        let spoke = topology.turn(self.at, self.v);
        self.at = topology.twins[spoke.half_edge as usize];
        // A closed ring ends where it began; both half-edges of the first edge lead there.
        if spoke.half_edge == self.start || self.at == self.start {
            self.left = 0;
            return None;
        }
        Some(spoke)
    }
}

impl Topology {
    /// Iterates over the edges at a vertex inside the surface, beginning with the edge of a half-edge.
    pub(crate) fn ring_from(&self, v: u32, half_edge: u32) -> Ring<'_> {
        let left = self.n_faces_at[v as usize] + 1;
        Ring { topology: self, v, start: half_edge, at: half_edge, is_first: true, left }
    }
}

impl Topology {
    /// Returns the topology with vertex v renamed to `places[v]`.
    pub(crate) fn renumbered(self, places: &[u32]) -> Self {
        let mut starts = vec![NONE; self.n_vertices];
        let mut n_faces_at = vec![0; self.n_vertices];
        for (v, &place) in places.iter().enumerate() {
            starts[place as usize] = self.starts[v];
            n_faces_at[place as usize] = self.n_faces_at[v];
        }
        let faces = renamed(&self.faces, |v| places[v as usize]);
        Self { faces, starts, n_faces_at, ..self }
    }
}

/// Faces with each vertex renamed.
pub(crate) fn renamed(faces: &Polygons, name: impl Fn(u32) -> u32) -> Polygons {
    let (offsets, corners) = faces.clone().into_parts();
    let corners = corners.into_iter().map(name).collect();
    Polygons::from_parts(offsets, corners).expect("the offsets of the same faces")
}
