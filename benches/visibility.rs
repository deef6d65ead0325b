//! Nanoseconds of direct light at a point of the rooms of
//! tests/data/references, one thread, on every rung of visibility.

#[path = "../tests/visibility/lit.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod lit;
#[path = "../tests/visibility/published.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod published;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use isolux::form_factor::{Best, Outline, of_loops};
use isolux::geometry::{Plane, Receiver};
use isolux::visibility::{Unoccluded, VertexRays, Visibility};
use isolux_host::occlusion::{Emitter, Occlusion};
use isolux_host::solve::HostRoot;
use lit::{Lit, Small, receiver};
use std::hint::black_box;
use std::iter::once;

/// An emitter as a firmware has it: its vertices in space beside its frame.
struct Placed<'l> {
    emitter: &'l Emitter,
    plane: Plane<f32>,
    vertices: Vec<[f32; 3]>,
}

fn placed(emitter: &Emitter) -> Placed<'_> {
    let vertices = lit::vertices::<f32>(emitter);
    Placed {
        emitter,
        plane: Plane::of_polygon(&vertices),
        vertices,
    }
}

fn direct(
    visibility: &mut impl Visibility<f32>,
    receiver: &Receiver<f32>,
    occlusion: &Occlusion,
    emitters: &[Placed<'_>],
) -> f32 {
    let occluders = occlusion.records();
    let mut sum = 0.0;
    for placed in emitters {
        let outline = Outline::new(&placed.vertices);
        let whole = || of_loops::<Best<HostRoot>, f32>(receiver, &placed.plane, once(outline));
        let seen = visibility.form_factor::<HostRoot>(
            receiver,
            &placed.emitter.target(),
            &occluders,
            placed.emitter.blockers().iter().copied(),
            whole,
        );
        sum += seen.low;
    }
    sum
}

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
