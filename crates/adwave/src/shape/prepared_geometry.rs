//! A shape prepared for the analysis: welded, triangulated, and numbered so that neighbors are close in memory.

use super::adjacency::triangles_at_vertices;
use super::curve::{WeldedCurve, weld_curve};
use super::face_flags::FaceFlags;
use super::order::reverse_cuthill_mckee;
use super::participation::{Participation, STRAY_NEIGHBORS};
use super::seams::{SeamMatches, is_open, match_seams};
use super::sheets::nearest_on_sheet;
use super::triangulate::try_triangulate;
use super::{
    Adjacency, FaceIncidence, GivenNormals, Graph, Mesh, Neighborhoods, PointCloud, Polygons, SeamWeld,
    Shape, VertexMap, VertexRole, WeldMode, enclosed_face_volume, face_ring, total_face_area, welded_normals,
};
use crate::rows::Pattern;
use crate::{Cancelled, Progress, parallel};
use std::borrow::Cow;
use std::sync::{Arc, Mutex};

/// A shape with its welded vertices in the analysis order, and their relation to the vertices of the shape. Copies
/// share all arrays.
///
/// ```
/// use adwave::Progress;
/// use adwave::shape::{PointCloud, PreparedGeometry, Shape, WeldMode};
/// let shape = Shape::Cloud(PointCloud::new(vec![[0.0; 3], [1.0; 3], [0.0; 3]])?);
/// let geometry = PreparedGeometry::new(&shape, WeldMode::EqualPositions, Progress::none())?;
/// assert_eq!((shape.n_vertices(), geometry.n_vertices()), (3, 2));
/// assert_eq!(geometry.points(), [[0.0; 3], [1.0; 3]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PreparedGeometry {
    shape: Shape,
    vertex_map: VertexMap,
    points: Arc<Vec<[f64; 3]>>,
    /// Faces of three corners or more between welded vertices; polygons start at a corner that the positions decide.
    faces: Arc<Polygons>,
    /// The triangulated faces, unless all faces are triangles.
    triangles: Option<Arc<Vec<[u32; 3]>>>,
    participation: Arc<Participation>,
    /// Neighbors found while looking for strays, kept for the first call that asks for them.
    near: Arc<Mutex<Option<Neighborhoods>>>,
    /// Triangles at each vertex, found while looking for borders, kept for the first call that asks for them.
    at_vertex: Arc<Mutex<Option<Pattern>>>,
    /// Neighbors along a curve; `None` for other shapes.
    curve: Option<Arc<Adjacency>>,
    /// Given normals of the points of a cloud, with the signs that they were found to have.
    given_normals: Option<Arc<GivenNormals>>,
    weld_mode: WeldMode,
    /// Vertices at different positions that were welded.
    seams: Option<SeamWeld>,
}

/// Shape of the vertices that take part.
pub(crate) struct Members {
    pub(crate) geometry: PreparedGeometry,
    /// Vertices that take part, as vertices of the whole shape, in ascending order.
    pub(crate) vertices: Vec<u32>,
}

/// Number of reported stages: vertex map, positions, triangles.
const STAGES: u64 = 3;

/// Exponent range of moderate sizes: between 2⁻³² and 2³² model units nothing overflows or underflows that would
/// not at a size of 1.
const MODERATE_EXPONENT: f64 = 32.0;

/// Positions in some unit, and the length of that unit in model units.
pub(crate) type UnitPoints<'a> = (Cow<'a, [[f64; 3]]>, f64);

