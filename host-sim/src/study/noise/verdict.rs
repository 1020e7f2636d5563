//! What the figures say, in words made from them.

use super::{Figures, Found, SEARCHERS, SEEDS, Shape, mean};
use crate::study::Table;
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

/// The proposed method against a basic one on costs of one kind, at [`RATIO`].
#[derive(Debug)]
struct Comparison<'a> {
    shape: Shape,
    basic: Searcher,
    ours: &'a Figures,
    other: &'a Figures,
}

/// All of them, kind by kind for each basic method.
fn comparisons(kinds: &[(Shape, Vec<Found>)]) -> Vec<Comparison<'_>> {
    let of = |basic| {
        kinds.iter().filter_map(move |(shape, figures)| {
            let [ours, other] = [SEARCHERS[0], basic].map(|searcher| at(figures, searcher, RATIO));
            Some(Comparison { shape: *shape, basic, ours: ours?, other: other? })
        })
    };
    BASIC.into_iter().flat_map(of).collect()
}

impl Comparison<'_> {
    fn holds(&self) -> bool {
        self.ours.evaluations[0] * FEWER <= self.other.evaluations[0] && self.ours.error[0] <= self.other.error[0]
    }

    /// Whether the 95 % intervals of the mean errors have a point in common.
    fn overlaps(&self) -> bool {
        let [[ours, ours_half], [other, other_half]] = [self.ours.error, self.other.error];
        (ours - other).abs() <= ours_half + other_half
    }

    /// The difference of the errors, cost by cost, and half the width of its 95 % interval: both search the same
    /// costs, so that it tells more than two intervals do.
    fn difference(&self) -> [f64; 2] {
        mean(self.ours.errors.iter().zip(&self.other.errors).map(|(ours, other)| ours - other))
    }

    fn leads(&self) -> bool {
        let [difference, half] = self.difference();
        difference < -half
    }

    fn row(&self) -> Vec<String> {
        let answer = |is_so: bool| if is_so { "yes" } else { "no" }.to_owned();
        let errors = [self.ours.error, self.other.error].into_iter().flatten().map(|value| format!("{value:.4}"));
        let names = [self.shape.name().to_owned(), self.basic.name().to_owned()];
        let fewer = format!("{:.2}", self.other.evaluations[0] / self.ours.evaluations[0]);
        let [difference, half] = self.difference().map(|value| format!("{value:.4}"));
        let answers = [answer(self.overlaps()), difference, half, answer(self.leads()), answer(self.holds())];
        names.into_iter().chain([fewer]).chain(errors).chain(answers).collect()
    }
}

/// Whether what is wanted at SNR 2 holds for every kind of cost, against both basic methods.
pub(super) fn musts(kinds: &[(Shape, Vec<Found>)]) -> String {
    let all = comparisons(kinds);
    let failing: Vec<String> = all
        .iter()
        .filter(|found| !found.holds())
        .map(|found| format!("{} against \"{}\"", found.shape.name(), found.basic.name()))
        .collect();
    let verdict = match failing.as_slice() {
        [] => "yes, for every kind of cost and against both".to_owned(),
        failing => format!("no, not for {}", failing.join(", nor for ")),
    };
    let leads = BASIC.map(|basic| {
        let all = || all.iter().filter(|found| found.basic == basic);
        let overlap = all().filter(|found| found.overlaps()).count();
        let lead = all().filter(|found| found.leads()).count();
        format!(
            "Against \"{}\" the 95 % intervals of the mean errors overlap for {overlap} of {} kinds; cost by cost the \
             error is significantly less for {lead}.",
            basic.name(),
            all().count(),
        )
    });
    format!(
        "Wanted at SNR {RATIO}: at least {FEWER} times fewer evaluations and no larger mean error than the basic methods. \
         Holds: {verdict}. {} A difference that is not significant shows neither a larger error nor a smaller one.",
        leads.join(" ")
    )
}

/// The comparisons at SNR 2.
pub(super) fn table(kinds: &[(Shape, Vec<Found>)]) -> Table {
    let columns = [
        "cost",
        "proposed against",
        "times fewer evaluations",
        "its error",
        "+- (95 %)",
        "error of the other",
        "+- (95 %)",
        "intervals overlap",
        "difference, cost by cost",
        "+- (95 %)",
        "significantly less",
        "holds",
    ];
    Table {
        name: "snr2".to_owned(),
        caption: format!(
            "The proposed method against the basic ones at SNR {RATIO}, {SEEDS} costs of each kind; errors are in parts of \
             the domain"
        ),
        columns: columns.map(str::to_owned).to_vec(),
        rows: comparisons(kinds).iter().map(Comparison::row).collect(),
    }
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

    fn kinds(ours: Figures, basic: Figures) -> Vec<(Shape, Vec<Found>)> {
        let kind = [(SEARCHERS[0], ours), (SEARCHERS[1], basic.clone()), (SEARCHERS[2], basic)];
        vec![(Shape::Well, kind.map(|(searcher, found)| (searcher, RATIO, found)).to_vec())]
    }

    #[test]
    fn both_evaluations_and_error_decide() {
        let errors = [0.1, 0.2, 0.3, 0.2];
        let yes = musts(&kinds(figures(100.0, errors), figures(110.1, errors)));
        assert!(
            yes.contains("Holds: yes") && yes.contains("overlap for 1 of 1") && yes.contains("less for 0."),
            "{yes}"
        );
        let dearer = musts(&kinds(figures(100.0, errors), figures(109.0, errors)));
        assert!(dearer.contains("Holds: no, not for well (unimodal) against"), "{dearer}");
        let worse = musts(&kinds(figures(100.0, errors.map(|error| error + 0.01)), figures(200.0, errors)));
        assert!(worse.contains("Holds: no") && worse.contains("less for 0."), "{worse}");
        let better = musts(&kinds(figures(100.0, errors), figures(200.0, errors.map(|error| error + 1.0))));
        assert!(better.contains("overlap for 0 of 1") && better.contains("less for 1."), "{better}");
    }

    #[test]
    fn a_row_has_a_cell_for_every_column() {
        let errors = [0.1, 0.2, 0.3, 0.2];
        let table = table(&kinds(figures(100.0, errors), figures(150.0, errors)));
        assert!(table.rows.len() == 2 && table.rows.iter().all(|row| row.len() == table.columns.len()));
        assert_eq!(table.rows[0][2], "1.50");
    }
}
