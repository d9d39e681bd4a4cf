//! Conversion of structured grids to shapes: a flat grid becomes its quadrilaterals, a grid of volumes its boundary,
//! a single row a path. This matches what viewers draw; all points as a cloud would form a solid block. Grids with a
//! spacing along each axis stay grids: see [`super::image`].

use adwave::Progress;
use adwave::shape::Polygons;

use super::image::ImageFrame;
use crate::model::numbers::collect_rows;
use crate::progress::{collect, report_row};
use crate::{CoordinatePrecision, Edges, Field, Format, ReadError, ReadLimits, ShapeFile};

/// Largest number of vertices of a grid for which a file stores only the size.
const MOST_WITHOUT_VALUES: usize = 1 << 18;

/// Numbers of points along the axes, the first axis running fastest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lattice {
    dims: [usize; 3],
}

impl Lattice {
    /// Creates a lattice; `None` if an axis has no points. Fails if the points cannot be counted.
    pub(crate) fn new(dims: [u64; 3]) -> Result<Option<Self>, ReadError> {
        let n = dims.iter().try_fold(1_u64, |n, &d| n.checked_mul(d)).unwrap_or(u64::MAX);
        if n > u64::from(u32::MAX) {
            return Err(ReadError::Limit { what: "points of the grid", found: n, limit: u32::MAX.into() });
        }
        Ok((n > 0).then_some(Self { dims: dims.map(|d| d as usize) }))
    }

    pub(crate) fn n_points(self) -> usize {
        self.dims.iter().product()
    }

    pub(crate) fn n_cells(self) -> usize {
        self.cells().iter().product()
    }

    /// Number of points along each axis.
    pub(crate) fn dims(self) -> [usize; 3] {
        self.dims
    }

    /// Checks the size of a grid for which a file stores only the size.
    pub(crate) fn check_without_values(self) -> Result<(), ReadError> {
        let n = if self.axes().len() == 3 { self.n_outer() } else { self.n_points() };
        if n <= MOST_WITHOUT_VALUES {
            return Ok(());
        }
        Err(ReadError::Whole(format!(
            "a grid without values may have at most {MOST_WITHOUT_VALUES} points, got {n}"
        )))
    }

    /// Number of cells along each axis; 1 along an axis with one point.
    pub(crate) fn cells(self) -> [usize; 3] {
        self.dims.map(|d| (d - 1).max(1))
    }

    pub(crate) fn point(self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.dims[1] + j) * self.dims[0] + i
    }

    pub(crate) fn cell(self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.cells();
        (k * ny + j) * nx + i
    }

    /// Lattice coordinates of the point with this index.
    fn position(self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.dims;
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    /// Axes with more than one point.
    fn axes(self) -> Vec<usize> {
        (0..3).filter(|&a| self.dims[a] > 1).collect()
    }

    /// Number of boundary points of a layer that is neither the first nor the last.
    fn ring(self) -> usize {
        let [nx, ny, _] = self.dims;
        nx * ny - (nx - 2) * (ny - 2)
    }

    /// Number of boundary points if all axes have several points.
    fn n_outer(self) -> usize {
        let [nx, ny, nz] = self.dims;
        2 * nx * ny + (nz - 2) * self.ring()
    }

    /// Index of a point among the boundary points.
    fn outer(self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, nz] = self.dims;
        if k == 0 {
            return j * nx + i;
        }
        let layer = nx * ny + (k - 1) * self.ring();
        if k == nz - 1 {
            return layer + j * nx + i;
        }
        layer
            + if j == 0 {
                i
            } else if j == ny - 1 {
                nx + 2 * (ny - 2) + i
            } else {
                nx + 2 * (j - 1) + usize::from(i > 0)
            }
    }

    /// Indices of the boundary points, ascending.
    fn outer_points(self) -> Vec<u32> {
        let [nx, ny, nz] = self.dims;
        let mut points = Vec::with_capacity(self.n_outer());
        for k in 0..nz {
            for j in 0..ny {
                let step = if k == 0 || k == nz - 1 || j == 0 || j == ny - 1 { 1 } else { nx - 1 };
                points.extend((0..nx).step_by(step).map(|i| self.point([i, j, k]) as u32));
            }
        }
        points
    }
}

/// Positions of the points of a grid.
#[derive(Clone, Debug)]
pub(crate) enum GridPoints {
    /// An origin and a step along each axis.
    Image(ImageFrame),
    /// One coordinate for each lattice position along each axis.
    Axes([Vec<f64>; 3]),
    /// Explicit positions in the rows of the file.
    Listed(Vec<[f64; 3]>),
}

