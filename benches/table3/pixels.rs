//! What the camera of the room sees, and what is right there.

use super::room;
use glam::DVec3;
use isolux_host::compare::{Errors, errors_by_scale};
use isolux_host::reference::{Error, Reference, Reflections};
use isolux_host::scene::camera::{Hit, View};
use isolux_host::scene::{Scene, shipped};

/// Pixels along each side of the picture.
pub(crate) const SIDE: u32 = 128;

/// The room, and the pixels that show the front of a surface that reflects.
pub(crate) struct Pixels {
    pub(crate) scene: Scene,
    pub(crate) hits: Vec<Hit>,
    /// Irradiance by the reference.
    exact: Vec<f64>,
    /// The largest of it on each surface.
    largest: Vec<f64>,
}

impl Pixels {
    pub(crate) fn new() -> Result<Self, Error> {
        let scene = room::scene("cornell", shipped::CORNELL);
        let camera = scene.camera.expect("the room has a camera");
        let shows = |hit: &Hit| hit.front && scene.surfaces[hit.surface].reflects();
        let seen = View::new(&camera, SIDE, SIDE).hits(&scene);
        let hits: Vec<Hit> = seen.into_iter().flatten().filter(shows).collect();
        let normal = |hit: &Hit| scene.surfaces[hit.surface].normal;
        let places: Vec<(DVec3, DVec3)> = hits.iter().map(|h| (h.position, normal(h))).collect();
        let exact = reference(&scene, Reflections::UntilUnshot(1e-5))?.irradiance_at(&places);
        let mut largest = vec![0.0_f64; scene.surfaces.len()];
        for (hit, &value) in hits.iter().zip(&exact) {
            largest[hit.surface] = largest[hit.surface].max(value);
        }
        Ok(Self {
            scene,
            hits,
            exact,
            largest,
        })
    }

    /// Places with their normals as the kernel takes them.
    pub(crate) fn receivers(&self) -> Vec<([f32; 3], [f32; 3])> {
        let single = |v: DVec3| v.as_vec3().to_array();
        let normal = |hit: &Hit| self.scene.surfaces[hit.surface].normal;
        let hits = self.hits.iter();
        hits.map(|hit| (single(hit.position), single(normal(hit))))
            .collect()
    }

    /// What answers at the pixels err by.
    pub(crate) fn errors(&self, answers: &[f64]) -> Errors {
        let pixels = self.hits.iter().zip(answers).zip(&self.exact);
        errors_by_scale(
            pixels.map(|((hit, &answer), &exact)| (answer, exact, self.largest[hit.surface])),
        )
    }
}

/// The reference, from where it was kept or solved with a word about it.
pub(crate) fn reference(scene: &Scene, reflections: Reflections) -> Result<Reference, Error> {
    eprintln!("reference {reflections:?}: from the cache, or some minutes");
    Reference::new(scene, reflections, &mut |_| {})
}
