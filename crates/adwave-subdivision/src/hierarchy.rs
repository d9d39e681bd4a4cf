//! Levels of a mesh that was made by subdivision.

use crate::coarsening::{Coarsening, ParitySearch};
use crate::topology::{NONE, Topology};
use crate::{Obstacle, SubdivisionError};
use adwave::Progress;
use adwave::shape::{Mesh, Polygons};

/// Number of faces between two checks for cancellation.
const AT_A_TIME: usize = 1 << 16;

/// Largest number of levels: 4¹⁶ faces are more than indices can number.
const MAX_LEVELS: usize = 16;

/// Levels, parents and coarse meshes of a mesh with subdivision connectivity; vertices and faces may have any order.
///
/// Level 0 is the mesh. On the next level each face represents four faces, and each vertex is a vertex of the finer
/// level; the other vertices of the finer level are midpoints of coarse edges. The vertices of level k ≥ 1 are the
/// first vertices of every finer level from 1 on ([`vertices`](Self::vertices)), so that a field on level k + 1 is the
/// beginning of a field on level k.
///
/// Parts of the mesh may have different numbers of levels; a part without a coarser level stays as it is.
///
/// ```
/// use adwave::Progress;
/// use adwave_subdivision::Hierarchy;
/// // A tetrahedron, each face cut into four.
/// let mesh = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let finer = adwave_subdivision::subdivide(4, &mesh);
/// let hierarchy = Hierarchy::new(finer.n_vertices, &finer.triangles, Progress::none())?;
/// assert_eq!((hierarchy.n_levels(), hierarchy.n_vertices(0), hierarchy.n_vertices(1)), (1, 10, 4));
/// # Ok::<(), adwave_subdivision::SubdivisionError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Hierarchy {
    /// Meshes from fine to coarse, with vertices in the order of the hierarchy.
    pub(crate) levels: Vec<HierarchyLevel>,
    /// Vertex of the mesh at each place in the order of the hierarchy; the coarsest level comes first.
    pub(crate) order: Vec<u32>,
    parts: Vec<SubdivisionPart>,
}

/// A mesh of the hierarchy, and the step that leads to it from the finer one.
#[derive(Clone, Debug)]
pub(crate) struct HierarchyLevel {
    pub(crate) topology: Topology,
    /// Midpoint on the finer level of each half-edge, or [`NONE`]; empty on level 0.
    pub(crate) midpoint_of: Vec<u32>,
    /// Ends of the edge of each midpoint; midpoints are numbered after the vertices of this level. Empty on level 0.
    pub(crate) parents: Vec<[u32; 2]>,
    /// Finer faces in each face: the central one, then the others; [`NONE`] in the other places if a face is unchanged.
    /// Empty on level 0.
    pub(crate) children: Vec<[u32; 4]>,
}

/// A connected part of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SubdivisionPart {
    /// First vertex of the part.
    pub first: u32,
    /// Number of vertices on level 0.
    pub n_vertices: usize,
    /// Number of vertices on the coarsest level.
    pub n_coarsest: usize,
    /// Number of levels of subdivision.
    pub n_levels: usize,
    /// Reason why there is no further level.
    pub obstacle: Obstacle,
}

/// Connected parts of a mesh, and the part of each vertex.
struct Parts {
    of_vertex: Vec<u32>,
    infos: Vec<SubdivisionPart>,
    /// True while a coarser level may exist.
    active: Vec<bool>,
}

impl Parts {
    /// Finds the parts by joining the corners of each face; the root of each part is its first vertex.
    fn new(topology: &Topology, progress: Progress<'_>) -> Result<Self, SubdivisionError> {
        let mut parents: Vec<u32> = (0..topology.n_vertices as u32).collect();
        for faces in topology.triangles.chunks(AT_A_TIME) {
            progress.check()?;
            for t in faces {
                let mut first = find_root(&mut parents, t[0]);
                for &v in &t[1..] {
                    let other = find_root(&mut parents, v);
                    let (low, high) = (first.min(other), first.max(other));
                    parents[high as usize] = low;
                    first = low;
                }
            }
        }
        let (mut of_vertex, mut infos, mut active) =
            (vec![NONE; topology.n_vertices], Vec::new(), Vec::new());
        for v in 0..topology.n_vertices as u32 {
            let first = find_root(&mut parents, v);
            if first == v {
                of_vertex[v as usize] = infos.len() as u32;
                active.push(topology.starts[v as usize] != NONE);
                let obstacle = Obstacle::NoFaces { vertex: v };
                infos.push(SubdivisionPart { first, n_vertices: 0, n_coarsest: 0, n_levels: 0, obstacle });
            } else {
                of_vertex[v as usize] = of_vertex[first as usize];
            }
            infos[of_vertex[v as usize] as usize].n_vertices += 1;
        }
        Ok(Self { of_vertex, infos, active })
    }
}

