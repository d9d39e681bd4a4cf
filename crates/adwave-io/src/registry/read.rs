//! Reading a shape from a file or from bytes.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use adwave::{Cancelled, Progress};
use rayon::prelude::*;

use crate::formats::las::part::{Selection, folder_of_tiles, read_tiles};
use crate::limits::decompress;
use crate::progress::BYTES_PER_STEP;
use crate::registry::sniff::sniff;
use crate::{Format, ReadError, ReadLimits, ShapeFile};

/// Reads the shape in a file, compressed by gzip or not. The content decides the format, the name only where the
/// content leaves it open. A folder with an `ept.json`, or that file, is read as an EPT; for a part of one see
/// [`read_cloud_part`](crate::read_cloud_part).
///
/// # Errors
/// One line that begins with the file's name: the file cannot be read, its format is unknown, it is malformed (with
/// line or byte), or it is larger than the limits.
pub fn read_path(path: &Path, limits: &ReadLimits) -> Result<ShapeFile, ReadError> {
    read_path_with(path, limits, Progress::none())
}

/// [`read_path`] with cancellation and progress: in bytes while the file is read, then in rows while it is parsed.
///
/// # Errors
/// The errors of [`read_path`], and [`ReadError::Cancelled`] soon after the cancellation.
pub fn read_path_with(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    if let Some(folder) = folder_of_tiles(path) {
        let mut shape = read_tiles(&folder, &Selection::whole(), limits, progress)?;
        shape.n_original_fields = shape.vertex_fields.len();
        return Ok(shape);
    }
    read_file(path, limits, progress)
        .and_then(|bytes| read_named(bytes, Some(&path.to_string_lossy()), path.parent(), limits, progress))
        .map_err(|e| e.in_file(path))
}

/// The bytes of a file, no more than the limit. A pipe is read to its end.
pub(crate) fn read_file(
    path: &Path,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<Vec<u8>, ReadError> {
    let mut file = File::open(path)?;
    let metadata = file.metadata()?;
    if metadata.is_dir() {
        return Err(ReadError::Whole("is a folder; give a file".into()));
    }
    limits.check_bytes(metadata.len())?;
    let total = metadata.len();
    let mut bytes = read_at_once(&file, if metadata.is_file() { total } else { 0 }, progress)?;
    if bytes.is_empty() {
        bytes.reserve_exact(total as usize);
    } else {
        io::Seek::seek(&mut file, io::SeekFrom::Start(total))?;
    }
    // What is left: all of it, or what was added since its length was asked for.
    let most = limits.max_bytes.saturating_add(1);
    loop {
        let before = bytes.len();
        let step = (most - before as u64).min(BYTES_PER_STEP as u64);
        (&file).take(step).read_to_end(&mut bytes)?;
        progress.step(bytes.len() as u64, total.max(bytes.len() as u64))?;
        if bytes.len() == before || bytes.len() as u64 == most {
            break;
        }
    }
    limits.check_bytes(bytes.len() as u64)?;
    Ok(bytes)
}

/// Shorter files are read by one thread.
const LARGE: u64 = 1 << 22;

/// The first `n` bytes of a large regular file, by all threads: making room for fresh memory takes longer than copying into
/// it. Nothing where the file is small, has become shorter, or the system has no reads at a position.
fn read_at_once(file: &File, n: u64, progress: Progress<'_>) -> Result<Vec<u8>, ReadError> {
    if n < LARGE {
        return Ok(Vec::new());
    }
    let mut bytes = vec![0; n as usize];
    let read = bytes.par_chunks_mut(BYTES_PER_STEP).enumerate().try_for_each(|(k, chunk)| {
        progress.check()?;
        read_exact_at(file, chunk, (k * BYTES_PER_STEP) as u64).map_err(ReadError::Io)
    });
    match read {
        Ok(()) => Ok(bytes),
        Err(ReadError::Cancelled(_)) => Err(Cancelled.into()),
        // The plain way meets the same error again if it is one.
        Err(_) => Ok(Vec::new()),
    }
}

#[cfg(unix)]
fn read_exact_at(file: &File, bytes: &mut [u8], at: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, at)
}

#[cfg(not(unix))]
fn read_exact_at(_: &File, _: &mut [u8], _: u64) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Reads the shape in bytes, compressed by gzip or not. `name_hint` is a file name that the content overrules.
///
/// # Errors
/// As [`read_path`], without the file's name.
pub fn read_bytes(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    limits: &ReadLimits,
) -> Result<ShapeFile, ReadError> {
    read_bytes_with(bytes, name_hint, limits, Progress::none())
}

/// [`read_bytes`] with progress and cancellation.
///
/// # Errors
/// The errors of [`read_bytes`], and [`ReadError::Cancelled`] soon after the cancellation.
pub fn read_bytes_with(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    read_named(bytes, name_hint, None, limits, progress)
}

