//! Pictures as people have them give the map of the plain PNG.

use image::{DynamicImage, ImageFormat};

use crate::files::{Map, encode};
use crate::overwrite::write_rig;
use crate::scene::{HEIGHT, Pair, WIDTH, grey16_image};
use crate::tool::Bench;

/// A JPEG of no loss to speak of with an EXIF orientation in it, and turned so that it comes out upright.
fn jpeg_turned(image: &DynamicImage, tag: u8) -> Vec<u8> {
    let turned = match tag {
        2 => image.fliph(),
        3 => image.rotate180(),
        4 => image.flipv(),
        6 => image.rotate270(),
        8 => image.rotate90(),
        _ => image.clone(),
    };
    let mut bytes = encode(&turned, ImageFormat::Jpeg);
    bytes.splice(2..2, [&[0xff, 0xe1, 0, 34][..], b"Exif\0\0", &exif(tag)].concat());
    bytes
}

/// A TIFF header and one directory with the orientation.
fn exif(tag: u8) -> Vec<u8> {
    [&b"II*\0"[..], &[8, 0, 0, 0, 1, 0], &[0x12, 1, 3, 0, 1, 0, 0, 0, tag, 0, 0, 0], &[0; 4]].concat()
}

/// The same in a chunk of a PNG, before its pixels.
fn png_turned(image: &DynamicImage, tag: u8) -> Vec<u8> {
    assert_eq!(tag, 3);
    let mut bytes = encode(&image.rotate180(), ImageFormat::Png);
    let content = [&b"eXIf"[..], &exif(tag)].concat();
    let chunk = [&26_u32.to_be_bytes()[..], &content, &crate::files::crc32(&content).to_be_bytes()].concat();
    bytes.splice(33..33, chunk);
    bytes
}

fn sixteen(image: &DynamicImage, bits: u32) -> DynamicImage {
    let wide: Vec<u16> = image.to_luma8().iter().map(|&grey| u16::from(grey) << (bits - 8)).collect();
    grey16_image(image.width() as usize, image.height() as usize, &wide)
}

/// A file of an image by the name of its encoding.
type Encoder = fn(&DynamicImage) -> Vec<u8>;

fn map_of(bench: &Bench, suffix: &str, encoder: Encoder) -> (Map, String) {
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    for (side, image) in [("l", pair.left_image()), ("r", pair.right_image())] {
        bench.write(&format!("{side}.{suffix}"), encoder(&image));
    }
    let outcome = bench.run(&format!("depth l.{suffix} r.{suffix} --num-disparities 16 -o map.pfm"));
    assert_eq!(outcome.status, 0, "{suffix}: {outcome:?}");
    (Map::from_pfm(&bench.read("map.pfm")), outcome.stderr)
}

#[test]
fn encodings_without_loss_give_the_very_map_of_the_plain_png() {
    let bench = Bench::new();
    let (plain, told) = map_of(&bench, "png", |image| encode(image, ImageFormat::Png));
    assert_eq!(told, "");
    let cases: [(&str, &str, Encoder); 12] = [
        ("pgm", "", |image| encode(image, ImageFormat::Pnm)),
        ("ppm", "", |image| encode(&image.to_rgb8().into(), ImageFormat::Pnm)),
        ("bmp", "", |image| encode(image, ImageFormat::Bmp)),
        ("tif", "", |image| encode(image, ImageFormat::Tiff)),
        ("rgb.png", "", |image| encode(&image.to_rgb8().into(), ImageFormat::Png)),
        ("alpha.png", "", |image| encode(&image.to_luma_alpha8().into(), ImageFormat::Png)),
        ("rgba.png", "", |image| encode(&image.to_rgba8().into(), ImageFormat::Png)),
        ("16.png", "", |image| encode(&sixteen(image, 16), ImageFormat::Png)),
        ("14.tif", "14 bits", |image| encode(&sixteen(image, 14), ImageFormat::Tiff)),
        ("12.png", "12 bits", |image| encode(&sixteen(image, 12), ImageFormat::Png)),
        ("10.png", "10 bits", |image| encode(&sixteen(image, 10), ImageFormat::Png)),
        ("turned.png", "", |image| png_turned(image, 3)),
    ];
    for (suffix, caveat, encoder) in cases {
        let (map, told) = map_of(&bench, suffix, encoder);
        assert!(map == plain, "{suffix}");
        assert!(if caveat.is_empty() { told.is_empty() } else { told.contains(caveat) }, "{suffix}: {told}");
        assert!(told.lines().count() <= 1, "{suffix}: {told}");
    }
}

