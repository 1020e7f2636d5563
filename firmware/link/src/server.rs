//! The board's side: it takes bytes, and gives bytes only as an answer to them.

use crate::MOST;
use crate::frame::{Decoder, FRAME, Frame};
use crate::transfer::{Incoming, send_missing};

/// The state of a conversation.
#[derive(Debug, Clone)]
pub struct Server {
    decoder: Decoder,
    request: Incoming,
    /// The request that was carried out last, and its answer.
    answered: Option<u16>,
    answer: [u8; MOST],
    answer_len: usize,
}

impl Default for Server {
    fn default() -> Self {
        Self {
            decoder: Decoder::default(),
            request: Incoming::default(),
            answered: None,
            answer: [0; MOST],
            answer_len: 0,
        }
    }
}

impl Server {
    /// Takes a byte. `send` gets bytes for the wire. A request that is whole is carried out by `execute`, once, which writes the
    /// answer and tells its length.
    pub fn take(
        &mut self,
        byte: u8,
        mut send: impl FnMut(&[u8]),
        execute: impl FnOnce(&[u8], &mut [u8; MOST]) -> usize,
    ) {
        let Some(frame) = self.decoder.take(byte) else { return };
        let (sequence, came) = match frame {
            Frame::Piece { is_answer: false, sequence, index, pieces, asks, payload } => {
                if self.answered != Some(sequence) {
                    if self.request.sequence() != Some(sequence) {
                        self.request.expect(sequence);
                    }
                    self.request.take(sequence, index, pieces, payload);
                    if let Some(request) = self.request.message() {
                        self.answer_len = execute(request, &mut self.answer).min(MOST);
                        self.answered = Some(sequence);
                    } else if asks {
                        return put(&Frame::Came { sequence, came: self.request.came() }, &mut send);
                    } else {
                        return;
                    }
                } else if !asks {
                    return;
                }
                (sequence, 0)
            }
            Frame::Missing { sequence, came } => (sequence, came),
            Frame::Piece { .. } | Frame::Came { .. } => return,
        };
        if self.answered == Some(sequence) {
            let answer = self.answer.get(..self.answer_len).unwrap_or(&[]);
            send_missing(answer, true, sequence, came, |frame| put(frame, &mut send));
        } else {
            // Whatever came of it: nothing, after a reset.
            let came = if self.request.sequence() == Some(sequence) { self.request.came() } else { 0 };
            put(&Frame::Came { sequence, came }, &mut send);
        }
    }
}

fn put(frame: &Frame<'_>, send: &mut impl FnMut(&[u8])) {
    let mut room = [0; FRAME];
    send(frame.encode(&mut room));
}
