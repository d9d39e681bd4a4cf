//! AMF reader: joins the objects of the file, placed by its constellations, to one shape.

use std::collections::{HashMap, HashSet};

use adwave::Progress;
use roxmltree::Node;

use crate::bytes::package::Package;
use crate::model::instances::{MergedMesh, Transform};
use crate::progress::report_row;
use crate::text::xml::{child, children, parse, text_of, wrong};
use crate::text::{parse_f64, show};
use crate::{Field, FieldValues, Format, LengthUnit, ReadError, ReadLimits, ShapeFile};

/// Largest nesting of constellations; one that contains itself would never end.
const DEEPEST: usize = 64;

/// Red, green, blue and, if present, alpha.
type Color = [f64; 4];

/// One object of the file.
#[derive(Default)]
struct Object {
    points: Vec<[f64; 3]>,
    colors: Vec<Option<Color>>,
    triangles: Vec<[u32; 3]>,
    of_triangles: Vec<Option<Color>>,
    /// Volume of each triangle, numbered over the whole file.
    volumes: Vec<u32>,
}

/// Content of a placement: an object or a constellation of others.
enum PlacementTarget {
    Object(Object),
    Constellation(Vec<(String, Transform)>),
}

struct Assembly<'a> {
    placed: HashMap<String, PlacementTarget>,
    joined: MergedMesh<'a>,
    colors: Vec<Option<Color>>,
    of_triangles: Vec<Option<Color>>,
    volumes: Vec<u32>,
    n_bytes: usize,
    n_visits: u64,
    progress: Progress<'a>,
}

/// Reads an AMF, plain or in an archive.
pub(crate) fn read_amf(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let text = if bytes.starts_with(b"PK") {
        let mut package = Package::open(&bytes, limits)?;
        let missing = || ReadError::Whole("the archive contains no AMF; get the whole file".into());
        let name = package.find(".amf").ok_or_else(missing)?;
        package.text(&name, progress)?
    } else {
        let broken = |e: std::string::FromUtf8Error| {
            let at = e.utf8_error().valid_up_to();
            ReadError::line_error(e.as_bytes(), at, "the text must be UTF-8; save it as UTF-8")
        };
        crate::text::encoding::to_utf8(bytes).map_err(broken)?
    };
    let document = parse(&text)?;
    let root = document.root_element();
    let colors_of_materials: HashMap<&str, Color> =
        children(root, "material").filter_map(|node| Some((node.attribute("id")?, color(node)?))).collect();
    let mut placed = HashMap::new();
    let mut order = Vec::new();
    let mut inner = HashSet::new();
    let mut n_volumes = 0;
    for node in root.children().filter(Node::is_element) {
        progress.check()?;
        let id = node.attribute("id").unwrap_or("").to_owned();
        let own = match node.tag_name().name() {
            "object" => {
                PlacementTarget::Object(object(node, &colors_of_materials, &mut n_volumes, progress)?)
            }
            "constellation" => PlacementTarget::Constellation(constellation(node, &mut inner)?),
            _ => continue,
        };
        if placed.insert(id.clone(), own).is_some() {
            let message = format!("ids must be unique, but {} occurs twice; rename one", show(id.as_bytes()));
            return Err(wrong(node, message));
        }
        order.push(id);
    }
    let mut assembly = Assembly {
        placed,
        joined: MergedMesh::new(limits, text.len()),
        colors: Vec::new(),
        of_triangles: Vec::new(),
        volumes: Vec::new(),
        n_bytes: text.len(),
        n_visits: 0,
        progress,
    };
    for id in order.iter().filter(|id| !inner.contains(*id)) {
        assembly.place(id, &Transform::IDENTITY, 0)?;
    }
    let mut shape = assembly.finish(n_volumes)?;
    for (name, what) in [("metadata", "metadata"), ("material", "materials"), ("texture", "textures")] {
        if root.descendants().any(|node| node.has_tag_name(name)) {
            shape.extras.push(what.into());
        }
    }
    let unit = root.attribute("unit").unwrap_or("millimeter");
    shape.unit = LengthUnit::from_name(unit).or_else(|| {
        let text = format!(
            "the unit of length {} is not known; the numbers stay as they are, until the file states another",
            show(unit.as_bytes())
        );
        shape.notes.push(text);
        Some(LengthUnit::from_unknown_name(unit))
    });
    Ok(shape)
}

/// Number in the child element of that name; 0 if it is missing.
fn number(node: Node<'_, '_>, name: &'static str) -> Result<f64, ReadError> {
    let Some(text) = text_of(node, name) else { return Ok(0.0) };
    parse_f64(text.as_bytes())
        .ok_or_else(|| wrong(node, format!("`{name}` must be a number, got {}", show(text.as_bytes()))))
}

/// Color in a node; `None` for a color given by a formula.
fn color(node: Node<'_, '_>) -> Option<Color> {
    let own = child(node, "color")?;
    let part = |name| text_of(own, name).and_then(|text| parse_f64(text.as_bytes()));
    Some([part("r")?, part("g")?, part("b")?, part("a").unwrap_or(f64::NAN)])
}

