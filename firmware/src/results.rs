//! The results task: disparity rows leave as packets.

use haarline::DisparityRow;
use haarline::packet::{Encoder, max_bytes};

use crate::edge::PacketSink;
use crate::ring::{From, ResultKind, ResultRow};

/// Room for the packet of the widest row.
const PACKET: usize = max_bytes(320);

/// Sends rows of `size` frames off until there are no more.
pub async fn results(mut rows: From<ResultRow>, mut sink: impl PacketSink, size: [u16; 2]) {
    let mut encoder = Encoder::new();
    let mut buffer = [0; PACKET];
    let (mut begun, mut sent) = (None, 0);
    loop {
        let slot = rows.receive().await;
        if slot.kind == ResultKind::Over {
            break;
        }
        let frame = slot.place.frame;
        if begun != Some(frame) {
            (begun, sent) = (Some(frame), 0);
            if let Ok(packet) = encoder.begin(frame, size, &slot.counters, &mut buffer) {
                sink.send(frame, packet).await;
            }
        }
        let packet = match slot.kind {
            ResultKind::Row => {
                sent += 1;
                let disparity = slot.disparity.get(..slot.width).unwrap_or(&[]);
                let confidence = slot.confidence.get(..slot.width).unwrap_or(&[]);
                let row = DisparityRow { y: slot.place.row, disparity, confidence };
                encoder.row(frame, row, &slot.counters, &mut buffer)
            }
            _ => encoder.end(frame, sent, &slot.counters, &mut buffer),
        };
        // The buffer is large enough for every row of the ring.
        if let Ok(packet) = packet {
            sink.send(frame, packet).await;
        }
        rows.receive_done();
    }
    sink.finish().await;
}
