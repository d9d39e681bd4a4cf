//! Shape section: the shape from two sides, and the signal on it.

use super::Subject;
use super::drawing::{FieldLook, PictureSpec, Scale, Studio};
use crate::page::{Block, Section};
use crate::table::grouped;
use adwave::shape::Shape;

pub(super) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> Section {
    let mut section = Section::new("shape", "The shape");
    if !studio.can_draw() {
        section.say(
            "A graph has no positions, so that it cannot be drawn. The report has charts and tables, with widths in hops.",
        );
        return section;
    }
    let what = match subject.shape {
        Shape::Cloud(_) | Shape::Graph(_) => "each point is a disc as wide as the distance to its neighbors",
        Shape::Mesh(_) => "the faces are lit from the upper left",
    };
    let plain = || {
        PictureSpec::plain(format!("{} from one side", subject.name), format!("Seen from one side: {what}."))
    };
    let drawn = if subject.is_geometry() {
        let back = PictureSpec::plain(
            format!("{} from the opposite side", subject.name),
            "The same from the opposite side.",
        );
        studio.draw_both(vec![plain()], vec![back])
    } else {
        let values = subject.scalar(subject.values);
        let look = || {
            let scale = Scale::from_percentiles(&values);
            FieldLook::new(values.clone(), subject.scalar_name(), scale)
        };
        let missing =
            if subject.decomposer.mask_flags().is_some() { "; gray where it has no value" } else { "" };
        let caption = format!("The signal {}{missing}.", subject.scalar_name());
        let front = PictureSpec::plain(format!("{} on {}", subject.signal, subject.name), caption);
        let back = PictureSpec::plain(
            format!("{} on the opposite side of {}", subject.signal, subject.name),
            "The signal on the opposite side.",
        );
        studio.draw_both(vec![plain(), front.field(look())], vec![back.field(look())])
    };
    section.gallery(drawn);
    if let Some(n_drawn) = studio.n_drawn() {
        section.say(format!(
            "The pictures show {} of the {} vertices, one for each cell of about a pixel. All numbers refer to the whole shape.",
            grouped(n_drawn),
            grouped(subject.shape.n_vertices())
        ));
    }
    section
}

impl Section {
    /// Adds pictures, or a note that explains why there are none.
    pub(crate) fn gallery(&mut self, drawn: Result<Vec<crate::page::Figure>, String>) {
        match drawn {
            Ok(figures) if figures.is_empty() => {}
            Ok(figures) => self.push(Block::Gallery(figures)),
            Err(why) => self.note(format!("No picture: {why}.")),
        }
    }
}
