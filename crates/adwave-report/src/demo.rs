//! Page of the demo: a shape before and after each edit, its saliency map, its features, and commands to try next.

use crate::analysis::features as find;
use crate::analysis::signed_saliency;
use crate::page::{Block, Figure, Link, Page, Section};
use crate::shape_report::drawing::{PictureSpec, Studio};
use crate::shape_report::presets::describe_preset;
use crate::shape_report::{Subject, Viewpoint, features, saliency};
use crate::table::{Table, grouped};
use adwave::features::FeatureParams;
use adwave::shape::{Shape, triangulate};
use adwave::{Cancelled, Progress};
use adwave_render::{
    Ball, ColorMap, FieldPaint, Paint, Panel, Picture, RenderError, RenderParams, SharedCamera, Surface,
    ValueRange, grid, render, value_range,
};

/// Color of the balls that mark features.
const GREEN: [u8; 3] = [52, 168, 83];
/// Share of the vertices that have the last color of the color map.
const TOP: f64 = 0.05;
/// Number of parts of the work, for progress.
const N_PARTS: u64 = 4;

/// Edit that the page shows.
#[derive(Clone, Debug)]
pub struct DemoEdit<'a> {
    /// Name of the edit's file without the extension: the name of a preset, or another name.
    pub name: &'a str,
    /// Description that continues a sentence after the name; empty for a preset.
    pub words: &'a str,
    /// Positions of the vertices after the edit.
    pub points: Vec<[f64; 3]>,
    /// Root mean square of the distances that the vertices moved, in % of the diagonal.
    pub rms_percent: f64,
}

/// Text and tables of the page.
#[derive(Clone, Debug)]
pub struct DemoText {
    /// One row per band.
    pub bands: Table,
    /// One row per edit.
    pub edits: Table,
    /// Files in the folder of the page.
    pub files: Vec<Link>,
    /// Commands to try next, with their descriptions.
    pub next: Vec<(String, String)>,
}

/// Page of the demo, and the pictures that have their own files.
#[derive(Clone, Debug)]
pub struct Demo {
    /// Page with its pictures embedded.
    pub page: Page,
    /// Sheet with the shape before and after each edit.
    pub sheet: Picture,
    /// Picture of the saliency map.
    pub saliency: Picture,
    /// Picture of the features as balls.
    pub features: Picture,
}

/// File names of the pictures: sheet, saliency map, features.
pub const PICTURES: [&str; 3] = ["sheet.png", "saliency.png", "features.png"];

/// Draws the pictures of the demo and assembles its page. O(vertices + pixels) for each picture.
///
/// # Errors
/// [`DemoError`].
pub fn demo(
    subject: &Subject<'_>,
    edits: &[DemoEdit<'_>],
    text: DemoText,
    progress: Progress<'_>,
) -> Result<Demo, DemoError> {
    let triangles = match (subject.shape, subject.shape.points()) {
        (Shape::Mesh(mesh), Some(points)) => triangulate(points, mesh.faces()),
        _ => Vec::new(),
    };
    progress.step(0, N_PARTS)?;
    let sheet = sheet(subject, edits, &triangles, progress)?;
    progress.step(1, N_PARTS)?;
    let saliency_picture = saliency_picture(subject, &triangles, progress)?;
    let features_picture = features_picture(subject, &triangles, progress)?;
    progress.step(2, N_PARTS)?;
    let mut studio = Studio::new(subject.shape, Viewpoint::default(), progress)?;
    let edits_section = edits_section(subject, edits, text.edits, &mut studio);
    progress.step(3, N_PARTS)?;
    let mut bands = Section::new("bands", "The edited bands");
    bands.say(
        "Band W_j contains the details of width about σ_j. Bands are numbered from fine to coarse. Smoothing removes bands, a \
         preset multiplies them by gains, and a local edit does so in a region. The smooth body remains when all bands are removed.",
    );
    bands.push(Block::Table(text.bands));
    let (mut map, _) = saliency::section(subject, &mut studio);
    "Saliency: where the shape stands out".clone_into(&mut map.title);
    link(&mut map, PICTURES[1]);
    let (mut balls, _) = features::section(subject, &mut studio);
    link(&mut balls, PICTURES[2]);
    let mut files = Section::new("files", "Files in this folder");
    files.push(Block::Files(text.files));
    let mut next = Section::new("next", "Next: try your own shape");
    for (command, what) in text.next {
        next.say(format!("`{command}`: {what}."));
    }
    progress.step(N_PARTS, N_PARTS)?;
    let page = Page {
        title: "adwave: wavelets for shapes".to_owned(),
        introduction: introduction(subject),
        sections: vec![edits_section, bands, map, balls, next, files],
        footer: format!("Made by adwave {} with `{}`.", env!("CARGO_PKG_VERSION"), subject.command),
    };
    Ok(Demo { page, sheet, saliency: saliency_picture, features: features_picture })
}

/// Failure to make the demo.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DemoError {
    /// The caller cancelled the call.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A picture could not be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
}

