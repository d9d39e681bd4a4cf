//! Reader for the objects of Geomview, joined to one shape.

use crate::formats::off::split_keyword;
use crate::model::file_head::FileHead;
use adwave::Progress;
use adwave::shape::Polygons;

use crate::formats::geomview::grid::{letters, read_grid};
use crate::progress::report_row;
use crate::text::tokens::Tokens;
use crate::text::{is_space, show};
use crate::{Edges, Field, FieldValues, Format, ReadError, ReadLimits, ShapeFile};

/// Largest nesting of lists.
const DEEPEST: usize = 64;

/// Shape built from the objects read so far.
#[derive(Default)]
pub(crate) struct GeomviewScene {
    pub(crate) points: Vec<[f64; 3]>,
    /// Fourth coordinate of each point, 1 if there is none.
    w: Vec<f64>,
    normals: Vec<[f64; 4]>,
    colors: Vec<[f64; 4]>,
    pub(crate) faces: Polygons,
    edges: Vec<[u32; 2]>,
    /// End of each object's faces.
    ends: Vec<usize>,
    has_appearance: bool,
}

impl GeomviewScene {
    pub(crate) fn push(&mut self, [x, y, z, w]: [f64; 4], normal: Option<[f64; 4]>, color: Option<[f64; 4]>) {
        let row = self.points.len();
        self.points.push([x, y, z]);
        self.w.push(w);
        for (list, value) in [(&mut self.normals, normal), (&mut self.colors, color)] {
            if let Some(value) = value {
                list.resize(row, [f64::NAN; 4]);
                list.push(value);
            }
        }
    }

    pub(crate) fn end_object(&mut self) {
        self.ends.push(self.faces.len());
    }

    fn into_shape(mut self) -> ShapeFile {
        let (n, n_faces) = (self.points.len(), self.faces.len());
        let mut shape = ShapeFile::from_mesh(self.points, self.faces);
        shape.format = Some(Format::GEOMVIEW);
        for (name, list, n_channels) in [("normal", &mut self.normals, 3), ("color", &mut self.colors, 4)] {
            if !list.is_empty() {
                list.resize(n, [f64::NAN; 4]);
                let values = list.iter().flat_map(|v| &v[..n_channels]).copied().collect();
                shape.vertex_fields.push(Field::new(name, n_channels, FieldValues::F64(values)));
            }
        }
        if self.w.iter().any(|&w| w != 1.0) {
            shape.vertex_fields.push(Field::new("w", 1, FieldValues::F64(self.w)));
            crate::formats::off::read::divide(&mut shape);
        }
        shape.edges = Edges { pairs: self.edges, ..Edges::default() };
        if self.ends.len() > 1 && n_faces > 0 {
            let object = (0..n_faces).map(|f| self.ends.partition_point(|&end| end <= f) as u32).collect();
            shape.face_fields.push(Field::new("object", 1, FieldValues::U32(object)));
        }
        if self.has_appearance {
            shape.extras.push("appearance".into());
        }
        shape
    }
}

/// True if the first word is an object of Geomview, in braces or not.
pub(crate) fn is_geomview(file: &FileHead<'_>) -> bool {
    let Some(inside) = file.head.trim_ascii_start().strip_prefix(b"{") else {
        return file.keyword().is_some_and(begins_object);
    };
    let words = crate::text::words(inside).map(|w| w.strip_prefix(b"{").unwrap_or(w));
    words.filter(|w| !w.is_empty()).take(1).any(|w| {
        begins_object(w)
            || split_keyword(w).is_some()
            || matches!(w, b"=" | b"appearance" | b"geom" | b"define" | b"INST")
    })
}

/// True if a word begins an object of Geomview other than OFF.
pub(crate) fn begins_object(word: &[u8]) -> bool {
    letters(word).is_some()
        || polygons(word).is_some()
        || matches!(word, b"LIST" | b"VECT" | b"SKEL" | b"4SKEL")
}

/// `[C][N][4]QUAD` and `POLY`: presence of normals, colors and a fourth coordinate.
fn polygons(word: &[u8]) -> Option<[bool; 3]> {
    let own = word.strip_suffix(b"QUAD").or_else(|| word.strip_suffix(b"POLY"))?;
    own.iter().all(|b| b"CN4".contains(b)).then(|| [b'N', b'C', b'4'].map(|letter| own.contains(&letter)))
}

/// Reads a file of Geomview.
pub(crate) fn read_geomview(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut scene = GeomviewScene::default();
    let mut tokens = Tokens::new(bytes, if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 });
    let mut reader = Reader { scene: &mut scene, limits, progress };
    reader.object(&mut tokens, 0)?;
    Ok(scene.into_shape())
}

struct Reader<'a> {
    scene: &'a mut GeomviewScene,
    limits: &'a ReadLimits,
    progress: Progress<'a>,
}

