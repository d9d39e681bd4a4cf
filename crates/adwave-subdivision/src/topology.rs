//! Triangles and the partner of each half-edge, for meshes whose edges have at most two faces.
//!
//! Half-edge 3f + k runs from corner k of face f to the next corner. Faces may have any orientation: walks around a
//! vertex go from edge to edge and do not depend on the front side.

use crate::SubdivisionError;
use adwave::Progress;

/// Marker of an index that does not exist, such as the partner of a half-edge on a border.
pub(crate) const NONE: u32 = u32::MAX;

/// Number of half-edges between two checks for cancellation.
const AT_A_TIME: usize = 1 << 16;

/// Triangles and the partners of their half-edges.
#[derive(Clone, Debug)]
pub(crate) struct Topology {
    pub(crate) n_vertices: usize,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Partner of each half-edge, on the other side of its edge, or [`NONE`].
    pub(crate) twins: Vec<u32>,
    /// One half-edge at each vertex, without a partner if there is one such; [`NONE`] for a vertex without faces.
    pub(crate) starts: Vec<u32>,
    /// Number of faces at each vertex.
    pub(crate) n_faces_at: Vec<u32>,
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
        triangles: Vec<[u32; 3]>,
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        let mut counts = vec![0_u32; n_vertices + 1];
        let mut n_faces_at = vec![0_u32; n_vertices];
        for (face, &t) in triangles.iter().enumerate() {
            if face % AT_A_TIME == 0 {
                progress.check()?;
            }
            if let Some(&index) = t.iter().find(|&&v| v as usize >= n_vertices) {
                return Err(SubdivisionError::IndexOutOfRange { face, index, n_vertices });
            }
            if t[0] == t[1] || t[1] == t[2] || t[2] == t[0] {
                let vertex = if t[1] == t[2] { t[1] } else { t[0] };
                return Err(SubdivisionError::RepeatedCorner { face, vertex });
            }
            for k in 0..3 {
                counts[t[k].min(t[(k + 1) % 3]) as usize + 1] += 1;
                n_faces_at[t[k] as usize] += 1;
            }
        }
        for v in 0..n_vertices {
            counts[v + 1] += counts[v];
        }
        let twins = match_half_edges(&triangles, &counts, progress)?;
        let mut topology = Self { n_vertices, triangles, twins, starts: vec![NONE; n_vertices], n_faces_at };
        topology.find_starts();
        Ok(topology)
    }

    fn find_starts(&mut self) {
        for (h, &v) in (0..).zip(self.triangles.as_flattened()) {
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
        let (f, k) = (half_edge as usize / 3, half_edge as usize % 3);
        [self.triangles[f][k], self.triangles[f][(k + 1) % 3]]
    }

    /// Corner opposite a half-edge in its face.
    pub(crate) fn apex(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][(half_edge as usize + 2) % 3]
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
        let (f, k) = (half_edge / 3, half_edge % 3);
        let t = self.triangles[f as usize];
        // Half-edge k holds corners k and k+1; the other edge at v is the previous one at corner k, the next at k+1.
        let other = if t[k as usize] == v { (k + 2) % 3 } else { (k + 1) % 3 };
        let neighbor = t[(k as usize + 2) % 3];
        Spoke { half_edge: 3 * f + other, neighbor }
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

    /// Third corner of the face on the other side of a half-edge; `None` on a border.
    pub(crate) fn apex_across(&self, half_edge: u32) -> Option<u32> {
        let twin = self.twins[half_edge as usize];
        (twin != NONE).then(|| self.apex(twin))
    }
}

/// Finds the partner of each half-edge; `offsets` has the start of the bucket of the smaller end of each edge.
fn match_half_edges(
    triangles: &[[u32; 3]],
    offsets: &[u32],
    progress: Progress<'_>,
) -> Result<Vec<u32>, SubdivisionError> {
    let n_half_edges = 3 * triangles.len();
    let mut filled: Vec<u32> = offsets[..offsets.len() - 1].to_vec();
    let mut bucket = vec![[NONE; 2]; n_half_edges];
    for (f, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            let at = &mut filled[a.min(b) as usize];
            bucket[*at as usize] = [a.max(b), (3 * f + k) as u32];
            *at += 1;
        }
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
