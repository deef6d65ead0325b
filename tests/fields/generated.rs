//! Rooms that no one has looked at: they are planned within their budget, or clearly
//! refused, and what comes of the plan is light.

use crate::any_room;
use crate::random::Random;
use glam::DVec3;
use isolux::shoot::Stop;
use isolux_host::bake;
use isolux_host::compare::Regions;
use isolux_host::occlusion::Occlusion;
use isolux_host::pilot::{self, Manner};
use isolux_host::plan::shadow::Floor;
use isolux_host::plan::{Plan, PredictedAt, SurfacePlan, Tag};
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::Scene;
use isolux_host::solve::{self, Rung, Sight, Solution};
use rayon::prelude::*;
use std::ops::Range;

/// Rooms, unless `ISOLUX_ROOMS` says how many, or which: `65..66`.
const ROOMS: Range<u64> = 0..10;

/// A room where all samples of a surface are next to dark, and a patch of it is not.
const FAINT: u64 = 22;

/// Places of a surface at which its light is judged, and those that a tag is judged by at
/// the least.
const PLACES: usize = 100;
const OF_A_TAG: f64 = 10.0;

/// Light below this part of a surface's brightest place counts as that much.
const DARK: f64 = 1e-3;

/// A relative error from which on a place is simply wrong, as predictions count it.
const WRONG: f64 = 0.25;

/// Patches of the solution that is taken for the truth.
const PATCHES: usize = 800;

/// What became of rooms.
#[derive(Debug, Default)]
struct Outcome {
    refused: usize,
    surfaces: usize,
    /// Surfaces whose error is within what was predicted.
    within: usize,
    errors: Vec<f64>,
    /// Tags of surfaces, and how many of them err within what was predicted.
    tags: [usize; 2],
    /// What is no light that a place may have, and what is no reason to refuse a room.
    wrong: Vec<String>,
}

impl Outcome {
    fn and(mut self, other: Self) -> Self {
        self.refused += other.refused;
        self.surfaces += other.surfaces;
        self.within += other.within;
        self.errors.extend(other.errors);
        self.tags = [0, 1].map(|k| self.tags[k] + other.tags[k]);
        self.wrong.extend(other.wrong);
        self
    }
}

#[test]
fn any_room_is_planned_or_refused() {
    let rooms: Vec<u64> = match std::env::var("ISOLUX_ROOMS") {
        Ok(asked) => which(&asked).collect(),
        Err(_) => ROOMS.chain([FAINT]).collect(),
    };
    let of_one = |&seed: &u64| {
        let mut outcome = Outcome::default();
        one(seed, &mut outcome);
        outcome
    };
    let outcomes = rooms.par_iter().map(of_one);
    let mut outcome = outcomes.reduce(Outcome::default, Outcome::and);
    let rooms = rooms.len();
    outcome.errors.sort_by(f64::total_cmp);
    let part = |part: f64| {
        outcome
            .errors
            .get((part * outcome.errors.len() as f64) as usize)
    };
    println!(
        "{rooms} rooms, {} refused; {} of {} surfaces within the prediction; rms of a surface, median {:?}, of 95 % below {:?}",
        outcome.refused,
        outcome.within,
        outcome.surfaces,
        part(0.5),
        part(0.95),
    );
    assert!(outcome.wrong.is_empty(), "{:#?}", outcome.wrong);
    assert!(outcome.refused * 4 <= rooms, "{outcome:?}");
    let [tags, within] = outcome.tags;
    println!("{within} of {tags} tags of surfaces within the prediction");
    assert!(outcome.within * 100 >= outcome.surfaces * 95, "{outcome:?}");
    assert!(within * 100 >= tags * 90, "{outcome:?}");
}

/// `200` or `65..66`.
fn which(asked: &str) -> Range<u64> {
    let number = |text: &str| {
        text.parse()
            .expect("a number of rooms, or a range of seeds")
    };
    match asked.split_once("..") {
        Some((first, end)) => number(first)..number(end),
        None => 0..number(asked),
    }
}

fn one(seed: u64, outcome: &mut Outcome) {
    let mut scene = any_room::room(seed);
    let samples = 250 + 50 * (seed % 10);
    scene.budget.samples = Some(samples);
    let vertices = scene.surfaces.iter().flat_map(|s| s.vertices.clone());
    let occlusion = Occlusion::for_receivers_within(&scene, vertices).expect("occluders");
    let judge = Reference::new(&scene, Reflections::AtMost(0), &mut |_| {}).expect("a reference");
    let field = |places: &[(DVec3, DVec3)]| judge.irradiance_at(places);
    let looking = (Some(&occlusion), Sight::Exact);
    let plan = match pilot::room(&scene, &scene.budget, looking, Manner::default(), &field) {
        Ok(plan) => plan,
        Err(error) => {
            println!("seed {seed}: {error}");
            // That the kernel does not take a plan is the planner's fault.
            if matches!(error, pilot::Error::Kernel(_)) {
                outcome.wrong.push(format!("seed {seed}: {error}"));
            }
            outcome.refused += 1;
            return;
        }
    };
    assert!(plan.samples() as u64 <= samples, "seed {seed}");
    let tables = bake::bake(&scene, &plan, Some(occlusion.clone())).expect("tables");
    let fine = pilot::finely(&scene, PATCHES, looking, &field).expect("patches");
    let fine = bake::bake(&scene, &fine, Some(occlusion.clone())).expect("tables");
    let stop = Stop::below(1e-3);
    let [light, truth] = [&tables, &fine]
        .map(|tables| solve::solve(tables, Rung::default(), Sight::Exact, stop).expect("light"));
    judged(seed, &scene, &plan, [&light, &truth], outcome);
}

