//! Kinds of Gmsh elements, by number.

use crate::model::volume::Cell;

/// Kind of an element, apart from the nodes between its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Point,
    Line,
    /// Triangle or quadrilateral.
    Face(u8),
    Cell(Cell),
}

/// Numbers of the kinds and their numbers of nodes. From `gmsh.model.mesh.getElementProperties` of Gmsh 4.15, and for
/// prisms of higher order, which it does not know, from `GmshDefines.h`.
const POINTS: &[(u32, u32)] = &[(15, 1)];
const LINES: &[(u32, u32)] =
    &[(1, 2), (8, 3), (26, 4), (27, 5), (28, 6), (62, 7), (63, 8), (64, 9), (65, 10), (66, 11)];
const TRIANGLES: &[(u32, u32)] = &[
    (2, 3),
    (9, 6),
    (20, 9),
    (21, 10),
    (22, 12),
    (23, 15),
    (24, 15),
    (25, 21),
    (42, 28),
    (43, 36),
    (44, 45),
    (45, 55),
    (46, 66),
    (52, 18),
    (53, 21),
    (54, 24),
    (55, 27),
    (56, 30),
];
const QUADRILATERALS: &[(u32, u32)] = &[
    (3, 4),
    (10, 9),
    (16, 8),
    (36, 16),
    (37, 25),
    (38, 36),
    (39, 12),
    (40, 16),
    (41, 20),
    (47, 49),
    (48, 64),
    (49, 81),
    (50, 100),
    (51, 121),
    (57, 24),
    (58, 28),
    (59, 32),
    (60, 36),
    (61, 40),
];
const TETRAHEDRA: &[(u32, u32)] = &[
    (4, 4),
    (11, 10),
    (29, 20),
    (30, 35),
    (31, 56),
    (32, 22),
    (33, 28),
    (71, 84),
    (72, 120),
    (73, 165),
    (74, 220),
    (75, 286),
    (79, 34),
    (80, 40),
    (81, 46),
    (82, 52),
    (83, 58),
    (137, 16),
];
const HEXAHEDRA: &[(u32, u32)] = &[
    (5, 8),
    (12, 27),
    (17, 20),
    (92, 64),
    (93, 125),
    (94, 216),
    (95, 343),
    (96, 512),
    (97, 729),
    (98, 1000),
    (99, 32),
    (100, 44),
    (101, 56),
    (102, 68),
    (103, 80),
    (104, 92),
    (105, 104),
];
const PRISMS: &[(u32, u32)] = &[
    (6, 6),
    (13, 18),
    (18, 15),
    (90, 40),
    (91, 75),
    (106, 126),
    (107, 196),
    (108, 288),
    (109, 405),
    (110, 550),
];
const PYRAMIDS: &[(u32, u32)] = &[
    (7, 5),
    (14, 14),
    (19, 13),
    (118, 30),
    (119, 55),
    (120, 91),
    (121, 140),
    (122, 204),
    (123, 285),
    (124, 385),
    (125, 21),
    (126, 29),
    (127, 37),
    (128, 45),
    (129, 53),
    (130, 61),
    (131, 69),
];

/// Numbers and node counts of a family, and the kind of its elements.
type Family = (&'static [(u32, u32)], Kind);

const FAMILIES: &[Family] = &[
    (POINTS, Kind::Point),
    (LINES, Kind::Line),
    (TRIANGLES, Kind::Face(3)),
    (QUADRILATERALS, Kind::Face(4)),
    (TETRAHEDRA, Kind::Cell(Cell::Tetrahedron)),
    (HEXAHEDRA, Kind::Cell(Cell::Hexahedron)),
    (PRISMS, Kind::Cell(Cell::Prism)),
    (PYRAMIDS, Kind::Cell(Cell::Pyramid)),
];

/// Kind and number of nodes of the elements with that number.
pub(crate) fn kind_of(number: i64) -> Option<(Kind, usize)> {
    let number = u32::try_from(number).ok()?;
    FAMILIES.iter().find_map(|(list, kind)| {
        list.iter().find(|(own, _)| *own == number).map(|(_, n_nodes)| (*kind, *n_nodes as usize))
    })
}

impl Kind {
    /// Number of corners, which are the first nodes.
    pub(crate) fn n_corners(self) -> usize {
        match self {
            Self::Point => 1,
            Self::Line => 2,
            Self::Face(n) => n.into(),
            Self::Cell(cell) => cell.n_corners(),
        }
    }
}
