//! Reader of Entwine point tiles: a folder with `ept.json`, a hierarchy in `ept-hierarchy` and a LAZ for each node in
//! `ept-data`.
//!
//! File names are built from integers only, so that nothing outside the folder is read. Source:
//! <https://entwine.io/en/latest/entwine-point-tile.html>.

use std::fs::File;
use std::path::{Path, PathBuf};

use adwave::Progress;
use rayon::prelude::*;
use serde_json::Value;

use crate::files::read::read_file;
use crate::formats::las::part::image::Image;
use crate::formats::las::part::octree::{Entry, Key, Node, Root, chosen, runs, wrong};
use crate::formats::las::part::selection::Selection;
use crate::formats::las::stream::{LasLayout, LasReader};
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// The file that says what the tiles are.
const JSON: &str = "ept.json";
/// Largest size of the points of tiles in memory, in bytes; one more tile may exceed it.
const MOST_WAITING: u64 = 1 << 26;
/// Tiles per thread in one batch.
const TILES_PER_THREAD: usize = 4;
/// Points of a tile read at a time.
const STEP: usize = 1 << 16;

/// Folder of an EPT, given the folder or its `ept.json`; `None` for other paths.
pub(crate) fn folder_of_tiles(path: &Path) -> Option<PathBuf> {
    if path.file_name().is_some_and(|name| name == JSON) {
        return Some(path.parent().unwrap_or(Path::new("")).to_path_buf());
    }
    path.join(JSON).is_file().then(|| path.to_path_buf())
}

/// Content of `ept.json`.
pub(super) struct Info {
    pub(super) root: Root,
    pub(super) bounds: Option<([f64; 3], [f64; 3])>,
    n_points: u64,
    coordinate_system: Option<String>,
}

impl Info {
    pub(super) fn read(
        folder: &Path,
        limits: &ReadLimits,
        progress: Progress<'_>,
    ) -> Result<Self, ReadError> {
        let path = folder.join(JSON);
        let read = || Self::of(&json(&read_file(&path, limits, progress)?)?);
        read().map_err(|error| error.in_file(&path))
    }

    fn of(json: &Value) -> Result<Self, ReadError> {
        let refused =
            |what: String| ReadError::Whole(format!("{what}; convert it (untwine, or pdal translate)"));
        let kind = json["dataType"].as_str().unwrap_or("none");
        if kind != "laszip" {
            return Err(refused(format!("the tiles must be of type `laszip`, got `{kind}`")));
        }
        let hierarchy = json["hierarchyType"].as_str().unwrap_or("json");
        if hierarchy != "json" {
            return Err(refused(format!("the hierarchy must be of type `json`, got `{hierarchy}`")));
        }
        let missing = |what: &str| ReadError::Whole(format!("has no {what}; get an undamaged file"));
        let (low, high) = box_of(&json["bounds"]).ok_or_else(|| missing("`bounds` of six numbers"))?;
        let span = json["span"].as_f64().ok_or_else(|| missing("`span`"))?;
        let root =
            Root { low, high, spacing: (high[0] - low[0]) / span, rounding: rounding(&json["schema"]) };
        if !root.is_valid() {
            let message =
                format!("`bounds` and the `span` {span:?} must describe an octree; get an undamaged file");
            return Err(ReadError::Whole(message));
        }
        Ok(Self {
            root,
            bounds: box_of(&json["boundsConforming"]).or(Some((low, high))),
            n_points: json["points"].as_u64().ok_or_else(|| missing("number of `points`"))?,
            coordinate_system: json["srs"]["wkt"].as_str().map(str::to_owned),
        })
    }
}

fn json(bytes: &[u8]) -> Result<Value, ReadError> {
    serde_json::from_slice(bytes).map_err(|e| {
        ReadError::Whole(format!("must be JSON ({}); get an undamaged file", crate::text::one_line(&e)))
    })
}

/// Smallest and largest coordinates.
fn box_of(json: &Value) -> Option<([f64; 3], [f64; 3])> {
    let numbers: Vec<f64> = json.as_array()?.iter().filter_map(Value::as_f64).collect();
    let (low, high) = numbers.split_first_chunk()?;
    Some((*low, high.try_into().ok()?))
}

/// Resolution of the coordinates, 0 if not stated.
fn rounding(schema: &Value) -> [f64; 3] {
    let step = |name: &str| schema.as_array()?.iter().find(|d| d["name"] == name)?["scale"].as_f64();
    ["X", "Y", "Z"].map(|name| step(name).unwrap_or(0.0))
}

