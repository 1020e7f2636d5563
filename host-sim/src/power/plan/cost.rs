//! What a pixel costs at sizes that nobody counted: a function of the width and the disparities for each method, scene and
//! input, fitted to the stored counts by least squares.

use std::collections::BTreeMap;

use anyhow::{Context, Result, ensure};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::counts::{self, Count, Input};
use crate::stereo::method::MethodKind;
use crate::twin::cycles::Core;

/// The widest views that were counted, px.
pub const MOST_WIDTH: u16 = 320;
/// The narrowest, px.
pub const LEAST_WIDTH: u16 = 64;
/// Disparities that were counted, parts of the width.
const DISPARITIES: [f64; 2] = [0.15, 0.5];
/// The references take this many at once; a rest takes another way, which was not counted.
const AT_ONCE: u16 = 16;
/// Terms of the function.
const TERMS: usize = 8;

/// The function's terms: what a pixel costs; what a row costs, and the detail of a scaled scene; what a disparity costs, of
/// which the first columns of a row have not all.
fn terms(width: u16, disparities: u16) -> [f64; TERMS] {
    let (width, disparities) = (f64::from(width) / 100.0, f64::from(disparities) / 100.0);
    let share = disparities / width;
    [1.0, 1.0 / width, 1.0 / width.powi(2), width, disparities.ln(), disparities, disparities * share, share]
}

/// Executed instructions of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Without the packets.
    pub instructions: f64,
    /// Of the packets.
    pub packets: f64,
}

impl Cost {
    /// All of it.
    #[must_use]
    pub fn all(self) -> f64 {
        self.instructions + self.packets
    }
}

/// Costs of one input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InputCost {
    /// Of the scene where it is least.
    pub least: f64,
    /// Mean of the scenes.
    pub mean: Cost,
    /// Of the scene where it is most.
    pub most: f64,
}

/// What was fitted to the counts of one method, scene and input.
#[derive(Debug)]
struct Fit {
    instructions: [f64; TERMS],
    packets: [f64; TERMS],
}

/// The model.
#[derive(Debug)]
pub struct CostModel {
    fits: BTreeMap<(String, Input, String), Fit>,
}

impl CostModel {
    /// Fits it to counts.
    ///
    /// # Errors
    /// If they are too few.
    pub fn fit(counts: &[Count]) -> Result<Self> {
        let mut groups = BTreeMap::<_, Vec<&Count>>::new();
        for count in counts {
            groups.entry((count.method.clone(), count.input, count.scene.clone())).or_default().push(count);
        }
        let fit = |(key, counts): ((String, Input, String), Vec<&Count>)| {
            let fit = Fit {
                instructions: solve(&counts, |count| count.instructions),
                packets: solve(&counts, |count| count.packets),
            };
            ensure!(counts.len() > TERMS, "{} counts of {} on {}: too few", counts.len(), key.0, key.2);
            Ok((key, fit))
        };
        Ok(Self { fits: groups.into_iter().map(fit).collect::<Result<_>>()? })
    }

    /// The cost on one scene.
    ///
    /// # Errors
    /// If it was never counted.
    pub fn on(&self, method: MethodKind, scene: &str, input: Input, width: u16, disparities: u16) -> Result<Cost> {
        let fit = self.fits.get(&(method.name().to_owned(), input, scene.to_owned()));
        let fit = fit.with_context(|| format!("{method} was never counted on {scene}, {}", input.name()))?;
        Ok(fit.at(width, disparities))
    }

    /// The cost of an input, over its scenes.
    ///
    /// # Errors
    /// If the method was never counted, as those that no chip has, or not at such a size.
    pub fn of(&self, method: MethodKind, input: Input, width: u16, disparities: u16) -> Result<InputCost> {
        ensure!(
            (LEAST_WIDTH..=MOST_WIDTH).contains(&width),
            "--size: was counted for views of {LEAST_WIDTH} to {MOST_WIDTH} px only, not for {width}"
        );
        let [fewest, most] = DISPARITIES.map(|part| part * f64::from(width));
        ensure!(
            (fewest..=most).contains(&f64::from(disparities)),
            "--num-disparities {disparities}: was counted from {fewest:.0} to {most:.0} only for views of {width} px"
        );
        let is_reference = matches!(method, MethodKind::Block | MethodKind::Sgm);
        ensure!(
            !is_reference || disparities.is_multiple_of(AT_ONCE),
            "--num-disparities {disparities}: {method} was counted for multiples of {AT_ONCE} only"
        );
        let is_asked = |(name, of, _): &&(String, Input, String)| name == method.name() && *of == input;
        let keys = self.fits.keys().filter(is_asked);
        let costs: Vec<Cost> = keys.map(|key| self.fits[key].at(width, disparities)).collect();
        ensure!(!costs.is_empty(), "--method {method}: runs on the host only, the reference on the chip is block");
        let mean = |of: fn(&Cost) -> f64| costs.iter().map(of).sum::<f64>() / costs.len() as f64;
        Ok(InputCost {
            least: costs.iter().map(|cost| cost.all()).fold(f64::INFINITY, f64::min),
            mean: Cost { instructions: mean(|cost| cost.instructions), packets: mean(|cost| cost.packets) },
            most: costs.iter().map(|cost| cost.all()).fold(0.0, f64::max),
        })
    }
}

