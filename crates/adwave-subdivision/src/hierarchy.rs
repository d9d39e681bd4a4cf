//! Levels of a mesh that was made by subdivision.

use crate::coarsening::{Coarsening, ParitySearch};
use crate::quad_levels::{self, QuadParams};
use crate::topology::{NONE, Topology, renamed};
use crate::{Family, Obstacle, SubdivisionError};
use adwave::shape::{Mesh, Polygons};
use adwave::{Progress, named_values};

/// Number of faces between two checks for cancellation.
const AT_A_TIME: usize = 1 << 16;

/// Largest number of levels: 4¹⁶ faces are more than indices can number.
pub(crate) const MAX_LEVELS: usize = 16;

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
    pub(crate) corners: BorderCorners,
}

/// Rule for the vertices of one face on a border in Catmull–Clark subdivision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BorderCorners {
    /// The border is smooth everywhere, as with Blender's boundary "all".
    #[default]
    Smooth,
    /// They stay in place, as with OpenSubdiv's boundary "edge and corner".
    Sharp,
}

named_values!(BorderCorners, "rule of border corners", {
    Smooth => "smooth", "the border is smooth everywhere";
    Sharp => "sharp", "border vertices of one face stay in place";
});

/// A mesh of the hierarchy, and the step that leads to it from the finer one.
#[derive(Clone, Debug)]
pub(crate) struct HierarchyLevel {
    pub(crate) topology: Topology,
    /// Midpoint on the finer level of each half-edge, or [`NONE`]; empty on level 0.
    pub(crate) midpoint_of: Vec<u32>,
    /// Ends of the edge of each midpoint; midpoints are numbered after the vertices of this level. Empty on level 0.
    pub(crate) parents: Vec<[u32; 2]>,
    /// Face point on the finer level of each face, or [`NONE`]; face points are numbered after the midpoints. Empty on
    /// level 0 and for triangles.
    pub(crate) face_points: Vec<u32>,
    /// Finer faces in each face: the central one, then the others; [`NONE`] in the other places if a face is unchanged.
    /// Empty on level 0 and for quadrilaterals.
    pub(crate) children: Vec<[u32; 4]>,
}

impl HierarchyLevel {
    fn without_step(topology: Topology) -> Self {
        let (midpoint_of, parents, face_points, children) = Default::default();
        Self { topology, midpoint_of, parents, face_points, children }
    }
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
    /// True if the connectivity allows other coarse vertices with as many levels.
    pub is_ambiguous: bool,
    /// Reason why there is no further level.
    pub obstacle: Obstacle,
}

/// Connected parts of a mesh, and the part of each vertex.
pub(crate) struct Parts {
    pub(crate) of_vertex: Vec<u32>,
    pub(crate) infos: Vec<SubdivisionPart>,
    /// True while a coarser level may exist.
    pub(crate) active: Vec<bool>,
}

