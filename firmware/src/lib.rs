//! What the programs of this package share.
#![no_std]

pub mod picture;
