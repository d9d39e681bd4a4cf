//! Faces of a mesh as lists of corners, with any number of corners per face.

use super::squared_distance;
use crate::vector::{add_scaled, subtract};
use std::cmp::Ordering;

/// The faces of a mesh, each a list of vertex indices in the order of the file.
///
/// While all faces are triangles only their corners are stored. Nothing is checked here;
/// [`Mesh::new`](crate::shape::Mesh::new) checks that every corner names a vertex.
///
/// ```
/// use adwave::shape::Polygons;
/// let mut faces = Polygons::from_triangles(&[[0, 1, 2]]);
/// assert_eq!(faces.triangles(), Some([[0, 1, 2]].as_slice()));
/// faces.push(&[0, 2, 3, 4]);
/// assert_eq!((faces.len(), faces.triangles()), (2, None));
/// assert_eq!(faces.get(1), [0, 2, 3, 4]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polygons {
    corners: Vec<u32>,
    /// End of each face; empty while all faces are triangles.
    ends: Vec<u32>,
}

impl Polygons {
    /// An empty list of faces.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty list with room for `n_faces` faces of `n_corners` corners in total.
    pub fn with_capacity(n_faces: usize, n_corners: usize) -> Self {
        // With three corners per face on average all may be triangles, whose ends are not stored.
        let n_ends = if n_corners == 3 * n_faces { 0 } else { n_faces };
        Self { corners: Vec::with_capacity(n_corners), ends: Vec::with_capacity(n_ends) }
    }

    /// One face per triangle.
    pub fn from_triangles(triangles: &[[u32; 3]]) -> Self {
        Self { corners: triangles.as_flattened().to_vec(), ends: Vec::new() }
    }

    /// Builds faces from their two lists without copying: face `f` has the corners
    /// `corners[offsets[f]..offsets[f + 1]]`. `None` unless the offsets start at 0, do not decrease, and end at the
    /// number of corners.
    ///
    /// ```
    /// use adwave::shape::Polygons;
    /// let faces = Polygons::from_parts(vec![0, 3, 5], vec![0, 1, 2, 2, 3]).unwrap();
    /// assert_eq!(faces.get(1), [2, 3]);
    /// assert_eq!(faces.into_parts(), (vec![0, 3, 5], vec![0, 1, 2, 2, 3]));
    /// assert!(Polygons::from_parts(vec![0, 3], vec![0, 1]).is_none());
    /// ```
    pub fn from_parts(mut offsets: Vec<u32>, corners: Vec<u32>) -> Option<Self> {
        let ends = (offsets.first().copied(), offsets.last().map(|&end| end as usize));
        if ends != (Some(0), Some(corners.len())) || !offsets.is_sorted() {
            return None;
        }
        if offsets.iter().zip((0..).step_by(3)).all(|(&offset, triple)| offset == triple) {
            return Some(Self { corners, ends: Vec::new() });
        }
        offsets.remove(0);
        Some(Self { corners, ends: offsets })
    }

    /// The offsets and the corners, the latter without a copy; see [`from_parts`](Self::from_parts).
    pub fn into_parts(self) -> (Vec<u32>, Vec<u32>) {
        let offsets = std::iter::once(0).chain((0..self.len()).map(|f| end(self.end(f)))).collect();
        (offsets, self.corners)
    }

    /// Appends a face.
    ///
    /// # Panics
    /// If the faces have 2³² corners or more in total and are not all triangles.
    pub fn push(&mut self, corners: &[u32]) {
        let are_triangles = self.ends.is_empty();
        if are_triangles && corners.len() != 3 {
            let n_faces = self.len();
            self.ends.extend((1..=n_faces).map(|f| end(3 * f)));
        }
        self.corners.extend_from_slice(corners);
        if !are_triangles || corners.len() != 3 {
            self.ends.push(end(self.corners.len()));
        }
    }

    /// Number of faces.
    pub fn len(&self) -> usize {
        if self.ends.is_empty() { self.corners.len() / 3 } else { self.ends.len() }
    }

    /// True if there are no faces.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Corners of face `f` as vertex indices, in the order of the file.
    pub fn get(&self, f: usize) -> &[u32] {
        &self.corners[if f == 0 { 0 } else { self.end(f - 1) }..self.end(f)]
    }

