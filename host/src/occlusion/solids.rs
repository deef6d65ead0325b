//! Closed convex bodies as places see them: inside it is dark.

use glam::DVec3;

use super::bodies;
use super::shape::{Plane, Shape};
use crate::scene::{PLANE_TOLERANCE, Scene, Surface};

/// The bodies of a scene: those that it names, and loose surfaces that close,
/// or stand with their open side on another surface.
#[derive(Clone, Debug)]
pub struct Solids {
    bodies: Vec<Solid>,
    flat: f64,
}

#[derive(Clone, Debug)]
struct Solid {
    surfaces: Vec<usize>,
    planes: Vec<Plane>,
}

impl Solids {
    /// Finds them.
    pub fn of(scene: &Scene) -> Self {
        let flat = PLANE_TOLERANCE * scene.largest_coordinate();
        let solid = |surfaces: Vec<usize>| {
            let faces: Vec<&Surface> = surfaces.iter().map(|&i| &scene.surfaces[i]).collect();
            let planes = Shape::body(&faces, flat)?.faces;
            Some(Solid { surfaces, planes })
        };
        let bodies = bodies::bodies(scene, flat);
        Self {
            bodies: bodies.into_iter().filter_map(solid).collect(),
            flat,
        }
    }

    /// The surfaces of each body, indices in [`Scene::surfaces`].
    pub fn surfaces(&self) -> impl ExactSizeIterator<Item = &[usize]> {
        self.bodies.iter().map(|body| &body.surfaces[..])
    }

    /// Whether a place on the surface `index`, whose unit normal is `normal`, is
    /// hidden by a body that stands on the surface or passes through it.
    ///
    /// Places on the outline of the body's foot are not hidden. Costs a
    /// distance for each face of the bodies.
    pub fn hide(&self, index: usize, place: DVec3, normal: DVec3) -> bool {
        // Lifted into what stands there, past the rounding of the two planes.
        let lifted = place + normal * (2.0 * self.flat);
        self.bodies.iter().any(|body| {
            let inside = |plane: &Plane| plane.height(lifted) < -self.flat;
            !body.surfaces.contains(&index) && body.planes.iter().all(inside)
        })
    }
}
