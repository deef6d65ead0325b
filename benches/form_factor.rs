//! Nanoseconds of one form factor on the host, over the same emitters and
//! receivers as the instructions of `cargo bench --bench instructions`.

#[path = "../tests/firmware/src/cost_cases.rs"]
mod cost_cases;
#[path = "../tests/firmware/src/cost_samples.rs"]
mod cost_samples;

use cost_cases::{CASES, Case, VERTICES};
use cost_samples::{RECEIVERS, Samples};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use isolux::form_factor::fixed_point::{self, Format, Q24, Q29};
use isolux::form_factor::{Arithmetic, Best, Libm, Outline, of_loops};
use isolux::geometry::{Plane, Receiver};
use isolux_host::solve::HostRoot;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Time of `calls` calls, each with the next receiver in turn.
fn in_turn<R, F>(calls: u64, receivers: &[R], call: impl Fn(&R) -> F) -> Duration {
    let rounds = calls.div_ceil(RECEIVERS as u64);
    let begun = Instant::now();
    for _ in 0..rounds {
        for receiver in receivers {
            black_box(call(black_box(receiver)));
        }
    }
    let spent = begun.elapsed().as_secs_f64();
    Duration::from_secs_f64(spent * calls as f64 / (rounds * RECEIVERS as u64) as f64)
}

fn receivers(of: impl Fn(usize) -> Result<Receiver<f32>, isolux::Error>) -> Vec<Receiver<f32>> {
    let all = (0..RECEIVERS).map(of).collect::<Result<_, _>>();
    all.expect("receivers that are some")
}

fn rung<A: Arithmetic<f32>>(group: &mut BenchmarkGroup<'_, WallTime>, case: &Case) {
    let receivers = receivers(|index| case.receiver(index));
    for vertices in VERTICES {
        let corners = case.emitter(vertices);
        let corners = &corners[..vertices];
        let (plane, outline) = (Plane::of_polygon(corners), Outline::new(corners));
        group.bench_function(BenchmarkId::new(case.name, vertices), |bencher| {
            bencher.iter_custom(|calls| {
                in_turn(calls, &receivers, |receiver| {
                    let outline = black_box(outline);
                    of_loops::<A, f32>(receiver, black_box(&plane), std::iter::once(outline))
                })
            });
        });
    }
}

fn fixed_rung<F: Format>(group: &mut BenchmarkGroup<'_, WallTime>, case: &Case) {
    for vertices in VERTICES {
        let placed = |index| case.fixed::<F>(vertices, index).expect("a receiver");
        let receivers: Vec<_> = (0..RECEIVERS).map(|index| placed(index).1).collect();
        let (corners, _) = placed(0);
        let corners = &corners[..vertices];
        let plane = fixed_point::Plane::of_polygon(corners);
        group.bench_function(BenchmarkId::new(case.name, vertices), |bencher| {
            bencher.iter_custom(|calls| {
                in_turn(calls, &receivers, |receiver| {
                    let outline = black_box(corners);
                    fixed_point::of_loops(receiver, black_box(&plane), std::iter::once(outline))
                })
            });
        });
    }
}

fn form_factors(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("best");
    for case in &CASES {
        rung::<Best<HostRoot>>(&mut group, case);
    }
    group.finish();
    let mut group = criterion.benchmark_group("libm");
    for case in &CASES {
        rung::<Libm<HostRoot>>(&mut group, case);
    }
    group.finish();
    let mut group = criterion.benchmark_group("q24");
    for case in &CASES {
        fixed_rung::<Q24>(&mut group, case);
    }
    group.finish();
    let mut group = criterion.benchmark_group("q29");
    for case in &CASES {
        fixed_rung::<Q29>(&mut group, case);
    }
    group.finish();
}

/// The classical method's form factor of one vertex, in `f32`.
fn classical(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("delta form factors");
    let receivers = receivers(Samples::receiver);
    for side in [4, 20] {
        let samples = Samples::on_the_light(side);
        group.bench_function(BenchmarkId::from_parameter(side * side), |bencher| {
            bencher.iter_custom(|calls| {
                in_turn(calls, &receivers, |receiver| {
                    black_box(&samples).form_factor(receiver)
                })
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(800));
    targets = form_factors, classical
}
criterion_main!(benches);
