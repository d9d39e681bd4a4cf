//! The shape itself, from two sides; and the signal on it.

use super::Subject;
use super::drawing::{FieldLook, Frame, Scale, Studio};
use crate::page::{Block, Section};
use crate::table::grouped;
use adwave::shape::Shape;

pub(super) fn section(subject: &Subject<'_>, studio: &mut Studio<'_>) -> Section {
    let mut section = Section::new("shape", "The shape");
    if !studio.can_draw() {
        section.say(
            "A graph has no positions: there is nothing to draw. What follows are charts and tables, and widths are in hops.",
        );
        return section;
    }
    let what = match subject.shape {
        Shape::Cloud(_) => "each point a disc as wide as its distance to its neighbors",
        _ => "its faces, lit from the upper left",
    };
    let plain =
        || Frame::plain(format!("{} from one side", subject.name), format!("Seen from one side: {what}."));
    let drawn = if subject.is_geometry() {
        let behind = Frame::plain(
            format!("{} from the opposite side", subject.name),
            "The same from the opposite side.",
        );
        studio.draw_both(vec![plain()], vec![behind])
    } else {
        let values = subject.scalar(subject.values);
        let look = || {
            let scale = Scale::of(&values);
            FieldLook::new(values.clone(), subject.scalar_name(), scale)
        };
        let missing =
            if subject.decomposer.mask_flags().is_some() { "; gray where it has no value" } else { "" };
        let caption = format!("The signal {}{missing}.", subject.scalar_name());
        let front = Frame::plain(format!("{} on {}", subject.signal, subject.name), caption);
        let behind = Frame::plain(
            format!("{} on the opposite side of {}", subject.signal, subject.name),
            "The signal on the opposite side.",
        );
        studio.draw_both(vec![plain(), front.field(look())], vec![behind.field(look())])
    };
    section.gallery(drawn);
    if let Some(n_drawn) = studio.n_drawn() {
        section.say(format!(
            "For pictures, {} of the {} vertices are drawn, one for each cell of about a pixel. All numbers are those of \
             the whole shape.",
            grouped(n_drawn),
            grouped(subject.shape.n_vertices())
        ));
    }
    section
}

impl Section {
    /// Adds pictures, or why there are none.
    pub(crate) fn gallery(&mut self, drawn: Result<Vec<crate::page::Figure>, String>) {
        match drawn {
            Ok(figures) if figures.is_empty() => {}
            Ok(figures) => self.push(Block::Gallery(figures)),
            Err(why) => self.note(format!("No picture: {why}.")),
        }
    }
}