fn object(
    node: Node<'_, '_>,
    materials: &HashMap<&str, Color>,
    n_volumes: &mut u32,
    progress: Progress<'_>,
) -> Result<Object, ReadError> {
    let mut object = Object::default();
    let of_object = color(node);
    for mesh in children(node, "mesh") {
        let first = object.points.len();
        for (row, vertex) in child(mesh, "vertices").iter().flat_map(|v| children(*v, "vertex")).enumerate() {
            report_row(progress, row as u64, 0)?;
            let Some(place) = child(vertex, "coordinates") else {
                return Err(wrong(vertex, format!("vertex {row} has no coordinates; add them")));
            };
            let axis = |name| match text_of(place, name) {
                Some(_) => number(place, name),
                None => Err(wrong(place, format!("vertex {row} has no `{name}`; add it"))),
            };
            object.points.push([axis("x")?, axis("y")?, axis("z")?]);
            object.colors.push(color(vertex));
        }
        for volume in children(mesh, "volume") {
            let of_material = volume.attribute("materialid").and_then(|id| materials.get(id).copied());
            let of_volume = color(volume).or(of_material).or(of_object);
            for (row, triangle) in children(volume, "triangle").enumerate() {
                report_row(progress, row as u64, 0)?;
                let mut corners = [0; 3];
                for (corner, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
                    let index: i64 = text_of(triangle, name).and_then(|t| t.parse().ok()).unwrap_or(-1);
                    let n_vertices = object.points.len() - first;
                    let vertex = usize::try_from(index).ok().filter(|&v| v < n_vertices);
                    let vertex = vertex.ok_or_else(|| ReadError::FaceIndex {
                        place: format!(
                            "line {}",
                            triangle.document().text_pos_at(triangle.range().start).row
                        ),
                        face: row as u64,
                        index,
                        n_vertices: n_vertices as u64,
                    })?;
                    *corner = (first + vertex) as u32;
                }
                object.triangles.push(corners);
                object.of_triangles.push(color(triangle).or(of_volume));
                object.volumes.push(*n_volumes);
            }
            *n_volumes += 1;
        }
    }
    Ok(object)
}

fn constellation(
    node: Node<'_, '_>,
    inner: &mut HashSet<String>,
) -> Result<Vec<(String, Transform)>, ReadError> {
    let mut instances = Vec::new();
    for own in children(node, "instance") {
        let Some(id) = own.attribute("objectid") else {
            return Err(wrong(own, "the instance has no objectid; add it"));
        };
        inner.insert(id.to_owned());
        let turn = [number(own, "rx")?, number(own, "ry")?, number(own, "rz")?];
        let shift = [number(own, "deltax")?, number(own, "deltay")?, number(own, "deltaz")?];
        instances.push((id.to_owned(), placement(turn, shift)));
    }
    Ok(instances)
}

/// Rotation about x, then y, then z, in degrees, followed by a translation.
fn placement(turn: [f64; 3], shift: [f64; 3]) -> Transform {
    let mut transform = Transform::IDENTITY;
    for (axis, degrees) in turn.into_iter().enumerate().filter(|(_, degrees)| *degrees != 0.0) {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut own = Transform::IDENTITY;
        own.0[3 * a + a] = cos;
        own.0[3 * a + b] = sin;
        own.0[3 * b + a] = -sin;
        own.0[3 * b + b] = cos;
        transform = transform.then(&own);
    }
    let mut moved = Transform::IDENTITY;
    moved.0[9..].copy_from_slice(&shift);
    transform.then(&moved)
}

impl Assembly<'_> {
    fn place(&mut self, id: &str, transform: &Transform, depth: usize) -> Result<(), ReadError> {
        self.n_visits += 1;
        report_row(self.progress, self.n_visits, 0)?;
        if depth > DEEPEST || self.n_visits > 1_000_000 + self.n_bytes as u64 / 16 {
            let message = "constellations are nested too deeply; check whether one contains itself";
            return Err(ReadError::Whole(message.into()));
        }
        let instances = match self.placed.get(id) {
            None => {
                let message =
                    format!("the placed object {} does not exist; correct the id", show(id.as_bytes()));
                return Err(ReadError::Whole(message));
            }
            Some(PlacementTarget::Object(object)) => {
                self.joined.add(&object.points, &object.triangles, transform, self.progress)?;
                self.colors.extend_from_slice(&object.colors);
                self.of_triangles.extend_from_slice(&object.of_triangles);
                self.volumes.extend_from_slice(&object.volumes);
                return Ok(());
            }
            Some(PlacementTarget::Constellation(instances)) => instances.clone(),
        };
        for (id, own) in instances {
            self.place(&id, &own.then(transform), depth + 1)?;
        }
        Ok(())
    }

    fn finish(self, n_volumes: u32) -> Result<ShapeFile, ReadError> {
        let mut shape = self.joined.into_shape(self.progress)?;
        shape.format = Some(Format::AMF);
        shape.vertex_fields.extend(field(&self.colors));
        if n_volumes > 1 {
            shape.face_fields.push(Field::new("volume", 1, FieldValues::U32(self.volumes)));
        }
        shape.face_fields.extend(field(&self.of_triangles));
        Ok(shape)
    }
}

/// Colors as a field, NaN where a color is missing; `None` if there are no colors.
fn field(colors: &[Option<Color>]) -> Option<Field> {
    if !colors.iter().any(Option::is_some) {
        return None;
    }
    let has_alpha = colors.iter().flatten().any(|c| !c[3].is_nan());
    let n_channels = if has_alpha { 4 } else { 3 };
    let values =
        colors.iter().flat_map(|c| c.unwrap_or([f64::NAN; 4]).into_iter().take(n_channels)).collect();
    Some(Field::new("color", n_channels, FieldValues::F64(values)))
}
