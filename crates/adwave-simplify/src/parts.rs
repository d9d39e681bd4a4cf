//! Collapses in parts of a large mesh, at the same time and in memory that stays in the caches.
//!
//! The cheapest collapse may be anywhere, so that one queue over a whole mesh waits for memory at nearly every step.
//! Here the positions are divided at medians into parts. A part has the faces whose corners are all in it. Positions
//! with other faces form its rim, which stays as it is: a collapse of inner positions is then the same, and is allowed
//! under the same conditions, as in the whole mesh. Faces that take part in proofs for triangles of several parts
//! (`certificate`) stay as well.
//!
//! A stage collapses all parts up to the same cost, round by round, until a share of the vertices is left. The next one
//! divides the mesh at other places. In the end one queue over the whole mesh collapses what is left, to the number
//! asked for. The parts depend on the mesh alone, so that the result does not depend on the number of threads.

use crate::certificate::{Certificates, Cover, Original};
use crate::collapse::Collapser;
use crate::colors::WedgeColors;
use crate::connectivity::{Connectivity, REMOVED, Turning};
use crate::geometry::Point;
use crate::quadric::Quadric;
use crate::surface::TriangleSurface;
use crate::wedges::Wedges;
use adwave::{Cancelled, Progress};
use rayon::prelude::*;

/// Number of vertices up to which a mesh is not divided.
const UNDIVIDED: usize = 1 << 17;

/// Largest number of positions of a part. Its state takes about 5 MB.
const PART: usize = 1 << 14;

/// Least number of parts while proofs are kept, whose work grows as the faces do.
const PROVEN_PARTS: usize = 16;

/// Number of vertices below which proofs are left to one queue.
const UNDIVIDED_PROOFS: usize = 1 << 13;

/// Vertices that the parts leave, relative to the number asked for.
const LEFT_OVER: f64 = 1.2;

/// Largest ratio of the numbers of vertices before and after a stage.
const GREATEST_RATIO: usize = 8;

/// The same while proofs are kept.
const GREATEST_PROVEN_RATIO: usize = 4;

/// Shares at which a stage divides; the next stage divides at others, so that rims move.
const CUTS: [f64; 3] = [0.5, 0.4, 0.6];

/// Share of the listed collapses, cheapest first, whose greatest cost limits a round.
const ROUND: f64 = 0.5;

/// Marker of what is in no part.
const NONE: u32 = u32::MAX;

/// Mesh between two stages of its collapses.
pub(crate) struct PartlyCollapsed {
    /// Wedges of each face of the original as it is now, or [`REMOVED`].
    pub(crate) faces: Vec<[u32; 3]>,
    /// Positions that are left, with their quadrics; `None` before the first collapse.
    pub(crate) quadrics: Option<Vec<(u32, Quadric)>>,
    /// Covers of the faces of the original, while proofs are kept.
    pub(crate) covers: Vec<Cover>,
    /// Number of vertices.
    pub(crate) n_vertices: usize,
}

/// Largest distance between the surfaces, and what its proof needs.
#[derive(Clone, Copy)]
pub(crate) struct DistanceLimit<'a> {
    pub(crate) surface: &'a TriangleSurface,
    pub(crate) charts: &'a [u32],
    pub(crate) limit: f64,
}

/// Input of the collapses of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct CollapseInput<'a> {
    pub(crate) wedges: &'a Wedges,
    pub(crate) colors: Option<&'a WedgeColors>,
    /// Importance of each position.
    pub(crate) importance: Option<&'a [f64]>,
    pub(crate) keeps_borders: bool,
    pub(crate) limit: Option<DistanceLimit<'a>>,
    pub(crate) progress: Progress<'a>,
}

