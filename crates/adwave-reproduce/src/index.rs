//! Page `index.html` with all figures; pictures and numbers are files in folders.

use crate::{ReproducedFigure, Verdict};
use adwave_report::page::{self, Block, Figure, Image, ImageKind, Link, Page, Section, Tone};

/// Returns the HTML of the page, with links relative to its folder.
pub(crate) fn html(made: &[ReproducedFigure]) -> String {
    let page = Page {
        title: "The paper, reproduced".to_owned(),
        introduction: vec![
            "Figures and tables of Hou & Qin, Admissible Diffusion Wavelets and Their Applications in Space-Frequency \
             Processing (IEEE TVCG 2013). Each verdict is computed from the numbers next to it."
                .to_owned(),
        ],
        sections: made.iter().map(section).collect(),
        footer: format!("Reproduced by adwave {}.", env!("CARGO_PKG_VERSION")),
    };
    page.html()
}

fn section(one: &ReproducedFigure) -> Section {
    let outcome = &one.outcome;
    let mut section = Section::new(&outcome.id, format!("{}: {}", outcome.id, outcome.title));
    section.push(Block::Verdict(verdict(&outcome.verdict)));
    let on =
        if outcome.shapes.is_empty() { String::new() } else { format!(" on {}", outcome.shapes.join(", ")) };
    section.say(format!("`{}`{on}, in {:.1} s", outcome.command, one.seconds));
    let names: Vec<&str> = outcome.pictures.iter().map(|p| p.name.as_str()).collect();
    // An SVG with a PNG of the same stem is the same picture: it is linked, not shown.
    let (twins, shown): (Vec<_>, Vec<_>) = outcome.pictures.iter().partition(|p| {
        p.name.strip_suffix(".svg").is_some_and(|stem| names.contains(&format!("{stem}.png").as_str()))
    });
    for picture in shown {
        let file = format!("{}/{}", one.folder, picture.name);
        let svg = picture.name.strip_suffix(".svg").is_some();
        let kind = if svg { ImageKind::Svg } else { ImageKind::Png };
        section.push(Block::Gallery(vec![Figure {
            image: Image::from_file(file.clone(), kind, &picture.bytes),
            alt: picture.caption.clone(),
            caption: picture.caption.clone(),
            legend: None,
            link: Some(file),
        }]));
    }
    if !twins.is_empty() {
        let link = |name: &str| Link { path: format!("{}/{name}", one.folder), text: name.to_owned() };
        section.push(Block::Files(twins.iter().map(|p| link(&p.name)).collect()));
    }
    for paragraph in &outcome.text {
        section.say(paragraph);
    }
    for table in &outcome.tables {
        section.push(Block::TableWithFile(table.clone(), format!("{}/{}", one.folder, table.name)));
    }
    section
}

fn verdict(verdict: &Verdict) -> page::Verdict {
    page::Verdict {
        tone: match verdict {
            Verdict::AsClaimed(_) => Tone::Good,
            Verdict::PartlyAsClaimed(_) => Tone::Mixed,
            Verdict::NotAsClaimed(_) => Tone::Bad,
        },
        headline: verdict.headline().to_owned(),
        sentence: verdict.sentence().to_owned(),
    }
}
