//! The types of cells, numbered as in `vtkCellType.h`.

/// Surface element of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    Empty,
    Vertices,
    /// Line between the first two corners.
    Line,
    Path,
    Strip,
    /// Polygon with that many corners, which come first.
    Polygon(usize),
    /// Polygon of all points.
    AnyPolygon,
    /// Polygon of the first half of the points; the others are midpoints of its sides.
    HalfPolygon,
    /// Rectangle whose last two corners are exchanged.
    Pixel,
    /// Volume with that many corners, which come first, and its outward faces.
    Volume(usize, &'static [&'static [u8]]),
    Polyhedron,
}

const TETRAHEDRON: &[&[u8]] = &[&[0, 1, 3], &[1, 2, 3], &[2, 0, 3], &[0, 2, 1]];
const VOXEL: &[&[u8]] =
    &[&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]];
const HEXAHEDRON: &[&[u8]] =
    &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[3, 7, 6, 2], &[0, 3, 2, 1], &[4, 5, 6, 7]];
const WEDGE: &[&[u8]] = &[&[0, 1, 2], &[3, 5, 4], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]];
const PYRAMID: &[&[u8]] = &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
const PENTAGONAL_PRISM: &[&[u8]] = &[
    &[0, 4, 3, 2, 1],
    &[5, 6, 7, 8, 9],
    &[0, 1, 6, 5],
    &[1, 2, 7, 6],
    &[2, 3, 8, 7],
    &[3, 4, 9, 8],
    &[4, 0, 5, 9],
];
const HEXAGONAL_PRISM: &[&[u8]] = &[
    &[0, 5, 4, 3, 2, 1],
    &[6, 7, 8, 9, 10, 11],
    &[0, 1, 7, 6],
    &[1, 2, 8, 7],
    &[2, 3, 9, 8],
    &[3, 4, 10, 9],
    &[4, 5, 11, 10],
    &[5, 0, 6, 11],
];

/// Family of a cell type; `None` for an unknown type.
pub(super) fn family(cell_type: u8) -> Option<Family> {
    Some(match cell_type {
        0 => Family::Empty,
        1 | 2 => Family::Vertices,
        // Linear, then quadratic, cubic, and of any order.
        3 | 21 | 35 | 60 | 68 | 75 => Family::Line,
        4 => Family::Path,
        5 | 22 | 34 | 61 | 69 | 76 => Family::Polygon(3),
        6 => Family::Strip,
        7 => Family::AnyPolygon,
        8 => Family::Pixel,
        9 | 23 | 28 | 30 | 62 | 70 | 77 => Family::Polygon(4),
        10 | 24 | 64 | 71 | 78 => Family::Volume(4, TETRAHEDRON),
        11 => Family::Volume(8, VOXEL),
        12 | 25 | 29 | 33 | 67 | 72 | 79 => Family::Volume(8, HEXAHEDRON),
        13 | 26 | 31 | 32 | 65 | 73 | 80 => Family::Volume(6, WEDGE),
        14 | 27 | 37 | 66 | 74 | 81 => Family::Volume(5, PYRAMID),
        15 => Family::Volume(10, PENTAGONAL_PRISM),
        16 => Family::Volume(12, HEXAGONAL_PRISM),
        36 => Family::HalfPolygon,
        42 => Family::Polyhedron,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_of_volumes_close_and_agree() {
        for cell_type in [10, 11, 12, 13, 14, 15, 16] {
            let Some(Family::Volume(n, faces)) = family(cell_type) else { panic!("{cell_type}") };
            let mut sides = Vec::new();
            for face in faces {
                for k in 0..face.len() {
                    assert!(usize::from(face[k]) < n);
                    sides.push((face[k], face[(k + 1) % face.len()]));
                }
            }
            // Every side is traversed once in each direction.
            for (a, b) in &sides {
                let times = |side| sides.iter().filter(|s| **s == side).count();
                assert_eq!((times((*a, *b)), times((*b, *a))), (1, 1), "{cell_type}");
            }
        }
    }
}
