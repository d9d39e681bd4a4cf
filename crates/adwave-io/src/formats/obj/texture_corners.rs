//! Texture coordinates and materials of the vertices of an OBJ.
//!
//! This is a second pass over the file, because [`ShapeFile`](crate::ShapeFile) keeps texture coordinates only if
//! each vertex has a single one, whereas a vertex on a seam has several.

use crate::text::{line_end, parse_f64, words};

/// Vertex with a texture coordinate and a material; each combination occurs once.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    pub(super) vertex: u32,
    pub(super) material: u32,
    pub(super) texcoord: u32,
}

/// Texture-related content of an OBJ.
pub(super) struct Corners {
    pub(super) texcoords: Vec<[f64; 2]>,
    pub(super) places: Vec<Place>,
    /// Names of the materials; the first (empty) one is for faces before any `usemtl`.
    pub(super) materials: Vec<String>,
    /// Files of materials.
    pub(super) libraries: Vec<String>,
}

impl Corners {
    /// Parses the relevant lines; malformed ones have already been rejected by the reader of shapes.
    pub(super) fn parse(bytes: &[u8], n_vertices: usize) -> Self {
        let mut corners = Self {
            texcoords: Vec::new(),
            places: Vec::new(),
            materials: vec![String::new()],
            libraries: Vec::new(),
        };
        let (mut n_seen, mut material, mut position) = (0_usize, 0_u32, 0);
        while position < bytes.len() {
            let end = line_end(bytes, position);
            let line = bytes[position..end].trim_ascii();
            position = end + 1;
            let rest = |keyword: &str| {
                let text = line.strip_prefix(keyword.as_bytes())?;
                Some(String::from_utf8_lossy(text.trim_ascii()).into_owned())
            };
            let mut words = words(line);
            match words.next() {
                Some(b"v") => n_seen += 1,
                Some(b"vt") => {
                    let mut number = || words.next().and_then(parse_f64).unwrap_or(0.0);
                    corners.texcoords.push([number(), number()]);
                }
                Some(b"f" | b"fo") => {
                    for word in words {
                        corners.corner(word, material, n_seen, n_vertices);
                    }
                }
                Some(b"usemtl") => {
                    let name = rest("usemtl").unwrap_or_default();
                    let known = corners.materials.iter().position(|m| *m == name);
                    material = known.unwrap_or_else(|| {
                        corners.materials.push(name);
                        corners.materials.len() - 1
                    }) as u32;
                }
                Some(b"mtllib") => corners.libraries.extend(rest("mtllib")),
                _ => {}
            }
        }
        let n_texcoords = corners.texcoords.len() as u32;
        corners.places.retain(|p| p.texcoord < n_texcoords);
        corners.places.sort_unstable();
        corners.places.dedup();
        corners
    }

    fn corner(&mut self, word: &[u8], material: u32, n_seen: usize, n_vertices: usize) {
        let mut parts = word.split(|&b| b == b'/');
        let mut index = |count: usize| {
            let number: i64 = std::str::from_utf8(parts.next()?).ok()?.parse().ok()?;
            // Negative indices count back from the last item read.
            let index = if number < 0 { count as i64 + number } else { number - 1 };
            u32::try_from(index).ok()
        };
        let vertex = index(n_seen);
        let texcoord = index(self.texcoords.len());
        if let (Some(vertex), Some(texcoord)) = (vertex, texcoord)
            && (vertex as usize) < n_vertices
        {
            self.places.push(Place { vertex, material, texcoord });
        }
    }
}
