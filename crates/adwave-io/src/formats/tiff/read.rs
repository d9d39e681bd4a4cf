//! TIFF reader.

use std::sync::Arc;

use super::geo::layout;
use super::page::{Page, fill_of};
use super::tags::{self, Container, Directory};
use super::write::TiffDocument;
use crate::model::context::ReadContext;
use crate::model::grid_layout::note_on_missing;
use crate::model::grid_values::GridNumbers;
use crate::{Format, ReadError, ShapeFile};

/// Bits of the kind of a page: a smaller copy of another one, or its mask.
const IS_COPY_OR_MASK: u64 = 1 | 4;
/// Colors by a palette.
const PALETTE: u64 = 3;
/// Numbers whose least value is white.
const WHITE_IS_ZERO: u64 = 0;

/// Pages that are the image or the stack: those like the first one.
pub(super) struct Stack {
    /// Index of each page among the directories.
    pub(super) indices: Vec<usize>,
    pub(super) pages: Vec<Page>,
    /// Pages that are smaller copies or masks.
    pub(super) n_copies: usize,
    /// Pages of another size or type.
    pub(super) n_others: usize,
}

impl Stack {
    pub(super) fn parse(container: &Container<'_>, directories: &[Directory]) -> Result<Self, ReadError> {
        let (mut stack, mut first_error) =
            (Self { indices: Vec::new(), pages: Vec::new(), n_copies: 0, n_others: 0 }, None);
        for (index, directory) in directories.iter().enumerate() {
            if container.count(directory, tags::SUBFILE).unwrap_or(0) & IS_COPY_OR_MASK != 0
                && directories.len() > 1
            {
                stack.n_copies += 1;
                continue;
            }
            match Page::parse(container, directory) {
                Ok(page) if stack.pages.first().is_none_or(|first| first.kind == page.kind) => {
                    stack.indices.push(index);
                    stack.pages.push(page);
                }
                Ok(_) => stack.n_others += 1,
                Err(error) if stack.pages.is_empty() => first_error = first_error.or(Some(error)),
                Err(error) => return Err(error),
            }
        }
        if stack.n_others > 0 {
            // A series of different pages is no stack: the first one alone is the image.
            stack.n_others += stack.pages.len() - 1;
            stack.pages.truncate(1);
            stack.indices.truncate(1);
        }
        match (stack.pages.is_empty(), first_error) {
            (true, Some(error)) => Err(error),
            (true, None) => {
                Err(ReadError::Whole("the file has no page with an image; get an intact file".into()))
            }
            _ => Ok(stack),
        }
    }

    /// Numbers of all pages, one after another.
    pub(super) fn numbers(&self, container: &Container<'_>, directory: &Directory) -> GridNumbers {
        let kind = &self.pages[0].kind;
        let n_places = self.pages.len() * kind.width * kind.height;
        GridNumbers {
            missing: missing(container, directory),
            ..GridNumbers::new(kind.kind, container.order, n_places, kind.n_samples)
        }
    }

    /// Bytes of all numbers, in the byte order of the file.
    pub(super) fn decode(
        &self,
        container: &Container<'_>,
        numbers: &GridNumbers,
    ) -> Result<Vec<u8>, ReadError> {
        let fill = fill_of(numbers.kind, numbers.order, numbers.missing);
        let mut all = Vec::new();
        for page in &self.pages {
            all.append(&mut page.decode(container.bytes, container.order, &fill)?);
        }
        Ok(all)
    }
}

/// Number that means no data, as GDAL states it.
fn missing(container: &Container<'_>, directory: &Directory) -> Option<f64> {
    container.text(directory, tags::NODATA)?.trim().parse().ok()
}

pub(super) fn read_tiff(bytes: Vec<u8>, c: &ReadContext<'_>) -> Result<ShapeFile, ReadError> {
    let container = Container::open(&bytes)?;
    let directories = container.directories()?;
    let stack = Stack::parse(&container, &directories)?;
    let directory = &directories[stack.indices[0]];
    let numbers = stack.numbers(&container, directory);
    c.limits.check_points(numbers.n_places as u64)?;
    c.limits.check_bytes(numbers.n_bytes().map_or(u64::MAX, |n| n as u64))?;
    c.progress.check()?;
    let values = numbers.read(&stack.decode(&container, &numbers)?, c.progress)?;
    let kind = &stack.pages[0].kind;
    let mut sizes = vec![kind.height, kind.width];
    if stack.pages.len() > 1 {
        sizes.insert(0, stack.pages.len());
    }
    let mut notes = Vec::new();
    match container.count(directory, tags::PHOTOMETRIC) {
        Some(PALETTE) => notes.push("values are numbers of the colors in a palette".into()),
        Some(WHITE_IS_ZERO) => {
            notes.push("0 is white in this file; the numbers are as they are stored".into());
        }
        _ => {}
    }
    if stack.n_others > 0 {
        notes.push(format!(
            "the pages differ in size or type: only the first is read, without {} others; save them as files of their own",
            stack.n_others
        ));
    }
    let (mut layout, system) = layout(&container, directory, &sizes, &mut notes);
    layout.kept = values.kept;
    let missing = container.text(directory, tags::NODATA);
    note_on_missing(&layout, missing.as_deref().map(str::trim), &mut notes);
    let mut shape = ShapeFile::from_grid(layout).map_err(|e| ReadError::Whole(e.to_string()))?;
    shape.vertex_fields.push(values.field);
    shape.format = Some(Format::TIFF);
    shape.coordinate_system = system.map(Arc::new);
    shape.notes = notes;
    shape.original = Some(Arc::new(TiffDocument { bytes }));
    Ok(shape)
}
