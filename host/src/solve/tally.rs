//! What a solve does, counted: the operations that its instructions come from.
//!
//! The kernel is solved once more, with types around its rungs that count what they
//! pass on. Nothing is measured here; [`crate::device::model`] says what an operation
//! costs on a core.

mod integers;
mod number;
mod operation;
mod seen;

pub(crate) use integers::tally as tally_in_integers;
pub use operation::Operation;

use super::looking::Looking;
use super::{EMITTERS, HostRoot, SAMPLES, Sight};
use crate::bake::Tables;
use isolux::Error;
use isolux::form_factor::{Arithmetic, Best, Outline};
use isolux::geometry::{Receiver, Vector};
use isolux::luminance::{Constant, Increment, Linear, Luminance, Rgb};
use isolux::number::Root;
use isolux::scene::{Method, Scene};
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Codes, Pair, Transfer};
use isolux::visibility::records::{Blocker, Occluders, Target};
use isolux::visibility::{Bracket, Capacities, Looked, Sum, Visibility};
use number::{CountedRoot, Kind, Number32, done};
use seen::{Workspace, arithmetic, is_near, rule};
use std::cell::Cell;
use std::marker::PhantomData;

/// How often every operation was done.
pub type Tally = [u64; Operation::ALL.len()];

thread_local! {
    /// The kernel's rungs are types without state: what they count is here.
    static COUNTED: Cell<Tally> = const { Cell::new([0; Operation::ALL.len()]) };
}

fn count(operation: Operation, times: usize) {
    COUNTED.with(|counted| {
        let mut tally = counted.get();
        tally[operation as usize] += times as u64;
        counted.set(tally);
    });
}

/// The rung `best`, counted.
struct Counted<A>(PhantomData<A>);

impl<A: Arithmetic<f32>> Arithmetic<f32> for Counted<A> {
    type Root = A::Root;

    fn contour(receiver: &Receiver<f32>, facing: Vector<f32>, outline: &Outline<'_, f32>) -> f32 {
        contour(receiver, facing, outline);
        A::contour(receiver, facing, outline)
    }
}

/// Counts what a loop takes.
fn contour(from: &Receiver<f32>, facing: Vector<f32>, outline: &Outline<'_, f32>) {
    let relative = |&vertex: &[f32; 3]| Vector::from(vertex) - from.position();
    let vertices = outline.vertices();
    // As the rung decides: seen within 22.5° of the first vertex.
    let small = vertices
        .first()
        .is_some_and(|first| outline.reach_squared() <= 0.1464 * relative(first).norm_squared());
    let above = { vertices.iter() }
        .filter(|vertex| from.normal().dot(relative(vertex)) >= 0.0)
        .count();
    let whole = above == vertices.len();
    if small && whole {
        count(Operation::SmallLoop, 1);
        count(Operation::SmallCorner, vertices.len());
        return;
    }
    let Some(receiver) = number::receiver(from) else {
        return;
    };
    let counted: Vec<[Number32; 3]> = vertices.iter().map(|v| v.map(Number32)).collect();
    let counted = Outline::new(&counted);
    done();
    Best::<CountedRoot>::contour(&receiver, number::vector(facing), &counted);
    if small {
        let quotients = done()[Kind::Quotient as usize] as usize;
        count(Operation::SmallCut, 1);
        count(Operation::SmallCutQuotient, quotients);
    } else if whole {
        let roots = done()[Kind::Root as usize] as usize;
        count(Operation::Loop, 1);
        count(Operation::Corner, vertices.len());
        count(Operation::Obtuse, roots.saturating_sub(vertices.len()));
    } else {
        count(Operation::CutLoop, 1);
        arithmetic([
            (Kind::Sum, Operation::CutSum),
            (Kind::Product, Operation::CutProduct),
            (Kind::Quotient, Operation::CutQuotient),
            (Kind::Comparison, Operation::CutComparison),
            (Kind::Root, Operation::CutRoot),
        ]);
    }
}

