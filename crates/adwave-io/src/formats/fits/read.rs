//! Reader of HEALPix maps.

use adwave::Progress;

use crate::formats::fits::column::{Column, columns};
use crate::formats::fits::header::Unit;
use crate::formats::fits::healpix::{MAX_N_SIDE, Ordering, PixelNumbers, Pixelization};
use crate::model::grouping::unique;
use crate::{CoordinatePrecision, Field, Format, ReadError, ReadLimits, ShapeFile, ValueType};

/// A FITS with a map, as far as it is needed to write it again.
#[derive(Clone, Debug)]
pub(super) struct FitsSource {
    pub(super) bytes: Vec<u8>,
    /// The table with the map.
    pub(super) table: Unit,
    pub(super) columns: Vec<Column>,
    pub(super) row_bytes: usize,
    pub(super) pixelization: Pixelization,
    /// Pixels of the vertices.
    pub(super) numbers: PixelNumbers,
    /// Index of the column of each field of the file, by its name.
    pub(super) fields: Vec<(String, usize)>,
    /// True if the vertices are all rows of the table in their order.
    pub(super) is_whole: bool,
}

/// Words with which columns of integers name pixels.
const PIXEL_COLUMNS: [&str; 3] = ["PIXEL", "HPXINDEX", "IPIX"];

/// Reads the first HEALPix map of a FITS.
pub(super) fn read_fits(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let table = find_table(&bytes)?;
    let columns = columns(&table)?;
    let n_rows = table.integer("NAXIS2")?.unwrap_or(0) as usize;
    let row_bytes = table.integer("NAXIS1")?.unwrap_or(0) as usize;
    let mut notes = Vec::new();
    let pixels = explicit_pixels(&table, &columns);
    let is_map =
        |column: &&Column| column.kind.is_some() && !pixels.is_some_and(|p| std::ptr::eq(p, *column));
    let Some(repeat) = pixels.or_else(|| columns.iter().find(is_map)).map(|column| column.repeat) else {
        return Err(ReadError::Whole(
            "the table of the FITS has no column of numbers; choose another file".into(),
        ));
    };
    let n = n_rows.saturating_mul(repeat);
    limits.check_points(n as u64)?;
    if n == 0 {
        return Err(ReadError::Whole("the map has no pixels; choose another file".into()));
    }
    let data = &bytes[table.data..table.data + table.n_bytes];
    let listed = pixels.map(|column| column.pixel_numbers(data, row_bytes, n));
    let pixelization = pixelization(&table, n, listed.is_some(), &mut notes)?;
    let numbers = pixels_of_rows(&table, pixelization, n, listed)?;
    let mut shape = ShapeFile::from_mesh(
        pixelization.centers(&numbers, n, progress)?,
        pixelization.dual_faces(&numbers, progress)?,
    );
    let mut fields = Vec::new();
    for (k, column) in columns.iter().enumerate() {
        progress.check()?;
        if pixels.is_some_and(|pixels| std::ptr::eq(pixels, column)) {
            continue;
        }
        if column.kind.is_none() || column.repeat != repeat {
            shape.extras.push(format!("column {}", column.name));
            continue;
        }
        let name = unique(&shape.vertex_fields, column.name.clone());
        fields.push((name.clone(), k));
        shape.vertex_fields.push(Field::new(name, 1, column.values(data, row_bytes, n)));
    }
    notes.push(describe(&table, pixelization, &columns, &fields));
    notes.extend(note_on_polarization(&fields));
    shape.format = Some(Format::FITS);
    shape.precision = CoordinatePrecision::F64;
    shape.is_map = true;
    shape.notes = notes;
    let source =
        FitsSource { bytes, table, columns, row_bytes, pixelization, numbers, fields, is_whole: true };
    shape.set_source(source);
    Ok(shape)
}

/// The first table that says it is a HEALPix map.
fn find_table(bytes: &[u8]) -> Result<Unit, ReadError> {
    let mut start = 0;
    let mut n_units = 0;
    while start < bytes.len() {
        // Zeros may follow the last unit.
        if n_units > 0 && bytes[start..].iter().all(|b| *b == 0 || *b == b' ') {
            break;
        }
        let unit = Unit::read(bytes, start)?;
        let is_table = unit.text("XTENSION").is_some_and(|kind| kind == "BINTABLE");
        let has_pixels = unit.text("PIXTYPE").is_some_and(|kind| kind.eq_ignore_ascii_case("HEALPIX"));
        if is_table && has_pixels {
            if unit.integer("NAXIS")? != Some(2) || unit.integer("BITPIX")? != Some(8) {
                return Err(ReadError::byte_error(
                    unit.start,
                    "a binary table must have NAXIS 2 and BITPIX 8; correct the header",
                ));
            }
            return Ok(unit);
        }
        start = unit.end;
        n_units += 1;
    }
    Err(ReadError::Whole(
        "the FITS has no HEALPix map (a binary table with PIXTYPE = 'HEALPIX'), and pictures in FITS are not read; write \
         them as TIFF or NumPy arrays"
            .into(),
    ))
}

