//! The host's side of the conversation: it asks until it is answered.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use haarline_link::MOST;
use haarline_link::frame::{Decoder, FRAME, Frame};
use haarline_link::message::{Answer, Request, read, write};
use haarline_link::transfer::{Incoming, is_whole, send_missing};

use super::port::Port;

/// Asks a board.
pub struct Client {
    port: Box<dyn Port>,
    decoder: Decoder,
    answer: Incoming,
    sequence: u16,
    /// After so long without a frame it asks again, and after so long it gives up.
    again: Duration,
    patience: Duration,
    /// Times that it had to ask again.
    pub repeats: u64,
}

/// What came of waiting.
enum Heard {
    /// The last piece that was sent, or nothing for too long.
    Enough,
    /// A bit for each piece of the request that came.
    Came(u32),
}

impl Client {
    /// Talks through a port; `sequence` is any number that another host would hardly begin with.
    #[must_use]
    pub fn new(port: Box<dyn Port>, sequence: u16, again: Duration, patience: Duration) -> Self {
        let (decoder, answer) = (Decoder::default(), Incoming::default());
        Self { port, decoder, answer, sequence, again, patience, repeats: 0 }
    }

    /// The answer to a request, however often it has to be sent.
    ///
    /// # Errors
    /// If the port fails or the board says nothing for too long, or something that is not understood.
    pub fn ask(&mut self, request: &Request<'_>) -> Result<Answer<'_>> {
        let mut room = [0; MOST];
        let len = write(request, &mut room).context("a request that is too long")?;
        let request = &room[..len];
        self.sequence = self.sequence.wrapping_add(1);
        self.answer.expect(self.sequence);
        let mut came = 0;
        let mut last_sign = Instant::now();
        let mut rounds = 0_u64;
        while self.answer.message().is_none() {
            rounds += 1;
            if last_sign.elapsed() > self.patience {
                bail!("the board does not answer: does its program `bench` run, and is it the right port?");
            }
            let has_answer = self.answer.came() != 0;
            let mut bytes = Vec::new();
            let mut put = |frame: &Frame<'_>| bytes.extend_from_slice(frame.encode(&mut [0; FRAME]));
            if has_answer || is_whole(request, came) {
                put(&Frame::Missing { sequence: self.sequence, came: self.answer.came() });
            } else {
                send_missing(request, false, self.sequence, came, put);
            }
            // It ends what somebody said before, and a frame whose own end is lost.
            bytes.insert(0, 0);
            self.port.write_all(&bytes).and_then(|()| self.port.flush()).context("the port")?;
            match self.hear(&mut last_sign)? {
                // A board that was reset forgot what came, and what it answered.
                Heard::Came(now) => {
                    came = now;
                    self.answer.expect(self.sequence);
                }
                Heard::Enough => {}
            }
        }
        self.repeats += rounds - 1;
        let answer = self.answer.message().unwrap_or(&[]);
        read(answer).context("the board's answer is not understood: its program is of another version")
    }

    /// Listens until there is something to be done.
    fn hear(&mut self, last_sign: &mut Instant) -> Result<Heard> {
        let mut buffer = [0; 512];
        let mut heard = Instant::now();
        loop {
            let count = self.port.read(&mut buffer).context("the port")?;
            let mut result = None;
            for &byte in &buffer[..count] {
                match self.decoder.take(byte) {
                    Some(Frame::Piece { is_answer: true, sequence, index, pieces, asks, payload }) => {
                        self.answer.take(sequence, index, pieces, payload);
                        (heard, *last_sign) = (Instant::now(), Instant::now());
                        if asks && sequence == self.sequence {
                            result = Some(Heard::Enough);
                        }
                    }
                    Some(Frame::Came { sequence, came }) if sequence == self.sequence => {
                        *last_sign = Instant::now();
                        result = Some(Heard::Came(came));
                    }
                    _ => {}
                }
            }
            if let Some(result) = result {
                return Ok(result);
            }
            if heard.elapsed() > self.again {
                return Ok(Heard::Enough);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::collections::VecDeque;
    use std::io::{self, Read, Write};
    use std::rc::Rc;

    use haarline_link::message::Method;
    use haarline_link::server::Server;

    use super::*;

    /// A board behind a wire that loses and flips one byte in `rate`.
    struct Wire {
        server: Server,
        rate: u64,
        random: u64,
        back: VecDeque<u8>,
        executed: Rc<RefCell<Vec<String>>>,
        /// Bytes until the board is reset once.
        reset_after: usize,
    }

    impl Wire {
        fn garble(&mut self, byte: u8) -> Option<u8> {
            self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let draw = self.random >> 33;
            match self.rate {
                0 => Some(byte),
                rate if draw.is_multiple_of(rate) => {
                    (draw / rate).is_multiple_of(2).then_some(byte ^ (draw >> 9) as u8)
                }
                _ => Some(byte),
            }
        }
    }

    impl Write for Wire {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            for &byte in bytes {
                self.reset_after = self.reset_after.saturating_sub(1);
                if self.reset_after == 1 {
                    self.server = Server::default();
                }
                let Some(byte) = self.garble(byte) else { continue };
                let mut sent = Vec::new();
                let executed = Rc::clone(&self.executed);
                self.server.take(
                    byte,
                    |bytes| sent.extend_from_slice(bytes),
                    |request, answer| {
                        let request = read::<Request<'_>>(request).expect("a request that is whole is right");
                        let mut executed = executed.borrow_mut();
                        executed.push(format!("{request:?}"));
                        let row = [7; 640];
                        let answered = match request {
                            Request::Take(y) => Answer::Row { y, disparity: &row, confidence: &row[..320] },
                            _ => Answer::Done(executed.len() as u32),
                        };
                        write(&answered, answer).expect("it fits")
                    },
                );
                for byte in sent {
                    let garbled = self.garble(byte);
                    self.back.extend(garbled);
                }
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Read for Wire {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = buffer.len().min(self.back.len());
            buffer.iter_mut().zip(self.back.drain(..count)).for_each(|(to, from)| *to = from);
            Ok(count)
        }
    }

    fn talk(rate: u64, reset_after: usize) -> (Vec<String>, u64) {
        let executed = Rc::new(RefCell::new(Vec::new()));
        let (server, back) = (Server::default(), VecDeque::new());
        let wire = Wire { server, rate, random: 1, back, executed: Rc::clone(&executed), reset_after };
        let mut client = Client::new(Box::new(wire), 99, Duration::from_micros(50), Duration::from_secs(20));
        let row: Vec<u8> = (0..640).map(|at| at as u8).collect();
        client.ask(&Request::Begin { method: Method::Full, width: 320, min_disparity: 0 }).unwrap();
        for y in 0..20 {
            client.ask(&Request::Push(&row)).unwrap();
            let answer = client.ask(&Request::Take(y)).unwrap();
            assert_eq!(answer, Answer::Row { y, disparity: &[7; 640], confidence: &[7; 320] });
        }
        let repeats = client.repeats;
        drop(client);
        (Rc::try_unwrap(executed).unwrap().into_inner(), repeats)
    }

    #[test]
    fn what_is_asked_is_done_once_whatever_is_lost() {
        let (clean, repeats) = talk(0, 0);
        assert_eq!((clean.len(), repeats), (41, 0));
        let (lossy, repeats) = talk(100, 0);
        assert!(repeats > 20, "{repeats} repeats");
        assert!(lossy == clean);
    }

    #[test]
    fn a_board_that_was_reset_is_asked_again() {
        let (asked, _) = talk(0, 3000);
        assert!((41..=42).contains(&asked.len()), "{}", asked.len());
    }

    #[test]
    fn silence_is_told() {
        let executed = Rc::default();
        let wire =
            Wire { server: Server::default(), rate: 1, random: 1, back: VecDeque::new(), executed, reset_after: 0 };
        let mut client = Client::new(Box::new(wire), 0, Duration::from_micros(50), Duration::from_millis(5));
        let error = client.ask(&Request::Hello).unwrap_err().to_string();
        assert!(error.starts_with("the board does not answer"), "{error}");
    }
}
