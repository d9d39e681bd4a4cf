//! Legacy VTK reader: the header, then keywords in any order.

use adwave::Progress;

use super::arrays::{ValueReader, skip_metadata};
use super::cells::read_cells;
use super::scanner::{ArrayType, Scanner};
use crate::model::cells::{CellKind, Cells, Dataset, Grid, GridPoints, ImageFrame, Lattice};
use crate::model::numbers::IndexError;
use crate::progress::collect;
use crate::text::show;
use crate::{CoordinatePrecision, Field, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// First bytes of a legacy VTK file.
pub(crate) const MAGIC: &[u8] = b"# vtk DataFile";

/// Content read so far.
#[derive(Default)]
struct LegacyContent {
    kind: Vec<u8>,
    points: Option<Vec<[f64; 3]>>,
    is_single: bool,
    cells: Vec<Cells>,
    types: Option<Vec<u8>>,
    dims: Option<[u64; 3]>,
    origin: [f64; 3],
    spacing: Option<[f64; 3]>,
    axes: [Option<Vec<f64>>; 3],
    point_fields: Vec<Field>,
    cell_fields: Vec<Field>,
    n_cell_rows: Option<u64>,
    n_point_rows: Option<u64>,
    extras: Vec<String>,
}

/// Owner of the arrays that follow.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    Whole,
    Points,
    Cells,
}

/// Reads a legacy VTK.
pub(crate) fn read_vtk(
    bytes: &[u8],
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut file = Scanner { bytes, at: 0, is_binary: false, progress };
    file.line();
    file.line();
    file.is_binary = match file.word() {
        Some((_, word)) if word.eq_ignore_ascii_case(b"BINARY") => true,
        Some((_, word)) if word.eq_ignore_ascii_case(b"ASCII") => false,
        Some((at, word)) => {
            let message = format!("expected ASCII or BINARY, got {}; correct it", show(word));
            return Err(ReadError::line_error(bytes, at, message));
        }
        None => {
            return Err(ReadError::line_error(
                bytes,
                bytes.len(),
                "the file ends in its header; get the whole file",
            ));
        }
    };
    let mut content = LegacyContent { is_single: true, ..LegacyContent::default() };
    let mut section = Section::Whole;
    while let Some((at, word)) = file.word() {
        progress.check()?;
        let keyword = word.to_ascii_uppercase();
        match keyword.as_slice() {
            b"POINT_DATA" => {
                content.n_point_rows = Some(file.count("the number of points")?);
                section = Section::Points;
            }
            b"CELL_DATA" => {
                content.n_cell_rows = Some(file.count("the number of cells")?);
                section = Section::Cells;
            }
            b"METADATA" => {
                file.at = at;
                skip_metadata(&mut file);
            }
            b"LOOKUP_TABLE" => {
                let name = file.name("the name of a table of colors")?;
                let n = file.count("the number of colors")?.saturating_mul(4);
                // Bytes, or in a text fractions of 255.
                let kind = if file.is_binary { ValueType::U8 } else { ValueType::F64 };
                file.array(n, ArrayType::Numbers(kind), "a table of colors")?;
                content.extras.push(format!("table of colors `{name}`"));
            }
            _ => {
                let is_known = content.geometry(&mut file, at, &keyword, limits)?
                    || content.values(&mut file, &keyword, section)?;
                if !is_known {
                    let message = format!("the keyword {} is unknown; save the file again", show(word));
                    return Err(file.error(at, message));
                }
            }
        }
    }
    content.into_shape(&file, limits, progress)
}

