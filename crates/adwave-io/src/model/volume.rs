//! Volume cells, and their surface: the faces that belong to a single cell.

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use crate::model::cells::VolumeFaces;
use crate::progress::at_row;

/// Kind of volume cell, with the corner numbering of Gmsh, VTK and Medit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cell {
    Tetrahedron,
    Pyramid,
    Prism,
    Hexahedron,
}

impl Cell {
    pub(crate) fn n_corners(self) -> usize {
        match self {
            Self::Tetrahedron => 4,
            Self::Pyramid => 5,
            Self::Prism => 6,
            Self::Hexahedron => 8,
        }
    }

    /// Corners of each face, counterclockwise seen from outside.
    fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
            Self::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
            Self::Prism => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
            Self::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
        }
    }
}

/// Volume cells of any kinds.
#[derive(Default)]
pub(crate) struct Cells {
    pub(crate) kinds: Vec<Cell>,
    /// Corners of all cells, one after the other.
    pub(crate) corners: Vec<u32>,
}

impl Cells {
    /// Faces that belong to a single cell, in the order of the cells, and the index of that cell. O(cells log cells).
    pub(crate) fn boundary(&self, progress: Progress<'_>) -> Result<(Polygons, Vec<u32>), Cancelled> {
        let mut sides = VolumeFaces::default();
        let mut first = 0;
        for (cell, kind) in self.kinds.iter().enumerate() {
            at_row(progress, cell as u64, self.kinds.len() as u64)?;
            let corners = &self.corners[first..first + kind.n_corners()];
            for side in kind.faces() {
                sides.push(side.iter().map(|&k| corners[k]), cell as u32);
            }
            first += kind.n_corners();
        }
        let (mut faces, mut cells) = (Polygons::new(), Vec::new());
        sides.boundary(progress, |face, cell| {
            faces.push(face);
            cells.push(cell);
        })?;
        Ok((faces, cells))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the signed volume enclosed by the faces.
    fn volume(points: &[[f64; 3]], faces: &Polygons) -> f64 {
        let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        faces
            .iter()
            .flat_map(|f| f.windows(2).skip(1).map(|w| [f[0], w[0], w[1]]).collect::<Vec<_>>())
            .map(|t| t.map(|v| points[v as usize]))
            .map(|[a, b, c]| det(a, b, c))
            .sum()
    }

    #[test]
    fn the_surface_of_each_cell_holds_its_volume() {
        let cube: Vec<[f64; 3]> = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
            .iter()
            .flat_map(|p| [[p[0], p[1], 0], [p[0], p[1], 1]])
            .map(|p| p.map(f64::from))
            .collect();
        // Bottom 0, 2, 4, 6, top 1, 3, 5, 7.
        for (kind, corners, six) in [
            (Cell::Tetrahedron, &[0_u32, 2, 6, 1][..], 1.0),
            (Cell::Pyramid, &[0, 2, 4, 6, 1], 2.0),
            (Cell::Prism, &[0, 2, 6, 1, 3, 7], 3.0),
            (Cell::Hexahedron, &[0, 2, 4, 6, 1, 3, 5, 7], 6.0),
        ] {
            let cells = Cells { kinds: vec![kind], corners: corners.to_vec() };
            let (faces, owners) = cells.boundary(Progress::none()).unwrap();
            assert!((volume(&cube, &faces) - six).abs() < 1e-12, "{kind:?}");
            assert!(owners.iter().all(|&c| c == 0));
        }
        // Two prisms form the cube; the face between them vanishes.
        let kinds = vec![Cell::Prism; 2];
        let cells = Cells { kinds, corners: vec![0, 2, 6, 1, 3, 7, 2, 4, 6, 3, 5, 7] };
        let (faces, owners) = cells.boundary(Progress::none()).unwrap();
        assert_eq!((faces.len(), volume(&cube, &faces).round()), (8, 6.0));
        assert_eq!(owners, [0, 0, 0, 0, 1, 1, 1, 1]);
    }

    #[test]
    fn a_collapsed_cell_is_the_simpler_one() {
        // A hexahedron whose top is collapsed to one corner, instead of a pyramid, and a tetrahedron at one side.
        let cells = Cells {
            kinds: vec![Cell::Hexahedron, Cell::Tetrahedron],
            corners: vec![0, 1, 2, 3, 4, 4, 4, 4, 0, 1, 4, 5],
        };
        let (faces, _) = cells.boundary(Progress::none()).unwrap();
        let mut sizes: Vec<usize> = faces.iter().map(<[u32]>::len).collect();
        sizes.sort_unstable();
        assert_eq!(sizes, [3, 3, 3, 3, 3, 3, 4]);
    }
}
