//! MCAP recordings of two cameras, as ROS writes them.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;

use image::{DynamicImage, ImageFormat};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};

use crate::corruption::{Random, assert_documented};
use crate::files::encode;
use crate::scene::Pair;
use crate::tool::{Bench, assert_one_error_line};

const SIZE: [usize; 2] = [96, 24];
const SEARCH: &str = "--method lite --num-disparities 16";
/// 20 Hz.
const PERIOD: u64 = 50_000_000;

/// Writes CDR, little-endian.
struct Cdr(Vec<u8>);

impl Cdr {
    /// A message that begins with a header.
    fn new(nanoseconds: u64) -> Self {
        let mut cdr = Self(vec![0, 1, 0, 0]);
        cdr.number((nanoseconds / 1_000_000_000) as u32);
        cdr.number((nanoseconds % 1_000_000_000) as u32);
        cdr.text("camera");
        cdr
    }

    fn number(&mut self, number: u32) {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        self.0.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.bytes(&[text.as_bytes(), &[0]].concat());
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u32);
        self.0.extend(bytes);
    }
}

/// `sensor_msgs/msg/Image`, with rows padded by 3 bytes.
fn image(time: u64, view: &DynamicImage, encoding: &str) -> Vec<u8> {
    let mut cdr = Cdr::new(time);
    let (width, height) = (view.width(), view.height());
    let bytes = match encoding {
        "mono8" => view.to_luma8().into_raw(),
        _ => view.to_rgb8().pixels().flat_map(|pixel| [pixel[2], pixel[1], pixel[0]]).collect(),
    };
    let row = bytes.len() / height as usize;
    cdr.number(height);
    cdr.number(width);
    cdr.text(encoding);
    cdr.0.push(0);
    cdr.number(row as u32 + 3);
    cdr.bytes(&bytes.chunks(row).flat_map(|row| row.iter().copied().chain([9; 3])).collect::<Vec<u8>>());
    cdr.0
}

/// `sensor_msgs/msg/CompressedImage`.
fn compressed(time: u64, view: &DynamicImage) -> Vec<u8> {
    let mut cdr = Cdr::new(time);
    cdr.text("png");
    cdr.bytes(&encode(view, ImageFormat::Png));
    cdr.0
}

/// A message: topic, type, time when it was recorded, content.
type Entry<'a> = (&'a str, &'a str, u64, Vec<u8>);

