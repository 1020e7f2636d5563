//! The steps, in the order in which a rig is wired.

use core::fmt::Write;

use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_time::{Duration, Instant, Timer};
use haarline_firmware::app::settings::{FRAME_RATE, HEIGHT};
use haarline_firmware::board::camera::Camera;
use haarline_firmware::board::dma_memory::DmaCell;
use haarline_firmware::board::idle;
use haarline_firmware::board::pair::{IS_TRIGGERED, LINE_LENGTH, MASTER_HZ, Model, SETUPS, WINDOW};
use haarline_firmware::board::sensors::{self, Bus, Sensors};
use haarline_firmware::board::serial::Serial;
use haarline_firmware::board::this::clock;
use haarline_firmware::board::this::parts::Parts;
use haarline_firmware::board::this::start::Started;
use haarline_firmware::board::this::{SERIES, start};
use haarline_firmware::bringup::lines::{MOST, Patterns, Seen, Wrong, late_samples};
use haarline_firmware::bringup::signals::{Counted, Verdict};
use haarline_firmware::dma_cell;
use haarline_firmware::sensor::{self, Sensor, SensorError};

use crate::report::Report;
use crate::survey::{self, ROW};

/// How long signals are counted: a few frames, of at least one a second.
const COUNT: Duration = Duration::from_micros(4_000_000 / FRAME_RATE as u64);
/// How long a frame is waited for.
const PATIENCE: Duration = Duration::from_micros(8_000_000 / FRAME_RATE as u64);
/// Lines of both sensors on which patterns can be told.
const LINES: usize = 2 * Model::PATTERN_LINES;
/// What a first sensor's lines are, and a second one's.
const FIRST: u16 = (1 << Model::PATTERN_LINES) - 1;
const SECOND: u16 = FIRST << Model::PATTERN_LINES;

type Text = heapless::String<192>;

/// One frame. This program alone keeps one: to look at.
static FRAME: DmaCell<[[u8; ROW]; HEIGHT as usize]> = dma_cell!([[u8; ROW]; HEIGHT as usize]);

#[cortex_m_rt::entry]
fn main() -> ! {
    let Started { peripherals, mut core, .. } = start::start();
    idle::run(&mut core.SCB, |spawner: Spawner| {
        let Parts { camera, sensors, rows, .. } = Parts::new(peripherals);
        // Once, here.
        spawner.spawn(bringup(camera, sensors, rows).unwrap());
    })
}

#[embassy_executor::task]
async fn bringup(mut camera: Camera, mut sensors: Sensors, rows: Serial) {
    let mut report = Report::default();
    chip(&mut report);
    buses(&mut report, &mut sensors.buses);
    if let Some(addresses) = set_up(&mut report, &mut sensors.buses).await
        && signals(&mut report, &mut camera, &mut sensors, addresses).await
    {
        data(&mut report, &mut camera, &mut sensors.buses, addresses).await;
        picture(&mut report, &mut camera, rows).await;
    }
    report.end();
    core::future::pending::<()>().await;
}

/// Step 1: chip and clock.
fn chip(report: &mut Report) {
    let revision = start::revision();
    let mut text = Text::new();
    let mhz = clock::core_hz(revision) / 1_000_000;
    let _ = write!(text, "{SERIES} revision {} ({:#06x}), {mhz} MHz", revision.name(), revision.0);
    match start::told_source() {
        Ok(source) => report.good(1, &format_args!("{text}{source}")),
        Err(source) => report.bad(1, &format_args!("{text}{source}")),
    }
}

