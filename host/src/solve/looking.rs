//! How the host looks: any rung of visibility and of transfer, from many samples at
//! once.

use super::Sight;
use isolux::Error;
use isolux::form_factor::Arithmetic;
use isolux::geometry::Receiver;
use isolux::luminance::Luminance;
use isolux::number::Root;
use isolux::scene::Scene;
use isolux::transfer::{Codes, Pair, Transfer};
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

/// Any rung of transfer: codes where the tables have them, else what a look
/// finds. Samples are spread over the cores as [`Looking`] does.
#[derive(Clone, Debug, Default)]
pub(super) struct Sending {
    pub(super) sight: Looking,
    pub(super) coded: bool,
}

impl Transfer for Sending {
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
        match self.coded {
            true => Codes.received::<A, L>(scene, receiver, pair, radiosity),
            false => Transfer::received::<A, L>(&mut self.sight, scene, receiver, pair, radiosity),
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
