//! Subset of the lines of an OBJ, and the attributes of its corners.

use crate::formats::obj::line::words;
use crate::formats::obj::read::{NONE, logical_end};
use crate::model::subset::{Subset, distinct};
use crate::text::parse_f64;

/// Content that the faces of an OBJ refer to.
#[derive(Default)]
pub(super) struct ObjContent<'a> {
    /// Lines before the first vertex, and the libraries of materials.
    head: Vec<&'a [u8]>,
    texcoords: Vec<&'a [u8]>,
    pub(super) normals: Vec<&'a [u8]>,
    /// Texture coordinate and normal of each corner.
    pub(super) corners: Vec<[u32; 2]>,
    /// Index of the state of each corner's face.
    pub(super) state: Vec<u32>,
    /// Object, group, smoothing group and material lines that apply to a face.
    states: Vec<[&'a [u8]; 4]>,
    /// Vertices of each line element.
    lines: Vec<Vec<i64>>,
}

impl<'a> ObjContent<'a> {
    pub(super) fn parse(bytes: &'a [u8]) -> Self {
        let mut content = ObjContent::default();
        let mut now: [&[u8]; 4] = [b""; 4];
        let mut known = std::collections::HashMap::new();
        let (mut n_seen, mut position) = (0_usize, if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 });
        while position < bytes.len() {
            let end = logical_end(bytes, position);
            let line = bytes[position..end].trim_ascii();
            position = end + 1;
            let mut words = words(line);
            match words.next() {
                Some(b"v") => n_seen += 1,
                Some(b"vt") => content.texcoords.push(line),
                Some(b"vn") => content.normals.push(line),
                Some(b"f") => {
                    let next = known.len() as u32;
                    let state = *known.entry(now).or_insert_with(|| {
                        content.states.push(now);
                        next
                    });
                    for word in words {
                        let corner = content.corner(word);
                        content.corners.push(corner);
                        content.state.push(state);
                    }
                }
                Some(b"l") => content.lines.push(words.map(|word| vertex(word, n_seen)).collect()),
                Some(b"o") => now[0] = line,
                Some(b"g") => now[1] = line,
                Some(b"s") => now[2] = line,
                Some(b"usemtl") => now[3] = line,
                Some(b"mtllib") => content.head.push(line),
                None if n_seen == 0 && !line.is_empty() => content.head.push(line),
                _ => {}
            }
        }
        content
    }

    /// True if the faces of a state have no smoothing group: `s off` or `s 0`.
    pub(super) fn is_flat(&self, state: u32) -> bool {
        self.states.get(state as usize).is_some_and(|lines| {
            matches!(words(lines[2]).nth(1), Some(word) if word == b"0" || word.eq_ignore_ascii_case(b"off"))
        })
    }

    /// Texture coordinate and normal of a corner, or [`NONE`].
    fn corner(&self, word: &[u8]) -> [u32; 2] {
        let mut parts = word.split(|&b| b == b'/').skip(1);
        [self.texcoords.len(), self.normals.len()].map(|count| {
            let part = parts.next().unwrap_or(b"");
            let number = std::str::from_utf8(part).ok().and_then(|text| text.parse::<i64>().ok());
            let index = match number {
                Some(number) if number < 0 => count as i64 + number,
                Some(number) => number - 1,
                None => return NONE,
            };
            u32::try_from(index).unwrap_or(NONE)
        })
    }
}

/// Vertex named by a word of a line element, or −1.
fn vertex(word: &[u8], n_seen: usize) -> i64 {
    let number = word.split(|&b| b == b'/').next().unwrap_or(b"");
    let index = std::str::from_utf8(number).ok().and_then(|text| text.parse::<i64>().ok()).unwrap_or(0);
    if index < 0 { n_seen as i64 + index } else { index - 1 }
}

/// Labels of the corners: equal if texture coordinate and state are.
pub(super) fn labels(bytes: &[u8], n_corners: usize) -> Option<Vec<u32>> {
    let content = ObjContent::parse(bytes);
    if content.corners.len() != n_corners || (content.texcoords.is_empty() && content.states.len() < 2) {
        return None;
    }
    // Files repeat a coordinate for each face; equal coordinates are one position.
    let place = distinct(content.texcoords.len(), |k| {
        let numbers = words(content.texcoords[k]).skip(1).filter_map(parse_f64);
        numbers.map(|x| (x + 0.0).to_bits()).collect::<Vec<_>>()
    });
    let key = |k: usize| {
        let [texcoord, _] = content.corners[k];
        (place.get(texcoord as usize).copied().unwrap_or(NONE), content.state[k])
    };
    Some(distinct(n_corners, key))
}

