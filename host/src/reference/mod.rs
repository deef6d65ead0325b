//! The judge: irradiance in f64, converged.
//!
//! Shares no formula, clip or visibility code with the kernel that it
//! judges. For scenes without occlusion, in the first channel:
//!
//! * Direct light is analytic, `E = Σ π L F` over the luminaires
//!   ([`form_factor()`]).
//! * Light reflected once is `E(x) = Σ ρ/π ∫ E_direct(y) cos cos / r² dA` over
//!   the reflecting surfaces, by adaptive product Gauss rules: surfaces are
//!   split where the plane of a luminaire crosses them (there direct light
//!   has a kink), into convex quadrilaterals, and those into quarters until
//!   each is far enough from x for its rule and its own quarters agree with
//!   it. What the quadtree learns about direct light serves all later points.
//! * Light reflected more often is gathered the same way from polynomials of
//!   the surfaces' irradiance by each generation of reflected light, on a
//!   mesh refined until the answer agrees with itself.
//!
//! A point within rounding of a surface's plane, or behind it, receives
//! nothing from that surface.

mod cell;
mod form_factor;
mod interreflection;
mod parallel;
mod partition;
mod patch;
mod request;
mod rule;
mod surface;

use std::f64::consts::PI;
use std::fmt;
use std::sync::atomic::AtomicUsize;

use glam::DVec3;

use crate::scene::{Scene, Surface};
use cell::Cell;
use interreflection::{Blank, Interreflection, Mesh};
use partition::Plane;
use patch::Receiver;
use rule::Rule;
use surface::{Luminaire, Origin, Outline, Reflector};

pub use form_factor::{form_factor, form_factor_signed};
pub use request::{Error, Reflections};

/// Nodes in a direction of a cell of directly lit radiance.
const ORDER: usize = 10;

/// Error allowed to one cell, relative to a rough value of the irradiance.
const CELL_TOLERANCE: f64 = 1e-11;

/// What is promised for light reflected at most once.
const PROMISED: f64 = 1e-9;

/// Agreement at which the mesh of further reflections is fine enough.
const AGREEMENT: f64 = 1e-7;

/// Error allowed to one cell of that mesh.
const MESH_TOLERANCE: f64 = 1e-8;

/// Points at which two meshes are compared.
const PROBES: usize = 96;

/// The converged irradiance of an unoccluded scene (first channel).
pub struct Reference {
    luminaires: Vec<Luminaire>,
    rule: Rule,
    once: Vec<Reflector>,
    further: Option<Interreflection>,
    reflections: usize,
    accuracy: f64,
    kept: AtomicUsize,
}

impl fmt::Debug for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reference")
            .field("luminaires", &self.luminaires.len())
            .field("reflectors", &self.once.len())
            .field("reflections", &self.reflections)
            .field("accuracy", &self.accuracy)
            .finish_non_exhaustive()
    }
}

