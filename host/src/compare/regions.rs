//! Errors by what light does at a place: in the open, in a shadow, at a foot.

use super::{Compared, Errors, Seen, errors_by_scale, mean};
use crate::plan::shadow::{Error, Floor};
use crate::plan::{self, SurfacePlan, Tag};
use crate::reference::Lookout;
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Which tag the places of a scene would have, were they samples.
pub struct Regions {
    lookouts: Vec<Lookout>,
    floors: Vec<Floor>,
    /// Surfaces whose errors count.
    reflecting: Vec<bool>,
}

/// What the places of one tag err by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tagged {
    /// Their tag.
    pub tag: Tag,
    /// How many of all places these are, in percent.
    pub share: f64,
    /// What they err by.
    pub errors: Errors,
}

/// A place with what was found there and what is true.
struct Judged {
    surface: usize,
    position: DVec3,
    value: f64,
    truth: f64,
    full_scale: f64,
}

/// Is told how many more places have been looked at, from any thread.
type Done<'a> = &'a (dyn Fn(usize) + Sync);

impl Regions {
    /// The regions of all surfaces.
    ///
    /// # Errors
    /// [`Error`] where there are too many vertices, or an outline is not simple.
    pub fn of(scene: &Scene) -> Result<Self, Error> {
        let surfaces = || 0..scene.surfaces.len();
        let luminaires = surfaces().filter(|&index| scene.surfaces[index].emits());
        let lookouts = luminaires.map(|index| Lookout::new(scene, index).map_err(Error::Outline));
        let floors = surfaces().map(|index| Floor::of(scene, index));
        Ok(Self {
            lookouts: lookouts.collect::<Result<_, _>>()?,
            floors: floors.collect::<Result<_, _>>()?,
            reflecting: scene
                .surfaces
                .iter()
                .map(|surface| surface.reflects())
                .collect(),
        })
    }

    /// The tag of a place of a surface ([`Tag::of_place`]), by the exact shadows.
    ///
    /// Costs a look at every luminaire.
    pub fn tag(&self, surface: usize, position: DVec3) -> Tag {
        let floor = &self.floors[surface];
        let frame = &floor.frame;
        let (u, v) = frame.to_local(position);
        let looks = self.lookouts.iter();
        let looks = looks.map(|lookout| lookout.look(position, frame.normal));
        let faced = looks.filter(|looked| looked.whole > 0.0);
        let seen = faced.map(|looked| match (looked.is_whole, looked.is_hidden) {
            (true, _) => plan::Seen::Wholly,
            (_, true) => plan::Seen::Hidden,
            _ => plan::Seen::Partly,
        });
        Tag::of_place(floor.is_at_foot(DVec2::new(u, v)), seen)
    }

    /// What the places of each tag err by, of a surface's grid; `done` is told how many
    /// more cells have been looked at.
    pub fn of_surface(&self, compared: &Compared, done: Done<'_>) -> Vec<Tagged> {
        let frame = &self.floors[compared.surface].frame;
        let side = compared.resolution;
        let cells = (0..side * side).filter(|&k| compared.inside[k]);
        let places = cells.map(|k| {
            let (u, v) = frame.cell_center(k % side, k / side, side, side);
            Judged {
                surface: compared.surface,
                position: frame.to_world(u, v),
                value: compared.structured[k],
                truth: compared.reference[k],
                full_scale: compared.full_scale,
            }
        });
        self.by_tag(places.collect(), done)
    }

    /// The same of a camera's pixels that see the front of a surface that reflects;
    /// `full_scale` is each surface's largest reference value.
    pub fn of_camera(&self, seen: &Seen, full_scale: &[f64], done: Done<'_>) -> Vec<Tagged> {
        let pixels = seen.hits.iter().enumerate();
        let fronts = pixels.filter_map(|(k, hit)| Some((k, hit.filter(|hit| hit.front)?)));
        let counted = fronts.filter(|(_, hit)| self.reflecting[hit.surface]);
        let places = counted.map(|(k, hit)| Judged {
            surface: hit.surface,
            position: hit.position,
            value: mean(seen.structured[k]),
            truth: mean(seen.reference[k]),
            full_scale: full_scale[hit.surface],
        });
        self.by_tag(places.collect(), done)
    }

    /// The tags of the places where a surface's samples are.
    pub fn of_samples(&self, surface: usize, planned: &SurfacePlan) -> Vec<Tag> {
        let place = |[u, v]: [f64; 2]| planned.frame.to_world(u, v);
        let samples = planned.samples.iter();
        samples
            .map(|sample| self.tag(surface, place(sample.place)))
            .collect()
    }

    /// What the places of each tag err by; tags without a place are left out.
    fn by_tag(&self, places: Vec<Judged>, done: Done<'_>) -> Vec<Tagged> {
        let tag = |place: &Judged| {
            done(1);
            self.tag(place.surface, place.position)
        };
        let tags: Vec<Tag> = places.par_iter().map(tag).collect();
        let of_tag = |tag| {
            let its = || {
                places
                    .iter()
                    .zip(&tags)
                    .filter(move |place| *place.1 == tag)
            };
            let count = its().count();
            let errors = its().map(|(at, _)| (at.value, at.truth, at.full_scale));
            (count > 0).then(|| Tagged {
                tag,
                share: 100.0 * count as f64 / places.len() as f64,
                errors: errors_by_scale(errors),
            })
        };
        Tag::OF_PLACES.into_iter().filter_map(of_tag).collect()
    }
}
