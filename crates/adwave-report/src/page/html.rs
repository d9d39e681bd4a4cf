//! From a page to HTML.

use super::image::data_uri;
use super::{Block, Fact, Figure, ImageKind, Legend, Link, Page, Section, Tone, Verdict};
use crate::table::Table;
use std::fmt::Write as _;

/// Tables with more rows are saved, not shown.
const MOST_ROWS: usize = 24;
/// With more sections the table of contents is a list in place of a line.
const MOST_IN_A_LINE: usize = 9;
/// So many pictures side by side are shown large.
const FEW: usize = 2;

const STYLE: &str = include_str!("style.css");

/// What the browser may load: what is in the file, and nothing else.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

pub(super) fn page(page: &Page) -> String {
    let title = escaped(&page.title);
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
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
    let class = if sections.len() > MOST_IN_A_LINE { " class=\"long\"" } else { "" };
    let mut text = format!("<nav aria-label=\"Contents\"{class}>\n<ul>\n");
    for one in sections {
        let verdict = one.blocks.iter().find_map(|block| match block {
            Block::Verdict(verdict) => Some(verdict),
            _ => None,
        });
        let badge = verdict.map_or(String::new(), |v| format!(" {}", badge(v)));
        let _ =
            writeln!(text, "<li><a href=\"#{}\">{}</a>{badge}</li>", escaped(&one.id), escaped(&one.title));
    }
    text + "</ul>\n</nav>\n"
}

fn section(section: &Section) -> String {
    let mut text =
        format!("<section id=\"{}\">\n<h2>{}</h2>\n", escaped(&section.id), escaped(&section.title));
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
        Block::Table(table) => numbers(table),
        Block::Files(links) => files(links),
    }
}

fn badge(verdict: &Verdict) -> String {
    let class = match verdict.tone {
        Tone::Good => "good",
        Tone::Mixed => "mixed",
        Tone::Bad => "bad",
    };
    format!("<b class=\"{class}\">{}.</b>", escaped(&verdict.headline))
}

fn facts(facts: &[Fact]) -> String {
    let mut text = String::from("<dl>\n");
    for fact in facts {
        let meaning = match fact.meaning.as_str() {
            "" => String::new(),
            meaning => format!("<dd class=\"meaning\">{}</dd>", prose(meaning)),
        };
        let (name, value) = (escaped(&fact.name), escaped(&fact.value));
        let _ = writeln!(text, "<div><dt>{name}</dt><dd class=\"value\">{value}</dd>{meaning}</div>");
    }
    text + "</dl>\n"
}

fn gallery(figures: &[Figure]) -> String {
    let class = if figures.len() <= FEW { "gallery few" } else { "gallery" };
    let figures: String = figures.iter().map(figure).collect();
    format!("<div class=\"{class}\">\n{figures}</div>\n")
}

fn figure(figure: &Figure) -> String {
    let image = &figure.image;
    let mut picture = format!(
        "<img src=\"{}\" width=\"{}\" height=\"{}\" alt=\"{}\">",
        image.light_uri(),
        image.width,
        image.height,
        escaped(&figure.alt)
    );
    if let Some(dark) = image.dark_uri() {
        picture = format!(
            "<picture><source media=\"(prefers-color-scheme:dark)\" srcset=\"{dark}\">{picture}</picture>"
        );
    }
    if let Some(link) = &figure.link {
        picture = format!("<a href=\"{}\">{picture}</a>", escaped(&path(link)));
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
                 {}<b>{}</b></span></div>\n",
                colors.join(","),
                escaped(low),
                escaped(label),
                escaped(high)
            )
        }
        Legend::Keys(keys) => {
            let item = |(color, text): &([u8; 3], String)| {
                format!("<li><i style=\"background:{}\"></i>{}</li>", hex(*color), escaped(text))
            };
            format!("<ul class=\"keys\">{}</ul>\n", keys.iter().map(item).collect::<String>())
        }
    }
}

fn numbers(table: &Table) -> String {
    let uri = data_uri("text/csv", table.csv().as_bytes());
    let name = escaped(&table.name);
    let mut text = format!(
        "<div class=\"table\">\n<p>{} <a download=\"{name}\" href=\"{uri}\">{name}</a></p>\n",
        prose(&table.caption)
    );
    if table.rows.len() <= MOST_ROWS {
        let numeric: Vec<bool> = (0..table.head.len())
            .map(|k| table.rows.iter().filter_map(|row| row.get(k)).all(|cell| is_number(cell)))
            .collect();
        let line = |tag: &str, cells: &[String]| {
            let cell = |(k, cell): (usize, &String)| {
                let class = if numeric.get(k).copied().unwrap_or_default() { " class=\"n\"" } else { "" };
                format!("<{tag}{class}>{}</{tag}>", prose(cell))
            };
            format!("<tr>{}</tr>\n", cells.iter().enumerate().map(cell).collect::<String>())
        };
        let rows: String = table.rows.iter().map(|row| line("td", row)).collect();
        let _ = write!(
            text,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">\n<table>\n<thead>\n{}</thead>\n\
             <tbody>\n{rows}</tbody>\n</table>\n</div>\n",
            escaped(&table.caption),
            line("th", &table.head)
        );
    } else {
        let _ = writeln!(text, "<p>{} rows, in the file.</p>", table.rows.len());
    }
    text + "</div>\n"
}

/// Whether a cell lines up to the right: a number, perhaps with a unit, or nothing.
fn is_number(cell: &str) -> bool {
    cell.trim_start_matches(['-', '−', '+', '–', '≥', '≤', '<', ' '])
        .chars()
        .next()
        .is_none_or(|c| c.is_ascii_digit())
}

fn files(links: &[Link]) -> String {
    let item = |link: &Link| {
        format!("<li><a href=\"{}\">{}</a></li>\n", escaped(&path(&link.path)), escaped(&link.text))
    };
    format!("<ul>\n{}</ul>\n", links.iter().map(item).collect::<String>())
}

/// A relative path as a link: what could end it or mean another scheme is written as `%XX`.
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

/// Text with code between backticks.
fn prose(text: &str) -> String {
    if text.matches('`').count() % 2 == 1 {
        return escaped(text);
    }
    let part = |(k, part): (usize, &str)| {
        if k % 2 == 1 { format!("<code>{}</code>", escaped(part)) } else { escaped(part) }
    };
    text.split('`').enumerate().map(part).collect()
}

fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            // Control characters have no place in HTML, and a name may hold any.
            c if c.is_control() && c != '\n' && c != '\t' => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}