impl LegacyContent {
    /// Reads points, cells and the sizes of grids; `false` for other keywords.
    fn geometry(
        &mut self,
        file: &mut Scanner<'_>,
        at: usize,
        keyword: &[u8],
        limits: &ReadLimits,
    ) -> Result<bool, ReadError> {
        let n_points = self.points.as_ref().map_or(0, Vec::len);
        let mut add = |this: &mut Self, kind: CellKind| {
            this.cells.push(read_cells(file, kind, n_points, at)?);
            Ok(true)
        };
        match keyword {
            b"VERTICES" => return add(self, CellKind::Vertices),
            b"LINES" => return add(self, CellKind::Lines),
            b"POLYGONS" | b"CELLS" => return add(self, CellKind::Polygons),
            b"TRIANGLE_STRIPS" => return add(self, CellKind::Strips),
            b"DATASET" => {
                self.kind = file.name("the kind of the dataset")?.to_ascii_uppercase().into_bytes();
            }
            b"POINTS" => {
                let n = file.count("the number of points")?;
                limits.check_points(n)?;
                let kind = file.array_type()?;
                let numbers = file.array(3 * n, kind, "coordinates")?;
                self.is_single &= numbers.kind() == ValueType::F32;
                self.points = Some(numbers.to_points(file.progress)?);
                skip_metadata(file);
            }
            b"CELL_TYPES" => {
                let n = file.count("the number of cells")?;
                let types = file.array(n, ArrayType::Numbers(ValueType::I32), "types of cells")?;
                let types = types.to_indices(256, file.progress).map_err(|error| match error {
                    IndexError::At(i, x) => file.error(at, format!("cell {i} has the unknown type {x}")),
                    _ => adwave::Cancelled.into(),
                })?;
                self.types = Some(collect(types.len(), file.progress, |i| types[i] as u8)?);
            }
            b"DIMENSIONS" => {
                let mut dims = [0; 3];
                for n in &mut dims {
                    *n = file.count("a number of points")?;
                }
                self.dims = Some(dims);
            }
            b"EXTENT" => {
                let mut ends = [0.0; 6];
                for end in &mut ends {
                    *end = file.number("the end of an axis")?;
                }
                self.dims = Some([0, 1, 2].map(|a| (ends[2 * a + 1] - ends[2 * a] + 1.0) as u64));
            }
            b"SPACING" | b"ASPECT_RATIO" | b"ORIGIN" => {
                let mut three = [0.0; 3];
                for x in &mut three {
                    *x = file.number("a length")?;
                }
                if keyword == b"ORIGIN" {
                    self.origin = three;
                } else {
                    self.spacing = Some(three);
                }
            }
            b"X_COORDINATES" | b"Y_COORDINATES" | b"Z_COORDINATES" => {
                let n = file.count("the number of coordinates")?;
                let kind = file.array_type()?;
                let numbers = file.array(n, kind, "coordinates")?;
                self.is_single &= numbers.kind() == ValueType::F32;
                self.axes[usize::from(keyword[0] - b'X')] = Some(numbers.to_f64(file.progress)?);
                skip_metadata(file);
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Reads arrays of values; `false` for other keywords.
    fn values(
        &mut self,
        file: &mut Scanner<'_>,
        keyword: &[u8],
        section: Section,
    ) -> Result<bool, ReadError> {
        let mut none = Vec::new();
        let (fields, n) = match section {
            Section::Points => (&mut self.point_fields, self.n_point_rows),
            Section::Cells => (&mut self.cell_fields, self.n_cell_rows),
            Section::Whole => (&mut none, None),
        };
        let mut values = ValueReader { fields, n: n.unwrap_or(0), extras: &mut self.extras };
        if keyword == b"FIELD" {
            values.field_arrays(file, section != Section::Whole)?;
            return Ok(true);
        }
        if section == Section::Whole || !values.attribute(file, keyword)? {
            return Ok(false);
        }
        skip_metadata(file);
        Ok(true)
    }

    fn into_shape(
        mut self,
        file: &Scanner<'_>,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<ShapeFile, ReadError> {
        let precision = if self.is_single { CoordinatePrecision::F32 } else { CoordinatePrecision::F64 };
        if !matches!(self.kind.as_slice(), b"POLYDATA" | b"UNSTRUCTURED_GRID") {
            let grid = self.into_grid(file, precision)?;
            let GridPoints::Image(frame) = grid.points else {
                return grid.into_shape(Format::VTK, limits, progress);
            };
            let (mut shape, _) = grid.into_image(&frame, [None; 2], limits, progress)?;
            shape.format = Some(Format::VTK);
            return Ok(shape);
        }
        let Some(points) = self.points.take() else {
            return Err(file.error(file.at, "the file has no POINTS; get the whole file"));
        };
        if self.kind == b"UNSTRUCTURED_GRID" {
            let n = self.cells.iter().map(Cells::len).sum::<usize>();
            let types = self.types.unwrap_or_default();
            if types.len() != n {
                let message =
                    format!("the file has {} CELL_TYPES for {n} cells; get the whole file", types.len());
                return Err(file.error(file.at, message));
            }
            if let [cells] = &mut self.cells[..] {
                cells.kind = CellKind::Each(types);
            } else if n > 0 {
                return Err(file.error(file.at, "the file has two lists of CELLS; save the file again"));
            }
        } else {
            // Values count vertices, lines, polygons and strips in this order, regardless of their order in the file.
            self.cells.sort_by_key(|block| match block.kind {
                CellKind::Vertices => 0,
                CellKind::Lines => 1,
                CellKind::Strips => 3,
                _ => 2,
            });
        }
        let n_cells = self.cells.iter().map(Cells::len).sum();
        check_rows(file, self.n_point_rows, points.len(), "points")?;
        check_rows(file, self.n_cell_rows, n_cells, "cells")?;
        Dataset {
            points,
            precision,
            cells: self.cells,
            point_fields: self.point_fields,
            cell_fields: self.cell_fields,
            extras: self.extras,
        }
        .into_shape(Format::VTK, progress)
    }

    fn into_grid(self, file: &Scanner<'_>, precision: CoordinatePrecision) -> Result<Grid, ReadError> {
        let fail = |message: &str| Err(file.error(file.at, message));
        let is_known =
            matches!(self.kind.as_slice(), b"STRUCTURED_POINTS" | b"STRUCTURED_GRID" | b"RECTILINEAR_GRID");
        if !is_known {
            let kind = show(&self.kind);
            return fail(&format!("a dataset of kind {kind} is not a shape; use one with points"));
        }
        let Some(dims) = self.dims else {
            return fail("the DIMENSIONS of the grid are missing; get the whole file");
        };
        let Some(lattice) = Lattice::new(dims)? else {
            return fail("the grid is empty; use one with points");
        };
        let (points, precision) = match self.kind.as_slice() {
            b"STRUCTURED_POINTS" => {
                let frame = ImageFrame {
                    origin: self.origin,
                    spacings: self.spacing.unwrap_or([1.0; 3]),
                    directions: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                    first: [0; 3],
                };
                (GridPoints::Image(frame), CoordinatePrecision::F64)
            }
            b"STRUCTURED_GRID" => {
                let points = self.points.unwrap_or_default();
                if points.len() != lattice.n_points() {
                    let (found, n) = (points.len(), lattice.n_points());
                    return fail(&format!(
                        "the DIMENSIONS require {n} POINTS, got {found}; get the whole file"
                    ));
                }
                (GridPoints::Listed(points), precision)
            }
            _ => {
                let axes = self.axes.map(Option::unwrap_or_default);
                if (0..3).any(|a| axes[a].len() as u64 != dims[a]) {
                    return fail(
                        "the numbers of coordinates along the axes must match the DIMENSIONS; get the \
                        complete file",
                    );
                }
                (GridPoints::Axes(axes), precision)
            }
        };
        check_rows(file, self.n_point_rows, lattice.n_points(), "points")?;
        check_rows(file, self.n_cell_rows, lattice.n_cells(), "cells")?;
        Ok(Grid {
            lattice,
            points,
            precision,
            point_fields: self.point_fields,
            cell_fields: self.cell_fields,
            point_rows: None,
            cell_rows: None,
            extras: self.extras,
        })
    }
}

fn check_rows(file: &Scanner<'_>, found: Option<u64>, n: usize, of: &str) -> Result<(), ReadError> {
    match found {
        Some(found) if found != n as u64 => {
            let message = format!("the file has values for {found} {of}, but {n} {of}; get the whole file");
            Err(file.error(file.at, message))
        }
        _ => Ok(()),
    }
}
