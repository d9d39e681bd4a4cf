//! `index.html`: all figures on one page, with pictures and numbers in folders beside it.

use super::{Made, Table, Verdict};

/// Tables with more rows are linked only.
const MOST_ROWS: usize = 24;

const STYLE: &str = "\
:root{color-scheme:light dark;--line:#8884;--good:#1a7f37;--part:#9a6700;--bad:#cf222e}\
@media(prefers-color-scheme:dark){:root{--good:#3fb950;--part:#d29922;--bad:#f85149}}\
body{max-width:72rem;margin:0 auto;padding:1rem;font:1rem/1.5 system-ui,sans-serif}\
section{border-top:1px solid var(--line);padding-bottom:1.5rem}\
img{max-width:100%;height:auto;background:#fff;border-radius:.4rem}\
figure{margin:1rem 0}figcaption{opacity:.8;font-size:.9rem}\
.scroll{overflow-x:auto}table{border-collapse:collapse;font-size:.85rem}\
th,td{border-bottom:1px solid var(--line);padding:.2rem .6rem;text-align:right}th:first-child,td:first-child{text-align:left}\
.as-claimed{color:var(--good)}.partly{color:var(--part)}.not-as-claimed{color:var(--bad)}";

/// The page, links relative to the folder of all figures.
pub(super) fn html(made: &[Made]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>The paper, made again</title>\n<style>{STYLE}</style>\n<h1>The paper, made again</h1>\n\
         <p>Figures and tables of Hou &amp; Qin, <i>Admissible Diffusion Wavelets and Their Applications in \
         Space-Frequency Processing</i> (IEEE TVCG 2013). Each verdict is computed from the numbers beside it.</p>\n<ul>\n"
    );
    for one in made {
        let outcome = &one.outcome;
        page += &format!(
            "<li><a href=\"#{}\">{}</a> {}: {}</li>\n",
            outcome.id,
            outcome.id,
            escaped(&outcome.title),
            badge(&outcome.verdict)
        );
    }
    page += "</ul>\n";
    for one in made {
        page += &section(one);
    }
    page + "</html>\n"
}

fn section(one: &Made) -> String {
    let outcome = &one.outcome;
    let mut text =
        format!("<section id=\"{}\">\n<h2>{}: {}</h2>\n", outcome.id, outcome.id, escaped(&outcome.title));
    let on =
        if outcome.shapes.is_empty() { String::new() } else { format!(" on {}", outcome.shapes.join(", ")) };
    text += &format!("<p><code>{}</code>{}</p>\n", escaped(&outcome.command), escaped(&on));
    let names: Vec<&str> = outcome.pictures.iter().map(|p| p.name.as_str()).collect();
    for picture in &outcome.pictures {
        let file = format!("{}/{}", one.folder, picture.name);
        // An SVG that has a PNG beside it is the same picture, linked and not shown twice.
        let twin = picture
            .name
            .strip_suffix(".svg")
            .is_some_and(|stem| names.contains(&format!("{stem}.png").as_str()));
        let caption = escaped(&picture.caption);
        text += &if twin {
            format!("<p><a href=\"{file}\">{}</a></p>\n", escaped(&picture.name))
        } else {
            format!(
                "<figure><a href=\"{file}\"><img src=\"{file}\" alt=\"{caption}\" loading=\"lazy\"></a>\
                 <figcaption>{caption}</figcaption></figure>\n"
            )
        };
    }
    for paragraph in &outcome.text {
        text += &format!("<p>{}</p>\n", escaped(paragraph));
    }
    text += &format!("<p>{} {}</p>\n", badge(&outcome.verdict), escaped(outcome.verdict.sentence()));
    for table in &outcome.tables {
        let file = format!("{}/{}", one.folder, table.name);
        text +=
            &format!("<p>{}: <a href=\"{file}\">{}</a></p>\n", escaped(&table.caption), escaped(&table.name));
        if table.rows.len() <= MOST_ROWS {
            text += &rows(table);
        }
    }
    text + "</section>\n"
}

fn badge(verdict: &Verdict) -> String {
    format!("<b class=\"{}\">{}.</b>", verdict.keyword(), verdict.headline())
}

fn rows(table: &Table) -> String {
    let line = |tag: &str, cells: &[String]| {
        let cells: Vec<String> =
            cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
        format!("<tr>{}</tr>\n", cells.concat())
    };
    let body: String = table.rows.iter().map(|row| line("td", row)).collect();
    format!("<div class=\"scroll\"><table>\n{}{body}</table></div>\n", line("th", &table.head))
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