/// Reads the selected part.
pub(crate) fn read_tiles(
    folder: &Path,
    selection: &Selection,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let info = Info::read(folder, limits, progress)?;
    let nodes = nodes(folder, &info, selection, limits, progress)?;
    let empty = || selection.empty(info.bounds).in_file(&folder.join(JSON));
    let Some(first) = nodes.first() else { return Err(empty()) };
    let path = tile(folder, first.key);
    let reader = LasReader::open(&path)?;
    let (head, layout) = (reader.head().0, reader.layout());
    let image = File::open(&path)
        .map_err(ReadError::Io)
        .and_then(|mut file| Image::new(head, &mut file, limits, progress));
    let mut image = image.map_err(|error| error.in_file(&path))?;
    if let Some(text) = &info.coordinate_system {
        image.add_coordinate_system(text);
    }
    let (size, n) = (layout.record_bytes as u64, nodes.len() as u64);
    let most = TILES_PER_THREAD * rayon::current_num_threads().max(1);
    let mut done = 0;
    for run in runs(&nodes, most, MOST_WAITING, |node| node.n_points.saturating_mul(size)) {
        progress.step(done, n)?;
        let tiles: Vec<_> = run
            .par_iter()
            .map(|node| {
                let path = tile(folder, node.key);
                let mut reader = LasReader::open(&path)?;
                check_tile(&reader, layout, node).map_err(|error| error.in_file(&path))?;
                records(&mut reader, selection, limits, progress)
            })
            .collect();
        tiles.into_iter().try_for_each(|rows: Result<_, ReadError>| image.add(&rows?))?;
        done += run.len() as u64;
    }
    if image.is_empty() {
        return Err(empty());
    }
    image.into_shape(Format::EPT, limits, progress)
}

/// The LAZ of a node.
fn tile(folder: &Path, key: Key) -> PathBuf {
    folder.join("ept-data").join(format!("{key}.laz"))
}

/// Checks that a tile has the same kind of points as the first one, and the number of points stated by the hierarchy.
fn check_tile(reader: &LasReader, first: &LasLayout, node: &Node<()>) -> Result<(), ReadError> {
    let own = reader.layout();
    let kind = |l: &LasLayout| (l.format, l.record_bytes, l.scale, l.offset);
    if kind(own) != kind(first) {
        let what = "its points differ from those of the first tile in format, scale or offset; create the \
                   tiles again";
        return Err(ReadError::Whole(what.into()));
    }
    if own.n_points != node.n_points {
        let (has, said) = (own.n_points, node.n_points);
        return Err(ReadError::Whole(format!(
            "has {has} points, but the hierarchy states {said}; create the tiles again"
        )));
    }
    Ok(())
}

/// Reads the selected records of a tile.
fn records(
    reader: &mut LasReader,
    selection: &Selection,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<u8>, ReadError> {
    let (mut kept, mut rows) = (Vec::new(), Vec::new());
    loop {
        progress.check()?;
        rows.clear();
        if reader.read(STEP, &mut rows)? == 0 {
            return Ok(kept);
        }
        selection.retain(&mut rows, reader.head().1);
        limits.check_bytes((kept.len() + rows.len()) as u64)?;
        kept.extend_from_slice(&rows);
    }
}

/// Selected nodes, in order.
pub(super) fn nodes(
    folder: &Path,
    info: &Info,
    selection: &Selection,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<Node<()>>, ReadError> {
    let mut n_bytes = 0;
    let page = |own: Key, ()| {
        let path = folder.join("ept-hierarchy").join(format!("{own}.json"));
        let mut read = || {
            let bytes = read_file(&path, limits, progress)?;
            n_bytes += bytes.len() as u64;
            limits.check_bytes(n_bytes)?;
            entries(&json(&bytes)?)
        };
        read().map_err(|error| error.in_file(&path))
    };
    let nodes = chosen(&info.root, selection, info.n_points, (), page, progress);
    nodes.map_err(|error| super::named(error, &folder.join("ept-hierarchy")))
}

/// Entries of a file of the hierarchy.
fn entries(json: &Value) -> Result<Vec<Entry<()>>, ReadError> {
    let broken = |what: String| ReadError::Whole(format!("{what}; get an undamaged file"));
    let listed = json.as_object().ok_or_else(|| broken("must be a list of nodes".into()))?;
    let entry = |(name, count): (&String, &Value)| {
        let numbers: Vec<i64> = name.split('-').filter_map(|word| word.parse().ok()).collect();
        let key =
            <[i64; 4]>::try_from(numbers).ok().and_then(Key::new).filter(|key| key.to_string() == *name);
        let name = || crate::text::show(name.as_bytes());
        let key = key.ok_or_else(|| broken(format!("{} must name a node D-X-Y-Z", name())))?;
        let count = count.as_i64().ok_or_else(|| wrong(key, "must have an integer number of points"))?;
        Ok(Entry { key, count, place: () })
    };
    listed.iter().map(entry).collect()
}
