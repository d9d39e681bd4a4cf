//! Sheets of several charts.

use super::canvas::{self, Area, Drawable};
use super::{Chart, PlotError};
use crate::picture::Picture;
use plotters::prelude::{DrawingBackend, WHITE};

/// Charts of equal size in rows of `columns`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// Charts, row by row.
    pub charts: Vec<Chart>,
    /// Number of charts per row; 0 counts as 1.
    pub columns: usize,
}

impl Sheet {
    /// Draws the sheet as SVG.
    ///
    /// # Errors
    ///
    /// No charts, a size out of range, and the errors of [`Chart::svg`].
    pub fn svg(&self, width: u32, height: u32) -> Result<String, PlotError> {
        canvas::svg(self, width, height)
    }

    /// Draws the sheet in pixels.
    ///
    /// # Errors
    ///
    /// The errors of [`Sheet::svg`].
    pub fn picture(&self, width: u32, height: u32) -> Result<Picture, PlotError> {
        canvas::picture(self, width, height)
    }
}

impl Drawable for Sheet {
    fn check(&self) -> Result<(), PlotError> {
        if self.charts.is_empty() {
            return Err(PlotError::Empty { title: "sheet".to_owned() });
        }
        self.charts.iter().try_for_each(Drawable::check)
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Result<(), PlotError> {
        area.fill(&WHITE).map_err(|e| PlotError::drawing(&e))?;
        let columns = self.columns.clamp(1, self.charts.len());
        let parts = area.split_evenly((self.charts.len().div_ceil(columns), columns));
        let (width, height) = parts[0].dim_in_pixel();
        if width < super::MIN_SIDE || height < super::MIN_SIDE {
            return Err(PlotError::Size { width, height });
        }
        self.charts.iter().zip(&parts).try_for_each(|(chart, part)| chart.draw(part))
    }
}
