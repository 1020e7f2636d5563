//! How far what is planned is from what is counted.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::Result;

use super::cost::CostModel;
use super::counts::{Count, Input};

/// What a plan may be off, %: on scenes, and on random views.
pub const MOST_PERCENT: [f64; 2] = [5.0, 6.0];

/// Errors of a method's plans on one input, over several sizes.
#[derive(Debug)]
pub struct Error {
    /// The method's name.
    pub method: &'static str,
    /// What the cameras saw.
    pub input: Input,
    /// The greatest error of a mean over the scenes, %.
    pub worst_mean_percent: f64,
    /// The greatest error on a single scene, %.
    pub worst_scene_percent: f64,
}

impl Error {
    /// Whether the mean over the scenes is off by more than [`MOST_PERCENT`].
    #[must_use]
    pub fn is_too_great(&self) -> bool {
        let [scenes, random] = MOST_PERCENT;
        self.worst_mean_percent.abs() > if self.input == Input::Random { random } else { scenes }
    }
}

/// The errors of the model against counts.
///
/// # Errors
/// If one of them was never fitted.
pub fn errors(model: &CostModel, counted: &[Count]) -> Result<Vec<Error>> {
    let mut groups = BTreeMap::<(&str, Input), Vec<&Count>>::new();
    for count in counted {
        groups.entry((&count.method, count.input)).or_default().push(count);
    }
    let error = |((_, input), counts): ((&str, Input), Vec<&Count>)| {
        let (mut worst_scene, mut sums) = (0.0, BTreeMap::<(u16, u16), [f64; 2]>::new());
        let method = counts[0].kind()?;
        for count in counts {
            let planned = model.on(method, &count.scene, input, count.width, count.disparities)?.instructions;
            worst_scene = worse(worst_scene, percent(planned, count.instructions));
            let sum = sums.entry((count.width, count.disparities)).or_default();
            *sum = [sum[0] + planned, sum[1] + count.instructions];
        }
        let means = sums.values().map(|&[planned, counted]| percent(planned, counted));
        Ok(Error {
            method: method.name(),
            input,
            worst_mean_percent: means.fold(0.0, worse),
            worst_scene_percent: worst_scene,
        })
    };
    groups.into_iter().map(error).collect()
}

fn percent(planned: f64, counted: f64) -> f64 {
    100.0 * (planned / counted - 1.0)
}

fn worse(one: f64, other: f64) -> f64 {
    if other.abs() > one.abs() { other } else { one }
}

/// As lines.
#[must_use]
pub fn text(errors: &[Error]) -> String {
    let mut text = String::from("planned against counted, at sizes that are not stored: the greatest error\n");
    for Error { method, input, worst_mean_percent, worst_scene_percent } in errors {
        let _ = writeln!(
            text,
            "  {method:13} {:6} mean of the scenes {worst_mean_percent:+.1} %, one scene {worst_scene_percent:+.1} %",
            input.name()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::power::plan::counting::{CHECKED, STORED};

    #[test]
    fn a_method_that_became_dearer_is_off() {
        let count = |dearer: f64| {
            move |&(width, disparities): &(u16, u16)| Count {
                method: "lite".to_owned(),
                scene: "a".to_owned(),
                input: Input::Clean,
                width,
                height: 240,
                disparities,
                instructions: dearer * (90.0 + 640.0 / f64::from(width)),
                packets: 20.0,
            }
        };
        let stored: Vec<Count> = STORED.iter().map(count(1.0)).collect();
        let model = CostModel::fit(&stored).unwrap();
        let off = |dearer: f64| {
            let counted: Vec<Count> = CHECKED.iter().map(count(dearer)).collect();
            errors(&model, &counted).unwrap()[0].worst_mean_percent
        };
        assert!(off(1.0).abs() < 1e-6);
        assert!((off(1.1) + 100.0 / 11.0).abs() < 1e-6, "{}", off(1.1));
    }
}