/// The most that a place of a surface has.
fn brightest_of(floor: &Floor, fine: &Solution<'_>) -> f64 {
    let (frame, side) = (&floor.frame, 60);
    let cells = (0..side * side).map(|k| frame.cell_center(k % side, k / side, side, side));
    let exposed = cells.filter(|&(u, v)| floor.is_exposed([u, v].into()));
    let normal = frame.normal.as_vec3().to_array();
    let receivers: Vec<([f32; 3], [f32; 3])> = exposed
        .map(|(u, v)| (frame.to_world(u, v).as_vec3().to_array(), normal))
        .collect();
    let values = fine.at(&receivers).expect("places");
    let values = values.iter().map(|at| f64::from(at.value[0]));
    values.fold(0.0, f64::max)
}

/// Compares what is reconstructed with what many more patches send to the same places.
fn judged(
    seed: u64,
    scene: &Scene,
    plan: &Plan,
    [light, fine]: [&Solution<'_>; 2],
    outcome: &mut Outcome,
) {
    let mut random = Random(seed + 1000);
    let regions = Regions::of(scene).expect("regions");
    let samples = light.irradiance().into_iter().flatten().map(f64::from);
    let in_the_room = samples.fold(0.0, f64::max);
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let planned = &plan.surfaces[index];
        if planned.fields.is_empty() {
            continue;
        }
        let floor = Floor::of(scene, index).expect("a floor");
        let frame = &floor.frame;
        let mut places: Vec<[f32; 2]> = Vec::new();
        for _ in 0..20 * PLACES {
            let (u, v) = (random.unit() * frame.size_u, random.unit() * frame.size_v);
            if places.len() < PLACES && floor.is_exposed([u, v].into()) {
                places.push([u as f32, v as f32]);
            }
        }
        let receivers: Vec<([f32; 3], [f32; 3])> = places
            .iter()
            .map(|&[u, v]| {
                let place = frame.to_world(f64::from(u), f64::from(v));
                (
                    place.as_vec3().to_array(),
                    frame.normal.as_vec3().to_array(),
                )
            })
            .collect();
        let truth: Vec<f64> = (fine.at(&receivers).expect("places").iter())
            .map(|at| f64::from(at.value[0]))
            .collect();
        let brightest = truth.iter().copied().fold(0.0, f64::max);
        if brightest <= 1e-6 * in_the_room {
            continue;
        }
        let mut squares: Vec<(Tag, f64, f64)> = Vec::new();
        for (&place, truth) in places.iter().zip(&truth) {
            let value = light.resampled(index, place).expect("a place of it");
            let value = f64::from(value.expect("it has fields")[0]);
            // The brightest of some places is not that of the surface.
            let bright = || brightest.max(brightest_of(&floor, fine));
            if !(value >= 0.0 && (value <= 4.0 * brightest || value <= 4.0 * bright())) {
                outcome.wrong.push(format!(
                    "seed {seed}, {} at {place:?}: {value} of {truth}, the brightest {brightest}, \
                     in the room {in_the_room}",
                    surface.name
                ));
            }
            let error = (value - truth) / truth.max(DARK * brightest);
            let [u, v] = place.map(f64::from);
            let tag = regions.tag(index, frame.to_world(u, v));
            squares.push((tag, error.abs().min(WRONG).powi(2), 1.0));
        }
        let sum: f64 = squares.iter().map(|(_, square, _)| square).sum();
        let error = (sum / places.len() as f64).sqrt();
        judged_by_tag(
            &PredictedAt::by_tag(places.len() as f64, &squares),
            planned,
            outcome,
        );
        let squares = planned.predicted.iter().map(|p| p.rms * p.rms * p.area);
        let predicted = (squares.sum::<f64>() / surface.area).sqrt();
        outcome.surfaces += 1;
        outcome.within += usize::from(error <= predicted);
        if error > predicted {
            println!(
                "seed {seed}, {}: {error:.4}, predicted {predicted:.4}",
                surface.name
            );
        }
        outcome.errors.push(error);
    }
}

/// Compares what the places of each tag err by with what was predicted of them.
fn judged_by_tag(found: &[PredictedAt], planned: &SurfacePlan, outcome: &mut Outcome) {
    for found in found.iter().filter(|found| found.area >= OF_A_TAG) {
        let mut predicted = planned.predicted_by_tag.iter();
        let predicted = predicted.find(|predicted| predicted.tag == found.tag);
        outcome.tags[0] += 1;
        outcome.tags[1] += usize::from(predicted.is_some_and(|p| found.rms <= p.rms));
    }
}
