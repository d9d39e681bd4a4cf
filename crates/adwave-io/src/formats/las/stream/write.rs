//! Writing of LAS and LAZ points in blocks.

use crate::formats::las::{LAS, LAZ};
use crate::model::format_descriptor::FormatDescriptor;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use adwave::Progress;

use crate::files::atomic::Pending;
use crate::formats::las::counts::{Counts, has_long_counts};
use crate::formats::las::fields::record_bytes;
use crate::formats::las::places::ExtraList;
use crate::formats::las::read::{Header, RECORD_HEAD, Record, is_copc_record, records, u64_at};
use crate::formats::las::stream::pack::Packer;
use crate::formats::las::stream::{LasLayout, LasReader};
use crate::formats::las::write::{
    COMPRESSED, compression_record, is_provenance, new_header, provenance_record, put,
};
use crate::{Format, Provenance, ValueType, WriteError};

/// Size of the head of an extended record, which follows the points, in bytes.
const EXTENDED_HEAD: usize = 60;
/// Largest number of extended records that are examined.
const MOST_EXTENDED: u32 = 1 << 16;
/// Number of the record with wave packets.
const WAVE_PACKETS: u16 = 65535;

/// Writer of a LAS or LAZ in blocks, with the header and the records of a template file and additional fields.
///
/// The file appears under its name when it is [finished](Self::finish). Until then an older file of that name is
/// unchanged, and dropping the writer leaves no file behind.
///
/// ```
/// use adwave_io::{LasLayout, LasReader, LasWriter};
/// let folder = tempfile::tempdir().unwrap();
/// let path = folder.path().join("a.laz");
/// let layout =
///     LasLayout { format: 6, record_bytes: 30, scale: [0.01; 3], offset: [0.0; 3], n_points: 0, bounds: None };
/// let mut writer = LasWriter::new(&path, &layout, &["height".into()], None).unwrap();
/// let mut record = vec![0; 34];
/// record[..4].copy_from_slice(&150_i32.to_le_bytes());
/// record[30..].copy_from_slice(&2.5_f32.to_le_bytes());
/// writer.write(&record).unwrap();
/// writer.finish().unwrap();
/// let reader = LasReader::open(&path).unwrap();
/// assert_eq!(reader.layout().n_points, 1);
/// assert_eq!(reader.layout().bounds, Some(([1.5, 0.0, 0.0], [1.5, 0.0, 0.0])));
/// ```
pub struct LasWriter {
    path: PathBuf,
    format: Format,
    pending: Pending,
    header: Vec<u8>,
    layout: LasLayout,
    points_start: u64,
    fields: Vec<String>,
    packer: Option<Packer>,
    counts: Counts,
    low: [i32; 3],
    high: [i32; 3],
    /// Extended records of the template file.
    tail: Option<Tail>,
    is_broken: bool,
}

/// Extended records of a file: the start of each, and its length.
struct Tail {
    file: File,
    records: Vec<(u64, u64)>,
}

/// Content before the points.
struct Head {
    header: Vec<u8>,
    records: Vec<Vec<u8>>,
    gap: Vec<u8>,
}

impl LasWriter {
    /// Begins a file with a template, compressed if its name ends in `.laz`.
    ///
    /// Version (at least 1.2), creation date, identifiers and coordinate system are copied, and so are all records
    /// except those of the compression, of wave packets, of a COPC hierarchy and of an earlier [`Provenance`]. Each
    /// field is a 32-bit float after the existing content of the records, with a description as extra bytes. A name
    /// in use gets a number, see [`fields`](Self::fields).
    ///
    /// # Errors
    /// The name has another extension, the folder is missing, or the records have no room for the fields. The message
    /// is one line that begins with the file's name.
    pub fn create(
        path: &Path,
        like: &LasReader,
        fields: &[String],
        provenance: Option<&Provenance>,
    ) -> Result<Self, WriteError> {
        Self::create_like(path, like, fields, provenance).map_err(|e| e.in_file(path))
    }

    fn create_like(
        path: &Path,
        like: &LasReader,
        fields: &[String],
        provenance: Option<&Provenance>,
    ) -> Result<Self, WriteError> {
        let (bytes, parsed) = like.head();
        let mut writer = Self::begin(path, Head::like(bytes, parsed), like.layout(), fields, provenance)?;
        writer.tail = Tail::of(like)?;
        Ok(writer)
    }

    /// Begins a file of version 1.4 with records of that layout, ignoring its number of points and bounds.
    ///
    /// # Errors
    /// The errors of [`create`](Self::create), and a layout that LAS does not have.
    pub fn new(
        path: &Path,
        layout: &LasLayout,
        fields: &[String],
        provenance: Option<&Provenance>,
    ) -> Result<Self, WriteError> {
        let is_long = record_bytes(layout.format)
            .is_some_and(|least| (least..=usize::from(u16::MAX)).contains(&layout.record_bytes));
        let what = || format!("records of {} bytes in point format {}", layout.record_bytes, layout.format);
        let begun = if is_long {
            let size = layout.record_bytes as u16;
            let header = new_header(4, layout.format, size, layout.scale, layout.offset);
            Self::begin(
                path,
                Head { header, records: Vec::new(), gap: Vec::new() },
                layout,
                fields,
                provenance,
            )
        } else {
            Err(WriteError::CannotHold { format: Format::LAS, what: what() })
        };
        begun.map_err(|e| e.in_file(path))
    }

