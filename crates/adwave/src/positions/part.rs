//! Directions of motion at the vertices of a part of a shape, for shapes that are larger than memory.

use super::MoveDirection;
use crate::parallel;
use crate::shape::Adjacency;
use crate::vector::{add_scaled, dot, subtract, unit};
use crate::{Cancelled, Progress};

/// Number of lazy steps that smooth normals before positions move along them.
pub const NORMAL_STEPS: usize = 4;

/// Meaning of the sign of a normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalSign {
    /// The side of the surface, as by the faces of a mesh.
    Side,
    /// No meaning, as for the tangent planes of a cloud: neighbors count with the sign of the vertex itself. Motion
    /// along a normal does not depend on its sign.
    Arbitrary,
}

/// Unit normals after [`NORMAL_STEPS`] lazy steps with equal weights; zero if they vanish. `normals` and `neighbors`
/// have one row per vertex. O(entries).
///
/// A row depends on the normals within [`NORMAL_STEPS`] rings around it, provided that their lists are complete and in
/// the same order.
///
/// ```
/// use adwave::Progress;
/// use adwave::positions::{NormalSign, smoothed_normals};
/// use adwave::rows::Pattern;
/// let pair = Pattern::new(vec![0, 1, 2], vec![1, 0], 2)?;
/// let normals = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
/// assert_eq!(smoothed_normals(normals.clone(), &pair, NormalSign::Arbitrary, Progress::none())?, normals);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Cancelled`] if the call is cancelled.
///
/// # Panics
/// Unless there is one row of neighbors per normal.
pub fn smoothed_normals(
    mut normals: Vec<[f64; 3]>,
    neighbors: &Adjacency,
    sign: NormalSign,
    progress: Progress<'_>,
) -> Result<Vec<[f64; 3]>, Cancelled> {
    assert_eq!(neighbors.n_rows(), normals.len(), "a row of neighbors for each normal");
    for _ in 0..NORMAL_STEPS {
        normals = parallel::try_collect(normals.len(), progress, |x| {
            let near = neighbors.row(x);
            let share = 0.5 / near.len().max(1) as f64;
            let own = if near.is_empty() { 1.0 } else { 0.5 };
            near.iter().fold(normals[x].map(|c| own * c), |sum, &y| {
                let other = &normals[y as usize];
                let turned = sign == NormalSign::Arbitrary && dot(&normals[x], other) < 0.0;
                add_scaled(&sum, if turned { -share } else { share }, other)
            })
        })?;
    }
    parallel::try_collect(normals.len(), progress, |x| unit(&normals[x]).unwrap_or_default())
}

impl MoveDirection {
    /// The part of a displacement `moved` in this direction, in model units; `normal` is a unit normal or zero.
    ///
    /// ```
    /// use adwave::positions::MoveDirection;
    /// let (moved, up) = ([1.0, 2.0, 3.0], [0.0, 0.0, 1.0]);
    /// assert_eq!(MoveDirection::Normal.part_of(&moved, &up), [0.0, 0.0, 3.0]);
    /// assert_eq!(MoveDirection::Surface.part_of(&moved, &up), [1.0, 2.0, 0.0]);
    /// assert_eq!(MoveDirection::X.part_of(&moved, &up), [1.0, 0.0, 0.0]);
    /// ```
    pub fn part_of(self, moved: &[f64; 3], normal: &[f64; 3]) -> [f64; 3] {
        let along_normal = || normal.map(|c| c * dot(moved, normal));
        match (self, self.axis()) {
            (_, Some(axis)) => std::array::from_fn(|c| if c == axis { moved[c] } else { 0.0 }),
            (Self::Normal, _) => along_normal(),
            (Self::Surface, _) => subtract(moved, &along_normal()),
            _ => *moved,
        }
    }
}
