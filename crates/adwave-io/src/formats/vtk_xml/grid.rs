//! Structured grids: images, and grids with coordinates along each axis or for each point.

use adwave::Progress;
use roxmltree::Node;

use super::array::arrays;
use super::document::{XmlFrame, error_at, numbers};
use super::read::{JoinedFields, fields, points};
use crate::model::cells::{Grid, GridPoints, ImageFrame, Lattice};
use crate::progress::report_row;
use crate::{CoordinatePrecision, Format, ReadError, ValueType};

/// First and last index along each axis.
type Extent = [[i64; 2]; 3];

fn extent(node: Node<'_, '_>, name: &str) -> Result<Extent, ReadError> {
    let Some(ends) = numbers::<i32, 6>(node, name)? else {
        return Err(error_at(node, format!("{name} is missing; save the file again")));
    };
    Ok([0, 1, 2].map(|a| [ends[2 * a].into(), ends[2 * a + 1].into()]))
}

fn lattice(node: Node<'_, '_>, extent: &Extent) -> Result<Lattice, ReadError> {
    let dims = extent.map(|[first, last]| u64::try_from(last - first + 1).unwrap_or(0));
    Lattice::new(dims)?.ok_or_else(|| error_at(node, "the grid is empty; use one with points"))
}

/// Reads the grid formed by all pieces.
pub(super) fn read_grid<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    data: Node<'n, '_>,
    pieces: &[Node<'n, '_>],
    format: Format,
    mut extras: Vec<String>,
    progress: Progress<'_>,
) -> Result<Grid, ReadError> {
    let [piece] = pieces else { return join_pieces(frame, data, pieces, format, extras, progress) };
    // The existing part is the grid, even if it was cut from a larger one.
    let extent = extent(*piece, if piece.has_attribute("Extent") { "Extent" } else { "WholeExtent" })?;
    let lattice = lattice(*piece, &extent)?;
    let located = LocatedPiece { node: *piece, extent, lattice };
    let (points, precision) = grid_points(frame, data, &located, format, progress)?;
    Ok(Grid {
        lattice,
        points,
        precision,
        point_fields: fields(frame, *piece, "PointData", lattice.n_points(), &mut extras, progress)?,
        cell_fields: fields(frame, *piece, "CellData", lattice.n_cells(), &mut extras, progress)?,
        point_rows: None,
        cell_rows: None,
        extras,
    })
}

/// A piece, the part of the whole grid that it is, and its points.
struct LocatedPiece<'n, 'i> {
    node: Node<'n, 'i>,
    extent: Extent,
    lattice: Lattice,
}

