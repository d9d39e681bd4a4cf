//! Fields as tables.

use std::io::Write;
use std::path::Path;

use adwave::Progress;
use flate2::Compression;
use flate2::write::GzEncoder;

use super::read::number;
use crate::model::grouping::column_names;
use crate::progress::report_row;
use crate::text::csv::push_csv_row;
use crate::{Field, WriteError, atomic_write_with};

/// Writes fields as a table: a row of names (`heat`; for several channels `flow_x` or `hks_0`), then one row per
/// vertex. `.gz` after the extension compresses.
///
/// # Errors
/// The errors of [`atomic_write`](crate::atomic_write), and [`WriteError::ArrayShape`] if the fields differ in the
/// number of rows.
pub fn write_csv_fields(path: &Path, fields: &[Field]) -> Result<(), WriteError> {
    write_csv_fields_with(path, fields, Progress::none())
}

/// [`write_csv_fields`] with cancellation.
///
/// # Errors
/// The errors of [`write_csv_fields`], and [`WriteError::Cancelled`].
pub fn write_csv_fields_with(
    path: &Path,
    fields: &[Field],
    progress: Progress<'_>,
) -> Result<(), WriteError> {
    let n = fields.first().map_or(0, Field::len);
    if let Some(other) = fields.iter().find(|field| field.len() != n) {
        let (name, found) = (other.name.clone(), other.values.len() as u64);
        return Err(WriteError::ArrayShape { name, found, shape: vec![n, other.n_channels] }.in_file(path));
    }
    atomic_write_with(path, progress, |out| {
        if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
            return write_rows(n, fields, progress, out);
        }
        let mut gz = GzEncoder::new(out, Compression::default());
        write_rows(n, fields, progress, &mut gz)?;
        gz.finish()?;
        Ok(())
    })
}

fn write_rows(
    n: usize,
    fields: &[Field],
    progress: Progress<'_>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut names = String::new();
    let own = |field: &Field| {
        if field.n_channels == 1 { vec![field.name.clone()] } else { column_names(field) }
    };
    // A row of names that are numbers would be read as values.
    let no_number =
        |name: String| if number(name.as_bytes()).is_some() { format!("field_{name}") } else { name };
    push_csv_row(&mut names, fields.iter().flat_map(own).map(no_number));
    out.write_all(names.as_bytes())?;
    let mut row = Vec::new();
    for i in 0..n {
        report_row(progress, i as u64, n as u64)?;
        row.clear();
        for (field, c) in fields.iter().flat_map(|field| (0..field.n_channels).map(move |c| (field, c))) {
            field.values.write_text(i * field.n_channels + c, &mut row);
            row.push(b',');
        }
        row.pop();
        row.push(b'\n');
        out.write_all(&row)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::csv::csv_number;

    #[test]
    fn a_table_that_is_no_longer_wanted_is_not_written() {
        let path = std::env::temp_dir().join(format!("adwave-table-{}.csv", std::process::id()));
        let field = Field::new("heat", 1, crate::FieldValues::F64(vec![0.5; 100]));
        let stop = std::sync::atomic::AtomicBool::new(true);
        let result = write_csv_fields_with(&path, &[field], Progress::none().with_cancel(&stop));
        assert_eq!(adwave::ClassifiedError::kind(&result.unwrap_err()), adwave::ErrorKind::Cancelled);
        assert!(!path.exists());
    }

    #[test]
    fn what_is_written_is_read_back() {
        let values = [0.1, -0.0, 1e300, f64::NAN];
        let mut text = String::new();
        push_csv_row(&mut text, ["the \"first\", and only"]);
        for x in values {
            push_csv_row(&mut text, [csv_number(x)]);
        }
        let fields = crate::parse_csv_fields(text.as_bytes(), &crate::ReadLimits::default()).unwrap();
        assert_eq!(fields[0].name, "the \"first\", and only");
        let read = fields[0].to_f64();
        assert_eq!(
            read[..3].iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
            values[..3].iter().map(|x| x.to_bits()).collect::<Vec<_>>()
        );
        assert!(read[3].is_nan());
    }
}
