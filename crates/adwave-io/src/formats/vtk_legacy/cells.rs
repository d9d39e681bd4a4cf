//! Lists of cells: counts and corners in one list, or since version 5.1 in two lists.

use crate::ReadError;
use crate::model::cells::{CellKind, Cells};
use crate::model::numbers::{NoIndex, Numbers};
use crate::progress::{all, at_row, collect};

use super::scanner::{ArrayType, Scanner};
use crate::ValueType;

/// Reads the cells after their two counts.
pub(super) fn read_cells(
    file: &mut Scanner<'_>,
    kind: CellKind,
    n_points: usize,
    keyword_at: usize,
) -> Result<Cells, ReadError> {
    let n = file.count("the number of cells")?;
    let size = file.count("the number of corners")?;
    if n.max(size) >= u32::MAX.into() {
        return Err(ReadError::Limit {
            what: "corners of cells",
            found: n.max(size),
            limit: u32::MAX.into(),
        });
    }
    let progress = file.progress;
    if file.pass("OFFSETS") {
        let array_type = file.array_type()?;
        let offsets = file.array(n, array_type, "offsets of cells")?;
        if !file.pass("CONNECTIVITY") {
            return Err(file.error(file.at, "CONNECTIVITY is missing after OFFSETS; save the file again"));
        }
        let array_type = file.array_type()?;
        let corners = file.array(size, array_type, "corners of cells")?;
        let offsets = offsets
            .to_indices(size as u32 + 1, progress)
            .map_err(|e| no_index(file, keyword_at, "offset", e, size))?;
        let grows = all(offsets.len().saturating_sub(1), progress, |i| offsets[i] <= offsets[i + 1])?;
        if offsets.is_empty() && size == 0 {
            return Ok(Cells { kind, offsets: vec![0], corners: Vec::new(), polyhedra: None });
        }
        if !grows || offsets.first() != Some(&0) || offsets.last() != Some(&(size as u32)) {
            let message = format!("the offsets of cells must ascend from 0 to {size}; save the file again");
            return Err(file.error(keyword_at, message));
        }
        let corners = corners
            .to_indices(n_points as u32, progress)
            .map_err(|e| face_index(file, keyword_at, &offsets, e, n_points))?;
        return Ok(Cells { kind, offsets, corners, polyhedra: None });
    }
    let list = file.array(size, ArrayType::Numbers(ValueType::I32), "cells")?;
    mixed(file, &list, n as usize, kind, n_points, keyword_at)
}

/// Converts a list in which each cell begins with its number of corners.
fn mixed(
    file: &Scanner<'_>,
    list: &Numbers<'_>,
    n: usize,
    kind: CellKind,
    n_points: usize,
    keyword_at: usize,
) -> Result<Cells, ReadError> {
    let progress = file.progress;
    let list = list
        .to_indices(u32::MAX, progress)
        .map_err(|e| no_index(file, keyword_at, "number", e, n_points as u64))?;
    let broken = |i: usize| {
        let message = format!("the cells end in cell {i} of {n}; save the file again");
        Err(file.error(keyword_at, message))
    };
    let mut offsets = Vec::new();
    let mut corners = Vec::new();
    let width = list.len().checked_div(n).unwrap_or(0);
    let is_even = width > 0 && width * n == list.len();
    if is_even && all(n, progress, |i| list[i * width] as usize + 1 == width)? {
        let k = width - 1;
        offsets = collect(n + 1, progress, |i| (i * k) as u32)?;
        corners = collect(n * k, progress, |c| list[c / k * width + 1 + c % k])?;
    } else {
        offsets.push(0);
        let mut at = 0;
        for i in 0..n {
            at_row(progress, i as u64, n as u64)?;
            let Some(&count) = list.get(at) else { return broken(i) };
            let Some(cell) = list.get(at + 1..).and_then(|rest| rest.get(..count as usize)) else {
                return broken(i);
            };
            corners.extend_from_slice(cell);
            offsets.push(corners.len() as u32);
            at += 1 + count as usize;
        }
    }
    let limit = n_points as u32;
    if !all(corners.len(), progress, |k| corners[k] < limit)? {
        let at = corners.iter().position(|&v| v >= limit).unwrap_or(0);
        let error = NoIndex::At(at, corners[at].into());
        return Err(face_index(file, keyword_at, &offsets, error, n_points));
    }
    Ok(Cells { kind, offsets, corners, polyhedra: None })
}

fn no_index(file: &Scanner<'_>, at: usize, what: &str, error: NoIndex, limit: u64) -> ReadError {
    let message = match error {
        NoIndex::Cancelled => return adwave::Cancelled.into(),
        NoIndex::Fractions => format!("each {what} of the cells must be an integer"),
        NoIndex::At(i, x) => format!("{what} {i} of the cells must be below {limit}, got {x}; correct it"),
    };
    file.error(at, message)
}

fn face_index(file: &Scanner<'_>, at: usize, offsets: &[u32], error: NoIndex, n_points: usize) -> ReadError {
    let NoIndex::At(k, index) = error else {
        return no_index(file, at, "corner", error, n_points as u64);
    };
    let place = if file.is_binary {
        format!("byte {at}")
    } else {
        format!("line {}", crate::text::line_of(file.bytes, at))
    };
    ReadError::FaceIndex {
        place,
        face: offsets.partition_point(|&start| start as usize <= k).saturating_sub(1) as u64,
        index: index as i64,
        n_vertices: n_points as u64,
    }
}
