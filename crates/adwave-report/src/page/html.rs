//! Conversion of a page to HTML.

use super::image::data_uri;
use super::{Block, Fact, Figure, ImageKind, Legend, Link, Page, Section, Source, Tone, Verdict};
use crate::table::Table;
use std::fmt::Write as _;

/// Largest number of rows of a table that is shown; larger tables are only linked.
const MAX_ROWS: usize = 24;
/// Largest number of characters of a cell that is not broken.
const SHORT_CELL: usize = 28;
/// Largest number of sections for which the table of contents is a line; with more it is a list.
const MAX_IN_A_LINE: usize = 9;

const STYLE: &str = include_str!("style.css");

/// Largest number of characters of code that is not broken between lines.
const LONG_CODE: usize = 36;

/// Content security policy of a page without other files.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";
/// Content security policy of a page with pictures in files.
const POLICY_WITH_FILES: &str = "default-src 'none'; img-src data: 'self' file:; style-src 'unsafe-inline'";

pub(super) fn page(page: &Page) -> String {
    let title = escape(&page.title);
    let mut blocks = page.sections.iter().flat_map(|s| &s.blocks);
    let has_files = blocks.any(|block| match block {
        Block::Gallery(figures) => figures.iter().any(|f| matches!(f.image.source, Source::File(_))),
        _ => false,
    });
    let policy = if has_files { POLICY_WITH_FILES } else { POLICY };
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n"
    );
    for paragraph in &page.introduction {
        let _ = writeln!(text, "<p>{}</p>", prose(paragraph));
    }
    text += "</header>\n";
    text += &contents(&page.sections);
    text += "<main>\n";
    for one in &page.sections {
        text += &section(one);
    }
    text += "</main>\n";
    if !page.footer.is_empty() {
        let _ = writeln!(text, "<footer><p>{}</p></footer>", prose(&page.footer));
    }
    text + "</body>\n</html>\n"
}

fn contents(sections: &[Section]) -> String {
    if sections.len() < 2 {
        return String::new();
    }
    let class = if sections.len() > MAX_IN_A_LINE { " class=\"long\"" } else { "" };
    let mut text = format!("<nav aria-label=\"Contents\"{class}>\n<ul>\n");
    for one in sections {
        let verdict = one.blocks.iter().find_map(|block| match block {
            Block::Verdict(verdict) => Some(verdict),
            _ => None,
        });
        let badge = verdict.map_or(String::new(), |v| format!(" {}", badge(v)));
        let _ = writeln!(text, "<li><a href=\"#{}\">{}</a>{badge}</li>", escape(&one.id), escape(&one.title));
    }
    text + "</ul>\n</nav>\n"
}

fn section(section: &Section) -> String {
    let mut text = format!("<section id=\"{}\">\n<h2>{}</h2>\n", escape(&section.id), escape(&section.title));
    for one in &section.blocks {
        text += &block(one);
    }
    text + "</section>\n"
}

fn block(block: &Block) -> String {
    match block {
        Block::Paragraph(text) => format!("<p>{}</p>\n", prose(text)),
        Block::Note(text) => format!("<p class=\"note\">{}</p>\n", prose(text)),
        Block::Verdict(verdict) => format!("<p>{} {}</p>\n", badge(verdict), prose(&verdict.sentence)),
        Block::Facts(list) => facts(list),
        Block::Gallery(figures) => gallery(figures),
        Block::Table(table) => {
            let uri = data_uri("text/csv", table.csv().as_bytes());
            numbers(table, &format!(" download=\"{}\" href=\"{uri}\"", escape(&table.name)))
        }
        Block::TableWithFile(table, file) => numbers(table, &format!(" href=\"{}\"", path(file))),
        Block::Files(links) => files(links),
    }
}

fn badge(verdict: &Verdict) -> String {
    let class = match verdict.tone {
        Tone::Good => "good",
        Tone::Mixed => "mixed",
        Tone::Bad => "bad",
    };
    format!("<b class=\"{class}\">{}.</b>", escape(&verdict.headline))
}

fn facts(facts: &[Fact]) -> String {
    let mut text = String::from("<dl>\n");
    for fact in facts {
        let meaning = match fact.meaning.as_str() {
            "" => String::new(),
            meaning => format!("<dd class=\"meaning\">{}</dd>", prose(meaning)),
        };
        let (name, value) = (escape(&fact.name), escape(&fact.value));
        let _ = writeln!(text, "<div><dt>{name}</dt><dd class=\"value\">{value}</dd>{meaning}</div>");
    }
    text + "</dl>\n"
}

