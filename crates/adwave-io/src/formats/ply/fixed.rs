//! Parallel reading of binary PLY rows of known size: vertices without lists, and runs of faces with equal numbers of
//! corners. All other rows are read by [`super::body`], with the same results.

use adwave::shape::Polygons;
use adwave::{Cancelled, Progress};

use super::body::Body;
use super::header::{Element, Encoding, Kind};
use crate::model::field::{ByteOrder, Number, with_values};
use crate::progress::{collect, extend};
use crate::{FieldValues, ReadError, ValueType};

/// Rows of equal size: each property has the same offset in all of them.
#[derive(Clone, Copy)]
struct Rows<'a> {
    bytes: &'a [u8],
    row_bytes: usize,
    n: usize,
    order: ByteOrder,
}

impl Rows<'_> {
    #[inline]
    fn number<T: Number>(&self, row: usize, offset: usize) -> T {
        T::from_bytes(&self.bytes[row * self.row_bytes + offset..], self.order)
    }

    /// Reads one property of every row.
    fn column(&self, t: ValueType, offset: usize, progress: Progress<'_>) -> Result<FieldValues, Cancelled> {
        let mut values = t.empty();
        with_values!(&mut values, v => extend(v, self.n, progress, |i| self.number(i, offset)))?;
        Ok(values)
    }

    /// Reads three properties of one type of every row.
    fn triples<T: Number + Into<f64>>(
        self,
        offsets: [usize; 3],
        progress: Progress<'_>,
    ) -> Result<Vec<[f64; 3]>, Cancelled> {
        let [x, y, z] = offsets;
        if [y, z] == [x + size_of::<T>(), x + 2 * size_of::<T>()] && self.order == ByteOrder::Little {
            // Layout of nearly all files, with sizes known to the compiler.
            return collect(self.n, progress, |i| {
                let row = &self.bytes[i * self.row_bytes + x..][..3 * size_of::<T>()];
                let number = |k: usize| T::from_bytes(&row[k * size_of::<T>()..], ByteOrder::Little).into();
                [number(0), number(1), number(2)]
            });
        }
        collect(self.n, progress, |i| offsets.map(|offset| self.number::<T>(i, offset).into()))
    }
}

/// Content of vertex rows.
pub(crate) struct Vertices {
    pub(crate) points: Vec<[f64; 3]>,
    /// True if all coordinates are 32-bit floats.
    pub(crate) is_single: bool,
    /// Values of each property except the coordinates.
    pub(crate) columns: Vec<Option<FieldValues>>,
}

/// Reads vertices whose properties are all numbers; `None` if one is a list or the file is text.
pub(crate) fn read_vertices(body: &mut Body<'_>, element: &Element) -> Result<Option<Vertices>, ReadError> {
    let Encoding::Binary(order) = body.encoding else { return Ok(None) };
    let mut row_bytes = 0;
    let mut places = Vec::with_capacity(element.properties.len());
    for property in &element.properties {
        let Kind::Scalar(t) = property.kind else { return Ok(None) };
        places.push((t, row_bytes));
        row_bytes += t.n_bytes();
    }
    let axes = ["x", "y", "z"].map(|axis| element.property(axis));
    let [Some(x), Some(y), Some(z)] = axes else { return Ok(None) };
    // The size of all rows was checked before.
    let n = element.n_rows as usize;
    let end = body.position + n * row_bytes;
    let rows = Rows { bytes: &body.bytes[body.position..end], row_bytes, n, order };
    let progress = body.progress;
    let types = [x, y, z].map(|p| places[p].0);
    let offsets = [x, y, z].map(|p| places[p].1);
    let points = match types {
        [ValueType::F32, ValueType::F32, ValueType::F32] => rows.triples::<f32>(offsets, progress)?,
        [ValueType::F64, ValueType::F64, ValueType::F64] => rows.triples::<f64>(offsets, progress)?,
        _ => {
            let mut columns = Vec::with_capacity(3);
            for (t, offset) in types.into_iter().zip(offsets) {
                columns.push(rows.column(t, offset, progress)?);
            }
            collect(n, progress, |i| [columns[0].get(i), columns[1].get(i), columns[2].get(i)])?
        }
    };
    let mut columns = Vec::with_capacity(places.len());
    for (p, &(t, offset)) in places.iter().enumerate() {
        let is_axis = [x, y, z].contains(&p);
        columns.push(if is_axis { None } else { Some(rows.column(t, offset, progress)?) });
    }
    body.position = end;
    Ok(Some(Vertices { points, is_single: types == [ValueType::F32; 3], columns }))
}

