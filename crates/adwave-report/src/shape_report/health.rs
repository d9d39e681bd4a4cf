//! Health section: parts and irregularities of a shape, and their effect on the bands.

use super::Subject;
use crate::page::{Block, Fact, Section, Tone, Verdict};
use crate::table::{digits, grouped};
use adwave::operator::OperatorKind;
use adwave::shape::{Health, Shape, bounding_box};

pub(super) fn section(subject: &Subject<'_>) -> (Section, Health) {
    let health = subject.decomposer.health();
    let mut section = Section::new("health", "Health");
    let irregularities = irregularities(subject, &health);
    section.push(Block::Verdict(verdict(subject, &health, &irregularities)));
    if !irregularities.is_empty() {
        section.push(Block::Facts(irregularities));
    }
    section.push(Block::Facts(facts(subject, &health)));
    (section, health)
}

fn fact(name: &str, value: impl Into<String>, meaning: &str) -> Fact {
    Fact { name: name.to_owned(), value: value.into(), meaning: meaning.to_owned() }
}

/// Lists the irregularities of the shape, with their counts and effects.
fn irregularities(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let n_masked = subject.decomposer.mask_flags().map_or(0, |out| out.iter().filter(|&&out| out).count());
    let counts = [
        (
            "Edges on a border",
            health.n_boundary_edges,
            "Edges of a single face: the surface is open there. Averages at a border are biased inward, so that bands are larger along it.",
        ),
        (
            "Edges of three or more faces",
            health.n_non_manifold_edges,
            "The surface branches there; diffusion follows every branch.",
        ),
        (
            "Edges where the orientation flips",
            health.n_misoriented_edges,
            "Two faces traverse them in the same direction, so their normals disagree. Bands do not use normals; curvature does.",
        ),
        ("Faces without area", health.n_zero_area_faces, "They connect their corners but have no weight."),
        (
            "Repeated faces",
            health.n_repeated_faces,
            "Faces with the same vertices as an earlier face: they count twice.",
        ),
        (
            "Vertices at another's position",
            health.n_welded,
            "They are one welded vertex; each of them gets its results.",
        ),
        (
            "Vertices without neighbors",
            health.n_isolated,
            "There is nothing to average with: every band is 0 there.",
        ),
        ("Vertices of no face", health.n_unreferenced, "Points that no face uses."),
        (
            "Vertices without a value",
            n_masked,
            "The signal is NaN there: these vertices are masked and have no results.",
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

fn verdict(subject: &Subject<'_>, health: &Health, irregularities: &[Fact]) -> Verdict {
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
        n => format!("in {n} unconnected parts"),
    };
    if irregularities.is_empty() {
        return Verdict {
            tone: Tone::Good,
            headline: "Nothing unusual".to_owned(),
            sentence: format!("{kind} {parts}."),
        };
    }
    let list: Vec<String> =
        irregularities.iter().map(|f| format!("{}: {}", f.name.to_lowercase(), f.value)).collect();
    Verdict {
        tone: Tone::Mixed,
        headline: match irregularities.len() {
            1 => "One irregularity".to_owned(),
            n => format!("{n} irregularities"),
        },
        sentence: format!("{kind} {parts}. It can be processed as it is; {}.", list.join(", ")),
    }
}

fn facts(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let mut list = counts(subject, health);
    list.extend(sizes(subject, health));
    let (edge, unit) = (subject.decomposer.mean_length(), subject.width_unit());
    if subject.shape.points().is_some() {
        let kind = subject.decomposer.operator_kind();
        let meaning = match (subject.shape, kind) {
            (Shape::Mesh(_), OperatorKind::Walk) => {
                "Mean over the edges, and the width of the operator's kernel."
            }
            (Shape::Mesh(_), OperatorKind::Surface) => "Mean over the edges.",
            (_, OperatorKind::Walk) => {
                "Mean distance to the nearest neighbors, and the width of the operator's kernel."
            }
            (_, OperatorKind::Surface) => "Mean distance to the neighbors on the surface.",
        };
        let name = if subject.shape.is_mesh() { "Mean edge" } else { "Mean spacing" };
        list.push(fact(name, format!("{} {unit}", digits(edge)), meaning));
    }
    list.extend(operator_facts(subject));
    list
}

/// Facts about the diffusion operator and the fields of the file.
pub(super) fn operator_facts(subject: &Subject<'_>) -> Vec<Fact> {
    let (name, meaning) = match subject.decomposer.operator_kind() {
        _ if subject.grid.is_some() => {
            ("heat", "Heat on the grid: a Gaussian of the same width along each axis, whose borders reflect.")
        }
        OperatorKind::Walk => ("walk", "A lazy random walk over the edges, as in the paper."),
        OperatorKind::Surface => {
            ("surface", "Heat diffusion on the surface; its widths hardly depend on the mesh.")
        }
    };
    let (step, unit) = (subject.decomposer.operator().step_length(), subject.width_unit());
    let mut list = vec![
        fact("Diffusion operator", name.to_owned(), meaning),
        fact(
            "Step of the diffusion operator",
            format!("{} {unit}", digits(step)),
            "Root mean square length s of a step; after n steps, σ = s·√n.",
        ),
    ];
    if !subject.fields.is_empty() {
        list.push(fact(
            "Fields in the file",
            subject.fields.join(", "),
            "Each can be the signal of a report, with `--field`.",
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
    if subject.shape.is_mesh() {
        let polygons = match health.n_polygons {
            0 => String::new(),
            n => format!("{} of them have more than three corners and are triangulated.", grouped(n)),
        };
        list.push(fact("Faces", grouped(health.n_faces), &polygons));
    }
    let edges = match subject.shape {
        Shape::Mesh(_) => "Distinct, after welding.",
        Shape::Cloud(_) => "Pairs of neighbors.",
        Shape::Graph(_) => "",
    };
    list.push(fact("Edges", grouped(health.n_edges), edges));
    list.push(fact(
        "Parts",
        grouped(health.n_components - health.n_isolated),
        "Connected by edges. Nothing is averaged across gaps.",
    ));
    if subject.shape.is_mesh() {
        list.push(if health.is_closed() {
            fact("Surface", "closed", "Every edge has two faces: the surface encloses a volume.")
        } else {
            fact("Surface", "open", "Some edges do not have two faces.")
        });
    }
    list
}

fn sizes(subject: &Subject<'_>, health: &Health) -> Vec<Fact> {
    let mut list = Vec::new();
    if subject.shape.is_mesh() {
        list.push(fact("Area", format!("{} model units²", digits(health.area)), ""));
        if let Some(volume) = health.volume {
            let meaning = if volume < 0.0 {
                "Negative: the faces are oriented inward."
            } else {
                "Enclosed by the surface."
            };
            list.push(fact("Volume", format!("{} model units³", digits(volume)), meaning));
        }
        if let Some(euler) = health.euler_characteristic {
            let n_parts = (health.n_components - health.n_isolated) as i64;
            let meaning = if health.is_closed() && health.volume.is_some() && n_parts == 1 && euler % 2 == 0 {
                match (2 - euler) / 2 {
                    0 => "V − E + F; topologically a sphere.".to_owned(),
                    1 => "V − E + F; topologically a torus.".to_owned(),
                    n => format!("V − E + F; genus {n}."),
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
            "Extent",
            format!("{} model units", digits(subject.decomposer.extent())),
            "Diagonal of the bounding box of the largest part, without strays; percentages of lengths refer to it.",
        ));
    }
    list
}
