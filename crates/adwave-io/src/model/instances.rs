//! Objects that a file places several times, joined to one shape.

use std::ops::Range;

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use crate::progress::{collect, extend};
use crate::{Field, FieldValues, ReadError, ReadLimits, ShapeFile};

/// Affine map p ↦ p R + t: the rows of R, then t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Transform(pub(crate) [f64; 12]);

impl Transform {
    pub(crate) const IDENTITY: Self = Self([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);

    pub(crate) fn scale(by: f64) -> Self {
        Self([by, 0.0, 0.0, 0.0, by, 0.0, 0.0, 0.0, by, 0.0, 0.0, 0.0])
    }

    pub(crate) fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        // Unmoved points keep their bits, including −0.
        if *self == Self::IDENTITY {
            return p;
        }
        let m = &self.0;
        [0, 1, 2].map(|c| p[0] * m[c] + p[1] * m[3 + c] + p[2] * m[6 + c] + m[9 + c])
    }

    /// True if the map turns solids inside out: the determinant of R is negative.
    pub(crate) fn mirrors(&self) -> bool {
        let [a, b, c, d, e, f, g, h, i, ..] = self.0;
        a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0
    }

    /// Composition: this map first, then `outer`.
    pub(crate) fn then(&self, outer: &Self) -> Self {
        if *self == Self::IDENTITY {
            return *outer;
        }
        if *outer == Self::IDENTITY {
            return *self;
        }
        let mut product = [0.0; 12];
        for row in 0..4 {
            let own = [0, 1, 2].map(|c| self.0[3 * row + c]);
            let moved = outer.apply(own);
            // Directions are not translated.
            let shift = |c: usize| if row < 3 { outer.0[9 + c] } else { 0.0 };
            for c in 0..3 {
                product[3 * row + c] = moved[c] - shift(c);
            }
        }
        Self(product)
    }
}

/// Placed objects, one after the other.
pub(crate) struct MergedMesh<'a> {
    limits: &'a ReadLimits,
    /// Length of the file.
    n_bytes: usize,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// End of each object's triangles.
    ends: Vec<usize>,
}

impl<'a> MergedMesh<'a> {
    /// Nothing placed yet, for a file of `n_bytes` bytes.
    pub(crate) fn new(limits: &'a ReadLimits, n_bytes: usize) -> Self {
        Self { limits, n_bytes, points: Vec::new(), triangles: Vec::new(), ends: Vec::new() }
    }

    /// Adds an object. A map that mirrors exchanges the last two corners of each triangle, so that the outside stays
    /// outside. Nested references could multiply a small file: the total is limited by what a file of that size could
    /// contain.
    pub(crate) fn add(
        &mut self,
        points: &[[f64; 3]],
        triangles: &[[u32; 3]],
        transform: &Transform,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        progress.step(self.points.len() as u64, 0)?;
        let (n_points, n_triangles) =
            (self.points.len() + points.len(), self.triangles.len() + triangles.len());
        self.limits.check_points(n_points as u64)?;
        let limit = 4_000_000 + 64 * self.n_bytes as u64;
        let found = n_points.max(n_triangles).max(self.ends.len()) as u64;
        if found > limit {
            return Err(ReadError::Limit { what: "placed vertices for the size of the file", found, limit });
        }
        let first = self.points.len() as u32;
        extend(&mut self.points, points.len(), progress, |i| transform.apply(points[i]))?;
        let mirrors = transform.mirrors();
        extend(&mut self.triangles, triangles.len(), progress, |f| {
            let [a, b, c] = triangles[f].map(|v| first + v);
            if mirrors { [a, c, b] } else { [a, b, c] }
        })?;
        self.ends.push(self.triangles.len());
        Ok(())
    }

    /// Converts to a shape, with the field `object` if there are several objects.
    pub(crate) fn into_shape(self, progress: Progress<'_>) -> Result<ShapeFile, Cancelled> {
        let (triangles, ends) = (self.triangles, self.ends);
        let offsets = collect(triangles.len() + 1, progress, |f| 3 * f as u32)?;
        let corners = triangles.into_flattened();
        let faces = Polygons::from_parts(offsets, corners).expect("triangles have three corners");
        let n = faces.len();
        let mut shape = ShapeFile::from_mesh(self.points, faces);
        if ends.len() > 1 {
            let object = collect(n, progress, |f| ends.partition_point(|&end| end <= f) as u32)?;
            shape.face_fields.push(Field::new("object", 1, FieldValues::U32(object)));
        }
        Ok(shape)
    }
}

