//! Reading of ZIP archives with a limit on the decompressed size.

use std::collections::HashMap;
use std::io::{Cursor, Read};

use adwave::Progress;
use zip::ZipArchive;

use crate::progress::BYTES_PER_STEP;
use crate::text::one_line;
use crate::{ReadError, ReadLimits};

/// Archive, and the number of bytes that may still be decompressed.
pub(crate) struct Package<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    /// Name of each file, by the normalized name.
    names: HashMap<String, String>,
    limit: u64,
    left: u64,
}

/// True if the bytes are an archive with a file whose name has this ending.
pub(crate) fn package_has(bytes: &[u8], ending: &str) -> bool {
    bytes.starts_with(b"PK\x03\x04")
        && ZipArchive::new(Cursor::new(bytes))
            .is_ok_and(|archive| archive.file_names().any(|name| ends_with(name, ending)))
}

fn ends_with(name: &str, ending: &str) -> bool {
    name.len() >= ending.len()
        && name.as_bytes()[name.len() - ending.len()..].eq_ignore_ascii_case(ending.as_bytes())
}

/// Normalizes a name: without a leading slash, in lower case.
fn plain(name: &str) -> String {
    name.trim_start_matches('/').to_ascii_lowercase()
}

impl<'a> Package<'a> {
    pub(crate) fn open(bytes: &'a [u8], limits: &ReadLimits) -> Result<Self, ReadError> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| {
            ReadError::Whole(format!("the ZIP archive is damaged ({}); get the whole file", one_line(&e)))
        })?;
        let names = archive.file_names().filter(|name| !name.ends_with('/'));
        let names = names.map(|name| (plain(name), name.to_owned())).collect();
        Ok(Self { archive, names, limit: limits.max_bytes, left: limits.max_bytes })
    }

    /// Names of all files in the archive.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.names.values().map(String::as_str)
    }

    /// True if there is a file of that name.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.names.contains_key(&plain(name))
    }

    /// First name with this ending.
    pub(crate) fn find(&self, ending: &str) -> Option<String> {
        self.names().filter(|name| ends_with(name, ending)).min().map(ToString::to_string)
    }

    /// Reads the text of a file in the archive; case and a leading slash of its name are ignored.
    pub(crate) fn text(&mut self, name: &str, progress: Progress<'_>) -> Result<String, ReadError> {
        let own = self.names.get(&plain(name)).cloned();
        let shown: String = name.chars().filter(|c| !c.is_control()).take(80).collect();
        let broken = |what: &dyn std::fmt::Display| {
            let what = one_line(what);
            ReadError::Whole(format!(
                "part `{shown}` of the archive is damaged ({what}); get the whole \
                                     file"
            ))
        };
        let Some(own) = own else {
            return Err(ReadError::Whole(format!(
                "part `{shown}` is missing in the archive; get the whole file"
            )));
        };
        let file = self.archive.by_name(&own).map_err(|e| broken(&e))?;
        let mut reader = file.take(self.left.saturating_add(1));
        let mut bytes = Vec::new();
        loop {
            progress.check()?;
            let before = bytes.len();
            let step = reader.by_ref().take(BYTES_PER_STEP as u64);
            { step }.read_to_end(&mut bytes).map_err(|e| broken(&e))?;
            if bytes.len() == before {
                break;
            }
        }
        let Some(left) = self.left.checked_sub(bytes.len() as u64) else {
            let found = self.limit.saturating_add(1);
            return Err(ReadError::Limit { what: "bytes", found, limit: self.limit });
        };
        self.left = left;
        crate::text::encoding::to_utf8(bytes).map_err(|_| broken(&"it is not text"))
    }
}
