//! What a view can show: patterns by integer arithmetic, the same on every machine.

use proptest::prelude::*;

/// A pattern without end.
#[derive(Debug, Clone, Copy)]
pub enum Content {
    /// One grey level.
    Constant(u8),
    /// Rows of one grey level each, all different.
    ConstantRows { seed: u32 },
    /// Fields of black and white, `across` x `down` px.
    Checkers { across: u8, down: u8 },
    /// Black and white stripes of `across` px, upright.
    UprightStripes { across: u8 },
    /// Black and white stripes of `down` px, lying.
    LyingStripes { down: u8 },
    /// Grey levels that rise, and start again at 0 after 255.
    Ramp { across: i8, down: i8 },
    /// White points on black, one in so many.
    Impulses { seed: u32, one_in: u8 },
    /// Each pixel black or white.
    BlackOrWhite { seed: u32 },
    /// Each pixel independent, mid-grey give or take `spread`.
    Noise { seed: u32, spread: u8 },
    /// Grey patches of all sizes, 40 to 200: what a camera might see.
    Texture { seed: u32 },
    /// The same at night: a quarter as bright.
    DimTexture { seed: u32 },
}

impl Content {
    /// The grey level of a pixel.
    pub fn at(self, x: i32, y: i32) -> u8 {
        let white = |is_white: bool| if is_white { 255 } else { 0 };
        let field = |x: i32, size: u8| x.div_euclid(i32::from(size)) & 1;
        match self {
            Self::Constant(grey) => grey,
            Self::ConstantRows { seed } => hash(seed, 0, y),
            Self::Checkers { across, down } => white(field(x, across) != field(y, down)),
            Self::UprightStripes { across } => white(field(x, across) == 1),
            Self::LyingStripes { down } => white(field(y, down) == 1),
            Self::Ramp { across, down } => {
                u8::try_from((x * i32::from(across) + y * i32::from(down)).rem_euclid(256)).unwrap()
            }
            Self::Impulses { seed, one_in } => white(hash(seed, x, y).is_multiple_of(one_in)),
            Self::BlackOrWhite { seed } => white(hash(seed, x, y) >= 128),
            Self::Noise { seed, spread } => {
                let offset = (i32::from(hash(seed, x, y)) - 128) * i32::from(spread) / 128;
                u8::try_from((128 + offset).clamp(0, 255)).unwrap()
            }
            Self::Texture { seed } => texture(seed, 16 * x, y),
            Self::DimTexture { seed } => texture(seed, 16 * x, y) / 4,
        }
    }
}

/// All contents.
pub fn contents() -> impl Strategy<Value = Content> {
    let seed = any::<u32>();
    let size = 1..=40_u8;
    prop_oneof![
        1 => any::<u8>().prop_map(Content::Constant),
        1 => seed.prop_map(|seed| Content::ConstantRows { seed }),
        1 => (size.clone(), size.clone()).prop_map(|(across, down)| Content::Checkers { across, down }),
        1 => size.clone().prop_map(|across| Content::UprightStripes { across }),
        1 => size.prop_map(|down| Content::LyingStripes { down }),
        1 => any::<(i8, i8)>().prop_map(|(across, down)| Content::Ramp { across, down }),
        1 => (seed, 1..=255_u8).prop_map(|(seed, one_in)| Content::Impulses { seed, one_in }),
        1 => seed.prop_map(|seed| Content::BlackOrWhite { seed }),
        1 => (seed, 0..=255_u8).prop_map(|(seed, spread)| Content::Noise { seed, spread }),
        3 => seed.prop_map(|seed| Content::Texture { seed }),
        1 => seed.prop_map(|seed| Content::DimTexture { seed }),
    ]
}

/// Grey patches of three sizes, 40 to 200, at any 1/16 px across.
pub fn texture(seed: u32, x_q4: i32, y: i32) -> u8 {
    let sizes: [(i32, i32); 3] = [(12, 8), (5, 4), (2, 2)];
    let [coarse, middle, fine] =
        sizes.map(|(across, down)| patches(seed ^ down.cast_unsigned(), x_q4, y, across, down));
    u8::try_from(40 + (2 * coarse + 3 * middle + 3 * fine) * 160 / (8 * 255)).unwrap()
}

/// Random grey levels on a grid of `across` x `down` px, and what bilinear interpolation makes of
/// them in between.
fn patches(seed: u32, x_q4: i32, y: i32, across: i32, down: i32) -> i32 {
    let (column, row) = (x_q4.div_euclid(16 * across), y.div_euclid(down));
    let (right, below) = (x_q4.rem_euclid(16 * across), y.rem_euclid(down));
    let grey = |column, row| i32::from(hash(seed, column, row));
    let line = |row| grey(column, row) * (16 * across - right) + grey(column + 1, row) * right;
    (line(row) * (down - below) + line(row + 1) * below) / (16 * across * down)
}

/// A random byte for each place.
pub fn hash(seed: u32, x: i32, y: i32) -> u8 {
    let mut mixed = seed.wrapping_mul(0x9E37_79B1);
    for value in [x, y] {
        mixed = (mixed ^ value.cast_unsigned()).wrapping_mul(0x85EB_CA6B);
        mixed = (mixed ^ (mixed >> 15)).wrapping_mul(0xC2B2_AE35);
        mixed ^= mixed >> 13;
    }
    mixed.to_be_bytes()[0]
}
