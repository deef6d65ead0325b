//! Where the light of a solved scene went: nothing may be lost or made.
//!
//! Every luminaire and secondary emitter has shot a known power; what the
//! samples received of it is known too. Both are the kernel's. The rest went
//! where the kernel has no samples, and is followed there by rays, which share
//! nothing with the kernel's form factors: out of an open scene, to backs, to
//! fronts that reflect nothing. What is then still missing is the solution's
//! error (and the rays', about 0.1 % of the power).

use crate::plan::Plan;
use crate::scene::camera::Caster;
use crate::scene::frame::Frame;
use crate::scene::{Quantity, Scene};
use crate::solve::Solution;
use glam::DVec2;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// Powers in W (lm), means of the channels where there is colour.
///
/// `emitted` + ρ `received` = `shot` + `unshot`, and
/// `shot` = `received` + `elsewhere` + `on_backs` + `leaving` + `missing`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Balance {
    /// W or lm.
    pub unit: &'static str,
    /// What luminaires emit, Σ π L A.
    pub emitted: f64,
    /// What luminaires and reflecting surfaces have sent.
    pub shot: f64,
    /// What has arrived on reflecting surfaces and is not sent.
    pub unshot: f64,
    /// What reflecting surfaces have received, as their samples tell.
    pub received: f64,
    /// What they have not reflected, Σ (1 - ρ) E A.
    pub absorbed: f64,
    /// What fronts that reflect nothing have received.
    pub elsewhere: f64,
    /// What backs have absorbed.
    pub on_backs: f64,
    /// What has left the scene.
    pub leaving: f64,
    /// What of the power shot is not accounted for; below 0 where more has been
    /// received than was sent.
    pub missing: f64,
}

/// Rays in all, shared out among the emitters by power.
const RAYS: f64 = 262_144.0;

/// Places tried for one that lies in an emitter, on the mean.
const TRIES: usize = 64;

/// How far apart in the sequence of places two emitters begin.
const APART: usize = 4099;

/// Sums up a solution. Costs about 262 144 rays: a second in a scene of 500
/// surfaces, a tenth in one of 30.
///
/// Rays leave an emitter evenly: how its radiosity varies over it is left out.
pub fn balance(scene: &Scene, plan: &Plan, solution: &Solution<'_>) -> Balance {
    let emitters = emitters(scene, plan, solution);
    let shot: f64 = emitters.iter().map(|emitter| emitter.power).sum();
    let emitted: f64 = (scene.surfaces.iter())
        .map(|surface| PI * super::mean(surface.radiance) * surface.area)
        .sum();
    let [received, absorbed] = received(scene, plan, solution);
    let caster = Caster::new(scene);
    let follow = |(index, emitter)| follow(scene, &caster, emitter, shot, index);
    let fates: Vec<[f64; 3]> = emitters.par_iter().enumerate().map(follow).collect();
    let [elsewhere, on_backs, leaving] =
        [0, 1, 2].map(|fate| fates.iter().map(|fates| fates[fate]).sum::<f64>());
    Balance {
        unit: match scene.quantity {
            Quantity::Radiometric => "W",
            Quantity::Photometric => "lm",
        },
        emitted,
        shot,
        unshot: f64::from(solution.solved.unshot) * emitted,
        received,
        absorbed,
        elsewhere,
        on_backs,
        leaving,
        missing: shot - received - elsewhere - on_backs - leaving,
    }
}

/// Something that has shot.
struct Emitter<'a> {
    frame: &'a Frame,
    /// Closed loops on the surface: a place in an odd number of them belongs to
    /// the emitter.
    loops: Vec<Vec<[f64; 2]>>,
    power: f64,
}

/// The emitters in the order of the tables: luminaires, then surface by surface.
fn emitters<'a>(scene: &Scene, plan: &'a Plan, solution: &Solution<'_>) -> Vec<Emitter<'a>> {
    let luminaires = scene.surfaces.iter().zip(&plan.surfaces);
    let luminaires = luminaires.filter(|(surface, _)| surface.emits());
    let luminaires = luminaires.map(|(surface, planned)| {
        let outline = planned.frame.vertices.iter().map(|&(u, v)| [u, v]);
        (planned, vec![outline.collect()], surface.area)
    });
    let others = plan.surfaces.iter().flat_map(|planned| {
        let areas = planned.areas();
        let shapes = planned.outlines().into_iter().zip(areas);
        shapes.map(move |(loops, area)| (planned, loops, area))
    });
    let all = luminaires.chain(others).enumerate();
    all.map(|(index, (planned, loops, area))| {
        let radiosity = solution.radiosity(index).map(f64::from);
        Emitter {
            frame: &planned.frame,
            loops,
            power: super::mean(radiosity) * area,
        }
    })
    .collect()
}

