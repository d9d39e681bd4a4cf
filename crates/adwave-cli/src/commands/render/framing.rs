//! What of a shape fills its picture: the arguments, and the shape that they are about.

use crate::error::CliError;
use crate::shape_input::Input;
use adwave_render::Framing;
use clap::Args;
use std::str::FromStr;

/// How many times as large a place is shown where nothing is said.
const CLOSE_UP: f64 = 4.0;

/// Which part of the shape is seen.
#[derive(Debug, Args)]
pub(crate) struct FramingArgs {
    /// How many times as large as the whole shape would fit [default: 1, with --focus 4]
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, help_heading = "Picture")]
    pub(crate) zoom: Option<f64>,
    /// The place in the middle of the picture: X,Y,Z in model units, or vertex=N (of the first shape)
    #[arg(long, value_name = "PLACE", allow_hyphen_values = true, help_heading = "Picture")]
    pub(crate) focus: Option<FocusArg>,
}

/// A place of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FocusArg {
    Point([f64; 3]),
    Vertex(usize),
}

impl FromStr for FocusArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "it is X,Y,Z in model units, or vertex=N with vertices counted from 0".to_owned();
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
    /// What can be known before a shape is read: everything but where a vertex is.
    pub(crate) fn without_vertex(&self) -> Framing {
        let zoom = self.zoom.unwrap_or(if self.focus.is_some() { CLOSE_UP } else { 1.0 });
        let focus = match self.focus {
            Some(FocusArg::Point(point)) => Some(point),
            _ => None,
        };
        Framing { zoom, focus }
    }

    /// The same with the vertex of this shape.
    pub(crate) fn of(&self, input: &Input) -> Result<Framing, CliError> {
        let framing = self.without_vertex();
        let Some(FocusArg::Vertex(vertex)) = self.focus else { return Ok(framing) };
        let points = input.shape.points().unwrap_or_default();
        let point = points.get(vertex).ok_or_else(|| {
            CliError::Input(format!(
                "--focus vertex={vertex}: {} has {} vertices, counted from 0",
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
