//! Time of every step of a whole scene on the host, for both of the paper's
//! light shapes, and of its rivals.
//!
//! The kernel's steps run on one core; planning and the reference use all.

#[path = "parts/planned.rs"]
mod planned;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use isolux::form_factor::Best;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux_host::baseline::{self, Parameters};
use isolux_host::solve::HostRoot;
use isolux_host::{bake, plan};
use planned::Planned;
use std::hint::black_box;
use std::time::Duration;

/// Cells along each side of a resampled surface.
const GRID: u32 = 200;

/// Points at which the reference is asked.
const ASKED: usize = 256;

/// The kernel's state with room for the paper's samples and emitters.
type PaperLight<'t> = Light<'t, Best<HostRoot>, 64, 16>;

fn host(group: &mut BenchmarkGroup<'_, WallTime>, planned: &Planned) {
    let Planned { scene, plan, .. } = planned;
    let once = planned::reference(scene);
    group.bench_function("reference: prepare", |bencher| {
        bencher.iter(|| planned::reference(scene));
    });
    let frame = &plan.surfaces[2].frame;
    let places: Vec<(DVec3, DVec3)> = (0..ASKED)
        .map(|k| {
            let (u, v) = frame.cell_center(k % 16, k / 16, 16, 16);
            (frame.to_world(u, v), frame.normal)
        })
        .collect();
    group.bench_function("reference: 256 points of B", |bencher| {
        bencher.iter(|| once.irradiance_at(black_box(&places)));
    });
    group.bench_function("plan", |bencher| {
        let field = |places: &[_]| once.irradiance_at(places);
        bencher.iter(|| plan::isolux(scene, &scene.budget, &field));
    });
    group.bench_function("bake", |bencher| {
        bencher.iter(|| bake::bake(scene, plan, None))
    });
}

fn kernel(group: &mut BenchmarkGroup<'_, WallTime>, planned: &Planned) {
    let bytes = planned.tables.bytes();
    group.bench_function("load", |bencher| {
        bencher.iter(|| Scene::load(black_box(bytes)).map(PaperLight::new));
    });
    let tables = Scene::load(bytes).expect("baked tables");
    let mut light = PaperLight::new(tables).expect("room for the paper's scene");
    group.bench_function("direct", |bencher| {
        bencher.iter(|| black_box(&mut light).direct());
    });
    for (name, stop) in [
        ("direct and one reflection", Stop::Reflections(1)),
        ("direct and shots to 0.1 %", Stop::below(0.001)),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| black_box(&mut light).solve(stop));
        });
    }
    for surface in [0, 2] {
        let name = &planned.scene.surfaces[surface].name;
        let mut row = [0.0; GRID as usize];
        group.bench_function(BenchmarkId::new("resample 200 x 200", name), |bencher| {
            bencher.iter(|| {
                for number in 0..GRID {
                    let done = light.resample_row::<HostRoot>(surface, [GRID; 2], number, &mut row);
                    black_box(done.expect("a row of a surface"));
                    black_box(&row);
                }
            });
        });
    }
}

fn classical(group: &mut BenchmarkGroup<'_, WallTime>, planned: &Planned) {
    for (column, parameters) in (1..).zip(Parameters::table_2()) {
        group.bench_function(BenchmarkId::new("baseline, scene", column), |bencher| {
            bencher.iter(|| baseline::solve(&planned.scene, black_box(&parameters)));
        });
    }
}

fn scenes(criterion: &mut Criterion) {
    for planned in planned::scenes() {
        let mut group = criterion.benchmark_group(&planned.scene.name);
        group
            .sample_size(10)
            .warm_up_time(Duration::from_millis(200))
            .measurement_time(Duration::from_secs(1));
        host(&mut group, &planned);
        kernel(&mut group, &planned);
        classical(&mut group, &planned);
        group.finish();
    }
}

criterion_group!(benches, scenes);
criterion_main!(benches);