/// Reads the next word; a brace is a word of its own.
fn word<'a>(tokens: &mut Tokens<'a>) -> Option<(usize, &'a [u8])> {
    tokens.skip();
    let (start, bytes) = (tokens.position, tokens.bytes);
    let is_brace = |b: u8| matches!(b, b'{' | b'}' | b'(' | b')');
    let first = *bytes.get(start)?;
    let end = if is_brace(first) {
        start + 1
    } else {
        let stop = |&b: &u8| is_space(b) || is_brace(b) || b == b'#';
        bytes[start..].iter().position(stop).map_or(bytes.len(), |n| start + n)
    };
    tokens.position = end;
    Some((start, &bytes[start..end]))
}

impl Reader<'_> {
    /// Reads one object, with or without braces.
    fn object(&mut self, tokens: &mut Tokens<'_>, depth: usize) -> Result<(), ReadError> {
        if depth > DEEPEST {
            return Err(ReadError::line_error(
                tokens.bytes,
                tokens.position,
                "objects are nested too deeply",
            ));
        }
        self.progress.check()?;
        loop {
            let ends =
                || ReadError::line_error(tokens.bytes, tokens.bytes.len(), "the file ends before an object");
            let Some((start, found)) = word(&mut tokens.clone()) else { return Err(ends()) };
            let wrong = |message: String| ReadError::line_error(tokens.bytes, start, message);
            match found {
                b"{" => {
                    word(tokens);
                    self.object(tokens, depth + 1)?;
                    let Some((_, b"}")) = word(&mut tokens.clone()) else {
                        return Err(ReadError::line_error(
                            tokens.bytes,
                            tokens.position,
                            "a closing } is missing here",
                        ));
                    };
                    word(tokens);
                    return Ok(());
                }
                b"=" | b"geom" => drop(word(tokens)),
                b"appearance" => {
                    word(tokens);
                    self.scene.has_appearance = true;
                    skip_braces(tokens)?;
                }
                b"define" => {
                    word(tokens);
                    word(tokens);
                }
                b"LIST" => {
                    word(tokens);
                    while let Some((_, next)) = word(&mut tokens.clone())
                        && next != b"}"
                    {
                        self.object(tokens, depth + 1)?;
                    }
                    return Ok(());
                }
                _ => {
                    if let Some(letters) = letters(found) {
                        word(tokens);
                        return read_grid(tokens, letters, self.scene, self.limits, self.progress);
                    }
                    if let Some(parts) = polygons(found) {
                        word(tokens);
                        return self.quadrilaterals(tokens, parts);
                    }
                    return match found {
                        b"SKEL" | b"4SKEL" => self.skeleton(tokens),
                        b"VECT" => self.vectors(tokens),
                        _ if split_keyword(found).is_some() => self.read_off_object(tokens, start),
                        _ => Err(wrong(format!(
                            "{} is not a supported mesh of Geomview; save the scene as OFF",
                            show(found)
                        ))),
                    };
                }
            }
        }
    }

    /// Reads quadrilaterals of four vertices each, up to a brace or the end.
    fn quadrilaterals(
        &mut self,
        tokens: &mut Tokens<'_>,
        [has_normal, has_color, has_w]: [bool; 3],
    ) -> Result<(), ReadError> {
        let mut row = 0;
        while let Some((_, next)) = word(&mut tokens.clone())
            && next != b"}"
        {
            report_row(self.progress, row, 0)?;
            let mut numbers = [0.0, 0.0, 0.0, 1.0];
            for x in &mut numbers[..if has_w { 4 } else { 3 }] {
                *x = tokens.number("vertex", row)?;
            }
            let mut part = |is_there: bool, n: usize| -> Result<Option<[f64; 4]>, ReadError> {
                let mut values = [f64::NAN; 4];
                for x in &mut values[..if is_there { n } else { 0 }] {
                    *x = tokens.number("vertex", row)?;
                }
                Ok(is_there.then_some(values))
            };
            let (normal, color) = (part(has_normal, 3)?, part(has_color, 4)?);
            self.scene.push(numbers, normal, color);
            row += 1;
            if row.is_multiple_of(4) {
                let end = self.scene.points.len() as u32;
                self.scene.faces.push(&[end - 4, end - 3, end - 2, end - 1]);
            }
        }
        if !row.is_multiple_of(4) {
            return Err(tokens.wrong("vertex", row, "a number of a quadrilateral"));
        }
        self.limits.check_points(self.scene.points.len() as u64)?;
        self.scene.end_object();
        Ok(())
    }

    /// Reads a `SKEL`: counts, vertices, then lines of shared vertices.
    fn skeleton(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
        let has_w = word(tokens).is_some_and(|(_, w)| w.starts_with(b"4"));
        let n_vertices = tokens.count("the number of vertices", 0)?;
        let n_lines = tokens.count("the number of lines", 0)?;
        self.limits.check_points(n_vertices.saturating_add(self.scene.points.len() as u64))?;
        tokens.check(n_vertices, 6, "vertex")?;
        let first = self.scene.points.len() as u32;
        for row in 0..n_vertices {
            report_row(self.progress, row, n_vertices)?;
            let mut numbers = [0.0, 0.0, 0.0, 1.0];
            for x in &mut numbers[..if has_w { 4 } else { 3 }] {
                *x = tokens.number("vertex", row)?;
            }
            self.scene.push(numbers, None, None);
        }
        tokens.check(n_lines, 2, "line")?;
        for row in 0..n_lines {
            report_row(self.progress, row, n_lines)?;
            let mut previous = None;
            for _ in 0..tokens.count("line", row)? {
                let vertex = tokens.count("line", row)?;
                if vertex >= n_vertices {
                    let message =
                        format!("line {row} names vertex {vertex}, but there are {n_vertices}; correct it");
                    return Err(ReadError::line_error(tokens.bytes, tokens.position, message));
                }
                let vertex = first + vertex as u32;
                self.scene.edges.extend(previous.map(|before| [before, vertex]));
                previous = Some(vertex);
            }
            // A color may follow at the end of the line.
            let end = crate::text::line_end(tokens.bytes, tokens.position);
            let rest = crate::text::words(&tokens.bytes[tokens.position..end]).take_while(|w| w[0] != b'}');
            if rest.count() == 4 {
                for _ in 0..4 {
                    tokens.number("line", row)?;
                }
            }
        }
        self.scene.end_object();
        Ok(())
    }

    /// Reads a `VECT`: counts, sizes of lines and numbers of colors, then vertices, then colors.
    fn vectors(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
        word(tokens);
        let mut counts = [0; 3];
        for count in &mut counts {
            *count = tokens.count("the counts", 0)?;
        }
        let [n_lines, n_vertices, n_colors] = counts;
        self.limits.check_points(n_vertices.saturating_add(self.scene.points.len() as u64))?;
        tokens.check(n_lines, 4, "line")?;
        let mut sizes = Vec::new();
        for row in 0..n_lines {
            // A negative number marks a closed line.
            sizes.push(tokens.integer("line", row)?);
        }
        for row in 0..n_lines {
            tokens.count("line", row)?;
        }
        if sizes.iter().try_fold(0_u64, |sum, n| sum.checked_add(n.unsigned_abs())) != Some(n_vertices) {
            let message = "the vertices of the lines must add up to the number of vertices; correct the \
                          counts";
            return Err(ReadError::line_error(tokens.bytes, tokens.position, message));
        }
        tokens.check(n_vertices, 6, "vertex")?;
        for size in sizes {
            let first = self.scene.points.len() as u32;
            let n = size.unsigned_abs() as u32;
            for k in 0..n {
                let row = u64::from(first + k);
                report_row(self.progress, row, n_vertices)?;
                let mut numbers = [0.0, 0.0, 0.0, 1.0];
                for x in &mut numbers[..3] {
                    *x = tokens.number("vertex", row)?;
                }
                self.scene.push(numbers, None, None);
                self.scene.edges.extend((k > 0).then(|| [first + k - 1, first + k]));
            }
            self.scene.edges.extend((size < -1).then(|| [first + n - 1, first]));
        }
        tokens.check(n_colors, 8, "color")?;
        for row in 0..4 * n_colors {
            tokens.number("color", row)?;
        }
        self.scene.end_object();
        Ok(())
    }

    /// Reads an OFF within a list, up to the brace that ends it.
    fn read_off_object(&mut self, tokens: &mut Tokens<'_>, start: usize) -> Result<(), ReadError> {
        let rest = &tokens.bytes[start..];
        let end = memchr::memchr2(b'}', b'{', rest).unwrap_or(rest.len());
        let file = crate::formats::off::read::read_off(rest[..end].to_vec(), self.limits, self.progress)
            .map_err(|e| match e {
                ReadError::Line { line, message } => {
                    let before = crate::text::line_of(tokens.bytes, start) - 1;
                    ReadError::Line { line: before + line, message }
                }
                other => other,
            })?;
        self.limits.check_points((self.scene.points.len() + file.n_vertices) as u64)?;
        let first = self.scene.points.len() as u32;
        let row = |name: &str, i: usize| {
            let field = file.field(name)?;
            let mut values = [f64::NAN; 4];
            (0..field.n_channels.min(4)).for_each(|c| values[c] = field.get(i, c));
            Some(values)
        };
        for (i, &[x, y, z]) in file.points.iter().enumerate() {
            report_row(self.progress, i as u64, file.n_vertices as u64)?;
            let w = row("w", i).map_or(1.0, |w| w[0]);
            self.scene.push([x, y, z, w], row("normal", i), row("color", i));
        }
        for face in file.faces.iter() {
            self.scene.faces.push(&face.iter().map(|v| first + v).collect::<Vec<_>>());
        }
        tokens.position = start + end;
        self.scene.end_object();
        Ok(())
    }
}

/// Skips content in braces.
fn skip_braces(tokens: &mut Tokens<'_>) -> Result<(), ReadError> {
    let mut depth = 0_usize;
    while let Some((_, found)) = word(tokens) {
        match found {
            b"{" => depth += 1,
            b"}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return Ok(());
        }
    }
    Err(ReadError::line_error(tokens.bytes, tokens.bytes.len(), "a closing } is missing; get the whole file"))
}