impl PreparedGeometry {
    /// Welds and triangulates `shape`. O(n log n).
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    pub fn new(shape: &Shape, weld_mode: WeldMode, progress: Progress<'_>) -> Result<Self, Cancelled> {
        progress.step(0, STAGES)?;
        let (mut given, mut are_sides_known) = (None, false);
        let (points, faces) = match shape {
            Shape::Graph(graph) => return Self::from_graph(shape, graph, weld_mode, progress),
            Shape::Cloud(cloud) => {
                (given, are_sides_known) = (cloud.normals(), cloud.are_sides_known());
                (cloud.points(), None)
            }
            Shape::Mesh(mesh) => (mesh.points(), Some(mesh.faces())),
        };
        let mut vertex_map = VertexMap::try_new(points, weld_mode, progress)?;
        progress.step(1, STAGES)?;
        let mut positions = vertex_map.try_positions(points, progress)?;
        progress.step(2, STAGES)?;
        let mut of_vertices = None;
        let mut seams = None;
        let mut faces = match faces {
            Some(given) => {
                let mut faces = welded_faces(given, vertex_map.as_slice(), progress)?;
                let mut vertex_faces = VertexFaces::new(positions.len(), &faces, progress)?;
                if let Some(found) =
                    match_weld_mode(weld_mode, &positions, &faces, &vertex_faces.flags, progress)?
                {
                    vertex_map = vertex_map.merged(&found.roots);
                    positions = vertex_map.try_positions(points, progress)?;
                    faces = welded_faces(given, vertex_map.as_slice(), progress)?;
                    vertex_faces = VertexFaces::new(positions.len(), &faces, progress)?;
                    seams = Some(found.weld);
                }
                of_vertices = Some(vertex_faces);
                faces
            }
            None => Polygons::new(),
        }
        .with_canonical_starts(&positions);
        let mut at_vertex = None;
        let (participation, near) = if let Some(of_vertices) = of_vertices {
            at_vertex = of_vertices.triangles;
            let is_used = &of_vertices.flags.is_used;
            (Participation::from_mesh(&positions, &mut faces, is_used, &mut at_vertex), None)
        } else {
            let (participation, near) = Participation::from_cloud(&positions, progress)?;
            (participation, Some(near))
        };
        let triangles = match faces.triangles() {
            Some(_) => None,
            None => Some(try_triangulate(&positions, &faces, progress, |_, corners| corners)?),
        };
        progress.step(STAGES, STAGES)?;
        let given_normals = match (given, &near) {
            (Some(normals), Some(near)) => {
                let welded = vertex_map.as_slice();
                let normals = welded_normals(normals.iter().copied(), welded, positions.len());
                GivenNormals::from_sides(&positions, near, &normals, are_sides_known, progress)?.map(Arc::new)
            }
            _ => None,
        };
        let near = near.filter(|_| !given_normals.as_ref().is_some_and(|given| given.are_sheets_apart));
        Ok(Self {
            vertex_map,
            points: Arc::new(positions),
            faces: Arc::new(faces),
            triangles: triangles.map(Arc::new),
            participation: Arc::new(participation),
            near: Arc::new(Mutex::new(near)),
            at_vertex: Arc::new(Mutex::new(at_vertex)),
            given_normals,
            seams,
            ..Self::empty(shape, weld_mode)
        })
    }

    /// A graph, whose nodes are numbered by the reverse Cuthill–McKee order, or along a curve.
    fn from_graph(
        shape: &Shape,
        graph: &Graph,
        weld_mode: WeldMode,
        progress: Progress<'_>,
    ) -> Result<Self, Cancelled> {
        let points = graph.positions();
        if let (Some(points), true) = (points, graph.is_curve()) {
            let WeldedCurve { vertex_map, edges } = weld_curve(graph, points, weld_mode, progress)?;
            let positions = vertex_map.try_positions(points, progress)?;
            progress.step(STAGES, STAGES)?;
            return Ok(Self {
                vertex_map,
                points: Arc::new(positions),
                participation: Arc::new(Participation::from_curve(&edges)),
                curve: Some(Arc::new(edges)),
                ..Self::empty(shape, weld_mode)
            });
        }
        let vertex_map = VertexMap::from_places(reverse_cuthill_mckee(graph.adjacency(), progress)?);
        let positions = match points {
            Some(points) => vertex_map.try_positions(points, progress)?,
            None => Vec::new(),
        };
        let participation = match graph.cell_areas() {
            Some(_) => Participation::from_curve(graph.rows().permute(vertex_map.as_slice()).pattern()),
            None => Participation::default(),
        };
        progress.step(STAGES, STAGES)?;
        Ok(Self {
            vertex_map,
            points: Arc::new(positions),
            participation: Arc::new(participation),
            ..Self::empty(shape, weld_mode)
        })
    }

    /// Geometry of a shape of which nothing is prepared yet.
    fn empty(shape: &Shape, weld_mode: WeldMode) -> Self {
        Self {
            shape: shape.clone(),
            vertex_map: VertexMap::identity(0),
            points: Arc::default(),
            faces: Arc::default(),
            triangles: None,
            participation: Arc::default(),
            near: Arc::default(),
            at_vertex: Arc::default(),
            curve: None,
            given_normals: None,
            weld_mode,
            seams: None,
        }
    }

