//! What a solve does, counted: the operations that its instructions come from.
//!
//! The kernel is solved once more, with types around its rungs that count what they
//! pass on. Nothing is measured here; [`crate::device::model`] says what an operation
//! costs on a core.

mod contours;
mod integers;
mod number;
mod operation;
mod seen;

pub(crate) use integers::tally as tally_in_integers;
pub use operation::Operation;

use super::looking::Looking;
use super::rung::with_rung;
use super::{EMITTERS, HostRoot, Rung, SAMPLES, Sight};
use crate::bake::Tables;
use contours::Counted;
use isolux::Error;
use isolux::form_factor::{Arithmetic, Best, Libm, Micromath, Poly3, Poly5, Poly8};
use isolux::geometry::{Receiver, Vector};
use isolux::luminance::{Constant, Increment, Linear, Luminance, Rgb};
use isolux::number::Root;
use isolux::scene::{Method, Scene};
use isolux::shoot::{Light, Stop};
use isolux::transfer::{Codes, Matrix, Pair, Transfer, Vectors};
use isolux::visibility::records::{Blocker, Occluders, Target};
use isolux::visibility::{Bracket, Capacities, Looked, Sum, Visibility};
use seen::{Workspace, is_near, rule};
use std::cell::Cell;

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
        let (counting, is_linear) = (&mut self.counting, self.is_linear);
        match self.looking {
            Looking::None => {}
            Looking::Rays => seen::rays(receiver, target, occluders, &blockers),
            Looking::Exact(_) => {
                seen::look(counting, receiver, target, occluders, &blockers, is_linear);
            }
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

/// How what a sample receives is had.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Way {
    #[default]
    Computed,
    Coded,
    Terms,
    Responses,
}

impl Way {
    fn of(scene: &Scene<'_>) -> Self {
        let counts = scene.counts();
        match () {
            // Terms come with fractions, as codes do.
            () if counts.terms > 0 => Self::Terms,
            () if counts.responses > 0 => Self::Responses,
            () if counts.is_coded() => Self::Coded,
            () => Self::Computed,
        }
    }
}

/// Any rung of transfer, counted; one sample after the other.
#[derive(Clone, Debug, Default)]
struct Transferred {
    looking: Observed,
    way: Way,
    /// Who shot last.
    last: Cell<Option<usize>>,
    /// How often those that reflect began to shoot in turn.
    rounds: Cell<usize>,
}

impl Transfer for Transferred {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        match (Way::of(scene), scene.counts().bits) {
            (Way::Computed, _) => <Looking as Transfer>::fits(scene),
            (Way::Coded, _) => Codes::fits(scene),
            (Way::Terms, 4) => Matrix::<4>::fits(scene),
            (Way::Terms, 6) => Matrix::<6>::fits(scene),
            (Way::Terms, _) => Matrix::<8>::fits(scene),
            (Way::Responses, _) => Vectors::fits(scene),
        }
    }

    fn sweeps(scene: &Scene<'_>) -> bool {
        Way::of(scene) == Way::Terms
    }

    fn is_in_the_end(scene: &Scene<'_>) -> bool {
        Way::of(scene) == Way::Responses
    }

    fn add<L: Luminance>(
        &self,
        scene: &Scene<'_>,
        emitter: usize,
        first: u32,
        radiosity: L,
        values: &mut [L::Colour],
    ) -> bool {
        if self.way != Way::Terms {
            return false;
        }
        self.shoots(scene, emitter);
        let bits = scene.counts().bits;
        // What there is a term for receives something of anything.
        let mut received = vec![0.0; values.len()];
        scene.add_terms(bits, emitter, first, Constant(1.0), &mut received);
        count(Operation::Sent, 1);
        count(Operation::Entry, values.len());
        count(
            Operation::Term,
            received.iter().filter(|&&value| value > 0.0).count(),
        );
        match bits {
            4 => Matrix::<4>.add(scene, emitter, first, radiosity, values),
            6 => Matrix::<6>.add(scene, emitter, first, radiosity, values),
            _ => Matrix::<8>.add(scene, emitter, first, radiosity, values),
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
        self.shoots(scene, pair.emitter);
        let reflects = !scene.is_luminaire(pair.emitter);
        match self.way {
            Way::Computed => {
                self.looking.is_linear = L::COEFFICIENTS > 1;
                self.looking.reflects = reflects;
                self.compute(scene, receiver, pair);
                let looking = &mut self.looking;
                Transfer::received::<A, L>(looking, scene, receiver, pair, radiosity)
            }
            Way::Coded => {
                if reflects {
                    decode(scene, receiver, pair);
                }
                Codes.received::<A, L>(scene, receiver, pair, radiosity)
            }
            // What luminaires send, whatever the bits of others' terms.
            Way::Terms => Matrix::<8>.received::<A, L>(scene, receiver, pair, radiosity),
            Way::Responses => Vectors.received::<A, L>(scene, receiver, pair, radiosity),
        }
    }
}

