//! Rewriting of a file: changed positions and fields replace the old numbers, or are appended if other parts share
//! those numbers.

use crate::model::context::WriteContext;
use crate::model::source_document::SourceDocument;
use crate::model::source_document::Update;
use std::collections::HashMap;
use std::io::Write;

use adwave::Progress;
use base64::Engine as _;

use super::accessor::Accessor;
use super::document::Document;
use super::json::{Json, object};
use super::matrix::{IDENTITY, inverse, normal, point, turns};
use super::read::{VertexGroup, field_name, turn_direction};
use super::write::{
    Attribute, EncodedRows, NumberBuffer, VERTICES, attributes, finish, positions, range, report_field, rows,
    set_provenance,
};
use crate::{Field, Format, ReadError, ShapeFile, ValueType, WriteError};

/// Content kept from the file.
#[derive(Debug)]
pub(crate) struct GltfSource {
    pub(crate) document: Document,
    pub(crate) parts: Vec<VertexGroup>,
}

/// File with the changes applied so far.
struct RewrittenFile<'a> {
    original: &'a GltfSource,
    json: Json,
    buffers: Vec<Vec<u8>>,
    added: NumberBuffer,
    /// New mesh of each node whose mesh is no longer shared.
    meshes: HashMap<usize, usize>,
}

impl SourceDocument for GltfSource {
    fn update(&self, shape: &ShapeFile, context: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        update_gltf(self, shape, context)
    }

    fn stale_attributes(&self) -> Vec<String> {
        let has_targets =
            |mesh: &Json| mesh.list_of("primitives").iter().any(|p| !p.list_of("targets").is_empty());
        let has_any = self.document.json.list_of("meshes").iter().any(has_targets);
        if has_any { vec!["offsets of morph targets".to_owned()] } else { Vec::new() }
    }

    /// Text and binary glTF hold the same.
    fn can_update(&self, read: Format, written: Format) -> bool {
        [read, written].iter().all(|&format| format == Format::GLB || format == Format::GLTF)
    }
}

/// Writes the original with the changes, unless a node flattens its mesh: then no position in the file gives the new
/// one.
fn update_gltf(
    original: &GltfSource,
    shape: &ShapeFile,
    context: &mut WriteContext<'_>,
) -> Result<Update, WriteError> {
    let (document, report) = (&original.document, &mut context.report);
    let (format, progress) = (context.format, context.progress);
    let is_beside = |json: &Json| json.text_of("uri").is_some_and(|uri| !uri.starts_with("data:"));
    let is_alone = !["buffers", "images"].iter().any(|key| document.json.list_of(key).iter().any(is_beside));
    if !shape.moved && shape.edited.is_empty() && shape.format == Some(format) && is_alone {
        for chunk in document.bytes.chunks(crate::progress::BYTES_PER_STEP) {
            progress.step(0, 1)?;
            context.out.write_all(chunk)?;
        }
        return Ok(Update::Written);
    }
    if original.parts.iter().any(|part| inverse(&part.instance.matrix).is_none()) {
        return Ok(Update::DoesNotFit);
    }
    let buffers: Vec<Vec<u8>> =
        (0..document.buffers.len()).map(|k| document.buffer(k).unwrap_or_default().to_vec()).collect();
    let added = NumberBuffer {
        n_views: document.json.list_of("bufferViews").len(),
        n_accessors: document.json.list_of("accessors").len(),
        start: buffers.first().map_or(0, |bytes| bytes.len().next_multiple_of(4)),
        ..NumberBuffer::default()
    };
    let mut changed =
        RewrittenFile { original, json: document.json.clone(), buffers, added, meshes: HashMap::new() };
    if shape.moved {
        let mut is_rounded = false;
        for part in 0..original.parts.len() {
            is_rounded |= changed.move_part(shape, part, progress)?;
        }
        if is_rounded {
            report.report_dropped("digits of coordinates beyond 32-bit floats");
        }
    }
    for name in &shape.edited {
        let Some(field) = shape.field(name) else { continue };
        report_field(field, format, report, progress)?;
        for part in 0..original.parts.len() {
            changed.set_field(field, part, progress)?;
        }
    }
    changed.pack_pictures(format);
    set_provenance(&mut changed.json, shape.valid_provenance());
    changed.finish(format, context.out, progress)?;
    Ok(Update::Written)
}