/// Consecutive faces and vertices of one object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ObjectRange {
    pub(crate) faces: Range<usize>,
    pub(crate) vertices: Range<usize>,
}

/// Objects that the face field `object` numbers, if each has consecutive vertices of its own; the whole shape
/// otherwise. The flag is true if these objects store the field.
pub(crate) fn object_ranges(shape: &ShapeFile) -> (Vec<ObjectRange>, bool) {
    let found = shape.face_fields.iter().find(|field| field.name == "object" && field.n_channels == 1);
    match found.and_then(|field| split(shape, field)) {
        Some(ranges) => (ranges, true),
        None => (vec![ObjectRange { faces: 0..shape.faces.len(), vertices: 0..shape.n_vertices }], false),
    }
}

fn split(shape: &ShapeFile, field: &Field) -> Option<Vec<ObjectRange>> {
    let mut ranges: Vec<ObjectRange> = Vec::new();
    // First vertex that no face so far has.
    let mut free = 0;
    for (f, face) in shape.faces.iter().enumerate() {
        let object = field.get(f, 0);
        // Readers number the objects from 0.
        if ranges.len() as f64 == object {
            let faces = f..shape.faces.len();
            if let Some(before) = ranges.last_mut() {
                (before.faces.end, before.vertices.end) = (f, free);
            }
            ranges.push(ObjectRange { faces, vertices: free..shape.n_vertices });
        } else if ranges.len() as f64 != object + 1.0 {
            return None;
        }
        let first = ranges.last()?.vertices.start;
        if face.iter().any(|&v| (v as usize) < first) {
            return None;
        }
        free = face.iter().map(|&v| v as usize + 1).fold(free, usize::max);
    }
    (ranges.len() > 1).then_some(ranges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_with_vertices_of_their_own_are_ranges() {
        let shape = |triangles: &[[u32; 3]], objects: Vec<u32>| {
            let mut shape = ShapeFile::from_mesh(vec![[0.0; 3]; 8], Polygons::from_triangles(triangles));
            shape.face_fields.push(Field::new("object", 1, FieldValues::U32(objects)));
            object_ranges(&shape)
        };
        let (ranges, is_stored) = shape(&[[0, 1, 2], [2, 1, 0], [4, 6, 5]], vec![0, 0, 1]);
        let range = |faces, vertices| ObjectRange { faces, vertices };
        assert_eq!((ranges, is_stored), (vec![range(0..2, 0..3), range(2..3, 3..8)], true));
        // Shared vertices, another order of vertices or objects, and a single object.
        for (triangles, objects) in [
            ([[0, 1, 2], [2, 3, 4]], vec![0, 1]),
            ([[3, 4, 5], [0, 1, 2]], vec![0, 1]),
            ([[0, 1, 2], [3, 4, 5]], vec![1, 0]),
            ([[0, 1, 2], [3, 4, 5]], vec![0, 0]),
        ] {
            assert_eq!(shape(&triangles, objects), (vec![range(0..2, 0..8)], false));
        }
    }

    #[test]
    fn one_after_the_other_is_the_product() {
        let turn = Transform([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0]);
        let grow = Transform([2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, -5.0]);
        for p in [[1.0, 0.0, 0.0], [0.5, -2.0, 4.0]] {
            assert_eq!(turn.then(&grow).apply(p), grow.apply(turn.apply(p)));
            assert_eq!(grow.then(&turn).apply(p), turn.apply(grow.apply(p)));
        }
        assert_eq!(turn.apply([1.0, 0.0, 0.0]), [1.0, 3.0, 3.0]);
        assert_eq!(Transform::scale(2.0).apply([1.0; 3]), [2.0; 3]);
        assert!(!turn.mirrors() && !grow.mirrors());
        assert!(Transform::scale(-1.0).then(&turn).mirrors());
        assert!(!Transform::scale(-1.0).then(&turn).then(&Transform::scale(-2.0)).mirrors());
    }
}
