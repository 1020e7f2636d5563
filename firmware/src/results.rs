//! The results task: disparity rows leave.

use crate::edge::RowSink;
use crate::ring::{From, ResultRow};

/// Sends rows off until there are no more.
pub async fn results(mut rows: From<ResultRow>, mut sink: impl RowSink) {
    loop {
        let row = rows.receive().await;
        if row.is_over {
            break;
        }
        sink.send(row).await;
        rows.receive_done();
    }
    sink.finish().await;
}
