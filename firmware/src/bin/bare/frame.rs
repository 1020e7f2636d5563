//! Where rows come from: the built-in picture, or two files of the host.

use core::ffi::CStr;

use haarline_firmware::picture;
use semihosting::fs::File;
use semihosting::io::{Read, Seek, SeekFrom};

/// Most columns of a frame.
pub const MAX_WIDTH: u16 = 320;

/// A row of either view; the first columns count.
pub type Line = [u8; MAX_WIDTH as usize];

/// A pair of views.
pub enum Frame {
    /// The built-in picture.
    BuiltIn,
    /// Two files.
    Files(Pgm, Pgm),
}

impl Frame {
    /// Opens two files, whose pictures have the same size.
    pub fn open(left: &str, right: &str) -> Result<Self, &'static str> {
        let (left, right) = (Pgm::open(left)?, Pgm::open(right)?);
        if (left.width, left.height) != (right.width, right.height) {
            return Err("the pictures differ in size");
        }
        Ok(Self::Files(left, right))
    }

    /// Columns and rows.
    pub fn size(&self) -> (u16, u32) {
        match self {
            Self::BuiltIn => (picture::WIDTH, picture::HEIGHT),
            Self::Files(left, _) => (left.width, left.height),
        }
    }

    /// Row `y` of the left and the right view.
    pub fn rows(&mut self, y: u32) -> Result<(Line, Line), &'static str> {
        match self {
            Self::BuiltIn => Ok(picture::rows(y)),
            Self::Files(left, right) => Ok((left.row(y)?, right.row(y)?)),
        }
    }
}

/// A grey picture of 8 bits in a file of the host: PGM, the binary kind.
pub struct Pgm {
    file: File,
    width: u16,
    height: u32,
    /// Where the pixels begin.
    pixels: u32,
}

impl Pgm {
    fn open(path: &str) -> Result<Self, &'static str> {
        let mut name = [0; 256];
        let Some(place) = name.get_mut(..path.len()) else { return Err("a path is too long") };
        place.copy_from_slice(path.as_bytes());
        let name = CStr::from_bytes_until_nul(&name).map_err(|_| "a path is too long")?;
        let mut file = File::open(name).map_err(|_| "a picture can't be opened")?;

        let mut begin = [0; 256];
        let len = file.read(&mut begin).map_err(|_| "a picture can't be read")?;
        let header = Header::parse(begin.get(..len).unwrap_or(&[]));
        let Some([width, height, 255]) = header.numbers else {
            return Err("a picture is no PGM of 8 bits (P5, greatest value 255, header up to 256 bytes)");
        };
        match u16::try_from(width) {
            Ok(width) if width <= MAX_WIDTH && height > 0 => Ok(Self { file, width, height, pixels: header.len }),
            _ => Err("a picture is wider than 320 px, or empty"),
        }
    }

    fn row(&mut self, y: u32) -> Result<Line, &'static str> {
        let start = u64::from(self.pixels) + u64::from(y) * u64::from(self.width);
        let mut line = [0; MAX_WIDTH as usize];
        let (row, _) = line.split_at_mut(usize::from(self.width));
        let read = self.file.seek(SeekFrom::Start(start)).and_then(|_| self.file.read_exact(row));
        read.map(|()| line).map_err(|_| "a picture ends too early")
    }
}

/// What stands before the pixels.
struct Header {
    /// Width, height, greatest value.
    numbers: Option<[u32; 3]>,
    len: u32,
}

impl Header {
    /// Reads `P5`, three numbers and one white space, with comments between them.
    fn parse(bytes: &[u8]) -> Self {
        let mut header = Self { numbers: None, len: 0 };
        let Some(mut rest) = bytes.strip_prefix(b"P5") else { return header };
        let mut numbers = [0; 3];
        for number in &mut numbers {
            rest = skip_blank(rest);
            let end = rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len());
            let (digits, after) = rest.split_at(end);
            let Some(parsed) = core::str::from_utf8(digits).ok().and_then(|text| text.parse().ok()) else {
                return header;
            };
            (*number, rest) = (parsed, after);
        }
        if let [separator, pixels @ ..] = rest
            && separator.is_ascii_whitespace()
        {
            header.len = u32::try_from(bytes.len() - pixels.len()).unwrap_or(0);
            header.numbers = Some(numbers);
        }
        header
    }
}

/// Past white space and comments, which end with their line.
fn skip_blank(mut bytes: &[u8]) -> &[u8] {
    loop {
        bytes = bytes.trim_ascii_start();
        if bytes.first() != Some(&b'#') {
            return bytes;
        }
        let end = bytes.iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len());
        (_, bytes) = bytes.split_at(end);
    }
}