/// Face rows processed together.
const ROWS_PER_BLOCK: usize = 1 << 16;

/// Layout of a face: numbers, the list of corners, numbers.
pub(crate) struct FaceLayout {
    pub(crate) order: ByteOrder,
    /// Offset and type of the count.
    pub(crate) count_at: usize,
    pub(crate) count: ValueType,
    pub(crate) item: ValueType,
    /// Size of a row without its corners in bytes.
    own_bytes: usize,
    /// Type and offset of each number; offsets after the corners count from their end.
    scalars: Vec<Option<(ValueType, usize, bool)>>,
}

impl FaceLayout {
    /// Layout of rows with one list of integers of at most 32 bits and otherwise fixed size.
    pub(crate) fn new(element: &Element, encoding: Encoding, corners: usize) -> Option<Self> {
        let Encoding::Binary(order) = encoding else { return None };
        let Kind::List { count, item } = element.properties[corners].kind else { return None };
        let fits = |t: ValueType| t.is_integer() && t.n_bytes() <= 4;
        if !fits(count) || !fits(item) {
            return None;
        }
        let (mut at, mut count_at, mut scalars) = (0, 0, Vec::with_capacity(element.properties.len()));
        for (p, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(t) => {
                    scalars.push(Some((t, at, p > corners)));
                    at += t.n_bytes();
                }
                Kind::List { .. } if p == corners => {
                    scalars.push(None);
                    count_at = at;
                    at += count.n_bytes();
                }
                Kind::List { .. } => return None,
            }
        }
        Some(Self { order, count_at, count, item, own_bytes: at, scalars })
    }

    /// Number of corners of the row at the start of `row`; `None` if it is negative or the row is truncated.
    #[inline]
    pub(crate) fn n_corners(&self, row: &[u8]) -> Option<usize> {
        let bytes = row.get(self.count_at..)?;
        let n = whole(bytes.get(..self.count.n_bytes())?, self.count, self.order)?;
        Some(n as usize)
    }

    pub(crate) fn row_bytes(&self, n_corners: usize) -> Option<usize> {
        n_corners.checked_mul(self.item.n_bytes())?.checked_add(self.own_bytes)
    }
}

/// Decodes the integer at the start of the bytes; `None` if it is negative.
#[inline]
pub(crate) fn whole(bytes: &[u8], t: ValueType, order: ByteOrder) -> Option<u32> {
    match t {
        ValueType::U8 => bytes.first().copied().map(u32::from),
        ValueType::U32 => Some(Number::from_bytes(bytes, order)),
        ValueType::I32 => u32::try_from(i32::from_bytes(bytes, order)).ok(),
        ValueType::U16 => Some(u16::from_bytes(bytes, order).into()),
        ValueType::I16 => u32::try_from(i16::from_bytes(bytes, order)).ok(),
        ValueType::I8 => u32::try_from(i8::from_bytes(bytes, order)).ok(),
        _ => None,
    }
}

/// Content of face rows.
pub(crate) struct Faces {
    pub(crate) polygons: Polygons,
    pub(crate) columns: Vec<Option<FieldValues>>,
    /// Number of rows read; the slow parser reads the next one and reports its error.
    pub(crate) n_rows: u64,
}

/// Reads the faces up to the first invalid one. `None` if the layout is not supported.
pub(crate) fn read_faces(
    body: &mut Body<'_>,
    element: &Element,
    corners: usize,
    n_vertices: usize,
) -> Result<Option<Faces>, ReadError> {
    let Some(layout) = FaceLayout::new(element, body.encoding, corners) else { return Ok(None) };
    let mut columns: Vec<Option<FieldValues>> =
        layout.scalars.iter().map(|s| s.map(|(t, ..)| t.empty())).collect();
    let n_rows = element.n_rows as usize;
    let mut list = CornerLists::with_capacity(n_rows);
    let (mut row, mut asked) = (0, 0);
    while row < n_rows {
        if row >= asked {
            body.progress.step(row as u64, n_rows as u64)?;
            asked = row + ROWS_PER_BLOCK / 8;
        }
        let bytes = &body.bytes[body.position..];
        let length = layout.n_corners(bytes).and_then(|k| Some((k, layout.row_bytes(k)?)));
        let Some((k, row_bytes)) = length else { break };
        let rows = bytes.chunks_exact(row_bytes).take(ROWS_PER_BLOCK.min(n_rows - row));
        let n = rows.take_while(|row| layout.n_corners(row) == Some(k)).count();
        let rows = Rows { bytes: &bytes[..n * row_bytes], row_bytes, n, order: layout.order };
        if n == 0 || !list.add(&layout, rows, k, n_vertices, body.progress)? {
            break;
        }
        for (column, place) in columns.iter_mut().zip(&layout.scalars) {
            if let (Some(column), Some((_, at, is_after))) = (column, *place) {
                let at = if is_after { at + k * layout.item.n_bytes() } else { at };
                with_values!(column, v => for i in 0..n {
                    v.push(rows.number(i, at));
                });
            }
        }
        body.position += rows.bytes.len();
        row += n;
    }
    let polygons = list.into_polygons(body.progress)?;
    Ok(Some(Faces { polygons, columns, n_rows: row as u64 }))
}

