//! Images and volumes as subjects of a report: their axes, and the flat mesh on which they are drawn.

use super::Subject;
use super::health::operator_facts;
use crate::page::{Block, Fact, Section};
use crate::table::{digits, grouped};

/// Image or volume that carries the signal of a report.
#[derive(Clone, Copy, Debug)]
pub struct SubjectGrid<'a> {
    /// Kind, such as `volume`.
    pub kind: &'a str,
    /// Words for one place and for several, such as `voxel` and `voxels`.
    pub words: [&'static str; 2],
    /// Names of the axes.
    pub axis_names: &'a [&'static str],
    /// Number of places along each axis, in the order of the values.
    pub sizes: &'a [usize],
    /// Distance of neighbors along each axis.
    pub spacings: &'a [f64],
    /// Unit of lengths, in words.
    pub unit: &'a str,
    /// Mesh that is drawn; `None` for a sequence.
    pub sheet: Option<FlatMesh<'a>>,
}

/// Flat mesh that shows an image, or slices of a volume, in the plane z = 0.
#[derive(Clone, Copy, Debug)]
pub struct FlatMesh<'a> {
    /// Positions of the points.
    pub points: &'a [[f64; 3]],
    /// Triangles between the points.
    pub triangles: &'a [[u32; 3]],
    /// Place of the grid at each point.
    pub places: &'a [u32],
}

impl SubjectGrid<'_> {
    /// Index of a place along each axis, such as `12, 40`.
    pub fn index(&self, place: usize) -> String {
        grid_index(self.sizes, place).iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
    }

    /// Position on the sheet of an image that shows a place, or the drawn place before it; `None` for a volume, of
    /// which a sheet shows slices.
    pub(super) fn position_on_sheet(&self, place: usize) -> Option<[f64; 3]> {
        let sheet = self.sheet.filter(|_| self.sizes.len() == 2)?;
        // The points of an image are in the order of its places.
        let after = sheet.places.partition_point(|&own| own as usize <= place);
        sheet.points.get(after.checked_sub(1)?).copied()
    }
}

/// Index along each axis of a place in a grid of these sizes, the last axis contiguous.
///
/// ```
/// use adwave_report::shape_report::grid_index;
/// assert_eq!(grid_index(&[2, 3, 4], 23), [1, 2, 3]);
/// assert_eq!(grid_index(&[5, 3], 4), [1, 1]);
/// ```
pub fn grid_index(sizes: &[usize], place: usize) -> Vec<usize> {
    let mut rest = place;
    let mut index: Vec<usize> = sizes
        .iter()
        .rev()
        .map(|size| {
            let at = rest % size;
            rest /= size;
            at
        })
        .collect();
    index.reverse();
    index
}

/// Section on the axes and the values, in place of the health of a shape.
pub(super) fn section(subject: &Subject<'_>, grid: &SubjectGrid<'_>) -> Section {
    let fact = |name: &str, value: String, meaning: &str| Fact {
        name: name.to_owned(),
        value,
        meaning: meaning.to_owned(),
    };
    let mut section = Section::new("health", "Axes and values");
    let mut facts = vec![fact("Kind", format!("{}, {}", grid.kind, subject.format), "")];
    for ((name, size), spacing) in grid.axis_names.iter().zip(grid.sizes).zip(grid.spacings) {
        let value = format!(
            "{} {}, {} apart, {} in all",
            grouped(*size),
            grid.words[1],
            digits(*spacing),
            digits(*size as f64 * spacing)
        );
        facts.push(fact(&format!("Axis {name}"), value, ""));
    }
    facts.push(fact("Unit of lengths", grid.unit.to_owned(), ""));
    let n_places: usize = grid.sizes.iter().product();
    facts.push(fact("Places", grouped(n_places), ""));
    let missing = subject.decomposer.mask_flags().map_or(0, |out| out.iter().filter(|&&out| out).count());
    if missing > 0 {
        let percent = format!("{} ({:.1} %)", grouped(missing), 100.0 * missing as f64 / n_places as f64);
        facts.push(fact("Places without data", percent, "No step reaches or leaves them."));
    }
    let known = || subject.values.iter().copied().filter(|v| v.is_finite());
    let n = known().count().max(1) as f64;
    let (low, high) = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let mean = known().map(|v| v / n).sum::<f64>();
    let channels = match subject.bands.n_channels {
        1 => String::new(),
        n => format!("Over {n} channels, each of which is processed on its own; pictures show the norm."),
    };
    facts.push(fact(
        "Values",
        format!("{} to {}, mean {}", digits(low), digits(high), digits(mean)),
        &channels,
    ));
    facts.extend(operator_facts(subject));
    section.push(Block::Facts(facts));
    section
}

/// Section with the picture of the signal.
pub(super) fn scene(
    subject: &Subject<'_>,
    grid: &SubjectGrid<'_>,
    studio: &mut super::Studio<'_>,
) -> Section {
    let mut section = Section::new("shape", format!("The {}", grid.kind));
    if !studio.can_draw() {
        section.say("A sequence is not drawn. The report has charts and tables.");
        return section;
    }
    let caption = match (grid.sizes, subject.decomposer.mask_flags()) {
        ([n, ..], _) if grid.sizes.len() > 2 => format!(
            "The three slices through the middle {}, {} {}, side by side: the first axis is fixed, then the second, then the third.",
            grid.words[0],
            grid.axis_names[0],
            n / 2
        ),
        (_, None) => "The values.".to_owned(),
        (_, Some(_)) => "The values; gray where there are none.".to_owned(),
    };
    section.gallery(studio.draw(&[super::drawing::SignalPictures::new(subject).picture(
        subject.values,
        format!("{} of {}", subject.signal, subject.name),
        caption,
    )]));
    section
}
