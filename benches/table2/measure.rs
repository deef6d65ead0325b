//! The figures: errors, times and instructions of both methods.

use super::cost_samples::{RECEIVERS, Samples};
use super::planned::{self, Planned};
use super::prices::{CORE, Prices};
use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::scene::Scene;
use isolux::shoot::{Light, Stop};
use isolux_host::baseline::{self, Baseline, Parameters};
use isolux_host::compare::{self, Answers, Compared, Errors};
use isolux_host::device::{self, Error, Job, Options};
use isolux_host::occlusion::Solids;
use isolux_host::reference::Reference;
use isolux_host::solve::{self, HostRoot, Rung, Sight};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Cells along each side of the grids that errors are taken on.
const GRID: usize = 200;

/// Surfaces of the paper's scenes.
const A: usize = 0;
const B: usize = 2;

/// Rounds whose median is a time.
const ROUNDS: usize = 101;

/// How long a call is repeated in each round, at least.
const LASTING: Duration = Duration::from_millis(1);

/// Samples along each side of the light source, and of a patch.
const SOURCE_SIDE: usize = 20;
const PATCH_SIDE: usize = 4;

/// What both legs of the light took, in one unit.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Legs {
    /// From the light to A.
    pub(crate) first: f64,
    /// From A to B.
    pub(crate) second: f64,
}

impl Legs {
    /// Both.
    pub(crate) fn total(self) -> f64 {
        self.first + self.second
    }
}

/// One column of the table.
pub(crate) struct Column {
    /// Polygons or patches that shoot from A.
    pub(crate) polygons: usize,
    /// Samples or element vertices on A.
    pub(crate) on_a: usize,
    /// Samples or element vertices on B.
    pub(crate) on_b: usize,
    /// Errors on A.
    pub(crate) error_a: Errors,
    /// Errors on B.
    pub(crate) error_b: Errors,
    /// Largest relative errors at the samples themselves on A and B, in
    /// percent: what is wrong before anything is resampled.
    pub(crate) at_samples: Option<[f64; 2]>,
    /// Seconds on the host.
    pub(crate) seconds: Legs,
    /// Form factors or delta form factors.
    pub(crate) evaluations: Legs,
    /// Instructions on the device.
    pub(crate) instructions: Option<Legs>,
    /// Seconds of the delta form factors alone, in `f32` with one division.
    pub(crate) lean_seconds: Option<f64>,
    /// Instructions with exact form factors for the light's shot.
    pub(crate) exact_first: Option<f64>,
}

/// A scene's table.
pub(crate) struct Table {
    /// The scene's name.
    pub(crate) scene: String,
    /// Structured sampling.
    pub(crate) structured: Column,
    /// Ray-traced form factors.
    pub(crate) classical: Vec<Column>,
}

/// Measures a scene.
pub(crate) fn scene(
    planned: &Planned,
    prices: Option<&Prices>,
) -> Result<Table, Box<dyn std::error::Error>> {
    let solution = solve::solve(
        &planned.tables,
        Rung::Best,
        Sight::None,
        Stop::Reflections(1),
    )?;
    let once = planned::reference(&planned.scene);
    let answers = Answers {
        scene: &planned.scene,
        plan: &planned.plan,
        reference: &once,
        solution: &solution,
        baseline: None,
    };
    let solids = Solids::of(&planned.scene);
    let of = |surface| compare::surface(&answers, &solids, surface, GRID, &mut |_| {});
    let (a, b) = (of(A)?, of(B)?);
    let mut structured = structured(planned, [&a, &b], prices.is_some())?;
    let columns = Parameters::table_2();
    let times = Times::measure(planned, &columns)?;
    structured.seconds = times.structured;
    structured.at_samples = Some([A, B].map(|surface| {
        let sampled: Vec<f32> = solution.irradiance().iter().map(|e| e[0]).collect();
        largest_error(planned, &once, &sampled, surface)
    }));
    let mut classical = Vec::new();
    for (parameters, &seconds) in columns.iter().zip(&times.classical) {
        let mut column = column(planned, parameters, [&a, &b], prices)?;
        column.seconds = seconds;
        let Legs { first, second } = column.evaluations;
        column.lean_seconds = Some(first * times.lean_source + second * times.lean_patch);
        classical.push(column);
    }
    Ok(Table {
        scene: planned.scene.name.clone(),
        structured,
        classical,
    })
}

