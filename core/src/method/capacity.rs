//! How much room a method has.

use crate::{Config, ConfigError};

/// Columns of a word of a row.
const COLUMNS: usize = 4;
/// Words of margin on both sides of a row.
const MARGINS: usize = 2;

/// Words that a row of `width` px needs, margins included: the capacity to build a method with.
///
/// # Examples
/// ```
/// use haarline::{Lite, blocks_for};
/// type Qvga = Lite<{ blocks_for(320) }>;
/// assert!(size_of::<Qvga>() <= 22 * 1024);
/// ```
#[must_use]
pub const fn blocks_for(width: u16) -> usize {
    words((width as usize).div_ceil(COLUMNS))
}

/// Words for a row of so many cells of four columns: those and the margins, and rows with a byte a cell are whole words.
const fn words(cells: usize) -> usize {
    cells + if cells % 4 == 1 { MARGINS + 1 } else { MARGINS }
}

/// Checks the configuration of a method with a capacity of so many words.
pub(crate) fn check_capacity(config: &Config, words: usize) -> Result<(), ConfigError> {
    config.check()?;
    if blocks_for(config.width) > words {
        let cells = words.saturating_sub(MARGINS);
        let cells = if self::words(cells) > words { cells.saturating_sub(1) } else { cells };
        let max_width = u16::try_from(COLUMNS * cells).unwrap_or(u16::MAX);
        return Err(ConfigError::Capacity { max_width });
    }
    Ok(())
}