/// Faces of the mesh, and the triangles of the original that they cover, with numbers of their own.
struct PartMesh {
    /// Wedges of both, without triangles.
    wedges: Wedges,
    /// Triangles of the original.
    originals: Vec<[u32; 3]>,
    /// Number in the whole mesh of each face, triangle of the original, wedge and position.
    face_names: Vec<u32>,
    original_names: Vec<u32>,
    wedge_names: Vec<u32>,
    position_names: Vec<u32>,
    colors: Option<WedgeColors>,
    importance: Option<Vec<f64>>,
    charts: Vec<u32>,
    face_charts: Vec<u32>,
}

/// A part, and its faces over its wedges.
type PartWithFaces = (PartMesh, Vec<[u32; 3]>);

/// Division of a mesh.
struct Division {
    /// Faces of each part.
    faces: Vec<Vec<u32>>,
    /// Triangles of the original of each part, while proofs are kept.
    originals: Vec<Vec<u32>>,
    /// True for positions that stay.
    is_rim: Vec<bool>,
}

impl<'a> CollapseInput<'a> {
    /// The mesh before any collapse.
    pub(crate) fn start(&self, n_vertices: usize) -> PartlyCollapsed {
        let faces = self.wedges.triangles.clone();
        let n_covers = if self.limit.is_some() { faces.len() as u32 } else { 0 };
        PartlyCollapsed {
            faces,
            quadrics: None,
            covers: (0..n_covers).map(Cover::single).collect(),
            n_vertices,
        }
    }

