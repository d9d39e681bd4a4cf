//! What a shape consists of, what is unusual about it, and what that means for its bands.

use super::Subject;
use crate::page::{Block, Fact, Section, Tone, Verdict};
use crate::table::{digits, grouped};
use adwave::operator::OperatorKind;
use adwave::shape::{Health, Shape, bounding_box};

pub(super) fn section(subject: &Subject<'_>) -> (Section, Health) {
    let health = subject.decomposer.health();
    let mut section = Section::new("health", "Health");
    let odd = oddities(subject, &health);
    section.push(Block::Verdict(verdict(subject, &health, &odd)));
    if !odd.is_empty() {
        section.push(Block::Facts(odd));
    }
    section.push(Block::Facts(facts(subject, &health)));
    (section, health)
}

fn fact(name: &str, value: impl Into<String>, meaning: &str) -> Fact {
    Fact { name: name.to_owned(), value: value.into(), meaning: meaning.to_owned() }
}

/// Counts that are 0 when all is well: how many, of what, and what it means.
fn oddities(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let vertices_left_out =
        subject.decomposer.mask_flags().map_or(0, |out| out.iter().filter(|&&out| out).count());
    let counts = [
        (
            "Edges on a border",
            health.n_boundary_edges,
            "Edges of one face only: the surface is open there. Averages lean inwards at a border, so bands are larger along it.",
        ),
        (
            "Edges of three faces or more",
            health.n_non_manifold_edges,
            "The surface branches there; diffusion goes along every branch.",
        ),
        (
            "Edges where orientation flips",
            health.n_misoriented_edges,
            "Two faces run the same way along them, so their normals disagree. Bands do not use normals; curvature does.",
        ),
        ("Faces without area", health.n_zero_area_faces, "They join their corners but weigh nothing."),
        (
            "Repeated faces",
            health.n_repeated_faces,
            "Faces with the vertices of an earlier one: they weigh twice.",
        ),
        (
            "Vertices at another's position",
            health.n_welded,
            "Taken as one welded vertex; results are given to each of them.",
        ),
        ("Vertices without neighbors", health.n_isolated, "Nothing to average with: every band is 0 there."),
        ("Vertices of no face", health.n_unreferenced, "Points that the surface does not use."),
        (
            "Vertices without a value",
            vertices_left_out,
            "The signal is NaN there: they are masked, and no result has a value there.",
        ),
    ];
    counts
        .into_iter()
        .filter(|&(_, count, _)| count > 0)
        .map(|(name, count, meaning)| match subject.shape {
            Shape::Graph(_) => fact(&name.replace("Vertices", "Nodes"), grouped(count), meaning),
            _ => fact(name, grouped(count), meaning),
        })
        .collect()
}

fn verdict(subject: &Subject<'_>, health: &Health, odd: &[Fact]) -> Verdict {
    let n_parts = health.n_components - health.n_isolated;
    let kind = match subject.shape {
        Shape::Mesh(_) if health.is_closed() => "A closed surface",
        Shape::Mesh(_) => "An open surface",
        Shape::Cloud(_) => "A cloud of points",
        Shape::Graph(_) => "A graph",
    };
    let parts = match n_parts {
        0 => "without an edge".to_owned(),
        1 => "in one part".to_owned(),
        n => format!("in {n} parts, which do not see each other"),
    };
    if odd.is_empty() {
        return Verdict {
            tone: Tone::Good,
            headline: "Nothing unusual".to_owned(),
            sentence: format!("{kind} {parts}."),
        };
    }
    let list: Vec<String> = odd.iter().map(|f| format!("{}: {}", f.name.to_lowercase(), f.value)).collect();
    Verdict {
        tone: Tone::Mixed,
        headline: match odd.len() {
            1 => "One thing to know".to_owned(),
            n => format!("{n} things to know"),
        },
        sentence: format!("{kind} {parts}. It can be worked with as it is; {}.", list.join(", ")),
    }
}

