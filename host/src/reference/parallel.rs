//! Independent results computed by all processors, in order: what each
//! result is does not depend on which thread computes it.

use std::sync::Mutex;

/// Results handed to a thread at a time.
const BATCH: usize = 32;

/// Fills `out`, rows of `width`, by `fill(index, row)`.
pub(super) fn rows(out: &mut [f64], width: usize, fill: impl Fn(usize, &mut [f64]) + Sync) {
    if out.is_empty() || width == 0 {
        return;
    }
    let count = out.len() / width;
    let available = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    let threads = available.min(count.div_ceil(BATCH));
    let batches = Mutex::new(out.chunks_mut(BATCH * width).enumerate());
    let work = || {
        loop {
            let next = match batches.lock() {
                Ok(mut batches) => batches.next(),
                Err(_) => None,
            };
            let Some((batch, rows)) = next else {
                return;
            };
            for (offset, row) in rows.chunks_mut(width).enumerate() {
                fill(batch * BATCH + offset, row);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(work);
        }
        work();
    });
}
