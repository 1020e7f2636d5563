//! The two readings of the paper's "wavelet-modified" block matching: what the blocks consist of.

/// What a block is made of when it is compared with others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reading {
    /// Intensities: pixels less the mean of the 3 rows and 16 columns around them.
    Intensity,
    /// Responses of Haar cascades: the gradient across in even rows, down in odd ones.
    #[default]
    Haar,
}
