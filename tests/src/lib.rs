//! Reference stereo methods to compare with. They run on the host and on the chip.
#![no_std]
