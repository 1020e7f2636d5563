//! What a confidence is worth: the share of wrong answers by class of confidence, and what the tests of evidence cost
//! and bring, in good light, in noise and in low light.

use anyhow::{Context, Result};
use haarline::{Config, Full, Lite, Parts, StereoMethod, blocks_for};

use super::plot::{Axis, BLACK, Chart, Layer, Mark, figure};
use super::{Outcome, Part, Plot, Setup, Table};
use crate::score::confidence_classes::{CLASSES, ConfidenceClasses};
use crate::score::degrade::Degradation;
use crate::score::evaluation::{Build, Evaluator, SceneScore, Source};
use crate::score::sure::SureScore;
use crate::stereo::method::on_large_stack;

/// Blocks for the widest rows.
const BLOCKS: usize = blocks_for(Config::MAX_WIDTH);
/// Pixels of a class with fewer of them, percent, are shown in the table but not in the plot.
const LEAST_SHARE: f64 = 0.05;
/// What is plotted of a class without a wrong answer, percent.
const NONE_WRONG: f64 = 0.01;

/// What happens to the frames.
fn conditions(seed: u64) -> [(&'static str, Degradation); 3] {
    let clean = Degradation { seed, ..Degradation::NONE };
    [
        ("clean", clean),
        ("noise 10", Degradation { noise: 10.0, ..clean }),
        ("low light", Degradation { both_gain: 0.25, noise: 2.0, ..clean }),
    ]
}

/// A method as a whole, or without its tests of evidence.
struct Subject {
    name: &'static str,
    is_lite: bool,
    parts: Parts,
}

const SUBJECTS: [Subject; 4] = [
    Subject { name: "full", is_lite: false, parts: Parts::ALL },
    Subject { name: "lite", is_lite: true, parts: Parts::ALL },
    Subject { name: "full without the tests", is_lite: false, parts: Parts { texture: false, ..Parts::ALL } },
    Subject { name: "lite without the tests", is_lite: true, parts: Parts { texture: false, ..Parts::ALL } },
];

/// A subject's scores: all scenes of each condition.
struct Measured {
    name: &'static str,
    conditions: Vec<(&'static str, Vec<SceneScore>)>,
}

impl Measured {
    fn scores(&self) -> impl Iterator<Item = &SceneScore> + Clone {
        self.conditions.iter().flat_map(|(_, scenes)| scenes)
    }

    /// The classes, over all conditions.
    fn classes(&self) -> ConfidenceClasses {
        let classes: Vec<_> = self.scores().map(|scene| &scene.score.confidence_classes).collect();
        ConfidenceClasses::mean(classes.iter().copied())
    }
}

/// Does the study.
///
/// # Errors
/// If a scene cannot be matched or a plot not be drawn.
pub fn run(setup: &Setup<'_>) -> Result<Outcome> {
    let conditions = conditions(setup.seed);
    setup.progress.set_length((SUBJECTS.len() * conditions.len() * setup.scenes.len()) as u64);
    let measured = SUBJECTS.iter().map(|subject| measure(setup, subject)).collect::<Result<Vec<_>>>()?;
    let whole = measured.get(..2).context("no method")?;
    let parts = vec![
        Part::Text(format!(
            "An answer is wrong if it is off by more than 2 px. Classes of 16 confidences; over {}, clean, at noise 10 \
             and in low light (both views x 0.25, noise 2); scenes weigh alike.",
            setup.scenes_name
        )),
        Part::Plot(Plot {
            name: "calibration".to_owned(),
            caption: format!(
                "Wrong answers by class of confidence; classes with at least {LEAST_SHARE} % of the scored pixels. From \
                 64 on an answer is sure. What is drawn at {NONE_WRONG} % has none or fewer."
            ),
            svg: plot(whole)?,
        }),
        Part::Table(classes_table(whole)),
        Part::Table(sure_table(&measured)),
    ];
    Ok(Outcome { name: "confidence", title: "What a confidence is worth".to_owned(), parts })
}

fn measure(setup: &Setup<'_>, subject: &Subject) -> Result<Measured> {
    let parts = subject.parts;
    let build: Box<Build<'_>> = if subject.is_lite {
        Box::new(move |config| {
            on_large_stack(|| Ok(Box::new(Lite::<BLOCKS>::with_parts(config, parts)?) as Box<dyn StereoMethod + Send>))
        })
    } else {
        Box::new(move |config| {
            on_large_stack(|| Ok(Box::new(Full::<BLOCKS>::with_parts(config, parts)?) as Box<dyn StereoMethod + Send>))
        })
    };
    let of = |(name, degradation)| {
        let evaluator = Evaluator { degradation, ..Evaluator::of(Source::Method(&*build)) };
        Ok((name, evaluator.run(setup.scenes, || setup.progress.inc(1))?))
    };
    let conditions = conditions(setup.seed).into_iter().map(of).collect::<Result<_>>()?;
    Ok(Measured { name: subject.name, conditions })
}

fn plot(whole: &[Measured]) -> Result<String> {
    let chart = |method: &Measured| {
        let layer = |name: &str, colour, classes: ConfidenceClasses| {
            let points = classes.0.iter().enumerate().filter(|(_, class)| class.pixels >= LEAST_SHARE);
            let points = points.filter_map(|(i, class)| Some([16.0 * i as f64 + 8.0, class.wrong?.max(NONE_WRONG)]));
            Layer::new(name, colour, Mark::DotsOnLine, points)
        };
        let mut layers: Vec<Layer> = method
            .conditions
            .iter()
            .enumerate()
            .map(|(i, (name, scenes))| {
                let classes = scenes.iter().map(|scene| &scene.score.confidence_classes);
                layer(name, i, ConfidenceClasses::mean(classes.collect::<Vec<_>>()))
            })
            .collect();
        layers.push(layer("all together", BLACK, method.classes()));
        layers.push(Layer::new("sure from here on", 3, Mark::Dashes, [[64.0, NONE_WRONG], [64.0, 100.0]]));
        Chart {
            title: method.name.to_owned(),
            x: Axis::linear("confidence", [0.0, 208.0]).with_ticks([0.0, 16.0, 64.0, 112.0, 160.0, 208.0]),
            y: Axis::log("wrong, % of the class", [NONE_WRONG, 100.0]),
            layers,
        }
    };
    figure(&whole.iter().map(chart).collect::<Vec<_>>(), 2, [420, 300])
}

fn classes_table(whole: &[Measured]) -> Table {
    let columns = whole.iter().flat_map(|method| {
        [format!("{}: share of the scored pixels, %", method.name), format!("{}: wrong, %", method.name)]
    });
    let classes: Vec<ConfidenceClasses> = whole.iter().map(Measured::classes).collect();
    let row = |class: usize| {
        let cells = classes.iter().flat_map(|of| {
            let class = of.0[class];
            [format!("{:.2}", class.pixels), class.wrong.map_or_else(|| "-".to_owned(), |wrong| format!("{wrong:.2}"))]
        });
        [(16 * class).to_string()].into_iter().chain(cells).collect()
    };
    Table {
        name: "classes".to_owned(),
        caption: "Calibration, over all conditions".to_owned(),
        columns: ["confidence from".to_owned()].into_iter().chain(columns).collect(),
        rows: (0..CLASSES).map(row).collect(),
    }
}

fn sure_table(measured: &[Measured]) -> Table {
    let row = |method: &Measured, (condition, scenes): &(&'static str, Vec<SceneScore>)| {
        let sure = SureScore::mean(scenes.iter().map(|scene| &scene.sure));
        let figure = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        let figures = [Some(sure.sure_density), sure.sure_bad2, Some(sure.sure_near), sure.hidden_sure_wrong];
        [method.name.to_owned(), (*condition).to_owned()].into_iter().chain(figures.map(figure)).collect()
    };
    let columns = [
        "method",
        "frames",
        "sure, % of the scored pixels",
        "of these wrong, %",
        "sure and near, % of the scored pixels",
        "sure and wrong, % of the hidden pixels",
    ];
    Table {
        name: "sure".to_owned(),
        caption: "What the tests of evidence cost and bring".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows: measured.iter().flat_map(|method| method.conditions.iter().map(|of| row(method, of))).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::rendered;
    use indicatif::ProgressBar;

    #[test]
    fn more_confidence_is_less_often_wrong_and_the_tests_bring_something() {
        let scenes = rendered::scenes(0);
        let progress = ProgressBar::hidden();
        let setup = Setup { seed: 0, scenes: &scenes, scenes_name: rendered::NAME, chip: None, progress: &progress };
        let outcome = run(&setup).unwrap();
        let [_, Part::Plot(plot), Part::Table(classes), Part::Table(sure)] = outcome.parts.as_slice() else {
            panic!("other parts")
        };
        assert!(plot.svg.contains("low light"));
        assert_eq!((classes.rows.len(), sure.rows.len()), (CLASSES, 12));
        let number = |cell: &String| cell.parse::<f64>().unwrap();
        // Guesses and doubtful ones, then the surest that there are.
        let wrong: Vec<f64> = classes.rows.iter().map(|row| &row[2]).filter(|cell| *cell != "-").map(number).collect();
        assert!(wrong[1] > 10.0 * wrong[wrong.len() - 1], "{wrong:?}");
        let bad2 = |row: usize| number(&sure.rows[row][3]);
        assert!((0..3).all(|condition| bad2(condition) < bad2(6 + condition)), "{:?}", sure.rows);
    }
}