    /// Wraps a graph whose nodes keep the given order, for one that is already well numbered.
    pub fn from_ordered_graph(graph: Graph) -> Self {
        let vertex_map = VertexMap::identity(graph.n_nodes());
        let curve = graph.is_curve().then(|| Arc::new(graph.adjacency().clone()));
        let points = graph.positions().unwrap_or_default().to_vec();
        Self {
            curve,
            shape: Shape::Graph(graph),
            vertex_map,
            points: Arc::new(points),
            faces: Arc::default(),
            triangles: None,
            participation: Arc::default(),
            near: Arc::default(),
            at_vertex: Arc::default(),
            given_normals: None,
            weld_mode: WeldMode::Off,
            seams: None,
        }
    }

    /// Wraps the graph of symmetric neighbors, each edge with the weight 1, in their order.
    pub(crate) fn from_neighbors(neighbors: &Adjacency) -> Self {
        let edges =
            (0..neighbors.n_rows()).flat_map(|x| neighbors.row(x).iter().map(move |&y| (x as u32, y)));
        let edges: Vec<(u32, u32, f64)> = edges.filter(|(x, y)| x < y).map(|(x, y)| (x, y, 1.0)).collect();
        let graph = Graph::new(neighbors.n_rows(), &edges).unwrap_or_else(|error| unreachable!("{error}"));
        Self::from_ordered_graph(graph)
    }

    /// The shape, in the order of its file.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Map from the vertices of the shape to the welded vertices.
    pub fn vertex_map(&self) -> &VertexMap {
        &self.vertex_map
    }

    /// Positions of the welded vertices, in model units; empty for a graph without positions.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Vertices at different positions that were welded along seams; `None` if there are none.
    pub fn seams(&self) -> Option<SeamWeld> {
        self.seams
    }

    /// Triangulated faces between welded vertices; empty for a cloud or a graph.
    pub fn triangles(&self) -> &[[u32; 3]] {
        match &self.triangles {
            Some(triangles) => triangles,
            None => self.faces.triangles().unwrap_or_default(),
        }
    }

    /// Faces of three corners or more between welded vertices, in the order of the mesh; empty for a cloud or a
    /// graph. Polygons start at a corner that only the positions decide
    /// ([`Polygons::with_canonical_starts`]).
    pub fn faces(&self) -> &Polygons {
        &self.faces
    }

    /// Neighbors of each welded vertex along a curve; `None` if the shape is not a curve.
    pub fn curve_edges(&self) -> Option<&Adjacency> {
        self.curve.as_deref()
    }

    /// End points of a curve, as welded vertices in ascending order: those with one neighbor. Empty for other shapes.
    pub fn curve_ends(&self) -> Vec<usize> {
        let Some(edges) = self.curve_edges() else { return Vec::new() };
        (0..edges.n_rows()).filter(|&x| edges.row(x).len() == 1).collect()
    }

    /// Vertices that share a side of a face, for each welded vertex.
    pub fn one_ring(&self) -> Adjacency {
        face_ring(self.n_vertices(), &self.faces)
    }

    /// Area of the mesh with `points` as its welded vertices, in their squared units.
    pub fn area_of(&self, points: &[[f64; 3]]) -> f64 {
        total_face_area(points, &self.faces)
    }

    /// Volume that the mesh encloses with `points` as its welded vertices, in their cubed units.
    pub fn volume_of(&self, points: &[[f64; 3]]) -> f64 {
        enclosed_face_volume(points, &self.faces)
    }

    /// True if the mesh has a border, or faces that disagree on the orientation; it encloses no volume then.
    pub(crate) fn is_open(&self) -> bool {
        is_open(self.n_vertices(), &self.faces)
    }

    /// Size of the shape in model units: the diagonal of the bounding box of its largest part; 0 for a graph.
    ///
    /// Vertices that take no part ([`outsiders`](Self::outsiders)) do not count, and of the connected parts only
    /// those with at least a tenth of the vertices of the most populous one. So neither strays, placeholders nor the
    /// layout of the parts change it. For a shape of one part it is the diagonal of the bounding box.
    pub fn extent(&self) -> f64 {
        self.participation.extent(&self.points, None)
    }

    /// [`extent`](Self::extent) without the flagged welded vertices.
    pub(crate) fn extent_without(&self, masked: &[bool]) -> f64 {
        self.participation.extent(&self.points, Some(masked))
    }

