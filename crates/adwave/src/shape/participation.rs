//! Vertices that take part in the analysis, and the size of the shape that they form.
//!
//! A default length must not depend on vertices that belong to nothing else: a vertex that no face uses, a record
//! without a position that a scanner wrote as `0 0 0`, a height of −9999, a reflection far away. Such vertices keep
//! their place and have no neighbors. The *extent* of a shape is the diagonal of the bounding box of its largest part,
//! so that it does not depend on the layout of the parts either.

use super::{DisjointSets, Neighborhoods, Polygons, box_diagonal, distance, nearest_of_wanted};
use crate::pages::zeros;
use crate::rows::Pattern;
use crate::{Cancelled, Progress, parallel};
use std::convert::Infallible;

/// Values that files write where a coordinate is unknown (raster and terrain formats).
const PLACEHOLDER_VALUES: [f64; 5] = [-9999.0, -99_999.0, -999_999.0, -32_767.0, -32_768.0];

/// Magnitude from which a coordinate is no length: ±3.4028e38, the largest 32-bit float, and 1e20 or 1e30 are
/// written where a value is unknown.
const NO_LENGTH: f64 = 1e19;

/// Smallest number of vertices with a known position for which placeholders are sought: fewer do not show which
/// positions are far away.
const MIN_KNOWN: usize = 16;

/// Share of the values at either end of an axis that may be strays and do not decide where the shape ends.
const TAIL: f64 = 0.01;

/// Number of neighbors by which strays of a cloud are found. A group of more points has all its nearest neighbors
/// among itself, and counts as a part of the shape.
pub const STRAY_NEIGHBORS: usize = 10;

/// Largest distance from a point to a neighbor that it leads to, in distances of that neighbor to its own 10th
/// neighbor. The kernel of the walk is below 1e-20 at half of it, so no point gives anything to another so far away;
/// the density of scans changes by less from point to point.
const MAX_GAP: f64 = 10.0;

/// Share of the vertices of the most populous part that another part needs to decide the extent.
const LEAST_PART: f64 = 0.1;

/// Share of the positions at either end of an axis that the frame of a picture may leave out, if they are far away.
const FRAME_TAIL: f64 = 0.005;

/// Widening of the frame on each side beyond these positions, in widths between them: a normal distribution reaches
/// 3.9 standard deviations then.
const FRAME_MARGIN: f64 = 0.25;

/// Size of the bounding box of all vertices, in sizes of the frame, from which only the frame is shown. Up to that size
/// the shape still fills half of the picture.
const FRAME_GAIN: f64 = 2.0;

/// Number of vertices that a thread processes at a time.
const POINTS_AT_A_TIME: usize = 1 << 14;

/// Reason why a vertex takes no part in the analysis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum VertexRole {
    /// The vertex takes part.
    #[default]
    Member,
    /// No face of the mesh, or edge of the curve, connects it to another vertex.
    Unused,
    /// The position of the vertex stands for an unknown one: a coordinate such as −9999 or −3.4e38 far outside the
    /// others, or `0 0 0` far from everything.
    Placeholder,
    /// A point of a cloud, or one of a few, far from all others.
    Stray,
}

impl VertexRole {
    /// All roles of vertices that take no part.
    pub const OUTSIDE: [Self; 3] = [Self::Placeholder, Self::Stray, Self::Unused];

    /// Plural of the role, as a key.
    pub fn plural(self) -> &'static str {
        match self {
            Self::Member => "members",
            Self::Unused => "unused",
            Self::Placeholder => "placeholders",
            Self::Stray => "strays",
        }
    }

    /// Explanation of the role of `n` vertices, as part of a sentence.
    fn explanation(self, n: usize) -> &'static str {
        match (self, n) {
            (Self::Member, 1) => "vertex that takes part",
            (Self::Member, _) => "vertices that take part",
            (Self::Unused, 1) => "vertex of no face or edge",
            (Self::Unused, _) => "vertices of no face or edge",
            (Self::Placeholder, 1) => "placeholder without a real position",
            (Self::Placeholder, _) => "placeholders without a real position",
            (Self::Stray, 1) => "point far from all others",
            (Self::Stray, _) => "points far from all others",
        }
    }
}

