//! On which line of a file the row of a table stands. A reader of tables skips comments and empty lines, and its own count lags
//! behind them; the bytes of the file do not.

/// Counts lines of a file from its beginning.
#[derive(Debug, Clone, Copy, Default)]
pub struct LineCounter {
    ends: usize,
    last: u8,
}

impl LineCounter {
    /// Takes the next bytes of the file.
    pub fn take(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            // A line ends in \n, in \r\n or, in old files, in \r alone.
            self.ends += usize::from(byte == b'\r' || (byte == b'\n' && self.last != b'\r'));
            self.last = byte;
        }
    }

    /// Returns the line of the last byte, from 1; the end of a line belongs to it.
    pub fn line(&self) -> usize {
        self.ends + 1 - usize::from(matches!(self.last, b'\n' | b'\r'))
    }
}

/// Counts the lines of a text in memory, as far as they are asked for.
#[derive(Debug, Clone, Copy)]
pub struct TextLines<'a> {
    text: &'a [u8],
    at: usize,
    counter: LineCounter,
}

impl<'a> TextLines<'a> {
    /// Begins at the first line.
    pub fn new(text: &'a [u8]) -> Self {
        TextLines { text, at: 0, counter: LineCounter::default() }
    }

    /// Returns the line of the row that ends before this byte, its end of line included. The byte never falls.
    pub fn ending_at(&mut self, end: u64) -> usize {
        let end = usize::try_from(end).unwrap_or(usize::MAX).clamp(self.at, self.text.len());
        self.counter.take(&self.text[self.at..end]);
        self.at = end;
        self.counter.line()
    }
}

#[cfg(test)]
mod tests {
    use super::TextLines;

    #[test]
    fn every_end_of_line_counts_once() {
        for text in ["a\n\n#\nb\nc", "a\r\n\r\n#\r\nb\r\nc", "a\r\r#\rb\rc"] {
            let mut lines = TextLines::new(text.as_bytes());
            let end = |of: char| text.find(of).expect("a row") as u64 + 1;
            assert_eq!(lines.ending_at(end('a')), 1, "{text:?}");
            // With the end of its line or without.
            assert_eq!(lines.ending_at(end('b')), 4, "{text:?}");
            assert_eq!(lines.ending_at(end('b') + 1), 4, "{text:?}");
            assert_eq!(lines.ending_at(u64::MAX), 5, "{text:?}");
        }
    }
}
