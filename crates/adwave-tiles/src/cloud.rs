//! Clouds: their files, what a point becomes, and tiles that are joined.

use std::path::{Path, PathBuf};

use adwave::Progress;
use adwave_io::{LasReader, LasWriter};
use rayon::prelude::*;

use crate::TilesError;
use crate::layout::{Layout, Steps, set_whole, whole};
use crate::outputs::Outputs;
use crate::plan::{Input, Params, Plan};

/// The work on some files, not yet cut into tiles; `None` where there are no files.
pub(crate) fn planned(inputs: &[PathBuf], params: &Params) -> Result<Option<Plan>, TilesError> {
    let mut plan: Option<Plan> = None;
    for path in inputs {
        let reader = LasReader::open(path)?;
        let bytes = std::fs::metadata(path).map_err(TilesError::io(path))?.len();
        let las = reader.layout();
        let layout = Steps {
            format: las.format,
            record_bytes: las.record_bytes,
            scale: las.scale,
            offset: las.offset,
        };
        let path = std::path::absolute(path).map_err(TilesError::io(path))?;
        let named = |what: &str| TilesError::Input(format!("{}: {what}", path.display()));
        if !layout.scale.iter().all(|s| s.is_normal() && s.abs() < 1e40)
            || !layout.offset.iter().all(|o| o.abs() < 1e50)
        {
            return Err(named("its scale or offset is no number to measure by; get an unbroken file"));
        }
        let first = plan.get_or_insert_with(|| Plan {
            inputs: Vec::new(),
            layout: Layout::Las(layout),
            bounds: ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]),
            params: params.clone(),
            blocks_per_tile: 0,
            n_points: 0,
            n_faces: 0,
        });
        let Layout::Las(of_first) = first.layout else { return Err(named("it is no cloud")) };
        if (layout.format, layout.record_bytes, layout.scale)
            != (of_first.format, of_first.record_bytes, of_first.scale)
        {
            return Err(named(
                "its point format, record length or scale is not that of the first file; convert one of them, or work on them apart",
            ));
        }
        let mut shift = [0; 3];
        for (c, shift) in shift.iter_mut().enumerate() {
            let steps = (layout.offset[c] - of_first.offset[c]) / layout.scale[c];
            // Whole steps, or the points would be rounded.
            if (steps - steps.round()).abs() > 1e-4 || steps.abs() > 4.5e9 {
                return Err(named(
                    "its offset is no whole number of steps from that of the first file; give all files one offset",
                ));
            }
            *shift = steps.round() as i64;
        }
        let (least, most) = (f64::from(i32::MIN), f64::from(i32::MAX));
        let clamped = |v: f64| v.clamp(least, most);
        let steps = |c: usize, v: f64| clamped(((v - of_first.offset[c]) / layout.scale[c]).round());
        let (lo, hi) = las.bounds.map_or(([least; 3], [most; 3]), |(lo, hi)| {
            (std::array::from_fn(|c| steps(c, lo[c])), std::array::from_fn(|c| steps(c, hi[c])))
        });
        if las.n_points > 0 {
            for c in 0..3 {
                first.bounds.0[c] = first.bounds.0[c].min(lo[c].min(hi[c]));
                first.bounds.1[c] = first.bounds.1[c].max(lo[c].max(hi[c]));
            }
        }
        first.n_points = first.n_points.saturating_add(las.n_points);
        first.inputs.push(Input { path, bytes, n_points: las.n_points, shift });
    }
    Ok(plan)
}

/// The records of all inputs, one after the other, without those before the point `first`.
pub(crate) fn records(
    inputs: &[Input],
    steps: Steps,
    mut first: u64,
) -> impl FnMut(usize, &mut Vec<u8>) -> Result<usize, TilesError> {
    let mut inputs = inputs.iter();
    let mut open_one: Option<(LasReader, &Input)> = None;
    move |most, held| {
        loop {
            let Some((reader, input)) = &mut open_one else {
                let Some(input) = inputs.next() else { return Ok(0) };
                let mut reader = open(input)?;
                if first < input.n_points {
                    reader.skip(std::mem::take(&mut first))?;
                    open_one = Some((reader, input));
                } else {
                    first -= input.n_points;
                }
                continue;
            };
            let start = held.len();
            let n = reader.read(most, held)?;
            if n > 0 {
                shift(&mut held[start..], steps.record_bytes, input)?;
                return Ok(n);
            }
            open_one = None;
        }
    }
}

