//! Reader of ESRI ASCII grids.

use std::io::Read as _;
use std::path::Path;
use std::sync::Arc;

use super::write::GridDocument;
use crate::model::context::ReadContext;
use crate::model::grid_layout::{GRID_VALUES, GridLayout, note_on_missing};
use crate::model::numbers::{NumberError, from_text};
use crate::text::{is_space, parse_f64, show};
use crate::{
    CoordinateSystem, CoordinateSystemKind, Field, FieldValues, Format, ReadError, ShapeFile, ValueType,
};

/// Largest text of a coordinate system that is read.
const MOST_PRJ: u64 = 1 << 16;

/// Lines before the numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct EsriHeader {
    n_columns: usize,
    n_rows: usize,
    /// Position of the first column and the last row, and true if it is that of their center.
    x: (f64, bool),
    y: (f64, bool),
    /// Width and height of a cell.
    cell: [f64; 2],
    /// Number that means no data, and its text.
    pub(super) missing: Option<(f64, String)>,
    /// First byte of the numbers.
    pub(super) start: usize,
}

/// Next word from a place on, and its end.
pub(super) fn next_word(bytes: &[u8], mut at: usize) -> Option<(&[u8], usize)> {
    while bytes.get(at).is_some_and(|&b| is_space(b)) {
        at += 1;
    }
    let start = at;
    while bytes.get(at).is_some_and(|&b| !is_space(b)) {
        at += 1;
    }
    (start < at).then(|| (&bytes[start..at], at))
}

impl EsriHeader {
    fn parse(bytes: &[u8]) -> Result<Self, ReadError> {
        let mut header = Self::default();
        let (mut columns, mut rows, mut width, mut height) = (None, None, None, None);
        let mut at = 0;
        while let Some((word, after)) = next_word(bytes, at) {
            let key = String::from_utf8_lossy(word).to_ascii_lowercase();
            if parse_f64(word).is_some() {
                break;
            }
            let Some((word, end)) = next_word(bytes, after) else {
                return Err(ReadError::line_error(
                    bytes,
                    after,
                    format!("`{key}` needs a number; get the whole file"),
                ));
            };
            let number =
                parse_f64(word).filter(|x| x.is_finite() || key == "nodata_value").ok_or_else(|| {
                    ReadError::line_error(
                        bytes,
                        after,
                        format!("`{key}` needs a number, got {}; correct it", show(word)),
                    )
                })?;
            match key.as_str() {
                "ncols" => columns = Some(number),
                "nrows" => rows = Some(number),
                "xllcorner" => header.x = (number, false),
                "xllcenter" => header.x = (number, true),
                "yllcorner" => header.y = (number, false),
                "yllcenter" => header.y = (number, true),
                "cellsize" => (width, height) = (Some(number), Some(number)),
                "dx" => width = Some(number),
                "dy" => height = Some(number),
                "nodata_value" => header.missing = Some((number, String::from_utf8_lossy(word).into_owned())),
                _ => {
                    let message = format!(
                        "{} is no line of an ESRI grid, nor a number; correct it",
                        show(key.as_bytes())
                    );
                    return Err(ReadError::line_error(bytes, at, message));
                }
            }
            at = end;
        }
        header.start = at;
        // Each number has a digit and a space.
        let most = bytes.len() as f64;
        let size = |name: &str, size: Option<f64>| match size {
            Some(n) if n >= 1.0 && n.fract() == 0.0 && n <= most => Ok(n as usize),
            Some(n) => Err(ReadError::Whole(format!(
                "`{name}` is {n}, in a file of {most} bytes; get the whole file"
            ))),
            None => Err(ReadError::Whole(format!("the line `{name}` is missing; get the whole file"))),
        };
        (header.n_columns, header.n_rows) = (size("ncols", columns)?, size("nrows", rows)?);
        let cell = |name: &str, size: Option<f64>| match size {
            Some(h) if h > 0.0 && h.is_normal() => Ok(h),
            Some(h) => Err(ReadError::Whole(format!("`{name}` must be above 0, got {h}; correct it"))),
            None => Err(ReadError::Whole("the line `cellsize` is missing; add it".into())),
        };
        header.cell = [cell("cellsize", width)?, cell("cellsize", height)?];
        if !header.layout().origin.iter().all(|x| x.is_finite()) {
            return Err(ReadError::Whole(
                "the position of the cells is beyond the range of numbers; correct it".into(),
            ));
        }
        Ok(header)
    }

