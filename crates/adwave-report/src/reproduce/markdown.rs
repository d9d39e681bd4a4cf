//! The page of all figures as Markdown with small pictures, for a repository.

use super::{PictureFile, ReproduceError, ReproducedFigure as Made, Table, write};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, imageops};
use std::fmt::Write as _;
use std::path::Path;

/// Pictures are no wider than this, in pixels.
const WIDEST: u32 = 960;
/// Nor do they have more pixels than this.
const MAX_PIXELS: f64 = 560_000.0;
/// A picture that is no larger as PNG stays one, in bytes: charts, which JPEG would blur.
const MAX_PNG_BYTES: usize = 60_000;
/// Quality of JPEG: shading without visible blocks.
const QUALITY: u8 = 82;
/// Tables with more rows are in the files only.
const MAX_ROWS: usize = 20;

/// Writes the Markdown file, and its pictures to a folder beside it that is named after it.
pub(super) fn write(path: &Path, made: &[Made]) -> Result<(), ReproduceError> {
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

/// `## Figure 8: …`, what stands over each section.
pub(super) fn heading(id: &str, title: &str) -> String {
    let number = |prefix: &str, word: &str| id.strip_prefix(prefix).map(|n| format!("{word} {n}"));
    let name = number("fig", "Figure").or_else(|| number("table", "Table")).unwrap_or_else(|| id.to_owned());
    format!("## {name}: {title}")
}

fn introduction(made: &[Made]) -> String {
    let mut text = String::from(
        "# The paper, reproduced\n\n\
         Every figure and table of Hou & Qin, *Admissible Diffusion Wavelets and Their Applications in Space-Frequency \
         Processing* (IEEE TVCG 2013), by one command:\n\n\
         ```sh\nadwave reproduce all -o out                       # on built-in shapes\n\
         adwave reproduce all -o out --models FOLDER       # on copies of the paper's models, found by name\n\
         adwave reproduce fig10 -o out                     # one of them\n```\n\n\
         `out/index.html` shows all, with pictures in full size and the numbers behind them as CSV. This file was written \
         by `adwave reproduce all -o out --markdown docs/PAPER.md`: pictures, numbers and verdicts are those of that run, \
         on built-in shapes. Seconds are those of the machine it ran on.\n\n\
         | | what it shows | verdict |\n|---|---|---|\n",
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
        let _ = writeln!(text, "| [{}](#{anchor}) | {} | {headline} |", outcome.id, outcome.title);
    }
    text
}

fn section(one: &Made, pictures: &[(String, &str)]) -> String {
    let outcome = &one.outcome;
    let mut text = format!("\n{}\n\n", heading(&outcome.id, &outcome.title));
    let shapes = outcome.shapes.join(", ");
    let on = if shapes.is_empty() { String::new() } else { format!(", on {shapes}") };
    let _ = writeln!(text, "`{}`{on}, {:.1} s\n", outcome.command, one.seconds);
    for (file, caption) in pictures {
        let _ = writeln!(text, "![{}]({file})\n\n*{caption}*\n", outcome.title);
    }
    for paragraph in &outcome.text {
        let _ = writeln!(text, "{paragraph}\n");
    }
    let _ = writeln!(text, "**{}.** {}", outcome.verdict.headline(), outcome.verdict.sentence());
    for table in &outcome.tables {
        if table.rows.len() <= MAX_ROWS {
            text += &rows(table);
        } else {
            let _ = writeln!(
                text,
                "\n{}: `{}/{}`, {} rows.",
                table.caption,
                one.folder,
                table.name,
                table.rows.len()
            );
        }
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
    format!("\n{}:\n\n{}{}{body}", table.caption, line(&table.head), line(&rule))
}

/// A picture made small; nothing for an SVG, which has its PNG beside it.
fn small(folder: &str, picture: &PictureFile) -> image::ImageResult<Option<(String, Vec<u8>)>> {
    let Some(stem) = picture.name.strip_suffix(".png") else { return Ok(None) };
    let name = if stem == folder { folder.to_owned() } else { format!("{folder}-{stem}") };
    let mut image = image::load_from_memory(&picture.bytes)?;
    let (width, height) = (f64::from(image.width()), f64::from(image.height()));
    let scale = (f64::from(WIDEST) / width).min((MAX_PIXELS / (width * height)).sqrt());
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
