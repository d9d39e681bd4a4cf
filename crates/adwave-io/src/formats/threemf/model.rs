//! Model of a 3MF: its objects, colors and build items.

use std::collections::HashMap;

use adwave::Progress;
use roxmltree::Node;

use crate::formats::threemf::UNITS;
use crate::model::instances::Transform;
use crate::progress::report_row;
use crate::text::xml::{child, children, integer, number, parse, wrong};
use crate::text::{parse_f64, show};
use crate::{LengthUnit, ReadError};

/// Red, green, blue, alpha.
pub(crate) type Color = [u8; 4];

/// Placed object of this model or of another part.
pub(crate) struct Component {
    pub(crate) path: Option<String>,
    pub(crate) id: u32,
    pub(crate) transform: Transform,
}

/// Content of an object.
#[derive(Default)]
pub(crate) struct Object {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Colors of the corners of each triangle; empty if no corner has one.
    pub(crate) colors: Vec<[Option<Color>; 3]>,
    pub(crate) components: Vec<Component>,
}

/// Model of a part.
pub(crate) struct Model {
    pub(crate) unit: LengthUnit,
    pub(crate) objects: HashMap<u32, Object>,
    /// Ids in the order of the file.
    pub(crate) ids: Vec<u32>,
    pub(crate) built: Vec<Component>,
    /// True if a triangle has colors of its corners instead of a single one.
    pub(crate) has_corners: bool,
    /// True if a color has transparency.
    pub(crate) has_alpha: bool,
    /// True if there are materials or textures that are not read.
    pub(crate) has_materials: bool,
}

/// Colors by group and index.
type Groups = HashMap<u32, Vec<Option<Color>>>;

/// The property that an object gives its triangles.
#[derive(Clone, Copy)]
struct Property {
    group: Option<u32>,
    index: Option<u32>,
}

impl Model {
    pub(crate) fn parse(text: &str, progress: Progress<'_>) -> Result<Self, ReadError> {
        let document = parse(text)?;
        let root = document.root_element();
        if root.tag_name().name() != "model" {
            return Err(wrong(root, "the part has no model; get the whole file"));
        }
        let name = root.attribute("unit").unwrap_or("millimeter");
        let Some(unit) = LengthUnit::from_name(name).filter(|unit| UNITS.contains(unit)) else {
            let units = UNITS.each_ref().map(LengthUnit::name).join(", ");
            let message = format!(
                "the unit of length must be one of {units}, got {}; correct it",
                show(name.as_bytes())
            );
            return Err(wrong(root, message));
        };
        let mut model = Self {
            unit,
            objects: HashMap::new(),
            ids: Vec::new(),
            built: Vec::new(),
            has_corners: false,
            has_alpha: false,
            has_materials: false,
        };
        let mut groups = Groups::new();
        for node in child(root, "resources").iter().flat_map(Node::children).filter(Node::is_element) {
            progress.check()?;
            match node.tag_name().name() {
                "object" => model.object(node, &groups, progress)?,
                "colorgroup" => model.group(node, &mut groups, "color", "color")?,
                "basematerials" => model.group(node, &mut groups, "base", "displaycolor")?,
                _ => model.has_materials = true,
            }
        }
        for node in child(root, "build").into_iter().flat_map(|build| children(build, "item")) {
            model.built.push(component(node)?);
        }
        Ok(model)
    }

    fn group(
        &mut self,
        node: Node<'_, '_>,
        groups: &mut Groups,
        element: &'static str,
        attribute: &str,
    ) -> Result<(), ReadError> {
        let Some(id) = integer(node, "id")? else { return Ok(()) };
        let mut colors = Vec::new();
        for own in children(node, element) {
            let color = own.attribute(attribute).and_then(color);
            self.has_alpha |= color.is_some_and(|(_, has_alpha)| has_alpha);
            colors.push(color.map(|(color, _)| color));
        }
        groups.insert(id, colors);
        Ok(())
    }

