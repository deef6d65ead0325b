//! Nanoseconds of direct light at a point of the rooms of
//! tests/data/references, one thread, on every rung of visibility.

#[path = "parts/directly.rs"]
mod directly;
#[path = "../tests/visibility/lit.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod lit;
#[path = "../tests/visibility/published.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod published;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use directly::{direct, placed};
use isolux::geometry::Receiver;
use isolux::visibility::{Unoccluded, VertexRays, Visibility};
use lit::{Lit, Small, receiver};
use std::hint::black_box;

fn rung(criterion: &mut Criterion, name: &str, visibility: &mut impl Visibility<f32>) {
    let mut group = criterion.benchmark_group(name);
    for (file, text) in published::FILES {
        let (scene, points) = published::read(text, |v| v);
        let lit = Lit::new(&scene);
        let emitters: Vec<_> = lit.emitters.iter().map(|(_, e)| placed(e)).collect();
        let receivers: Vec<Receiver<f32>> = points
            .iter()
            .map(|point| receiver(point.place, point.normal))
            .collect();
        let mut next = receivers.iter().cycle();
        group.bench_function(BenchmarkId::from_parameter(file), |bencher| {
            bencher.iter(|| {
                let receiver = next.next().expect("a receiver");
                direct(visibility, black_box(receiver), &lit.occlusion, &emitters)
            });
        });
    }
}

fn all(criterion: &mut Criterion) {
    rung(criterion, "none", &mut Unoccluded);
    rung(criterion, "vertex-rays", &mut VertexRays);
    rung(criterion, "exact", &mut Small::<f32>::new());
}

criterion_group!(benches, all);
criterion_main!(benches);