    /// Prepares the collapses of the whole mesh. O(faces log faces).
    pub(crate) fn collapser(&self, mesh: PartlyCollapsed) -> Result<Collapser<'a>, Cancelled> {
        let connectivity = self.connectivity(self.wedges, mesh.faces)?;
        let quadrics = match mesh.quadrics {
            Some(known) => self.all_quadrics(&known),
            None => connectivity.quadrics(self.importance, self.progress)?,
        };
        let certificates = self.limit.map(|DistanceLimit { surface, charts, limit }| {
            let (points, triangles) = (&self.wedges.points, &self.wedges.triangles);
            let (names, face_charts, colors) = (None, charts, self.colors);
            let original = Original { points, triangles, names, charts, face_charts, surface, colors };
            Certificates::new(original, limit, mesh.covers)
        });
        Ok(Collapser::new(connectivity, quadrics, self.colors, certificates))
    }

    /// Quadrics of all positions, zeros for those that are not listed.
    fn all_quadrics(&self, listed: &[(u32, Quadric)]) -> Vec<Quadric> {
        let mut quadrics = vec![Quadric::default(); self.wedges.n_positions()];
        for &(x, quadric) in listed {
            quadrics[x as usize] = quadric;
        }
        quadrics
    }

    fn connectivity(&self, wedges: &Wedges, faces: Vec<[u32; 3]>) -> Result<Connectivity, Cancelled> {
        let mut connectivity = Connectivity::new(wedges, faces, self.progress)?;
        if self.keeps_borders {
            connectivity.fix_borders();
        }
        Ok(connectivity)
    }

    /// Collapses a large mesh in parts, until one queue should do the rest. `n_left` is the number of vertices asked
    /// for; without it, all collapses that keep the largest distance are made. O(n log n).
    pub(crate) fn collapse_in_parts(
        &self,
        mut mesh: PartlyCollapsed,
        n_left: Option<usize>,
    ) -> Result<PartlyCollapsed, Cancelled> {
        let n_first = mesh.n_vertices;
        let (ratio, undivided) = match self.limit {
            Some(_) => (GREATEST_PROVEN_RATIO, UNDIVIDED_PROOFS),
            None => (GREATEST_RATIO, UNDIVIDED),
        };
        let least = n_left.map_or(0, |n| (LEFT_OVER * n as f64) as usize);
        let progress = StageProgress { progress: self.progress, n_first, n_left: n_left.unwrap_or(0) };
        for cut in CUTS.into_iter().cycle() {
            let before = mesh.n_vertices;
            let target = least.max(before / ratio);
            if n_first <= UNDIVIDED || before <= undivided || 2 * target > before {
                break;
            }
            self.collapse_once(&mut mesh, target, cut, progress)?;
            if mesh.n_vertices > before - before / 4 {
                break;
            }
        }
        Ok(mesh)
    }

    /// Divides the mesh, and collapses all parts until about `target` vertices are left.
    fn collapse_once(
        &self,
        mesh: &mut PartlyCollapsed,
        target: usize,
        cut: f64,
        progress: StageProgress<'_>,
    ) -> Result<(), Cancelled> {
        let Division { faces, originals, is_rim } = self.divide(mesh, cut)?;
        let mut number = vec![NONE; if self.limit.is_some() { mesh.faces.len() } else { 0 }];
        if self.limit.is_some() {
            for (k, &t) in faces.iter().flat_map(|list| (0..).zip(list)) {
                number[t as usize] = k;
            }
        }
        let (parts, triangles): (Vec<_>, Vec<_>) =
            self.extract(&mesh.faces, faces, originals)?.into_iter().unzip();
        let inner = |(part, faces): (&PartMesh, &Vec<_>)| part.n_inner_vertices(faces, &is_rim);
        let mut left: Vec<usize> = parts.par_iter().zip(&triangles).map(inner).collect();
        let known = mesh.quadrics.take();
        let all_known = known.as_ref().map(|known| self.all_quadrics(known));
        let mut covers: Vec<Vec<Cover>> = Vec::with_capacity(parts.len());
        for part in &parts {
            let take = |t: &u32| std::mem::replace(&mut mesh.covers[*t as usize], Cover::single(NONE));
            covers.push(part.original_names.iter().map(take).collect());
        }
        let start = |((part, faces), covers): ((_, _), Vec<Cover>)| {
            let covers = covers.into_iter().map(|cover| cover.renumbered(&number)).collect();
            self.start_part(part, faces, &is_rim, all_known.as_deref(), covers)
        };
        let states = parts.par_iter().zip(triangles).zip(covers);
        let mut collapsers: Vec<Collapser<'_>> = states.map(start).collect::<Result<_, _>>()?;
        drop((number, all_known));
        let n_inner: usize = left.iter().sum();
        let n_others = mesh.n_vertices - n_inner;
        // The rims will be as coarse as the rest in the end.
        let target = (target as f64 * n_inner as f64 / mesh.n_vertices as f64) as usize;
        loop {
            let n_left: usize = left.iter().sum();
            progress.step(n_others + n_left)?;
            let (highest, shares) = plan_round(&collapsers, n_left.saturating_sub(target));
            if shares.iter().all(|share| *share == 0) {
                break;
            }
            let states = collapsers.par_iter_mut().zip(&parts).zip(left.par_iter_mut().zip(&shares));
            states.try_for_each(|((collapser, part), (left, share))| {
                let to = left.saturating_sub(*share);
                *left = collapser.run(*left, to, highest, &part.wedges.vertex, self.progress.quiet())?;
                Ok::<_, Cancelled>(())
            })?;
        }
        let mut quadrics = known.map_or_else(|| self.rim_quadrics(&mesh.faces, &is_rim), Ok)?;
        quadrics.retain(|(x, _)| is_rim[*x as usize]);
        mesh.gather(parts.iter().zip(collapsers), &is_rim, quadrics);
        mesh.n_vertices = n_others + left.iter().sum::<usize>();
        Ok(())
    }

    /// Divides the positions of the faces that are left, at the share `cut` of each side. O(n log n).
    fn divide(&self, mesh: &PartlyCollapsed, cut: f64) -> Result<Division, Cancelled> {
        let position = |wedge: u32| self.wedges.position[wedge as usize] as usize;
        let left = || (0..).zip(&mesh.faces).filter(|(_, face)| face[0] != REMOVED);
        let mut part_of = vec![NONE; self.wedges.n_positions()];
        for &wedge in left().flat_map(|(_, face)| face) {
            part_of[position(wedge)] = wedge;
        }
        let used = (0..).zip(&part_of).filter(|(_, wedge)| **wedge != NONE);
        let mut points: Vec<(Point, u32)> =
            used.map(|(x, &wedge)| (self.wedges.points[wedge as usize], x)).collect();
        self.progress.check()?;
        let most = match self.limit {
            Some(_) => PART.min(points.len().div_ceil(PROVEN_PARTS)),
            None => PART,
        };
        let cells = bisect(&mut points, most, cut);
        self.progress.check()?;
        for (part, cell) in (0..).zip(&cells) {
            for &x in cell {
                part_of[x as usize] = part;
            }
        }
        let mut faces = vec![Vec::new(); cells.len()];
        let mut is_rim = vec![false; part_of.len()];
        let part_of_face = |face: [u32; 3]| {
            let [a, b, c] = face.map(|wedge| part_of[position(wedge)]);
            if a == b && b == c { a } else { NONE }
        };
        for (t, &face) in left() {
            match part_of_face(face) {
                NONE => face.into_iter().for_each(|wedge| is_rim[position(wedge)] = true),
                part => faces[part as usize].push(t),
            }
        }
        let mut originals = vec![Vec::new(); cells.len()];
        let is_removed = |face: u32| mesh.faces[face as usize][0] == REMOVED;
        // A face that was removed with its other side covered what the other side did.
        let covers = (0..).zip(&mesh.covers).filter(|(_, cover)| !cover.faces().any(is_removed));
        for (t, cover) in covers {
            let part_of_cover = |face: u32| part_of_face(mesh.faces[face as usize]);
            let part = cover.faces().map(part_of_cover).reduce(|a, b| if a == b { a } else { NONE });
            match part {
                None | Some(NONE) => {
                    let corners = cover.faces().flat_map(|face| mesh.faces[face as usize]);
                    corners.for_each(|wedge| is_rim[position(wedge)] = true);
                }
                Some(part) => originals[part as usize].push(t),
            }
        }
        Ok(Division { faces, originals, is_rim })
    }

    /// Numbers the wedges and the positions of each part in their order; also returns the faces. O(n log n).
    fn extract(
        &self,
        faces: &[[u32; 3]],
        lists: Vec<Vec<u32>>,
        originals: Vec<Vec<u32>>,
    ) -> Result<Vec<PartWithFaces>, Cancelled> {
        let mesh = |number: &mut Vec<u32>, (face_names, original_names): (Vec<u32>, Vec<u32>)| {
            self.progress.check()?;
            let face = |t: &u32| faces[*t as usize];
            let original = |t: &u32| self.wedges.triangles[*t as usize];
            let corners = face_names.iter().map(face).chain(original_names.iter().map(original)).flatten();
            let mut wedge_names = Vec::new();
            for wedge in corners {
                if number[wedge as usize] == NONE {
                    number[wedge as usize] = 0;
                    wedge_names.push(wedge);
                }
            }
            wedge_names.sort_unstable();
            for (k, &wedge) in (0..).zip(&wedge_names) {
                number[wedge as usize] = k;
            }
            let numbered = |t: [u32; 3]| t.map(|wedge| number[wedge as usize]);
            let triangles = face_names.iter().map(face).map(numbered).collect();
            let originals = original_names.iter().map(original).map(numbered).collect();
            for &wedge in &wedge_names {
                number[wedge as usize] = NONE;
            }
            Ok((self.part_mesh(originals, [face_names, original_names, wedge_names]), triangles))
        };
        let numbers = || vec![NONE; self.wedges.points.len()];
        lists.into_par_iter().zip(originals).map_init(numbers, mesh).collect()
    }

    /// The part with the given triangles of the original, and with the numbers in the whole mesh of its faces, of these
    /// triangles and of its wedges.
    fn part_mesh(
        &self,
        originals: Vec<[u32; 3]>,
        [face_names, original_names, wedge_names]: [Vec<u32>; 3],
    ) -> PartMesh {
        let mut position_names: Vec<u32> = Vec::new();
        let mut position = Vec::with_capacity(wedge_names.len());
        for &wedge in &wedge_names {
            let at = self.wedges.position[wedge as usize];
            if position_names.last() != Some(&at) {
                position_names.push(at);
            }
            position.push(position_names.len() as u32 - 1);
        }
        let of = |wedge: &u32| *wedge as usize;
        let wedges = Wedges {
            points: wedge_names.iter().map(|wedge| self.wedges.points[of(wedge)]).collect(),
            position,
            vertex: wedge_names.iter().map(|wedge| self.wedges.vertex[of(wedge)]).collect(),
            triangles: Vec::new(),
            corners: Vec::new(),
            unit: self.wedges.unit,
            n_left_out: 0,
        };
        let importance = self.importance.map(|of| position_names.iter().map(|&x| of[x as usize]).collect());
        let colors = self.colors.map(|colors| colors.select(&wedge_names));
        let charts_of = |names: &[u32]| match self.limit {
            Some(DistanceLimit { charts, .. }) => names.iter().map(|&t| charts[t as usize]).collect(),
            None => Vec::new(),
        };
        let (charts, face_charts) = (charts_of(&original_names), charts_of(&face_names));
        PartMesh {
            wedges,
            originals,
            face_names,
            original_names,
            wedge_names,
            position_names,
            colors,
            importance,
            charts,
            face_charts,
        }
    }

    /// Lists the collapses of a part. `known` has the quadrics of the positions of the mesh.
    fn start_part<'b>(
        &self,
        part: &'b PartMesh,
        faces: Vec<[u32; 3]>,
        is_rim: &[bool],
        known: Option<&[Quadric]>,
        covers: Vec<Cover>,
    ) -> Result<Collapser<'b>, Cancelled>
    where
        'a: 'b,
    {
        let mut connectivity = self.connectivity(&part.wedges, faces)?;
        let names = (0..).zip(&part.position_names);
        connectivity.set_rim(names.filter(|(_, name)| is_rim[**name as usize]).map(|(x, _)| x));
        let quadrics = match known {
            Some(known) => part.position_names.iter().map(|&x| known[x as usize]).collect(),
            None => connectivity.quadrics(part.importance.as_deref(), self.progress)?,
        };
        let colors = part.colors.as_ref();
        let certificates = self.limit.map(|DistanceLimit { surface, limit, .. }| {
            let (points, triangles) = (&part.wedges.points, &part.originals);
            let (charts, face_charts) = (&part.charts, &part.face_charts);
            let names = Some(&*part.original_names);
            let original = Original { points, triangles, names, charts, face_charts, surface, colors };
            Certificates::new(original, limit, covers)
        });
        let mut collapser = Collapser::new(connectivity, quadrics, colors, certificates);
        collapser.start(Turning::Limited, self.progress.quiet())?;
        Ok(collapser)
    }

    /// Quadrics of the positions at rims before any collapse. O(faces at rims).
    fn rim_quadrics(&self, faces: &[[u32; 3]], is_rim: &[bool]) -> Result<Vec<(u32, Quadric)>, Cancelled> {
        let at_rim = |wedge: &u32| is_rim[self.wedges.position[*wedge as usize] as usize];
        let left = (0..).zip(faces).filter(|(_, face)| face[0] != REMOVED && face.iter().any(at_rim));
        let parts = self.extract(faces, vec![left.map(|(t, _)| t).collect()], vec![Vec::new()])?;
        let mut quadrics = Vec::new();
        for (part, faces) in parts {
            let connectivity = Connectivity::new(&part.wedges, faces, self.progress)?;
            let found = connectivity.quadrics(part.importance.as_deref(), self.progress)?;
            quadrics.extend(part.position_names.into_iter().zip(found));
        }
        Ok(quadrics)
    }
}