/// Writes a recording of these messages in their order, in chunks of about one frame.
fn write(bench: &Bench, name: &str, compression: Option<Compression>, entries: &[Entry<'_>]) {
    let options = WriteOptions::new().compression(compression).chunk_size(Some(8000));
    let mut writer = options.create(BufWriter::new(File::create(bench.path(name)).unwrap())).unwrap();
    for (sequence, (topic, schema, time, data)) in entries.iter().enumerate() {
        let schema = writer.add_schema(&format!("sensor_msgs/msg/{schema}"), "ros2msg", b"").unwrap();
        let channel_id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap();
        let (log_time, sequence) = (*time, sequence as u32);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
}

fn pair(moment: u64) -> Pair {
    Pair::shifted(SIZE[0], SIZE[1], moment as i64 + 2)
}

fn time(moment: u64) -> u64 {
    1_700_000_000_000_000_000 + moment * PERIOD
}

/// Left and right views of the moments, the right ones 2 ms late, as pixels of this encoding.
fn views(moments: [&[u64]; 2], encoding: &str) -> Vec<Entry<'static>> {
    let left = moments[0].iter().map(|&moment| {
        let at = time(moment);
        ("/cam0/image_raw", "Image", at, image(at, &pair(moment).left_image(), encoding))
    });
    let right = moments[1].iter().map(|&moment| {
        let at = time(moment) + 2_000_000;
        ("/cam1/image_raw", "Image", at, image(at, &pair(moment).right_image(), encoding))
    });
    let mut all: Vec<_> = left.chain(right).collect();
    all.sort_by_key(|entry| entry.2);
    all
}

/// The moment that each map tells; none of a damaged frame.
fn played(bench: &Bench) -> Vec<Option<u64>> {
    let table = fs::read_to_string(bench.path("out/frames.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = lines.next().unwrap().iter().position(|name| *name == "median_disparity_px").unwrap();
    lines.map(|line| line[column].parse().ok().map(|px: f64| px.round() as u64 - 2)).collect()
}

#[test]
fn two_topics_are_paired_by_their_time_stamps() {
    for (encoding, compression) in
        [("mono8", None), ("bgr8", Some(Compression::Zstd)), ("mono8", Some(Compression::Lz4))]
    {
        let bench = Bench::new();
        write(&bench, "take.mcap", compression, &views([&[0, 1, 3, 4], &[0, 2, 3, 4]], encoding));
        let outcome = bench.run(&format!("play take.mcap -o out {SEARCH}"));
        assert_eq!(outcome.status, 1, "{outcome:?}");
        assert!(outcome.stderr.contains("2 of 5 frames were damaged"), "{}", outcome.stderr);
        assert_eq!(played(&bench), [Some(0), None, None, Some(3), Some(4)], "{encoding}");
        assert!(bench.path(format!("out/{}.pfm", time(3))).exists(), "named by the left view's time");
    }
}

#[test]
fn compressed_images_and_topics_of_any_name_are_read() {
    let bench = Bench::new();
    let entry = |topic, view: DynamicImage, at| (topic, "CompressedImage", at, compressed(at, &view));
    let entries: Vec<Entry<'_>> = (0..3)
        .flat_map(|moment| {
            let (left, right) = (pair(moment).left_image(), pair(moment).right_image());
            [("/port", left, time(moment)), ("/starboard", right, time(moment))]
        })
        .map(|(topic, view, at)| entry(topic, view, at))
        .collect();
    write(&bench, "take.mcap", Some(Compression::Zstd), &entries);
    bench.refuses("play take.mcap -o out", &["--left TOPIC", "/port, /starboard"]);
    bench.refuses("play take.mcap -o out --left /port --right /aft", &["--right /aft", "/starboard"]);
    bench.refuses("play take.mcap -o out --layout top-bottom --first left", &["--left TOPIC"]);
    bench.succeeds(&format!("play take.mcap -o out --left /port --right star* {SEARCH}"));
    assert_eq!(played(&bench), [0, 1, 2].map(Some));
    bench.succeeds("record --recording take.mcap --left /port --right /starboard --wiring line -o take.raw");
    assert_eq!(bench.read("take.raw").len(), 3 * 2 * SIZE[0] * SIZE[1]);
}

/// `sensor_msgs/Image` as ROS 1 writes it: packed, little-endian, texts without a zero at their end.
fn ros1_image(time: u64, view: &DynamicImage) -> Vec<u8> {
    let number = |number: u32| number.to_le_bytes();
    let text = |text: &str| [&number(text.len() as u32), text.as_bytes()].concat();
    let [width, height] = [view.width(), view.height()];
    let pixels = view.to_luma8().into_raw();
    let stamp = [number((time / 1_000_000_000) as u32), number((time % 1_000_000_000) as u32)].concat();
    let header = [&number(7)[..], &stamp, &text("camera")].concat();
    let layout = [&number(height)[..], &number(width), &text("mono8"), &[0], &number(width)].concat();
    [header, layout, number(pixels.len() as u32).to_vec(), pixels].concat()
}

#[test]
fn recordings_of_ros_1_are_read() {
    let bench = Bench::new();
    let file = BufWriter::new(File::create(bench.path("take.mcap")).unwrap());
    let mut writer = WriteOptions::new().profile("ros1").create(file).unwrap();
    let schema = writer.add_schema("sensor_msgs/Image", "ros1msg", b"").unwrap();
    for moment in [0, 1, 2] {
        for (topic, view) in [("/left/image", pair(moment).left_image()), ("/right/image", pair(moment).right_image())]
        {
            let channel_id = writer.add_channel(schema, topic, "ros1", &BTreeMap::new()).unwrap();
            let log_time = time(moment);
            let header = MessageHeader { channel_id, sequence: moment as u32, log_time, publish_time: log_time };
            writer.write_to_known_channel(&header, &ros1_image(log_time, &view)).unwrap();
        }
    }
    writer.finish().unwrap();
    bench.succeeds(&format!("play take.mcap -o out {SEARCH}"));
    assert_eq!(played(&bench), [0, 1, 2].map(Some));
    assert!(bench.path(format!("out/{}.pfm", time(2))).exists(), "named by the left view's time");
}

#[test]
fn stamps_that_are_not_set_give_way_to_the_times_of_recording() {
    let bench = Bench::new();
    let unset = |(topic, schema, at, _): Entry<'static>| {
        let pair = pair((at - time(0)) / PERIOD);
        let view = if topic == "/cam0/image_raw" { pair.left_image() } else { pair.right_image() };
        (topic, schema, at, image(0, &view, "mono8"))
    };
    let entries: Vec<_> = views([&[0, 1, 2], &[0, 1, 2]], "mono8").into_iter().map(unset).collect();
    write(&bench, "take.mcap", None, &entries);
    bench.succeeds(&format!("play take.mcap -o out {SEARCH}"));
    assert_eq!(played(&bench), [0, 1, 2].map(Some));
}

#[test]
fn what_cannot_be_read_is_told_in_one_line() {
    let bench = Bench::new();
    bench.write("text.mcap", "no recording");
    bench.refuses("play text.mcap -o out", &["text.mcap", "does not begin as an MCAP file"]);
    bench.write("short.mcap", b"\x89MCAP0");
    bench.refuses("play short.mcap -o out", &["short.mcap", "does not begin as an MCAP file"]);
    bench.write("empty.mcap", "");
    bench.refuses("play empty.mcap -o out", &["empty.mcap", "is empty"]);
    write(&bench, "imu.mcap", None, &[("/imu", "Imu", 1, vec![0; 8])]);
    bench.refuses("play imu.mcap -o out", &["sensor_msgs/Image", "sensor_msgs/msg/Imu"]);
    let mosaic = views([&[0], &[0]], "mono8")
        .into_iter()
        .map(|(topic, schema, at, _)| (topic, schema, at, image(time(0), &pair(0).left_image(), "bayer_rggb8")));
    write(&bench, "bayer.mcap", None, &mosaic.collect::<Vec<_>>());
    let outcome = bench.run("play bayer.mcap -o out");
    assert_eq!(outcome.status, 1, "{outcome:?}");
    assert!(outcome.stderr.contains("bayer_rggb8"), "{}", outcome.stderr);
    bench.refuses("play bayer.mcap -o . --mavlink bayer.mcap --rig r.toml", &[]);
}

#[test]
fn a_recording_that_is_cut_off_or_damaged_gives_what_is_whole() {
    let bench = Bench::new();
    let moments: Vec<u64> = (0..6).collect();
    let take = || views([&moments, &moments], "mono8");
    write(&bench, "take.mcap", None, &take());
    let bytes = bench.read("take.mcap");
    bench.write("cut.mcap", &bytes[..bytes.len() / 2]);
    let outcome = bench.run(&format!("play cut.mcap -o out {SEARCH}"));
    assert!(outcome.stderr.contains("cut.mcap: is cut off"), "{outcome:?}");
    let found: Vec<u64> = played(&bench).into_iter().flatten().collect();
    assert!((2..5).contains(&found.len()) && found == moments[..found.len()], "{found:?}");
    // A changed pixel fails the chunk's checksum: the frames in it are no measurement.
    fs::remove_dir_all(bench.path("out")).unwrap();
    let mut damaged = bytes.clone();
    damaged[bytes.len() / 3] ^= 64;
    bench.write("damaged.mcap", &damaged);
    let outcome = bench.run(&format!("play damaged.mcap -o out {SEARCH}"));
    assert_eq!(outcome.status, 1, "{outcome:?}");
    let found = played(&bench);
    assert!(found.iter().filter(|moment| moment.is_none()).count() >= 1, "{found:?}");
    assert!(found.iter().zip(&moments).all(|(found, moment)| found.is_none_or(|found| found == *moment)), "{found:?}");
}

#[test]
fn no_corruption_gives_a_wrong_row_or_a_fault() {
    let mut random = Random::new();
    for (compression, cases) in [(None, 80), (Some(Compression::Zstd), 60), (Some(Compression::Lz4), 60)] {
        let bench = Bench::new();
        write(&bench, "take.mcap", compression, &views([&[0, 1, 2], &[0, 1, 2]], "mono8"));
        let line = |name: &str| format!("play {name}.mcap -o {name} {SEARCH} --write disparity --min-confidence 0");
        bench.succeeds(&line("take"));
        let whole = bench.read("take.mcap");
        let mut right = 0;
        for case in 0..cases {
            bench.write("bad.mcap", random.corrupt(&whole));
            let outcome = bench.run(&line("bad"));
            assert_documented(&outcome, &[0, 1, 2], &format!("{compression:?}, case {case}"));
            if outcome.status == 2 {
                assert_one_error_line(&outcome.stderr, "bad.mcap");
                continue;
            }
            for entry in fs::read_dir(bench.path("bad")).unwrap() {
                let name = entry.unwrap().file_name().into_string().unwrap();
                if name.ends_with(".pfm") {
                    let is_right = fs::read(bench.path(format!("take/{name}")))
                        .is_ok_and(|map| map == bench.read(&format!("bad/{name}")));
                    assert!(
                        is_right,
                        "{compression:?}, case {case}: {name} is not the map of that moment: {outcome:?}"
                    );
                    right += 1;
                }
            }
            fs::remove_dir_all(bench.path("bad")).unwrap();
        }
        assert!(right * 2 > cases, "{compression:?}: {right} right maps of {cases} files");
    }
}
