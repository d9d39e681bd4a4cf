//! A reader of HTML that is stricter than browsers are: every tag is closed in its order, every attribute quoted, every
//! ampersand part of a character reference.

/// An opening tag.
#[derive(Debug)]
pub(crate) struct Tag {
    pub(crate) name: String,
    pub(crate) attributes: Vec<(String, String)>,
}

impl Tag {
    /// The value of an attribute.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }
}

/// Elements without content.
const VOID: [&str; 4] = ["meta", "img", "source", "br"];

/// All opening tags of a page, in order.
pub(crate) fn tags(page: &str) -> Vec<Tag> {
    let mut rest = page.strip_prefix("<!doctype html>").expect("the type of the document");
    let (mut tags, mut open): (Vec<Tag>, Vec<String>) = (Vec::new(), Vec::new());
    while let Some(at) = rest.find('<') {
        text(&rest[..at]);
        rest = &rest[at + 1..];
        if let Some(after) = rest.strip_prefix('/') {
            let end = after.find('>').expect("the end of a tag");
            assert_eq!(open.pop().as_deref(), Some(&after[..end]));
            rest = &after[end + 1..];
            continue;
        }
        let (tag, after) = opening(rest);
        rest = after;
        if tag.name == "style" {
            let end = rest.find("</style>").expect("the end of the style sheet");
            let style = &rest[..end];
            assert!(!style.contains("url(") && !style.contains("@import") && !style.contains('<'));
            assert_eq!(style.matches('{').count(), style.matches('}').count());
            rest = &rest[end + "</style>".len()..];
        } else if !VOID.contains(&tag.name.as_str()) {
            open.push(tag.name.clone());
        }
        tags.push(tag);
    }
    text(rest);
    assert!(open.is_empty(), "not closed: {open:?}");
    tags
}

/// A tag after its `<`, and what follows it.
fn opening(rest: &str) -> (Tag, &str) {
    let end = rest.find([' ', '>']).expect("the end of a tag's name");
    let name = &rest[..end];
    assert!(
        !name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit()),
        "<{name}"
    );
    let (mut attributes, mut rest) = (Vec::new(), &rest[end..]);
    loop {
        rest = rest.trim_start();
        if let Some(after) = rest.strip_prefix('>') {
            return (Tag { name: name.to_owned(), attributes }, after);
        }
        let (key, after) = rest.split_once("=\"").expect("an attribute with quotes");
        assert!(key.bytes().all(|b| b.is_ascii_lowercase() || b == b'-'), "attribute {key}");
        let (value, after) = after.split_once('"').expect("the end of an attribute");
        assert!(!value.contains('<'), "{key}={value}");
        text(value);
        attributes.push((key.to_owned(), value.to_owned()));
        rest = after;
    }
}

/// Characters without markup.
fn text(text: &str) {
    for part in text.split('&').skip(1) {
        let name = part.split_once(';').expect("the end of a character reference").0;
        assert!(["amp", "lt", "gt", "quot", "#39"].contains(&name), "&{name};");
    }
    assert!(!text.contains('>'), "{text}");
}
