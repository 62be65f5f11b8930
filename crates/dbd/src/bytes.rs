//! The bytes of a file, a window of them at a time; LZ4 blocks unpacked on the way.
//!
//! A compressed file is a row of blocks, each two bytes with the length (most significant first), then so many bytes of an
//! LZ4 block that unpacks to at most 32 KiB. A block that does not unpack leaves a hole, at which reading has to find its
//! way again.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use crate::error::{Damage, Error, Place};

/// Most that a block unpacks to.
const BLOCK: usize = 32 * 1024;

/// Bytes read at once from a file that is not compressed.
const PIECE: usize = 64 * 1024;

/// Damaged places that are reported of one file.
const MOST_DAMAGES: usize = 100;

/// What every header begins with.
pub(crate) const LABEL: &[u8] = b"dbd_label";

/// The bytes that are in memory, from where the reader stands on.
pub(crate) struct Bytes {
    path: PathBuf,
    file: File,
    compressed: bool,
    /// Bytes in memory, and how many of them are behind the reader.
    window: Vec<u8>,
    behind: usize,
    /// Place of `window[0]` in the contents.
    first: u64,
    /// Compressed blocks so far, and the places in the contents where the last few of them begin.
    blocks: u64,
    begins: Vec<(u64, u64)>,
    ended: bool,
    /// A hole in the contents at this place: what follows does not join on.
    pub(crate) hole: Option<u64>,
    pub(crate) damages: Vec<Damage>,
}

impl Bytes {
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        let file = File::open(path).map_err(|error| Error::io(path, &error))?;
        let mut bytes = Bytes {
            path: path.to_owned(),
            file,
            compressed: false,
            window: Vec::new(),
            behind: 0,
            first: 0,
            blocks: 0,
            begins: Vec::new(),
            ended: false,
            hole: None,
            damages: Vec::new(),
        };
        let mut start = [0u8; 64];
        let read = bytes.read_up_to(&mut start)?;
        let start = &start[..read];
        bytes.compressed = is_compressed(start);
        std::io::Seek::rewind(&mut bytes.file).map_err(|error| Error::io(path, &error))?;
        Ok(bytes)
    }

    /// The bytes from the reader on, at least `wanted` of them unless the file ends or has a hole.
    pub(crate) fn ahead(&mut self, wanted: usize) -> Result<&[u8], Error> {
        while self.window.len() - self.behind < wanted && !self.ended && self.hole.is_none() {
            self.more()?;
        }
        let end = match self.hole {
            Some(at) => ((at - self.first) as usize).max(self.behind),
            None => self.window.len(),
        };
        Ok(&self.window[self.behind..end])
    }

    /// Goes on by so many bytes.
    pub(crate) fn skip(&mut self, bytes: usize) {
        self.behind = (self.behind + bytes).min(self.window.len());
        if self.behind > 4 * PIECE {
            self.window.drain(..self.behind);
            self.first += self.behind as u64;
            self.behind = 0;
        }
    }

    /// Goes on behind the hole.
    pub(crate) fn pass_hole(&mut self) {
        if let Some(at) = self.hole.take() {
            self.behind = ((at - self.first) as usize).max(self.behind);
        }
    }

    /// Where the reader stands, and so many bytes on.
    pub(crate) fn place(&self, ahead: usize) -> Place {
        let byte = self.first + (self.behind + ahead) as u64;
        let block = self.begins.iter().rev().find(|(_, begin)| *begin <= byte).map(|(block, _)| *block);
        Place { block: block.filter(|_| self.compressed), byte: Some(byte) }
    }

    /// Keeps what is damaged; of very many places the first.
    pub(crate) fn damaged(&mut self, place: Place, problem: String) {
        if self.damages.len() < MOST_DAMAGES {
            self.damages.push(Damage { place, problem });
        }
    }

    fn more(&mut self) -> Result<(), Error> {
        if !self.compressed {
            let old = self.window.len();
            self.window.resize(old + PIECE, 0);
            let mut file = &self.file;
            let read = read_up_to(&mut file, &mut self.window[old..]).map_err(|error| Error::io(&self.path, &error))?;
            self.window.truncate(old + read);
            self.ended = read == 0;
            return Ok(());
        }
        let mut length = [0u8; 2];
        let read = self.read_up_to(&mut length)?;
        if read < 2 {
            self.ended = true;
            return Ok(());
        }
        self.blocks += 1;
        let begin = self.first + self.window.len() as u64;
        // Places are asked for where the reader stands: old blocks are of no use.
        if self.begins.len() > 64 {
            self.begins.drain(..32);
        }
        self.begins.push((self.blocks, begin));
        let mut packed = vec![0u8; usize::from(u16::from_be_bytes(length))];
        let read = self.read_up_to(&mut packed)?;
        let place = Place { block: Some(self.blocks), byte: Some(begin) };
        if read < packed.len() {
            self.ended = true;
            // The blocks of a file that was cut off unpack up to where it ends, as far as LZ4 can.
            let problem = format!("the block of {} bytes ends after {read}: the file was cut off", packed.len());
            self.damaged(place, problem);
            return Ok(());
        }
        match lz4_flex::block::decompress(&packed, BLOCK) {
            Ok(unpacked) => self.window.extend(unpacked),
            Err(error) => {
                let problem = format!("the block of {} bytes does not unpack ({error}) and was left out", packed.len());
                self.damaged(place, problem);
                self.hole = Some(begin);
            }
        }
        Ok(())
    }

    fn read_up_to(&mut self, buffer: &mut [u8]) -> Result<usize, Error> {
        read_up_to(&mut self.file, buffer).map_err(|error| Error::io(&self.path, &error))
    }
}

/// Whether a file that begins so is a row of LZ4 blocks with a header inside: the label stands as it is behind the lengths.
pub(crate) fn is_compressed(start: &[u8]) -> bool {
    !start.starts_with(LABEL) && start.len() > 4 && start[2..].windows(LABEL.len()).take(6).any(|bytes| bytes == LABEL)
}

/// Unpacks a whole row of blocks, for lists of sensors.
pub(crate) fn unpacked(path: &Path, bytes: &[u8]) -> Result<Vec<u8>, Error> {
    let (mut out, mut at, mut block) = (Vec::new(), 0, 0);
    while let Some(&[high, low]) = bytes.get(at..at + 2) {
        block += 1;
        let length = usize::from(u16::from_be_bytes([high, low]));
        let place = Place { block: Some(block), byte: Some(out.len() as u64) };
        let packed = bytes
            .get(at + 2..at + 2 + length)
            .ok_or_else(|| Error::new(path, format!("the block of {length} bytes is cut off")).at(place))?;
        let plain = lz4_flex::block::decompress(packed, BLOCK)
            .map_err(|error| Error::new(path, format!("the block does not unpack: {error}")).at(place))?;
        out.extend(plain);
        at += 2 + length;
    }
    Ok(out)
}

fn read_up_to(file: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut read = 0;
    while read < buffer.len() {
        match file.read(&mut buffer[read..]) {
            Ok(0) => break,
            Ok(bytes) => read += bytes,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(read)
}