/// Number of rows that a text names.
const NAMED_ROWS: usize = 5;

/// Text on the vertices of one role among `outsiders` ([`PreparedGeometry::outsiders`](super::PreparedGeometry)): how
/// many, which rows (counted from 0), and that they take no part; `None` if there are none.
///
/// ```
/// use adwave::shape::{VertexRole, describe_outsiders};
/// let text = describe_outsiders(&[(7, VertexRole::Stray)], VertexRole::Stray);
/// assert_eq!(text.as_deref(), Some("1 point far from all others (row 7) takes no part and keeps its values"));
/// ```
pub fn describe_outsiders(outsiders: &[(usize, VertexRole)], role: VertexRole) -> Option<String> {
    let rows: Vec<usize> = outsiders.iter().filter(|(_, own)| *own == role).map(|(row, _)| *row).collect();
    let n = rows.len();
    if n == 0 {
        return None;
    }
    let mut named = rows.iter().take(NAMED_ROWS).map(usize::to_string).collect::<Vec<_>>().join(", ");
    if n > NAMED_ROWS {
        named += ", …";
    }
    let (row, end) = if n == 1 {
        ("row", "takes no part and keeps its values")
    } else {
        ("rows", "take no part and keep their values")
    };
    Some(format!("{n} {} ({row} {named}) {end}", role.explanation(n)))
}

/// True if a point leads to one of its [`STRAY_NEIGHBORS`] nearest neighbors: if the `distance` of this neighbor is at
/// most 10 times `radius`, its distance to its own 10th neighbor.
pub fn leads_to(distance: f64, radius: f64) -> bool {
    distance <= MAX_GAP * radius
}

/// True if a point of a cloud leads, step by step from neighbor to neighbor, to at most [`STRAY_NEIGHBORS`] points
/// including itself. `reach(x, found)` appends the neighbors that `x` [`leads_to`]. In a cloud of more points at least
/// one is no stray: the point whose last neighbor is closest.
///
/// # Errors
/// The first error of `reach`.
pub fn is_stray<E>(
    point: u32,
    reach: &mut impl FnMut(u32, &mut Vec<u32>) -> Result<(), E>,
) -> Result<bool, E> {
    let mut group = vec![point];
    let mut found = Vec::new();
    let mut next = 0;
    while next < group.len() {
        found.clear();
        reach(group[next], &mut found)?;
        for &y in &found {
            if !group.contains(&y) {
                group.push(y);
            }
        }
        if group.len() > STRAY_NEIGHBORS {
            return Ok(false);
        }
        next += 1;
    }
    Ok(true)
}

/// Roles and parts of the welded vertices of a shape.
#[derive(Clone, Debug, Default)]
pub(crate) struct Participation {
    /// Roles; empty if all vertices take part.
    pub(super) roles: Vec<VertexRole>,
    /// Connected part of each vertex.
    parts: Vec<u32>,
    n_parts: usize,
}

