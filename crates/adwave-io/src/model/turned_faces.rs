//! Faces that are turned over, with the normals that follow from them.

use std::sync::Arc;

use adwave::shape::Polygons;

use crate::model::moved_attributes::{is_normal, is_tangent};
use crate::model::source_document::SourceDocument;
use crate::{Field, ShapeFile, ShapeFileError};

impl ShapeFile {
    /// Turns the flagged faces over: each keeps its first corner, and the others are listed backward.
    ///
    /// Normals of vertices, corners and faces are reversed where most of them pointed to the old front of the turned
    /// faces; otherwise they belong to the new front already and stay. PLY, OBJ and STL keep all other content; other
    /// formats are written as new files.
    ///
    /// ```
    /// use adwave_io::{Format, ReadLimits, read_bytes, write_bytes};
    /// let text = b"# kept\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 # front\n";
    /// let mut file = read_bytes(text.to_vec(), Some("a.obj"), &ReadLimits::default()).unwrap();
    /// file.turn_faces(&[true])?;
    /// assert_eq!(file.faces().get(0), [0, 2, 1]);
    /// let mut out = Vec::new();
    /// write_bytes(&file, Format::OBJ, &mut out).unwrap();
    /// assert_eq!(out, b"# kept\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2 # front\n");
    /// # Ok::<(), adwave_io::ShapeFileError>(())
    /// ```
    ///
    /// # Errors
    /// [`ShapeFileError::FaceCount`] if the number of flags differs from that of the faces,
    /// [`ShapeFileError::PartOfFile`] if vertices were left out that are written again.
    pub fn turn_faces(&mut self, is_turned: &[bool]) -> Result<(), ShapeFileError> {
        let n_faces = self.faces.len();
        if is_turned.len() != n_faces {
            return Err(ShapeFileError::FaceCount { found: is_turned.len(), n_faces });
        }
        if !is_turned.contains(&true) {
            return Ok(());
        }
        if self.whole.is_some() {
            return Err(ShapeFileError::PartOfFile);
        }
        let corner_normals = self.normals_of_corners();
        let faces = turn_polygons(&self.faces, is_turned);
        let document = self.original.as_deref().and_then(|source| source.with_turned_faces(is_turned));
        let turns = Turns { points: &self.points, faces: &faces, is_turned };
        let fields = turns.fields(&self.vertex_fields);
        let face_fields = turns.face_fields(&self.face_fields);
        let corner_normals = corner_normals.map(|normals| turns.normals_of_corners(&self.faces, normals));
        let has_stale_normals = !face_fields.is_empty()
            && !document.as_deref().is_some_and(SourceDocument::computes_face_normals);
        self.original = document.filter(|_| !has_stale_normals);
        self.faces = Arc::new(faces);
        for field in fields {
            self.add_vertex_field(field)?;
        }
        for (at, field) in face_fields {
            self.face_fields[at] = field;
        }
        self.corner_normals = corner_normals.map(Arc::new);
        // The provenance of the file describes other faces.
        self.moved = true;
        Ok(())
    }

    /// One normal per corner of the faces, NaN at corners without; `None` if only the vertices have normals.
    fn normals_of_corners(&self) -> Option<Vec<[f64; 3]>> {
        if let Some(normals) = &self.corner_normals {
            return Some(normals.to_vec());
        }
        let stored = self.original.as_ref()?.corner_normals(self)?;
        let normal = |&k: &u32| stored.normals.get(k as usize).copied().unwrap_or([f64::NAN; 3]);
        Some(stored.of_corner.iter().map(normal).collect())
    }
}

/// Corners of a face or values at them, with the first one kept and the others backward.
pub(crate) fn turn_list<T>(list: &mut [T]) {
    if let Some((_, others)) = list.split_first_mut() {
        others.reverse();
    }
}

fn turn_polygons(faces: &Polygons, is_turned: &[bool]) -> Polygons {
    let mut result = Polygons::with_capacity(faces.len(), faces.corners().len());
    let mut corners = Vec::new();
    for (face, &is_turned) in faces.iter().zip(is_turned) {
        corners.clear();
        corners.extend_from_slice(face);
        if is_turned {
            turn_list(&mut corners);
        }
        result.push(&corners);
    }
    result
}

/// Faces after they were turned.
struct Turns<'a> {
    points: &'a [[f64; 3]],
    faces: &'a Polygons,
    is_turned: &'a [bool],
}

