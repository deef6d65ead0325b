//! How the host looks: any rung of visibility and of transfer, from many samples at
//! once.

use super::Sight;
use isolux::Error;
use isolux::form_factor::Arithmetic;
use isolux::geometry::Receiver;
use isolux::luminance::Luminance;
use isolux::number::Root;
use isolux::scene::Scene;
use isolux::transfer::{Codes, Matrix, Pair, Transfer, Vectors};
use isolux::visibility::records::{Blocker, Occluders, Target};
use isolux::visibility::{Bracket, Capacities, Exact, Looked, Sum, VertexRays, Visibility};
use rayon::prelude::*;

/// The host's workspace: room for some sixty occluders between one place and
/// one emitter.
type Workspace = Exact<32, 64, 256, 64>;

/// Any rung of visibility, looking from many samples at once. Every sample is
/// looked at by one core and no sum is divided: the bits are those of one after
/// the other. One type for all rungs keeps the program small: what a scene
/// requires is the device's concern.
#[derive(Clone, Debug, Default)]
pub(super) enum Looking {
    Rays,
    #[default]
    None,
    Exact(Box<Workspace>),
}

impl Looking {
    pub(super) fn with(sight: Sight) -> Self {
        match sight {
            Sight::None => Self::None,
            Sight::VertexRays => Self::Rays,
            Sight::Exact => Self::Exact(Box::default()),
        }
    }
}

impl Visibility for Looking {
    const CAPACITIES: Capacities = Workspace::CAPACITIES;

    fn form_factor<R: Root<f32> + Copy>(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> f32,
    ) -> Bracket<f32> {
        match self {
            Self::None => Bracket::exactly(unoccluded()),
            Self::Rays => {
                VertexRays.form_factor::<R>(receiver, target, occluders, blockers, unoccluded)
            }
            Self::Exact(exact) => Visibility::form_factor::<R>(
                exact.as_mut(),
                receiver,
                target,
                occluders,
                blockers,
                unoccluded,
            ),
        }
    }

    fn look(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        parts: &mut impl Sum<f32>,
    ) -> Looked<f32> {
        match self {
            Self::None => Looked::Whole,
            Self::Rays => VertexRays.look(receiver, target, occluders, blockers, parts),
            Self::Exact(exact) => exact.look(receiver, target, occluders, blockers, parts),
        }
    }
}

/// Any rung of transfer: what the tables have, else what a look finds. Samples are
/// spread over the cores as [`Looking`] does.
#[derive(Clone, Debug)]
pub(super) enum Sending {
    Exact(Looking),
    Codes,
    /// By the bits of a factor.
    Matrix(u32),
    Vectors,
}

impl Sending {
    /// What these tables are read with.
    pub(super) fn of(scene: &Scene<'_>, sight: Sight) -> Self {
        let counts = scene.counts();
        match () {
            () if counts.responses > 0 => Self::Vectors,
            () if counts.terms > 0 => Self::Matrix(counts.bits),
            () if counts.is_coded() => Self::Codes,
            () => Self::Exact(Looking::with(sight)),
        }
    }
}

impl Transfer for Sending {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        match Self::of(scene, Sight::None) {
            Self::Exact(_) => <Looking as Transfer>::fits(scene),
            Self::Codes => Codes::fits(scene),
            Self::Matrix(4) => Matrix::<4>::fits(scene),
            Self::Matrix(6) => Matrix::<6>::fits(scene),
            Self::Matrix(_) => Matrix::<8>::fits(scene),
            Self::Vectors => Vectors::fits(scene),
        }
    }

    fn sweeps(scene: &Scene<'_>) -> bool {
        matches!(Self::of(scene, Sight::None), Self::Matrix(_))
    }

    fn is_in_the_end(scene: &Scene<'_>) -> bool {
        matches!(Self::of(scene, Sight::None), Self::Vectors)
    }

    fn add<L: Luminance>(
        &self,
        scene: &Scene<'_>,
        emitter: usize,
        first: u32,
        radiosity: L,
        values: &mut [L::Colour],
    ) -> bool {
        match self {
            Self::Matrix(bits) => scene.add_terms(*bits, emitter, first, radiosity, values),
            _ => return false,
        }
        true
    }

    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        match self {
            Self::Exact(sight) => {
                Transfer::received::<A, L>(sight, scene, receiver, pair, radiosity)
            }
            Self::Codes => Codes.received::<A, L>(scene, receiver, pair, radiosity),
            Self::Matrix(4) => Matrix::<4>.received::<A, L>(scene, receiver, pair, radiosity),
            Self::Matrix(6) => Matrix::<6>.received::<A, L>(scene, receiver, pair, radiosity),
            Self::Matrix(_) => Matrix::<8>.received::<A, L>(scene, receiver, pair, radiosity),
            Self::Vectors => Vectors.received::<A, L>(scene, receiver, pair, radiosity),
        }
    }

    fn each<C: Send>(&mut self, values: &mut [C], value: impl Fn(&mut Self, usize, &mut C) + Sync) {
        spread(self, values, value);
    }
}

/// Sets every value, on all cores where there are enough of them.
fn spread<W: Clone + Send + Sync, C: Send>(
    workspace: &mut W,
    values: &mut [C],
    value: impl Fn(&mut W, usize, &mut C) + Sync,
) {
    /// Samples below which handing out work costs more than it saves.
    const FEW: usize = 64;
    if values.len() < FEW {
        for (index, place) in values.iter_mut().enumerate() {
            value(workspace, index, place);
        }
        return;
    }
    values
        .par_iter_mut()
        .enumerate()
        .with_min_len(FEW / 2)
        .for_each_init(
            || workspace.clone(),
            |workspace, (index, place)| value(workspace, index, place),
        );
}
