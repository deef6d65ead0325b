//! A scene: polygons that emit, reflect and occlude, and what is asked of it.
//!
//! The ground floor of the host: every other room reads a [`Scene`], none
//! writes one. Lengths are metres, radiances W m⁻² sr⁻¹ (cd m⁻² in a
//! photometric scene), irradiances W m⁻² (lx). A polygon faces the side from
//! which its vertices run counter-clockwise.

pub mod body;
pub mod camera;
pub mod diagnostic;
pub(crate) mod document;
pub mod file;
pub mod frame;
pub mod memory;
pub mod points;
pub mod polygon;
pub mod requires;
pub mod rungs;
mod section;
pub(crate) mod settings;
pub mod shipped;

use glam::DVec3;

pub use diagnostic::Diagnostic;
pub use document::MAX_COORDINATE;
pub use settings::parse_bytes;

/// A surface never occludes a point on its own plane; a point is on it within
/// this part of the scene's largest absolute coordinate, because the points of
/// rotated or rounded scenes lie a little off.
pub const PLANE_TOLERANCE: f64 = 1e-6;

/// A validated scene, in the order of its file.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The scene's name.
    pub name: String,
    /// Whether radiance is radiometric or photometric.
    pub quantity: Quantity,
    /// The polygons, in file order.
    pub surfaces: Vec<Surface>,
    /// Closed convex occluders made of surfaces.
    pub bodies: Vec<Body>,
    /// Named places whose irradiance is asked for.
    pub points: Vec<Point>,
    /// Rungs the scene asks for; `None` where it leaves the choice open.
    pub rungs: Rungs,
    /// The camera of its pictures.
    pub camera: Option<Camera>,
    /// What the device may spend.
    pub budget: Budget,
}

/// The physical quantity a scene is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Radiance in W m⁻² sr⁻¹, irradiance in W m⁻².
    Radiometric,
    /// Luminance in cd m⁻², illuminance in lx.
    Photometric,
}

impl Quantity {
    /// The unit of irradiance (illuminance) as it is printed.
    pub fn irradiance_unit(self) -> &'static str {
        match self {
            Self::Radiometric => "W/m²",
            Self::Photometric => "lx",
        }
    }

    /// The unit of radiosity as it is printed.
    pub fn radiosity_unit(self) -> &'static str {
        match self {
            Self::Radiometric => "W/m²",
            Self::Photometric => "lm/m²",
        }
    }

    /// What irradiance is called.
    pub fn irradiance_name(self) -> &'static str {
        match self {
            Self::Radiometric => "irradiance",
            Self::Photometric => "illuminance",
        }
    }
}

/// A planar polygon that emits and reflects on its front.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Unique name.
    pub name: String,
    /// At least three vertices, counter-clockwise seen from the front, in metres.
    pub vertices: Vec<DVec3>,
    /// Unit normal of the front.
    pub normal: DVec3,
    /// Area in m².
    pub area: f64,
    /// Diffuse reflectance of each channel, 0 ≤ ρ < 1.
    pub reflectance: [f64; 3],
    /// Emitted radiance of each channel.
    pub radiance: [f64; 3],
}

/// A closed convex occluder.
#[derive(Clone, Debug)]
pub struct Body {
    /// Unique name.
    pub name: String,
    /// Indices of its faces in [`Scene::surfaces`].
    pub surfaces: Vec<usize>,
}

/// A named place.
#[derive(Clone, Debug)]
pub struct Point {
    /// Unique name.
    pub name: String,
    /// Position in metres.
    pub position: DVec3,
    /// Unit normal of the receiving side.
    pub normal: DVec3,
}

/// The names of the rungs a scene asks for (see the accuracy ladders in the README).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rungs {
    /// Number type and edge term.
    pub arithmetic: Option<String>,
    /// How occlusion is found.
    pub visibility: Option<String>,
    /// What a secondary emitter is.
    pub emitters: Option<String>,
    /// How emitter-to-receiver terms are had on the device.
    pub transfer: Option<String>,
    /// How samples are placed.
    pub placement: Option<String>,
    /// How samples become an image.
    pub reconstruction: Option<String>,
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Position in metres.
    pub eye: DVec3,
    /// A place in the middle of the picture.
    pub target: DVec3,
    /// A direction that is up in the picture.
    pub up: DVec3,
    /// Vertical field of view in degrees.
    pub fov: f64,
}

/// What the device may spend; `None` is no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    /// Bytes of RAM.
    pub ram: Option<u64>,
    /// Bytes of flash.
    pub flash: Option<u64>,
    /// Form-factor samples.
    pub samples: Option<u64>,
}

impl Scene {
    /// The largest absolute coordinate of its surfaces in metres.
    pub fn largest_coordinate(&self) -> f64 {
        largest_coordinate(&self.surfaces)
    }

    /// The distance in metres within which a point counts as on a plane:
    /// [`PLANE_TOLERANCE`] of the largest absolute coordinate.
    pub fn plane_tolerance(&self) -> f64 {
        PLANE_TOLERANCE * self.largest_coordinate()
    }

    /// The index of the surface of that name.
    pub fn surface_named(&self, name: &str) -> Option<usize> {
        self.surfaces
            .iter()
            .position(|surface| surface.name == name)
    }
}

impl Surface {
    /// The mean of the vertices, in metres: a place on the surface's plane.
    pub fn center(&self) -> DVec3 {
        polygon::center(&self.vertices)
    }

    /// Signed distance in metres of a place from the surface's plane, positive
    /// on the front.
    pub fn height_of(&self, place: DVec3) -> f64 {
        (place - self.center()).dot(self.normal)
    }

    /// Whether it emits in any channel.
    pub fn emits(&self) -> bool {
        self.radiance.iter().any(|&radiance| radiance > 0.0)
    }

    /// Whether it reflects in any channel.
    pub fn reflects(&self) -> bool {
        self.reflectance.iter().any(|&rho| rho > 0.0)
    }
}

fn largest_coordinate(surfaces: &[Surface]) -> f64 {
    surfaces
        .iter()
        .flat_map(|surface| &surface.vertices)
        .fold(0.0, |largest: f64, vertex| {
            largest.max(vertex.abs().max_element())
        })
}

/// The direction of `vector` at unit length; `None` for zero. Neither huge nor
/// tiny lengths are lost.
fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    if largest == 0.0 || !largest.is_finite() {
        return None;
    }
    // Dividing twice, not multiplying by a reciprocal: an axis stays exact.
    let scaled = vector / largest;
    Some(scaled / scaled.length())
}
