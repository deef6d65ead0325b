//! How large a workspace visibility needs, found by looking from every sample.

use super::Tables;
use crate::scene::Point;
use crate::solve::HostRoot;
use isolux::form_factor::Best;
use isolux::geometry::Receiver;
use isolux::luminance::Constant;
use isolux::number::Root;
use isolux::scene::Scene;
use isolux::scene::records::Sight;
use isolux::visibility::records::{Blocker, Occluders, Target};
use isolux::visibility::{Bracket, Capacities, Exact, Gathered, Looked, Sum, Visibility};
use rayon::prelude::*;

/// The fewest corners of a piece there is room for.
const VERTICES: u32 = 8;

/// Pieces, lines and blockers of the workspace that surveys.
const PIECES: usize = 64;
const LINES: usize = 256;
const BLOCKERS: usize = 64;

/// The capacities with which visibility is exact from every sample and every
/// named point.
///
/// Pieces wait at most one a blocker kept; corners are tried from few to many,
/// the larger ones only where the smaller did not suffice.
pub(super) fn sight(tables: &Tables, points: &[Point]) -> Sight {
    let Ok(scene) = Scene::load(tables.bytes()) else {
        return Sight::default();
    };
    let of_points = points.iter().filter_map(|point| {
        let single = |v: glam::DVec3| v.as_vec3().to_array();
        let receiver = Receiver::new::<HostRoot>(single(point.position), single(point.normal));
        Some((receiver.ok()?, 0..scene.emitters().len()))
    });
    let luminaires = scene.counts().luminaires as usize;
    let of_samples = scene.surfaces().iter().flat_map(|surface| {
        let (_, places) = scene.samples_of(surface);
        places.iter().enumerate().filter_map(move |(k, &place)| {
            let position = surface.place(place).into();
            let receiver = Receiver::new::<HostRoot>(position, surface.normal).ok()?;
            let all = 0..scene.emitters().len();
            let emitters = match (surface.direct as usize, surface.indirect) {
                (0, 0) => all,
                _ if k < surface.unshadowed as usize => 0..0,
                (direct, _) if k < direct => 0..luminaires,
                _ => luminaires..all.end,
            };
            Some((receiver, emitters))
        })
    });
    let looks: Vec<_> = of_points.chain(of_samples).collect();
    let found = looks
        .par_iter()
        .flat_map_iter(|(receiver, emitters)| {
            emitters
                .clone()
                .map(move |emitter| look(&scene, receiver, emitter))
        })
        .reduce(Sight::default, larger);
    Sight {
        vertices: found.vertices.max(VERTICES),
        ..found
    }
}

fn larger(a: Sight, b: Sight) -> Sight {
    Sight {
        vertices: a.vertices.max(b.vertices),
        pieces: a.pieces.max(b.pieces),
        lines: a.lines.max(b.lines),
        blockers: a.blockers.max(b.blockers),
    }
}

/// What one look needs.
fn look(scene: &Scene<'_>, receiver: &Receiver<f32>, emitter: usize) -> Sight {
    type Look = fn(&Scene<'_>, &Receiver<f32>, usize) -> Surveyed;
    const LOOKS: [(u32, Look); 5] = [
        (8, with::<8>),
        (10, with::<10>),
        (12, with::<12>),
        (16, with::<16>),
        (32, with::<32>),
    ];
    let mut found = Sight::default();
    for (vertices, with) in LOOKS {
        let surveyed = with(scene, receiver, emitter);
        found = Sight {
            vertices,
            ..surveyed.sight
        };
        if surveyed.complete {
            break;
        }
    }
    found
}

/// What one look found.
#[derive(Clone, Copy)]
struct Surveyed {
    sight: Sight,
    /// Whether the workspace sufficed.
    complete: bool,
}

fn with<const VERTICES: usize>(
    scene: &Scene<'_>,
    receiver: &Receiver<f32>,
    emitter: usize,
) -> Surveyed {
    let mut surveyor = Surveyor::<VERTICES> {
        exact: Exact::new(),
        surveyed: Surveyed {
            sight: Sight::default(),
            complete: true,
        },
    };
    let light = Constant(1.0_f32);
    scene.received::<Best<HostRoot>, _, _>(receiver, emitter, light, &mut surveyor);
    surveyor.surveyed
}

/// Looks as [`Exact`] does, and notes what that takes.
struct Surveyor<const VERTICES: usize> {
    exact: Exact<VERTICES, PIECES, LINES, BLOCKERS>,
    surveyed: Surveyed,
}

impl<const VERTICES: usize> Visibility for Surveyor<VERTICES> {
    const CAPACITIES: Capacities =
        <Exact<VERTICES, PIECES, LINES, BLOCKERS> as Visibility>::CAPACITIES;

    fn form_factor<R: Root<f32> + Copy>(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> f32,
    ) -> Bracket<f32> {
        let exact = &mut self.exact;
        Visibility::form_factor::<R>(exact, receiver, target, occluders, blockers, unoccluded)
    }

    fn look(
        &mut self,
        receiver: &Receiver<f32>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        _: &mut impl Sum<f32>,
    ) -> Looked<f32> {
        let gathered = self.exact.gather(receiver, target, occluders, blockers);
        let complete = match gathered {
            Gathered::Dark | Gathered::Whole => true,
            Gathered::Partly => self.exact.fold((), |(), _| {}).is_complete(),
            Gathered::Overflow => false,
        };
        let (blockers, lines) = self.exact.kept();
        let surveyed = &mut self.surveyed;
        surveyed.complete &= complete;
        surveyed.sight.blockers = surveyed.sight.blockers.max(blockers as u32);
        surveyed.sight.pieces = surveyed.sight.pieces.max(blockers as u32);
        surveyed.sight.lines = surveyed.sight.lines.max(lines as u32);
        Looked::Dark
    }
}
