//! Markdown page of all figures with small pictures, for a repository.

use crate::{PictureFile, ReproduceError, ReproducedFigure as Made, Table, write};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, imageops};
use std::collections::HashSet;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

/// Largest number of characters of a line of prose and of a table row.
const LINE_WIDTH: usize = 118;
/// Largest width of a picture, in pixels.
const MAX_WIDTH: u32 = 960;
/// Largest number of pixels of a picture.
const MAX_PIXELS: f64 = 560_000.0;
/// Largest size in bytes of a picture that stays a PNG, such as charts, which JPEG would blur.
const MAX_PNG_BYTES: usize = 60_000;
/// JPEG quality at which shading has no visible blocks.
const QUALITY: u8 = 82;
/// Largest number of rows of a table on the page; larger tables are only in the CSV files.
const MAX_ROWS: usize = 20;

/// Writes the Markdown file, and its pictures to a folder of the same name next to it.
pub(crate) fn write(path: &Path, made: &[Made]) -> Result<(), ReproduceError> {
    let stem = path.file_stem().map_or_else(|| "paper".to_owned(), |s| s.to_string_lossy().to_lowercase());
    let folder = path.with_file_name(&stem);
    std::fs::create_dir_all(&folder).map_err(|e| write::failed(&folder, e))?;
    let mut text = introduction(made);
    for one in made {
        let mut names = Vec::new();
        for picture in &one.outcome.pictures {
            let Some((name, bytes)) = small(one.folder, picture).map_err(|e| write::failed(path, e))? else {
                continue;
            };
            write::bytes(&folder.join(&name), &bytes)?;
            names.push((format!("{stem}/{name}"), picture.caption.as_str()));
        }
        text += &section(one, &names);
    }
    write::bytes(path, text.as_bytes())
}

/// Returns the heading of a section: `## Figure 8: …`.
pub(crate) fn heading(id: &str, title: &str) -> String {
    let number = |prefix: &str, word: &str| id.strip_prefix(prefix).map(|n| format!("{word} {n}"));
    let name = number("fig", "Figure").or_else(|| number("table", "Table"));
    let name = name.or_else(|| number("section", "Section")).unwrap_or_else(|| id.to_owned());
    format!("## {name}: {title}")
}

fn introduction(made: &[Made]) -> String {
    let mut text = String::from(
        "# The paper, reproduced\n\n\
         You want to know whether the claims of the paper hold, or to make its figures yourself. One command reproduces\n\
         every figure and table of Hou & Qin, *Admissible Diffusion Wavelets and Their Applications in Space-Frequency\n\
         Processing* (IEEE TVCG 2013):\n\n\
         ```sh\nadwave reproduce all -o out                       # on built-in shapes\n\
         adwave reproduce all -o out --models FOLDER       # on copies of the paper's models, found by name\n\
         adwave reproduce fig10 -o out                     # one of them\n```\n\n\
         `out/index.html` shows all of them, with pictures in full size and the numbers behind them as CSV. This page was\n\
         written by `adwave reproduce all -o out --markdown docs/PAPER.md`: pictures, numbers and verdicts are those of that\n\
         run on built-in shapes, and seconds are those of its machine. The verdicts are computed from the numbers:\n\n",
    );
    for one in made {
        let outcome = &one.outcome;
        let anchor: String = heading(&outcome.id, &outcome.title)[3..]
            .to_lowercase()
            .chars()
            .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
            .map(|c| if c == ' ' { '-' } else { c })
            .collect();
        let headline = outcome.verdict.headline().to_lowercase();
        text += &list_item(&format!("[{}](#{anchor}) {}: {headline}.", outcome.id, outcome.title));
    }
    text
}

fn section(one: &Made, pictures: &[(String, &str)]) -> String {
    let outcome = &one.outcome;
    let mut text = format!("\n{}\n\n", heading(&outcome.id, &outcome.title));
    let shapes = outcome.shapes.join(", ");
    let on = if shapes.is_empty() { String::new() } else { format!(", on {shapes}") };
    let _ = writeln!(text, "{}\n", wrapped(&format!("`{}`{on}, {:.1} s", outcome.command, one.seconds)));
    for (file, caption) in pictures {
        let _ = writeln!(text, "![{}]({file})\n\n{}\n", outcome.title, wrapped(&format!("*{caption}*")));
    }
    for paragraph in &outcome.text {
        let _ = writeln!(text, "{}\n", wrapped(paragraph));
    }
    let verdict = format!("**{}.** {}", outcome.verdict.headline(), outcome.verdict.sentence());
    let _ = writeln!(text, "{}", wrapped(&verdict));
    for table in &outcome.tables {
        if table.rows.len() <= MAX_ROWS {
            text += &rows(table);
        } else {
            let file =
                format!("{}: `{}/{}`, {} rows.", table.caption, one.folder, table.name, table.rows.len());
            let _ = writeln!(text, "\n{}", wrapped(&file));
        }
    }
    text
}

/// Formats a table with its caption. Columns that do not fit into one line follow in further tables, which repeat the
/// columns that identify a row.
fn rows(table: &Table) -> String {
    let lines: Vec<Vec<String>> = std::iter::once(&table.head)
        .chain(&table.rows)
        .map(|row| row.iter().map(|cell| cell.replace('|', "\\|")).collect())
        .collect();
    let n_keys = n_key_columns(&lines[1..]);
    let mut text = format!("\n{}\n", wrapped(&format!("{}:", table.caption)));
    for columns in column_groups(&lines, n_keys) {
        text.push('\n');
        for (i, line) in lines.iter().enumerate() {
            let cells: Vec<&str> =
                line[..n_keys].iter().chain(&line[columns.clone()]).map(String::as_str).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
            if i == 0 {
                let _ = writeln!(text, "| {} |", vec!["---"; cells.len()].join(" | "));
            }
        }
    }
    text
}

