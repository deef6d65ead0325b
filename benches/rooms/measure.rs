//! The figures, in seconds of one thread.

use super::clock::{least, of_all};
use super::directly::{direct as form_factors, placed};
use super::lit::{self, Lit, Small};
use super::random::{self, Random};
use super::{published, room};
use glam::{DMat3, DVec3};
use isolux::geometry::Receiver;
use isolux::shoot::Stop;
use isolux::visibility::{Exact, Unoccluded, Visibility};
use isolux_host::scene::{Surface, shipped};
use isolux_host::solve::{self, Rung, Sight, Solution};
use std::hint::black_box;

/// Runs whose least is a time.
const ROUNDS: usize = 15;

/// Points of a timed run of direct light, at least.
const POINTS: usize = 10_000;

/// Points of a timed run with every emitter shining.
const FEW_POINTS: usize = 1000;

/// Places on the floor of a generated scene.
pub(crate) const PLACES: usize = 256;

/// Room for a thousand occluders between a point and the light.
type Workspace = Exact<32, 512, 4096, 1024>;

/// Direct light at a point.
pub(crate) struct Direct {
    /// The visible form factors of every luminaire alone.
    pub(crate) exact: f64,
    /// The same with nothing in the way.
    pub(crate) none: f64,
    /// The solution of the host at a list of points.
    pub(crate) solution: f64,
}

/// All light.
pub(crate) struct Bounces {
    /// What the plan holds.
    pub(crate) samples: u32,
    pub(crate) emitters: u32,
    /// Seconds of planning, and of baking with the survey of workspaces.
    pub(crate) plan: f64,
    pub(crate) bake: f64,
    /// Seconds of loading and solving.
    pub(crate) solve: f64,
    pub(crate) shots: u32,
    pub(crate) form_factors: u32,
    /// Seconds of a point then.
    pub(crate) point: f64,
}

/// Direct light in a generated scene.
pub(crate) struct Many {
    /// Seconds a point.
    pub(crate) seconds: f64,
    /// Places at which a workspace met its bounds.
    pub(crate) inexact: usize,
}

/// Text of a shipped scene, and the published points of it.
fn sources(name: &str) -> (&'static str, &'static str) {
    let (shipped, file) = match name {
        "penumbra" => (shipped::PENUMBRA, "d_penumbra_h1.5"),
        "office" => (shipped::OFFICE, "e_office"),
        _ => (shipped::CORNELL, "c_cornell_grey"),
    };
    let found = published::FILES.iter().find(|(known, _)| *known == file);
    (shipped, found.expect("a published room").1)
}

/// Places with their normals, as often as it takes to have so many.
fn places(points: &[published::Point], count: usize) -> Vec<([f32; 3], [f32; 3])> {
    let single = |v: DVec3| v.as_vec3().to_array();
    let all = points
        .iter()
        .map(|point| (single(point.place), single(point.normal)));
    all.cycle().take(count).collect()
}

/// Seconds of direct light at one of these places.
fn kernel(visibility: &mut impl Visibility, lit: &Lit, places: &[([f32; 3], [f32; 3])]) -> f64 {
    let emitters: Vec<_> = lit.emitters.iter().map(|(_, e)| placed(e)).collect();
    let receivers: Vec<Receiver<f32>> = places
        .iter()
        .map(|&(place, normal)| Receiver::new::<solve::HostRoot>(place, normal))
        .collect::<Result<_, _>>()
        .expect("receivers");
    let seconds = least(ROUNDS, || {
        for receiver in &receivers {
            let receiver = black_box(receiver);
            black_box(form_factors(
                visibility,
                receiver,
                &lit.occlusion,
                &emitters,
            ));
        }
    });
    seconds / receivers.len() as f64
}

/// Seconds of a solution at one of these places.
fn at(solution: &Solution<'_>, places: &[([f32; 3], [f32; 3])]) -> f64 {
    let seconds = least(ROUNDS, || {
        black_box(solution.at(black_box(places)).expect("receivers"));
    });
    seconds / places.len() as f64
}

