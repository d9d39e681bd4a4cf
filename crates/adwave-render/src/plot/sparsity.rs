//! Sparsity pattern of a matrix.

use super::PlotError;
use super::canvas::{self, Area, Drawable};
use crate::picture::Picture;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Dark square for each entry of a matrix, with row 0 at the top, and the matrix size and the number of entries below.
///
/// A matrix with more rows or columns than pixels is drawn in cells of several entries; the darkness of a cell is the
/// filled fraction, with a minimum that keeps single entries visible.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparsityPattern {
    /// Title above the pattern.
    pub title: String,
    /// Number of rows of the matrix.
    pub n_rows: usize,
    /// Number of columns of the matrix.
    pub n_columns: usize,
    /// Row and column of each entry, from 0.
    pub entries: Vec<[u32; 2]>,
}

/// Color of a fully filled cell.
const DARK: RGBColor = RGBColor(0, 80, 140);
const GROUND: RGBColor = RGBColor(244, 244, 244);
/// Smallest darkness of a cell with an entry.
const LEAST: f64 = 0.35;

impl SparsityPattern {
    /// Draws the pattern as SVG.
    ///
    /// # Errors
    ///
    /// No rows, columns or entries, an entry outside the matrix, or a size out of range.
    pub fn svg(&self, width: u32, height: u32) -> Result<String, PlotError> {
        canvas::svg(self, width, height)
    }

    /// Draws the pattern in pixels.
    ///
    /// # Errors
    ///
    /// The errors of [`SparsityPattern::svg`].
    pub fn picture(&self, width: u32, height: u32) -> Result<Picture, PlotError> {
        canvas::picture(self, width, height)
    }

    /// Number of entries in each of `rows` × `columns` cells, row by row.
    fn cells(&self, rows: usize, columns: usize) -> Vec<u32> {
        let mut counts = vec![0_u32; rows * columns];
        for &[row, column] in &self.entries {
            let at = |k: u32, cells: usize, of: usize| (k as usize * cells / of).min(cells - 1);
            counts[at(row, rows, self.n_rows) * columns + at(column, columns, self.n_columns)] += 1;
        }
        counts
    }
}

impl Drawable for SparsityPattern {
    fn check(&self) -> Result<(), PlotError> {
        if self.n_rows == 0 || self.n_columns == 0 || self.entries.is_empty() {
            return Err(PlotError::Empty { title: self.title.clone() });
        }
        let outside = |e: &&[u32; 2]| e[0] as usize >= self.n_rows || e[1] as usize >= self.n_columns;
        match self.entries.iter().find(outside) {
            Some(&[row, column]) => {
                let (title, n_rows, n_columns) = (self.title.clone(), self.n_rows, self.n_columns);
                Err(PlotError::BadEntry { title, row, column, n_rows, n_columns })
            }
            None => Ok(()),
        }
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Result<(), PlotError> {
        let failed = |e: &dyn std::fmt::Display| PlotError::drawing(e);
        area.fill(&WHITE).map_err(|e| failed(&e))?;
        let (width, height) = area.dim_in_pixel();
        let size = canvas::letters(area) as i32;
        let margin = 2 * size;
        let room = [width as i32 - 2 * size, height as i32 - 2 * margin].map(|r| f64::from(r.max(1)));
        // Square cells of whole pixels if they fit, so that all cells look alike.
        let fit = (room[0] / self.n_columns as f64).min(room[1] / self.n_rows as f64);
        let side = if fit >= 1.0 { fit.floor() } else { fit };
        let extent = |n: usize| ((n as f64 * side).round() as usize).max(1);
        let (wide, tall) = (extent(self.n_columns), extent(self.n_rows));
        let (columns, rows) = (self.n_columns.min(wide), self.n_rows.min(tall));
        let (left, top) = ((width as i32 - wide as i32) / 2, margin);
        let corner = |column: usize, row: usize| {
            (left + (column * wide / columns) as i32, top + (row * tall / rows) as i32)
        };
        let block = |from: (i32, i32), to: (i32, i32), color: RGBColor| {
            area.draw(&Rectangle::new([from, to], color.filled())).map_err(|e| failed(&e))
        };
        block(corner(0, 0), corner(columns, rows), GROUND)?;
        let whole = (self.n_rows as f64 / rows as f64) * (self.n_columns as f64 / columns as f64);
        let shade = |count: u32| {
            let part = (f64::from(count) / whole).min(1.0);
            let dark = LEAST + (1.0 - LEAST) * part;
            let mix = |g: u8, d: u8| (f64::from(g) + dark * (f64::from(d) - f64::from(g))).round() as u8;
            RGBColor(mix(GROUND.0, DARK.0), mix(GROUND.1, DARK.1), mix(GROUND.2, DARK.2))
        };
        let counts = self.cells(rows, columns);
        for row in 0..rows {
            let cells = &counts[row * columns..(row + 1) * columns];
            let mut from = 0;
            // A run of equal cells in a row is drawn as one rectangle, which keeps an SVG file small.
            for run in cells.chunk_by(|a, b| a == b) {
                let to = from + run.len();
                if run[0] > 0 {
                    block(corner(from, row), corner(to, row + 1), shade(run[0]))?;
                }
                from = to;
            }
        }
        let style = |size: i32| {
            ("sans-serif", size, &INK).into_text_style(area).pos(Pos::new(HPos::Center, VPos::Center))
        };
        let middle = width as i32 / 2;
        area.draw_text(&self.title, &style(size + 3), (middle, size)).map_err(|e| failed(&e))?;
        let part = 100.0 * self.entries.len() as f64 / (self.n_rows as f64 * self.n_columns as f64);
        let text =
            format!("{} × {}, {} entries ({part:.1} %)", self.n_rows, self.n_columns, self.entries.len());
        area.draw_text(&text, &style(size), (middle, top + tall as i32 + size)).map_err(|e| failed(&e))
    }
}

const INK: RGBColor = RGBColor(48, 48, 48);