    fn begin(
        path: &Path,
        mut head: Head,
        layout: &LasLayout,
        fields: &[String],
        provenance: Option<&Provenance>,
    ) -> Result<Self, WriteError> {
        let is_named = |descriptor: &&&FormatDescriptor| descriptor.matches_name(path);
        let format = [&LAS, &LAZ].iter().find(is_named).map(|descriptor| descriptor.format);
        let Some(format) = format.filter(|_| !is_gzip(path)) else {
            return Err(WriteError::UnknownFormat { writable: ".las, .laz".into() });
        };
        let mut layout = LasLayout { n_points: 0, bounds: None, ..layout.clone() };
        let mut list = ExtraList::read(&head.records, layout.format, layout.record_bytes);
        let mut names = Vec::with_capacity(fields.len());
        for field in fields {
            let Some((name, _)) = list.add(field, 1, ValueType::F32) else {
                let what = format!(
                    "the field `{field}` in records of {} bytes, which have no room for it",
                    list.record_bytes
                );
                return Err(WriteError::CannotHold { format, what });
            };
            names.push(name);
        }
        if !fields.is_empty() {
            list.put_into(&mut head.records);
        }
        layout.record_bytes = list.record_bytes;
        put(&mut head.header, 105, (list.record_bytes as u16).to_le_bytes());
        head.records.extend(provenance.and_then(provenance_record));
        let packer = match format {
            Format::LAZ => Some(Packer::new(layout.format, layout.record_bytes)?),
            _ => None,
        };
        if let Some(packer) = &packer {
            head.records.push(compression_record(packer.description()));
        }
        if layout.format < 6 || !has_long_counts(&head.header) {
            // The 32-bit counts are set, too.
            put(&mut head.header, 107, 1_u32.to_le_bytes());
        }
        head.header[104] = layout.format | if packer.is_some() { COMPRESSED } else { 0 };
        let start = head.header.len() + head.records.iter().map(Vec::len).sum::<usize>() + head.gap.len();
        let start = u32::try_from(start).map_err(|_| {
            let what = "records before the points of more than 4 GiB".into();
            WriteError::CannotHold { format, what }
        })?;
        put(&mut head.header, 96, start.to_le_bytes());
        put(&mut head.header, 100, (head.records.len() as u32).to_le_bytes());
        let mut pending = Pending::begin(path)?;
        pending.out.write_all(&head.header)?;
        head.records.iter().try_for_each(|record| pending.out.write_all(record))?;
        pending.out.write_all(&head.gap)?;
        if packer.is_some() {
            Packer::begin(&mut pending.out)?;
        }
        Ok(Self {
            path: path.to_path_buf(),
            format,
            pending,
            header: head.header,
            layout,
            points_start: start.into(),
            fields: names,
            packer,
            counts: Counts::default(),
            low: [i32::MAX; 3],
            high: [i32::MIN; 3],
            tail: None,
            is_broken: false,
        })
    }

    /// Storage of the written points, with the fields; the number of points and the bounds are known after finishing.
    pub fn layout(&self) -> &LasLayout {
        &self.layout
    }

    /// Names of the fields in the file: as given, if they are short enough and not in use.
    pub fn fields(&self) -> &[String] {
        &self.fields
    }

    /// Appends complete records: those of the template file, each followed by its fields.
    ///
    /// # Errors
    /// The bytes are not a multiple of the record size, writing or compression fails, or the header cannot count the
    /// points. The message is one line that begins with the file's name, and nothing more can be written.
    pub fn write(&mut self, records: &[u8]) -> Result<(), WriteError> {
        let result = self.append(records);
        self.is_broken |= result.is_err();
        result.map_err(|e| e.in_file(&self.path))
    }

    fn append(&mut self, records: &[u8]) -> Result<(), WriteError> {
        self.check()?;
        let size = self.layout.record_bytes;
        if !records.len().is_multiple_of(size) {
            let what = format!("{} bytes of points in records of {size}", records.len());
            return Err(WriteError::CannotHold { format: self.format, what });
        }
        let n = self.counts.n + (records.len() / size) as u64;
        if n > u64::from(u32::MAX) && !has_long_counts(&self.header) {
            let what = format!("more than {} points with a header before version 1.4", u32::MAX);
            return Err(WriteError::CannotHold { format: self.format, what });
        }
        for row in records.chunks_exact(size) {
            self.counts.add(row, self.layout.format);
            for axis in 0..3 {
                let mut own = [0; 4];
                own.copy_from_slice(&row[4 * axis..][..4]);
                let whole = i32::from_le_bytes(own);
                self.low[axis] = self.low[axis].min(whole);
                self.high[axis] = self.high[axis].max(whole);
            }
        }
        match &mut self.packer {
            Some(packer) => packer.add(records, &mut self.pending.out),
            None => Ok(self.pending.out.write_all(records)?),
        }
    }