/// Reads the shape in bytes. External files are read from the folder, if there is one.
fn read_named(
    bytes: Vec<u8>,
    name_hint: Option<&str>,
    folder: Option<&Path>,
    limits: &ReadLimits,
    progress: Progress<'_>,
) -> Result<ShapeFile, ReadError> {
    let mut bytes = decompress(bytes, limits, progress)?;
    if let Some(text) = crate::text::encoding::from_utf16(&bytes)
        && !text.contains(&0)
    {
        bytes = text;
    }
    let mut format = sniff(&bytes, name_hint)?;
    if is_text(format, &bytes) && old_line_ends(&mut bytes, progress)? {
        // What was one long remark may be rows now.
        format = sniff(&bytes, name_hint)?;
    }
    let mut shape = match format.family() {
        Format::Obj => crate::formats::obj::read::read_obj(bytes, limits, progress),
        Format::Ply => crate::formats::ply::read::read_ply(bytes, limits, progress),
        Format::Off => crate::formats::off::read::read_off(bytes, limits, progress),
        Format::Stl if format == Format::StlAscii => {
            crate::formats::stl::read::read_stl_ascii(&bytes, limits, progress)
        }
        Format::Stl => crate::formats::stl::read::read_stl(&bytes, limits, progress),
        Format::Xyz | Format::Pts | Format::Csv => {
            crate::formats::columns::read::read_columns(bytes, limits, name_hint, progress)
        }
        Format::Pcd => crate::formats::pcd::read::read_pcd(bytes, limits, progress),
        Format::Las | Format::Laz => crate::formats::las::read::read_las(bytes, limits, progress),
        Format::Gifti => crate::formats::gifti::read::read_gifti(bytes, folder, limits, progress),
        Format::E57 => crate::formats::e57::read::read_e57(bytes, limits, progress),
        Format::Glb | Format::Gltf => crate::formats::gltf::read::read_gltf(bytes, folder, limits, progress),
        Format::Msh => crate::formats::msh::read::read_msh(bytes, limits, progress),
        Format::Medit => crate::formats::medit::read::read_medit(bytes, limits, progress),
        Format::MeditBinary => crate::formats::medit::binary::read_meshb(bytes, limits, progress),
        Format::Amf => crate::formats::amf::read::read_amf(bytes, limits, progress),
        Format::ThreeMf => crate::formats::threemf::read::read_3mf(&bytes, limits, progress),
        Format::Dmat => crate::formats::dmat::read::read_dmat(&bytes, limits, progress),
        Format::Tgf => crate::formats::graph::tgf::read_tgf(&bytes, limits, progress),
        Format::EdgeList => crate::formats::graph::edge_list::read_edge_list(&bytes, limits, progress),
        Format::GraphMl => crate::formats::graph::graphml::read_graphml(bytes, limits, progress),
        Format::Geomview => crate::formats::geomview::read::read_geomview(&bytes, limits, progress),
        Format::Mtx => crate::formats::mtx::read::read_mtx(&bytes, limits, progress),
        Format::Vtp | Format::Vtu | Format::Vti | Format::Vtr | Format::Vts => {
            crate::formats::vtk_xml::read::read_vtk_xml(&bytes, format, limits, progress)
        }
        Format::FreeSurfer => {
            crate::formats::freesurfer::read::read_surface(&bytes, name_hint, limits, progress)
        }
        Format::Vtk => crate::formats::vtk_legacy::read::read_vtk(&bytes, limits, progress),
        _ => Err(ReadError::UnknownFormat { found: format!("{format} is written only") }),
    }?;
    shape.n_original_fields = shape.vertex_fields.len();
    Ok(shape)
}

fn is_text(format: Format, bytes: &[u8]) -> bool {
    let text = matches!(
        format,
        Format::Obj
            | Format::Off
            | Format::StlAscii
            | Format::Xyz
            | Format::Pts
            | Format::Csv
            | Format::Mtx
            | Format::Tgf
            | Format::EdgeList
    );
    text || (format == Format::Ply && bytes.starts_with(b"ply\rformat ascii"))
}

/// Lines that end with a carriage return alone (before 2001 on the Macintosh) get line feeds instead; whether there were any.
fn old_line_ends(bytes: &mut [u8], progress: Progress<'_>) -> Result<bool, Cancelled> {
    for chunk in bytes.chunks(BYTES_PER_STEP) {
        progress.check()?;
        if memchr::memchr(b'\n', chunk).is_some() {
            return Ok(false);
        }
    }
    let mut is_changed = false;
    for chunk in bytes.chunks_mut(BYTES_PER_STEP) {
        progress.check()?;
        for b in chunk {
            if *b == b'\r' {
                *b = b'\n';
                is_changed = true;
            }
        }
    }
    Ok(is_changed)
}
