//! Normals that a file gives to the points of a cloud, and a check that their signs mean a side of the surface.
//!
//! Scanners and meshes give normals that point to one side. The normals of plane fits have the right axis and an
//! arbitrary sign. All code that uses the sign of given normals takes them from here.

use super::orientation::{EdgeOrientation, Enclosure, orient};
use super::sheets::{OPPOSITE, are_sheets_apart};
use super::{DisjointSets, Neighborhoods};
use crate::vector::{dot, unit};
use crate::{Cancelled, Progress};
use nalgebra::Vector3;

/// Smallest cosine between a normal and the reflection of its neighbor's normal for which the pair shows whether both
/// are on one side.
const CLEAR: f64 = 0.5;

/// Mean squared cosine between normals and the line between their points above which the line leads across the surface;
/// it is 0.5 across the edge of a box.
const ACROSS: f64 = 0.55;

/// Share of the points of a part that neighbors on one side must join for the part to count as oriented.
const JOINED: f64 = 0.999;

/// Share of the points whose given normals must point to one side for it to count as the intended side.
const MEANT: f64 = 0.9;

/// Use of the signs of given normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NormalSigns {
    /// Neighbors agree: the normals are used as they are.
    AsGiven,
    /// Most neighbors agree: the others were turned over.
    Repaired,
    /// Neighbors do not agree: only the axes are used, and the sides are those of normals without signs.
    Unoriented,
}

/// Consistency of given normals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NormalCheck {
    /// Use of the signs.
    pub signs: NormalSigns,
    /// Share of the pairs of neighbors whose given normals are on one side, in [0, 1]; 1 without pairs.
    pub agreement: f64,
    /// Number of welded points whose normals were turned over.
    pub n_turned: usize,
    /// Number of connected parts.
    pub n_parts: usize,
    /// Number of closed parts whose normals point inward, if the side is that of the given normals.
    pub n_inward: usize,
}

impl NormalCheck {
    /// Describes deviations of the normals; `None` if they are used as given and none points inward.
    pub fn describe(&self) -> Option<String> {
        let agreement = 100.0 * self.agreement;
        let turned = match self.n_turned {
            1 => "1 was".to_owned(),
            n => format!("{n} were"),
        };
        let found = match self.signs {
            NormalSigns::AsGiven => String::new(),
            NormalSigns::Repaired => format!(
                "the given normals are on one side for {agreement:.1} % of the neighbors; {turned} turned over to their neighbors' side"
            ),
            NormalSigns::Unoriented => format!(
                "the given normals are not oriented ({agreement:.0} % of the neighbors are on one side); their signs are ignored and \
                 found from the points"
            ),
        };
        let inward = match (self.n_inward, self.n_parts) {
            (0, _) => String::new(),
            (1, 1) => "the given normals point inward, into the closed surface, and are used so".to_owned(),
            (n, parts) => format!(
                "the given normals of {n} of {parts} parts point inward, into a closed surface, and are used so"
            ),
        };
        match (found.is_empty(), inward.is_empty()) {
            (true, true) => None,
            (false, true) => Some(found),
            (true, false) => Some(inward),
            (false, false) => Some(format!("{found}; {inward}")),
        }
    }
}

/// Given normals of a cloud with consistent signs where the points allow it.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenNormals {
    /// Unit normals at the points; zero where none is given.
    pub normals: Vec<[f64; 3]>,
    /// Findings, and the use of the signs.
    pub check: NormalCheck,
    /// True if neighbors with opposite normals lie on other sheets of the cloud.
    pub(super) are_sheets_apart: bool,
}

