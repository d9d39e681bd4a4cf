//! 3MF reader: the build items of the archive's model, joined to one shape.

use std::collections::HashMap;

use adwave::Progress;

use crate::bytes::package::Package;
use crate::formats::threemf::model::{Color, Component, Model};
use crate::model::instances::{MergedMesh, Transform};
use crate::progress::report_row;
use crate::text::xml::parse;
use crate::{Field, FieldValues, Format, LengthUnit, ReadError, ReadLimits, ShapeFile};

/// Largest nesting of objects; one that contains itself would never end.
const DEEPEST: usize = 64;

/// Parts in use, and the shape built from them.
struct Assembly<'a> {
    models: HashMap<String, Model>,
    joined: MergedMesh<'a>,
    colors: Vec<[Option<Color>; 3]>,
    n_bytes: usize,
    n_visits: u64,
    progress: Progress<'a>,
}

/// Reads a 3MF.
pub(crate) fn read_3mf(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut package = Package::open(bytes, limits)?;
    let root = root_of(&mut package, progress)?;
    let mut models = HashMap::new();
    let mut n_bytes = bytes.len();
    let mut wanted = vec![root.clone()];
    while let Some(path) = wanted.pop() {
        if models.contains_key(&path) {
            continue;
        }
        let text = package.text(&path, progress)?;
        n_bytes += text.len();
        let model = Model::parse(&text, progress).map_err(|e| in_part(&path, e))?;
        let components = model.objects.values().flat_map(|o| &o.components).chain(&model.built);
        wanted.extend(components.filter_map(|c| c.path.as_deref().map(plain)));
        models.insert(path, model);
    }
    let mut extras = Vec::new();
    let n_parts =
        package.names().filter(|name| name.to_ascii_lowercase().rsplit('.').next() == Some("model")).count();
    let is_plain = |name: &str| {
        let ending = name.rsplit('.').next().unwrap_or("").to_ascii_lowercase();
        matches!(ending.as_str(), "model" | "rels") || name.eq_ignore_ascii_case("[content_types].xml")
    };
    if n_parts > models.len() || !package.names().all(is_plain) {
        extras.push("other parts of the archive".to_owned());
    }
    if models.values().any(|m| m.has_materials) {
        extras.push("materials and textures".into());
    }
    let main = &models[&root];
    let whole = |id: &u32| Component { path: None, id: *id, transform: Transform::IDENTITY };
    let built: Vec<(Option<String>, u32, Transform)> = if main.built.is_empty() {
        main.ids.iter().map(whole).map(|c| (c.path, c.id, c.transform)).collect()
    } else {
        main.built.iter().map(|c| (c.path.clone(), c.id, c.transform)).collect()
    };
    let (joined, colors) = (MergedMesh::new(limits, n_bytes), Vec::new());
    let mut assembly = Assembly { models, joined, colors, n_bytes, n_visits: 0, progress };
    let unit = assembly.models[&root].unit.clone();
    for (path, id, transform) in built {
        let path = path.as_deref().map_or_else(|| root.clone(), plain);
        assembly.place(&path, id, &transform, &unit, 0)?;
    }
    let mut shape = assembly.finish(extras)?;
    shape.unit = Some(unit);
    Ok(shape)
}

fn plain(path: &str) -> String {
    path.trim_start_matches('/').to_owned()
}

fn in_part(path: &str, error: ReadError) -> ReadError {
    let path: String = path.chars().filter(|c| !c.is_control()).take(80).collect();
    match error {
        ReadError::Cancelled(_) | ReadError::Limit { .. } => error,
        other => ReadError::Whole(format!("part `{path}`, {other}")),
    }
}

/// Path of the root model of the archive.
fn root_of(package: &mut Package<'_>, progress: Progress<'_>) -> Result<String, ReadError> {
    let path = "_rels/.rels";
    if package.has(path) {
        let text = package.text(path, progress)?;
        let document = parse(&text).map_err(|e| in_part(path, e))?;
        let is_model = |node: &roxmltree::Node<'_, '_>| {
            node.attribute("Type").is_some_and(|kind| kind.ends_with("/3dmodel"))
        };
        let found =
            document.descendants().find(is_model).and_then(|node| node.attribute("Target").map(plain));
        if let Some(target) = found {
            return Ok(target);
        }
    }
    let missing = || ReadError::Whole("the archive has no model; get the whole file".into());
    package.find("3dmodel.model").or_else(|| package.find(".model")).map(|p| plain(&p)).ok_or_else(missing)
}

