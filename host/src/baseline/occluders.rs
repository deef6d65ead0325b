//! Rays between two places: what lies between.

use glam::{DVec2, DVec3};

use crate::scene::{Scene, Surface};

/// A surface that rays may meet.
#[derive(Clone, Debug)]
struct Occluder {
    normal: DVec3,
    offset: f64,
    /// The coordinate that is left out where the polygon is looked at in two.
    dropped: usize,
    outline: Vec<DVec2>,
}

/// All surfaces of a scene, and the distance within which a place is on a
/// plane. A surface occludes from both sides, but neither to nor from a place
/// on its own plane.
#[derive(Clone, Debug)]
pub(super) struct Occluders {
    all: Vec<Occluder>,
    flat: f64,
}

/// What may come between an emitter and places: for each surface the lowest and
/// the highest corner of the emitter over its plane.
#[derive(Clone, Debug, Default)]
pub(super) struct Span(Vec<(f64, f64)>);

impl Occluder {
    fn of(surface: &Surface) -> Self {
        let steep = surface.normal.abs();
        let dropped = if steep.x >= steep.y && steep.x >= steep.z {
            0
        } else if steep.y >= steep.z {
            1
        } else {
            2
        };
        Self {
            normal: surface.normal,
            offset: surface.normal.dot(surface.center()),
            dropped,
            outline: surface.vertices.iter().map(|v| flat(*v, dropped)).collect(),
        }
    }

    fn height(&self, place: DVec3) -> f64 {
        self.normal.dot(place) - self.offset
    }

    /// Whether the polygon holds a place of its plane: an odd number of edges
    /// to its right.
    fn holds(&self, place: DVec3) -> bool {
        let place = flat(place, self.dropped);
        let Some(mut from) = self.outline.last().copied() else {
            return false;
        };
        let mut inside = false;
        for &to in &self.outline {
            if (from.y > place.y) != (to.y > place.y) {
                let t = (place.y - from.y) / (to.y - from.y);
                if place.x < from.x + t * (to.x - from.x) {
                    inside = !inside;
                }
            }
            from = to;
        }
        inside
    }
}

fn flat(place: DVec3, dropped: usize) -> DVec2 {
    match dropped {
        0 => DVec2::new(place.y, place.z),
        1 => DVec2::new(place.z, place.x),
        _ => DVec2::new(place.x, place.y),
    }
}

impl Occluders {
    pub(super) fn of(scene: &Scene) -> Self {
        Self {
            all: scene.surfaces.iter().map(Occluder::of).collect(),
            flat: scene.plane_tolerance(),
        }
    }

    /// Where an emitter of these corners is.
    pub(super) fn span(&self, corners: &[DVec3]) -> Span {
        let range = |occluder: &Occluder| {
            corners
                .iter()
                .map(|corner| occluder.height(*corner))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
                    (low.min(height), high.max(height))
                })
        };
        Span(self.all.iter().map(range).collect())
    }

    /// Into `found` the surfaces whose planes part a place from some of the
    /// emitter, with the place's heights over them.
    pub(super) fn between(&self, place: DVec3, span: &Span, found: &mut Vec<(usize, f64)>) {
        found.clear();
        for (index, (occluder, &(low, high))) in self.all.iter().zip(&span.0).enumerate() {
            let height = occluder.height(place);
            let parts = (height > self.flat && low < -self.flat)
                || (height < -self.flat && high > self.flat);
            if parts {
                found.push((index, height));
            }
        }
    }

    /// Whether any of the surfaces `found` is between a place and a sample.
    pub(super) fn hide(&self, place: DVec3, sample: DVec3, found: &[(usize, f64)]) -> bool {
        found.iter().any(|&(index, height)| {
            let occluder = &self.all[index];
            let other = occluder.height(sample);
            let parts = (height > 0.0 && other < -self.flat) || (height < 0.0 && other > self.flat);
            parts && {
                let t = height / (height - other);
                occluder.holds(place + (sample - place) * t)
            }
        })
    }
}
