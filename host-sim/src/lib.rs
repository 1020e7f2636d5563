//! The host side of Haarline.