    /// The faces in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone + '_ {
        (0..self.len()).map(|f| self.get(f))
    }

    /// Corners of all faces, one face after another.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// End of face `f` in [`corners`](Self::corners), which is the start of the next face.
    pub fn end(&self, f: usize) -> usize {
        if self.ends.is_empty() { 3 * f + 3 } else { self.ends[f] as usize }
    }

    /// These faces, each of more than three corners starting at a corner that only the positions decide: the one
    /// nearest to the mean of its corners, and among equally near ones the first in the order of their coordinates.
    /// Whatever starts at the first corner, such as a fan, then does not depend on the corner that a file names
    /// first. O(corners).
    ///
    /// ```
    /// use adwave::shape::Polygons;
    /// let points = [[4.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 0.0], [2.0, 5.0, 0.0]];
    /// let faces: Polygons = [[3, 0, 1, 2].as_slice()].into_iter().collect();
    /// assert_eq!(faces.with_canonical_starts(&points).get(0), [1, 2, 3, 0]);
    /// ```
    ///
    /// # Panics
    /// If a face names a vertex that does not exist.
    #[must_use]
    pub fn with_canonical_starts(mut self, points: &[[f64; 3]]) -> Self {
        if self.ends.is_empty() {
            return self;
        }
        let mut start = 0;
        for &end in &self.ends {
            let face = &mut self.corners[start..end as usize];
            if face.len() > 3 {
                face.rotate_left(least_rotation(points, face));
                face.rotate_left(nearest_to_mean(points, face));
            }
            start = end as usize;
        }
        self
    }

    /// The faces as triangles, if all of them are.
    pub fn triangles(&self) -> Option<&[[u32; 3]]> {
        self.ends.is_empty().then(|| self.corners.as_chunks().0)
    }
}

/// Start of the rotation of a face whose corners come first in the order of their coordinates, then of their
/// numbers. O(corners).
fn least_rotation(points: &[[f64; 3]], face: &[u32]) -> usize {
    let n = face.len();
    let key = |k: usize| (&points[face[k % n] as usize], face[k % n]);
    let order = |a: usize, b: usize| {
        let ((p, i), (q, j)) = (key(a), key(b));
        let by_position = (0..3).map(|c| p[c].total_cmp(&q[c])).find(|order| order.is_ne());
        by_position.unwrap_or_else(|| i.cmp(&j))
    };
    // Two candidates; the one that loses a comparison after k equal corners skips k + 1 starts.
    let (mut a, mut b, mut k) = (0, 1, 0);
    while a < n && b < n && k < n {
        match order(a + k, b + k) {
            Ordering::Equal => k += 1,
            Ordering::Less => (b, k) = (b + k + 1, 0),
            Ordering::Greater => (a, k) = (a + k + 1, 0),
        }
        if a == b {
            b += 1;
        }
    }
    a.min(b)
}

/// Corner of a face nearest to the mean of its corners; the first of several.
fn nearest_to_mean(points: &[[f64; 3]], face: &[u32]) -> usize {
    let offset = |&v: &u32| subtract(&points[v as usize], &points[face[0] as usize]);
    let sum = face.iter().map(offset).fold([0.0; 3], |sum, d| add_scaled(&sum, 1.0, &d));
    let mean = sum.map(|c| c / face.len() as f64);
    let squares = face.iter().map(|v| squared_distance(&offset(v), &mean));
    let nearest = squares.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map_or(0, |(k, _)| k)
}

fn end(n_corners: usize) -> u32 {
    u32::try_from(n_corners).expect("fewer than 2^32 corners")
}

impl From<Vec<[u32; 3]>> for Polygons {
    /// One face per triangle, without a copy.
    fn from(triangles: Vec<[u32; 3]>) -> Self {
        Self { corners: triangles.into_flattened(), ends: Vec::new() }
    }
}

impl<'a> FromIterator<&'a [u32]> for Polygons {
    fn from_iter<I: IntoIterator<Item = &'a [u32]>>(faces: I) -> Self {
        let mut polygons = Self::new();
        for face in faces {
            polygons.push(face);
        }
        polygons
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_what_was_pushed_wherever_the_first_polygon_comes() {
        let faces: [&[u32]; 6] = [&[0, 1, 2], &[2, 1, 0], &[0, 1, 2, 3], &[], &[5], &[7, 8, 9]];
        for skip in 0..faces.len() {
            let polygons: Polygons = faces[skip..].iter().copied().collect();
            assert!(polygons.iter().eq(faces[skip..].iter().copied()));
            assert_eq!(polygons.triangles().is_some(), faces[skip..].iter().all(|f| f.len() == 3));
        }
        assert_eq!(Polygons::from(vec![[0, 1, 2]]), Polygons::from_triangles(&[[0, 1, 2]]));
    }
}