fn facts(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let mut list = counts(subject, health);
    list.extend(sizes(subject, health));
    let diffusion = subject.decomposer.diffusion();
    let (edge, step) = (subject.decomposer.mean_length(), diffusion.step_length());
    let unit = subject.width_unit();
    if subject.shape.points().is_some() {
        let kind = subject.decomposer.operator_kind();
        let meaning = match (subject.shape, kind) {
            (Shape::Mesh(_), OperatorKind::Walk) => {
                "Mean over the edges; the operator's kernel is as wide as that."
            }
            (Shape::Mesh(_), OperatorKind::Surface) => "Mean over the edges.",
            (_, OperatorKind::Walk) => {
                "Mean distance to the nearest neighbors; the operator's kernel is as wide as that."
            }
            (_, OperatorKind::Surface) => "Mean distance to the neighbors on the surface.",
        };
        let name = if let Shape::Mesh(_) = subject.shape { "Mean edge" } else { "Mean spacing" };
        list.push(fact(name, format!("{} {unit}", digits(edge)), meaning));
    }
    let (name, meaning) = match subject.decomposer.operator_kind() {
        OperatorKind::Walk => ("walk", "A lazy random walk over the edges, as in the paper."),
        OperatorKind::Surface => ("surface", "Heat on the surface: widths that hardly depend on the mesh."),
    };
    list.push(fact("Diffusion operator", name.to_owned(), meaning));
    list.push(fact(
        "Step of the diffusion operator",
        format!("{} {unit}", digits(step)),
        "Root mean square length s of one step; after n steps σ = s·√n.",
    ));
    if !subject.fields.is_empty() {
        list.push(fact(
            "Fields in the file",
            subject.fields.join(", "),
            "Each can be reported with `--field`.",
        ));
    }
    list
}

fn counts(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let (kind, one) = match subject.shape {
        Shape::Mesh(_) => ("mesh", "Vertices"),
        Shape::Cloud(_) => ("cloud", "Points"),
        Shape::Graph(_) => ("graph", "Nodes"),
    };
    let mut list = vec![
        fact("Kind", format!("{kind}, {}", subject.format), ""),
        fact(one, grouped(health.n_vertices), ""),
    ];
    if let Shape::Mesh(_) = subject.shape {
        let polygons = match health.n_polygons {
            0 => String::new(),
            n => format!("{} of them have more than three corners and are cut into triangles.", grouped(n)),
        };
        list.push(fact("Faces", grouped(health.n_faces), &polygons));
    }
    let edges = match subject.shape {
        Shape::Mesh(_) => "Distinct, after welding.",
        Shape::Cloud(_) => "Pairs of neighbors that the diffusion steps between.",
        Shape::Graph(_) => "",
    };
    list.push(fact("Edges", grouped(health.n_edges), edges));
    list.push(fact(
        "Parts",
        grouped(health.n_components - health.n_isolated),
        "Connected over edges. Nothing is averaged across a gap.",
    ));
    if let Shape::Mesh(_) = subject.shape {
        list.push(if health.is_closed() {
            fact("Surface", "closed", "Every edge has two faces: it has an inside.")
        } else {
            fact("Surface", "open", "Some edges do not have two faces.")
        });
    }
    list
}

fn sizes(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let mut list = Vec::new();
    if let Shape::Mesh(_) = subject.shape {
        list.push(fact("Area", format!("{} model units²", digits(health.area)), ""));
        if let Some(volume) = health.volume {
            let meaning =
                if volume < 0.0 { "Negative: the faces look inwards." } else { "Enclosed by the surface." };
            list.push(fact("Volume", format!("{} model units³", digits(volume)), meaning));
        }
        if let Some(euler) = health.euler_characteristic {
            let n_parts = (health.n_components - health.n_isolated) as i64;
            let meaning = if health.is_closed() && health.volume.is_some() && n_parts == 1 && euler % 2 == 0 {
                match (2 - euler) / 2 {
                    0 => "V − E + F; a sphere in kind, without a hole through it.".to_owned(),
                    1 => "V − E + F; a torus in kind, with one hole through it.".to_owned(),
                    n => format!("V − E + F; {n} holes through it."),
                }
            } else {
                "V − E + F.".to_owned()
            };
            list.push(fact("Euler characteristic", euler.to_string(), &meaning));
        }
    }
    if let Some((low, high)) = subject.shape.points().and_then(bounding_box) {
        let sides = [0, 1, 2].map(|k| digits(high[k] - low[k]));
        let from = subject.position(low);
        let to = subject.position(high);
        list.push(fact(
            "Bounding box, x × y × z",
            format!("{} model units", sides.join(" × ")),
            &format!("From ({from}) to ({to})."),
        ));
        list.push(fact(
            "Diagonal",
            format!("{} model units", digits(subject.decomposer.diagonal())),
            "Of the bounding box: the size of the shape, which percentages of lengths refer to.",
        ));
    }
    list
}