impl Participation {
    /// Roles in a mesh, whose `faces` lose those with a placeholder as corner.
    ///
    /// `is_used` flags the vertices of faces with two different corners. `at_vertex` has the triangles at each vertex,
    /// if all faces are triangles; it is taken if faces are lost.
    pub(super) fn from_mesh(
        points: &[[f64; 3]],
        faces: &mut Polygons,
        is_used: &[bool],
        at_vertex: &mut Option<Pattern>,
    ) -> Self {
        let n = points.len();
        let role = |&used: &bool| if used { VertexRole::Member } else { VertexRole::Unused };
        let mut roles: Vec<VertexRole> = is_used.iter().map(role).collect();
        if faces.is_empty() {
            return Self { roles: Vec::new(), parts: vec![0; n], n_parts: 1 };
        }
        // A vertex at the origin that faces use may be the tip of a shape.
        if mark_placeholders(points, &mut roles, OriginRule::Ordinary) {
            let is_known = |face: &&[u32]| face.iter().all(|&c| roles[c as usize] == VertexRole::Member);
            *faces = faces.iter().filter(is_known).collect();
            *at_vertex = None;
            let mut is_used = vec![false; n];
            for face in faces.iter().filter(|face| has_side(face)) {
                for &c in face {
                    is_used[c as usize] = true;
                }
            }
            for (role, used) in roles.iter_mut().zip(is_used) {
                if *role == VertexRole::Member && !used {
                    *role = VertexRole::Unused;
                }
            }
        }
        let sets = if let (Some(at_vertex), Some(triangles)) = (&at_vertex, faces.triangles()) {
            DisjointSets::from_triangles(triangles, at_vertex)
        } else {
            let mut sets = DisjointSets::new(n);
            for face in faces.iter() {
                for &c in face {
                    sets.join(face[0], c);
                }
            }
            sets
        };
        Self::new(roles, sets)
    }