/// Structured grid with its values.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) lattice: Lattice,
    pub(crate) points: GridPoints,
    pub(crate) precision: CoordinatePrecision,
    pub(crate) point_fields: Vec<Field>,
    pub(crate) cell_fields: Vec<Field>,
    /// Field rows of the lattice's points and cells, if they are not in order.
    pub(crate) point_rows: Option<Vec<u32>>,
    pub(crate) cell_rows: Option<Vec<u32>>,
    pub(crate) extras: Vec<String>,
}

pub(super) fn row(rows: Option<&Vec<u32>>, index: usize) -> usize {
    rows.map_or(index, |rows| rows[index] as usize)
}

impl Grid {
    fn point(&self, index: usize) -> [f64; 3] {
        match &self.points {
            GridPoints::Image(frame) => frame.position(self.lattice.position(index)),
            GridPoints::Axes(axes) => {
                let position = self.lattice.position(index);
                std::array::from_fn(|a| axes[a][position[a]])
            }
            GridPoints::Listed(points) => points[row(self.point_rows.as_ref(), index)],
        }
    }

    /// Converts the grid to a shape.
    pub(crate) fn into_shape(
        mut self,
        format: Format,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<ShapeFile, ReadError> {
        let (lattice, axes) = (self.lattice, self.lattice.axes());
        let n = if axes.len() == 3 { lattice.n_outer() } else { lattice.n_points() };
        limits.check_points(n as u64)?;
        let is_listed = matches!(self.points, GridPoints::Listed(_));
        if self.point_fields.is_empty() && self.cell_fields.is_empty() && !is_listed {
            lattice.check_without_values()?;
        }
        let kept = (axes.len() == 3).then(|| lattice.outer_points());
        let index = |i: usize| kept.as_ref().map_or(i, |kept| kept[i] as usize);
        let mut shape = ShapeFile::from_cloud(collect(n, progress, |i| self.point(index(i)))?);
        for field in &self.point_fields {
            let rows = self.point_rows.as_ref();
            shape.vertex_fields.push(collect_rows(field, n, progress, &|i| row(rows, index(i)))?);
        }
        let mut quads = Quads { lattice, corners: Vec::new(), cells: Vec::new(), is_outer: kept.is_some() };
        match axes[..] {
            [] => {}
            [_] => {
                shape.edges = Edges { pairs: (1..n as u32).map(|v| [v - 1, v]).collect(), ..Edges::default() }
            }
            [a, b] => quads.add(if (a, b) == (0, 2) { 1 } else { 3 - a - b }, 0, true, progress)?,
            _ => {
                for axis in [2, 1, 0] {
                    quads.add(axis, 0, false, progress)?;
                    quads.add(axis, lattice.dims[axis] - 1, true, progress)?;
                }
                if volume(&shape.points, &quads.corners) < 0.0 {
                    for quad in &mut quads.corners {
                        quad.reverse();
                    }
                }
                let n_inside = lattice.n_points() - n;
                self.extras.push(format!("{} volumes (their boundary is read)", lattice.n_cells()));
                if n_inside > 0 {
                    self.extras.push(format!("{n_inside} points inside volumes"));
                }
            }
        }
        let n_faces = quads.cells.len();
        for field in self.cell_fields {
            if n_faces == 0 {
                self.extras.push(format!("values of cells in `{}`", field.name));
                continue;
            }
            let rows = self.cell_rows.as_ref();
            let cells = &quads.cells;
            shape
                .face_fields
                .push(collect_rows(&field, n_faces, progress, &|f| row(rows, cells[f] as usize))?);
        }
        let offsets = collect(n_faces + 1, progress, |f| 4 * f as u32)?;
        let faces = Polygons::from_parts(offsets, quads.corners.into_flattened());
        shape.faces = faces.unwrap_or_default().into();
        shape.format = Some(format);
        shape.precision = self.precision;
        shape.extras = self.extras;
        Ok(shape)
    }
}

/// Six times the volume enclosed by a surface.
fn volume(points: &[[f64; 3]], quads: &[[u32; 4]]) -> f64 {
    let Some(base) = points.first() else { return 0.0 };
    let at = |v: u32| -> [f64; 3] { std::array::from_fn(|c| points[v as usize][c] - base[c]) };
    let triple = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let of_quad = |&[a, b, c, d]: &[u32; 4]| triple([a, b, c].map(at)) + triple([a, c, d].map(at));
    quads.iter().map(of_quad).sum()
}

/// Quadrilaterals of a lattice.
struct Quads {
    lattice: Lattice,
    corners: Vec<[u32; 4]>,
    /// Cell of each quadrilateral.
    cells: Vec<u32>,
    /// True if corners are numbered among the boundary points.
    is_outer: bool,
}

impl Quads {
    /// Adds the quadrilaterals at one lattice position along an axis, facing along it or against it.
    fn add(
        &mut self,
        axis: usize,
        place: usize,
        is_along: bool,
        progress: Progress<'_>,
    ) -> Result<(), ReadError> {
        let (lattice, is_outer) = (self.lattice, self.is_outer);
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let number = |p: usize, q: usize| {
            let mut position = [0; 3];
            (position[axis], position[b], position[c]) = (place, p, q);
            (if is_outer { lattice.outer(position) } else { lattice.point(position) }) as u32
        };
        let layer = place.min(lattice.cells()[axis] - 1);
        for q in 0..lattice.dims[c] - 1 {
            report_row(progress, q as u64, lattice.dims[c] as u64)?;
            for p in 0..lattice.dims[b] - 1 {
                let mut quad = [number(p, q), number(p + 1, q), number(p + 1, q + 1), number(p, q + 1)];
                if !is_along {
                    quad.reverse();
                }
                let mut cell = [0; 3];
                (cell[axis], cell[b], cell[c]) = (layer, p, q);
                self.corners.push(quad);
                self.cells.push(lattice.cell(cell) as u32);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FieldValues;

    fn grid(dims: [u64; 3]) -> ShapeFile {
        let lattice = Lattice::new(dims).unwrap().unwrap();
        let (n, n_cells) = (lattice.n_points(), lattice.n_cells());
        let whole = |n: usize| FieldValues::U32((0..n as u32).collect());
        let grid = Grid {
            lattice,
            points: GridPoints::Axes([0, 1, 2].map(|a| (0..dims[a]).map(|i| i as f64).collect())),
            precision: CoordinatePrecision::F64,
            point_fields: vec![Field::new("p", 1, whole(n))],
            cell_fields: vec![Field::new("c", 1, whole(n_cells))],
            point_rows: None,
            cell_rows: None,
            extras: Vec::new(),
        };
        grid.into_shape(Format::VTI, &ReadLimits::default(), Progress::none()).unwrap()
    }

    #[test]
    fn boundaries_are_closed_and_their_values_are_those_of_the_grid() {
        for dims in [[2, 2, 2], [3, 4, 5], [2, 5, 3], [4, 2, 2], [3, 3, 3]] {
            let shape = grid(dims);
            let [nx, ny, nz] = dims;
            let n_quads = 2 * ((nx - 1) * (ny - 1) + (ny - 1) * (nz - 1) + (nz - 1) * (nx - 1));
            assert_eq!(shape.faces.len() as u64, n_quads);
            // Euler's formula for a sphere.
            assert_eq!(shape.n_vertices, shape.faces.len() + 2);
            for (v, p) in shape.points.iter().enumerate() {
                let index = (p[2] * ny as f64 + p[1]) * nx as f64 + p[0];
                assert_eq!(shape.vertex_fields[0].get(v, 0), index);
            }
            let quads: Vec<[u32; 4]> = shape.faces.iter().map(|f| f.try_into().unwrap()).collect();
            let expected = 6.0 * ((nx - 1) * (ny - 1) * (nz - 1)) as f64;
            assert!((volume(&shape.points, &quads) - expected).abs() < 1e-9);
            for (f, face) in shape.faces.iter().enumerate() {
                // The smallest corner of the cell is half a cell or a whole cell from the middle of its sides.
                let middle: [f64; 3] = std::array::from_fn(|c| {
                    face.iter().map(|&v| shape.points[v as usize][c]).sum::<f64>() / 4.0
                });
                let cell = shape.face_fields[0].get(f, 0) as u64;
                let corner = [cell % (nx - 1), cell / (nx - 1) % (ny - 1), cell / ((nx - 1) * (ny - 1))];
                for c in 0..3 {
                    assert!((0.0..=1.0).contains(&(middle[c] - corner[c] as f64)), "{dims:?} {face:?}");
                }
            }
        }
    }

    #[test]
    fn flat_and_thin_grids() {
        for (dims, n_faces, n_edges) in
            [([3, 4, 1], 6, 0), ([1, 3, 4], 6, 0), ([3, 1, 4], 6, 0), ([5, 1, 1], 0, 4), ([1, 1, 1], 0, 0)]
        {
            let shape = grid(dims);
            assert_eq!((shape.faces.len(), shape.edges.pairs.len()), (n_faces, n_edges), "{dims:?}");
            assert_eq!(shape.n_vertices as u64, dims.iter().product::<u64>());
        }
        assert_eq!(Lattice::new([0, 5, 5]).unwrap(), None);
        assert!(Lattice::new([1 << 20, 1 << 20, 1 << 40]).is_err());
    }
}