#[test]
fn jpegs_are_turned_upright_and_may_lack_their_end() {
    let bench = Bench::new();
    let (upright, told) = map_of(&bench, "jpg", |image| jpeg_turned(image, 1));
    assert_eq!(told, "");
    let median = |map: &Map| {
        let mut known = map.known();
        known.sort_by(f32::total_cmp);
        known[known.len() / 2]
    };
    assert!((median(&upright) - 6.0).abs() < 0.25);
    // Blocks of 8 x 8 fall alike where the size is a multiple of 8: the same samples, but for rounding.
    let turned: [Encoder; 5] = [
        |image| jpeg_turned(image, 2),
        |image| jpeg_turned(image, 3),
        |image| jpeg_turned(image, 4),
        |image| jpeg_turned(image, 6),
        |image| jpeg_turned(image, 8),
    ];
    for (index, encoder) in turned.into_iter().enumerate() {
        let (map, told) = map_of(&bench, "turned.jpg", encoder);
        assert_eq!((map.width, map.height, told.as_str()), (WIDTH, HEIGHT, ""), "{index}");
        let far = map.px.iter().zip(&upright.px).filter(|(a, b)| (*a - *b).abs() > 0.5).count();
        assert!(far * 50 < map.px.len() && (median(&map) - 6.0).abs() < 0.25, "{index}: {far}");
    }
    let (endless, told) = map_of(&bench, "endless.jpg", |image| {
        let mut bytes = encode(image, ImageFormat::Jpeg);
        bytes.truncate(bytes.len() - 2);
        bytes
    });
    assert!(endless == map_of(&bench, "whole.jpg", |image| encode(image, ImageFormat::Jpeg)).0);
    assert!(told.contains("no end marker") && told.lines().count() == 1, "{told}");
    let pair = Pair::shifted(WIDTH, HEIGHT, 6);
    bench.write("up.jpg", jpeg_turned(&pair.left_image(), 1));
    // Tag 6, but stored upright: it comes out as 40 x 96 px.
    let mut lying = encode(&pair.right_image(), ImageFormat::Jpeg);
    lying.splice(2..2, [&[0xff, 0xe1, 0, 34][..], b"Exif\0\0", &exif(6)].concat());
    bench.write("lying.jpg", lying);
    bench.refuses("depth up.jpg lying.jpg -o map.pfm", &["same size", "EXIF orientation"]);
}

#[test]
fn corrupted_images_end_with_a_map_or_one_line() {
    let bench = Bench::new();
    let pair = Pair::shifted(64, 16, 4);
    pair.write(&bench);
    let whole = encode(&pair.right_image().to_rgb8().into(), ImageFormat::Jpeg);
    // Every byte of the frame's header, where sampling factors, sizes and tables are told.
    let header = whole.windows(2).position(|pair| pair[0] == 0xff && (pair[1] & 0xfe) == 0xc0).unwrap();
    for at in header..header + 20 {
        for value in [0x00, 0x11, 0x41, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] = value;
            bench.write("r.jpg", bytes);
            let line = "depth left.png r.jpg --num-disparities 16";
            let outcome = bench.run(line);
            assert!([0, 2].contains(&outcome.status), "byte {at} as {value}: {outcome:?}");
            if outcome.status == 2 {
                crate::tool::assert_refused(&outcome, line, &["r.jpg"]);
            }
        }
    }
}

#[test]
fn wide_views_are_shrunk_on_request_and_the_rig_follows() {
    let bench = Bench::new();
    let small = Pair::shifted(WIDTH, HEIGHT, 6);
    small.write(&bench);
    let doubled = |view: &[u8]| {
        let pixel = |index: usize| view[index / (2 * WIDTH) / 2 * WIDTH + index % (2 * WIDTH) / 2];
        (0..4 * WIDTH * HEIGHT).map(pixel).collect::<Vec<u8>>()
    };
    let (left, right) = (doubled(&small.left), doubled(&small.right));
    Pair { width: 2 * WIDTH, height: 2 * HEIGHT, left, right }.write_as(&bench, "l.png", "r.png");
    let written = "--num-disparities 16 --baseline-mm 60 --depth-png";
    bench.succeeds(&format!("depth left.png right.png --focal-px 100 {written} plain.png -o plain.pfm"));
    bench.succeeds(&format!("depth l.png r.png --shrink 2 --focal-px 200 {written} d.png -o small.pfm"));
    assert!(bench.read("small.pfm") == bench.read("plain.pfm"));
    assert_eq!(crate::files::png16(&bench.read("d.png")), crate::files::png16(&bench.read("plain.png")));
    write_rig(&bench, &[("width", 2 * WIDTH), ("height", 2 * HEIGHT), ("num_disparities", 32), ("focal_px", 200)]);
    let told = bench.succeeds("depth l.png r.png --rig rig.toml --shrink 2 --json").json();
    let told = ["width", "height", "num_disparities", "focal_px"].map(|key| told[key].as_f64().unwrap() as usize);
    assert_eq!(told, [WIDTH, HEIGHT, 16, 100]);
    // A rig of the small views' size is theirs already.
    std::fs::remove_file(bench.path("rig.toml")).unwrap();
    write_rig(&bench, &[("width", WIDTH), ("height", HEIGHT), ("num_disparities", 16), ("focal_px", 100)]);
    let told = bench.succeeds("depth l.png r.png --rig rig.toml --shrink 2 --json").json();
    let told = ["width", "height", "num_disparities", "focal_px"].map(|key| told[key].as_f64().unwrap() as usize);
    assert_eq!(told, [WIDTH, HEIGHT, 16, 100]);
    bench.write("take/left/a.png", bench.read("l.png"));
    bench.write("take/right/a.png", bench.read("r.png"));
    bench.succeeds("play take --rig rig.toml --shrink 2 -o out");
    bench.refuses("depth l.png r.png --rig rig.toml", &["its width and height are"]);
    let wide = Pair::shifted(1600, 4, 0);
    wide.write_as(&bench, "wl.png", "wr.png");
    bench.refuses("depth wl.png wr.png -o map.pfm", &["1600 px", "32 to 1280", "--shrink 2"]);
    assert_eq!(bench.run("depth wl.png wr.png --shrink 2 -o map.pfm").status, 0);
    bench.refuses("depth l.png r.png --shrink 0", &["--shrink", "1 to 8"]);
}