impl Turns<'_> {
    /// Turned faces: index, first corner in the list of all corners, and corners.
    fn turned_faces(&self) -> impl Iterator<Item = (usize, usize, &[u32])> {
        let faces = self.faces.iter().enumerate().filter(|(f, _)| self.is_turned[*f]);
        faces.map(|(f, face)| (f, self.faces.end(f) - face.len(), face))
    }

    /// Area vector of a face, twice its area long.
    fn area_vector(&self, face: &[u32]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        let Some(&first) = face.first() else { return sum };
        let place = |v: u32| -> [f64; 3] {
            let (p, o) = (self.points[v as usize], self.points[first as usize]);
            std::array::from_fn(|c| p[c] - o[c])
        };
        for pair in face.windows(2) {
            let (a, b) = (place(pair[0]), place(pair[1]));
            for c in 0..3 {
                sum[c] += a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
            }
        }
        sum
    }

    /// True if most normals point to the back of the turned faces; `normal` is that of a corner, by its index in the
    /// list of all corners, its vertex and its face.
    fn point_back(&self, normal: impl Fn(usize, u32, usize) -> [f64; 3]) -> bool {
        let mut sum = 0.0;
        for (f, first, face) in self.turned_faces() {
            let area = self.area_vector(face);
            for (k, &v) in face.iter().enumerate() {
                let along: f64 = normal(first + k, v, f).iter().zip(area).map(|(n, a)| n * a).sum();
                sum += if along.is_finite() { along } else { 0.0 };
            }
        }
        sum < 0.0
    }

    /// Vertex fields of normals and tangents that change.
    fn fields(&self, fields: &[Field]) -> Vec<Field> {
        let Some(normal) = fields.iter().find(|field| is_normal(field)) else { return Vec::new() };
        if !self.point_back(|_, v, _| row_of(normal, v as usize)) {
            return Vec::new();
        }
        let mut of_turned = vec![false; self.points.len()];
        for (_, _, face) in self.turned_faces() {
            for &v in face {
                of_turned[v as usize] = true;
            }
        }
        let reversed = |field: &Field, is_reversed: &dyn Fn(usize) -> bool| {
            let mut values = field.to_f64();
            for (k, x) in values.iter_mut().enumerate() {
                let (v, c) = (k / field.n_channels, k % field.n_channels);
                if of_turned[v] && is_reversed(c) {
                    *x = 0.0 - *x;
                }
            }
            field.with_values_rounded(&values)
        };
        // The fourth channel of a tangent says on which side of it the other direction lies.
        let tangents = fields.iter().filter(|field| is_tangent(field) && field.n_channels == 4);
        let mut changed: Vec<Field> = tangents.map(|field| reversed(field, &|c| c == 3)).collect();
        changed.push(reversed(normal, &|_| true));
        changed
    }

    /// Face fields of normals that change, with their places in the list.
    fn face_fields(&self, fields: &[Field]) -> Vec<(usize, Field)> {
        let mut changed = Vec::new();
        for (at, field) in fields.iter().enumerate().filter(|(_, field)| is_normal(field)) {
            if !self.point_back(|_, _, f| row_of(field, f)) {
                continue;
            }
            let mut values = field.to_f64();
            for (row, _) in values.chunks_exact_mut(3).zip(self.is_turned).filter(|(_, turned)| **turned) {
                for x in row {
                    *x = 0.0 - *x;
                }
            }
            changed.push((at, field.with_values_rounded(&values)));
        }
        changed
    }

    /// Normals of the corners, given those in the order of the faces `before` they were turned.
    fn normals_of_corners(&self, before: &Polygons, mut normals: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
        if normals.len() != before.corners().len() {
            return normals;
        }
        for (_, first, face) in self.turned_faces() {
            turn_list(&mut normals[first..first + face.len()]);
        }
        if self.point_back(|corner, _, _| normals[corner]) {
            for (_, first, face) in self.turned_faces() {
                for normal in &mut normals[first..first + face.len()] {
                    *normal = normal.map(|x| 0.0 - x);
                }
            }
        }
        normals
    }
}

fn row_of(field: &Field, row: usize) -> [f64; 3] {
    std::array::from_fn(|c| field.get(row, c))
}

#[cfg(test)]
mod tests {
    use crate::{Format, ReadLimits, ShapeFile, read_bytes, write_bytes};

    fn read(name: &str, bytes: &[u8]) -> ShapeFile {
        read_bytes(bytes.to_vec(), Some(name), &ReadLimits::default()).unwrap()
    }