    /// Bounding box, in model units, of the part that a picture should show: all vertices that take part, unless a
    /// hundredth of them lies so far away that the others would fill less than half of the picture. `None` without
    /// positions.
    pub fn frame(&self) -> Option<([f64; 3], [f64; 3])> {
        self.participation.frame(&self.points)
    }

    /// Vertices of the shape that take no part in the analysis, in ascending order, with the reason. They have no
    /// neighbors and keep their values.
    pub fn outsiders(&self) -> Vec<(usize, VertexRole)> {
        let role = |x: &u32| self.participation.roles.get(*x as usize).copied().unwrap_or_default();
        let roles = self.vertex_map.as_slice().iter().map(role).enumerate();
        roles.filter(|(_, role)| *role != VertexRole::Member).collect()
    }

    /// The shape of the vertices that take part; `None` if all do.
    pub(crate) fn members(&self, progress: Progress<'_>) -> Result<Option<Members>, Cancelled> {
        let outsiders = self.outsiders();
        let Some(points) = self.shape.points().filter(|points| outsiders.len() < points.len()) else {
            return Ok(None);
        };
        if outsiders.is_empty() {
            return Ok(None);
        }
        let mut number = vec![0; points.len()];
        for (x, _) in &outsiders {
            number[*x] = u32::MAX;
        }
        let vertices: Vec<u32> = (0..points.len() as u32).filter(|&x| number[x as usize] == 0).collect();
        for (k, &x) in (0..).zip(&vertices) {
            number[x as usize] = k;
        }
        let pick = |values: &[[f64; 3]]| vertices.iter().map(|&x| values[x as usize]).collect::<Vec<_>>();
        let shape = match &self.shape {
            Shape::Mesh(mesh) => {
                let mut faces = Polygons::new();
                for face in mesh.faces().iter() {
                    let own: Vec<u32> = face.iter().map(|&c| number[c as usize]).collect();
                    if !own.contains(&u32::MAX) {
                        faces.push(&own);
                    }
                }
                Mesh::new(pick(points), faces).map(Shape::Mesh)
            }
            Shape::Cloud(cloud) => PointCloud::new(pick(points)).map(|own| {
                Shape::Cloud(match cloud.normals() {
                    Some(normals) => own.with_normals(pick(normals)),
                    None => own,
                })
            }),
            Shape::Graph(_) => return Ok(None),
        };
        let Ok(shape) = shape else { return Ok(None) };
        let geometry = Self::new(&shape, self.weld_mode, progress)?;
        // A shape whose members have outsiders of their own would never end.
        Ok(geometry.outsiders().is_empty().then_some(Members { geometry, vertices }))
    }

    pub(crate) fn participation(&self) -> &Participation {
        &self.participation
    }

    /// The `k` nearest neighbors of the points of a cloud at `points` (its positions in any unit), among those that
    /// take part.
    pub(crate) fn nearest(
        &self,
        points: &[[f64; 3]],
        k: usize,
        progress: Progress<'_>,
    ) -> Result<Neighborhoods, Cancelled> {
        if k == STRAY_NEIGHBORS && std::ptr::eq(points, self.points.as_slice()) {
            let known = self.near.lock().ok().and_then(|mut near| near.take());
            if let Some(near) = known {
                return Ok(near);
            }
        }
        self.nearest_of(points, k, |_| true, progress)
    }

