//! Surface of cells.

use adwave::Progress;
use adwave::shape::Polygons;

use super::boundary::VolumeFaces;
use super::kinds::{Family, family};
use super::{CellKind, Cells};
use crate::ReadError;
use crate::progress::{all, at_row};

/// Surface elements of all cells.
#[derive(Default)]
pub(super) struct Surface {
    pub(super) faces: Polygons,
    /// Cell of each face.
    pub(super) sources: Sources,
    pub(super) edges: Vec<[u32; 2]>,
    /// Indices of the cells that are lines, and of those that are points.
    pub(super) line_cells: Vec<u32>,
    pub(super) vertex_cells: Vec<u32>,
    /// Number of volume cells.
    pub(super) n_volumes: usize,
    /// True if cells have points that may not be corners of the surface.
    pub(super) has_other_points: bool,
    /// Points that are cells of their own.
    pub(super) vertices: Vec<u32>,
}

/// Assignment of faces to cells.
pub(super) enum Sources {
    /// Face `f` belongs to cell `first + f`.
    From(usize),
    List(Vec<u32>),
}

impl Default for Sources {
    fn default() -> Self {
        Self::List(Vec::new())
    }
}

impl Surface {
    /// Extracts the surface of all blocks.
    pub(super) fn of(blocks: Vec<Cells>, progress: Progress<'_>) -> Result<Self, ReadError> {
        let mut surface = Self::default();
        let mut volumes = VolumeFaces::default();
        let n_blocks = blocks.iter().filter(|block| !block.is_empty()).count();
        let mut first = 0;
        for block in blocks {
            let n = block.len();
            if first + n > u32::MAX as usize {
                return Err(ReadError::Limit {
                    what: "cells",
                    found: (first + n) as u64,
                    limit: u32::MAX.into(),
                });
            }
            if n_blocks == 1 && is_polygons(&block, progress)? {
                if let Some(faces) = Polygons::from_parts(block.offsets, block.corners) {
                    return Ok(Self { faces, sources: Sources::From(first), ..surface });
                }
                return Err(ReadError::Whole(
                    "the offsets of cells must not decrease; save the file again".into(),
                ));
            }
            surface.add(&block, first, &mut volumes, progress)?;
            first += n;
        }
        if !volumes.is_empty() {
            let Sources::List(sources) = &mut surface.sources else { return Ok(surface) };
            let faces = &mut surface.faces;
            volumes.boundary(progress, |corners, cell| {
                faces.push(corners);
                sources.push(cell);
            })?;
        }
        Ok(surface)
    }

    fn push_face(&mut self, corners: &[u32], cell: u32) {
        self.faces.push(corners);
        if let Sources::List(sources) = &mut self.sources {
            sources.push(cell);
        }
    }

    fn push_path(&mut self, corners: &[u32], cell: u32) {
        self.edges.extend(corners.windows(2).map(|pair| [pair[0], pair[1]]));
        self.line_cells.push(cell);
    }

    fn push_vertices(&mut self, corners: &[u32], cell: u32) {
        self.vertices.extend_from_slice(corners);
        self.vertex_cells.push(cell);
    }

    fn push_strip(&mut self, corners: &[u32], cell: u32) {
        for (k, triple) in corners.windows(3).enumerate() {
            let [a, b, c] = [triple[0], triple[1], triple[2]];
            // Every second triangle of a strip has the opposite orientation.
            self.push_face(&if k % 2 == 0 { [a, b, c] } else { [b, a, c] }, cell);
        }
    }

    fn add(
        &mut self,
        block: &Cells,
        first: usize,
        volumes: &mut VolumeFaces,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        let n = block.len();
        for i in 0..n {
            at_row(progress, i as u64, n as u64)?;
            let (corners, cell) = (block.get(i), (first + i) as u32);
            match &block.kind {
                CellKind::Vertices => self.push_vertices(corners, cell),
                CellKind::Lines => self.push_path(corners, cell),
                CellKind::Polygons => self.push_face(corners, cell),
                CellKind::Strips => self.push_strip(corners, cell),
                CellKind::Each(types) => self.add_typed(block, i, types[i], cell, volumes)?,
            }
        }
        Ok(())
    }

    fn add_typed(
        &mut self,
        block: &Cells,
        i: usize,
        cell_type: u8,
        cell: u32,
        volumes: &mut VolumeFaces,
    ) -> Result<(), ReadError> {
        let corners = block.get(i);
        let Some(family) = family(cell_type) else {
            return Err(ReadError::Whole(format!(
                "cell {cell} has the type {cell_type}, which has no surface; export the surface instead"
            )));
        };
        let first = |n: usize| {
            corners.get(..n).ok_or_else(|| {
                let found = corners.len();
                ReadError::Whole(format!(
                    "cell {cell} of type {cell_type} needs {n} points, got {found}; save the file again"
                ))
            })
        };
        match family {
            Family::Empty => {}
            Family::Vertices => self.push_vertices(corners, cell),
            Family::Line => {
                self.push_path(first(2)?, cell);
                self.has_other_points |= corners.len() > 2;
            }
            Family::Path => self.push_path(corners, cell),
            Family::Strip => self.push_strip(corners, cell),
            Family::Polygon(n) => {
                self.push_face(first(n)?, cell);
                self.has_other_points |= corners.len() > n;
            }
            Family::AnyPolygon => self.push_face(corners, cell),
            Family::HalfPolygon => {
                self.push_face(first(corners.len() / 2)?, cell);
                self.has_other_points = true;
            }
            Family::Pixel => {
                let c = first(4)?;
                self.push_face(&[c[0], c[1], c[3], c[2]], cell);
            }
            Family::Volume(n, faces) => {
                let corners = first(n)?;
                for face in faces {
                    volumes.push(face.iter().map(|&k| corners[usize::from(k)]), cell);
                }
                self.n_volumes += 1;
            }
            Family::Polyhedron => {
                let faces = block.polyhedra.as_ref().and_then(|polyhedra| {
                    let start = if i == 0 { 0 } else { *polyhedra.ends.get(i - 1)? };
                    Some((start as usize..*polyhedra.ends.get(i)? as usize, &polyhedra.faces))
                });
                let Some((range, faces)) = faces else {
                    let message = format!("the polyhedron {cell} has no faces; save the file again");
                    return Err(ReadError::Whole(message));
                };
                for f in range {
                    volumes.push(faces.get(f).iter().copied(), cell);
                }
                self.n_volumes += 1;
            }
        }
        self.has_other_points |= self.n_volumes > 0;
        Ok(())
    }
}

/// True if all cells are polygons whose points are their corners.
fn is_polygons(block: &Cells, progress: Progress<'_>) -> Result<bool, ReadError> {
    Ok(match &block.kind {
        CellKind::Polygons => true,
        CellKind::Each(types) => all(types.len(), progress, |i| {
            let n = block.offsets[i + 1] - block.offsets[i];
            matches!((types[i], n), (5, 3) | (7, _) | (9, 4))
        })?,
        _ => false,
    })
}
