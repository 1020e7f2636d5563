//! The results task: disparity rows leave as packets.

use haarline::packet::{Encoder, FrameEnd, PacketError, max_bytes};
use haarline::{DisparityRow, Stage};

use crate::app::edge::{PacketSink, WorkClock};
use crate::app::ring::{From, MAX_WIDTH, ResultKind, ResultRows, SLOT_ROWS};

/// Room for the packet of the widest row.
#[expect(clippy::cast_possible_truncation, reason = "a few hundred columns")]
const PACKET: usize = max_bytes(MAX_WIDTH as u16);

/// Sends rows of `size` frames off until there are no more. A frame that nobody ended was cut: it is ended here.
pub async fn results(mut rows: From<ResultRows>, mut sink: impl PacketSink, size: [u16; 2], clock: &impl WorkClock) {
    let mut sender = Sender { encoder: Encoder::new(), buffer: [0; PACKET], clock };
    let mut open: Option<(u32, FrameEnd)> = None;
    loop {
        let slot = rows.receive().await;
        if slot.kind == ResultKind::Over {
            break;
        }
        let frame = slot.place.frame;
        if let Some((cut, end)) = open
            && cut != frame
        {
            let end = FrameEnd { is_cut: true, unsent_frames: end.unsent_frames + 1, ..end };
            let packet = sender.make(|encoder, buffer| encoder.end(cut, &end, &slot.counters, buffer));
            sink.send(cut, packet).await;
            open = None;
        }
        if open.is_none() {
            let packet = sender.make(|encoder, buffer| encoder.begin(frame, size, &slot.counters, buffer));
            sink.send(frame, packet).await;
        }
        let (_, end) = open.get_or_insert((frame, FrameEnd { figures: None, is_cut: false, ..slot.end }));
        if slot.kind == ResultKind::End {
            let packet = sender.make(|encoder, buffer| encoder.end(frame, &slot.end, &slot.counters, buffer));
            sink.send(frame, packet).await;
            open = None;
        } else {
            end.rows += u32::try_from(slot.count).unwrap_or(0);
            let all: [DisparityRow<'_>; SLOT_ROWS] = core::array::from_fn(|nth| {
                let width = slot.width;
                let disparity = slot.disparity.get(nth).and_then(|row| row.get(..width)).unwrap_or(&[]);
                let confidence = slot.confidence.get(nth).and_then(|row| row.get(..width)).unwrap_or(&[]);
                let y = slot.place.row.saturating_add(u32::try_from(nth).unwrap_or(0));
                DisparityRow { y, disparity, confidence }
            });
            for mut left in all.get(..slot.count).unwrap_or(&all).chunks(slot.together.max(1)) {
                while !left.is_empty() {
                    let mut count = 1;
                    let packet = sender.make(|encoder, buffer| {
                        encoder.rows(frame, left, buffer).map(|(together, packet)| {
                            count = together;
                            packet
                        })
                    });
                    sink.send(frame, packet).await;
                    left = left.get(count..).unwrap_or(&[]);
                }
            }
        }
        rows.receive_done();
    }
    sink.finish().await;
}

/// Makes packets.
struct Sender<'a, C> {
    encoder: Encoder,
    buffer: [u8; PACKET],
    clock: &'a C,
}

impl<C: WorkClock> Sender<'_, C> {
    /// The packet that `make` makes; none if there is none. The buffer is large enough for every row of the ring.
    fn make<'b>(
        &'b mut self,
        make: impl FnOnce(&mut Encoder, &'b mut [u8]) -> Result<&'b mut [u8], PacketError>,
    ) -> &'b [u8] {
        let before = self.clock.swap(Some(Stage::Packets));
        let packet = make(&mut self.encoder, &mut self.buffer);
        self.clock.swap(before);
        packet.map_or(&[], |packet| packet)
    }
}
