//! The paper's Table 1 in joules: what a pixel takes by every method, next to published stereo hardware.

use std::fmt::Write as _;

use anyhow::Result;

use super::accuracy::Accuracy;
use super::budget::{MODEL, Planner, Request};
use super::comparison::full_load_nj;
use super::counting::METHODS;
use super::counts::Input;
use super::currents::Board;

/// The boards that there is a program for.
pub const BOARDS: [Board; 2] = [Board::H743, Board::U575];

/// Something published.
struct Peer {
    what: &'static str,
    figure: &'static str,
    source: &'static str,
}

const PEERS: [Peer; 4] = [
    Peer {
        what: "stereo coprocessor, semi-global matching (ASIC)",
        figure: "4.29 nJ/px",
        source: "not verified: \"A 4.29nJ/pixel Stereo Depth Coprocessor With Pixel Level Pipeline and Region Optimized \
                 Semi-Global Matching for IoT Application\", by its title from memory",
    },
    Peer {
        what: "stereo processor (ASIC)",
        figure: "12.2 nJ/px",
        source: "not verified: from the project's notes, the paper was not looked up",
    },
    Peer {
        what: "VL53L5CX, time of flight, 8x8 zones",
        figure: "286 mW; at 15 Hz (not verified) 298 uJ a zone",
        source: "286 mW typical: Bitcraze's blog, \"Towards Autonomous Flight on Nano-Drones with Multi-zone Depth Sensors\", \
                 September 2022",
    },
    Peer {
        what: "OpenMV AE3, a whole camera",
        figure: "50 to 60 mA",
        source: "not verified: from the project's notes",
    },
];

/// The tables, as Markdown. `request` tells size and disparities; method and board are all of them.
///
/// # Errors
/// If the methods were not counted at that size.
pub fn markdown(planner: &Planner<'_>, accuracy: &[Accuracy], request: &Request) -> Result<String> {
    let Request { width, height, disparities, .. } = *request;
    let scenes = accuracy.first().map_or(0, |one| one.scenes);
    let mut text = format!(
        "**{MODEL}.** {width}x{height} px, {disparities} disparities, clean frames; energy of the core alone while it works at \
         its highest clock, nJ a pixel (least to most by the model of cycles); mJ a frame. Accuracy: means of {scenes} \
         recorded scenes, clean; noisy is noise of 10 grey levels.\n\n"
    );
    let names = BOARDS.map(|board| planner.currents.chip(board).name.as_str());
    let _ = writeln!(
        text,
        "| method | {}, instructions/px | nJ/px | mJ/frame | {}, instructions/px | nJ/px | mJ/frame | density, % | bad2, % | \
         tot2, % | tot2 noisy, % |",
        names[0], names[1]
    );
    let _ = writeln!(text, "| --- |{}", " ---: |".repeat(10));
    let mut sources: Vec<String> = Vec::new();
    for method in METHODS {
        let mut cells = Vec::new();
        for board in BOARDS {
            let plan = planner.plan(&Request { board, method, ..*request })?;
            cells.push(format!("{:.0}", plan.instructions_per_pixel.clean.mean.all()));
            let energy = full_load_nj(planner, &plan);
            cells.push(format!("{:.1} ({:.1} to {:.1})", energy.likely, energy.least, energy.most));
            cells.push(format!("{:.2}", energy.likely * f64::from(width) * f64::from(height) / 1e6));
        }
        let clean = Accuracy::of(accuracy, method, Input::Clean);
        let noisy = Accuracy::of(accuracy, method, Input::Noisy);
        let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        cells.extend([clean.map(|one| one.density), clean.map(|one| one.bad2), clean.map(|one| one.tot2)].map(figure));
        cells.push(figure(noisy.map(|one| one.tot2)));
        let _ = writeln!(text, "| {method} | {} |", cells.join(" | "));
    }
    text.push_str("\n| published | figure | source |\n| --- | --- | --- |\n");
    for Peer { what, figure, source } in PEERS {
        let _ = writeln!(text, "| {what} | {figure} | {source} |");
    }
    for board in BOARDS {
        let chip = planner.currents.chip(board);
        let (point, cycles) = (&chip.points[0], chip.core.cycles());
        sources.push(format!(
            "{} at {} MHz runs with {} mA: {}",
            chip.name,
            point.mhz,
            point.run.ma,
            point.run.source()?
        ));
        sources.push(format!(
            "{:.2} ({:.2} to {:.2}) cycles an instruction on the {}: not verified, a model of classes of instructions",
            cycles.likely,
            cycles.least,
            cycles.most,
            chip.core.name()
        ));
    }
    text.push_str("\nIt rests on:\n\n");
    for source in sources {
        let _ = writeln!(text, "- {source}");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::power::plan::cost::Costs;
    use crate::power::plan::currents::Currents;
    use crate::stereo::method::MethodKind;

    #[test]
    fn every_method_and_every_mark_is_told() {
        let (costs, currents) = (Costs::stored().unwrap(), Currents::own().unwrap());
        let planner = Planner { costs: &costs, currents: &currents };
        let request = Request {
            board: Board::H743,
            method: MethodKind::Full,
            width: 320,
            height: 240,
            disparities: 48,
            fps: 30.0,
            sensor: None,
            exposure_lines: None,
            battery: None,
        };
        let text = markdown(&planner, &Accuracy::stored().unwrap(), &request).unwrap();
        assert!(text.starts_with("**model, not measured.**"));
        for method in METHODS {
            let line = text.lines().find(|line| line.starts_with(&format!("| {method} |"))).unwrap();
            assert!(!line.contains(" - "), "{line}");
        }
        let marks = |text: &str| text.matches("not verified").count();
        assert!(PEERS.iter().all(|peer| !peer.source.is_empty() && text.contains(peer.source)));
        assert!(marks(&text) >= 4 + 4, "{text}");
    }
}
