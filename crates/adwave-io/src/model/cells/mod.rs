//! Cells of grids, numbered and typed as VTK has them, and the surface that they make.
//!
//! Surfaces and lines are taken as they stand. Of volumes the boundary is taken: the faces that belong to one cell alone.
//! Cells of higher order count by their corners, so that points between these are no vertices of the surface.

mod boundary;
#[cfg(feature = "vtk")]
mod dataset;
#[cfg(feature = "vtk")]
mod grid;
#[cfg(feature = "vtk")]
mod kinds;
#[cfg(feature = "vtk")]
mod surface;

pub(crate) use boundary::VolumeFaces;
#[cfg(feature = "vtk")]
pub(crate) use dataset::Dataset;
#[cfg(feature = "vtk")]
pub(crate) use grid::{Grid, GridPoints, Lattice};

use adwave::shape::Polygons;

/// What the cells of a block are.
#[derive(Clone, Debug)]
pub(crate) enum CellKind {
    Vertices,
    /// Each a path over its corners.
    Lines,
    Polygons,
    /// Strips of triangles.
    Strips,
    /// Each of its own type, as VTK numbers them.
    Each(Vec<u8>),
}

/// Cells one after the other, their corners numbered by the points of the whole file.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    pub(crate) kind: CellKind,
    /// Where each begins among the corners, and at last where the last ends; they grow from 0.
    pub(crate) offsets: Vec<u32>,
    pub(crate) corners: Vec<u32>,
    /// The faces of cells that are polyhedra.
    pub(crate) polyhedra: Option<Polyhedra>,
}

/// Faces of the cells of a block that are polyhedra.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polyhedra {
    /// Where the faces of each cell end.
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

    /// Counts the points from `first` on.
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

    /// The corners of cell `i`.
    pub(crate) fn get(&self, i: usize) -> &[u32] {
        &self.corners[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }
}