/// Counts what a code asks for.
fn decode(scene: &Scene<'_>, receiver: &Receiver<f32>, pair: Pair) {
    let method = scene.code(pair.emitter, pair.receiver).meaning().0;
    if method == Method::Skip {
        return;
    }
    let Some(near) = facing(scene, receiver, pair.emitter) else {
        return;
    };
    match method {
        Method::Point => count(Operation::PointCode, 1),
        _ => {
            count(Operation::Code, 1);
            rules(scene, pair.emitter, near);
        }
    }
}

impl Transferred {
    /// Counts what an emitter that is about to shoot takes by itself.
    fn shoots(&self, scene: &Scene<'_>, emitter: usize) {
        let last = self.last.replace(Some(emitter));
        if last == Some(emitter) {
            return;
        }
        begins(scene, emitter);
        let reflected = last.filter(|&last| !scene.is_luminaire(last));
        if !scene.is_luminaire(emitter) && reflected.is_none_or(|last| emitter < last) {
            self.rounds.set(self.rounds.get() + 1);
        }
    }

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

/// What direct light and a whole solve take on a rung, counted.
///
/// # Errors
/// Those of [`Scene::load`] and [`Light::new`].
pub fn tally(tables: &Tables, rung: Rung, sight: Sight, stop: Stop) -> Result<[Tally; 2], Error> {
    let scene = Scene::load(tables.bytes())?;
    let counts = scene.counts();
    let sight = match counts.occluders {
        0 => Sight::None,
        _ => sight,
    };
    with_rung!(rung, Kernel => match (counts.channels, counts.coefficients, counts.weights) {
        (1, 1, 0) => of::<Kernel, Constant<f32>>(scene, sight, stop),
        (1, 1, _) => of::<Kernel, Increment<f32>>(scene, sight, stop),
        (1, ..) => of::<Kernel, Linear<f32>>(scene, sight, stop),
        (_, 1, 0) => of::<Kernel, Constant<Rgb>>(scene, sight, stop),
        (_, 1, _) => of::<Kernel, Increment<Rgb>>(scene, sight, stop),
        _ => of::<Kernel, Linear<Rgb>>(scene, sight, stop),
    })
}

fn of<A: contours::Known, L: Luminance>(
    scene: Scene<'_>,
    sight: Sight,
    stop: Stop,
) -> Result<[Tally; 2], Error> {
    let transferred = Transferred {
        looking: Observed {
            looking: Looking::with(sight),
            ..Observed::default()
        },
        way: Way::of(&scene),
        ..Transferred::default()
    };
    let light = Light::<Counted<A>, SAMPLES, EMITTERS, L, _>::with_sight(scene, transferred)?;
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
    light.sight().rounds.set(0);
    let shots = light.solve(stop).shots as usize;
    count(Operation::Solve, 1);
    count(Operation::Shot, shots);
    let rounds = light.sight().rounds.get();
    let by_turns = Transferred::sweeps(&scene);
    // All are asked before every shot, or before every round, and once more for what is
    // left in the end.
    let later = match by_turns {
        true => rounds,
        false => shots.saturating_sub(first),
    };
    let looks = match stop {
        Stop::Reflections(_) => 0,
        Stop::Shots(_) => later,
        Stop::Below { shots: most, .. } => later + usize::from(shots < most as usize),
    } + 1;
    settle(match stop {
        Stop::Reflections(times) => 1 + times as usize,
        _ if by_turns => 1 + rounds,
        _ => 1,
    });
    count(Operation::Unshot, looks * emitters);
    count(Operation::Member, looks * members);
    Ok([direct, COUNTED.get()])
}