    /// [`nearest`](Self::nearest) of the points that are wanted; what the others have is open.
    pub(crate) fn nearest_of(
        &self,
        points: &[[f64; 3]],
        k: usize,
        is_wanted: impl Fn(usize) -> bool + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Neighborhoods, Cancelled> {
        match &self.given_normals {
            Some(given) if given.are_sheets_apart => {
                nearest_on_sheet(points, &given.normals, &self.participation, k, is_wanted, progress)
            }
            _ => self.participation.nearest(points, k, is_wanted, progress),
        }
    }

    /// Keeps the [`STRAY_NEIGHBORS`] nearest neighbors for the next call that asks for them.
    pub(crate) fn keep_nearest(&self, near: Neighborhoods) {
        if let (false, Ok(mut known)) = (self.has_separate_sheets(), self.near.lock()) {
            *known = Some(near);
        }
    }

    /// True if the given normals of a cloud separate sheets: points with opposite normals are not neighbors.
    pub fn has_separate_sheets(&self) -> bool {
        self.given_normals.as_ref().is_some_and(|given| given.are_sheets_apart)
    }

    /// Given normals of the welded points of a cloud, checked and with consistent signs; `None` if the shape has none.
    pub fn given_normals(&self) -> Option<&GivenNormals> {
        self.given_normals.as_deref()
    }

    /// The faces at each welded vertex.
    pub(crate) fn incidence(&self, progress: Progress<'_>) -> Result<FaceIncidence<'_>, Cancelled> {
        let known = self.at_vertex.lock().ok().and_then(|mut at_vertex| at_vertex.take());
        match (self.faces.triangles(), known) {
            (Some(triangles), Some(at_vertex)) => Ok(FaceIncidence::Triangles { triangles, at_vertex }),
            _ => FaceIncidence::new(self.n_vertices(), &self.faces, progress),
        }
    }

    /// Number of welded vertices.
    pub fn n_vertices(&self) -> usize {
        self.vertex_map.n_welded()
    }

    /// Largest power of two not above the diagonal, in model units; 1 if all points coincide.
    pub(crate) fn size_unit(&self) -> f64 {
        let diagonal = self.participation.members_diagonal(&self.points);
        if diagonal == 0.0 { 1.0 } else { diagonal.log2().floor().clamp(-1000.0, 1000.0).exp2() }
    }

    /// Positions in a unit in which squares of lengths neither overflow nor underflow, and the length of that unit
    /// in model units: a power of two, so that nothing is rounded, and 1 for a shape of moderate size.
    pub(crate) fn unit_points(&self, progress: Progress<'_>) -> Result<UnitPoints<'_>, Cancelled> {
        let unit = self.size_unit();
        if unit.log2().abs() <= MODERATE_EXPONENT {
            return Ok((Cow::Borrowed(&self.points), 1.0));
        }
        let scaled = |x: usize| self.points[x].map(|c| c / unit);
        Ok((Cow::Owned(parallel::try_collect(self.points.len(), progress, scaled)?), unit))
    }
}

/// Matches the seams that a mode welds; `None` if there are none.
fn match_weld_mode(
    weld_mode: WeldMode,
    positions: &[[f64; 3]],
    faces: &Polygons,
    flags: &FaceFlags,
    progress: Progress<'_>,
) -> Result<Option<SeamMatches>, Cancelled> {
    match weld_mode {
        WeldMode::Seams => match_seams(positions, faces, flags, None, progress),
        WeldMode::Within(tolerance) if tolerance > 0.0 => {
            match_seams(positions, faces, flags, Some(tolerance), progress)
        }
        WeldMode::Within(_) | WeldMode::EqualPositions | WeldMode::Off => Ok(None),
    }
}

/// Facts about the faces at each vertex.
struct VertexFaces {
    flags: FaceFlags,
    /// The triangles at each vertex, if all faces are triangles.
    triangles: Option<Pattern>,
}

impl VertexFaces {
    fn new(n: usize, faces: &Polygons, progress: Progress<'_>) -> Result<Self, Cancelled> {
        let Some(triangles) = faces.triangles() else {
            return Ok(Self { flags: FaceFlags::new(n, faces), triangles: None });
        };
        let at_vertex = triangles_at_vertices(n, triangles, progress)?;
        let flags = FaceFlags::from_triangles(triangles, &at_vertex, progress)?;
        Ok(Self { flags, triangles: Some(at_vertex) })
    }
}

/// Faces of three corners or more with welded corners.
fn welded_faces(faces: &Polygons, welded: &[u32], progress: Progress<'_>) -> Result<Polygons, Cancelled> {
    let name = |corner: u32| welded[corner as usize];
    if let Some(triangles) = faces.triangles() {
        return Ok(parallel::try_collect(triangles.len(), progress, |f| triangles[f].map(name))?.into());
    }
    let mut kept = Polygons::with_capacity(faces.len(), faces.corners().len());
    let mut corners = Vec::new();
    for (f, face) in faces.iter().enumerate().filter(|(_, face)| face.len() > 2) {
        if f.is_multiple_of(FACES_AT_A_TIME) {
            progress.check()?;
        }
        corners.clear();
        corners.extend(face.iter().map(|&corner| name(corner)));
        kept.push(&corners);
    }
    Ok(kept)
}

/// Number of faces between two checks for cancellation.
const FACES_AT_A_TIME: usize = 1 << 14;