/// Any rung of visibility, counted.
#[derive(Clone, Debug, Default)]
struct Observed {
    looking: Looking,
    counting: Box<Workspace>,
    /// Whether the radiosity is linear, and whether the emitter only reflects.
    is_linear: bool,
    reflects: bool,
}

impl Visibility for Observed {
    const CAPACITIES: Capacities = Looking::CAPACITIES;

    fn form_factor<R: Root<f32> + Copy>(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> f32,
    ) -> Bracket<f32> {
        let looking = &mut self.looking;
        looking.form_factor::<R>(receiver, target, occluders, blockers, unoccluded)
    }

    fn look(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        parts: &mut impl Sum<f32>,
    ) -> Looked<f32> {
        let blockers: Vec<Blocker> = blockers.collect();
        if matches!(self.looking, Looking::Exact(_)) {
            let counting = &mut self.counting;
            let is_linear = self.is_linear;
            seen::look(counting, receiver, target, occluders, &blockers, is_linear);
        }
        let blockers = blockers.iter().copied();
        let looked = { &mut self.looking }.look(receiver, target, occluders, blockers, parts);
        let is_known = matches!(looked, Looked::Dark | Looked::Parts | Looked::AtMost);
        if self.is_linear && self.reflects && !is_known {
            let near = is_near(receiver, target.origin, target.radius);
            rule(target.corners, 1.0, near);
        }
        looked
    }
}

/// Any rung of transfer, counted; one sample after the other.
#[derive(Clone, Debug, Default)]
struct Transferred {
    looking: Observed,
    coded: bool,
    /// Who shot last.
    last: Option<usize>,
}

impl Transfer for Transferred {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        match scene.counts().is_coded() {
            false => <Looking as Transfer>::fits(scene),
            true => Codes::fits(scene),
        }
    }

    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        count(Operation::Pair, 1);
        let reflects = !scene.is_luminaire(pair.emitter);
        if self.last != Some(pair.emitter) {
            self.last = Some(pair.emitter);
            begins(scene, pair.emitter);
        }
        if !self.coded {
            self.looking.is_linear = L::COEFFICIENTS > 1;
            self.looking.reflects = reflects;
            self.compute(scene, receiver, pair);
            let looking = &mut self.looking;
            return Transfer::received::<A, L>(looking, scene, receiver, pair, radiosity);
        }
        if reflects {
            let method = scene.code(pair.emitter, pair.receiver).meaning().0;
            if method != Method::Skip
                && let Some(near) = facing(scene, receiver, pair.emitter)
            {
                match method {
                    Method::Point => count(Operation::PointCode, 1),
                    _ => {
                        count(Operation::Code, 1);
                        rules(scene, pair.emitter, near);
                    }
                }
            }
        }
        Codes.received::<A, L>(scene, receiver, pair, radiosity)
    }
}

impl Transferred {
    /// Counts what a pair takes besides looks and loops.
    fn compute(&self, scene: &Scene<'_>, receiver: &Receiver<f32>, pair: Pair) {
        let (shape, emitter) = (
            scene.shapes().get(pair.emitter),
            &scene.emitters()[pair.emitter],
        );
        let is_seeing = !matches!(self.looking.looking, Looking::None);
        let is_occluded =
            is_seeing && !pair.unshadowed && shape.is_some_and(|shape| shape.blockers > 0);
        let is_point = emitter.loops == 0;
        if !self.looking.is_linear && !is_occluded && !is_point {
            return;
        }
        let Some(near) = facing(scene, receiver, pair.emitter) else {
            return;
        };
        if is_point {
            count(Operation::PointPair, 1);
            return;
        }
        count(Operation::Facing, 1);
        if self.looking.is_linear && self.looking.reflects && !is_occluded {
            rules(scene, pair.emitter, near);
        }
    }
}

