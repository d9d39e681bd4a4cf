//! Levels of a mesh of quadrilaterals: in which of up to four ways each step of each part begins.
//!
//! All ways that the connectivity allows are followed to the coarsest level: a step has at most four, and the next
//! level a fourth of the faces, so each level costs O(n). Only those with the most levels remain. They are several for
//! meshes without irregular vertices, such as tori and strips, and in the last step of closed meshes, where the dual
//! mesh has the same subdivision (a cube and an octahedron). The positions then decide (see `quad_fit`): a way whose
//! positions follow from the coarse ones by subdivision, then one whose coarsest mesh has the fewest faces that are not
//! quadrilaterals, then the smaller details, then the first.

use crate::coarsening::Coarsening;
use crate::hierarchy::{MAX_LEVELS, Parts, SearchLevel};
use crate::quad_coarsening::{N_CHOICES, RoleSearch};
use crate::quad_fit::Fit;
use crate::topology::{NONE, Topology};
use crate::{BorderCorners, Obstacle, SubdivisionError};
use adwave::Progress;
use adwave::shape::Polygons;
use adwave::vector::{add_scaled, cross, dot, norm, subtract};

/// Positions and creases of a mesh of quadrilaterals.
#[derive(Clone, Copy, Debug, Default)]
pub struct QuadParams<'a> {
    /// Positions of the vertices, which decide where the connectivity allows several coarse meshes.
    pub points: Option<&'a [[f64; 3]]>,
    /// Sharp edges of the mesh by their ends. A coarse edge is sharp if both of its halves are.
    pub creases: &'a [[u32; 2]],
    /// Rule for border vertices of one face.
    pub corners: BorderCorners,
}

/// Levels from fine to coarse, the coarsest mesh, and the vertex of the mesh at each of its vertices.
pub(crate) struct QuadLevels {
    pub(crate) finer: Vec<SearchLevel>,
    pub(crate) coarsest: Topology,
    pub(crate) names: Vec<u32>,
}

/// Marks the half-edges of sharp edges.
pub(crate) fn set_creases(topology: &mut Topology, creases: &[[u32; 2]]) -> Result<(), SubdivisionError> {
    if creases.is_empty() {
        return Ok(());
    }
    let mut sharp = vec![false; topology.twins.len()];
    for &[a, b] in creases {
        let at = if (a as usize) < topology.n_vertices {
            topology.ring(a).find(|spoke| spoke.neighbor == b)
        } else {
            None
        };
        let Some(spoke) = at else { return Err(SubdivisionError::NoEdge { a, b }) };
        sharp[spoke.half_edge as usize] = true;
        if let Some(twin) = sharp.get_mut(topology.twins[spoke.half_edge as usize] as usize) {
            *twin = true;
        }
    }
    topology.sharp = sharp;
    Ok(())
}

/// Edges between faces whose normals enclose more than an angle in degrees, as pairs of vertices. Faces may have any
/// orientation; edges of a border are not among them. O(n).
///
/// ```
/// use adwave::{Progress, shape::Polygons};
/// use adwave_subdivision::sharp_edges;
/// let points = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0]];
/// let faces: Polygons = [[0, 1, 2, 3].as_slice(), &[0, 1, 5, 4]].into_iter().collect();
/// assert_eq!(sharp_edges(&points, &faces, 80.0, Progress::none())?, [[0, 1]]);
/// assert!(sharp_edges(&points, &faces, 100.0, Progress::none())?.is_empty());
/// # Ok::<(), adwave_subdivision::SubdivisionError>(())
/// ```
///
/// # Errors
/// [`SubdivisionError`] if the faces do not form a surface with borders, and on cancellation.
pub fn sharp_edges(
    points: &[[f64; 3]],
    faces: &Polygons,
    degrees: f64,
    progress: Progress<'_>,
) -> Result<Vec<[u32; 2]>, SubdivisionError> {
    let topology = Topology::new(points.len(), faces.clone(), progress)?;
    let normals: Vec<[f64; 3]> = faces.iter().map(|corners| unit_normal(points, corners)).collect();
    let mut edges = Vec::new();
    for (h, &twin) in (0..).zip(&topology.twins) {
        if twin == NONE || twin < h {
            continue;
        }
        let [a, b] = topology.ends(h);
        let cosine = dot(&normals[topology.face(h) as usize], &normals[topology.face(twin) as usize]);
        // Faces of one orientation run along their common edge in opposite directions.
        let cosine = if topology.origin(twin) == a { -cosine } else { cosine };
        if cosine < degrees.to_radians().cos() {
            edges.push([a.min(b), a.max(b)]);
        }
    }
    Ok(edges)
}

/// Unit normal of the area that a face encloses, or 0.
fn unit_normal(points: &[[f64; 3]], corners: &[u32]) -> [f64; 3] {
    let at = |k: usize| subtract(&points[corners[k % corners.len()] as usize], &points[corners[0] as usize]);
    let sum = (0..corners.len()).fold([0.0; 3], |sum, k| add_scaled(&sum, 1.0, &cross(&at(k), &at(k + 1))));
    let length = norm(&sum);
    if length > 0.0 { sum.map(|x| x / length) } else { sum }
}

