//! The first program: the core on a Cortex-M, fed with a picture it makes itself.
//!
//! It shows that the pipeline links and fits, and how it is driven: rows in, rows out. Cameras,
//! tasks and telemetry are not here yet.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip {
    use core::sync::atomic::{AtomicU32, Ordering};
    use haarline::{Config, Lite, ScanlinePair, StereoMethod, blocks_for};
    use haarline_firmware::picture::{self, HEIGHT, WIDTH};
    use panic_halt as _;
    use static_cell::StaticCell;

    type Pipeline = Lite<{ blocks_for(WIDTH) }>;

    /// The pipeline's whole state.
    static PIPELINE: StaticCell<Pipeline> = StaticCell::new();

    /// Frames done, and pixels of the last one that were answered: for a debugger to look at.
    static FRAMES: AtomicU32 = AtomicU32::new(0);
    static KNOWN: AtomicU32 = AtomicU32::new(0);

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let config = Config { num_disparities: 32, ..Config::for_width(WIDTH) };
        let Ok(pipeline) = Lite::new(config) else { panic!("the configuration above is valid") };
        let pipeline = PIPELINE.init(pipeline);
        loop {
            let mut known = 0;
            let mut count = |row: haarline::DisparityRow<'_>| {
                known += row.disparity.iter().map(|d| u32::from(d.is_known())).sum::<u32>();
            };
            for y in 0..HEIGHT {
                let (left, right) = picture::rows(y);
                // Rows of `WIDTH` pixels are what was configured, so none is refused.
                let _ = pipeline.push(ScanlinePair { left: &left, right: &right }, &mut count);
            }
            pipeline.finish(&mut count);
            KNOWN.store(known, Ordering::Relaxed);
            FRAMES.fetch_add(1, Ordering::Relaxed);
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on a Cortex-M. With a board on a probe:");
    println!("  cargo run -p haarline-firmware --profile firmware --target thumbv7em-none-eabihf");
}