impl Assembly<'_> {
    /// Adds an object and all its components.
    fn place(
        &mut self,
        path: &str,
        id: u32,
        transform: &Transform,
        unit: &LengthUnit,
        depth: usize,
    ) -> Result<(), ReadError> {
        self.n_visits += 1;
        let limit = 1_000_000 + self.n_bytes as u64 / 16;
        if depth > DEEPEST || self.n_visits > limit {
            let message = "objects are nested too deeply; check whether components form a cycle";
            return Err(ReadError::Whole(message.into()));
        }
        report_row(self.progress, self.n_visits, 0)?;
        let Some(model) = self.models.get(path) else {
            return Err(ReadError::Whole("a component names a part that does not exist".into()));
        };
        let Some(object) = model.objects.get(&id) else {
            let message = format!("the placed object {id} does not exist; correct the id");
            return Err(in_part(path, ReadError::Whole(message)));
        };
        if !object.points.is_empty() {
            let transform = match model.unit.ratio_to(unit).filter(|ratio| *ratio != 1.0) {
                Some(ratio) => Transform::scale(ratio).then(transform),
                None => *transform,
            };
            let (before, n) = (self.joined.triangles.len(), object.triangles.len());
            self.joined.add(&object.points, &object.triangles, &transform, self.progress)?;
            if !object.colors.is_empty() {
                self.colors.resize(before, [None; 3]);
                let mirrors = transform.mirrors();
                self.colors.extend(object.colors.iter().map(
                    |&[a, b, c]| {
                        if mirrors { [a, c, b] } else { [a, b, c] }
                    },
                ));
                self.colors.resize(before + n, [None; 3]);
            }
        }
        let components: Vec<(String, u32, Transform)> = object
            .components
            .iter()
            .map(|c| (c.path.as_deref().map_or_else(|| path.to_owned(), plain), c.id, c.transform))
            .collect();
        for (path, id, own) in components {
            self.place(&path, id, &own.then(transform), unit, depth + 1)?;
        }
        Ok(())
    }

    fn finish(mut self, mut extras: Vec<String>) -> Result<ShapeFile, ReadError> {
        let has_corners = self.models.values().any(|m| m.has_corners);
        let n_channels = if self.models.values().any(|m| m.has_alpha) { 4 } else { 3 };
        let mut shape = self.joined.into_shape(self.progress)?;
        shape.format = Some(Format::THREE_MF);
        let n = shape.faces.len();
        if self.colors.iter().flatten().any(Option::is_some) {
            self.colors.resize(n, [None; 3]);
            // Objects without a color are white.
            let white = [255; 4];
            if !has_corners {
                let values =
                    self.colors.iter().flat_map(|c| c[0].unwrap_or(white).into_iter().take(n_channels));
                let values = FieldValues::U8(values.collect());
                shape.face_fields.push(Field::new("color", n_channels, values));
            } else if let Some(of_vertex) = one_per_vertex(&shape, &self.colors) {
                let values = of_vertex.iter().flat_map(|c| c.unwrap_or(white).into_iter().take(n_channels));
                let values = FieldValues::U8(values.collect());
                shape.vertex_fields.push(Field::new("color", n_channels, values));
            } else {
                extras.push("colors of face corners".into());
            }
        }
        shape.extras = extras;
        Ok(shape)
    }
}

/// Color of each vertex, if all its corners have the same one.
fn one_per_vertex(shape: &ShapeFile, colors: &[[Option<Color>; 3]]) -> Option<Vec<Option<Color>>> {
    let mut found: Vec<Option<Color>> = vec![None; shape.n_vertices];
    for (&v, color) in shape.faces.corners().iter().zip(colors.as_flattened()) {
        let Some(color) = color else { continue };
        let known = found[v as usize].get_or_insert(*color);
        if known != color {
            return None;
        }
    }
    Some(found)
}