impl PartlyCollapsed {
    /// Takes over what the parts have become. `quadrics` are those of the rims.
    fn gather<'b>(
        &mut self,
        parts: impl Iterator<Item = (&'b PartMesh, Collapser<'b>)>,
        is_rim: &[bool],
        mut quadrics: Vec<(u32, Quadric)>,
    ) {
        for (part, collapser) in parts {
            for &t in &part.face_names {
                self.faces[t as usize] = [REMOVED; 3];
            }
            let (triangles, origins) = collapser.connectivity.triangles();
            for (triangle, origin) in triangles.into_iter().zip(origins) {
                let name = part.face_names[origin as usize];
                self.faces[name as usize] = triangle.map(|wedge| part.wedge_names[wedge as usize]);
            }
            let positions = part.position_names.iter().zip(collapser.quadrics).zip(0..);
            let inner = positions.filter(|((x, _), k)| {
                !is_rim[**x as usize] && !collapser.connectivity.around[*k as usize].is_empty()
            });
            quadrics.extend(inner.map(|((&x, quadric), _)| (x, quadric)));
            let found = collapser.certificates.map_or_else(Vec::new, Certificates::into_covers);
            for (&t, cover) in part.original_names.iter().zip(found) {
                self.covers[t as usize] = cover.renumbered(&part.face_names);
            }
        }
        self.quadrics = Some(quadrics);
    }
}