    /// Roles in a cloud of different `points`, with the nearest neighbors of those that take part.
    pub(super) fn from_cloud(
        points: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<(Self, Neighborhoods), Cancelled> {
        let mut roles = vec![VertexRole::Member; points.len()];
        mark_placeholders(points, &mut roles, OriginRule::Placeholder);
        let found = Self { roles: roles.clone(), parts: Vec::new(), n_parts: 0 };
        let near = found.nearest(points, STRAY_NEIGHBORS, |_| true, progress)?;
        let reach = |x: u32, found: &mut Vec<u32>| {
            let gap = |y: u32| distance(&points[x as usize], &points[y as usize]);
            let row = near.adjacency.row(x as usize).iter();
            found.extend(row.filter(|&&y| leads_to(gap(y), near.radius[y as usize])));
            Ok::<(), Infallible>(())
        };
        let n_known = roles.iter().filter(|role| **role == VertexRole::Member).count();
        let mut n_strays = 0;
        if n_known > STRAY_NEIGHBORS {
            let is_stray: Vec<bool> = parallel::try_collect(points.len(), progress, |x| {
                let Ok(is_stray) = is_stray(x as u32, &mut { reach });
                roles[x] == VertexRole::Member && is_stray
            })?;
            for (role, is_stray) in roles.iter_mut().zip(is_stray) {
                if is_stray {
                    *role = VertexRole::Stray;
                    n_strays += 1;
                }
            }
        }
        let mut sets = DisjointSets::new(points.len());
        let mut reached = Vec::new();
        for x in 0..points.len() as u32 {
            reached.clear();
            let Ok(()) = reach(x, &mut reached);
            for &y in &reached {
                sets.join(x, y);
            }
        }
        let this = Self::new(roles, sets);
        let near =
            if n_strays == 0 { near } else { this.nearest(points, STRAY_NEIGHBORS, |_| true, progress)? };
        Ok((this, near))
    }

    /// Roles in a curve with the given edges: vertices without edges are unused.
    pub(super) fn from_curve(edges: &Pattern) -> Self {
        let n = edges.n_rows();
        let mut sets = DisjointSets::new(n);
        for x in 0..n {
            for &y in edges.row(x) {
                sets.join(x as u32, y);
            }
        }
        let role = |x: usize| if edges.row(x).is_empty() { VertexRole::Unused } else { VertexRole::Member };
        let roles = if edges.nnz() == 0 { vec![VertexRole::Member; n] } else { (0..n).map(role).collect() };
        Self::new(roles, sets)
    }

    fn new(mut roles: Vec<VertexRole>, mut sets: DisjointSets) -> Self {
        if roles.iter().all(|role| *role == VertexRole::Member) {
            roles = Vec::new();
        }
        if sets.is_one() {
            return Self { roles, parts: zeros(sets.len()), n_parts: 1 };
        }
        let n = sets.len();
        let mut number = vec![u32::MAX; n];
        let mut n_parts = 0;
        let parts = (0..n)
            .map(|x| {
                let root = sets.root(x as u32) as usize;
                if number[root] == u32::MAX {
                    number[root] = n_parts;
                    n_parts += 1;
                }
                number[root]
            })
            .collect();
        Self { roles, parts, n_parts: n_parts as usize }
    }

    /// True if a vertex takes part.
    pub(crate) fn is_member(&self, x: usize) -> bool {
        self.roles.is_empty() || self.roles[x] == VertexRole::Member
    }

    /// Flags of the vertices that take no part; `None` if all do.
    pub(crate) fn outsiders(&self) -> Option<Vec<bool>> {
        let is_out = |role: &VertexRole| *role != VertexRole::Member;
        self.roles.iter().any(is_out).then(|| self.roles.iter().map(is_out).collect())
    }

    /// The `k` nearest neighbors, among the vertices that take part, of those that are wanted; none and radius 0 for the
    /// others.
    pub(crate) fn nearest(
        &self,
        points: &[[f64; 3]],
        k: usize,
        is_wanted: impl Fn(usize) -> bool + Sync + Send,
        progress: Progress<'_>,
    ) -> Result<Neighborhoods, Cancelled> {
        if self.outsiders().is_none() {
            return nearest_of_wanted(points, k, is_wanted, progress);
        }
        let members: Vec<u32> = (0..points.len() as u32).filter(|&x| self.is_member(x as usize)).collect();
        let own: Vec<[f64; 3]> = members.iter().map(|&x| points[x as usize]).collect();
        let near = nearest_of_wanted(&own, k, |i| is_wanted(members[i] as usize), progress)?;
        let (mut offsets, mut columns) = (vec![0_usize; points.len() + 1], Vec::new());
        let mut radius = vec![0.0; points.len()];
        let mut next = 0;
        for x in 0..points.len() {
            if members.get(next) == Some(&(x as u32)) {
                columns.extend(near.adjacency.row(next).iter().map(|&y| members[y as usize]));
                radius[x] = near.radius[next];
                next += 1;
            }
            offsets[x + 1] = columns.len();
        }
        let adjacency = Pattern::new(offsets, columns, points.len()).unwrap_or_else(|e| unreachable!("{e}"));
        Ok(Neighborhoods { adjacency, radius, k: near.k })
    }

    /// Diagonal of the bounding box of all vertices that take part.
    pub(super) fn members_diagonal(&self, points: &[[f64; 3]]) -> f64 {
        if self.roles.is_empty() {
            return super::diagonal(points);
        }
        let members: Vec<[f64; 3]> =
            (0..points.len()).filter(|&x| self.is_member(x)).map(|x| points[x]).collect();
        super::diagonal(&members)
    }

    /// Diagonal of the bounding box of the largest part among those with a tenth of the vertices of the most populous
    /// part, without vertices that take no part or are `masked`; 0 if there are none.
    pub(crate) fn extent(&self, points: &[[f64; 3]], masked: Option<&[bool]>) -> f64 {
        let is_whole = self.n_parts == 1 && self.roles.is_empty() && masked.is_none();
        if self.parts.len() != points.len() || is_whole {
            return super::diagonal(points);
        }
        let mut boxes: Vec<Option<([f64; 3], [f64; 3])>> = vec![None; self.n_parts];
        let mut counts = vec![0_usize; self.n_parts];
        for (x, p) in points.iter().enumerate() {
            if !self.is_member(x) || masked.is_some_and(|masked| masked[x]) {
                continue;
            }
            let part = self.parts[x] as usize;
            counts[part] += 1;
            let (lo, hi) = boxes[part].get_or_insert((*p, *p));
            for c in 0..3 {
                lo[c] = lo[c].min(p[c]);
                hi[c] = hi[c].max(p[c]);
            }
        }
        let least = LEAST_PART * counts.iter().copied().max().unwrap_or(0) as f64;
        let large = boxes.iter().zip(&counts).filter(|(_, count)| **count as f64 >= least);
        large.filter_map(|(bounds, _)| *bounds).map(|(lo, hi)| box_diagonal(&lo, &hi)).fold(0.0, f64::max)
    }

    /// Bounding box of the vertices that a picture should show: all that take part, without the few that are so far
    /// away that the others would fill less than half of it; `None` without vertices.
    pub(crate) fn frame(&self, points: &[[f64; 3]]) -> Option<([f64; 3], [f64; 3])> {
        let members: Vec<[f64; 3]> =
            (0..points.len()).filter(|&x| self.is_member(x)).map(|x| points[x]).collect();
        let all = super::bounding_box(&members)?;
        let mut core = all;
        for c in 0..3 {
            let Some([low, high]) = quantiles(members.iter().map(|p| p[c]).collect(), FRAME_TAIL) else {
                return Some(all);
            };
            let margin = FRAME_MARGIN * (high - low);
            (core.0[c], core.1[c]) = ((low - margin).max(all.0[c]), (high + margin).min(all.1[c]));
        }
        let is_inside = |p: &&[f64; 3]| (0..3).all(|c| (core.0[c]..=core.1[c]).contains(&p[c]));
        let inside: Vec<[f64; 3]> = members.iter().filter(is_inside).copied().collect();
        let Some(shown) = super::bounding_box(&inside) else { return Some(all) };
        Some(if box_diagonal(&all.0, &all.1) > FRAME_GAIN * box_diagonal(&shown.0, &shown.1) {
            shown
        } else {
            all
        })
    }
}

/// Bounding box of the points that a picture should show, among those that are `used` (by a face) or among all: without
/// placeholders, and without the few points that are so far away that the others would fill less than half of the
/// picture. `None` without points. O(n).
///
/// ```
/// use adwave::shape::picture_frame;
/// let mut points: Vec<[f64; 3]> = (0..900).map(|i| [f64::from(i % 30), f64::from(i / 30), 0.0]).collect();
/// points.push([1e6, 0.0, 0.0]);
/// assert_eq!(picture_frame(&points, None), Some(([0.0; 3], [29.0, 29.0, 0.0])));
/// ```
///
/// # Panics
/// Unless there is one flag per point.
pub fn picture_frame(points: &[[f64; 3]], used: Option<&[bool]>) -> Option<([f64; 3], [f64; 3])> {
    let role =
        |x: usize| if used.is_none_or(|used| used[x]) { VertexRole::Member } else { VertexRole::Unused };
    let mut roles: Vec<VertexRole> = (0..points.len()).map(role).collect();
    let origin = if used.is_some() { OriginRule::Ordinary } else { OriginRule::Placeholder };
    mark_placeholders(points, &mut roles, origin);
    Participation { roles, ..Participation::default() }.frame(points)
}

/// True if a face connects two different vertices.
fn has_side(face: &[u32]) -> bool {
    face.iter().any(|&c| c != face[0])
}

/// Meaning of a vertex at the origin that is far from everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OriginRule {
    /// A record without a position, as in clouds.
    Placeholder,
    /// A vertex, such as the tip of a shape that faces lead to.
    Ordinary,
}