impl GivenNormals {
    /// Checks and orients the given `normals`, of any length and zero or NaN where there is none; `None` if there are
    /// none at all. O(n k), with O(n k log n) if neighbors disagree.
    ///
    /// Neighbors agree if the reflection of one normal in the plane half-way between the points has a positive product
    /// with the other. The normals are oriented if the pairs that agree connect 99.9 % of the points of the parts that
    /// all pairs connect. Where sheets are closer than points, neighbors with opposite normals lie on other sheets and
    /// do not count. Otherwise the axes are oriented along a spanning tree, unless that violates as many pairs as the
    /// given signs.
    ///
    /// # Errors
    /// [`Cancelled`] if the call is cancelled.
    ///
    /// # Panics
    /// Unless there are one normal and one neighborhood per point.
    ///
    /// ```
    /// use adwave::Progress;
    /// use adwave::sample::Sample;
    /// use adwave::shape::{GivenNormals, NormalSigns, nearest_neighbors};
    /// let points = Sample::from_name("sphere", Some(2000))?.points;
    /// let near = nearest_neighbors(&points, 10);
    /// // The points of the unit sphere are its normals; every second one is turned over.
    /// let every_second = |k: usize, p: [f64; 3]| if k % 2 == 0 { p } else { p.map(|c| -c) };
    /// let given: Vec<_> = points.iter().enumerate().map(|(k, p)| every_second(k, *p)).collect();
    /// let found = GivenNormals::new(&points, &near, &given, Progress::none())?.unwrap();
    /// assert_eq!(found.check.signs, NormalSigns::Unoriented);
    /// let out = |(n, p): (&[f64; 3], &[f64; 3])| n[0] * p[0] + n[1] * p[1] + n[2] * p[2] > 0.9;
    /// assert!(found.normals.iter().zip(&points).all(out));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        points: &[[f64; 3]],
        near: &Neighborhoods,
        normals: &[[f64; 3]],
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        Self::from_sides(points, near, normals, false, progress)
    }

    /// [`new`](Self::new), with signs that are certain if `are_sides_known`.
    pub(super) fn from_sides(
        points: &[[f64; 3]],
        near: &Neighborhoods,
        normals: &[[f64; 3]],
        are_sides_known: bool,
        progress: Progress<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        assert_eq!(points.len(), normals.len(), "a normal for each point");
        assert_eq!(points.len(), near.adjacency.n_rows(), "a neighborhood for each point");
        let given: Vec<Vector3<f64>> = normals.iter().map(|n| unit_normal(*n).into()).collect();
        if given.iter().all(|n| *n == Vector3::zeros()) {
            return Ok(None);
        }
        let units: Vec<[f64; 3]> = given.iter().map(|n| (*n).into()).collect();
        let are_sheets_apart = are_sides_known || are_sheets_apart(points, &units, near);
        let pairs = Pairs { points, near, are_sheets_apart };
        let found = pairs.count(&given, progress)?;
        let mut check = NormalCheck {
            signs: NormalSigns::AsGiven,
            agreement: found.agreement(),
            n_turned: 0,
            n_parts: found.parts.len(),
            n_inward: 0,
        };
        let mut normals = given.clone();
        if !found.is_joined && !are_sheets_apart {
            let joined = near.adjacency.union_with_transpose(progress)?;
            let mut oriented = given.clone();
            orient(points, &joined, &near.radius, &mut oriented, progress)?;
            if pairs.count(&oriented, progress)?.n_against < found.n_against {
                check.signs = follow_side(&given, &mut oriented, &found.parts);
                normals = oriented;
                check.n_turned = (0..normals.len()).filter(|&x| normals[x].dot(&given[x]) < 0.0).count();
            }
        }
        if check.signs != NormalSigns::Unoriented {
            let is_inward =
                |part: &&Vec<u32>| Enclosure::new(points, &near.radius, part, &normals).is_inward();
            check.n_inward = found.parts.iter().filter(is_inward).count();
        }
        let normals = normals.into_iter().map(Into::into).collect();
        Ok(Some(Self { normals, check, are_sheets_apart }))
    }
}

/// Turns parts to the side of most of their given normals, if these mean one.
fn follow_side(given: &[Vector3<f64>], oriented: &mut [Vector3<f64>], parts: &[Vec<u32>]) -> NormalSigns {
    let (mut n_meant, mut n_all) = (0, 0);
    for part in parts {
        let with_normal = part.iter().filter(|&&x| given[x as usize] != Vector3::zeros());
        let (mut n, mut n_alike) = (0_usize, 0_usize);
        for &x in with_normal {
            n += 1;
            n_alike += usize::from(given[x as usize].dot(&oriented[x as usize]) > 0.0);
        }
        let is_meant = n_alike.max(n - n_alike) as f64 >= MEANT * n as f64;
        n_all += n;
        n_meant += if is_meant { n } else { 0 };
        if is_meant && 2 * n_alike < n {
            for &x in part {
                oriented[x as usize] = -oriented[x as usize];
            }
        }
    }
    if n_meant as f64 >= MEANT * n_all as f64 { NormalSigns::Repaired } else { NormalSigns::Unoriented }
}