impl PartMesh {
    /// Counts the vertices of the faces that are not at the rim.
    fn n_inner_vertices(&self, faces: &[[u32; 3]], is_rim: &[bool]) -> usize {
        let Wedges { position, vertex, .. } = &self.wedges;
        let at_rim = |wedge: u32| is_rim[self.position_names[position[wedge as usize] as usize] as usize];
        let inner = faces.as_flattened().iter().filter(|wedge| !at_rim(**wedge));
        let mut vertices: Vec<u32> = inner.map(|&wedge| vertex[wedge as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices.len()
    }
}

/// Progress of all stages together.
#[derive(Clone, Copy)]
struct StageProgress<'a> {
    progress: Progress<'a>,
    n_first: usize,
    n_left: usize,
}

impl StageProgress<'_> {
    /// Reports the number of vertices that are left.
    fn step(&self, n: usize) -> Result<(), Cancelled> {
        self.progress.step((self.n_first - n) as u64, (self.n_first - self.n_left) as u64)
    }
}

/// Cost up to which all parts collapse in the next round, and the number of vertices that each may lose, `budget` in
/// all.
fn plan_round(collapsers: &[Collapser<'_>], budget: usize) -> (f32, Vec<usize>) {
    let mut costs: Vec<f32> = collapsers.iter().flat_map(Collapser::costs).collect();
    if costs.is_empty() {
        return (0.0, vec![0; collapsers.len()]);
    }
    let k = (costs.len() as f64 * ROUND) as usize;
    let highest = *costs.select_nth_unstable_by(k, f32::total_cmp).1;
    let cheap = |collapser: &Collapser<'_>| collapser.costs().filter(|cost| *cost <= highest).count();
    let cheap: Vec<usize> = collapsers.par_iter().map(cheap).collect();
    let all: usize = cheap.iter().sum();
    (highest, cheap.iter().map(|&n| (budget as u128 * n as u128 / all as u128) as usize).collect())
}

/// Divides points along the longest side of their bounding box, the share `cut` of them to one side, into cells of at
/// most `most` points, and lists the numbers of each. O(n log n).
fn bisect(points: &mut [(Point, u32)], most: usize, cut: f64) -> Vec<Vec<u32>> {
    if points.len() <= most {
        return vec![points.iter().map(|(_, x)| *x).collect()];
    }
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for (p, _) in points.iter() {
        low = std::array::from_fn(|c| low[c].min(p[c]));
        high = std::array::from_fn(|c| high[c].max(p[c]));
    }
    let side = |c: usize| high[c] - low[c];
    let axis = (1..3).fold(0, |best, c| if side(c) > side(best) { c } else { best });
    let middle = (points.len() as f64 * cut) as usize;
    points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (first, second) = points.split_at_mut(middle);
    let (mut cells, others) = rayon::join(|| bisect(first, most, cut), || bisect(second, most, cut));
    cells.extend(others);
    cells
}
