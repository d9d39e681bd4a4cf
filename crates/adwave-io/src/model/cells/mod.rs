//! Cells of unstructured grids with VTK's numbering and types, and their surface.
//!
//! Surfaces and lines are kept as they are. Volumes are replaced by their boundary: the faces that belong to a single
//! cell. Cells of higher order are reduced to their corners, so that the points between corners are not vertices of
//! the surface.

mod boundary;
#[cfg(feature = "vtk")]
mod dataset;
#[cfg(feature = "vtk")]
mod grid;
#[cfg(feature = "vtk")]
mod image;
#[cfg(feature = "vtk")]
mod kinds;
#[cfg(feature = "vtk")]
mod surface;

pub(crate) use boundary::VolumeFaces;
#[cfg(feature = "vtk")]
pub(crate) use dataset::Dataset;
#[cfg(feature = "vtk")]
pub(crate) use grid::{Grid, GridPoints, Lattice};
#[cfg(feature = "vtk")]
pub(crate) use image::{GridArrays, ImageFrame, frame_of, hidden_places};

use adwave::shape::Polygons;

/// Kind of the cells in a block.
#[derive(Clone, Debug)]
pub(crate) enum CellKind {
    Vertices,
    /// Paths over their corners.
    Lines,
    Polygons,
    /// Triangle strips.
    Strips,
    /// Individual types in VTK's numbering.
    Each(Vec<u8>),
}

/// Cells one after the other, with corners numbered by the points of the whole file.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    pub(crate) kind: CellKind,
    /// Start of each cell among the corners, followed by the end of the last; ascending from 0.
    pub(crate) offsets: Vec<u32>,
    pub(crate) corners: Vec<u32>,
    /// Faces of the cells that are polyhedra.
    pub(crate) polyhedra: Option<Polyhedra>,
}

/// Faces of the polyhedra in a block.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polyhedra {
    /// End of each cell's faces.
    pub(crate) ends: Vec<u32>,
    pub(crate) faces: Polygons,
}

impl Cells {
    pub(crate) fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Renumbers the points from `first` on.
    pub(crate) fn renumber(&mut self, first: u32) {
        for corner in &mut self.corners {
            *corner += first;
        }
        if let Some(polyhedra) = &mut self.polyhedra {
            let (offsets, mut corners) = std::mem::take(&mut polyhedra.faces).into_parts();
            for corner in &mut corners {
                *corner += first;
            }
            polyhedra.faces = Polygons::from_parts(offsets, corners).unwrap_or_default();
        }
    }

    /// Corners of cell `i`.
    pub(crate) fn get(&self, i: usize) -> &[u32] {
        &self.corners[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }
}
