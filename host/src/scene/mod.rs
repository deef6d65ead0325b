//! A scene: polygons that emit, reflect and occlude, and what is asked of it.
//!
//! The ground floor of the host: every other room reads a [`Scene`], none
//! writes one. Lengths are metres, radiances W m⁻² sr⁻¹ (cd m⁻² in a
//! photometric scene), irradiances W m⁻² (lx). A polygon faces the side from
//! which its vertices run counter-clockwise.

use glam::DVec3;

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
