//! Subsets of shapes that are a part of their file, together with everything that is not in the part.

use adwave::shape::{Polygons, triangulate_with_faces};

use crate::model::partial::WholeFile;
use crate::{ShapeFile, ShapeFileError, Subset};

/// Lists of a [`Subset`] of a whole file.
#[derive(Default)]
struct WholeSubset {
    vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    faces: Vec<u32>,
    corners: Vec<[u32; 3]>,
}

impl ShapeFile {
    /// Number of faces of the file that are not in this part because one of their vertices was not selected.
    pub fn n_left_out_faces(&self) -> usize {
        self.selected_from().map_or(0, |whole| whole.file.faces.len() - self.faces.len())
    }

    /// Creates a file from a subset of this part and the vertices and faces that were not selected; of a shape that is
    /// not a selection, a [`subset`](Self::subset). Faces that were not selected become triangles; without new
    /// triangles they are dropped.
    ///
    /// ```
    /// use adwave_io::{ShapeFile, Subset};
    /// let file = ShapeFile::from_cloud((0..4).map(|x| [f64::from(x), 0.0, 0.0]).collect());
    /// let part = file.select_rows(&[true, true, false, true])?;
    /// let thin = part.subset_with_left_out(&Subset { vertices: &[0, 2], ..Subset::default() })?;
    /// assert_eq!(thin.points(), [[0.0; 3], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`subset`](Self::subset).
    pub fn subset_with_left_out(&self, subset: &Subset<'_>) -> Result<Self, ShapeFileError> {
        let Some(whole) = self.selected_from() else { return self.subset(subset) };
        self.check_subset(subset)?;
        let lists = whole.merge(self, subset);
        whole.file.subset(&Subset {
            vertices: &lists.vertices,
            triangles: &lists.triangles,
            faces: &lists.faces,
            corners: &lists.corners,
        })
    }

    /// File that this shape was selected from; `None` if only vertices without a position are missing.
    fn selected_from(&self) -> Option<&WholeFile> {
        self.whole.as_deref().filter(|whole| !whole.is_missing)
    }
}

impl WholeFile {
    /// Lists of the subset of the whole file that has a subset of its part and the rest.
    fn merge(&self, part: &ShapeFile, subset: &Subset<'_>) -> WholeSubset {
        let file = &self.file;
        let mut is_kept = vec![true; file.n_vertices];
        for &row in &self.kept {
            is_kept[row as usize] = false;
        }
        let row = |vertex: u32| self.kept[vertex as usize];
        for &vertex in subset.vertices {
            is_kept[row(vertex) as usize] = true;
        }
        let vertices: Vec<u32> = (0..file.n_vertices as u32).filter(|&row| is_kept[row as usize]).collect();
        let place = |row: u32| vertices.binary_search(&row).unwrap_or(0) as u32;
        let mut lists = WholeSubset::default();
        for triangle in subset.triangles {
            lists.triangles.push(triangle.map(|x| place(row(subset.vertices[x as usize]))));
        }
        lists.faces = subset.faces.iter().map(|&face| self.faces[face as usize]).collect();
        let starts = corner_starts(&file.faces);
        let mut corner_in_whole = Vec::with_capacity(part.faces.corners().len());
        for (face, &in_whole) in part.faces.iter().zip(&self.faces) {
            let start = starts[in_whole as usize];
            corner_in_whole.extend((start..).take(face.len()));
        }
        lists.corners.extend(subset.corners.iter().map(|three| three.map(|k| corner_in_whole[k as usize])));
        if !subset.triangles.is_empty() {
            for face in self.triangles_left_out(&starts) {
                lists.triangles.push(face.vertices.map(place));
                lists.faces.push(face.face);
                lists.corners.push(face.corners);
            }
        }
        lists.vertices = vertices;
        lists
    }

    /// Triangles of the faces that are not in the part.
    fn triangles_left_out(&self, starts: &[u32]) -> Vec<LeftOutTriangle> {
        let mut in_part = vec![false; self.file.faces.len()];
        for &face in &self.faces {
            in_part[face as usize] = true;
        }
        let (mut others, mut rows) = (Polygons::new(), Vec::new());
        for (f, face) in self.file.faces.iter().enumerate() {
            if !in_part[f] {
                others.push(face);
                rows.push(f as u32);
            }
        }
        let triangles = triangulate_with_faces(&self.file.points, &others);
        let to_triangle = |(k, vertices): (usize, [u32; 3])| {
            let face = rows[k];
            let corners = self.file.faces.get(face as usize);
            let corner = |x: u32| corners.iter().position(|&y| y == x).unwrap_or(0) as u32;
            LeftOutTriangle { vertices, face, corners: vertices.map(|x| starts[face as usize] + corner(x)) }
        };
        triangles.into_iter().map(to_triangle).collect()
    }
}

/// Triangle of a face that is not in the part.
struct LeftOutTriangle {
    vertices: [u32; 3],
    face: u32,
    /// Corners of the triangle, counted through all faces of the file.
    corners: [u32; 3],
}

/// Index of the first corner of each face.
fn corner_starts(faces: &Polygons) -> Vec<u32> {
    let mut next = 0;
    faces
        .iter()
        .map(|face| {
            let start = next;
            next += face.len() as u32;
            start
        })
        .collect()
}
