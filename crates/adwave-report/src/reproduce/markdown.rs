//! The page of all figures as Markdown with small pictures, for the documentation.

use super::{PictureFile, ReproduceError, ReproducedFigure, Table, write};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, imageops};
use std::fmt::Write as _;
use std::path::Path;

/// Largest width of a picture in pixels.
const MAX_WIDTH: u32 = 960;
/// Largest number of pixels of a picture.
const MAX_PIXELS: f64 = 560_000.0;
/// Largest size in bytes of a PNG that is kept: charts, which JPEG would blur.
const MAX_PNG_BYTES: usize = 60_000;
/// JPEG quality at which shading has no visible blocks.
const QUALITY: u8 = 82;
/// Tables with more rows are only in the files.
const MAX_ROWS: usize = 20;
/// Longest line in characters. Wider tables are only in the files.
const MAX_LINE: usize = 120;

/// Writes the Markdown file, and its pictures to a folder next to it with the same name.
pub(super) fn write(path: &Path, made: &[ReproducedFigure]) -> Result<(), ReproduceError> {
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

/// Heading of a section, such as `## Figure 8: …`.
pub(super) fn heading(id: &str, title: &str) -> String {
    let number = |prefix: &str, word: &str| id.strip_prefix(prefix).map(|n| format!("{word} {n}"));
    let name = number("fig", "Figure").or_else(|| number("table", "Table")).unwrap_or_else(|| id.to_owned());
    format!("## {name}: {title}")
}

fn introduction(made: &[ReproducedFigure]) -> String {
    let mut text = String::from(
        "# The paper, reproduced\n\n\
         All figures and tables of Hou & Qin, *Admissible Diffusion Wavelets and Their Applications in Space-Frequency\n\
         Processing* (IEEE TVCG 2013), by one command:\n\n\
         ```sh\nadwave reproduce all -o out                       # on built-in shapes\n\
         adwave reproduce all -o out --models FOLDER       # on copies of the paper's models, found by name\n\
         adwave reproduce fig10 -o out                     # one of them\n```\n\n\
         `out/index.html` shows all figures, with pictures in full size and the numbers as CSV. This file was written by\n\
         `adwave reproduce all -o out --markdown docs/PAPER.md`: pictures, numbers and verdicts are those of that run, on\n\
         built-in shapes. Seconds are those of the machine that it ran on.\n\n\
         | | what it shows | verdict |\n|---|---|---|\n",
    );
    let mut links = String::new();
    for one in made {
        let outcome = &one.outcome;
        let anchor: String = heading(&outcome.id, &outcome.title)[3..]
            .to_lowercase()
            .chars()
            .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
            .map(|c| if c == ' ' { '-' } else { c })
            .collect();
        let headline = outcome.verdict.headline().to_lowercase();
        let _ = writeln!(text, "| [{}] | {} | {headline} |", outcome.id, outcome.title);
        let _ = writeln!(links, "[{}]: #{anchor}", outcome.id);
    }
    text + "\n" + &links
}

fn section(one: &ReproducedFigure, pictures: &[(String, &str)]) -> String {
    let outcome = &one.outcome;
    let mut text = format!("\n{}\n\n", heading(&outcome.id, &outcome.title));
    let shapes = outcome.shapes.join(", ");
    let on = if shapes.is_empty() { String::new() } else { format!(", on {shapes}") };
    let _ = writeln!(text, "{}\n", wrap(&format!("`{}`{on}, {:.1} s", outcome.command, one.seconds)));
    for (file, caption) in pictures {
        let _ = writeln!(text, "![{}]({file})\n\n{}\n", outcome.title, wrap(&format!("*{caption}*")));
    }
    for paragraph in &outcome.text {
        let _ = writeln!(text, "{}\n", wrap(paragraph));
    }
    let verdict = format!("**{}.** {}", outcome.verdict.headline(), outcome.verdict.sentence());
    let _ = writeln!(text, "{}", wrap(&verdict));
    for table in &outcome.tables {
        let shown = rows(table);
        let is_narrow = shown.lines().all(|line| line.chars().count() <= MAX_LINE);
        if table.rows.len() <= MAX_ROWS && is_narrow {
            let _ = write!(text, "\n{}\n\n{shown}", wrap(&format!("{}:", table.caption)));
        } else {
            let file = format!("{}/{}", one.folder, table.name);
            let note = format!("{}: `{file}`, {} rows.", table.caption, table.rows.len());
            let _ = writeln!(text, "\n{}", wrap(&note));
        }
    }
    text
}

/// Breaks a paragraph into lines of at most [`MAX_LINE`] characters. No line begins with a word that Markdown would take for a list or a
/// quotation.
fn wrap(paragraph: &str) -> String {
    let is_mark = |word: &str| {
        word.chars().all(|c| "+-*>#=|".contains(c))
            || word.trim_end_matches(['.', ')']).len() < word.len()
                && word.starts_with(|c: char| c.is_ascii_digit())
    };
    let mut tokens: Vec<String> = Vec::new();
    for word in paragraph.split(' ') {
        match tokens.last_mut() {
            Some(last) if is_mark(word) => *last += &format!(" {word}"),
            _ => tokens.push(word.to_owned()),
        }
    }
    let (mut text, mut length) = (String::new(), 0);
    for token in tokens {
        let n = token.chars().count();
        if length > 0 && length + 1 + n > MAX_LINE {
            text.push('\n');
            length = 0;
        } else if length > 0 {
            text.push(' ');
            length += 1;
        }
        text.push_str(&token);
        length += n;
    }
    text
}

fn rows(table: &Table) -> String {
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let rule = vec!["---".to_owned(); table.head.len()];
    let body: String = table.rows.iter().map(|row| line(row)).collect();
    format!("{}{}{body}", line(&table.head), line(&rule))
}

/// Reduces a picture; `None` for an SVG, which has a PNG of the same stem.
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

/// Composites a picture on white, since JPEG has no transparency.
fn composite_on_white(image: &DynamicImage) -> DynamicImage {
    let mut white = image::RgbaImage::from_pixel(image.width(), image.height(), image::Rgba([255; 4]));
    imageops::overlay(&mut white, &image.to_rgba8(), 0, 0);
    DynamicImage::ImageRgb8(DynamicImage::ImageRgba8(white).to_rgb8())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_short_and_do_not_begin_with_a_list_mark() {
        let text = format!("{} + {} 12. {}", "a ".repeat(59), "b ".repeat(58), "c ".repeat(100));
        let wrapped = wrap(&text);
        assert!(wrapped.lines().count() > 2);
        assert!(wrapped.lines().all(|line| line.chars().count() <= MAX_LINE));
        assert!(wrapped.lines().all(|line| !line.starts_with('+') && !line.starts_with("12.")));
        assert_eq!(wrapped.replace('\n', " "), text);
    }
}