impl Reference {
    /// Prepares the reference for a scene. Every surface of positive radiance
    /// emits, every one of positive reflectance reflects, nothing occludes:
    /// the caller refuses scenes in which something does.
    ///
    /// `progress` is told the done share, 0 to 1. Up to one reflection this
    /// is quick; more take a matrix of up to 6144² numbers (302 MB) and
    /// seconds.
    ///
    /// # Errors
    ///
    /// [`Error`] where a fraction makes no sense, a polygon crosses itself,
    /// or the scene is too large for more than one reflection.
    pub fn new(
        scene: &Scene,
        reflections: Reflections,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, Error> {
        if let Reflections::UntilUnshot(fraction) = reflections
            && (fraction.is_nan() || fraction <= 0.0)
        {
            return Err(Error::Fraction(fraction));
        }
        let mut reference = Self {
            luminaires: luminaires(scene),
            rule: Rule::new(ORDER),
            once: Vec::new(),
            further: None,
            reflections: 0,
            accuracy: PROMISED,
            kept: AtomicUsize::new(0),
        };
        progress(0.0);
        if !matches!(reflections, Reflections::AtMost(0)) {
            reference.reflect(scene, reflections, progress)?;
        }
        progress(1.0);
        Ok(reference)
    }

    fn reflect(
        &mut self,
        scene: &Scene,
        reflections: Reflections,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), Error> {
        let emits = |surface: &Surface| surface.radiance[0] > 0.0;
        let blanks = blanks(scene, &emits)?;
        let power: f64 = scene
            .surfaces
            .iter()
            .map(|surface| PI * surface.radiance[0] * surface.area)
            .sum();
        let once: Vec<Reflector> = blanks.iter().map(|blank| self.lit(blank)).collect();
        let unshot: f64 = PI * once.iter().map(Reflector::flux).sum::<f64>();
        if reflections.enough(0, unshot, power) {
            return Ok(());
        }
        self.once = once;
        self.reflections = 1;
        if reflections == Reflections::AtMost(1) {
            return Ok(());
        }
        progress(0.1);
        self.reflect_further(scene, reflections, power, progress)
    }

    /// Refines the mesh of further reflections until two levels agree.
    fn reflect_further(
        &mut self,
        scene: &Scene,
        reflections: Reflections,
        power: f64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), Error> {
        let either = |surface: &Surface| surface.radiance[0] > 0.0 || surface.reflectance[0] > 0.0;
        let blanks = blanks(scene, &either)?;
        let mut probes: Vec<Receiver> = Vec::new();
        let mut before: Option<Vec<f64>> = None;
        for level in 0.. {
            let mesh = match Mesh::new(&blanks, level) {
                Ok(mesh) => mesh,
                Err(_) if level > 1 => break,
                Err(error) => return Err(error),
            };
            let receivers = mesh.receivers(&blanks);
            let mut first = vec![0.0; receivers.len()];
            parallel::rows(&mut first, 1, |index, value| {
                value[0] = self.gather_once(&receivers[index], MESH_TOLERANCE);
            });
            let found = mesh.solve(&blanks, first, reflections, power)?;
            progress(1.0 - 0.9 / (level + 2) as f64);
            if probes.is_empty() {
                let stride = receivers.len().div_ceil(PROBES).max(1);
                probes = receivers.into_iter().step_by(stride).collect();
            }
            let changed = self.reflections != found.reflections;
            self.reflections = found.reflections;
            self.further = Some(found);
            let values = self.at_all(&probes);
            if let Some(before) = &before {
                let pairs = before.iter().zip(&values);
                let worst = pairs
                    .map(|(a, b)| if a == b { 0.0 } else { (a - b).abs() / b.abs() })
                    .fold(0.0, f64::max);
                self.accuracy = PROMISED.max(worst);
                if worst <= AGREEMENT && !changed {
                    break;
                }
            }
            before = Some(values);
        }
        Ok(())
    }

    /// A reflector under direct light.
    fn lit(&self, blank: &Blank) -> Reflector {
        let origin = self.origin(&self.rule);
        let cells = surface::with_field(&blank.outline, blank.reflectance, &origin, |field| {
            let parts = blank.quadrilaterals.iter();
            parts
                .map(|corners| Cell::evaluate(*corners, field))
                .collect()
        });
        Reflector {
            outline: blank.outline.clone(),
            reflectance: blank.reflectance,
            cells,
        }
    }

    fn origin<'a>(&'a self, rule: &'a Rule) -> Origin<'a> {
        Origin {
            rule,
            luminaires: &self.luminaires,
            kept: &self.kept,
        }
    }

    /// Irradiance by light reflected exactly once.
    fn gather_once(&self, receiver: &Receiver, tolerance: f64) -> f64 {
        let origin = self.origin(&self.rule);
        gather(&self.once, &origin, receiver, tolerance)
    }

    /// Irradiance (W m⁻², or lx in a photometric scene) of a differential
    /// area at `position` (metres) facing `normal` (any length but 0).
    ///
    /// To within [`Reference::accuracy`]. Cost: about a microsecond for direct light,
    /// some tens with a reflection, up to a millisecond close to an edge
    /// where surfaces meet.
    #[must_use]
    pub fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        let Some(normal) = normal.try_normalize() else {
            return 0.0;
        };
        self.at(&Receiver { position, normal })
    }

