//! The part of a shape that fills its picture.

use crate::args::number;
use crate::error::CliError;
use crate::resolve::shape::{Input, vertex_in_row};
use adwave_render::{Frame, Framing};
use clap::Args;
use std::str::FromStr;

/// Zoom factor on a focus if none is given.
const CLOSE_UP: f64 = 4.0;

/// The part of the shape that is seen.
#[derive(Debug, Args)]
pub(crate) struct FramingArgs {
    /// Magnification, relative to the view that fits the whole shape [default: 1, with --focus 4]
    #[arg(long, value_name = "FACTOR", value_parser = number, allow_negative_numbers = true, help_heading = "Picture")]
    pub(crate) zoom: Option<f64>,
    /// Vertices that are shown: main, without the few that are far from all others, or all
    #[arg(long, value_name = "WHICH", default_value = "main", help_heading = "Picture")]
    pub(crate) frame: Frame,
    /// Point in the middle of the picture: X,Y,Z in model units, or vertex=N of the first shape
    #[arg(long, value_name = "PLACE", allow_hyphen_values = true, help_heading = "Picture")]
    pub(crate) focus: Option<FocusArg>,
}

/// A point of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FocusArg {
    Point([f64; 3]),
    Vertex(usize),
}

impl FromStr for FocusArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "must be X,Y,Z in model units, or vertex=N with vertices counted from 0".to_owned();
        if let Some(vertex) = text.trim().strip_prefix("vertex=") {
            return vertex.trim().parse().map(Self::Vertex).map_err(|_| wrong());
        }
        let numbers: Vec<f64> = text.split(',').map_while(|part| part.trim().parse().ok()).collect();
        match <[f64; 3]>::try_from(numbers) {
            Ok(point) if text.split(',').count() == 3 && point.iter().all(|c| c.is_finite()) => {
                Ok(Self::Point(point))
            }
            _ => Err(wrong()),
        }
    }
}

impl FramingArgs {
    /// The framing as far as it is known before a shape is read: without the position of a vertex.
    pub(crate) fn without_vertex(&self) -> Framing {
        let zoom = self.zoom.unwrap_or(if self.focus.is_some() { CLOSE_UP } else { 1.0 });
        let focus = match self.focus {
            Some(FocusArg::Point(point)) => Some(point),
            _ => None,
        };
        Framing { zoom, focus }
    }

    /// The framing for a shape, whose vertex may be the focus.
    pub(crate) fn resolve_for_shape(&self, input: &Input) -> Result<Framing, CliError> {
        let framing = self.without_vertex();
        let Some(FocusArg::Vertex(vertex)) = self.focus else { return Ok(framing) };
        let points = input.shape.points().unwrap_or_default();
        let point = points.get(vertex_in_row(input, vertex)?).ok_or_else(|| {
            CliError::Input(format!(
                "--focus vertex={vertex} must be below the number of vertices, but {} has {}",
                input.name,
                points.len()
            ))
        })?;
        Ok(Framing { focus: Some(*point), ..framing })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_three_finite_numbers_or_a_vertex() {
        assert_eq!("1,-2.5, 3e2".parse(), Ok(FocusArg::Point([1.0, -2.5, 300.0])));
        assert_eq!("vertex=12".parse(), Ok(FocusArg::Vertex(12)));
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,inf", "nan,0,0", "vertex=-1", "vertex=", "12"] {
            assert!(bad.parse::<FocusArg>().unwrap_err().contains("vertex=N"), "{bad}");
        }
    }
}