/// Step 2: who answers on the buses.
fn buses(report: &mut Report, buses: &mut [Bus; 2]) {
    let mut silent = 0;
    for (number, bus) in (1..).zip(buses.iter_mut().take(SETUPS.len())) {
        let mut text = Text::new();
        for address in 8..0x78 {
            if sensor::Bus::write_read(bus, address, &[0], &mut [0]).is_ok() {
                let _ = write!(text, " {address:#04x}");
            }
        }
        if text.is_empty() {
            silent += 1;
            report.bad(2, &format_args!("nobody answers on I2C bus {number}: {}", sensors::pins(number - 1)));
        } else {
            report.good(2, &format_args!("on I2C bus {number} answers:{text}"));
        }
    }
    if silent == SETUPS.len() {
        report.bad(
            2,
            &format_args!(
                "no sensor at all: most likely the master clock's wire ({} kHz on PA8), or the supply",
                MASTER_HZ / 1000
            ),
        );
    }
}

/// Step 3: what they are, and whether they hold what is written. The addresses, if all is well.
async fn set_up(report: &mut Report, buses: &mut [Bus; 2]) -> Option<[u8; 2]> {
    let mut addresses = [None; SETUPS.len()];
    for (nth, ((bus, setup), place)) in buses.iter_mut().zip(SETUPS).zip(&mut addresses).enumerate() {
        let number = nth + 1;
        match sensors::try_set_up(bus, setup, &mut false).await {
            Ok(address) => {
                *place = Some(address);
                report.good(3, &format_args!("sensor {number} is an {} and holds what was written", Model::NAME));
            }
            Err(SensorError::Silent(_)) => report.bad(
                3,
                &format_args!("sensor {number} does not answer: {}, its supply, its clock", sensors::pins(nth)),
            ),
            Err(SensorError::Model(model)) => {
                report.bad(3, &format_args!("sensor {number} is no {} but says {model:#06x}", Model::NAME));
            }
            Err(SensorError::Forgets(register, written, found)) => report.bad(
                3,
                &format_args!("sensor {number} holds {found:#06x} where {written:#06x} was written, register {register:#06x}: its supply"),
            ),
        }
    }
    let mut found = [0; 2];
    for (place, address) in found.iter_mut().zip(addresses) {
        *place = address?;
    }
    Some(found)
}

/// Step 4: clocks and sync signals; whether frames come.
async fn signals(report: &mut Report, camera: &mut Camera, sensors: &mut Sensors, addresses: [u8; 2]) -> bool {
    tell_all(&mut sensors.buses, addresses, |setup| Some(Model::start(setup)));
    if IS_TRIGGERED {
        sensors.trigger.start();
    }
    camera.begin();
    // The first frames may be of before.
    survey::count(camera, COUNT).await;
    let begun = Instant::now();
    let counted = survey::count(camera, COUNT).await;
    let mut free = None;
    if Verdict::of(counted, None) != Verdict::Good && Model::free_running().is_some() {
        tell_all(&mut sensors.buses, addresses, |_| Model::free_running());
        survey::count(camera, COUNT).await;
        free = Some(survey::count(camera, COUNT).await);
    }
    match Verdict::of(counted, free) {
        Verdict::Good => rates(report, counted, begun),
        wrong => report.bad(4, &wrong),
    }
    Verdict::of(counted, free) == Verdict::Good
}

/// What came in the time.
fn rates(report: &mut Report, counted: Counted, begun: Instant) {
    let us = begun.elapsed().as_micros().max(1);
    let tenths = u64::from(counted.frames) * 10_000_000 / us;
    let lines = counted.lines / counted.frames.max(1);
    let [pixels, height] = WINDOW;
    let text = format_args!(
        "{}.{} frames a second, about {lines} lines each ({height} expected), {} of {} lines with {pixels} pixels, a line of {LINE_LENGTH} clocks at {} kHz",
        tenths / 10,
        tenths % 10,
        counted.whole,
        counted.lines,
        MASTER_HZ / 1000
    );
    // A frame under way at the beginning or the end is no whole one.
    if counted.whole < counted.lines || lines < u32::from(height) * 3 / 4 || lines > u32::from(height) * 3 / 2 {
        report.bad(4, &text);
    } else {
        report.good(4, &text);
    }
}