/// Range of the coordinates of the vertices whose position is no placeholder in itself. It distinguishes placeholders
/// from positions that happen to have the same value.
///
/// ```
/// use adwave::shape::{KnownRange, OriginRule, may_be_placeholder};
/// let range = KnownRange { low: [0.0, 0.0, 100.0], high: [50.0, 50.0, 120.0] };
/// let hole = [20.0, 30.0, -9999.0];
/// assert!(may_be_placeholder(&hole) && range.is_placeholder(&hole, OriginRule::Ordinary));
/// assert!(range.is_placeholder(&[0.0; 3], OriginRule::Placeholder) && !may_be_placeholder(&[1.0, 0.0, 0.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownRange {
    /// The value below which the share [`TAIL`](Self::TAIL) of each coordinate lies.
    pub low: [f64; 3],
    /// The value above which the share [`TAIL`](Self::TAIL) of each coordinate lies.
    pub high: [f64; 3],
}

/// Returns true for a position that files write where it is unknown: `0 0 0`, or a coordinate such as −9999 or −3.4e38.
/// [`KnownRange::is_placeholder`] decides for these.
pub fn may_be_placeholder(p: &[f64; 3]) -> bool {
    *p == [0.0; 3] || p.iter().any(|&c| is_placeholder_value(c))
}

