//! Several charts on one sheet.

use super::canvas::{self, Area, Drawn};
use super::{Chart, PlotError};
use crate::picture::Picture;
use plotters::prelude::{DrawingBackend, WHITE};

/// Charts in rows of `columns`, all of one size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// Row by row.
    pub charts: Vec<Chart>,
    /// Charts side by side; 0 counts as 1.
    pub columns: usize,
}

impl Sheet {
    /// The sheet as the text of an SVG file.
    ///
    /// # Errors
    ///
    /// No charts, a size that is none, and as [`Chart::svg`].
    pub fn svg(&self, width: u32, height: u32) -> Result<String, PlotError> {
        canvas::svg(self, width, height)
    }

    /// The sheet in pixels.
    ///
    /// # Errors
    ///
    /// As [`Sheet::svg`].
    pub fn picture(&self, width: u32, height: u32) -> Result<Picture, PlotError> {
        canvas::picture(self, width, height)
    }
}

impl Drawn for Sheet {
    fn check(&self) -> Result<(), PlotError> {
        if self.charts.is_empty() {
            return Err(PlotError::Empty { title: "sheet".to_owned() });
        }
        self.charts.iter().try_for_each(Drawn::check)
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