/// The models by processor: its program is another where its instructions are.
#[derive(Debug)]
pub struct Costs {
    m4: CostModel,
    m33: CostModel,
}

impl Costs {
    /// Those of the stored counts.
    ///
    /// # Errors
    /// If a file that they are stored in is damaged.
    pub fn stored() -> Result<Self> {
        let fit = |core| CostModel::fit(&counts::stored(core)?);
        Ok(Self { m4: fit(Core::CortexM4)?, m33: fit(Core::CortexM33)? })
    }

    /// The same counts for every processor.
    ///
    /// # Errors
    /// If they are too few.
    pub fn fit(counts: &[Count]) -> Result<Self> {
        Ok(Self { m4: CostModel::fit(counts)?, m33: CostModel::fit(counts)? })
    }

    /// That of a processor.
    #[must_use]
    pub fn of(&self, core: Core) -> &CostModel {
        if core.is_armv8() { &self.m33 } else { &self.m4 }
    }
}

impl Fit {
    fn at(&self, width: u16, disparities: u16) -> Cost {
        let terms = terms(width, disparities);
        let sum = |factors: &[f64; TERMS]| factors.iter().zip(terms).map(|(factor, term)| factor * term).sum();
        Cost { instructions: sum(&self.instructions), packets: sum(&self.packets) }
    }
}

/// The factors of the terms by which the squared errors, in parts of what was counted, are least.
fn solve(counts: &[&Count], of: impl Fn(&Count) -> f64) -> [f64; TERMS] {
    let weight = |count: &Count| 1.0 / of(count).max(1.0);
    let row = |count: &&Count| terms(count.width, count.disparities).map(|term| term * weight(count));
    let rows: Vec<f64> = counts.iter().flat_map(row).collect();
    let matrix = DMatrix::from_row_slice(counts.len(), TERMS, &rows);
    let wanted = DVector::from_iterator(counts.len(), counts.iter().map(|count| of(count) * weight(count)));
    let found = matrix.svd(true, true).solve(&wanted, 1e-9);
    let mut factors = [0.0; TERMS];
    if let Ok(found) = found {
        factors.iter_mut().zip(found.iter()).for_each(|(factor, found)| *factor = *found);
    }
    factors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_of_its_form_is_found_again() {
        let truth = |width: u16, disparities: u16| {
            let (w, d) = (f64::from(width), f64::from(disparities));
            80.0 + 900.0 / w + 4.0 * d - 1.5 * d * d / w
        };
        let count = |&(width, disparities): &(u16, u16)| Count {
            method: "block".to_owned(),
            scene: "a".to_owned(),
            input: Input::Clean,
            width,
            height: 240,
            disparities,
            instructions: truth(width, disparities),
            packets: 20.0,
        };
        let counts: Vec<Count> = super::super::counting::STORED.iter().map(count).collect();
        let model = CostModel::fit(&counts).unwrap();
        for (width, disparities) in super::super::counting::CHECKED {
            let found = model.of(MethodKind::Block, Input::Clean, width, disparities).unwrap();
            assert!((found.mean.instructions - truth(width, disparities)).abs() < 1e-3, "{found:?}");
            assert!((found.mean.packets - 20.0).abs() < 1e-3, "{found:?}");
        }
        let refused = |width, disparities| model.of(MethodKind::Block, Input::Clean, width, disparities).is_err();
        assert!(refused(48, 16) && refused(640, 96) && refused(320, 40) && refused(320, 176) && refused(320, 50));
        assert!(model.of(MethodKind::Ncc, Input::Clean, 320, 48).is_err());
    }
}
