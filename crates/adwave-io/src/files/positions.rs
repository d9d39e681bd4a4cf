//! Bytes of a file at a position, for pieces that are read or written out of order.

use std::fs::File;
use std::io;

#[cfg(unix)]
pub(crate) fn read_at(file: &File, position: u64, bytes: &mut [u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, position)
}

#[cfg(unix)]
pub(crate) fn write_at(file: &File, position: u64, bytes: &[u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::write_all_at(file, bytes, position)
}

/// Lock of the pieces, which move the position of the file itself.
#[cfg(not(unix))]
static ONE_AT_A_TIME: std::sync::Mutex<()> = std::sync::Mutex::new(());

#[cfg(not(unix))]
pub(crate) fn read_at(mut file: &File, position: u64, bytes: &mut [u8]) -> io::Result<()> {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    io::Seek::seek(&mut file, io::SeekFrom::Start(position))?;
    io::Read::read_exact(&mut file, bytes)
}

#[cfg(not(unix))]
pub(crate) fn write_at(mut file: &File, position: u64, bytes: &[u8]) -> io::Result<()> {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    io::Seek::seek(&mut file, io::SeekFrom::Start(position))?;
    io::Write::write_all(&mut file, bytes)
}
