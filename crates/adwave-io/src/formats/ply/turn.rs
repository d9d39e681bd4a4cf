//! The bytes of a PLY with some of its faces turned over.

use adwave::Progress;

use crate::ValueType;
use crate::formats::ply::body::PlyBody;
use crate::formats::ply::header::{Element, Encoding, PlySource, PropertyKind};
use crate::formats::ply::read::{corner_list, texcoord_list};
use crate::model::turned_faces::turn_list;
use crate::text::Words;

/// The bytes with the corners and texture coordinates of the flagged faces in their new order; `None` if the file has
/// strips, or another number of faces.
pub(super) fn turned_bytes(source: &PlySource, is_turned: &[bool]) -> Option<Vec<u8>> {
    let mut bytes = source.bytes.clone();
    let encoding = source.header.encoding;
    let mut body =
        PlyBody { bytes: &source.bytes, position: source.header.body, encoding, progress: Progress::none() };
    let mut face = 0;
    for element in &source.header.elements {
        let corners = corner_list(element).filter(|_| element.name == "face");
        if corners.is_none() && element.name != "vertex" && corner_list(element).is_some() {
            return None;
        }
        let lists = [(corners, 1), (texcoord_list(element).filter(|_| corners.is_some()), 2)];
        for row in 0..element.n_rows {
            if corners.is_none() {
                body.skip_row(element, row).ok()?;
                continue;
            }
            let is_turned = *is_turned.get(face)?;
            face += 1;
            for (p, property) in element.properties.iter().enumerate() {
                let list = lists.iter().find(|(list, _)| *list == Some(p));
                match (list, property.kind) {
                    (Some((_, width)), PropertyKind::List { count, item }) if is_turned => {
                        let list = List { count, item, width: *width };
                        list.turn(&mut body, element, row, &mut bytes)?;
                    }
                    _ => body.skip(property.kind, element, row).ok()?,
                }
            }
        }
    }
    (face == is_turned.len()).then_some(bytes)
}

/// List of values, of which each corner has `width`.
struct List {
    count: ValueType,
    item: ValueType,
    width: usize,
}

impl List {
    /// Turns the list at the position of the body, which passes it; the values come to other places in `bytes`.
    fn turn(&self, body: &mut PlyBody<'_>, element: &Element, row: u64, bytes: &mut [u8]) -> Option<()> {
        let start = body.position;
        body.skip(PropertyKind::List { count: self.count, item: self.item }, element, row).ok()?;
        let end = body.position;
        if let Encoding::Binary(_) = body.encoding {
            let items = start + self.count.n_bytes()..end;
            let mut corners: Vec<&[u8]> =
                body.bytes[items.clone()].chunks(self.width * self.item.n_bytes()).collect();
            turn_list(&mut corners);
            bytes[items].copy_from_slice(&corners.concat());
            return Some(());
        }
        let mut places = Vec::new();
        let mut words = Words::new(&body.bytes[..end], start);
        while let Some((position, word)) = words.next() {
            places.push(position..position + word.len());
        }
        // The first word is the length of the list.
        let items = places.get(1..)?;
        if items.is_empty() {
            return Some(());
        }
        let mut corners: Vec<_> = items.chunks(self.width).collect();
        turn_list(&mut corners);
        let (mut out, mut copied) = (Vec::new(), items[0].start);
        for (place, word) in items.iter().zip(corners.concat()) {
            out.extend_from_slice(&body.bytes[copied..place.start]);
            out.extend_from_slice(&body.bytes[word]);
            copied = place.end;
        }
        bytes[items[0].start..copied].copy_from_slice(&out);
        Some(())
    }
}
