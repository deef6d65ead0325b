//! Direct light at a place through the kernel's visibility, with the host's root.

use super::lit;
use isolux::form_factor::{Best, Outline, of_loops};
use isolux::geometry::{Plane, Receiver};
use isolux::visibility::Visibility;
use isolux_host::occlusion::{Emitter, Occlusion};
use isolux_host::solve::HostRoot;
use std::iter::once;

/// An emitter as a firmware has it: its vertices in space beside its frame.
pub(crate) struct Placed<'l> {
    emitter: &'l Emitter,
    plane: Plane<f32>,
    vertices: Vec<[f32; 3]>,
}

/// Places an emitter.
pub(crate) fn placed(emitter: &Emitter) -> Placed<'_> {
    let vertices = lit::vertices::<f32>(emitter);
    Placed {
        emitter,
        plane: Plane::of_polygon(&vertices),
        vertices,
    }
}

/// The form factors of all emitters at a receiver, visible parts alone; the
/// lower bound where visibility had to stop early.
pub(crate) fn direct(
    visibility: &mut impl Visibility<f32>,
    receiver: &Receiver<f32>,
    occlusion: &Occlusion,
    emitters: &[Placed<'_>],
) -> f32 {
    let occluders = occlusion.records();
    let mut sum = 0.0;
    for placed in emitters {
        let outline = Outline::new(&placed.vertices);
        let whole = || of_loops::<Best<HostRoot>, f32>(receiver, &placed.plane, once(outline));
        let seen = visibility.form_factor::<HostRoot>(
            receiver,
            &placed.emitter.target(),
            &occluders,
            placed.emitter.blockers().iter().copied(),
            whole,
        );
        sum += seen.low;
    }
    sum
}
