//! How much of one luminaire is seen, in double precision.

use glam::DVec3;

use super::Error;
use super::convex::Loop;
use super::form_factor::form_factor_signed;
use super::partition;
use super::patch::Receiver;
use super::visible::Occluders;
use crate::scene::Scene;

/// One luminaire of a scene and all that can hide it.
pub struct Lookout {
    occluders: Occluders,
    /// Convex parts of the luminaire.
    parts: Vec<Vec<DVec3>>,
    /// Its unit normal, and a place on its plane.
    plane: [DVec3; 2],
    /// A place no higher than this above the plane is on it.
    tolerance: f64,
}

/// Form factors of one luminaire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Looked {
    /// Of what is seen, 0 ≤ F.
    pub visible: f64,
    /// Of all of it that is above the horizon.
    pub whole: f64,
    /// What is hidden is nothing, up to rounding.
    pub is_whole: bool,
    /// What is seen is nothing, up to rounding.
    pub is_hidden: bool,
}

impl Looked {
    /// The visible fraction V = F_visible / F; `None` where F = 0: on or behind
    /// the luminaire's plane, or below its own horizon.
    pub fn fraction(&self) -> Option<f64> {
        match (self.whole > 0.0, self.is_whole, self.is_hidden) {
            (false, ..) => None,
            (_, true, _) => Some(1.0),
            (_, _, true) => Some(0.0),
            _ => Some((self.visible / self.whole).clamp(0.0, 1.0)),
        }
    }
}

/// A visible or a hidden part counts as nothing below this share of the whole.
const NOTHING: f64 = 1e-12;

impl Lookout {
    /// Surface `luminaire` of a scene; it need not emit.
    ///
    /// # Errors
    /// [`Error::Outline`] where a polygon has no convex parts.
    pub fn new(scene: &Scene, luminaire: usize) -> Result<Self, Error> {
        let surface = &scene.surfaces[luminaire];
        let parts = partition::convex_pieces(&surface.vertices, surface.normal);
        Ok(Self {
            occluders: Occluders::new(scene)?,
            parts: parts.ok_or_else(|| Error::Outline {
                surface: surface.name.clone(),
            })?,
            plane: [surface.normal, surface.center()],
            tolerance: scene.plane_tolerance(),
        })
    }

    /// What is seen from a place that faces the unit vector `normal`.
    ///
    /// F by Eq. 3 over the visible fragments of each convex part; error 1e-12
    /// absolute. Costs a test for every occluder, and a few cuts for those
    /// that hide something.
    pub fn look(&self, position: DVec3, normal: DVec3) -> Looked {
        let mut looked = Looked {
            visible: 0.0,
            whole: 0.0,
            is_whole: true,
            is_hidden: true,
        };
        let [facing, centre] = self.plane;
        if facing.dot(position - centre) <= self.tolerance {
            return looked;
        }
        let sight = self.occluders.seen_from(Receiver { position, normal });
        let everything = sight.everything();
        let factor = |part: &Loop| form_factor_signed(DVec3::ZERO, normal, part).max(0.0);
        for part in &self.parts {
            let polygon = sight.above(&sight.relative(part));
            if polygon.len() < 3 {
                continue;
            }
            let whole = factor(&polygon);
            looked.whole += whole;
            looked.visible += match sight.blockers(&everything, &polygon, facing) {
                None => 0.0,
                Some(blockers) if blockers.is_empty() => whole,
                Some(blockers) => {
                    let fragments = sight.fragments(polygon, &blockers);
                    fragments.iter().map(factor).sum()
                }
            };
        }
        looked.is_hidden = looked.visible <= NOTHING * looked.whole;
        looked.is_whole = looked.whole - looked.visible <= NOTHING * looked.whole;
        looked
    }
}
