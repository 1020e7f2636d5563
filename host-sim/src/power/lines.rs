//! Lines of a file of any length, in a buffer of one size.

use std::io::{Error, ErrorKind, Read, Result};

/// Bytes of a line that has no end.
const LONGEST: usize = 1 << 16;
/// Bytes read at once: what a core's second cache holds.
const BUFFER: usize = 4 * LONGEST;

/// A line, without what ends it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line<'a> {
    pub text: &'a [u8],
    /// Whether something ends it: the last line of a file may be cut off.
    pub is_ended: bool,
}

/// The lines of a file that are not empty.
#[derive(Debug)]
pub(super) struct Lines<R> {
    from: R,
    buffer: Vec<u8>,
    /// What was read and not told yet.
    begin: usize,
    end: usize,
    /// Lines told, with the empty ones.
    count: u64,
}

impl<R: Read> Lines<R> {
    pub fn new(from: R) -> Self {
        Self { from, buffer: vec![0; BUFFER], begin: 0, end: 0, count: 0 }
    }

    /// The number of the line that was told last, from 1 on.
    pub fn number(&self) -> u64 {
        self.count
    }

    /// The next one.
    #[inline]
    pub fn next(&mut self) -> Result<Option<Line<'_>>> {
        loop {
            let found = memchr::memchr(b'\n', &self.buffer[self.begin..self.end]);
            let (length, is_ended) = match found {
                Some(length) => (length, true),
                None if self.fill()? => continue,
                None => (self.end - self.begin, false),
            };
            let begin = self.begin;
            self.begin = (begin + length + 1).min(self.end);
            let text = &self.buffer[begin..begin + length];
            let text = text.strip_suffix(b"\r").unwrap_or(text);
            if is_ended || !text.is_empty() {
                self.count += 1;
            }
            if !text.is_empty() {
                // Borrowed anew: a borrow that is returned within a loop lasts for all of it.
                return Ok(Some(Line { text: &self.buffer[begin..begin + text.len()], is_ended }));
            }
            if !is_ended {
                return Ok(None);
            }
        }
    }

    /// Reads more of a line whose end is not in the buffer; whether there was any.
    #[cold]
    fn fill(&mut self) -> Result<bool> {
        if self.end - self.begin > LONGEST {
            let told = format!("has a line of more than {LONGEST} bytes, which no table of currents has");
            return Err(Error::new(ErrorKind::InvalidData, told));
        }
        self.buffer.copy_within(self.begin..self.end, 0);
        (self.begin, self.end) = (0, self.end - self.begin);
        loop {
            match self.from.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
                Ok(count) => {
                    self.end += count;
                    return Ok(count > 0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pipe that gives few bytes at once.
    struct Trickle<'a>(&'a [u8], usize);

    impl Read for Trickle<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
            let count = self.1.min(self.0.len()).min(buffer.len());
            buffer[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    fn told(text: &[u8], at_once: usize) -> Result<Vec<(u64, String, bool)>> {
        let mut lines = Lines::new(Trickle(text, at_once));
        let mut told = Vec::new();
        while let Some(Line { text, is_ended }) = lines.next()? {
            let text = String::from_utf8_lossy(text).into_owned();
            told.push((lines.number(), text, is_ended));
        }
        Ok(told)
    }

    #[test]
    fn lines_are_those_of_the_file_however_it_is_read() {
        let line = |number, text: &str, is_ended| (number, text.to_owned(), is_ended);
        for at_once in [1, 2, 3, 1000] {
            let found = told(b"a,b\r\n\n1,2\n\r\n\n3,4", at_once).unwrap();
            assert_eq!(found, [line(1, "a,b", true), line(3, "1,2", true), line(6, "3,4", false)], "{at_once}");
            assert!(told(b"", at_once).unwrap().is_empty());
            assert!(told(b"\n\r\n", at_once).unwrap().is_empty());
        }
        let rows: Vec<String> = (0..50_000).map(|row| format!("{row},{}", "7".repeat(row % 40))).collect();
        for at_once in [4093, usize::MAX] {
            let found = told((rows.join("\n") + "\n").as_bytes(), at_once).unwrap();
            assert!(found.iter().map(|line| &line.1).eq(&rows), "{at_once} bytes at once");
            assert!(found.iter().all(|line| line.2));
        }
    }

    #[test]
    fn a_line_without_end_is_refused() {
        let endless = vec![b'7'; 10 * BUFFER];
        assert!(told(&endless, 1000).unwrap_err().to_string().contains("a line of more than 65536 bytes"));
        let long = [vec![b'7'; LONGEST], b"\n1".to_vec()].concat();
        assert_eq!(told(&long, 1000).unwrap().len(), 2);
    }
}
