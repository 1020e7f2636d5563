//! The blur of a lens: a Gaussian, along rows and columns.

/// Weights of a Gaussian, cut off where they no longer move an 8-bit value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Kernel(Vec<f64>);

impl Kernel {
    /// A kernel of standard deviation `sigma` px; of 0 it changes nothing.
    pub(super) fn new(sigma: f64) -> Self {
        let reach = (3.5 * sigma).ceil() as i32;
        let weight = |at: i32| if at == 0 { 1.0 } else { (-0.5 * (f64::from(at) / sigma).powi(2)).exp() };
        let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        Self(weights.into_iter().map(|weight| weight / sum).collect())
    }

    /// How many pixels beyond a pixel it looks at.
    pub(super) fn reach(&self) -> usize {
        self.0.len() / 2
    }

    /// Blurs rows of `width`; the result is [`Kernel::reach`] pixels smaller on every side.
    pub(super) fn apply(&self, values: &[f64], width: usize) -> Vec<f64> {
        let along: Vec<f64> = values.chunks(width).flat_map(|row| self.along(row)).collect();
        let width = width - 2 * self.reach();
        let height = (along.len() / width).saturating_sub(2 * self.reach());
        let sum = |index: usize| -> f64 {
            self.0.iter().enumerate().map(|(row, weight)| weight * along[index + row * width]).sum()
        };
        (0..width * height).map(sum).collect()
    }

    fn along(&self, row: &[f64]) -> impl Iterator<Item = f64> {
        row.windows(self.0.len()).map(|window| window.iter().zip(&self.0).map(|(value, weight)| value * weight).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_blur_changes_nothing() {
        let values = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0];
        assert_eq!((Kernel::new(0.0).reach(), Kernel::new(0.0).apply(&values, 3)), (0, values.to_vec()));
    }

    #[test]
    fn a_ramp_stays_and_a_point_spreads_by_its_variance() {
        let kernel = Kernel::new(0.8);
        let reach = kernel.reach();
        let width = 2 * reach + 9;
        let ramp: Vec<f64> = (0..width * width).map(|i| (2 * (i % width) + i / width) as f64).collect();
        let blurred = kernel.apply(&ramp, width);
        assert_eq!(blurred.len(), 81);
        for (index, value) in blurred.into_iter().enumerate() {
            assert!((value - ramp[(index / 9 + reach) * width + index % 9 + reach]).abs() < 1e-9);
        }
        let mut point = vec![0.0; width * width];
        point[width / 2 * width + width / 2] = 1.0;
        let spread = kernel.apply(&point, width);
        let variance: f64 = (0..81).map(|i| spread[i] * (i as f64 % 9.0 - 4.0).powi(2)).sum();
        assert!((variance - 0.64).abs() < 0.03 && (spread.iter().sum::<f64>() - 1.0).abs() < 1e-3, "{variance}");
    }
}
