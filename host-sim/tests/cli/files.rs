//! Readers and writers of the files that go in and come out, independent of the tool's.

use std::io::Cursor;

use image::{DynamicImage, ImageFormat};

/// A floating point map, from the top row.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    pub width: usize,
    pub height: usize,
    /// Disparities in px; unknown is positive infinity.
    pub px: Vec<f32>,
}

impl Map {
    /// Reads a PFM file: three header lines, then rows of float32 from the bottom one.
    #[track_caller]
    pub fn from_pfm(bytes: &[u8]) -> Self {
        let mut lines = bytes.splitn(4, |&byte| byte == b'\n');
        let mut line = || std::str::from_utf8(lines.next().unwrap()).unwrap();
        assert_eq!(line(), "Pf", "one channel");
        let size: Vec<usize> = line().split(' ').map(|number| number.parse().unwrap()).collect();
        let &[width, height] = &size[..] else { panic!("{size:?} is no size") };
        let scale: f64 = line().parse().unwrap();
        assert_eq!(scale.abs(), 1.0);
        let samples = lines.next().unwrap();
        assert_eq!(samples.len(), 4 * width * height);
        let sample = |bytes: &[u8; 4]| {
            if scale < 0.0 { f32::from_le_bytes(*bytes) } else { f32::from_be_bytes(*bytes) }
        };
        let from_bottom: Vec<f32> = samples.as_chunks().0.iter().map(sample).collect();
        let px: Vec<f32> = from_bottom.chunks(width).rev().flatten().copied().collect();
        assert!(px.iter().all(|px| px.is_finite() || *px == f32::INFINITY), "neither -inf nor NaN");
        Self { width, height, px }
    }

    /// The known disparities.
    pub fn known(&self) -> Vec<f32> {
        self.px.iter().copied().filter(|px| px.is_finite()).collect()
    }

    /// Known pixels, percent.
    pub fn density(&self) -> f64 {
        100.0 * self.known().len() as f64 / self.px.len() as f64
    }
}

/// Vertices of a PLY file in its binary form: position in m and colour.
#[track_caller]
pub fn vertices(bytes: &[u8]) -> Vec<([f32; 3], [u8; 3])> {
    const END: &[u8] = b"end_header\n";
    let end = bytes.windows(END.len()).position(|window| window == END).unwrap() + END.len();
    let header: Vec<&str> = std::str::from_utf8(&bytes[..end]).unwrap().lines().collect();
    assert_eq!(header[..2], ["ply", "format binary_little_endian 1.0"]);
    let count = header.iter().find_map(|line| line.strip_prefix("element vertex ")).unwrap();
    let properties: Vec<&str> = header.iter().filter_map(|line| line.strip_prefix("property ")).collect();
    assert_eq!(properties, ["float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"]);
    let (vertices, rest) = bytes[end..].as_chunks::<15>();
    assert_eq!((vertices.len(), rest.len()), (count.parse().unwrap(), 0), "as many as the header says");
    let vertex = |v: &[u8; 15]| {
        let float = |at: usize| f32::from_le_bytes([v[at], v[at + 1], v[at + 2], v[at + 3]]);
        ([float(0), float(4), float(8)], [v[12], v[13], v[14]])
    };
    vertices.iter().map(vertex).collect()
}

/// Reads a PNG.
#[track_caller]
pub fn png(bytes: &[u8]) -> DynamicImage {
    image::load_from_memory_with_format(bytes, ImageFormat::Png).unwrap()
}

/// Samples of a 16-bit grey PNG.
#[track_caller]
pub fn png16(bytes: &[u8]) -> Vec<u16> {
    let DynamicImage::ImageLuma16(image) = png(bytes) else { panic!("not of 16 bits") };
    image.into_raw()
}

/// Samples of an 8-bit grey PNG.
#[track_caller]
pub fn png8(bytes: &[u8]) -> Vec<u8> {
    let DynamicImage::ImageLuma8(image) = png(bytes) else { panic!("not grey of 8 bits") };
    image.into_raw()
}

/// The file of an image.
pub fn encode(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    if format == ImageFormat::Jpeg {
        image.write_with_encoder(image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100)).unwrap();
    } else {
        image.write_to(&mut bytes, format).unwrap();
    }
    bytes.into_inner()
}

/// Makes the header of a PNG claim another size, with a right checksum.
pub fn resized_png(mut png: Vec<u8>, width: u32, height: u32) -> Vec<u8> {
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    let checksum = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.to_be_bytes());
    png
}

pub fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)))
}
