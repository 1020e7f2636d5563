//! What the figures say, in words made from them.

use super::{Figures, Found, SEARCHERS, SEEDS, Shape, mean};
use crate::study::schwefel::Searcher;

/// The ratio of the paper's claim.
const RATIO: f64 = 2.0;
/// How many times fewer evaluations are wanted.
const FEWER: f64 = 1.1;
/// The basic methods.
const BASIC: [Searcher; 2] = [SEARCHERS[1], SEARCHERS[2]];

/// The figures of a searcher at a ratio.
fn at(figures: &[Found], searcher: Searcher, ratio: f64) -> Option<&Figures> {
    figures.iter().find(|found| (found.0, found.1) == (searcher, ratio)).map(|found| &found.2)
}

/// The proposed method's figures at [`RATIO`], and a basic one's.
fn pair(figures: &[Found], basic: Searcher) -> Option<[&Figures; 2]> {
    Some([at(figures, SEARCHERS[0], RATIO)?, at(figures, basic, RATIO)?])
}

/// Whether what is wanted at SNR 2 holds for every kind of cost, against both basic methods.
pub(super) fn musts(kinds: &[(Shape, Vec<Found>)]) -> String {
    let (mut failing, mut words) = (Vec::new(), Vec::new());
    for basic in BASIC {
        for (shape, figures) in kinds {
            let Some([ours, other]) = pair(figures, basic) else { continue };
            if ours.evaluations[0] * FEWER > other.evaluations[0] || ours.error[0] > other.error[0] {
                failing.push(format!("{} against \"{}\"", shape.name(), basic.name()));
            }
        }
        words.push(lead(kinds, basic));
    }
    let verdict = if failing.is_empty() {
        "yes, for every kind".to_owned()
    } else {
        format!("no, not for {}", failing.join(", nor for "))
    };
    format!(
        "Wanted at SNR {RATIO}: at least {FEWER} times fewer evaluations and no larger mean error than the basic methods. \
         Holds: {verdict}. {}",
        words.join(" ")
    )
}

/// Whether the lead in error over a basic method is more than chance.
fn lead(kinds: &[(Shape, Vec<Found>)], basic: Searcher) -> String {
    let of_shape = |(shape, figures): &(Shape, Vec<Found>)| {
        let [ours, other] = pair(figures, basic)?;
        let [[a, a_half], [b, b_half]] = [ours.error, other.error];
        let overlap = if (a - b).abs() <= a_half + b_half { "overlap" } else { "do not overlap" };
        let [difference, half] = mean(ours.errors.iter().zip(&other.errors).map(|(a, b)| a - b));
        let significance = match difference {
            _ if difference.abs() <= half => "not significant",
            _ if difference < 0.0 => "significantly less",
            _ => "significantly more",
        };
        Some(format!(
            "{} {a:.4} +- {a_half:.4} against {b:.4} +- {b_half:.4}, which {overlap}; cost by cost {difference:+.4} +- \
             {half:.4}, {significance}",
            shape.name()
        ))
    };
    let words: Vec<String> = kinds.iter().filter_map(of_shape).collect();
    format!("Relative error against \"{}\" with 95 % intervals over {SEEDS} costs: {}.", basic.name(), words.join("; "))
}

/// What Fig. 4 says at SNR 2, and at 20.
pub(super) fn text(shape: Shape, figures: &[Found]) -> String {
    let of = |searcher: Searcher, ratio: f64| {
        at(figures, searcher, ratio).map_or([f64::NAN; 2], |found| [found.evaluations[0], found.error[0]])
    };
    let mut words = format!("{}: ", shape.name());
    for ratio in [RATIO, 20.0] {
        let [evaluations, error] = of(SEARCHERS[0], ratio);
        let compare = |searcher: Searcher| {
            let [others, others_error] = of(searcher, ratio);
            format!(
                "{:.2} times the evaluations and {:.2} times the error of \"{}\"",
                evaluations / others,
                error / others_error,
                searcher.name()
            )
        };
        let both = BASIC.map(compare).join(", ");
        words.push_str(&format!("at SNR {ratio} the proposed method needs {both}; "));
    }
    let [[_, gradient], [_, ours]] = [of(Searcher::Gradient, RATIO), of(SEARCHERS[0], RATIO)];
    words.push_str(&format!(
        "gradient descent's error at SNR {RATIO} is {gradient:.3}, {:.1} times the proposed method's.",
        gradient / ours
    ));
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(evaluations: f64, errors: [f64; 4]) -> Figures {
        let error = mean(errors.into_iter());
        Figures { error, evaluations: [evaluations, 0.1], seconds: 1e-6, errors: errors.to_vec() }
    }

    fn told(ours: Figures, basic: Figures) -> String {
        let kind = [(SEARCHERS[0], ours), (SEARCHERS[1], basic.clone()), (SEARCHERS[2], basic)];
        musts(&[(Shape::Well, kind.map(|(searcher, found)| (searcher, RATIO, found)).to_vec())])
    }

    #[test]
    fn both_evaluations_and_error_decide() {
        let errors = [0.1, 0.2, 0.3, 0.2];
        let yes = told(figures(100.0, errors), figures(110.1, errors));
        assert!(yes.contains("Holds: yes") && yes.contains("which overlap"), "{yes}");
        let dearer = told(figures(100.0, errors), figures(109.0, errors));
        assert!(dearer.contains("Holds: no, not for well (unimodal) against"), "{dearer}");
        let worse = told(figures(100.0, errors.map(|e| e + 0.01)), figures(200.0, errors));
        assert!(worse.contains("Holds: no") && worse.contains("significantly more"), "{worse}");
        let better = told(figures(100.0, errors), figures(200.0, errors.map(|e| e + 1.0)));
        assert!(better.contains("do not overlap") && better.contains("significantly less"), "{better}");
    }
}