/// A way to begin a step, and the ways to go on.
struct Branch {
    choice: usize,
    /// Number of levels from here on, with this step.
    n_levels: usize,
    /// Least number of faces of the coarsest mesh that are not quadrilaterals.
    n_others: usize,
    next: Vec<Branch>,
}

/// Ways to begin a step that lead to the most levels, and the reason why there are no more.
struct Branches {
    best: Vec<Branch>,
    obstacle: Obstacle,
}

/// A step, its coarse mesh, and the index of each vertex on it.
type Step = (Coarsening, Topology, Vec<u32>);

/// The chosen branch, and the positions of its coarse mesh.
type Closest = (usize, Option<Vec<[f64; 3]>>);

/// The step of a part that consists of all faces, with one corner of its first face as the coarse vertex.
fn step(
    topology: &Topology,
    choice: usize,
    progress: Progress<'_>,
) -> Result<Result<Step, Obstacle>, SubdivisionError> {
    let mut search = RoleSearch::new(topology, progress);
    if let Some(obstacle) = search.flood(0, choice)? {
        return Ok(Err(obstacle));
    }
    let coarsening = match search.finish() {
        Ok(coarsening) => coarsening,
        Err(obstacle) => return Ok(Err(obstacle)),
    };
    let ranks = coarsening.ranks(topology.n_vertices);
    match coarsening.coarse_topology(&ranks, progress) {
        Ok(coarser) => Ok(Ok((coarsening, coarser, ranks))),
        Err(
            SubdivisionError::RepeatedCorner { vertex, .. } | SubdivisionError::ManyFaces { a: vertex, .. },
        ) => Ok(Err(Obstacle::Degenerate { vertex: coarsening.coarse[vertex as usize] })),
        Err(error) => Err(error),
    }
}

/// Number of faces that are not quadrilaterals.
fn n_others(faces: &Polygons) -> usize {
    faces.iter().filter(|corners| corners.len() != 4).count()
}

/// Follows all ways to coarsen a part.
fn explore(topology: &Topology, level: usize, progress: Progress<'_>) -> Result<Branches, SubdivisionError> {
    let mut found = Branches { best: Vec::new(), obstacle: Obstacle::NoFaces { vertex: 0 } };
    if let Some(corners) = topology.faces.iter().find(|corners| corners.len() != 4) {
        found.obstacle = Obstacle::NotQuad { vertex: corners[0], n_corners: corners.len() };
        return Ok(found);
    }
    if let Some(vertex) = pinched_vertex(topology) {
        found.obstacle = Obstacle::Pinched { vertex };
        return Ok(found);
    }
    for choice in 0..if level < MAX_LEVELS { N_CHOICES } else { 0 } {
        let (coarsening, coarser, _) = match step(topology, choice, progress)? {
            Ok(taken) => taken,
            Err(obstacle) => {
                // The first reason is told, unless a later choice goes on.
                if choice == 0 {
                    found.obstacle = obstacle;
                }
                continue;
            }
        };
        let Branches { best: next, obstacle } = explore(&coarser, level + 1, progress)?;
        let n_levels = 1 + next.first().map_or(0, |branch| branch.n_levels);
        let most = found.best.first().map_or(0, |branch: &Branch| branch.n_levels);
        if n_levels < most {
            continue;
        }
        if n_levels > most {
            found.best.clear();
            found.obstacle = obstacle.renamed(&coarsening.coarse);
        }
        let n_others = next.iter().map(|branch| branch.n_others).min();
        let n_others = n_others.unwrap_or_else(|| n_others_of(&coarser));
        found.best.push(Branch { choice, n_levels, n_others, next });
    }
    Ok(found)
}

fn n_others_of(topology: &Topology) -> usize {
    n_others(&topology.faces)
}

/// A vertex whose faces form several fans.
fn pinched_vertex(topology: &Topology) -> Option<u32> {
    (0..topology.n_vertices as u32).find(|&v| topology.ring(v).count() != topology.n_neighbors(v))
}

/// Choice of each step of a part.
struct Plan {
    choices: Vec<usize>,
    is_ambiguous: bool,
    obstacle: Obstacle,
}

/// Decides how to begin the steps of a part with these positions.
fn plan(
    topology: &Topology,
    points: Option<Vec<[f64; 3]>>,
    corners: BorderCorners,
    progress: Progress<'_>,
) -> Result<Plan, SubdivisionError> {
    let Branches { best, obstacle } = explore(topology, 0, progress)?;
    let mut plan = Plan { choices: Vec::new(), is_ambiguous: false, obstacle };
    let (mut branches, mut points) = (best, points);
    let mut coarse: Option<Topology> = None;
    while !branches.is_empty() {
        plan.is_ambiguous |= branches.len() > 1;
        let may_part = branches.len() > 1 || branches.iter().any(Branch::parts);
        let at = coarse.as_ref().unwrap_or(topology);
        let (chosen, next_points) = match points.take().filter(|_| may_part) {
            Some(points) => closest(at, &branches, &points, corners, progress)?,
            None => ((0..branches.len()).min_by_key(|&k| branches[k].n_others).unwrap_or(0), None),
        };
        points = next_points;
        let branch = branches.swap_remove(chosen);
        plan.choices.push(branch.choice);
        if let Ok((_, coarser, _)) = step(at, branch.choice, progress)? {
            coarse = Some(coarser);
        }
        branches = branch.next;
    }
    Ok(plan)
}