    fn at(&self, receiver: &Receiver) -> f64 {
        let mut total = surface::direct(&self.luminaires, receiver);
        if !self.once.is_empty() {
            total += self.gather_once(receiver, CELL_TOLERANCE);
        }
        if let Some(further) = &self.further {
            let origin = self.origin(&further.rule);
            total += gather(&further.reflectors, &origin, receiver, MESH_TOLERANCE);
        }
        total
    }

    fn at_all(&self, receivers: &[Receiver]) -> Vec<f64> {
        let mut values = vec![0.0; receivers.len()];
        parallel::rows(&mut values, 1, |index, value| {
            value[0] = self.at(&receivers[index]);
        });
        values
    }

    /// [`Reference::irradiance`] at many points (position, normal), on all
    /// processors: the same bits in the same order as one by one.
    #[must_use]
    pub fn irradiance_at(&self, points: &[(DVec3, DVec3)]) -> Vec<f64> {
        let mut values = vec![0.0; points.len()];
        parallel::rows(&mut values, 1, |index, value| {
            let (position, normal) = points[index];
            value[0] = self.irradiance(position, normal);
        });
        values
    }

    /// How often the counted light is reflected at most.
    #[must_use]
    pub fn reflections(&self) -> usize {
        self.reflections
    }

    /// The relative error of an irradiance.
    ///
    /// For light reflected at most once 1e-9 is promised (of the surfaces'
    /// mean effect on the point, where the point sees only what is much
    /// darker than the mean). With more reflections it is what was measured:
    /// the largest relative difference between the two finest meshes, at 96
    /// points spread over the reflecting surfaces.
    #[must_use]
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }
}

/// Irradiance from reflectors, each cell to within `tolerance` of a rough
/// value of the whole.
fn gather(
    reflectors: &[Reflector],
    origin: &Origin<'_>,
    receiver: &Receiver,
    tolerance: f64,
) -> f64 {
    let rough: f64 = reflectors.iter().map(|r| r.rough(receiver)).sum();
    if rough <= 0.0 {
        return 0.0;
    }
    let parts = reflectors.iter();
    parts
        .map(|reflector| reflector.receive(origin, receiver, tolerance * rough))
        .sum()
}

fn outline(scene: &Scene, surface: &Surface) -> Outline {
    let coordinates = scene.surfaces.iter().flat_map(|surface| &surface.vertices);
    Outline {
        vertices: surface.vertices.clone(),
        normal: surface.normal,
        scale: coordinates
            .map(|vertex| vertex.abs().max_element())
            .fold(0.0, f64::max),
    }
}

fn luminaires(scene: &Scene) -> Vec<Luminaire> {
    let emitting = scene.surfaces.iter().filter(|s| s.radiance[0] > 0.0);
    emitting
        .map(|surface| Luminaire {
            outline: outline(scene, surface),
            radiance: surface.radiance[0],
        })
        .collect()
}

/// The reflecting surfaces, split along the planes of those that `shine`.
fn blanks(scene: &Scene, shine: &dyn Fn(&Surface) -> bool) -> Result<Vec<Blank>, Error> {
    let planes: Vec<Plane> = scene
        .surfaces
        .iter()
        .filter(|surface| shine(surface))
        .map(|surface| Plane {
            point: surface.vertices[0],
            normal: surface.normal,
        })
        .collect();
    let reflecting = scene.surfaces.iter().filter(|s| s.reflectance[0] > 0.0);
    reflecting
        .map(|surface| {
            let parts = partition::quadrilaterals(&surface.vertices, surface.normal, &planes);
            Ok(Blank {
                outline: outline(scene, surface),
                reflectance: surface.reflectance[0],
                quadrilaterals: parts.ok_or_else(|| Error::Outline {
                    surface: surface.name.clone(),
                })?,
            })
        })
        .collect()
}