/// The column with the numbers of the pixels of each row, if they are listed.
fn explicit_pixels<'a>(table: &Unit, columns: &'a [Column]) -> Option<&'a Column> {
    let is_integer = |column: &&Column| column.kind.is_some_and(ValueType::is_integer);
    let is_named = |column: &&Column| PIXEL_COLUMNS.iter().any(|name| column.name.eq_ignore_ascii_case(name));
    let is = |key: &str, word: &str| table.text(key).is_some_and(|text| text.eq_ignore_ascii_case(word));
    let named = columns.iter().find(|column| is_integer(column) && is_named(column));
    if is("INDXSCHM", "EXPLICIT") {
        return named.or_else(|| columns.iter().find(is_integer));
    }
    // A map of all pixels may have a column that is called so.
    named.filter(|_| is("OBJECT", "PARTIAL") && !is("INDXSCHM", "IMPLICIT"))
}

/// Resolution and order by the header, else by the number of pixels, with a note.
fn pixelization(
    table: &Unit,
    n: usize,
    is_listed: bool,
    notes: &mut Vec<String>,
) -> Result<Pixelization, ReadError> {
    let ordering = match table.text("ORDERING").map(|word| word.to_ascii_uppercase()).as_deref() {
        Some("RING") => Ordering::Ring,
        Some("NESTED" | "NEST") => Ordering::Nested,
        Some(_) => return Err(table.wrong("ORDERING", "RING or NESTED")),
        None => {
            notes.push("the header has no ORDERING; RING is assumed, as healpy does".into());
            Ordering::Ring
        }
    };
    let n_side = match table.integer("NSIDE")? {
        Some(n_side) => u64::try_from(n_side).ok(),
        None if is_listed => None,
        None => Some((n as u64 / 12).isqrt()),
    };
    let Some(n_side) = n_side.filter(|n_side| (1..=MAX_N_SIDE).contains(n_side)) else {
        return Err(table.wrong("NSIDE", &format!("a whole number from 1 to {MAX_N_SIDE}")));
    };
    if ordering == Ordering::Nested && !n_side.is_power_of_two() {
        return Err(table.wrong("NSIDE", "a power of two for the order NESTED"));
    }
    Ok(Pixelization { n_side, ordering })
}

/// Pixels of the rows: listed, all, or from FIRSTPIX to LASTPIX.
fn pixels_of_rows(
    table: &Unit,
    pixelization: Pixelization,
    n: usize,
    listed: Option<Vec<u64>>,
) -> Result<PixelNumbers, ReadError> {
    let n_pixels = pixelization.n_pixels();
    if let Some(listed) = listed {
        return PixelNumbers::new(listed, n_pixels);
    }
    if n as u64 == n_pixels {
        return Ok(PixelNumbers::All);
    }
    let first = table.integer("FIRSTPIX")?.and_then(|first| u64::try_from(first).ok());
    let last = table.integer("LASTPIX")?.and_then(|last| u64::try_from(last).ok());
    if let (Some(first), Some(last)) = (first, last)
        && last < n_pixels
        && first <= last
        && last - first + 1 == n as u64
    {
        return PixelNumbers::new((first..=last).collect(), n_pixels);
    }
    Err(ReadError::Whole(format!(
        "a HEALPix map of NSIDE {} must have 12·NSIDE² = {n_pixels} pixels, or list them, got {n}; correct NSIDE or \
         get the whole file",
        pixelization.n_side
    )))
}

/// Sentence on the places of the map and the units of its columns.
fn describe(
    table: &Unit,
    pixelization: Pixelization,
    columns: &[Column],
    fields: &[(String, usize)],
) -> String {
    let ordering = if pixelization.ordering == Ordering::Ring { "ring" } else { "nested" };
    let system = match table.text("COORDSYS").map(|word| word.to_ascii_uppercase()).as_deref() {
        Some("G") => ", galactic coordinates",
        Some("E") => ", ecliptic coordinates",
        Some("C" | "Q") => ", equatorial coordinates",
        _ => "",
    };
    let units: Vec<String> = (fields.iter())
        .filter(|(_, k)| !columns[*k].unit.is_empty())
        .map(|(name, k)| format!("{name} in {}", columns[*k].unit))
        .collect();
    let units = if units.is_empty() { String::new() } else { format!("; {}", units.join(", ")) };
    format!(
        "HEALPix map of NSIDE {}, {ordering} order{system}: places on a sphere of radius 1, where a length is an angle \
         in radians and 5deg are 5 degrees{units}",
        pixelization.n_side
    )
}

/// Warning that Q and U are no numbers of their own.
fn note_on_polarization(fields: &[(String, usize)]) -> Option<String> {
    let begins = |word: &str| fields.iter().find(|(name, _)| name.to_ascii_uppercase().starts_with(word));
    let (q, u) = begins("Q_POL").zip(begins("U_POL"))?;
    Some(format!(
        "{} and {} are components along local directions, which turn from pixel to pixel: as numbers each is smoothed by \
         itself, which differs from a beam for polarization near the poles",
        q.0, u.0
    ))
}