/// Texture coordinates of the corners, 0 where there are none; `None` if no corner has any.
pub(super) fn corner_texcoords(bytes: &[u8], n_corners: usize) -> Option<Vec<f64>> {
    let content = ObjContent::parse(bytes);
    if content.corners.len() != n_corners || content.texcoords.is_empty() {
        return None;
    }
    let value = |&[texcoord, _]: &[u32; 2]| {
        let line = content.texcoords.get(texcoord as usize).copied().unwrap_or(b"");
        let mut numbers = words(line).skip(1).filter_map(parse_f64);
        [numbers.next().unwrap_or(0.0), numbers.next().unwrap_or(0.0)]
    };
    Some(content.corners.iter().flat_map(value).collect())
}

/// Text of the subset: the unchanged lines of kept vertices, the used texture coordinates and normals, and the new
/// triangles under the object, group, smoothing group and material of their corners.
pub(super) fn text(bytes: &[u8], rows: &[u64], n_corners: usize, subset: &Subset<'_>) -> Vec<u8> {
    let content = ObjContent::parse(bytes);
    let known = content.corners.len() == n_corners;
    let mut out = Vec::with_capacity(bytes.len() / 4 + 64);
    let push = |out: &mut Vec<u8>, line: &[u8]| {
        out.extend_from_slice(line);
        out.push(b'\n');
    };
    for line in &content.head {
        push(&mut out, line);
    }
    for &x in subset.vertices {
        let start = rows[x as usize] as usize;
        out.extend_from_slice(b"v ");
        push(&mut out, bytes[start..logical_end(bytes, start)].trim_ascii());
    }
    let mut used = [vec![NONE; content.texcoords.len()], vec![NONE; content.normals.len()]];
    for (kind, lines) in [&content.texcoords, &content.normals].into_iter().enumerate() {
        let mut n = 0;
        for &corner in subset.corners.as_flattened().iter().filter(|_| known) {
            let index = content.corners[corner as usize][kind] as usize;
            if let Some(place) = used[kind].get_mut(index).filter(|place| **place == NONE) {
                *place = n;
                n += 1;
                push(&mut out, lines[index]);
            }
        }
        if !known || subset.triangles.is_empty() {
            // No face refers to them: in a cloud they belong to the vertices, in order.
            for &x in subset.vertices.iter().filter(|_| lines.len() == rows.len()) {
                push(&mut out, lines[x as usize]);
            }
        }
    }
    push_faces(&mut out, &content, &used, subset, known);
    for line in &content.lines {
        for pair in line.windows(2) {
            let place = |x: i64| subset.vertices.binary_search(&u32::try_from(x).ok()?).ok();
            if let (Some(a), Some(b)) = (place(pair[0]), place(pair[1])) {
                out.extend_from_slice(format!("l {} {}\n", a + 1, b + 1).as_bytes());
            }
        }
    }
    if subset.vertices.is_empty() {
        push(&mut out, b"# no vertices");
    }
    out
}

fn push_faces(
    out: &mut Vec<u8>,
    content: &ObjContent<'_>,
    used: &[Vec<u32>; 2],
    subset: &Subset<'_>,
    known: bool,
) {
    let state = |t: usize| if known { content.state[subset.corners[t][0] as usize] } else { 0 };
    let mut order: Vec<usize> = (0..subset.triangles.len()).collect();
    order.sort_by_key(|&t| state(t));
    let mut now: [&[u8]; 4] = [b""; 4];
    for t in order {
        if known {
            for (line, now) in content.states[state(t) as usize].iter().zip(&mut now) {
                if line != now {
                    out.extend_from_slice(line);
                    out.push(b'\n');
                    *now = line;
                }
            }
        }
        out.push(b'f');
        for (&x, &corner) in subset.triangles[t].iter().zip(&subset.corners[t]) {
            let at = |kind: usize| {
                let index = if known { content.corners[corner as usize][kind] } else { NONE };
                used[kind].get(index as usize).filter(|&&place| place != NONE).map(|place| place + 1)
            };
            let x = x + 1;
            let corner = match (at(0), at(1)) {
                (None, None) => format!(" {x}"),
                (Some(texcoord), None) => format!(" {x}/{texcoord}"),
                (None, Some(normal)) => format!(" {x}//{normal}"),
                (Some(texcoord), Some(normal)) => format!(" {x}/{texcoord}/{normal}"),
            };
            out.extend_from_slice(corner.as_bytes());
        }
        out.push(b'\n');
    }
}
