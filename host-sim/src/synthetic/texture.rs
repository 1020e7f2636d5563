//! Textures of synthetic scenes: smooth noise in several octaves, known at every point, so that no
//! image is ever resampled.

/// Wavelengths in px and their weights, which add up to 1. The finest is coarse enough for the pixels.
const OCTAVES: [(f64, f64); 5] = [(3.0, 0.22), (6.0, 0.24), (13.0, 0.22), (29.0, 0.18), (61.0, 0.14)];

/// How a layer looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Tells textures of one scene apart.
    index: u32,
    /// Mean, grey levels.
    mean: f64,
    /// Greatest deviation from the mean, grey levels; most deviations are far smaller.
    contrast: f64,
    /// Factor on the wavelengths.
    scale: f64,
    bars: Option<Bars>,
}

/// Upright bars, all alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bars {
    /// From one bar to the next, px.
    pub period: f64,
    /// Share of the period that is bar.
    pub share: f64,
    /// Width of an edge, px.
    pub edge: f64,
    /// How much darker a bar is than what lies between, grey levels.
    pub depth: f64,
}

impl Bars {
    /// What the bars take away from the grey level.
    fn at(&self, x: f64) -> f64 {
        let (place, width) = (x.rem_euclid(self.period), self.share * self.period);
        // How far inside a bar; negative outside.
        let inside = if place < width { place.min(width - place) } else { -(place - width).min(self.period - place) };
        self.depth * (0.5 + inside / self.edge).clamp(0.0, 1.0)
    }
}

impl Texture {
    /// Noise of its own for each `index` around `mean`.
    #[must_use]
    pub const fn new(index: u32, mean: f64, contrast: f64) -> Self {
        Self { index, mean, contrast, scale: 1.0, bars: None }
    }

    /// The same, coarser by a factor.
    #[must_use]
    pub const fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// The same with bars on it.
    #[must_use]
    pub const fn with_bars(self, bars: Bars) -> Self {
        Self { bars: Some(bars), ..self }
    }

    /// One grey everywhere.
    #[must_use]
    pub const fn blank(grey: f64) -> Self {
        Self { index: 0, mean: grey, contrast: 0.0, scale: 1.0, bars: None }
    }

    /// Whether it is one grey everywhere.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.contrast == 0.0 && self.bars.is_none()
    }

    /// The grey level at a point.
    pub(super) fn grey(&self, x: f64, y: f64, seed: u64) -> f64 {
        let mean = self.mean - self.bars.map_or(0.0, |bars| bars.at(x));
        if self.contrast == 0.0 {
            return mean;
        }
        let octave = |(number, (wavelength, weight)): (u64, &(f64, f64))| {
            let lattice = mix(seed ^ mix(u64::from(self.index) << 8 | number));
            let wavelength = wavelength * self.scale;
            weight * value_noise(x / wavelength, y / wavelength, lattice)
        };
        // Averaging octaves flattens the noise; the factor restores about the range of one.
        let sum: f64 = (0..).zip(&OCTAVES).map(octave).sum();
        mean + self.contrast * (2.2 * sum).clamp(-1.0, 1.0)
    }
}

/// Values -1 to 1 at the points of a square lattice, smoothly blended between them.
fn value_noise(x: f64, y: f64, lattice: u64) -> f64 {
    let (column, row) = (x.floor(), y.floor());
    let (along, down) = (smooth(x - column), smooth(y - row));
    let at = |dx: f64, dy: f64| {
        let point = ((column + dx) as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (row + dy) as i64 as u64;
        (mix(lattice ^ mix(point)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let blend = |from: f64, to: f64, place: f64| from + place * (to - from);
    blend(blend(at(0.0, 0.0), at(1.0, 0.0), along), blend(at(0.0, 1.0), at(1.0, 1.0), along), down)
}

/// From 0 to 1 with slope 0 at both ends.
fn smooth(place: f64) -> f64 {
    place * place * (3.0 - 2.0 * place)
}

/// The finaliser of SplitMix64: spreads every input bit over all output bits.
fn mix(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_spread_around_its_mean() {
        let texture = Texture::new(1, 120.0, 60.0);
        let greys: Vec<f64> = (0..40_000).map(|i| texture.grey(f64::from(i % 200), f64::from(i / 200), 0)).collect();
        let mean = greys.iter().sum::<f64>() / 40_000.0;
        let sigma = (greys.iter().map(|grey| (grey - mean).powi(2)).sum::<f64>() / 40_000.0).sqrt();
        assert!((mean - 120.0).abs() < 12.0, "mean {mean}");
        assert!((15.0..45.0).contains(&sigma), "sigma {sigma}");
        assert!(greys.iter().all(|grey| (60.0..=180.0).contains(grey)));
    }

    #[test]
    fn bars_are_alike_and_their_edges_ramps() {
        let fence = Texture::blank(200.0).with_bars(Bars { period: 10.0, share: 0.4, edge: 2.0, depth: 100.0 });
        let row: Vec<f64> = (0..20).map(|x| fence.grey(f64::from(x), 3.0, 0)).collect();
        assert_eq!(row[..10], [150.0, 100.0, 100.0, 100.0, 150.0, 200.0, 200.0, 200.0, 200.0, 200.0]);
        assert_eq!(row[..10], row[10..]);
        assert!(!fence.is_blank() && fence.grey(-10.0, 0.0, 1) == row[0]);
    }

    #[test]
    fn textures_differ_and_repeat() {
        let grey = |index, seed| Texture::new(index, 0.0, 100.0).grey(12.3, 4.5, seed);
        assert_eq!(grey(1, 7), grey(1, 7));
        assert_ne!(grey(1, 7), grey(2, 7));
        assert_ne!(grey(1, 7), grey(1, 8));
        assert_eq!(Texture::blank(80.0).grey(1.0, 2.0, 3), 80.0);
    }
}
