//! The two edges of the application, which tell what goes on there.

use haarline::{Stage, StageClock};

use crate::app::edge::{PacketSink, RowSource, SourceEvent, Work, WorkClock};
use crate::app::phase::Activity;

/// Takes what begins or ends.
pub type Tell = fn(Activity, bool);

/// A source of rows that tells when a frame comes. A frame that never ends is told until the next one's end.
pub struct ShownSource<S> {
    source: S,
    tell: Tell,
}

impl<S> ShownSource<S> {
    /// Tells of `source`.
    pub const fn new(source: S, tell: Tell) -> Self {
        Self { source, tell }
    }
}

impl<S: RowSource> RowSource for ShownSource<S> {
    async fn next(&mut self, bytes: &mut [u8]) -> SourceEvent {
        let event = self.source.next(bytes).await;
        match event {
            SourceEvent::Start => (self.tell)(Activity::Capture, true),
            SourceEvent::End | SourceEvent::Overrun | SourceEvent::DmaError | SourceEvent::Over => {
                (self.tell)(Activity::Capture, false);
            }
            SourceEvent::Row(_) | SourceEvent::Border | SourceEvent::Lost => {}
        }
        event
    }

    fn is_waiting(&self) -> bool {
        self.source.is_waiting()
    }
}

/// Where packets go, telling when the last byte of each has left.
pub struct ShownSink<S> {
    sink: S,
    tell: Tell,
}

impl<S> ShownSink<S> {
    /// Tells of `sink`.
    pub const fn new(sink: S, tell: Tell) -> Self {
        Self { sink, tell }
    }
}

impl<S: PacketSink> PacketSink for ShownSink<S> {
    async fn send(&mut self, frame: u32, packet: &[u8]) {
        (self.tell)(Activity::Send, true);
        self.sink.send(frame, packet).await;
        (self.tell)(Activity::Send, false);
    }

    async fn finish(&mut self) {
        self.sink.finish().await;
    }
}

/// A clock that counts nothing and tells when a packet is made: what is made is sent, so the sink tells of its end.
pub struct ShownPackets(pub Tell);

impl StageClock for ShownPackets {
    fn enter(&self, _: Stage) {}
}

impl WorkClock for ShownPackets {
    fn rest(&self, _: Work) {}

    fn swap(&self, stage: Option<Stage>) -> Option<Stage> {
        if stage == Some(Stage::Packets) {
            (self.0)(Activity::Send, true);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use core::future::Future;
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};
    use std::cell::RefCell;

    use super::*;

    thread_local! {
        static TOLD: RefCell<Vec<(Activity, bool)>> = const { RefCell::new(Vec::new()) };
    }

    fn tell(activity: Activity, is_on: bool) {
        TOLD.with_borrow_mut(|told| told.push((activity, is_on)));
    }

    fn told() -> Vec<(Activity, bool)> {
        TOLD.take()
    }

    /// Runs what never waits.
    fn run<T>(future: impl Future<Output = T>) -> T {
        match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(done) => done,
            Poll::Pending => panic!("it waits"),
        }
    }

    struct Events(Vec<SourceEvent>);

    impl RowSource for Events {
        async fn next(&mut self, _: &mut [u8]) -> SourceEvent {
            self.0.remove(0)
        }
    }

    #[test]
    fn a_frame_comes_from_its_start_to_its_end_however_it_ends() {
        for end in [SourceEvent::End, SourceEvent::Overrun, SourceEvent::DmaError, SourceEvent::Over] {
            let events = [SourceEvent::Border, SourceEvent::Start, SourceEvent::Row(4), SourceEvent::Lost, end];
            let mut source = ShownSource::new(Events(events.to_vec()), tell);
            for event in events {
                assert_eq!(run(source.next(&mut [])), event);
            }
            assert_eq!(told(), [(Activity::Capture, true), (Activity::Capture, false)], "{end:?}");
        }
    }

    struct Sink(usize);

    impl PacketSink for Sink {
        async fn send(&mut self, _: u32, packet: &[u8]) {
            self.0 += packet.len();
            tell(Activity::Compute, true);
        }

        async fn finish(&mut self) {}
    }

    #[test]
    fn a_row_is_sent_from_the_making_of_its_packet_to_its_last_byte() {
        let (clock, mut sink) = (ShownPackets(tell), ShownSink::new(Sink(0), tell));
        let before = clock.swap(Some(Stage::Packets));
        clock.swap(before);
        assert_eq!(told(), [(Activity::Send, true)]);
        run(sink.send(0, b"abc"));
        assert_eq!(sink.sink.0, 3);
        assert_eq!(told(), [(Activity::Send, true), (Activity::Compute, true), (Activity::Send, false)]);
    }
}
