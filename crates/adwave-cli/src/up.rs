//! Which axis of a shape points up in its pictures, and how that is known.

use crate::shape_input::Input;
use adwave::Progress;
use adwave::shape::{PreparedGeometry, Shape, WeldMode, health, one_ring};
use adwave_io::Format;
use adwave_render::Up;
use serde_json::{Value, json};

/// An axis and why it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Upward {
    pub(crate) up: Up,
    why: Why,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Why {
    Asked,
    /// Scans from the air have their heights in z.
    Las,
    /// In the spaces of GIFTI z is toward the top of the head.
    Gifti,
    /// So it is in FreeSurfer's.
    FreeSurfer,
    /// Low and open, as scans of land are.
    Land,
    /// As most models have it.
    Usual,
}

impl Upward {
    /// The axis asked for; else z for LAS, LAZ, GIFTI, FreeSurfer and what looks like land, else y.
    pub(crate) fn of(asked: Option<Up>, input: &Input) -> Self {
        if let Some(up) = asked {
            return Self { up, why: Why::Asked };
        }
        match input.file.format() {
            Some(Format::LAS | Format::LAZ | Format::EPT) => return Self { up: Up::Z, why: Why::Las },
            Some(Format::GIFTI) => return Self { up: Up::Z, why: Why::Gifti },
            Some(Format::FREESURFER) => return Self { up: Up::Z, why: Why::FreeSurfer },
            _ => {}
        }
        let up = Up::guess(input.shape.points().unwrap_or_default(), || is_open(&input.shape));
        Self { up, why: if up == Up::Z { Why::Land } else { Why::Usual } }
    }

    /// A line for people; none where the axis was asked for.
    pub(crate) fn line(self) -> String {
        match self.why() {
            Some(why) => format!("up {}, {why}; --up x, y or z sets it\n", self.up.name()),
            None => String::new(),
        }
    }

    /// The same for machines: the axis, and why it was taken where it was not asked for.
    pub(crate) fn json(self) -> Value {
        json!({"axis": self.up.name(), "guessed": self.why()})
    }

    fn why(self) -> Option<&'static str> {
        match self.why {
            Why::Asked => None,
            Why::Las => Some("guessed from the LAS file"),
            Why::Gifti => Some("guessed from the GIFTI"),
            Why::FreeSurfer => Some("guessed from the FreeSurfer surface"),
            Why::Land => Some("guessed from a shape as low and open as land"),
            Why::Usual => Some("as most models have it"),
        }
    }
}

/// Whether it is a cloud or has a border.
fn is_open(shape: &Shape) -> bool {
    if !matches!(shape, Shape::Mesh(_)) {
        return true;
    }
    let Ok(geometry) = PreparedGeometry::new(shape, WeldMode::EqualPositions, Progress::none()) else {
        return false;
    };
    let ring = one_ring(geometry.n_vertices(), geometry.triangles());
    health(&geometry, &ring, Progress::none()).is_ok_and(|health| !health.is_closed())
}
