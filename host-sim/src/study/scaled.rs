//! Functions of one real number as the core's extremum search sees them: integer costs over fixed-point
//! coordinates.

use anyhow::Result;
use haarline::extremum::{FRAC_BITS, Found, Method, Settings};

/// Steps that the domain is divided into; with the fraction bits a coordinate has 28 bits.
const STEPS: i32 = 1 << 12;

/// A domain and the unit of a cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scaled {
    /// Ends of the domain.
    pub domain: [f64; 2],
    /// How much of the function one unit of the integer cost is.
    pub cost_unit: f64,
}

/// Parameters of the search in parts of the domain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// `gamma`.
    pub gamma: f64,
    /// `s_1`.
    pub first_support: u8,
    /// `a`: the first support covers this part of the domain.
    pub span: f64,
    /// `delta_1` and `delta_2`, parts of the domain.
    pub errors: [f64; 2],
    /// Most iterations.
    pub limit: u16,
}

impl Scaled {
    /// Searches `function` from `start`; a function's value outside of 31 bits of cost units is held at their end.
    ///
    /// # Errors
    /// If the core refuses the parameters.
    pub fn search(
        &self,
        parameters: &Parameters,
        method: Method,
        start: f64,
        function: impl Fn(f64) -> f64,
    ) -> Result<Found<1>> {
        let part = |part: f64| (part * f64::from(STEPS << FRAC_BITS)) as i32;
        let settings = Settings {
            start: [self.coordinate(start)],
            gamma: (parameters.gamma * f64::from(1 << FRAC_BITS)) as u32,
            step: part(parameters.span / f64::from(parameters.first_support & !1)),
            least_step: 1,
            first_support: parameters.first_support,
            support_increment: 0,
            first_error: part(parameters.errors[0]).max(1),
            error: part(parameters.errors[1]).max(1),
            limit: parameters.limit,
            ..Settings::new([0], [STEPS << FRAC_BITS])
        };
        Ok(settings.build()?.run(method, |&[c]| Some((function(self.value(c)) / self.cost_unit) as i32)))
    }

    /// The coordinate of a value; the domain's nearer end if it lies outside.
    #[must_use]
    pub fn coordinate(&self, value: f64) -> i32 {
        let [lower, upper] = self.domain;
        let part = ((value - lower) / (upper - lower)).clamp(0.0, 1.0);
        (part * f64::from(STEPS << FRAC_BITS)).round() as i32
    }

    /// The value of a coordinate.
    #[must_use]
    pub fn value(&self, coordinate: i32) -> f64 {
        let [lower, upper] = self.domain;
        lower + f64::from(coordinate) / f64::from(STEPS << FRAC_BITS) * (upper - lower)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_survives_the_way_to_a_coordinate_and_back() {
        let scaled = Scaled { domain: [-500.0, 500.0], cost_unit: 1e-6 };
        for value in [-500.0, -3.25, 0.0, 420.9687, 500.0] {
            assert!((scaled.value(scaled.coordinate(value)) - value).abs() < 1e-5, "{value}");
        }
        assert_eq!(scaled.coordinate(600.0), scaled.coordinate(500.0));
    }
}