/// Finds the first vertex of the part that a vertex belongs to so far.
fn find_root(parents: &mut [u32], v: u32) -> u32 {
    let mut at = v;
    while parents[at as usize] != at {
        let next = parents[at as usize];
        parents[at as usize] = parents[next as usize];
        at = next;
    }
    at
}

/// Level during the search, with its own numbering.
struct SearchLevel {
    topology: Topology,
    coarsening: Coarsening,
    /// Index of each coarse vertex on the next level.
    coarse_rank: Vec<u32>,
}

impl Hierarchy {
    /// Finds the levels of a mesh with `n_vertices` vertices and the faces `triangles` in O(n).
    ///
    /// # Errors
    /// [`SubdivisionError`] if the triangles do not form a surface with borders, if no part has a coarser level (with
    /// the reason), and on cancellation.
    pub fn new(
        n_vertices: usize,
        triangles: &[[u32; 3]],
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        if triangles.is_empty() {
            return Err(SubdivisionError::NoFaces);
        }
        let mut topology = Topology::new(n_vertices, triangles.to_vec(), progress)?;
        let mut parts = Parts::new(&topology, progress)?;
        // The vertex of the mesh of each vertex of the present level.
        let mut names: Vec<u32> = (0..n_vertices as u32).collect();
        let mut finer: Vec<SearchLevel> = Vec::new();
        while finer.len() < MAX_LEVELS {
            let Some((coarsening, coarser, coarse_rank)) = coarsen(&topology, &names, &mut parts, progress)?
            else {
                break;
            };
            names = coarsening.coarse.iter().map(|&v| names[v as usize]).collect();
            finer.push(SearchLevel { topology, coarsening, coarse_rank });
            topology = coarser;
        }
        if finer.is_empty() {
            let part = parts.infos.iter().max_by_key(|part| part.n_vertices);
            let obstacle = part.map_or(Obstacle::NoFaces { vertex: 0 }, |part| part.obstacle);
            return Err(SubdivisionError::NoLevels { obstacle });
        }
        for &v in &names {
            parts.infos[parts.of_vertex[v as usize] as usize].n_coarsest += 1;
        }
        progress.check()?;
        Ok(number_levels(finer, topology, &names, parts.infos))
    }

    /// Finds the levels of a mesh whose faces are triangles, like [`new`](Self::new).
    ///
    /// # Errors
    /// As for [`new`](Self::new), and [`SubdivisionError::NotTriangle`] if a face has more or fewer than three corners.
    pub fn from_mesh(mesh: &Mesh, progress: Progress<'_>) -> Result<Self, SubdivisionError> {
        Self::new(mesh.points().len(), triangles_of(mesh.faces())?, progress)
    }

    /// Number of levels of subdivision, at least 1.
    pub fn n_levels(&self) -> usize {
        self.levels.len() - 1
    }

    /// Number of vertices of a level.
    ///
    /// # Panics
    /// If the level does not exist.
    pub fn n_vertices(&self, level: usize) -> usize {
        self.levels[level].topology.n_vertices
    }

    /// Number of faces of a level.
    ///
    /// # Panics
    /// If the level does not exist.
    pub fn n_faces(&self, level: usize) -> usize {
        self.levels[level].topology.triangles.len()
    }

    /// Vertex of the mesh at each vertex of a level.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if the level does not exist.
    pub fn vertices(&self, level: usize) -> Result<Vec<u32>, SubdivisionError> {
        self.check_level(level)?;
        Ok(match level {
            0 => (0..self.order.len() as u32).collect(),
            _ => self.order[..self.n_vertices(level)].to_vec(),
        })
    }