/// What the reflecting surfaces have received, and what of it they keep.
fn received(scene: &Scene, plan: &Plan, solution: &Solution<'_>) -> [f64; 2] {
    let samples: Vec<[f64; 3]> = solution
        .irradiance()
        .into_iter()
        .map(|value| value.map(f64::from))
        .collect();
    let mut sums = [0.0; 2];
    let mut first = 0;
    for (surface, planned) in scene.surfaces.iter().zip(&plan.surfaces) {
        for (shares, area) in planned.shares().iter().zip(planned.areas()) {
            for &(sample, share) in shares {
                let power = samples[first + sample].map(|value| share * area * value);
                let kept = std::array::from_fn(|k| (1.0 - surface.reflectance[k]) * power[k]);
                sums[0] += super::mean(power);
                sums[1] += super::mean(kept);
            }
        }
        first += planned.samples.len();
    }
    sums
}

/// What of an emitter's power goes to fronts without samples, to backs, and out.
fn follow(
    scene: &Scene,
    caster: &Caster<'_>,
    emitter: &Emitter<'_>,
    shot: f64,
    index: usize,
) -> [f64; 3] {
    // Emitters of few rays must not all send the same ones.
    let first = index * APART;
    let rays = (RAYS * emitter.power / shot).ceil();
    let mut counts = [0.0; 3];
    if rays.is_nan() || rays <= 0.0 {
        return counts;
    }
    let rays = rays as usize;
    let corners = || emitter.loops.iter().flatten().copied().map(DVec2::from);
    let low = corners().fold(DVec2::INFINITY, DVec2::min);
    let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max);
    let mut cast = 0.0;
    for x in (first..first + TRIES * rays).map(spread) {
        let place = low + (high - low) * DVec2::new(x[0], x[1]);
        if !encloses(&emitter.loops, place) {
            continue;
        }
        // Lambert's law: even over the disc beneath the hemisphere (Malley).
        let (sin, cos) = (TAU * x[2]).sin_cos();
        let frame = emitter.frame;
        let aside = (frame.u * cos + frame.v * sin) * x[3].sqrt();
        let direction = aside + frame.normal * (1.0 - x[3]).sqrt();
        match caster.nearest(frame.to_world(place.x, place.y), direction) {
            Some(hit) if !hit.front => counts[1] += 1.0,
            Some(hit) if !scene.surfaces[hit.surface].reflects() => counts[0] += 1.0,
            Some(_) => {}
            None => counts[2] += 1.0,
        }
        cast += 1.0;
        if cast >= rays as f64 {
            break;
        }
    }
    let each = if cast > 0.0 {
        emitter.power / cast
    } else {
        0.0
    };
    counts.map(|count| count * each)
}

/// The `index`-th of places spread evenly in [0, 1)⁴: Roberts' sequence, whose
/// steps are powers of the inverse of the root of x⁵ = x + 1.
fn spread(index: usize) -> [f64; 4] {
    const STEP: f64 = 1.0 / 1.167_303_978_261_418_7;
    let step = |power: i32| (0.5 + STEP.powi(power) * (index as f64 + 1.0)).fract();
    [step(1), step(2), step(3), step(4)]
}

fn encloses(loops: &[Vec<[f64; 2]>], place: DVec2) -> bool {
    let mut inside = false;
    for outline in loops {
        for (k, &to) in outline.iter().enumerate() {
            let from = outline[(k + outline.len() - 1) % outline.len()];
            let [a, b] = [from, to].map(|corner| DVec2::from(corner) - place);
            if (a.y > 0.0) != (b.y > 0.0) {
                let (low, high) = if a.y > 0.0 { (b, a) } else { (a, b) };
                inside ^= low.perp_dot(high) > 0.0;
            }
        }
    }
    inside
}
