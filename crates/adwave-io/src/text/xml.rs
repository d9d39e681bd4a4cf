//! XML documents, and the numbers in them.

use roxmltree::{Document, Node};

use crate::ReadError;
use crate::text::{one_line, parse_f64, show};

/// Parses a document.
pub(crate) fn parse(text: &str) -> Result<Document<'_>, ReadError> {
    Document::parse(text).map_err(|e| {
        let message = format!("the XML is malformed ({}); get an undamaged file", one_line(&e));
        ReadError::Line { line: e.pos().row.into(), message }
    })
}

/// Creates the error at a position of the document.
pub(crate) fn wrong(node: Node<'_, '_>, message: impl Into<String>) -> ReadError {
    let line = node.document().text_pos_at(node.range().start).row;
    ReadError::Line { line: line.into(), message: message.into() }
}

/// Child elements of that name.
pub(crate) fn children<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// First child element of that name.
pub(crate) fn child<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    children(node, name).next()
}

/// Number in an attribute.
pub(crate) fn number(node: Node<'_, '_>, name: &str) -> Result<f64, ReadError> {
    let text = node.attribute(name).unwrap_or("").trim();
    parse_f64(text.as_bytes()).ok_or_else(|| {
        wrong(node, format!("`{name}` must be a number, got {}; correct it", show(text.as_bytes())))
    })
}

/// Integer in an attribute, if present.
pub(crate) fn whole<T: std::str::FromStr>(node: Node<'_, '_>, name: &str) -> Result<Option<T>, ReadError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    text.trim().parse().map(Some).map_err(|_| {
        wrong(node, format!("`{name}` must be an integer, got {}; correct it", show(text.as_bytes())))
    })
}

/// Text of the first child element of that name.
pub(crate) fn text_of<'a>(node: Node<'a, '_>, name: &'static str) -> Option<&'a str> {
    child(node, name).and_then(|own| own.text()).map(str::trim)
}
