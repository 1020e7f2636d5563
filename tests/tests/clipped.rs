//! What the sensor clips: where one view or both are saturated or black, hardly anything is sure, and nothing wrong.

#[allow(dead_code, unused_imports, unused_macros, reason = "the methods have more properties")]
mod common;

use std::ops::Range;

use common::content::{Content, hash};
use common::frame::Frame;
use common::map::{Map, run};
use haarline::confidence::SURE;
use haarline::obstacle::{Mounting, Obstacles, Sectors, Settings};
use haarline::{Config, DisparityRow, Full, Lite, Rig, StereoMethod, blocks_for};

const WIDTH: usize = 160;
const HEIGHT: usize = 96;
const CONFIG: Config = Config { width: 160, min_disparity: 0, num_disparities: 32 };
/// Disparities of what lies behind, and of the panel before it, px.
const BEHIND: i32 = 6;
const PANEL: i32 = 15;
/// Of the rig that looks for obstacles.
const FOCAL_PX: i32 = 200;
/// Pixels beside the panel's outline that it may be seen by, and those that the cell there may share with what is outside.
const RIM: i32 = 12;
const CELL: i32 = 4;
const SEEDS: u32 = 12;
/// What is clipped: black by a sensor that ends at 0 or that has an offset, and white.
const GREYS: [u8; 3] = [0, 16, 255];
const NOISES: [i32; 5] = [0, 1, 2, 5, 10];

/// Which views clip the panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Clipped {
    Both,
    Left,
    Right,
}

const CLIPPED: [Clipped; 3] = [Clipped::Both, Clipped::Left, Clipped::Right];

/// Columns and rows of the left view.
#[derive(Debug, Clone)]
struct Panel {
    columns: Range<i32>,
    rows: Range<i32>,
}

impl Panel {
    fn contains(&self, x: i32, y: i32) -> bool {
        self.columns.contains(&x) && self.rows.contains(&y)
    }

    /// The same without so many pixels along its outline.
    fn inner(&self, by: i32) -> Self {
        let within = |range: &Range<i32>| range.start + by..range.end - by;
        Self { columns: within(&self.columns), rows: within(&self.rows) }
    }
}

/// A textured panel before a textured wall, `grey` all over where it is clipped; then normal noise of deviation `noise`, and
/// what it makes less than black or more than white is clipped.
fn frame(seed: u32, panel: &Panel, clipped: Clipped, grey: u8, noise: i32) -> Frame {
    let [behind, before] = [1, 2].map(|layer| Content::Texture { seed: 8 * seed + layer });
    let noisy = |view: u32, x: i32, y: i32, pixel: u8| {
        // Four dice of 256 sides make a bell of deviation 148.
        let sum: i32 = (0..4).map(|die| i32::from(hash(64 * seed + 8 * view + die, x, y))).sum();
        u8::try_from((i32::from(pixel) + (sum - 510) * noise / 148).clamp(0, 255)).unwrap()
    };
    let look = |view: Clipped, x: i32, y: i32| {
        if clipped == Clipped::Both || clipped == view { grey } else { before.at(x, y) }
    };
    let left = |x: i32, y: i32| if panel.contains(x, y) { look(Clipped::Left, x, y) } else { behind.at(x, y) };
    let right = |x: i32, y: i32| {
        let near = x + PANEL;
        if panel.contains(near, y) { look(Clipped::Right, near, y) } else { behind.at(x + BEHIND, y) }
    };
    Frame::from_fn(WIDTH, HEIGHT, |x, y| noisy(1, x, y, left(x, y)), |x, y| noisy(2, x, y, right(x, y)))
}