impl adwave::ClassifiedError for DemoError {
    fn kind(&self) -> adwave::ErrorKind {
        match self {
            Self::Cancelled(error) => error.kind(),
            Self::Render(error) => error.kind(),
        }
    }
}

fn introduction(subject: &Subject<'_>) -> Vec<String> {
    vec![
        format!(
            "A built-in creature of {} vertices was decomposed into {} bands, from fine to coarse, and reconstructed in five \
             ways.",
            grouped(subject.shape.n_vertices()),
            subject.bands.n_levels()
        ),
        "Click a picture to see it in full size.".to_owned(),
    ]
}

fn edits_section(
    subject: &Subject<'_>,
    edits: &[DemoEdit<'_>],
    table: Table,
    studio: &mut Studio<'_>,
) -> Section {
    let mut section = Section::new("edits", "Before and after");
    let mut specs = vec![PictureSpec::plain(
        format!("The original {}", subject.name),
        "The original creature: `creature.ply`.",
    )];
    specs.extend(edits.iter().map(|edit| {
        let description = if edit.words.is_empty() { describe_preset(edit.name) } else { edit.words };
        PictureSpec::plain(
            format!("The {} after {}", subject.name, edit.name),
            format!(
                "`{}` {description}. Vertices move by {:.2} % of the diagonal (rms).",
                edit.name, edit.rms_percent
            ),
        )
        .with_positions(edit.points.clone())
    }));
    section.gallery(studio.draw(&specs));
    link(&mut section, PICTURES[0]);
    section.push(Block::Table(table));
    section
}

/// Links the pictures of a section to a file in the folder of the page.
fn link(section: &mut Section, file: &str) {
    let figures = section.blocks.iter_mut().filter_map(|block| match block {
        Block::Gallery(figures) => Some(figures),
        _ => None,
    });
    figures.flatten().for_each(|figure: &mut Figure| figure.link = Some(file.to_owned()));
}

fn sheet(
    subject: &Subject<'_>,
    edits: &[DemoEdit<'_>],
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Picture, RenderError> {
    let panel = |points, caption: &str| Panel {
        surface: Surface { points, triangles, paint: Paint::CLAY },
        balls: Vec::new(),
        caption: caption.to_owned(),
    };
    let mut panels = vec![panel(subject.shape.points().unwrap_or_default(), "before")];
    panels.extend(edits.iter().map(|edit| panel(&edit.points, edit.name)));
    grid(&panels, 3, SharedCamera::Same, &RenderParams::default().with_size(640, 560), progress.quiet())
}

fn saliency_picture(
    subject: &Subject<'_>,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Picture, RenderError> {
    let map = signed_saliency(subject.decomposer, subject.bands, true, None).map(|s| s.map);
    let points = subject.shape.points().unwrap_or_default();
    let map = map.unwrap_or_else(|_| vec![0.0; points.len()]);
    let sizes: Vec<f64> = map.iter().map(|v| v.abs()).collect();
    let high = value_range(&sizes, 0.0, 1.0 - TOP).1;
    let range = if high > 0.0 { ValueRange::Fixed(-high, high) } else { ValueRange::Auto };
    let paint = Paint::Field(FieldPaint {
        values: &map,
        label: "saliency".to_owned(),
        color_map: ColorMap::from_name("coolwarm"),
        range,
    });
    render(&Surface { points, triangles, paint }, &[], &RenderParams::default(), progress.quiet())
}

fn features_picture(
    subject: &Subject<'_>,
    triangles: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Picture, RenderError> {
    let found = find(subject.decomposer, subject.bands, &FeatureParams::default()).unwrap_or_default();
    let balls: Vec<Ball> = found
        .iter()
        .filter_map(|f| Some(Ball { center: f.position?, radius: f.sigma, color: GREEN }))
        .filter(|ball| ball.radius > 0.0)
        .collect();
    let points = subject.shape.points().unwrap_or_default();
    render(
        &Surface { points, triangles, paint: Paint::CLAY },
        &balls,
        &RenderParams::default(),
        progress.quiet(),
    )
}