/// Counts what an emitter that is about to shoot takes by itself.
fn begins(scene: &Scene<'_>, index: usize) {
    let emitter = &scene.emitters()[index];
    count(
        Operation::ShotSurface,
        scene.surfaces().len() + scene.points().len(),
    );
    if emitter.members > 0 {
        count(Operation::Gather, 1);
        count(Operation::GatherMember, emitter.members as usize);
    }
}

/// Whether a receiver is in front of an emitter with a shape, and if so whether it is
/// near.
fn facing(scene: &Scene<'_>, receiver: &Receiver<f32>, index: usize) -> Option<bool> {
    let emitter = scene.emitters().get(index)?;
    let surface = scene.surfaces().get(emitter.surface as usize)?;
    let shape = scene.shapes().get(index)?;
    let normal = Vector::from(surface.normal);
    let height = normal.dot(receiver.position() - Vector::from(surface.origin));
    let center = surface.place(shape.center);
    let origin = [center.x, center.y, center.z];
    (height > 0.0).then(|| is_near(receiver, origin, shape.scale))
}

/// Counts a rule over every loop of an emitter.
fn rules(scene: &Scene<'_>, index: usize, near: bool) {
    if let (Some(emitter), Some(shape)) = (scene.emitters().get(index), scene.shapes().get(index)) {
        for outline in scene.loops_of(emitter) {
            rule(outline.vertices(), shape.scale, near);
        }
    }
}

/// What direct light and a whole solve take on the rung `best`, counted.
///
/// # Errors
/// Those of [`Scene::load`] and [`Light::new`].
pub fn tally(tables: &Tables, sight: Sight, stop: Stop) -> Result<[Tally; 2], Error> {
    let scene = Scene::load(tables.bytes())?;
    let counts = scene.counts();
    let sight = match counts.occluders {
        0 => Sight::None,
        _ => sight,
    };
    match (counts.channels, counts.coefficients, counts.weights) {
        (1, 1, 0) => of::<Constant<f32>>(scene, sight, stop),
        (1, 1, _) => of::<Increment<f32>>(scene, sight, stop),
        (1, ..) => of::<Linear<f32>>(scene, sight, stop),
        (_, 1, 0) => of::<Constant<Rgb>>(scene, sight, stop),
        (_, 1, _) => of::<Increment<Rgb>>(scene, sight, stop),
        _ => of::<Linear<Rgb>>(scene, sight, stop),
    }
}

fn of<L: Luminance>(scene: Scene<'_>, sight: Sight, stop: Stop) -> Result<[Tally; 2], Error> {
    type Counting = Counted<Best<HostRoot>>;
    let transferred = Transferred {
        looking: Observed {
            looking: Looking::with(sight),
            ..Observed::default()
        },
        coded: scene.counts().is_coded(),
        last: None,
    };
    let light = Light::<Counting, SAMPLES, EMITTERS, L, _>::with_sight(scene, transferred)?;
    let mut light = Box::new(light);
    let counts = scene.counts();
    let (emitters, members) = (counts.emitters as usize, counts.members as usize);
    // Every emitter is asked before direct light, and those of a generation before it.
    let settle = |times: usize| {
        count(Operation::Gather, times * emitters);
        count(Operation::GatherMember, times * members);
    };
    COUNTED.set([0; Operation::ALL.len()]);
    let first = light.direct() as usize;
    count(Operation::Shot, first);
    settle(1);
    let direct = COUNTED.get();
    COUNTED.set([0; Operation::ALL.len()]);
    let shots = light.solve(stop).shots as usize;
    count(Operation::Shot, shots);
    // All are asked before every shot, and once more for what is left in the end.
    let later = shots.saturating_sub(first);
    let looks = match stop {
        Stop::Reflections(_) => 0,
        Stop::Shots(_) => later,
        Stop::Below { shots: most, .. } => later + usize::from(shots < most as usize),
    } + 1;
    settle(match stop {
        Stop::Reflections(times) => 1 + times as usize,
        _ => 1,
    });
    count(Operation::Unshot, looks * emitters);
    count(Operation::Member, looks * members);
    Ok([direct, COUNTED.get()])
}
