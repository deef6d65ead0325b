//! Time on this machine.

use super::suite;
use crate::solve::FormFactorRung;
use std::hint::black_box;
use std::time::Instant;

/// Rounds, of which the quickest counts: the others were disturbed.
const ROUNDS: usize = 9;

/// How often a round takes every case.
const TIMES: usize = 20;

/// Nanoseconds of a form factor of the suite's class `ordinary`, from vertices
/// in memory: the receiver is made and the emitter's plane is found each time.
pub(super) fn nanoseconds(rung: FormFactorRung) -> f64 {
    let cases = suite::cases("ordinary");
    let mut quickest = f64::INFINITY;
    for _ in 0..ROUNDS {
        let begun = Instant::now();
        for _ in 0..TIMES {
            for case in &cases {
                let case = black_box(case);
                let answer = rung.form_factor(case.position, case.normal, &case.vertices);
                // Only its being computed matters here.
                let _ = black_box(answer);
            }
        }
        quickest = quickest.min(begun.elapsed().as_secs_f64());
    }
    1e9 * quickest / (TIMES * cases.len().max(1)) as f64
}
