//! The parameters of the extremum search, named as in the paper, and their ranges.

use core::fmt;

use super::FRAC_BITS;

/// Parameters of the extremum search; [`Settings::build`] checks them.
///
/// Coordinates, steps and errors are fixed point with [`FRAC_BITS`] fraction bits, in whatever unit the cost
/// is a function of.
///
/// # Examples
/// ```
/// use haarline::extremum::{FRAC_BITS, Method, Settings};
/// let whole = |c: i32| c << FRAC_BITS;
/// let settings = Settings { start: [whole(10)], first_support: 16, ..Settings::new([0], [whole(100)]) };
/// let search = settings.build()?;
/// let found = search.run(Method::Proposed, |&[c]| Some(((c - whole(70)) >> 8).abs()));
/// assert!(found.registered);
/// assert!((found.at[0] - whole(70)).abs() <= whole(1));
/// # Ok::<(), haarline::extremum::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings<const N: usize> {
    /// `c[0]`, where the search begins.
    pub start: [i32; N],
    /// Least coordinates of the domain, at least -[`Settings::MAX_COORDINATE`].
    pub lower: [i32; N],
    /// Greatest coordinates of the domain, at most [`Settings::MAX_COORDINATE`].
    pub upper: [i32; N],
    /// `gamma`, fixed point like the coordinates: the part of half a support that is gone at full direction
    /// (all costs before the point at one end of their range, all after it at the other); above 0, at most 16.
    pub gamma: u32,
    /// `a`, distance of the samples at the first start.
    pub step: i32,
    /// The least distance of samples that makes sense, such as one where the cost is defined in whole steps;
    /// shorter supports never sample more closely. At most `step`.
    pub least_step: i32,
    /// `s_1`, samples of the first start's support, half on each side (of an odd number the centre is left
    /// out); at least 2, and no longer than the domain.
    pub first_support: u8,
    /// `Delta_s`, samples by which the support grows when nothing was registered; 0 for never.
    pub support_increment: u8,
    /// `A_1`, least height of a registered extremum: by how much the cost in the outer parts of the support
    /// must exceed that in the inner ones. At least 0; a height of 0 is never registered.
    pub least_height: i32,
    /// `delta_1`, error of the first start: a step of its walk as short as this ends it.
    pub first_error: i32,
    /// `delta_2`, error wanted: a step of a later start's walk, or half a support, as short as this ends the search.
    pub error: i32,
    /// Most iterations, all starts together.
    pub limit: u16,
}

impl<const N: usize> Settings<N> {
    /// Greatest magnitude of a coordinate.
    pub const MAX_COORDINATE: i32 = 1 << 30;
    /// Greatest `gamma`.
    pub const MAX_GAMMA: u32 = 16 << FRAC_BITS;

    /// A search over a domain, from its middle in whole steps, with the paper's gamma of 0.9 and support of 10.
    #[must_use]
    pub fn new(lower: [i32; N], upper: [i32; N]) -> Self {
        let one = 1 << FRAC_BITS;
        Self {
            start: core::array::from_fn(|j| lower[j].midpoint(upper[j])),
            lower,
            upper,
            gamma: 58_982, // 0.9
            step: one,
            least_step: one,
            first_support: 10,
            support_increment: 2,
            least_height: 0,
            first_error: one,
            error: one,
            limit: 100,
        }
    }

    /// Checks every field.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn build(self) -> Result<Search<N>, SettingsError> {
        self.check_domain()?;
        if self.gamma == 0 || self.gamma > Self::MAX_GAMMA {
            return Err(SettingsError::Gamma);
        }
        if self.least_step <= 0 || self.step < self.least_step {
            return Err(SettingsError::Step);
        }
        if self.first_error <= 0 || self.error <= 0 {
            return Err(SettingsError::Errors);
        }
        if self.limit == 0 {
            return Err(SettingsError::Limit);
        }
        if self.least_height < 0 {
            return Err(SettingsError::LeastHeight);
        }
        self.check_support()?;
        Ok(Search(self))
    }

    fn check_domain(&self) -> Result<(), SettingsError> {
        if N == 0 {
            return Err(SettingsError::NoParameter);
        }
        for parameter in 0..N {
            let (lower, start, upper) = (self.lower[parameter], self.start[parameter], self.upper[parameter]);
            if lower >= upper {
                return Err(SettingsError::EmptyDomain { parameter });
            }
            if lower < -Self::MAX_COORDINATE || upper > Self::MAX_COORDINATE {
                return Err(SettingsError::Coordinate { parameter });
            }
            if !(lower..=upper).contains(&start) {
                return Err(SettingsError::Start { parameter });
            }
        }
        Ok(())
    }

    fn check_support(&self) -> Result<(), SettingsError> {
        if self.first_support < 2 {
            return Err(SettingsError::Support);
        }
        for parameter in 0..N {
            if self.length_of(self.first_support) > self.extent(parameter) {
                return Err(SettingsError::SupportOverDomain { parameter });
            }
        }
        Ok(())
    }

    /// How long a support is at the first start's step.
    fn length_of(&self, support: u8) -> i64 {
        i64::from(support & !1) * i64::from(self.step)
    }

    /// How long the domain is along a parameter.
    pub(super) fn extent(&self, parameter: usize) -> i64 {
        i64::from(self.upper[parameter]) - i64::from(self.lower[parameter])
    }
}

/// A search whose settings have been checked; [`Search::run`] looks for the extremum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Search<const N: usize>(pub(super) Settings<N>);

/// Why settings are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SettingsError {
    /// There must be a parameter to search.
    NoParameter,
    /// `lower` must be below `upper`.
    EmptyDomain {
        /// Which parameter.
        parameter: usize,
    },
    /// `lower` and `upper` must lie within [`Settings::MAX_COORDINATE`].
    Coordinate {
        /// Which parameter.
        parameter: usize,
    },
    /// `start` must lie within the domain.
    Start {
        /// Which parameter.
        parameter: usize,
    },
    /// `gamma` must be above 0 and at most 16.
    Gamma,
    /// `least_step` must be above 0 and at most `step`.
    Step,
    /// `first_error` and `error` must be above 0.
    Errors,
    /// `limit` must be at least 1.
    Limit,
    /// `least_height` must be at least 0.
    LeastHeight,
    /// `first_support` must be at least 2.
    Support,
    /// `first_support` steps must not exceed the domain.
    SupportOverDomain {
        /// Which parameter.
        parameter: usize,
    },
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoParameter => f.write_str("there must be a parameter to search"),
            Self::EmptyDomain { parameter } => {
                write!(f, "the bracket of parameter {parameter} is empty: its lower end must be below its upper end")
            }
            Self::Coordinate { parameter } => {
                write!(f, "the domain of parameter {parameter} must lie within -16384 to 16384 steps")
            }
            Self::Start { parameter } => write!(f, "the start of parameter {parameter} must lie in its domain"),
            Self::Gamma => f.write_str("gamma must be above 0 and at most 16"),
            Self::Step => f.write_str("the least step must be above 0 and at most the first one"),
            Self::Errors => f.write_str("both errors must be above 0"),
            Self::Limit => f.write_str("the limit must be at least 1 iteration"),
            Self::LeastHeight => f.write_str("the least height must not be negative"),
            Self::Support => f.write_str("the support must be at least 2 samples"),
            Self::SupportOverDomain { parameter } => {
                write!(f, "the support is longer than the domain of parameter {parameter}: shorten it or its step")
            }
        }
    }
}

impl core::error::Error for SettingsError {}