/// Number of leading columns, at most 3, that distinguish all rows; 1 if none do.
fn n_key_columns(rows: &[Vec<String>]) -> usize {
    let are_keys = |n: usize| {
        let mut seen = HashSet::new();
        rows.iter().all(|row| row.len() > n && seen.insert(&row[..n]))
    };
    (1..=3).find(|&n| are_keys(n)).unwrap_or(1)
}

/// Groups the columns after the first `n_keys`, so that the rows of each group fit into a line together with the first
/// ones.
fn column_groups(lines: &[Vec<String>], n_keys: usize) -> Vec<Range<usize>> {
    let n_columns = lines[0].len();
    let width = |columns: Range<usize>| {
        let of_line = |line: &Vec<String>| {
            let cells = line[..n_keys].iter().chain(&line[columns.clone()]);
            1 + cells.map(|cell| cell.chars().count() + 3).sum::<usize>()
        };
        lines.iter().map(of_line).max().unwrap_or(0)
    };
    let mut groups = Vec::new();
    let mut start = n_keys.min(n_columns);
    while start < n_columns {
        let fitting = (start + 1..=n_columns).rev().find(|&end| width(start..end) <= LINE_WIDTH);
        let end = fitting.unwrap_or(start + 1);
        groups.push(start..end);
        start = end;
    }
    if groups.is_empty() {
        groups.push(n_columns..n_columns);
    }
    groups
}

/// Formats an item of a list, wrapped, with its line end.
fn list_item(text: &str) -> String {
    format!("* {}\n", wrap_words(text, 2).replace('\n', "\n  "))
}

/// Wraps a paragraph.
fn wrapped(text: &str) -> String {
    wrap_words(text, 0)
}

/// Breaks text into lines of at most [`LINE_WIDTH`] characters minus `indent`, at spaces that are not within backticks.
fn wrap_words(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut length = 0;
    let mut is_code = false;
    for word in text.split_inclusive(|c| {
        is_code ^= c == '`';
        c == ' ' && !is_code
    }) {
        let word = word.trim_end_matches(' ');
        let n_chars = word.chars().count();
        if length > 0 && length + 1 + n_chars > LINE_WIDTH - indent {
            lines.push('\n');
            length = 0;
        } else if length > 0 {
            lines.push(' ');
            length += 1;
        }
        lines += word;
        length += n_chars;
    }
    lines
}

/// Returns the name and the bytes of a reduced picture; `None` for an SVG, which has a PNG of the same content.
fn small(folder: &str, picture: &PictureFile) -> image::ImageResult<Option<(String, Vec<u8>)>> {
    let Some(stem) = picture.name.strip_suffix(".png") else { return Ok(None) };
    let name = if stem == folder { folder.to_owned() } else { format!("{folder}-{stem}") };
    let mut image = image::load_from_memory(&picture.bytes)?;
    let (width, height) = (f64::from(image.width()), f64::from(image.height()));
    let scale = (f64::from(MAX_WIDTH) / width).min((MAX_PIXELS / (width * height)).sqrt());
    if scale < 1.0 {
        let [width, height] = [width, height].map(|side| (scale * side).round().max(1.0) as u32);
        image = image.resize_exact(width, height, imageops::FilterType::Lanczos3);
    }
    let image = composite_on_white(&image);
    let mut png = Vec::new();
    image.write_with_encoder(PngEncoder::new_with_quality(
        &mut png,
        CompressionType::Best,
        FilterType::Adaptive,
    ))?;
    if png.len() <= MAX_PNG_BYTES {
        return Ok(Some((format!("{name}.png"), png)));
    }
    let mut jpeg = Vec::new();
    image.write_with_encoder(JpegEncoder::new_with_quality(&mut jpeg, QUALITY))?;
    Ok(Some((format!("{name}.jpg"), jpeg)))
}

/// Composites a picture on white, because JPEG has no transparency.
fn composite_on_white(image: &DynamicImage) -> DynamicImage {
    let mut white = image::RgbaImage::from_pixel(image.width(), image.height(), image::Rgba([255; 4]));
    imageops::overlay(&mut white, &image.to_rgba8(), 0, 0);
    DynamicImage::ImageRgb8(DynamicImage::ImageRgba8(white).to_rgb8())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_is_broken_at_spaces_outside_code() {
        let text = format!("{} `a code span` end", "word ".repeat(22).trim_end());
        let lines = wrapped(&text);
        assert_eq!(lines.lines().nth(1), Some("`a code span` end"), "{lines}");
        assert_eq!(lines.replace('\n', " "), text);
        assert_eq!(list_item("one two"), "* one two\n");
    }

    #[test]
    fn wide_tables_are_split_and_repeat_the_columns_that_identify_a_row() {
        let row = |cells: &[&str]| cells.iter().map(|&c| c.to_owned()).collect::<Vec<String>>();
        let wide = "w".repeat(50);
        let lines = [row(&["kind", "level", &wide, &wide, "x"]), row(&["a", "1", "2", "3", "4"])];
        assert_eq!(n_key_columns(&lines[1..]), 1);
        let repeated = [row(&["a", "1"]), row(&["a", "2"]), row(&["b", "1"])].map(|mut r| {
            r.push("value".to_owned());
            r
        });
        assert_eq!(n_key_columns(&repeated), 2);
        assert_eq!(column_groups(&lines, 2), [2..3, 3..5]);
        assert_eq!(column_groups(&lines[1..], 1), vec![1..5; 1]);
    }
}
