//! The axis that points up in pictures, and the reason for it.

use super::shape::Input;
use adwave_io::Format;
use adwave_render::{Up, UpReason};
use serde_json::{Value, json};

/// An axis and the reason for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UpAxis {
    pub(crate) up: Up,
    reason: UpReason,
    format: Option<Format>,
}

impl UpAxis {
    /// The axis asked for; else that of the file's format; else a guess from the shape.
    pub(crate) fn choose(asked: Option<Up>, input: &Input) -> Self {
        let format = input.file.format();
        let (up, reason) = Up::choose(asked, format.and_then(Format::up_axis), &input.shape);
        Self { up, reason, format }
    }

    /// A line for people; empty if the axis was asked for.
    pub(crate) fn line(self) -> String {
        match self.explain() {
            Some(reason) => format!("up: {}, {reason}; --up x, y or z sets it\n", self.up.name()),
            None => String::new(),
        }
    }

    /// The axis, and the reason for it unless it was asked for.
    pub(crate) fn to_json(self) -> Value {
        json!({"axis": self.up.name(), "guessed": self.explain()})
    }

    fn explain(self) -> Option<&'static str> {
        match (self.reason, self.format) {
            (UpReason::Asked, _) => None,
            (UpReason::Format, Some(Format::GIFTI)) => Some("guessed from the GIFTI"),
            (UpReason::Format, Some(Format::FREESURFER)) => Some("guessed from the FreeSurfer surface"),
            (UpReason::Format, Some(Format::FITS | Format::NETCDF)) => Some("guessed from the map"),
            (UpReason::Format, _) => Some("guessed from the LAS file"),
            (UpReason::Land, _) => Some("guessed from a shape as low and open as land"),
            (UpReason::Common, _) => Some("as most models have it"),
        }
    }
}