fn methods() -> [(&'static str, Box<dyn StereoMethod>); 2] {
    [
        ("full", Box::new(Full::<{ blocks_for(160) }>::new(CONFIG).unwrap())),
        ("lite", Box::new(Lite::<{ blocks_for(160) }>::new(CONFIG).unwrap())),
    ]
}

/// Calls `with` for every way to clip: a name and the frames.
fn each(panel: &Panel, mut with: impl FnMut(&str, &[Frame])) {
    for noise in NOISES {
        for clipped in CLIPPED {
            for grey in GREYS {
                let frames: Vec<Frame> = (0..SEEDS).map(|seed| frame(seed, panel, clipped, grey, noise)).collect();
                with(&format!("noise {noise}, {grey} in {clipped:?}"), &frames);
            }
        }
    }
}

/// Percent of a part of the panel for which something holds of confidence and error, px.
fn share(map: &Map, part: &Panel, holds: impl Fn(u8, f64) -> bool) -> f64 {
    let pixels = part.rows.clone().flat_map(|y| part.columns.clone().map(move |x| (x, y)));
    let is_so = pixels.map(|(x, y)| {
        let at = usize::try_from(y).unwrap() * WIDTH + usize::try_from(x).unwrap();
        let error = map.disparity[at].map_or(0.0, |bits| f64::from(bits) / 16.0 - f64::from(PANEL));
        holds(map.confidence[at], error)
    });
    let all: Vec<bool> = is_so.collect();
    100.0 * all.iter().filter(|&&is_so| is_so).count() as f64 / all.len() as f64
}

#[test]
fn what_one_view_or_both_clip_is_hardly_sure_and_not_wrong() {
    // Where noise is clipped, too, half of it is left, which is less than the frame's: that passes for little texture.
    // A seventh of the view, a fourth and a half.
    for (columns, rows) in [(56..104, 24..72), (56..120, 24..80), (40..136, 12..88)] {
        let panel = Panel { columns, rows };
        for (name, mut method) in methods() {
            each(&panel, |how, frames| {
                let (mut sure, mut wrong) = (0.0, 0.0);
                for frame in frames {
                    let map = run(&mut *method, frame);
                    sure += share(&map, &panel.inner(RIM), |confidence, _| confidence >= SURE);
                    let is_wrong = |confidence, error: f64| confidence >= SURE && error.abs() > 2.0;
                    wrong += share(&map, &panel.inner(CELL), is_wrong);
                }
                let [sure, wrong] = [sure, wrong].map(|sum| sum / f64::from(SEEDS));
                println!("{name}, {how}, {panel:?}: {sure:.2} % sure, {wrong:.2} % sure and wrong");
                assert!(
                    sure <= 6.0 && wrong <= 1.0,
                    "{name}, {how}, {panel:?}: {sure} % sure, {wrong} % sure and wrong"
                );
            });
        }
    }
}

#[test]
fn in_the_direction_of_what_is_clipped_there_is_no_data() {
    let panel = Panel { columns: 40..136, rows: 0..96 };
    // The wall to the left of the panel, the panel but for its rim, the wall to the right; between them what may be either.
    let borders = [-78, -42, -27, 44, 60, 78].map(|column| column * 65_536 / FOCAL_PX);
    let [left_q16 @ .., right_q16] = borders;
    let sectors = Sectors { count: 5, left_q16, right_q16, secant_q14: [1 << 14; 5] };
    let level = Mounting { height_mm: 300, sin_pitch_q14: 0, cos_pitch_q14: 1 << 14, lowest_mm: 50, highest_mm: 600 };
    let rig = Rig::new(200 << 8, 60_000).unwrap();
    let size = [160, 96];
    let mut finder = Obstacles::<5, { blocks_for(160) }>::new(size, rig, level, sectors, Settings::DEFAULT).unwrap();
    for (name, mut method) in methods() {
        each(&panel, |how, frames| {
            let (mut told, mut walls) = (0, 0);
            for frame in frames {
                let mut take = |row: DisparityRow<'_>| finder.push(&row);
                for row in frame.rows() {
                    method.push(row, &mut take).unwrap();
                }
                method.finish(&mut take);
                let [left, _, middle, _, right] = finder.nearest_mm().collect::<Vec<_>>().try_into().unwrap();
                // Whatever is told is the panel itself, at 60 mm x 200 px / 15 px.
                assert!(middle.is_none_or(|mm| mm.abs_diff(800) < 120), "{name}, {how}: {middle:?}");
                told += u32::from(middle.is_some());
                // At 60 mm x 200 px / 6 px.
                walls += [left, right].iter().filter(|wall| wall.is_some_and(|mm| mm.abs_diff(2000) < 300)).count();
            }
            println!("{name}, {how}: {told} told, {walls} walls");
            assert!(told <= 1, "{name}, {how}: told in {told} frames");
            // In more noise the strips of wall beside the panel are too narrow.
            let is_quiet = ["noise 0", "noise 1", "noise 2"].iter().any(|noise| how.starts_with(&format!("{noise},")));
            assert!(walls > 0 || !is_quiet, "{name}, {how}: nothing is told at all");
        });
    }
}
