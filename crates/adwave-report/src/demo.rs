//! The page of the demo: one shape before and after each edit, its saliency map, its features, and what to do next.

use crate::analysis::features as find;
use crate::analysis::signed_saliency;
use crate::page::{Block, Figure, Link, Page, Section};
use crate::shape_report::drawing::{Frame, Studio};
use crate::shape_report::presets::words;
use crate::shape_report::{Subject, Viewpoint, features, saliency};
use crate::table::{Table, grouped};
use adwave::features::FeatureParams;
use adwave::shape::{Shape, triangulate};
use adwave::{Cancelled, Progress};
use adwave_render::{
    Ball, ColorMap, FieldPaint, Paint, Panel, Picture, RenderError, RenderParams, SharedCamera, Surface,
    ValueRange, grid, render, value_range,
};

/// What marks a feature in the picture of all of them.
const GREEN: [u8; 3] = [52, 168, 83];
/// The part of the vertices that share the last color of the map.
const TOP: f64 = 0.05;
/// Parts of the work, for progress.
const N_PARTS: u64 = 4;

/// An edit that is shown.
#[derive(Clone, Debug)]
pub struct ShownEdit<'a> {
    /// The name of its file without the ending; a preset's name, or another.
    pub name: &'a str,
    /// What it does, in words that go on after the name; empty for a preset.
    pub words: &'a str,
    /// The shape's vertices after it.
    pub points: Vec<[f64; 3]>,
    /// By how much vertices moved, root of the mean square, in % of the diagonal.
    pub rms_percent: f64,
}

/// What the page tells beside its pictures.
#[derive(Clone, Debug)]
pub struct DemoText {
    /// One row for each band.
    pub bands: Table,
    /// One row for each edit.
    pub edits: Table,
    /// The files beside the page.
    pub files: Vec<Link>,
    /// What to type next: a command and what it does.
    pub next: Vec<(String, String)>,
}

/// The page, and pictures that go beside it.
#[derive(Clone, Debug)]
pub struct Demo {
    /// With its pictures inside.
    pub page: Page,
    /// The shape before and after each edit, on one sheet.
    pub sheet: Picture,
    /// Where the shape stands out.
    pub saliency: Picture,
    /// A ball for each feature.
    pub features: Picture,
}

/// The names of the files that the pictures go to.
pub const PICTURES: [&str; 3] = ["sheet.png", "saliency.png", "features.png"];

/// Draws the demo's pictures and puts its page together. O(vertices + pixels) for each picture.
///
/// # Errors
/// [`DemoError`].
pub fn demo(
    subject: &Subject<'_>,
    edits: &[ShownEdit<'_>],
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
    let mut bands = Section::new("bands", "The bands that were edited");
    bands.say(
        "Band j, W_j, holds the details that are about σ_j wide, from fine to coarse. Smoothing drops them, a preset weighs \
         them, a local edit does so in a part of the shape; what is left when all are dropped is the smooth body.",
    );
    bands.push(Block::Table(text.bands));
    let (mut map, _) = saliency::section(subject, &mut studio);
    "Where the shape stands out".clone_into(&mut map.title);
    link(&mut map, PICTURES[1]);
    let (mut balls, _) = features::section(subject, &mut studio);
    link(&mut balls, PICTURES[2]);
    let mut files = Section::new("files", "Files beside this page");
    files.push(Block::Files(text.files));
    let mut next = Section::new("next", "Next, on a shape of your own");
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

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// The call was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A picture cannot be drawn.
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
            "A built-in creature of {} vertices was split into {} bands, from fine to coarse, and put together again in five \
             ways.",
            grouped(subject.shape.n_vertices()),
            subject.bands.n_levels()
        ),
        "Choose a picture to see it in full size.".to_owned(),
    ]
}

fn edits_section(
    subject: &Subject<'_>,
    edits: &[ShownEdit<'_>],
    table: Table,
    studio: &mut Studio<'_>,
) -> Section {
    let mut section = Section::new("edits", "Before and after");
    let mut frames = vec![Frame::plain(
        format!("The {} as it is", subject.name),
        "The creature as it is: `creature.ply`.",
    )];
    frames.extend(edits.iter().map(|edit| {
        let said = if edit.words.is_empty() { words(edit.name) } else { edit.words };
        Frame::plain(
            format!("The {} after {}", subject.name, edit.name),
            format!(
                "`{}` {said}. Vertices move by {:.2} % of the diagonal (rms).",
                edit.name, edit.rms_percent
            ),
        )
        .at(edit.points.clone())
    }));
    section.gallery(studio.draw(&frames));
    link(&mut section, PICTURES[0]);
    section.push(Block::Table(table));
    section
}

/// Lets the pictures of a section lead to a file beside the page.
fn link(section: &mut Section, file: &str) {
    let figures = section.blocks.iter_mut().filter_map(|block| match block {
        Block::Gallery(figures) => Some(figures),
        _ => None,
    });
    figures.flatten().for_each(|figure: &mut Figure| figure.link = Some(file.to_owned()));
}

fn sheet(
    subject: &Subject<'_>,
    edits: &[ShownEdit<'_>],
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