impl Parts {
    /// Finds the parts by joining the corners of each face; the root of each part is its first vertex.
    fn new(topology: &Topology, progress: Progress<'_>) -> Result<Self, SubdivisionError> {
        let mut parents: Vec<u32> = (0..topology.n_vertices as u32).collect();
        for (f, corners) in topology.faces.iter().enumerate() {
            if f % AT_A_TIME == 0 {
                progress.check()?;
            }
            let mut first = find_root(&mut parents, corners[0]);
            for &v in &corners[1..] {
                let other = find_root(&mut parents, v);
                let (low, high) = (first.min(other), first.max(other));
                parents[high as usize] = low;
                first = low;
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
                infos.push(SubdivisionPart {
                    first,
                    n_vertices: 0,
                    n_coarsest: 0,
                    n_levels: 0,
                    is_ambiguous: false,
                    obstacle,
                });
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
pub(crate) struct SearchLevel {
    pub(crate) topology: Topology,
    pub(crate) coarsening: Coarsening,
    /// Index of each coarse vertex on the next level.
    pub(crate) coarse_rank: Vec<u32>,
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
        let mut topology = Topology::new(n_vertices, Polygons::from_triangles(triangles), progress)?;
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
        Self::from_levels(finer, topology, &names, parts, progress)
    }

    /// Finds the levels of a mesh of polygons in O(n): those of triangles that were cut into four if all faces are
    /// triangles, like [`new`](Self::new), and otherwise those of Catmull–Clark subdivision, where each face of n
    /// corners was cut into n quadrilaterals. The coarsest mesh may have faces of any number of corners.
    ///
    /// # Errors
    /// As for [`new`](Self::new), and [`SubdivisionError::NoEdge`] if a crease is not an edge of the mesh.
    ///
    /// ```
    /// use adwave::{Progress, shape::Polygons};
    /// use adwave_subdivision::{Hierarchy, QuadParams, subdivide_polygons};
    /// let pentagon: Polygons = [[0, 1, 2, 3, 4].as_slice()].into_iter().collect();
    /// let finer = subdivide_polygons(5, &pentagon);
    /// let hierarchy = Hierarchy::from_faces(11, &finer.faces, &QuadParams::default(), Progress::none())?;
    /// assert_eq!((hierarchy.n_levels(), hierarchy.n_vertices(1), hierarchy.faces(1)?.get(0).len()), (1, 5, 5));
    /// # Ok::<(), adwave_subdivision::SubdivisionError>(())
    /// ```
    pub fn from_faces(
        n_vertices: usize,
        faces: &Polygons,
        params: &QuadParams<'_>,
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        if let Some(triangles) = faces.triangles() {
            return Self::new(n_vertices, triangles, progress);
        }
        let mut topology = Topology::new(n_vertices, faces.clone(), progress)?;
        quad_levels::set_creases(&mut topology, params.creases)?;
        let mut parts = Parts::new(&topology, progress)?;
        let found = quad_levels::search(topology, &mut parts, params, progress)?;
        let mut hierarchy = Self::from_levels(found.finer, found.coarsest, &found.names, parts, progress)?;
        hierarchy.corners = params.corners;
        Ok(hierarchy)
    }

    /// Numbers the levels that a search has found.
    fn from_levels(
        finer: Vec<SearchLevel>,
        coarsest: Topology,
        names: &[u32],
        mut parts: Parts,
        progress: Progress<'_>,
    ) -> Result<Self, SubdivisionError> {
        if finer.is_empty() {
            let part = parts.infos.iter().max_by_key(|part| part.n_vertices);
            let obstacle = part.map_or(Obstacle::NoFaces { vertex: 0 }, |part| part.obstacle);
            return Err(SubdivisionError::NoLevels { obstacle });
        }
        for &v in names {
            parts.infos[parts.of_vertex[v as usize] as usize].n_coarsest += 1;
        }
        progress.check()?;
        Ok(number_levels(finer, coarsest, names, parts.infos))
    }

    /// Finds the levels of a mesh by its faces and positions, like [`from_faces`](Self::from_faces).
    ///
    /// # Errors
    /// As for [`from_faces`](Self::from_faces).
    pub fn from_mesh(mesh: &Mesh, progress: Progress<'_>) -> Result<Self, SubdivisionError> {
        let params = QuadParams { points: Some(mesh.points()), ..QuadParams::default() };
        Self::from_faces(mesh.points().len(), mesh.faces(), &params, progress)
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
        self.levels[level].topology.n_faces()
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

    /// True if the levels are those of Catmull–Clark subdivision, false if those of triangles.
    pub fn is_of_quads(&self) -> bool {
        self.levels[0].topology.faces.triangles().is_none()
    }

    /// Family of wavelets to use unless another is asked for.
    pub fn usual_family(&self) -> Family {
        if self.is_of_quads() { Family::CatmullClark } else { Family::default() }
    }

    /// Faces of a level, as vertices of that level.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if the level does not exist.
    pub fn faces(&self, level: usize) -> Result<Polygons, SubdivisionError> {
        self.check_level(level)?;
        let faces = &self.levels[level].topology.faces;
        Ok(if level == 0 { renamed(faces, |v| self.order[v as usize]) } else { faces.clone() })
    }

    /// Triangles of a level, as vertices of that level. Their corners have the order of the corners of the finer faces.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if the level does not exist, [`SubdivisionError::NotTriangle`] for quadrilaterals.
    pub fn triangles(&self, level: usize) -> Result<Vec<[u32; 3]>, SubdivisionError> {
        Ok(triangles_of(&self.faces(level)?)?.to_vec())
    }

    /// Parents of each vertex of a level finer than the coarsest, as vertices of the next level, each with an equal
    /// share: the corners of a face for its face point, the ends of the edge of a midpoint, or the vertex itself if it
    /// remains. Returned as the start of each row, with the end of the last one, and the parents.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if there is no next level.
    pub fn parent_rows(&self, level: usize) -> Result<(Vec<u32>, Vec<u32>), SubdivisionError> {
        self.check_has_next(level)?;
        let coarser = &self.levels[level + 1];
        let n = self.n_vertices(level);
        let mut rows: Vec<Vec<u32>> = (0..coarser.topology.n_vertices as u32).map(|v| vec![v]).collect();
        rows.extend(coarser.parents.iter().map(|pair| pair.to_vec()));
        rows.resize(n, Vec::new());
        for (corners, &center) in coarser.topology.faces.iter().zip(&coarser.face_points) {
            if center != NONE {
                rows[center as usize] = corners.to_vec();
            }
        }
        let mut in_mesh = Vec::new();
        if level == 0 {
            in_mesh.resize(n, 0);
            for (place, &v) in self.order.iter().enumerate() {
                in_mesh[v as usize] = place;
            }
        } else {
            in_mesh.extend(0..n);
        }
        let (mut starts, mut parents) = (vec![0], Vec::new());
        for place in in_mesh {
            parents.extend(&rows[place]);
            starts.push(parents.len() as u32);
        }
        Ok((starts, parents))
    }

    fn check_has_next(&self, level: usize) -> Result<(), SubdivisionError> {
        if level >= self.n_levels() {
            return Err(SubdivisionError::Level { level, n_levels: self.n_levels() - 1 });
        }
        Ok(())
    }

    /// Parents of each vertex of a level finer than the coarsest, as vertices of the next level: the ends of the edge
    /// of a midpoint, or twice the vertex itself if it remains.
    ///
    /// # Errors
    /// [`SubdivisionError::Level`] if there is no next level, [`SubdivisionError::PairsOfQuads`] for quadrilaterals,
    /// whose face points have more parents ([`parent_rows`](Self::parent_rows)).
    pub fn parents(&self, level: usize) -> Result<Vec<[u32; 2]>, SubdivisionError> {
        self.check_has_next(level)?;
        if self.is_of_quads() {
            return Err(SubdivisionError::PairsOfQuads);
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
        let rank = coarsening.ranks(topology.n_vertices);
        let name = |k: u32| names[coarsening.coarse[k as usize] as usize];
        let vertex = match coarsening.coarse_topology(&rank, progress) {
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
    pub(crate) fn renamed(self, names: &[u32]) -> Self {
        let name = |vertex: u32| names[vertex as usize];
        match self {
            Self::Valence { vertex, n_neighbors } => Self::Valence { vertex: name(vertex), n_neighbors },
            Self::Parity { vertex } => Self::Parity { vertex: name(vertex) },
            Self::Border { vertex } => Self::Border { vertex: name(vertex) },
            Self::Degenerate { vertex } => Self::Degenerate { vertex: name(vertex) },
            Self::Pinched { vertex } => Self::Pinched { vertex: name(vertex) },
            Self::NoFaces { vertex } => Self::NoFaces { vertex: name(vertex) },
            Self::NotQuad { vertex, n_corners } => Self::NotQuad { vertex: name(vertex), n_corners },
            Self::EdgePoint { vertex, n_neighbors } => Self::EdgePoint { vertex: name(vertex), n_neighbors },
            Self::FacePoint { vertex } => Self::FacePoint { vertex: name(vertex) },
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
        let centers = coarsening.face_points.iter().copied().filter(|&v| v != NONE);
        for (place, v) in ((coarsening.coarse.len() + coarsening.midpoints.len()) as u32..).zip(centers) {
            finer_places[v as usize] = place;
        }
        let place = |v: u32| if v == NONE { NONE } else { finer_places[v as usize] };
        let level = HierarchyLevel {
            topology: coarser.renumbered(&places),
            midpoint_of: coarsening.midpoint_of.into_iter().map(place).collect(),
            parents: coarsening.parents.into_iter().map(|pair| pair.map(place)).collect(),
            face_points: coarsening.face_points.into_iter().map(place).collect(),
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
    levels.push(HierarchyLevel::without_step(topology));
    levels.reverse();
    Hierarchy { levels, order, parts, corners: BorderCorners::default() }
}
