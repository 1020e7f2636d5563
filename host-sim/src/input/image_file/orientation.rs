//! Which way up: the EXIF orientation of a JPEG, PNG or TIFF, applied as OpenCV's `imread` does.

use std::io::Cursor;

use exif::{In, Reader, Tag};
use image::DynamicImage;
use image::metadata::Orientation;

/// Turns and mirrors the image as its file tells; without a valid tag it stays as it is.
pub(super) fn apply(image: &mut DynamicImage, file: &[u8]) {
    let told = Reader::new().continue_on_error(true).read_from_container(&mut Cursor::new(file));
    let told = told.or_else(|error| error.distill_partial_result(|_| ()));
    let value = told.ok().and_then(|exif| exif.get_field(Tag::Orientation, In::PRIMARY)?.value.get_uint(0));
    let orientation = value.and_then(|value| Orientation::from_exif(u8::try_from(value).ok()?));
    if let Some(orientation) = orientation {
        image.apply_orientation(orientation);
    }
}