    /// Faces of a level, as vertices of that level. Their corners have the order of the corners of the finer faces.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if the level does not exist.
    pub fn triangles(&self, level: usize) -> Result<Vec<[u32; 3]>, SubdivisionError> {
        self.check_level(level)?;
        let triangles = &self.levels[level].topology.triangles;
        Ok(match level {
            0 => triangles.iter().map(|t| t.map(|v| self.order[v as usize])).collect(),
            _ => triangles.clone(),
        })
    }

    /// Parents of each vertex of a level finer than the coarsest, as vertices of the next level: the ends of the edge
    /// of a midpoint, or twice the vertex itself if it remains.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if there is no next level.
    pub fn parents(&self, level: usize) -> Result<Vec<[u32; 2]>, SubdivisionError> {
        if level >= self.n_levels() {
            return Err(SubdivisionError::Level { level, n_levels: self.n_levels() - 1 });
        }
        let coarser = &self.levels[level + 1];
        let staying = (0..coarser.topology.n_vertices as u32).map(|v| [v, v]);
        let parents: Vec<[u32; 2]> = staying.chain(coarser.parents.iter().copied()).collect();
        if level > 0 {
            return Ok(parents);
        }
        let mut in_mesh = vec![[0; 2]; parents.len()];
        for (&v, pair) in self.order.iter().zip(parents) {
            in_mesh[v as usize] = pair;
        }
        Ok(in_mesh)
    }

    /// Connected parts of the mesh with their numbers of levels, in the order of their first vertices.
    pub fn parts(&self) -> &[SubdivisionPart] {
        &self.parts
    }

    /// Checks that a level exists.
    pub(crate) fn check_level(&self, level: usize) -> Result<(), SubdivisionError> {
        if level > self.n_levels() {
            return Err(SubdivisionError::Level { level, n_levels: self.n_levels() });
        }
        Ok(())
    }
}

/// Returns the triangles of faces that have three corners each.
///
/// # Errors
/// [`SubdivisionError::NotTriangle`] for the first face with another number of corners.
pub fn triangles_of(faces: &Polygons) -> Result<&[[u32; 3]], SubdivisionError> {
    if let Some((face, corners)) = faces.iter().enumerate().find(|(_, corners)| corners.len() != 3) {
        return Err(SubdivisionError::NotTriangle { face, n_corners: corners.len() });
    }
    Ok(faces.triangles().unwrap_or_default())
}

/// Finds the next level of all active parts, its mesh, and the index of each vertex on it; `None` if no part has one.
fn coarsen(
    topology: &Topology,
    names: &[u32],
    parts: &mut Parts,
    progress: Progress<'_>,
) -> Result<Option<(Coarsening, Topology, Vec<u32>)>, SubdivisionError> {
    loop {
        let n_parts = parts.infos.len();
        let (mut first, mut irregular) = (vec![NONE; n_parts], vec![NONE; n_parts]);
        for (v, &name) in (0..topology.n_vertices as u32).zip(names) {
            let part = parts.of_vertex[name as usize] as usize;
            if !parts.active[part] {
                continue;
            }
            if first[part] == NONE {
                first[part] = v;
            }
            let n_regular = if topology.is_border(v) { 4 } else { 6 };
            if irregular[part] == NONE && topology.n_neighbors(v) != n_regular {
                irregular[part] = v;
            }
        }
        let mut search = ParitySearch::new(topology, progress);
        for part in 0..n_parts {
            if first[part] == NONE {
                continue;
            }
            let seed = (irregular[part] != NONE).then_some(irregular[part]);
            if let Some(obstacle) = search.search_part(first[part], seed)? {
                parts.active[part] = false;
                parts.infos[part].obstacle = obstacle.renamed(names);
            }
        }
        if !parts.active.contains(&true) {
            return Ok(None);
        }
        let coarsening = search.finish();
        let mut rank = vec![NONE; topology.n_vertices];
        for (k, &v) in (0..).zip(&coarsening.coarse) {
            rank[v as usize] = k;
        }
        let triangles = coarsening.triangles.iter().map(|t| t.map(|v| rank[v as usize])).collect();
        let name = |k: u32| names[coarsening.coarse[k as usize] as usize];
        let vertex = match Topology::new(coarsening.coarse.len(), triangles, progress) {
            Ok(coarser) => {
                for (active, part) in parts.active.iter().zip(&mut parts.infos) {
                    part.n_levels += usize::from(*active);
                }
                return Ok(Some((coarsening, coarser, rank)));
            }
            Err(
                SubdivisionError::RepeatedCorner { vertex, .. }
                | SubdivisionError::ManyFaces { a: vertex, .. },
            ) => name(vertex),
            Err(error) => return Err(error),
        };
        let part = parts.of_vertex[vertex as usize] as usize;
        parts.active[part] = false;
        parts.infos[part].obstacle = Obstacle::Degenerate { vertex };
    }
}