fn gallery(figures: &[Figure]) -> String {
    let class = match figures.len() {
        0 | 1 => " one",
        2 => " two",
        3 | 6 => " three",
        4 => " four",
        5 => " five",
        _ => "",
    };
    let figures: String = figures.iter().map(figure).collect();
    format!("<div class=\"gallery{class}\">\n{figures}</div>\n")
}

fn figure(figure: &Figure) -> String {
    let image = &figure.image;
    let sides = match (image.width, image.height) {
        (0, _) | (_, 0) => String::new(),
        (width, height) => format!(" width=\"{width}\" height=\"{height}\""),
    };
    let tag = |source: &str, more: &str| {
        format!("<img src=\"{source}\"{sides} alt=\"{}\"{more}>", escape(&figure.alt))
    };
    let mut picture = match &image.source {
        Source::File(file) => tag(&path(file), " loading=\"lazy\""),
        Source::Embedded { light, dark } if dark.is_empty() => tag(&image.uri(light), ""),
        Source::Embedded { light, dark } => format!(
            "<picture><source media=\"(prefers-color-scheme:dark)\" srcset=\"{}\">{}</picture>",
            image.uri(dark),
            tag(&image.uri(light), "")
        ),
    };
    if let Some(link) = &figure.link {
        picture = format!("<a href=\"{}\">{picture}</a>", path(link));
    }
    let class = if image.kind == ImageKind::Svg { " class=\"svg\"" } else { "" };
    let legend = figure.legend.as_ref().map_or(String::new(), legend);
    format!(
        "<figure{class}>\n{picture}\n{legend}<figcaption>{}</figcaption>\n</figure>\n",
        prose(&figure.caption)
    )
}

fn legend(legend: &Legend) -> String {
    let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    match legend {
        Legend::Bar { label, low, high, colors } => {
            let colors: Vec<String> = colors.iter().map(|&c| hex(c)).collect();
            format!(
                "<div class=\"bar\"><i style=\"background:linear-gradient(to right,{})\"></i><span><b>{}</b>\
                 <em>{}</em><b>{}</b></span></div>\n",
                colors.join(","),
                escape(low),
                prose(label),
                escape(high)
            )
        }
        Legend::Keys(keys) => {
            let item = |(color, text): &([u8; 3], String)| {
                format!("<li><i style=\"background:{}\"></i>{}</li>", hex(*color), prose(text))
            };
            format!("<ul class=\"keys\">{}</ul>\n", keys.iter().map(item).collect::<String>())
        }
    }
}

/// Converts a table to HTML; `link` has the attributes of its link.
fn numbers(table: &Table, link: &str) -> String {
    let mut text = format!(
        "<div class=\"table\">\n<p>{} <a{link}>{}</a></p>\n",
        prose(&table.caption),
        escape(&table.name)
    );
    if table.rows.len() <= MAX_ROWS {
        let cells = |k: usize| table.rows.iter().filter_map(move |row| row.get(k));
        let class = |k: usize| {
            if cells(k).all(|cell| is_number(cell)) {
                " class=\"n\""
            } else if cells(k).all(|cell| cell.chars().count() <= SHORT_CELL) {
                " class=\"s\""
            } else {
                ""
            }
        };
        let classes: Vec<&str> = (0..table.head.len()).map(class).collect();
        let line = |tag: &str, cells: &[String]| {
            let cell = |(k, cell): (usize, &String)| {
                let class = classes.get(k).copied().unwrap_or_default();
                format!("<{tag}{class}>{}</{tag}>", prose(cell))
            };
            format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
        };
        let rows: String = table.rows.iter().map(|row| line("td", row)).collect();
        let _ = write!(
            text,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">\n<table>\n<thead>\n{}</thead>\n\
             <tbody>\n{rows}</tbody>\n</table>\n</div>\n",
            escape(&table.caption),
            line("th", &table.head)
        );
    } else {
        let _ = writeln!(text, "<p>{} rows; see the file.</p>", table.rows.len());
    }
    text + "</div>\n"
}