fn is_placeholder_value(c: f64) -> bool {
    c.abs() >= NO_LENGTH || PLACEHOLDER_VALUES.contains(&c)
}

impl KnownRange {
    /// Share of the values at either end of an axis that may be strays and do not decide where the shape ends.
    pub const TAIL: f64 = TAIL;

    /// Smallest number of vertices for which placeholders are sought; fewer do not show which positions are far away.
    pub const MIN_KNOWN: usize = MIN_KNOWN;

    /// Ranks, from 0, of [`low`](Self::low) and [`high`](Self::high) among `n` > 0 sorted values.
    pub fn ranks(n: usize) -> [usize; 2] {
        let low = (TAIL * (n - 1) as f64).floor() as usize;
        [low, n - 1 - low]
    }

    /// Returns true for a placeholder: a position that [`may_be_placeholder`] and is far outside the range.
    pub fn is_placeholder(&self, p: &[f64; 3], origin: OriginRule) -> bool {
        let Self { low, high } = self;
        // Distance of a value outside the others, beyond their own range.
        let is_outside = |c: usize| {
            let gap = (low[c] - p[c]).max(p[c] - high[c]);
            gap > 0.0 && gap > high[c] - low[c]
        };
        let nearest = std::array::from_fn(|c| p[c].clamp(low[c], high[c]));
        let is_far_origin = origin == OriginRule::Placeholder
            && *p == [0.0; 3]
            && box_diagonal(p, &nearest) > box_diagonal(low, high);
        is_far_origin || (0..3).any(|c| is_placeholder_value(p[c]) && is_outside(c))
    }
}

/// Marks members whose position stands for an unknown one; returns true if there are any.
fn mark_placeholders(points: &[[f64; 3]], roles: &mut [VertexRole], origin: OriginRule) -> bool {
    let is_member = |x: &usize| roles[*x] == VertexRole::Member;
    let suspects = parallel::map_chunks(points.len(), POINTS_AT_A_TIME, |range| {
        range.filter(is_member).filter(|&x| may_be_placeholder(&points[x])).collect::<Vec<usize>>()
    });
    let suspects = suspects.concat();
    if suspects.is_empty() {
        return false;
    }
    let known: Vec<[f64; 3]> =
        (0..points.len()).filter(is_member).map(|x| points[x]).filter(|p| !may_be_placeholder(p)).collect();
    if known.len() < MIN_KNOWN {
        return false;
    }
    let mut range = KnownRange { low: [0.0; 3], high: [0.0; 3] };
    for c in 0..3 {
        let Some([low, high]) = quantiles(known.iter().map(|p| p[c]).collect(), TAIL) else { return false };
        (range.low[c], range.high[c]) = (low, high);
    }
    let mut is_any = false;
    for x in suspects {
        if range.is_placeholder(&points[x], origin) {
            roles[x] = VertexRole::Placeholder;
            is_any = true;
        }
    }
    is_any
}

/// Values below and above which the share `tail` of them lies; `None` for no values.
fn quantiles(mut values: Vec<f64>, tail: f64) -> Option<[f64; 2]> {
    let n = values.len();
    if n == 0 {
        return None;
    }
    let low = (tail * (n - 1) as f64).floor() as usize;
    let mut at = |k: usize| *values.select_nth_unstable_by(k, f64::total_cmp).1;
    Some([at(low), at(n - 1 - low)])
}
