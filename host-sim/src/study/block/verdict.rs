//! What the trials say of the paper's three claims, in words made from the figures.

use super::{GATED, OPPONENT, PARTS, READINGS, Trial, find};

/// Whether each claim holds, for both readings.
pub(super) fn text(trials: &[Trial]) -> String {
    let readings = READINGS.map(|reading| {
        let claims = [cost(trials, reading), robustness(trials, reading), location(trials, reading)];
        format!("{reading}. {}", claims.join(" "))
    });
    format!("Against block with its gates off. {} {}", readings.join(" "), attribution(trials))
}

/// What brings it: reading (b) without one of its parts.
fn attribution(trials: &[Trial]) -> String {
    let tot2 = |method, frames| find(trials, method, frames).map_or(f64::NAN, |trial| trial.mean.tot2);
    let [whole, unsmoothed, start_only, block] = [READINGS[1], PARTS[0], PARTS[1], OPPONENT]
        .map(|method| ["clean", "sigma 10"].map(|frames| format!("{:.2}", tot2(method, frames))).join(" and "));
    format!(
        "Not all of this is the search's. tot2 of reading (b), clean and at sigma 10, is {whole}; {unsmoothed} without \
         the smoothing that the noise asks for, which block has not; {start_only} where the best of the starts, contour \
         seeds and neighbours, is the answer; block's is {block}."
    )
}

/// Pairs of trials, the opponent's and the reading's, on frames of those names.
fn pairs<'a>(trials: &'a [Trial], reading: &'a str, frames: &'a [&str]) -> impl Iterator<Item = [&'a Trial; 2]> {
    frames.iter().filter_map(move |frames| Some([find(trials, OPPONENT, frames)?, find(trials, reading, frames)?]))
}

/// "Energy lower by nearly a factor of 2". The chip has block with its gates, which take few of its instructions.
fn cost(trials: &[Trial], reading: &str) -> String {
    let (mut least, mut no_worse, mut words) = (f64::INFINITY, true, Vec::new());
    for [block, wavelet] in pairs(trials, reading, &["clean", "sigma 10"]) {
        let lost = block.tot2.iter().zip(&wavelet.tot2).filter(|(block, wavelet)| wavelet > block).count();
        no_worse &= wavelet.mean.tot2 <= block.mean.tot2;
        let accuracy = format!(
            "tot2 {:.2} against {:.2} (higher on {lost} of {} scenes)",
            wavelet.mean.tot2,
            block.mean.tot2,
            wavelet.tot2.len()
        );
        let gated = find(trials, GATED, wavelet.frames).and_then(|trial| trial.instructions);
        let instructions = match (gated, wavelet.instructions) {
            (Some(block), Some(wavelet)) => {
                least = least.min(block / wavelet);
                format!("{wavelet:.0} instructions per pixel against {block:.0}, {:.2} times fewer", block / wavelet)
            }
            _ => "instructions not counted".to_owned(),
        };
        words.push(format!("{}: {instructions}, {accuracy}", wavelet.frames));
    }
    let verdict = match (least.is_finite(), least >= 2.0 && no_worse) {
        (false, _) => "cannot be judged without the emulated chip (--elf), which has reading (b)",
        (true, true) => "holds for instructions",
        (true, false) => "does not hold for instructions",
    };
    format!("Energy / 2 {verdict}. {}.", words.join("; "))
}

/// "More noise robust": under every noise fewer wrong or unanswered, and less of a rise over the clean frames.
fn robustness(trials: &[Trial], reading: &str) -> String {
    let clean: Vec<_> = pairs(trials, reading, &["clean"]).collect();
    let Some([clean_block, clean_wavelet]) = clean.first() else { return String::new() };
    let (mut holds, mut words) = (true, Vec::new());
    for [block, wavelet] in pairs(trials, reading, &["sigma 5", "sigma 10", "sigma 20"]) {
        let rises = [wavelet.mean.tot2 - clean_wavelet.mean.tot2, block.mean.tot2 - clean_block.mean.tot2];
        holds &= wavelet.mean.tot2 <= block.mean.tot2 && rises[0] <= rises[1];
        words.push(format!("{}: {:.1} against {:.1} points", wavelet.frames, rises[0], rises[1]));
    }
    let verdict = if holds { "holds" } else { "does not hold" };
    format!("More noise robust {verdict}; rise of tot2 over clean frames: {}.", words.join("; "))
}

/// "Less location error".
fn location(trials: &[Trial], reading: &str) -> String {
    let (mut holds, mut words) = (true, Vec::new());
    for [block, wavelet] in pairs(trials, reading, &super::DEGRADATIONS.map(|(frames, _)| frames)) {
        let (Some(of_block), Some(of_wavelet)) = (block.mean.epe, wavelet.mean.epe) else { continue };
        holds &= of_wavelet <= of_block;
        words.push(format!("{}: {of_wavelet:.2} against {of_block:.2} px", wavelet.frames));
    }
    let verdict = if holds { "holds" } else { "does not hold in all frames" };
    format!("Less location error {verdict}: {}.", words.join("; "))
}