/// Steps 5 and 6: each data line, and whether the second sensor is in step with the first.
async fn data(report: &mut Report, camera: &mut Camera, buses: &mut [Bus; 2], addresses: [u8; 2]) {
    if LINES == 0 {
        report.good(5, &"data lines: these sensors have no pattern that tells them, look at the picture");
        return;
    }
    let mut patterns = Patterns { lines: LINES, low: Seen::NOTHING, high: Seen::NOTHING, alone: [Seen::NOTHING; MOST] };
    let sent = [0, FIRST | SECOND].into_iter().chain((0..LINES).map(|line| 1 << line));
    let Patterns { low, high, alone, .. } = &mut patterns;
    for (lines, place) in sent.zip([low, high].into_iter().chain(alone)) {
        show(buses, addresses, Some(lines));
        let Some(seen) = survey::seen(camera, PATIENCE).await else {
            report.bad(5, &"no frame came while patterns were shown");
            return;
        };
        *place = seen;
    }
    let mut wrong = 0;
    patterns.wrong(|one: Wrong| {
        wrong += 1;
        report.bad(5, &one);
    });
    if wrong == 0 {
        report.good(5, &format_args!("data lines: all {LINES} carry what they should, and nothing else"));
    }
    show(buses, addresses, Some(FIRST | SECOND));
    let mut late = 0;
    survey::frame(camera, PATIENCE, |nth, row| {
        if nth == usize::from(WINDOW[1]) / 2 {
            late = late_samples(survey::samples(row), patterns.high.any & FIRST, patterns.high.any & SECOND);
        }
    })
    .await;
    match late {
        0 => report.good(6, &"phase: both sensors begin a line with the same clock"),
        late => report.bad(
            6,
            &format_args!("phase: the second sensor is {late} pixel clocks late: clock or trigger of the two have different wires, or one needs a new start"),
        ),
    }
    show(buses, addresses, None);
}

/// Shows a pattern, a bit for each line of the port.
fn show(buses: &mut [Bus; 2], addresses: [u8; 2], lines: Option<u16>) {
    for ((nth, bus), address) in buses.iter_mut().enumerate().zip(addresses).take(SETUPS.len()) {
        let own = lines.map(|lines| lines >> (nth * Model::PATTERN_LINES) & FIRST);
        let _ = sensor::apply::<Model, _>(bus, address, Model::pattern(own));
    }
}

fn tell_all(
    buses: &mut [Bus; 2],
    addresses: [u8; 2],
    setting: impl Fn(<Model as Sensor>::Setup) -> Option<sensor::Setting>,
) {
    for ((bus, address), setup) in buses.iter_mut().zip(addresses).zip(SETUPS) {
        if let Some(setting) = setting(setup) {
            let _ = sensor::apply::<Model, _>(bus, address, setting);
        }
    }
}

/// Step 7: one frame, out of the row packets' port.
async fn picture(report: &mut Report, camera: &mut Camera, mut rows: Serial) {
    let frame = FRAME.fill(|| [0; ROW]);
    let is_whole = survey::frame(camera, PATIENCE, |nth, row| {
        if let Some(place) = frame.get_mut(nth) {
            place.copy_from_slice(row);
        }
    });
    if !is_whole.await {
        return report.bad(7, &"no frame came");
    }
    let (mut least, mut most) = (u8::MAX, 0);
    for &byte in frame.as_flattened() {
        (least, most) = (least.min(byte), most.max(byte));
    }
    for row in frame.iter() {
        if rows.send(row).await.is_err() {
            return report.bad(7, &"the serial port's DMA failed");
        }
    }
    // The last bytes are still on the wire.
    Timer::after_millis(5).await;
    report.good(
        7,
        &format_args!("a raw frame of {} bytes, {least} to {most}, left by the row packets' port", ROW * frame.len()),
    );
}