    fn check(&self) -> Result<(), WriteError> {
        if self.is_broken {
            return Err(std::io::Error::other("a previous error left it incomplete").into());
        }
        Ok(())
    }

    /// Writes the content after the points and the counts and bounds of the header, and renames the file to its final
    /// name.
    ///
    /// # Errors
    /// Writing fails; an older file of that name is unchanged then. The message is one line that begins with the
    /// file's name.
    pub fn finish(self) -> Result<(), WriteError> {
        let path = self.path.clone();
        self.complete().map_err(|e| e.in_file(&path))
    }

    fn complete(mut self) -> Result<(), WriteError> {
        self.check()?;
        if let Some(packer) = &mut self.packer {
            packer.end(self.points_start, &mut self.pending.out)?;
        }
        if let Some(tail) = &mut self.tail {
            let start = self.pending.out.stream_position()?;
            put(&mut self.header, 235, start.to_le_bytes());
            put(&mut self.header, 243, (tail.records.len() as u32).to_le_bytes());
            for &(start, n_bytes) in &tail.records {
                tail.file.seek(SeekFrom::Start(start))?;
                let n = std::io::copy(&mut (&tail.file).take(n_bytes), &mut self.pending.out)?;
                if n < n_bytes {
                    return Err(std::io::Error::other("the template file has become shorter").into());
                }
            }
        }
        self.counts.put_into(&mut self.header);
        for axis in 0..3 {
            let at = |whole: i32| f64::from(whole) * self.layout.scale[axis] + self.layout.offset[axis];
            let (a, b) =
                if self.counts.n > 0 { (at(self.low[axis]), at(self.high[axis])) } else { (0.0, 0.0) };
            put(&mut self.header, 179 + 16 * axis, a.max(b).to_le_bytes());
            put(&mut self.header, 187 + 16 * axis, a.min(b).to_le_bytes());
        }
        self.pending.out.seek(SeekFrom::Start(0))?;
        self.pending.out.write_all(&self.header)?;
        self.pending.finish(Progress::none())
    }
}

fn is_gzip(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"))
}

impl Head {
    /// Copies the bytes before the points of a file, except those of its compression or hierarchy.
    fn like(bytes: &[u8], parsed: &Header) -> Self {
        const VERSION_1_2: u8 = 2;
        const WAVE_PACKETS_INSIDE: u8 = 2;
        let mut header = bytes[..parsed.bytes].to_vec();
        header[25] = header[25].max(VERSION_1_2);
        // Wave packets are dropped, and extended records are counted when they are written.
        header[6] &= !WAVE_PACKETS_INSIDE;
        if header[25] >= 3 && header.len() >= 235 {
            put(&mut header, 227, 0_u64.to_le_bytes());
        }
        if has_long_counts(&header) {
            put(&mut header, 235, 0_u64.to_le_bytes());
            put(&mut header, 243, 0_u32.to_le_bytes());
        }
        let all = records(bytes, parsed);
        let whole = |record: &Record<'_>| {
            bytes[record.start..record.start + RECORD_HEAD + record.content.len()].to_vec()
        };
        let kept =
            all.iter().filter(|record| !record.is_compression() && !is_copc_record(record.user)).map(whole);
        let end = all.last().map_or(parsed.bytes, |last| last.start + RECORD_HEAD + last.content.len());
        Self {
            header,
            records: kept.filter(|record| !is_provenance(record)).collect(),
            gap: bytes.get(end..parsed.points_start).unwrap_or_default().to_vec(),
        }
    }
}

impl Tail {
    /// Collects the complete extended records of a file, except wave packets and the hierarchy of a COPC.
    fn of(like: &LasReader) -> Result<Option<Self>, WriteError> {
        let (bytes, parsed) = like.head();
        if !has_long_counts(&bytes[..parsed.bytes]) {
            return Ok(None);
        }
        let count = crate::formats::las::read::u32_at(bytes, 243).unwrap_or(0).min(MOST_EXTENDED);
        let mut at = u64_at(bytes, 235).unwrap_or(0);
        if count == 0 || at < parsed.points_start as u64 {
            return Ok(None);
        }
        let mut file = File::open(like.path())?;
        let mut found = Vec::new();
        for _ in 0..count {
            let mut head = Vec::with_capacity(EXTENDED_HEAD);
            file.seek(SeekFrom::Start(at))?;
            (&file).take(EXTENDED_HEAD as u64).read_to_end(&mut head)?;
            let Some(n_bytes) = u64_at(&head, 20).filter(|_| head.len() == EXTENDED_HEAD) else { break };
            let n_bytes = n_bytes.saturating_add(EXTENDED_HEAD as u64);
            let end = at.saturating_add(n_bytes);
            if end > like.n_bytes() {
                break;
            }
            let is_wave = head[2..].starts_with(b"LASF_Spec") && head[18..20] == WAVE_PACKETS.to_le_bytes();
            if !is_wave && !is_copc_record(&head[2..18]) {
                found.push((at, n_bytes));
            }
            at = end;
        }
        Ok((!found.is_empty()).then_some(Self { file, records: found }))
    }
}