fn structured(
    planned: &Planned,
    [a, b]: [&Compared; 2],
    device: bool,
) -> Result<Column, Box<dyn std::error::Error>> {
    let tables = Scene::load(planned.tables.bytes())?;
    let mut light = Light::<Best<HostRoot>, 64, 16>::new(tables)?;
    let direct = light.solve(Stop::Reflections(0)).form_factors;
    let both = light.solve(Stop::Reflections(1)).form_factors;
    Ok(Column {
        polygons: planned.plan.surfaces[A].bands.len(),
        on_a: planned.plan.surfaces[A].samples.len(),
        on_b: planned.plan.surfaces[B].samples.len(),
        error_a: a.errors,
        error_b: b.errors,
        at_samples: None,
        seconds: Legs::default(),
        evaluations: Legs {
            first: f64::from(direct),
            second: f64::from(both - direct),
        },
        instructions: device.then(|| instructions(planned)).transpose()?,
        lean_seconds: None,
        exact_first: None,
    })
}

/// The largest relative error at the samples of a surface, in percent.
fn largest_error(planned: &Planned, once: &Reference, sampled: &[f32], surface: usize) -> f64 {
    let surfaces = &planned.plan.surfaces;
    let before = surfaces[..surface].iter();
    let first: usize = before.map(|other| other.samples.len()).sum();
    let of = &surfaces[surface];
    let place = |[u, v]: [f64; 2]| (of.frame.to_world(u, v), of.frame.normal);
    let places: Vec<_> = of
        .samples
        .iter()
        .map(|sample| place(sample.place))
        .collect();
    let exact = once.irradiance_at(&places);
    let pairs = sampled[first..].iter().zip(exact);
    pairs
        .map(|(&value, exact)| 100.0 * (f64::from(value) / exact - 1.0).abs())
        .fold(0.0, f64::max)
}

/// Instructions of direct light and of one reflection on the device.
fn instructions(planned: &Planned) -> Result<Legs, Error> {
    let job = Job {
        scene: &planned.scene.name,
        tables: planned.tables.bytes(),
        arithmetic: Rung::Best.name(),
        visibility: "none",
        stop: Stop::Reflections(1),
        // Resampling is not part of either method's time.
        resolution: 1,
        expected: &[],
        budget: planned.scene.budget,
    };
    let options = Options {
        cores: vec![CORE],
        software_root: false,
        ..Options::default()
    };
    let steps = device::run(&job, &options)?.instructions_by_step;
    Ok(Legs {
        first: steps.direct as f64,
        second: steps.shoot as f64,
    })
}

fn column(
    planned: &Planned,
    parameters: &Parameters,
    [a, b]: [&Compared; 2],
    prices: Option<&Prices>,
) -> Result<Column, baseline::Error> {
    let scene = &planned.scene;
    let solved = baseline::solve(scene, parameters)?;
    let deltas = |round: usize| -> f64 {
        let shots = solved.shots().iter().filter(|shot| shot.round == round);
        shots.map(|shot| shot.evaluations as f64).sum()
    };
    let evaluations = Legs {
        first: deltas(0),
        second: deltas(1),
    };
    let on_a = solved.vertices(A).unwrap_or(0);
    let [along, across] = parameters.surfaces[0].1.patches;
    Ok(Column {
        polygons: along * across,
        on_a,
        on_b: solved.vertices(B).unwrap_or(0),
        error_a: errors(planned, &solved, a),
        error_b: errors(planned, &solved, b),
        at_samples: None,
        seconds: Legs::default(),
        evaluations,
        instructions: prices.map(|prices| Legs {
            first: evaluations.first * prices.on_source,
            second: evaluations.second * prices.on_patch,
        }),
        lean_seconds: None,
        exact_first: prices
            .map(|prices| on_a as f64 * prices.exact + evaluations.second * prices.on_patch),
    })
}

