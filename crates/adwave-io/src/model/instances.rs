//! Objects that a file places several times, joined to one shape.

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

/// The objects that are placed, one after the other.
pub(crate) struct Joined<'a> {
    limits: &'a ReadLimits,
    /// Length of the file.
    n_bytes: usize,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// End of each object's triangles.
    ends: Vec<usize>,
}

impl<'a> Joined<'a> {
    /// Nothing placed yet, for a file of `n_bytes` bytes.
    pub(crate) fn new(limits: &'a ReadLimits, n_bytes: usize) -> Self {
        Self { limits, n_bytes, points: Vec::new(), triangles: Vec::new(), ends: Vec::new() }
    }

    /// Adds an object. Objects that name others many times over make much of little: at most as much as a file of that many
    /// bytes is worth.
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
        extend(&mut self.triangles, triangles.len(), progress, |f| triangles[f].map(|v| first + v))?;
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

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