/// Corners of faces: stored as triangles as long as there are no other faces, so that each is written once in its
/// final position.
struct CornerLists {
    triangles: Vec<[u32; 3]>,
    /// Corners in the form of [`Polygons`] as soon as there is a face that is not a triangle; else empty.
    corners: Vec<u32>,
    offsets: Vec<u32>,
}

impl CornerLists {
    /// Every face takes bytes, so the capacity does not exceed the file size.
    fn with_capacity(n_faces: usize) -> Self {
        Self { triangles: Vec::with_capacity(n_faces), corners: Vec::new(), offsets: Vec::new() }
    }

    fn n_corners(&self) -> usize {
        self.corners.len() + 3 * self.triangles.len()
    }

    /// Adds faces of `k` corners each; returns `false`, without adding any, if a corner is invalid or there are too
    /// many.
    fn add(
        &mut self,
        layout: &FaceLayout,
        rows: Rows<'_>,
        k: usize,
        n_vertices: usize,
        progress: Progress<'_>,
    ) -> Result<bool, Cancelled> {
        if self.n_corners() as u64 + rows.n as u64 * k as u64 >= u64::from(u32::MAX) {
            return Ok(false);
        }
        let at = layout.count_at + layout.count.n_bytes();
        match layout.item {
            ValueType::U32 => self.add_as::<u32>(rows, at, k, n_vertices, progress),
            ValueType::I32 => self.add_as::<i32>(rows, at, k, n_vertices, progress),
            ValueType::U16 => self.add_as::<u16>(rows, at, k, n_vertices, progress),
            ValueType::I16 => self.add_as::<i16>(rows, at, k, n_vertices, progress),
            ValueType::U8 => self.add_as::<u8>(rows, at, k, n_vertices, progress),
            _ => self.add_as::<i8>(rows, at, k, n_vertices, progress),
        }
    }

    fn add_as<T: Number + TryInto<u32>>(
        &mut self,
        rows: Rows<'_>,
        at: usize,
        k: usize,
        n_vertices: usize,
        progress: Progress<'_>,
    ) -> Result<bool, Cancelled> {
        // No list is long enough for the largest index, so it marks invalid ones.
        let corner = |i: usize, c: usize| -> u32 {
            rows.number::<T>(i, at + c * size_of::<T>()).try_into().unwrap_or(u32::MAX)
        };
        let is_vertex = |&v: &u32| (v as usize) < n_vertices;
        if k == 3 && self.offsets.is_empty() {
            let before = self.triangles.len();
            extend(&mut self.triangles, rows.n, progress, |i| [0, 1, 2].map(|c| corner(i, c)))?;
            let sound = self.triangles[before..].as_flattened().iter().all(is_vertex);
            self.triangles.truncate(if sound { before + rows.n } else { before });
            return Ok(sound);
        }
        if self.offsets.is_empty() {
            self.offsets = collect(self.triangles.len() + 1, progress, |f| 3 * f as u32)?;
            self.corners = std::mem::take(&mut self.triangles).into_flattened();
        }
        let before = self.corners.len();
        self.corners.extend((0..rows.n).flat_map(|i| (0..k).map(move |c| (i, c))).map(|(i, c)| corner(i, c)));
        let sound = self.corners[before..].iter().all(is_vertex);
        if sound {
            self.offsets.extend((1..=rows.n).map(|i| (before + i * k) as u32));
        } else {
            self.corners.truncate(before);
        }
        Ok(sound)
    }

    fn into_polygons(self, progress: Progress<'_>) -> Result<Polygons, Cancelled> {
        let (offsets, corners) = if self.offsets.is_empty() {
            (collect(self.triangles.len() + 1, progress, |f| 3 * f as u32)?, self.triangles.into_flattened())
        } else {
            (self.offsets, self.corners)
        };
        Ok(Polygons::from_parts(offsets, corners).expect("offsets ascend to the number of corners"))
    }
}
