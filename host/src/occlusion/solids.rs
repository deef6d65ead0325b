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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file;

    /// A floor, and a block on 1 x 1 from `z` to `top`, its lowest face left out.
    fn block(z: f64, top: f64) -> Scene {
        let face = |name: &str, vertices: [[f64; 3]; 4]| {
            format!("[[surface]]\nname = \"{name}\"\nvertices = {vertices:?}\nreflectance = 0.5\n")
        };
        let text = "isolux = 1\nname = \"t\"\nquantity = \"radiometric\"\n".to_owned()
            + &face(
                "floor",
                [[0., 0., 0.], [4., 0., 0.], [4., 4., 0.], [0., 4., 0.]],
            )
            + &face(
                "lid",
                [[1., 1., top], [2., 1., top], [2., 2., top], [1., 2., top]],
            )
            + &face(
                "s",
                [[1., 1., z], [2., 1., z], [2., 1., top], [1., 1., top]],
            )
            + &face(
                "e",
                [[2., 1., z], [2., 2., z], [2., 2., top], [2., 1., top]],
            )
            + &face(
                "n",
                [[2., 2., z], [1., 2., z], [1., 2., top], [2., 2., top]],
            )
            + &face(
                "w",
                [[1., 2., z], [1., 1., z], [1., 1., top], [1., 2., top]],
            )
            + "[[body]]\nname = \"b\"\nsurfaces = [\"lid\", \"s\", \"e\", \"n\", \"w\"]\n";
        file::parse("t.toml", &text).unwrap()
    }

    #[test]
    fn a_body_hides_its_foot_and_nothing_else() {
        let hidden = |scene: &Scene, index: usize, x: f64, y: f64, z: f64| {
            let normal = scene.surfaces[index].normal;
            Solids::of(scene).hide(index, DVec3::new(x, y, z), normal)
        };
        let standing = block(0.0, 1.0);
        assert!(hidden(&standing, 0, 1.5, 1.5, 0.0));
        assert!(hidden(&standing, 0, 1.01, 1.99, 0.0));
        assert!(!hidden(&standing, 0, 0.99, 1.5, 0.0));
        assert!(!hidden(&standing, 1, 1.5, 1.5, 1.0), "its own lid");
        assert!(!hidden(&block(0.1, 1.0), 0, 1.5, 1.5, 0.0), "it hovers");
        assert!(
            hidden(&block(-0.5, 0.5), 0, 1.5, 1.5, 0.0),
            "it passes through"
        );
        assert!(!hidden(&block(-1.0, -0.5), 0, 1.5, 1.5, 0.0), "it is below");
    }
}