fn to_write_error(error: ReadError) -> WriteError {
    match error {
        ReadError::Cancelled(e) => e.into(),
        // Everything that could be read once can be read again.
        other => WriteError::Io(std::io::Error::other(other.to_string())),
    }
}

impl RewrittenFile<'_> {
    /// Writes the new positions of a part if it moved; returns true if digits are lost.
    fn move_part(&mut self, shape: &ShapeFile, k: usize, progress: Progress<'_>) -> Result<bool, WriteError> {
        let original = self.original;
        let part = &original.parts[k];
        let (accessor, matrix) = (&part.positions, part.instance.matrix);
        let mut before = Vec::new();
        accessor.append_points(&original.document, &mut before, |p| p, progress).map_err(to_write_error)?;
        let in_scene = |p: [f64; 3]| if matrix == IDENTITY { p } else { point(&matrix, p) };
        let after = &shape.points[part.first..part.first + accessor.count];
        let is_same = |i: usize| in_scene(before[i]).map(f64::to_bits) == after[i].map(f64::to_bits);
        if crate::progress::all(after.len(), progress, is_same)? {
            return Ok(false);
        }
        let back = inverse(&matrix).unwrap_or(IDENTITY);
        // Unchanged coordinates keep their bits.
        let own = |i: usize| {
            let local = if is_same(i) {
                before[i]
            } else if matrix == IDENTITY {
                after[i]
            } else {
                point(&back, after[i])
            };
            local.map(|x| x as f32)
        };
        let local = crate::progress::collect(after.len(), progress, own)?;
        let keeps = |i: usize| matrix != IDENTITY || is_same(i) || local[i].map(f64::from) == after[i];
        let is_rounded = !crate::progress::all(after.len(), progress, keeps)?;
        let (rows, around) = positions(&local, progress)?;
        if self.is_own(accessor, k) {
            self.put(accessor, &rows);
            let list =
                |corner: [f32; 3]| Json::List(corner.iter().map(|&x| Json::from_number(x.into())).collect());
            let around = range(&local).map(list);
            if let Some(json) = self.json.list_mut("accessors").and_then(|list| list.get_mut(accessor.index))
            {
                let [low, high] = around;
                json.set("min", low);
                json.set("max", high);
            }
        } else {
            let index = self.added.add(&rows, VERTICES, Some(around));
            self.point_to(k, "POSITION", index);
        }
        Ok(is_rounded)
    }

    /// Writes the rows of a field that belong to a part.
    fn set_field(&mut self, field: &Field, k: usize, progress: Progress<'_>) -> Result<(), WriteError> {
        let original = self.original;
        let part = &original.parts[k];
        let back = inverse(&part.instance.matrix).unwrap_or(IDENTITY);
        // A part without the attribute has NaN in the field.
        let of_part = part.first * field.n_channels..(part.first + part.positions.count) * field.n_channels;
        let has_values = of_part.clone().any(|k| !field.values.get(k).is_nan()) || of_part.is_empty();
        for mut attribute in attributes(field) {
            let old = part.attributes.iter().find(|(name, _)| {
                *name == attribute.name || (attribute.channels.0 == 0 && field_name(name) == field.name)
            });
            // The attribute keeps its name, which says how its numbers are encoded.
            if let Some((name, _)) = old {
                attribute.name.clone_from(name);
            }
            let turn = attribute.name == "NORMAL" && turns(&part.instance.matrix);
            let is_tangent = field.name == "tangent" && field.n_channels == 4 && turns(&part.instance.matrix);
            let turned = |row: &mut [f32]| {
                if is_tangent {
                    turn_direction(row, &back);
                }
                if turn && let [x, y, z] = row {
                    [*x, *y, *z] = normal(&back, [(*x).into(), (*y).into(), (*z).into()]).map(|x| x as f32);
                }
            };
            let rows =
                rows(field, &attribute, part.first..part.first + part.positions.count, turned, progress)?;
            match old {
                Some((_, accessor)) if holds(accessor, &attribute) && self.is_own(accessor, k) => {
                    self.put(accessor, &rows);
                    self.forget_range(accessor.index);
                }
                Some((name, _)) => {
                    let index = self.added.add(&rows, VERTICES, None);
                    self.point_to(k, name, index);
                }
                None if has_values => {
                    let index = self.added.add(&rows, VERTICES, None);
                    self.point_to(k, &attribute.name, index);
                }
                None => {}
            }
        }
        Ok(())
    }

    /// Removes the bounds, which are optional, because they no longer hold.
    fn forget_range(&mut self, index: usize) {
        if let Some(json) = self.json.list_mut("accessors").and_then(|list| list.get_mut(index)) {
            json.remove("min");
            json.remove("max");
        }
    }

    /// True if an accessor's bytes belong to one part alone and can be overwritten.
    fn is_own(&self, accessor: &Accessor, k: usize) -> bool {
        if accessor.is_sparse || accessor.place.is_none() || accessor.value_type != ValueType::F32 {
            return false;
        }
        let part = &self.original.parts[k];
        let shares = |other: &Accessor| other.index == accessor.index || other.place == accessor.place;
        let others = self.original.parts.iter().enumerate().filter(|(other, _)| *other != k);
        let mut of_others =
            others.flat_map(|(_, p)| std::iter::once(&p.positions).chain(p.attributes.iter().map(|a| &a.1)));
        if of_others.any(shares) {
            return false;
        }
        // Primitives that are not part of the scene must not use them either.
        let meshes = self.original.document.json.list_of("meshes").iter().enumerate();
        let names = |value: &Json| value.index() == Some(accessor.index);
        !meshes.into_iter().any(|(m, mesh)| {
            mesh.list_of("primitives").iter().enumerate().any(|(p, primitive)| {
                let is_mine = m == part.instance.mesh && part.primitives.contains(&p);
                let attributes = match primitive.get("attributes") {
                    Some(Json::Object(members)) => members.as_slice(),
                    _ => &[],
                };
                let targets = primitive.list_of("targets").iter().any(|target| match target {
                    Json::Object(members) => members.iter().any(|(_, value)| names(value)),
                    _ => false,
                });
                targets || (!is_mine && attributes.iter().any(|(_, value)| names(value)))
            })
        })
    }

    /// Overwrites the rows of an accessor that belongs to one part.
    fn put(&mut self, accessor: &Accessor, rows: &EncodedRows) {
        let Some(place) = accessor.place else { return };
        let row = rows.n_channels * rows.value_type.n_bytes();
        let Some(buffer) = self.buffers.get_mut(place.buffer) else { return };
        for (i, bytes) in rows.bytes.chunks_exact(row).enumerate() {
            let at = place.offset + i * place.stride;
            buffer[at..at + row].copy_from_slice(bytes);
        }
    }

    /// Redirects an attribute of a part's primitives to another accessor; a mesh that other nodes use too is copied
    /// first.
    fn point_to(&mut self, k: usize, attribute: &str, accessor: usize) {
        let part = &self.original.parts[k];
        let mesh = self.own_mesh(k);
        let meshes = self.json.list_mut("meshes").and_then(|meshes| meshes.get_mut(mesh));
        let Some(primitives) = meshes.and_then(|mesh| mesh.list_mut("primitives")) else { return };
        for &p in &part.primitives {
            if let Some(attributes) =
                primitives.get_mut(p).and_then(|primitive| primitive.get_mut("attributes"))
            {
                attributes.set(attribute, accessor.into());
            }
        }
    }

    fn own_mesh(&mut self, k: usize) -> usize {
        let instance = &self.original.parts[k].instance;
        let Some(node) = instance.node else { return instance.mesh };
        if let Some(&mesh) = self.meshes.get(&node) {
            return mesh;
        }
        let nodes = self.json.list_of("nodes").iter();
        let is_shared = nodes.filter(|other| other.index_of("mesh") == Some(instance.mesh)).count() > 1;
        let mut mesh = instance.mesh;
        if is_shared && let Some(meshes) = self.json.list_mut("meshes") {
            let copy = meshes[mesh].clone();
            mesh = meshes.len();
            meshes.push(copy);
            if let Some(json) = self.json.list_mut("nodes").and_then(|nodes| nodes.get_mut(node)) {
                json.set("mesh", mesh.into());
            }
        }
        self.meshes.insert(node, mesh);
        mesh
    }

    /// Embeds external pictures.
    fn pack_pictures(&mut self, format: Format) {
        for (k, picture) in self.original.document.pictures.iter().enumerate() {
            let Some(bytes) = picture else { continue };
            let kind = kind_of_picture(bytes);
            let view = (format == Format::GLB).then(|| {
                self.added.bytes.resize(self.added.bytes.len().next_multiple_of(4), 0);
                let at = self.added.start + self.added.bytes.len();
                self.added.bytes.extend_from_slice(bytes);
                let length = bytes.len();
                self.added.views.push(object([
                    ("buffer", 0.into()),
                    ("byteOffset", at.into()),
                    ("byteLength", length.into()),
                ]));
                self.added.n_views + self.added.views.len() - 1
            });
            let Some(image) = self.json.list_mut("images").and_then(|list| list.get_mut(k)) else { continue };
            if let Some(view) = view {
                image.remove("uri");
                image.set("bufferView", view.into());
                image.set("mimeType", kind.into());
            } else {
                let encoded = base64::engine::general_purpose::STANDARD.encode(bytes);
                image.set("uri", Json::Text(format!("data:{kind};base64,{encoded}")));
            }
        }
    }

    fn finish(
        mut self,
        format: Format,
        out: &mut dyn Write,
        progress: Progress<'_>,
    ) -> Result<(), WriteError> {
        if !self.added.bytes.is_empty() {
            if self.buffers.is_empty() {
                self.buffers.push(Vec::new());
                if let Some(list) = self.json.list_mut("buffers") {
                    list.push(object([("byteLength", 0.into())]));
                }
            }
            self.buffers[0].resize(self.added.start, 0);
            self.buffers[0].append(&mut self.added.bytes);
        }
        if let Some(views) = self.json.list_mut("bufferViews") {
            views.append(&mut self.added.views);
        }
        if let Some(accessors) = self.json.list_mut("accessors") {
            accessors.append(&mut self.added.accessors);
        }
        for key in ["bufferViews", "accessors"] {
            if self.json.list_of(key).is_empty() {
                self.json.remove(key);
            }
        }
        finish(self.json, self.buffers, format, out, progress)
    }
}

/// True if an accessor has rows of the type in which an attribute is written.
fn holds(accessor: &Accessor, attribute: &Attribute) -> bool {
    accessor.value_type == attribute.value_type
        && accessor.n_channels == attribute.channels.1
        && accessor.is_normalized == attribute.is_normalized
}

/// Media type by the first bytes.
fn kind_of_picture(bytes: &[u8]) -> &'static str {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => "image/png",
        [0xff, 0xd8, 0xff, ..] => "image/jpeg",
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => "image/webp",
        [0xab, b'K', b'T', b'X', ..] => "image/ktx2",
        _ => "application/octet-stream",
    }
}