impl Obstacle {
    /// Returns the reason with the vertex of the level replaced by that of the mesh.
    fn renamed(self, names: &[u32]) -> Self {
        let name = |vertex: u32| names[vertex as usize];
        match self {
            Self::Valence { vertex, n_neighbors } => Self::Valence { vertex: name(vertex), n_neighbors },
            Self::Parity { vertex } => Self::Parity { vertex: name(vertex) },
            Self::Border { vertex } => Self::Border { vertex: name(vertex) },
            Self::Degenerate { vertex } => Self::Degenerate { vertex: name(vertex) },
            Self::Pinched { vertex } => Self::Pinched { vertex: name(vertex) },
            Self::NoFaces { vertex } => Self::NoFaces { vertex: name(vertex) },
        }
    }
}

/// Numbers the vertices of all levels from coarse to fine.
fn number_levels(
    finer: Vec<SearchLevel>,
    coarsest: Topology,
    names: &[u32],
    parts: Vec<SubdivisionPart>,
) -> Hierarchy {
    // Place of each vertex of the level at hand; the vertices of the coarsest level come first in their order.
    let mut places: Vec<u32> = (0..coarsest.n_vertices as u32).collect();
    let mut levels = Vec::with_capacity(finer.len() + 1);
    let mut coarser = coarsest;
    for SearchLevel { topology, coarsening, coarse_rank } in finer.into_iter().rev() {
        let mut finer_places = vec![NONE; topology.n_vertices];
        for &v in &coarsening.coarse {
            finer_places[v as usize] = places[coarse_rank[v as usize] as usize];
        }
        for (place, &v) in (coarsening.coarse.len() as u32..).zip(&coarsening.midpoints) {
            finer_places[v as usize] = place;
        }
        let place = |v: u32| if v == NONE { NONE } else { finer_places[v as usize] };
        let level = HierarchyLevel {
            topology: coarser.renumbered(&places),
            midpoint_of: coarsening.midpoint_of.into_iter().map(place).collect(),
            parents: coarsening.parents.into_iter().map(|pair| pair.map(place)).collect(),
            children: coarsening.children,
        };
        levels.push(level);
        (coarser, places) = (topology, finer_places);
    }
    let mut order = vec![0; places.len()];
    for (v, &place) in (0..).zip(&places) {
        order[place as usize] = v;
    }
    debug_assert_eq!(&order[..names.len()], names);
    let topology = coarser.renumbered(&places);
    levels.push(HierarchyLevel {
        topology,
        midpoint_of: Vec::new(),
        parents: Vec::new(),
        children: Vec::new(),
    });
    levels.reverse();
    Hierarchy { levels, order, parts }
}

impl Topology {
    /// Returns the topology with vertex v renamed to `places[v]`.
    fn renumbered(self, places: &[u32]) -> Self {
        let mut starts = vec![NONE; self.n_vertices];
        let mut n_faces_at = vec![0; self.n_vertices];
        for (v, &place) in places.iter().enumerate() {
            starts[place as usize] = self.starts[v];
            n_faces_at[place as usize] = self.n_faces_at[v];
        }
        let triangles = self.triangles.into_iter().map(|t| t.map(|v| places[v as usize])).collect();
        Self { triangles, starts, n_faces_at, ..self }
    }
}
