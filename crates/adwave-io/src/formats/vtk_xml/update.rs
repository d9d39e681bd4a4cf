//! A VTI that was read, written again with other values: all else keeps its bytes.

use std::borrow::Cow;
use std::ops::Range;

use roxmltree::Node;

use super::array::{arrays, n_channels, value_type};
use super::document::{XmlFrame, parse, split};
use super::write::type_name;
use crate::model::cells::{GridArrays, hidden_places};
use crate::model::context::WriteContext;
use crate::model::grid_values::GridNumbers;
use crate::model::numbers::{Numbers, from_bytes};
use crate::model::source_document::{SourceDocument, Update};
use crate::text::escape_xml;
use crate::{Field, FieldValues, Format, GRID_VALUES, ReadError, ReadLimits, ShapeFile, WriteError};

/// Attributes of an array that are stated anew, or that depend on its numbers.
const OWN_ATTRIBUTES: [&str; 7] =
    ["type", "Name", "NumberOfComponents", "format", "offset", "RangeMin", "RangeMax"];

/// A VTI that was read.
#[derive(Debug)]
pub(super) struct ImageDocument {
    pub(super) bytes: Vec<u8>,
    /// Limits with which it was read.
    pub(super) limits: ReadLimits,
    pub(super) arrays: GridArrays,
}

/// Reasons against an update.
enum Refusal {
    DoesNotFit,
    Write(WriteError),
}

impl From<WriteError> for Refusal {
    fn from(error: WriteError) -> Self {
        Self::Write(error)
    }
}

impl From<adwave::Cancelled> for Refusal {
    fn from(cancelled: adwave::Cancelled) -> Self {
        Self::Write(cancelled.into())
    }
}

impl From<ReadError> for Refusal {
    fn from(error: ReadError) -> Self {
        match error {
            ReadError::Cancelled(cancelled) => cancelled.into(),
            _ => Self::DoesNotFit,
        }
    }
}

impl SourceDocument for ImageDocument {
    fn update(&self, shape: &ShapeFile, c: &mut WriteContext<'_>) -> Result<Update, WriteError> {
        match self.updated(shape, c) {
            Ok(bytes) => {
                c.out.write_all(&bytes)?;
                Ok(Update::Written)
            }
            Err(Refusal::DoesNotFit) => Ok(Update::DoesNotFit),
            Err(Refusal::Write(error)) => Err(error),
        }
    }

    fn keeps_extras(&self, format: Format) -> bool {
        format == Format::VTI
    }
}

