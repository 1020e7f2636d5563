//! How the host's `haarline silicon` and a board's program `bench` talk over a serial port that loses and garbles bytes.
//!
//! The host asks, the board answers, one request at a time: that is the flow control. A message, up to [`MOST`] bytes, goes in
//! fragments of [`PIECE`] bytes, each a frame of its own ([`frame`]): COBS, so that a zero ends it, with a CRC-32. What is
//! missing is sent again ([`transfer`]). The board does nothing by itself: the host asks again after a time-out, and a request
//! that comes again is answered again and not carried out twice ([`server`]).
#![cfg_attr(not(test), no_std)]

pub mod frame;
pub mod measured;
pub mod message;
pub mod server;
pub mod transfer;

/// Bytes of a fragment: with one byte in a hundred lost or garbled, six in ten arrive.
pub const PIECE: usize = 40;
/// Fragments of a message.
pub const PIECES: usize = 32;
/// Bytes of a message.
pub const MOST: usize = PIECE * PIECES;