impl Branch {
    /// True if a later step can begin in several ways.
    fn parts(&self) -> bool {
        self.next.len() > 1 || self.next.iter().any(Self::parts)
    }
}

/// The branch that the positions fit best, and the positions of its coarse mesh.
fn closest(
    topology: &Topology,
    branches: &[Branch],
    points: &[[f64; 3]],
    corners: BorderCorners,
    progress: Progress<'_>,
) -> Result<Closest, SubdivisionError> {
    let mut best: Option<(usize, Fit)> = None;
    for (k, branch) in branches.iter().enumerate() {
        let Ok((coarsening, coarser, ranks)) = step(topology, branch.choice, progress)? else { continue };
        let fit = Fit::new(&coarsening, coarser, &ranks, points, corners, progress)?;
        let is_better = best.as_ref().is_none_or(|(other, known)| {
            let key = |k: usize, fit: &Fit| (!fit.is_exact(), branches[k].n_others);
            key(k, &fit).cmp(&key(*other, known)).then(fit.error.total_cmp(&known.error)).is_lt()
        });
        if is_better {
            best = Some((k, fit));
        }
    }
    Ok(best.map_or((0, None), |(k, fit)| (k, Some(fit.coarse))))
}

/// Finds the levels of all parts.
pub(crate) fn search(
    topology: Topology,
    parts: &mut Parts,
    params: &QuadParams<'_>,
    progress: Progress<'_>,
) -> Result<QuadLevels, SubdivisionError> {
    let plans = plan_parts(&topology, parts, params, progress)?;
    let mut names: Vec<u32> = (0..topology.n_vertices as u32).collect();
    let (mut finer, mut topology) = (Vec::new(), topology);
    loop {
        let mut first = vec![NONE; plans.len()];
        for (f, corners) in (0..).zip(topology.faces.iter()) {
            let slot = &mut first[parts.of_vertex[names[corners[0] as usize] as usize] as usize];
            *slot = f.min(*slot);
        }
        let mut roles = RoleSearch::new(&topology, progress);
        let mut is_last = true;
        for (choices, &face) in plans.iter().zip(&first) {
            if let Some(&choice) = choices.get(finer.len()) {
                roles.flood(face, choice)?;
                is_last = false;
            }
        }
        if is_last {
            break;
        }
        let coarsening = roles.finish().map_err(|obstacle| SubdivisionError::NoLevels { obstacle })?;
        let coarse_rank = coarsening.ranks(topology.n_vertices);
        let coarser = coarsening.coarse_topology(&coarse_rank, progress)?;
        names = coarsening.coarse.iter().map(|&v| names[v as usize]).collect();
        finer.push(SearchLevel { topology, coarsening, coarse_rank });
        topology = coarser;
    }
    Ok(QuadLevels { finer, coarsest: topology, names })
}

/// Decides how to begin the steps of each part, and notes the numbers of levels.
fn plan_parts(
    topology: &Topology,
    parts: &mut Parts,
    params: &QuadParams<'_>,
    progress: Progress<'_>,
) -> Result<Vec<Vec<usize>>, SubdivisionError> {
    let n_parts = parts.infos.len();
    let mut vertices_of = vec![Vec::new(); n_parts];
    let mut places = vec![0; topology.n_vertices];
    for (v, &part) in (0..).zip(&parts.of_vertex) {
        places[v as usize] = vertices_of[part as usize].len() as u32;
        vertices_of[part as usize].push(v);
    }
    let mut faces_of = vec![(Polygons::new(), Vec::new()); n_parts];
    for (f, corners) in (0..).zip(topology.faces.iter()) {
        let (faces, sharp) = &mut faces_of[parts.of_vertex[corners[0] as usize] as usize];
        faces.push(&corners.iter().map(|&v| places[v as usize]).collect::<Vec<u32>>());
        if !topology.sharp.is_empty() {
            sharp.extend(&topology.sharp[topology.first(f) as usize..][..corners.len()]);
        }
    }
    let mut plans = Vec::with_capacity(n_parts);
    for (part, (faces, sharp)) in faces_of.into_iter().enumerate() {
        if !parts.active[part] {
            plans.push(Vec::new());
            continue;
        }
        let vertices = &vertices_of[part];
        let mut own = Topology::new(vertices.len(), faces, progress)?;
        own.sharp = sharp;
        let points = params.points.map(|points| vertices.iter().map(|&v| points[v as usize]).collect());
        let Plan { choices, is_ambiguous, obstacle } = plan(&own, points, params.corners, progress)?;
        let info = &mut parts.infos[part];
        info.n_levels = choices.len();
        info.is_ambiguous = is_ambiguous;
        info.obstacle = obstacle.renamed(vertices);
        plans.push(choices);
    }
    Ok(plans)
}