/// Positions of the points of a piece.
fn grid_points<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    data: Node<'n, '_>,
    piece: &LocatedPiece<'n, '_>,
    format: Format,
    progress: Progress<'_>,
) -> Result<(GridPoints, CoordinatePrecision), ReadError> {
    let LocatedPiece { node: piece, extent, lattice } = *piece;
    let precision = |kinds: &[ValueType]| {
        if kinds.iter().all(|kind| *kind == ValueType::F32) {
            CoordinatePrecision::F32
        } else {
            CoordinatePrecision::F64
        }
    };
    match format {
        Format::VTI => {
            let three =
                |name, other| Ok::<_, ReadError>(numbers::<f64, 3>(data, name)?.unwrap_or([other; 3]));
            let turn = numbers::<f64, 9>(data, "Direction")?
                .unwrap_or([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
            let frame = ImageFrame {
                origin: three("Origin", 0.0)?,
                spacings: three("Spacing", 1.0)?,
                directions: [0, 1, 2].map(|axis| [turn[axis], turn[3 + axis], turn[6 + axis]]),
                first: extent.map(|[first, _]| first),
            };
            Ok((GridPoints::Image(frame), CoordinatePrecision::F64))
        }
        Format::VTR => {
            let Some(section) = piece.children().find(|node| node.has_tag_name("Coordinates")) else {
                return Err(error_at(piece, "the grid has no coordinates; save the file again"));
            };
            let mut axes: [Vec<f64>; 3] = Default::default();
            let mut kinds = Vec::new();
            let mut nodes = arrays(section);
            for (a, axis) in axes.iter_mut().enumerate() {
                let Some(node) = nodes.next() else {
                    return Err(error_at(
                        section,
                        "the grid must have coordinates for three axes; save the file again",
                    ));
                };
                let numbers = frame.array(node, progress)?;
                let (found, [first, last]) = (numbers.len(), extent[a]);
                if found as i64 != last - first + 1 {
                    let message = format!(
                        "the indices {first} to {last} do not match {found} coordinates; get the whole \
                        file"
                    );
                    return Err(error_at(node, message));
                }
                *axis = numbers.to_f64(progress)?;
                kinds.push(numbers.kind());
            }
            Ok((GridPoints::Axes(axes), precision(&kinds)))
        }
        _ => {
            let (points, kind) = points(frame, piece, lattice.n_points() as u64, progress)?;
            Ok((GridPoints::Listed(points), precision(&[kind])))
        }
    }
}

/// Piece of the whole grid.
struct GridPiece {
    lattice: Lattice,
    /// Start in the whole grid along each axis.
    offset: [usize; 3],
    /// Coordinates of the piece along each axis, if it has any.
    axes: [Vec<f64>; 3],
}

/// Joins several pieces to one grid.
fn join_pieces<'n: 'a, 'a>(
    frame: &XmlFrame<'a>,
    data: Node<'n, '_>,
    pieces: &[Node<'n, '_>],
    format: Format,
    mut extras: Vec<String>,
    progress: Progress<'_>,
) -> Result<Grid, ReadError> {
    let whole = extent(data, "WholeExtent")?;
    let all = lattice(data, &whole)?;
    let (mut point_fields, mut cell_fields) = (JoinedFields::default(), JoinedFields::default());
    let mut parts = Vec::new();
    let mut listed = Vec::new();
    let mut image = None;
    let mut precision = CoordinatePrecision::F32;
    for &piece in pieces {
        let extent = extent(piece, "Extent")?;
        let lattice = lattice(piece, &extent)?;
        let is_within = (0..3).all(|a| extent[a][0] >= whole[a][0] && extent[a][1] <= whole[a][1]);
        if !is_within {
            return Err(error_at(piece, "the piece must lie within the whole extent; save the file again"));
        }
        let offset = [0, 1, 2].map(|a| (extent[a][0] - whole[a][0]) as usize);
        let located = LocatedPiece { node: piece, extent, lattice };
        let (points, of_piece) = grid_points(frame, data, &located, format, progress)?;
        if of_piece == CoordinatePrecision::F64 {
            precision = of_piece;
        }
        let mut axes: [Vec<f64>; 3] = Default::default();
        match points {
            GridPoints::Image(frame) => {
                let first = whole.map(|[first, _]| first);
                image = Some(GridPoints::Image(ImageFrame { first, ..frame }));
            }
            GridPoints::Listed(points) => listed.extend(points),
            GridPoints::Axes(of_piece) => axes = of_piece,
        }
        point_fields
            .add(fields(frame, piece, "PointData", lattice.n_points(), &mut extras, progress)?, &mut extras);
        cell_fields
            .add(fields(frame, piece, "CellData", lattice.n_cells(), &mut extras, progress)?, &mut extras);
        parts.push(GridPiece { lattice, offset, axes });
    }
    let missing = || error_at(data, "the pieces do not fill the whole extent; get all pieces");
    let n: usize = parts.iter().map(|part| part.lattice.n_points()).sum();
    if n < all.n_points() || n > u32::MAX as usize {
        return Err(missing());
    }
    let (point_fields, cell_fields) = (point_fields.into_fields(), cell_fields.into_fields());
    if listed.is_empty() && point_fields.is_empty() && cell_fields.is_empty() {
        // Only its own statements tell how large the grid is.
        all.check_without_values()?;
    }
    let points = match format {
        Format::VTI => image.ok_or_else(missing)?,
        Format::VTR => GridPoints::Axes(axes(&parts, all).ok_or_else(missing)?),
        _ => GridPoints::Listed(listed),
    };
    let is_flatter = |part: &GridPiece| (0..3).any(|a| part.lattice.dims()[a] == 1 && all.dims()[a] > 1);
    let point_rows = rows(&parts, all.n_points(), Lattice::dims, |at| all.point(at), |_| false, progress)?;
    let cell_rows = rows(&parts, all.n_cells(), Lattice::cells, |at| all.cell(at), is_flatter, progress)?;
    Ok(Grid {
        lattice: all,
        points,
        precision,
        point_fields,
        cell_fields,
        point_rows: Some(point_rows.ok_or_else(missing)?),
        cell_rows: Some(cell_rows.ok_or_else(missing)?),
        extras,
    })
}

/// Coordinates of the whole grid along each axis; `None` if one is missing.
fn axes(parts: &[GridPiece], all: Lattice) -> Option<[Vec<f64>; 3]> {
    let mut axes = all.dims().map(|n| vec![None; n]);
    for part in parts {
        for (a, axis) in axes.iter_mut().enumerate() {
            for (i, &x) in part.axes[a].iter().enumerate() {
                *axis.get_mut(part.offset[a] + i)? = Some(x);
            }
        }
    }
    let [x, y, z] = axes.map(|axis| axis.into_iter().collect::<Option<Vec<f64>>>());
    Some([x?, y?, z?])
}

/// For each point (or cell) of the whole grid, its row among those of all parts; `None` if one is missing.
fn rows(
    parts: &[GridPiece],
    n: usize,
    dims: impl Fn(Lattice) -> [usize; 3],
    index: impl Fn([usize; 3]) -> usize,
    is_left: impl Fn(&GridPiece) -> bool,
    progress: Progress<'_>,
) -> Result<Option<Vec<u32>>, ReadError> {
    let mut rows = vec![u32::MAX; n];
    let mut row = 0;
    for part in parts {
        let [nx, ny, nz] = dims(part.lattice);
        // A flat part of a grid that is not flat has cells that do not belong to the grid.
        if is_left(part) {
            row += (nx * ny * nz) as u32;
            continue;
        }
        for k in 0..nz {
            for j in 0..ny {
                report_row(progress, u64::from(row), n as u64)?;
                for i in 0..nx {
                    let position = [i + part.offset[0], j + part.offset[1], k + part.offset[2]];
                    rows[index(position)] = row;
                    row += 1;
                }
            }
        }
    }
    Ok((!rows.contains(&u32::MAX)).then_some(rows))
}