impl ImageDocument {
    /// The file with the edited fields of the shape.
    fn updated(&self, shape: &ShapeFile, c: &WriteContext<'_>) -> Result<Cow<'_, [u8]>, Refusal> {
        // Another type of numbers is that of the edited fields, else of the values.
        let is_edited = |field: &&Field| {
            let is_retyped = shape.value_type.is_some() && shape.edited.is_empty();
            shape.edited.contains(&field.name) || is_retyped && field.name == GRID_VALUES
        };
        let fields: Vec<&Field> = shape.vertex_fields.iter().filter(is_edited).collect();
        if fields.is_empty() {
            return Ok(Cow::Borrowed(&self.bytes));
        }
        let (xml, appended) = split(&self.bytes)?;
        let document = parse(&xml)?;
        let root = document.root_element();
        let frame = XmlFrame::new(root, appended, &self.limits)?;
        let name = if self.arrays.of_cells { "CellData" } else { "PointData" };
        let mut pieces = root.descendants().filter(|node| node.has_tag_name("Piece"));
        let (Some(piece), None) = (pieces.next(), pieces.next()) else { return Err(Refusal::DoesNotFit) };
        let section = piece.children().find(|node| node.has_tag_name(name)).ok_or(Refusal::DoesNotFit)?;
        // Elements from the definition of an entity have no place of their own.
        if memchr::memmem::find(&xml, b"<!DOCTYPE").is_some() {
            return Err(Refusal::DoesNotFit);
        }
        let mut edit = XmlEdit { frame: &frame, parts: Vec::new() };
        for field in fields {
            self.add_field(&mut edit, section, field, shape, c)?;
        }
        if edit.parts.is_empty() {
            return Ok(Cow::Borrowed(&self.bytes));
        }
        Ok(Cow::Owned(edit.apply(&self.bytes, root)?))
    }

    /// Adds a field to the edit, unless its numbers are those of the file.
    fn add_field<'n: 'a, 'a>(
        &self,
        edit: &mut XmlEdit<'_, 'a>,
        section: Node<'n, '_>,
        field: &Field,
        shape: &ShapeFile,
        c: &WriteContext<'_>,
    ) -> Result<(), Refusal> {
        let (frame, order) = (edit.frame, edit.frame.encoding.order);
        let name = self.arrays.name_of(&field.name);
        let own = arrays(section).find(|node| node.attribute("Name").unwrap_or("array") == name);
        let Some(node) = own else {
            // A new array, stored as the others are.
            let Some(last) = arrays(section).last() else { return Err(Refusal::DoesNotFit) };
            let kind = shape.value_type.unwrap_or(field.values.value_type());
            let mut plain = Vec::new();
            let numbers = GridNumbers::new(kind, order, shape.n_vertices, field.n_channels);
            numbers.write(None, field, c.format, &mut plain, c.progress)?;
            let end = last.range().end;
            let new =
                NewArray { range: end..end, head: array_head(name, &numbers, ""), storage: stored(last) };
            return edit.add(new, &numbers, plain, c);
        };
        let old = frame.array(node, c.progress)?;
        let (own_kind, n_own) = (value_type(node).ok_or(Refusal::DoesNotFit)?, n_channels(node)?);
        if old.len() != shape.n_vertices * n_own {
            return Err(Refusal::DoesNotFit);
        }
        let kind = shape.value_type.unwrap_or(own_kind);
        let numbers = GridNumbers::new(kind, order, shape.n_vertices, field.n_channels);
        let is_alike = kind == own_kind && n_own == field.n_channels;
        let filled = if is_alike { self.with_hidden_numbers(field, &old, shape) } else { None };
        let old = match old {
            Numbers::Bytes { bytes, .. } => bytes,
            Numbers::Values(values) => {
                let mut bytes = Vec::new();
                (0..values.len()).for_each(|i| values.write_bytes(i, order, &mut bytes));
                bytes.into()
            }
        };
        let mut plain = Vec::new();
        let written = filled.as_ref().unwrap_or(field);
        numbers.write(is_alike.then_some(&old[..]), written, c.format, &mut plain, c.progress)?;
        if is_alike && plain == old[..] {
            return Ok(());
        }
        let is_kept = |name: &str| {
            let is_of_components = name.starts_with("ComponentName") && n_own != field.n_channels;
            !OWN_ATTRIBUTES.contains(&name) && !is_of_components
        };
        let more: String = node
            .attributes()
            .filter(|a| a.namespace().is_none() && is_kept(a.name()))
            .map(|a| format!(" {}=\"{}\"", a.name(), escape_xml(a.value())))
            .collect();
        let head = array_head(name, &numbers, &more);
        edit.add(NewArray { range: node.range(), head, storage: stored(node) }, &numbers, plain, c)
    }

    /// The values with the numbers of the file at hidden places that have none; `None` if no place is hidden.
    fn with_hidden_numbers(&self, field: &Field, old: &Numbers<'_>, shape: &ShapeFile) -> Option<Field> {
        let hidden = hidden_places(&shape.vertex_fields, self.arrays.of_cells);
        let n_channels = field.n_channels;
        let number = |(i, x): (usize, f64)| {
            if x.is_nan() && hidden[i / n_channels] { old.get(i) } else { x }
        };
        hidden.contains(&true).then(|| {
            let values = field.to_f64().into_iter().enumerate().map(number).collect();
            Field::new(field.name.clone(), n_channels, FieldValues::F64(values))
        })
    }
}

/// Form in which a file stores an array.
#[derive(Clone, Copy)]
enum Storage {
    Text,
    Inline,
    Appended,
}

fn stored(node: Node<'_, '_>) -> Storage {
    match node.attribute("format") {
        Some("binary") => Storage::Inline,
        Some("appended") => Storage::Appended,
        None if node.has_attribute("offset") => Storage::Appended,
        _ => Storage::Text,
    }
}

/// An array that takes the place of one in the XML.
struct NewArray {
    range: Range<usize>,
    /// Start of its element.
    head: String,
    storage: Storage,
}

/// Start of the element of an array, with further attributes.
fn array_head(name: &str, numbers: &GridNumbers, more: &str) -> String {
    let (kind, name) = (type_name(numbers.kind), escape_xml(name));
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{}\"{more}",
        numbers.n_channels()
    )
}

/// Text that takes the place of a range of the XML: the start of the block in the appended part stands between both
/// texts, if there is one.
struct XmlPart {
    range: Range<usize>,
    before: String,
    block: Option<Vec<u8>>,
    after: &'static str,
}