    /// Number of places; `None` if that is no number.
    fn n_places(&self) -> Option<usize> {
        self.n_columns.checked_mul(self.n_rows)
    }

    fn layout(&self) -> GridLayout {
        let [width, height] = self.cell;
        let at = |(x, is_center): (f64, bool), size: f64| if is_center { x } else { x + 0.5 * size };
        let last_row = at(self.y, height);
        let sizes = [self.n_rows, self.n_columns];
        GridLayout {
            origin: [at(self.x, width), last_row + (self.n_rows - 1) as f64 * height, 0.0],
            steps: vec![[0.0, -height, 0.0], [width, 0.0, 0.0]],
            ..GridLayout::new(&sizes, &[height, width])
        }
    }

    /// Value of a number: NaN if it means no data.
    pub(super) fn value(&self, x: f64) -> f64 {
        let is_missing = self.missing.as_ref().is_some_and(|(missing, _)| x == *missing);
        if is_missing || !x.is_finite() { f64::NAN } else { x }
    }
}

pub(super) fn read_grid(bytes: Vec<u8>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let header = EsriHeader::parse(&bytes)?;
    let n_found = bytes.len();
    let Some(n_places) = header.n_places().filter(|n| *n <= n_found) else {
        let EsriHeader { n_columns, n_rows, .. } = header;
        let message =
            format!("{n_columns} columns and {n_rows} rows do not fit {n_found} bytes; get the whole file");
        return Err(ReadError::Whole(message));
    };
    c.limits.check_points(n_places as u64)?;
    c.limits.check_bytes(8 * n_places as u64)?;
    let numbers = from_text(&bytes[header.start..], ValueType::F64, c.progress).map_err(|e| match e {
        NumberError::Cancelled(cancelled) => ReadError::Cancelled(cancelled),
        NumberError::At(at, message) => {
            ReadError::line_error(&bytes, header.start + at, format!("{message}; correct it"))
        }
    })?;
    let FieldValues::F64(mut values) = numbers else {
        return Err(ReadError::Whole("the numbers are of another type; save the file again".into()));
    };
    if values.len() != n_places {
        let message =
            format!("the file has {} numbers instead of {n_places}; get the whole file", values.len());
        return Err(ReadError::Whole(message));
    }
    for x in &mut values {
        *x = header.value(*x);
    }
    let kept = values.iter().any(|x| x.is_nan()).then(|| values.iter().map(|x| !x.is_nan()).collect());
    let layout = GridLayout { kept, ..header.layout() };
    let mut notes = vec!["the file states no unit of length and no coordinate system".to_owned()];
    let missing = header.missing.as_ref().map(|(_, text)| text.as_str());
    note_on_missing(&layout, missing, &mut notes);
    let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.vertex_fields.push(Field::new(GRID_VALUES, 1, FieldValues::F64(values)));
    shape.format = Some(Format::ESRI_GRID);
    if let Some(system) = system_beside(c) {
        notes.remove(0);
        shape.unit.clone_from(&system.unit);
        shape.coordinate_system = Some(Arc::new(system));
    }
    shape.notes = notes;
    shape.original = Some(Arc::new(GridDocument { bytes, header }));
    Ok(shape)
}

/// Coordinate system in the `.prj` beside the file.
fn system_beside(c: &ReadContext<'_>) -> Option<CoordinateSystem> {
    let name = Path::new(c.name?).file_name()?.to_str()?;
    let stem = name.strip_suffix(".gz").unwrap_or(name).rsplit_once('.')?.0;
    let file = std::fs::File::open(c.folder?.join(format!("{stem}.prj"))).ok()?;
    let mut text = String::new();
    file.take(MOST_PRJ).read_to_string(&mut text).ok()?;
    let text = text.trim_start();
    #[cfg(feature = "las")]
    if let Some(system) = crate::formats::las::wkt::parse_wkt(text) {
        return Some(system);
    }
    let is_geographic =
        text.starts_with("GEOG") || text.to_ascii_lowercase().contains("projection geographic");
    let kind = if is_geographic { CoordinateSystemKind::Geographic } else { return None };
    Some(CoordinateSystem { name: format!("{stem}.prj"), kind, unit: None })
}
