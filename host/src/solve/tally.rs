//! What a solve does, counted: the operations that its instructions come from.
//!
//! The kernel is solved once more, with types around its rungs that count what they
//! pass on. Nothing is measured here; [`crate::device::model`] says what an operation
//! costs on a core.

mod integers;

pub(crate) use integers::tally as tally_in_integers;

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
use isolux::visibility::{Bracket, Capacities, Looked, Piece, Sum, Visibility};
use std::cell::Cell;
use std::marker::PhantomData;

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// An emitter shoots.
    Shot,
    /// An emitter and a sample.
    Pair,
    /// An emitter asked for all that it has not shot, before direct light.
    Gather,
    /// One of its members.
    GatherMember,
    /// An emitter asked for the power that it has not shot, before every shot after.
    Unshot,
    /// One of its members.
    Member,
    /// A loop summed.
    Loop,
    /// A corner of such a loop.
    Corner,
    /// A loop that the horizon cuts.
    CutLoop,
    /// A small loop: by the form without cancellation.
    SmallLoop,
    /// A corner of such a loop.
    SmallCorner,
    /// A look past occluders.
    Look,
    /// A blocker on the list of a look.
    Listed,
    /// A blocker that may hide something.
    Kept,
    /// A line of such a blocker.
    Line,
    /// A piece that is seen.
    Piece,
    /// A corner of such a piece.
    PieceCorner,
    /// A code that says a point will do.
    PointCode,
    /// A code that asks for moments or contours.
    Code,
    /// An emitter and a surface that have terms.
    Sent,
    /// An emitter and a sample that have a term.
    Entry,
    /// A term that is not 0.
    Term,
}

impl Operation {
    /// All of them.
    pub const ALL: [Self; 22] = [
        Self::Shot,
        Self::Pair,
        Self::Gather,
        Self::GatherMember,
        Self::Unshot,
        Self::Member,
        Self::Loop,
        Self::Corner,
        Self::CutLoop,
        Self::SmallLoop,
        Self::SmallCorner,
        Self::Look,
        Self::Listed,
        Self::Kept,
        Self::Line,
        Self::Piece,
        Self::PieceCorner,
        Self::PointCode,
        Self::Code,
        Self::Sent,
        Self::Entry,
        Self::Term,
    ];

    /// What it is called in committed costs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shot => "shot",
            Self::Pair => "pair",
            Self::Gather => "gather",
            Self::GatherMember => "gather-member",
            Self::Unshot => "unshot",
            Self::Member => "member",
            Self::Loop => "loop",
            Self::Corner => "corner",
            Self::CutLoop => "cut-loop",
            Self::SmallLoop => "small-loop",
            Self::SmallCorner => "small-corner",
            Self::Look => "look",
            Self::Listed => "listed",
            Self::Kept => "kept",
            Self::Line => "line",
            Self::Piece => "piece",
            Self::PieceCorner => "piece-corner",
            Self::PointCode => "point-code",
            Self::Code => "code",
            Self::Sent => "sent",
            Self::Entry => "entry",
            Self::Term => "term",
        }
    }
}

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
        let from = |&vertex: &[f32; 3]| Vector::from(vertex) - receiver.position();
        let vertices = outline.vertices();
        // As the rung decides: seen within 22.5° of the first vertex.
        let small = vertices
            .first()
            .is_some_and(|first| outline.reach_squared() <= 0.1464 * from(first).norm_squared());
        let above = { vertices.iter() }
            .filter(|vertex| receiver.normal().dot(from(vertex)) > 0.0)
            .count();
        let [whole, corner] = match small {
            true => [Operation::SmallLoop, Operation::SmallCorner],
            false => [Operation::Loop, Operation::Corner],
        };
        count(whole, 1);
        count(corner, vertices.len());
        if above > 0 && above < vertices.len() {
            count(Operation::CutLoop, 1);
        }
        A::contour(receiver, facing, outline)
    }
}

/// Any rung of visibility, counted.
#[derive(Clone, Debug, Default)]
struct Observed(Looking);

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
        let looking = &mut self.0;
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
        count(Operation::Look, 1);
        let blockers = blockers.inspect(|_| count(Operation::Listed, 1));
        let mut told = Told(parts);
        let looked = self
            .0
            .look(receiver, target, occluders, blockers, &mut told);
        if let (Looking::Exact(exact), false) = (&self.0, looked == Looked::Dark) {
            let (blockers, lines) = exact.kept();
            count(Operation::Kept, blockers);
            count(Operation::Line, lines);
        }
        looked
    }
}

/// A sum over pieces, counted.
struct Told<'a, S>(&'a mut S);

fn piece(piece: &Piece<'_, f32>) {
    count(Operation::Piece, 1);
    count(Operation::PieceCorner, piece.corners().len());
}

impl<S: Sum<f32>> Sum<f32> for Told<'_, S> {
    fn visible(&mut self, seen: &Piece<'_, f32>) {
        piece(seen);
        self.0.visible(seen);
    }

    fn unresolved(&mut self, unknown: &Piece<'_, f32>) {
        piece(unknown);
        self.0.unresolved(unknown);
    }

    fn difference(&mut self, whole: &Piece<'_, f32>, hidden: &Piece<'_, f32>) -> bool {
        piece(whole);
        piece(hidden);
        self.0.difference(whole, hidden)
    }
}

/// Any rung of transfer, counted; one sample after the other.
#[derive(Clone, Debug, Default)]
struct Transferred {
    looking: Observed,
    coded: bool,
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
        if !self.coded {
            let looking = &mut self.looking;
            return Transfer::received::<A, L>(looking, scene, receiver, pair, radiosity);
        }
        if !scene.is_luminaire(pair.emitter) {
            match scene.code(pair.emitter, pair.receiver).meaning().0 {
                Method::Skip => {}
                Method::Point => count(Operation::PointCode, 1),
                _ => count(Operation::Code, 1),
            }
        }
        Codes.received::<A, L>(scene, receiver, pair, radiosity)
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
        looking: Observed(Looking::with(sight)),
        coded: scene.counts().is_coded(),
    };
    let light = Light::<Counting, SAMPLES, EMITTERS, L, _>::with_sight(scene, transferred)?;
    let mut light = Box::new(light);
    let counts = scene.counts();
    let (emitters, members) = (counts.emitters as usize, counts.members as usize);
    COUNTED.set([0; Operation::ALL.len()]);
    let first = light.direct() as usize;
    count(Operation::Shot, first);
    count(Operation::Gather, emitters);
    count(Operation::GatherMember, members);
    let direct = COUNTED.get();
    COUNTED.set([0; Operation::ALL.len()]);
    let shots = light.solve(stop).shots as usize;
    count(Operation::Shot, shots);
    count(Operation::Gather, emitters);
    count(Operation::GatherMember, members);
    // All are asked before every generation, or before every shot; and once more for
    // what is left in the end.
    let looks = match stop {
        Stop::Reflections(times) => {
            count(Operation::Gather, times as usize * emitters);
            count(Operation::GatherMember, times as usize * members);
            1
        }
        _ => shots.saturating_sub(first) + 1,
    };
    count(Operation::Unshot, looks * emitters);
    count(Operation::Member, looks * members);
    let all = COUNTED.get();
    Ok([direct, all])
}