/// Changes to a file.
struct XmlEdit<'e, 'a> {
    frame: &'e XmlFrame<'a>,
    parts: Vec<XmlPart>,
}

impl XmlEdit<'_, '_> {
    /// Adds an array with numbers in the byte order of the file.
    fn add(
        &mut self,
        new: NewArray,
        numbers: &GridNumbers,
        plain: Vec<u8>,
        c: &WriteContext<'_>,
    ) -> Result<(), Refusal> {
        let (encoding, progress) = (self.frame.encoding, c.progress);
        let NewArray { range, head, storage } = new;
        let text = |plain| encoding.encode_text(plain, progress)?.ok_or(Refusal::DoesNotFit);
        let inline = |format: &str, content: &str| format!("{head} format=\"{format}\">\n{content}\n");
        let (before, block, after) = match storage {
            Storage::Text => {
                let values = from_bytes(&plain, numbers.kind, encoding.order, progress)?;
                let mut words = Vec::new();
                for i in 0..values.len() {
                    values.write_text(i, &mut words);
                    words.push(if (i + 1).is_multiple_of(20) { b'\n' } else { b' ' });
                }
                (inline("ascii", &String::from_utf8_lossy(words.trim_ascii_end())), None, "</DataArray>")
            }
            Storage::Inline => (inline("binary", &text(plain)?), None, "</DataArray>"),
            Storage::Appended => {
                let is_base64 = self.frame.appended.is_some_and(|appended| appended.is_base64);
                let block = if is_base64 {
                    text(plain)?.into_bytes()
                } else {
                    encoding.encode(plain, progress)?.ok_or(Refusal::DoesNotFit)?.concat()
                };
                (format!("{head} format=\"appended\" offset=\""), Some(block), "\"/>")
            }
        };
        self.parts.push(XmlPart { range, before, block, after });
        Ok(())
    }

    /// The bytes of a file with all changes.
    fn apply(mut self, bytes: &[u8], root: Node<'_, '_>) -> Result<Vec<u8>, Refusal> {
        let mut appended = Vec::new();
        let old = self.frame.appended.filter(|_| self.parts.iter().any(|part| part.block.is_some()));
        if let Some(old) = old {
            let offset = |node: &Node<'_, '_>| {
                let attribute = node.attribute_node("offset")?;
                let is_replaced = self.parts.iter().any(|part| part.range == node.range());
                let offset = attribute.value().trim().parse::<usize>().ok().filter(|_| !is_replaced)?;
                Some((offset, attribute.range_value()))
            };
            let mut kept: Vec<_> = root.descendants().filter_map(|node| offset(&node)).collect();
            kept.sort_by_key(|(offset, _)| *offset);
            let mut last = None;
            for (offset, range) in kept {
                let start = match last {
                    Some((before, start)) if before == offset => start,
                    _ => {
                        let next = self.frame.offsets.partition_point(|&other| other <= offset);
                        let end = self.frame.offsets.get(next).map_or(old.bytes.len(), |&end| end);
                        let block = old.bytes.get(offset..end).ok_or(Refusal::DoesNotFit)?;
                        appended.extend_from_slice(block);
                        appended.len() - block.len()
                    }
                };
                last = Some((offset, start));
                self.parts.push(XmlPart { range, before: start.to_string(), block: None, after: "" });
            }
        }
        self.parts.sort_by_key(|part| part.range.start);
        // Ranges begin after a byte order mark.
        let mark = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
        for part in self.parts {
            let (start, end) = (part.range.start + mark, part.range.end + mark);
            out.extend_from_slice(bytes.get(at..start).ok_or(Refusal::DoesNotFit)?);
            out.extend_from_slice(part.before.as_bytes());
            if let Some(block) = part.block {
                out.extend_from_slice(appended.len().to_string().as_bytes());
                appended.extend(block);
            }
            out.extend_from_slice(part.after.as_bytes());
            at = end;
        }
        let Some(old) = old else {
            out.extend_from_slice(bytes.get(at..).ok_or(Refusal::DoesNotFit)?);
            return Ok(out);
        };
        out.extend_from_slice(bytes.get(at..old.start).ok_or(Refusal::DoesNotFit)?);
        out.extend_from_slice(&appended);
        out.push(b'\n');
        out.extend_from_slice(&bytes[old.start + old.bytes.len()..]);
        Ok(out)
    }
}