/// What the classical method errs by on the cells that the kernel was judged on.
fn errors(planned: &Planned, solved: &Baseline, judged: &Compared) -> Errors {
    let frame = &planned.plan.surfaces[judged.surface].frame;
    let cells = (0..GRID * GRID).filter(|&k| judged.inside[k]);
    let values = cells.map(|k| {
        let (u, v) = frame.cell_center(k % GRID, k / GRID, GRID, GRID);
        let value = solved.irradiance_at(judged.surface, frame.to_world(u, v));
        (value.unwrap_or(f64::NAN), judged.reference[k])
    });
    compare::errors(values, judged.full_scale)
}

/// Samples and receivers of the classical method alone, in `f32`.
struct Lean {
    samples: Samples,
    receivers: Vec<Receiver<f32>>,
}

impl Lean {
    fn new(side: usize) -> Self {
        Self {
            samples: Samples::on_the_light(side),
            receivers: (0..RECEIVERS).flat_map(Samples::receiver).collect(),
        }
    }

    fn run(&self) {
        for receiver in &self.receivers {
            black_box(black_box(&self.samples).form_factor(black_box(receiver)));
        }
    }
}

/// Times of everything that is compared, in seconds.
struct Times {
    structured: Legs,
    /// A delta form factor in `f32` with one division, on the source.
    lean_source: f64,
    /// The same on a patch.
    lean_patch: f64,
    classical: Vec<Legs>,
}

impl Times {
    fn measure(planned: &Planned, columns: &[Parameters]) -> Result<Self, isolux::Error> {
        let tables = Scene::load(planned.tables.bytes())?;
        let mut light = Light::<Best<HostRoot>, 64, 16>::new(tables)?;
        let mut other = light.clone();
        let (lean_source, lean_patch) = (Lean::new(SOURCE_SIDE), Lean::new(PATCH_SIDE));
        let unreflected: Vec<Parameters> = columns.iter().map(unreflected).collect();
        let mut calls: Vec<Box<dyn FnMut() + '_>> = vec![
            Box::new(|| {
                black_box(&mut light).direct();
            }),
            Box::new(|| {
                black_box(&mut other).solve(Stop::Reflections(1));
            }),
            Box::new(|| lean_source.run()),
            Box::new(|| lean_patch.run()),
        ];
        for parameters in unreflected.iter().chain(columns) {
            calls.push(Box::new(|| {
                // What it refuses is found out before anything is timed.
                let _ = black_box(baseline::solve(&planned.scene, black_box(parameters)));
            }));
        }
        let times = medians(&mut calls);
        let (first, total) = times[4..].split_at(columns.len());
        let deltas = |side: usize| (RECEIVERS * side * side) as f64;
        Ok(Self {
            structured: Legs {
                first: times[0],
                second: times[1] - times[0],
            },
            lean_source: times[2] / deltas(SOURCE_SIDE),
            lean_patch: times[3] / deltas(PATCH_SIDE),
            classical: first
                .iter()
                .zip(total)
                .map(|(&first, &total)| Legs {
                    first,
                    second: total - first,
                })
                .collect(),
        })
    }
}

/// The same without reflected light.
fn unreflected(parameters: &Parameters) -> Parameters {
    Parameters {
        stop: baseline::Stop::Reflections(0),
        ..parameters.clone()
    }
}

/// The median time of each call, in seconds. The calls take turns, so that
/// whatever else the machine does strikes all of them alike.
fn medians(calls: &mut [Box<dyn FnMut() + '_>]) -> Vec<f64> {
    let time = |call: &mut Box<dyn FnMut() + '_>, times: u32| {
        let begun = Instant::now();
        (0..times).for_each(|_| call());
        begun.elapsed()
    };
    let repeats: Vec<u32> = calls
        .iter_mut()
        .map(|call| {
            let mut repeats = 1;
            while time(call, repeats) < LASTING {
                repeats *= 2;
            }
            repeats
        })
        .collect();
    let mut times = vec![Vec::with_capacity(ROUNDS); calls.len()];
    for _ in 0..ROUNDS {
        for ((call, &repeats), times) in calls.iter_mut().zip(&repeats).zip(&mut times) {
            times.push(time(call, repeats).as_secs_f64() / f64::from(repeats));
        }
    }
    times
        .into_iter()
        .map(|mut times| {
            times.sort_by(f64::total_cmp);
            times[ROUNDS / 2]
        })
        .collect()
}
