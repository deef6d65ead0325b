//! Time that one thread spent, whatever else the machine does.

use cpu_time::{ProcessTime, ThreadTime};
use rayon::ThreadPoolBuilder;

/// Does `work` in a pool of one thread, so that the host's loops over samples
/// take one core.
pub(crate) fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(work)
}

/// Seconds of the processor that the calling thread spent on `work`.
pub(crate) fn once<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = ThreadTime::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}

/// The least of several times: what neighbours that empty the caches add is
/// left out.
#[allow(dead_code, reason = "not every bench repeats")]
pub(crate) fn least(rounds: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..rounds).map(|_| once(&mut work).0);
    times.fold(f64::INFINITY, f64::min)
}

/// Seconds that all processors together spent on `work`.
#[allow(dead_code, reason = "not every bench plans")]
pub(crate) fn of_all<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = ProcessTime::now();
    let result = work();
    (start.elapsed().as_secs_f64(), result)
}