    fn object(
        &mut self,
        node: Node<'_, '_>,
        groups: &Groups,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        let Some(id) = integer(node, "id")? else { return Err(wrong(node, "an object has no id; add it")) };
        let mut object = Object::default();
        if let Some(components) = child(node, "components") {
            for own in children(components, "component") {
                object.components.push(component(own)?);
            }
        }
        if let Some(mesh) = child(node, "mesh") {
            for (row, vertex) in
                child(mesh, "vertices").iter().flat_map(|v| children(*v, "vertex")).enumerate()
            {
                report_row(progress, row as u64, 0)?;
                object.points.push([number(vertex, "x")?, number(vertex, "y")?, number(vertex, "z")?]);
            }
            let own = Property { group: integer(node, "pid")?, index: integer(node, "pindex")? };
            for (row, face) in
                child(mesh, "triangles").iter().flat_map(|t| children(*t, "triangle")).enumerate()
            {
                report_row(progress, row as u64, 0)?;
                self.triangle(face, row, &mut object, own, groups)?;
            }
        }
        if self.objects.insert(id, object).is_some() {
            return Err(wrong(
                node,
                format!("ids must be unique, but there are two objects of id {id}; rename one"),
            ));
        }
        self.ids.push(id);
        Ok(())
    }

    fn triangle(
        &mut self,
        node: Node<'_, '_>,
        row: usize,
        object: &mut Object,
        own: Property,
        groups: &Groups,
    ) -> Result<(), ReadError> {
        let mut corners = [0; 3];
        for (corner, name) in corners.iter_mut().zip(["v1", "v2", "v3"]) {
            let index = integer::<i64>(node, name)?.unwrap_or(-1);
            let vertex = u32::try_from(index).ok().filter(|&v| (v as usize) < object.points.len());
            *corner = vertex.ok_or_else(|| ReadError::FaceIndex {
                place: format!("line {}", node.document().text_pos_at(node.range().start).row),
                face: row as u64,
                index,
                n_vertices: object.points.len() as u64,
            })?;
        }
        object.triangles.push(corners);
        let group = integer(node, "pid")?.or(own.group).and_then(|pid: u32| groups.get(&pid));
        let Some(group) = group else {
            if !object.colors.is_empty() {
                object.colors.push([None; 3]);
            }
            return Ok(());
        };
        let first = integer::<u32>(node, "p1")?;
        let others = [integer::<u32>(node, "p2")?, integer::<u32>(node, "p3")?];
        self.has_corners |= others.iter().any(Option::is_some);
        let color = |index: Option<u32>| index.and_then(|k| group.get(k as usize).copied().flatten());
        let first = first.or(own.index);
        object.colors.resize(row, [None; 3]);
        object.colors.push([color(first), color(others[0].or(first)), color(others[1].or(first))]);
        Ok(())
    }
}

/// Parses `#RRGGBB` or `#RRGGBBAA`; also returns true for the latter.
fn color(text: &str) -> Option<(Color, bool)> {
    let digits = text.trim().strip_prefix('#')?;
    if !matches!(digits.len(), 6 | 8) || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let byte = |k: usize| digits.get(2 * k..2 * k + 2).map_or(Some(255), |d| u8::from_str_radix(d, 16).ok());
    Some(([byte(0)?, byte(1)?, byte(2)?, byte(3)?], digits.len() == 8))
}

fn component(node: Node<'_, '_>) -> Result<Component, ReadError> {
    let id = integer(node, "objectid")?;
    let id = id.ok_or_else(|| wrong(node, "a placed item needs an objectid; add it"))?;
    // The attribute of the production extension has a namespace of its own.
    let path = node.attributes().find(|a| a.name() == "path").map(|a| a.value().to_owned());
    let mut transform = Transform::IDENTITY;
    if let Some(text) = node.attribute("transform") {
        let numbers: Option<Vec<f64>> =
            text.split_ascii_whitespace().map(|w| parse_f64(w.as_bytes())).collect();
        transform.0 = numbers.and_then(|n| n.try_into().ok()).ok_or_else(|| {
            wrong(node, format!("a transform needs 12 numbers, got {}; correct it", show(text.as_bytes())))
        })?;
    }
    Ok(Component { path, id, transform })
}