/// Asks of all inputs whether they are still the same.
pub(crate) fn check(inputs: &[Input]) -> Result<(), TilesError> {
    inputs.iter().try_for_each(|input| open(input).map(drop))
}

/// Opens an input and asks whether it is still the same.
fn open(input: &Input) -> Result<LasReader, TilesError> {
    let reader = LasReader::open(&input.path)?;
    let bytes = std::fs::metadata(&input.path).map_err(TilesError::io(&input.path))?.len();
    if bytes != input.bytes || reader.layout().n_points != input.n_points {
        return Err(TilesError::Input(format!(
            "{} has changed since the work began; delete the folder and begin anew",
            input.path.display()
        )));
    }
    Ok(reader)
}

/// Coordinates as steps from the offset that all inputs share.
fn shift(records: &mut [u8], bytes: usize, input: &Input) -> Result<(), TilesError> {
    if input.shift == [0; 3] {
        return Ok(());
    }
    let shifted = |record: &mut [u8]| {
        let own = whole(record);
        let mut moved = [0; 3];
        for c in 0..3 {
            moved[c] = i32::try_from(i64::from(own[c]) + input.shift[c]).ok()?;
        }
        set_whole(record, moved);
        Some(())
    };
    if records.par_chunks_exact_mut(bytes).any(|record| shifted(record).is_none()) {
        return Err(TilesError::Input(format!(
            "{}: its points are too far from those of the first file for coordinates of 32 bits; split the work",
            input.path.display()
        )));
    }
    Ok(())
}

/// A file for points as they come out.
pub(crate) fn writer(plan: &Plan, path: &Path) -> Result<LasWriter, TilesError> {
    let like = LasReader::open(&plan.inputs[0].path)?;
    Ok(LasWriter::create(path, &like, &plan.params.fields(), None)?)
}

/// The points of a block as they come out.
pub(crate) fn records_of_block(
    plan: &Plan,
    layout: Steps,
    records: &[u8],
    points: &[[f64; 3]],
    outs: &Outputs<'_>,
) -> Result<Vec<u8>, TilesError> {
    let n = records.len() / layout.record_bytes;
    let mut made = Vec::with_capacity(records.len() + plan.params.field_bytes() * n);
    let (mut vertex, mut last) = (0, None);
    for record in records.chunks_exact(layout.record_bytes) {
        let here = whole(record);
        vertex += usize::from(last.is_some_and(|last| last != here));
        last = Some(here);
        let start = made.len();
        made.extend_from_slice(record);
        if let Some(change) = outs.change.map(|change| change[vertex]) {
            let moved: [f64; 3] = std::array::from_fn(|c| points[vertex][c] + change[c]);
            let Some(whole) = layout.nearest(moved) else {
                return Err(TilesError::Input(format!(
                    "a point would move to {moved:?}, which 32-bit coordinates of this scale do not reach; use smaller gains"
                )));
            };
            set_whole(&mut made[start..], whole);
        }
        outs.push_fields(vertex, &mut made);
    }
    Ok(made)
}

/// Records that are joined at a time.
const JOINED_AT_A_TIME: usize = 1 << 19;

/// All tiles as one file, in the order of the curve.
pub(crate) fn join(
    plan: &Plan,
    tiles: &[PathBuf],
    path: &Path,
    progress: Progress<'_>,
) -> Result<(), TilesError> {
    let mut writer = writer(plan, path)?;
    let mut records = Vec::new();
    let mut n = 0;
    for tile in tiles {
        let mut reader = LasReader::open(tile)?;
        loop {
            progress.step(n, plan.n_points)?;
            records.clear();
            let read = reader.read(JOINED_AT_A_TIME, &mut records)?;
            if read == 0 {
                break;
            }
            n += read as u64;
            writer.write(&records)?;
        }
    }
    if n != plan.n_points {
        return Err(TilesError::Input(format!(
            "the tiles have {n} points of {}; delete the folder and begin anew",
            plan.n_points
        )));
    }
    Ok(writer.finish()?)
}