/// Pairs of neighbors that show whether their normals are on one side.
struct Pairs<'a> {
    points: &'a [[f64; 3]],
    near: &'a Neighborhoods,
    are_sheets_apart: bool,
}

/// Agreement of the normals of neighbors.
struct PairCount {
    n_pairs: usize,
    n_against: usize,
    /// Points that pairs connect, whether they agree or not, in ascending order; points without normal are left out.
    parts: Vec<Vec<u32>>,
    /// True if pairs that agree connect nearly all points of the parts.
    is_joined: bool,
}

impl PairCount {
    fn agreement(&self) -> f64 {
        if self.n_pairs == 0 { 1.0 } else { 1.0 - self.n_against as f64 / self.n_pairs as f64 }
    }
}

impl Pairs<'_> {
    /// True if two normals are on one side, false if they are on different sides; `None` if the pair does not show it.
    fn compare(&self, normals: &[Vector3<f64>], x: usize, y: usize) -> Option<bool> {
        let (n, m) = (&normals[x], &normals[y]);
        if self.are_sheets_apart && n.dot(m) < OPPOSITE {
            return None;
        }
        let way = EdgeOrientation::new([&self.points[x], &self.points[y]], [n, m]);
        (way.across <= ACROSS && way.alike.abs() >= CLEAR).then_some(way.alike > 0.0)
    }

    fn count(&self, normals: &[Vector3<f64>], progress: Progress<'_>) -> Result<PairCount, Cancelled> {
        let n = normals.len();
        let (mut all, mut agreeing) = (DisjointSets::new(n), DisjointSets::new(n));
        let (mut n_pairs, mut n_against) = (0, 0);
        for x in 0..n {
            if x % (1 << 14) == 0 {
                progress.check()?;
            }
            for &y in self.near.adjacency.row(x) {
                let Some(agrees) = self.compare(normals, x, y as usize) else { continue };
                n_pairs += 1;
                all.join(x as u32, y);
                if agrees {
                    agreeing.join(x as u32, y);
                } else {
                    n_against += 1;
                }
            }
        }
        let mut part_of_root = vec![u32::MAX; n];
        let mut parts: Vec<Vec<u32>> = Vec::new();
        let mut sizes = vec![0_usize; n];
        for x in (0..n as u32).filter(|&x| normals[x as usize] != Vector3::zeros()) {
            let part = &mut part_of_root[all.root(x) as usize];
            if *part == u32::MAX {
                *part = parts.len() as u32;
                parts.push(Vec::new());
            }
            parts[*part as usize].push(x);
            sizes[agreeing.root(x) as usize] += 1;
        }
        let largest = |part: &Vec<u32>| part.iter().map(|&x| sizes[x as usize]).max().unwrap_or(0); // of its roots
        let n_joined: usize = parts.iter().map(largest).sum();
        let n_known: usize = parts.iter().map(Vec::len).sum();
        let is_joined = n_joined as f64 >= JOINED * n_known as f64;
        Ok(PairCount { n_pairs, n_against, parts, is_joined })
    }
}

/// Unit vector of a normal of any length; zero if it has no direction.
pub(crate) fn unit_normal(normal: [f64; 3]) -> [f64; 3] {
    let size = normal.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if !(size.is_finite() && size > 0.0 && normal.iter().all(|c| c.is_finite())) {
        return [0.0; 3];
    }
    unit(&normal.map(|c| c / size)).unwrap_or_default()
}

/// Mean unit normals at the welded points; zero where there is none.
pub(crate) fn welded_normals(
    normals: impl Iterator<Item = [f64; 3]>,
    welded: &[u32],
    n_welded: usize,
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; n_welded];
    for (normal, &x) in normals.zip(welded) {
        let unit = unit_normal(normal);
        for (sum, c) in sums[x as usize].iter_mut().zip(unit) {
            *sum += c;
        }
    }
    // The sum of opposite normals is rounding.
    sums.into_iter().map(|sum| if dot(&sum, &sum) > 1e-12 { unit_normal(sum) } else { [0.0; 3] }).collect()
}