    fn written(file: &ShapeFile, format: Format) -> Vec<u8> {
        let mut out = Vec::new();
        write_bytes(file, format, &mut out).unwrap();
        out
    }

    const PLY: &str = "ply\nformat ascii 1.0\ncomment kept\nelement face 2\n\
        property uchar mark\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n\
        element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar heat\nend_header\n\
        7 3 0 1 2  6 .0 .1 .2 .3 .4 .5\n9 4 0 2 1 3 0\n0 0 0 1\n1 0 0 2\n0 1 0 3\n1 1 0 4\n";

    #[test]
    fn a_text_ply_keeps_all_but_the_order_of_the_corners() {
        let mut file = read("a.ply", PLY.as_bytes());
        file.turn_faces(&[true, false]).unwrap();
        let expected = PLY.replace("3 0 1 2  6 .0 .1 .2 .3 .4 .5", "3 0 2 1  6 .0 .1 .4 .5 .2 .3");
        assert_eq!(String::from_utf8(written(&file, Format::PLY_ASCII)).unwrap(), expected);
        file.turn_faces(&[true, true]).unwrap();
        let expected = PLY.replace("4 0 2 1 3 0", "4 0 3 1 2 0");
        assert_eq!(String::from_utf8(written(&file, Format::PLY_ASCII)).unwrap(), expected);
    }

    #[test]
    fn turning_twice_gives_the_bytes_of_the_file_again() {
        let plain = read("a.ply", PLY.as_bytes());
        for (format, name) in [(Format::PLY, "b.ply"), (Format::STL, "b.stl"), (Format::OBJ, "b.obj")] {
            let original = written(&plain, format);
            let mut file = read(name, &original);
            let flags: Vec<bool> = (0..file.faces().len()).map(|f| f == 0).collect();
            file.turn_faces(&flags).unwrap();
            let turned = written(&file, format);
            assert_ne!(turned, original, "{name}");
            let again = read(name, &turned);
            assert_eq!(again.faces().len(), file.faces().len());
            let corners = |file: &ShapeFile| -> Vec<[f64; 3]> {
                file.faces().get(0).iter().map(|&v| file.points()[v as usize]).collect()
            };
            assert_eq!(corners(&again), corners(&file), "{name}");
            file.turn_faces(&flags).unwrap();
            assert_eq!(written(&file, format), original, "{name}");
        }
    }

    #[test]
    fn normals_follow_if_they_belonged_to_the_old_front() {
        let text = |normal: &str, face: &str| {
            format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 {normal}\nvt 0 0\nvt 1 0\nvt 0 1\n{face}\n")
        };
        // The faces were turned by mistake: their normals are right already.
        let mut file = read("a.obj", text("-1", "f 1/1/1 2/2/1 3/3/1").as_bytes());
        file.turn_faces(&[true]).unwrap();
        let expected = text("-1", "f 1/1/1 3/3/1 2/2/1");
        assert_eq!(String::from_utf8(written(&file, Format::OBJ)).unwrap(), expected);
        // The normals are those of the faces.
        let mut file = read("a.obj", text("1", "f 1/1/1 2/2/1 3/3/1").as_bytes());
        file.turn_faces(&[true]).unwrap();
        let expected = text("-1", "f 1/1/1 3/3/1 2/2/1");
        assert_eq!(String::from_utf8(written(&file, Format::OBJ)).unwrap(), expected);
        let stl = written(&file, Format::STL_ASCII);
        assert!(String::from_utf8(stl).unwrap().contains("facet normal 0 0 -1"));
    }

    #[test]
    fn normals_of_stl_triangles_are_reversed_with_them() {
        let text = "solid one\nfacet normal 0 0 0.5\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                    endloop\nendfacet\nendsolid one\n";
        let mut file = read("a.stl", text.as_bytes());
        file.turn_faces(&[true]).unwrap();
        let turned = String::from_utf8(written(&file, Format::STL_ASCII)).unwrap();
        assert!(turned.contains("normal 0 0 -0.5"), "{turned}");
        assert!(turned.contains("vertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n"), "{turned}");
    }

    #[test]
    fn the_number_of_flags_is_checked() {
        let mut file = read("a.ply", PLY.as_bytes());
        let error = file.turn_faces(&[true]).unwrap_err();
        assert_eq!(error.to_string(), "expected 2 flags, one per face; got 1");
    }
}