/// True for a cell that is aligned to the right: a number, with or without a unit, or an empty cell.
fn is_number(cell: &str) -> bool {
    cell.trim_start_matches(['-', '−', '+', '–', '≥', '≤', '<', ' '])
        .chars()
        .next()
        .is_none_or(|c| c.is_ascii_digit())
}

fn files(links: &[Link]) -> String {
    let item =
        |link: &Link| format!("<li><a href=\"{}\">{}</a></li>\n", path(&link.path), escape(&link.text));
    format!("<ul>\n{}</ul>\n", links.iter().map(item).collect::<String>())
}

/// Converts a relative path to a link. Characters that could end the attribute or start a scheme are percent-encoded.
fn path(path: &str) -> String {
    let mut text = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"/._-~".contains(&byte) {
            text.push(char::from(byte));
        } else {
            let _ = write!(text, "%{byte:02X}");
        }
    }
    text
}

/// Converts text to HTML, with code between backticks and with subscripts.
fn prose(text: &str) -> String {
    if text.matches('`').count() % 2 == 1 {
        return subscripts(text);
    }
    let part = |(k, part): (usize, &str)| match k % 2 {
        0 => subscripts(part),
        _ if part.chars().count() <= LONG_CODE => format!("<code class=\"k\">{}</code>", escape(part)),
        _ => format!("<code>{}</code>", escape(part)),
    };
    text.split('`').enumerate().map(part).collect()
}

/// Escapes text and sets subscripts: the j of `W_j`, `S_j`, `n_j` and `σ_j`, the number of a level in its place, or
/// `(j−1)`. Names such as `scan_1.obj` or `S_1.obj` do not change.
fn subscripts(text: &str) -> String {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(at) = rest.find('_') {
        let (before, after) = (&rest[..at], &rest[at + 1..]);
        let mut letters = before.chars().rev();
        let symbol = letters.next().is_some_and(|c| "WSnσ".contains(c))
            && letters.next().or(out.chars().last()).is_none_or(|c| !word(c) && c != '.' && c != '/');
        let end = match after.chars().next() {
            Some('j' | 'J') => 1,
            Some('(') => after.find(')').map_or(0, |end| end + 1),
            _ => after.bytes().take_while(u8::is_ascii_digit).count(),
        };
        let mut next = after[end..].chars();
        let ends = match next.next() {
            Some('.') => next.next().is_none_or(char::is_whitespace),
            Some(c) => !word(c),
            None => true,
        };
        let index = after[..end].trim_matches(['(', ')']);
        if symbol && !index.is_empty() && ends {
            out += &format!("{}<sub>{}</sub>", escape(before), escape(index));
            rest = &after[end..];
        } else {
            out += &escape(&rest[..=at]);
            rest = after;
        }
    }
    out + &escape(rest)
}

fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            // HTML does not allow control characters, but a name may contain them.
            c if c.is_control() && c != '\n' && c != '\t' => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_are_those_of_the_symbols_only() {
        for (text, html) in [
            ("|W_j| and σ_12.", "|W<sub>j</sub>| and σ<sub>12</sub>."),
            ("W_j = S_(j−1) − S_j", "W<sub>j</sub> = S<sub>j−1</sub> − S<sub>j</sub>"),
            ("S_J, n_j", "S<sub>J</sub>, n<sub>j</sub>"),
            ("scan_1.obj S_1.obj a_W_1 W_jet W_ _ S_()<", "scan_1.obj S_1.obj a_W_1 W_jet W_ _ S_()&lt;"),
            ("a/S_1 b.W_2", "a/S_1 b.W_2"),
        ] {
            assert_eq!(prose(text), html);
        }
        assert_eq!(prose("`W_1` <"), "<code class=\"k\">W_1</code> &lt;");
        assert_eq!(prose("one ` only"), "one ` only");
    }

    #[test]
    fn paths_cannot_end_the_attribute_or_name_another_scheme() {
        assert_eq!(path("fig02/a b.png"), "fig02/a%20b.png");
        assert_eq!(path("javascript:alert(\"1\")"), "javascript%3Aalert%28%221%22%29");
    }

    #[test]
    fn control_characters_do_not_reach_the_page() {
        assert_eq!(escape("a\0\u{1b}[31m<&>\"'"), "a\u{fffd}\u{fffd}[31m&lt;&amp;&gt;&quot;&#39;");
    }
}