/// Direct light at the published points of a room.
pub(crate) fn direct(name: &str) -> Direct {
    let (source, text) = sources(name);
    let (published, points) = published::read(text, |v| v);
    let places = places(&points, POINTS);
    let lit = Lit::new(&published);
    let scene = room::scene(name, source);
    let tables = room::bake(&scene, &room::plan(&scene));
    let solution = solve::solve(&tables, Rung::Best, Sight::Exact, Stop::Reflections(0));
    Direct {
        exact: kernel(&mut Small::<f32>::new(), &lit, &places),
        none: kernel(&mut Unoccluded, &lit, &places),
        solution: at(&solution.expect("a solution"), &places),
    }
}

/// All light in a room, within its budget or without one, and then at its
/// published points.
pub(crate) fn bounces((name, within_budget): (&str, bool)) -> Bounces {
    let (source, text) = sources(name);
    let mut scene = room::scene(name, source);
    if !within_budget {
        scene.budget.samples = None;
    }
    let (planning, plan) = of_all(|| room::plan(&scene));
    let (baking, tables) = of_all(|| room::bake(&scene, &plan));
    let solved = || solve::solve(&tables, Rung::Best, Sight::Exact, Stop::below(0.001));
    let solving = least(5, || {
        black_box(solved().expect("a solution"));
    });
    let solution = solved().expect("a solution");
    let (_, points) = published::read(text, |v| v);
    Bounces {
        samples: tables.counts.samples,
        emitters: tables.counts.emitters,
        plan: planning,
        bake: baking,
        solve: solving,
        shots: solution.solved.shots,
        form_factors: solution.solved.form_factors,
        point: at(&solution, &places(&points, FEW_POINTS)),
    }
}

/// Polygons that come between the light and the places below it.
#[derive(Clone, Copy)]
pub(crate) enum Clutter {
    /// Boxes that stand on a floor, each closed: what rooms are full of.
    Furniture,
    /// Loose triangles and quadrilaterals that float before the light, all of
    /// them in the way of something: the hardest for a method that cuts.
    Leaves,
}

/// A square light 4 m up, and `count` polygons in all with it. The more there
/// are the smaller, so that about as much of the light is hidden.
fn generated(count: usize, clutter: Clutter) -> Lit {
    let mut random = Random(count as u64);
    let corners = [[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]];
    let light = corners.map(|[x, y]| DVec3::new(x, y, 4.0)).to_vec();
    let mut surfaces: Vec<Surface> = vec![lit::surface(light, 1.0)];
    let scale = 1.0 / (count as f64).sqrt();
    while surfaces.len() < count {
        match clutter {
            Clutter::Furniture => surfaces.extend(standing(&mut random, 2.0 * scale)),
            Clutter::Leaves => surfaces.push(random.occluder(0.6 * scale)),
        }
    }
    Lit::new(&lit::scene(surfaces))
}

/// A box on the floor about the places, up to twice as high as wide, turned
/// about its axis.
fn standing(random: &mut Random, size: f64) -> Vec<Surface> {
    let half = [0.5, 0.5, 1.0].map(|most| random.between(0.3, 1.0) * most * size);
    let turn = DMat3::from_rotation_z(random.between(0.0, 6.3));
    let [x, y] = [(); 2].map(|()| random.between(-2.0, 2.0));
    let place = DVec3::new(x, y, half[2]);
    random::faces_of_box(half)
        .into_iter()
        .map(|face| lit::surface(face.iter().map(|&v| turn * v + place).collect(), 0.0))
        .collect()
}

/// Direct light at [`PLACES`] places on the floor of a generated scene.
pub(crate) fn many(count: usize, clutter: Clutter) -> Many {
    let lit = generated(count, clutter);
    let mut random = Random(7);
    let places: Vec<([f32; 3], [f32; 3])> = (0..PLACES)
        .map(|_| [(); 2].map(|()| random.between(-2.0, 2.0) as f32))
        .map(|[x, y]| ([x, y, 0.0], [0.0, 0.0, 1.0]))
        .collect();
    let mut sight = Box::new(Workspace::new());
    let mut is_exact = |place: &([f32; 3], [f32; 3])| {
        let receiver = Receiver::new::<solve::HostRoot>(place.0, place.1).expect("a receiver");
        let mut emitters = lit.emitters.iter();
        emitters.all(|(_, emitter)| {
            lit.form_factor(sight.as_mut(), &receiver, emitter)
                .is_exact()
        })
    };
    Many {
        inexact: places.iter().filter(|place| !is_exact(place)).count(),
        seconds: kernel(sight.as_mut(), &lit, &places),
    }
}
