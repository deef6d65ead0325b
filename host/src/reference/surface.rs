//! Surfaces as the reference keeps them.

use std::f64::consts::PI;
use std::sync::atomic::AtomicUsize;

use glam::DVec3;

use super::cell::{Cell, Field};
use super::form_factor::form_factor;
use super::luminaire::Luminaire;
use super::patch::Receiver;
use super::rule::Rule;
use crate::scene::{Scene, Surface};

/// A point whose normal is the surface's within this (length of the
/// difference) and whose height is within the same share of the scene's
/// largest coordinate lies on the surface's plane, and gets nothing from it
/// whatever rounding did to its coordinates.
const COPLANAR: f64 = 1e-6;

/// A height below this share of the scene's largest coordinate is rounding.
const ON_PLANE: f64 = 1e-14;

/// A polygon and its plane.
#[derive(Clone)]
pub(super) struct Outline {
    /// Vertices, counter-clockwise from the front.
    pub(super) vertices: Vec<DVec3>,
    /// Unit normal.
    pub(super) normal: DVec3,
    /// Largest absolute coordinate of the scene.
    pub(super) scale: f64,
}

impl Outline {
    /// A surface of a scene.
    pub(super) fn new(scene: &Scene, surface: &Surface) -> Self {
        Self {
            vertices: surface.vertices.clone(),
            normal: surface.normal,
            scale: scene.largest_coordinate(),
        }
    }

    /// Height of the receiver over the front, `None` where it can see nothing of it.
    pub(super) fn height(&self, receiver: &Receiver) -> Option<f64> {
        let height = self
            .normal
            .dot(receiver.position - self.vertices.first().copied().unwrap_or_default());
        let parallel = (self.normal - receiver.normal).length() <= COPLANAR;
        let needed = if parallel { COPLANAR } else { ON_PLANE };
        (height > needed * self.scale).then_some(height)
    }

    /// Form factor to the whole polygon.
    pub(super) fn form_factor(&self, receiver: &Receiver) -> f64 {
        match self.height(receiver) {
            Some(_) => form_factor(receiver.position, receiver.normal, &self.vertices),
            None => 0.0,
        }
    }
}

/// Irradiance by one channel of all luminaires, nothing in between:
/// `E = Σ π L F`.
fn direct(origin: &Origin<'_>, receiver: &Receiver) -> f64 {
    let parts = origin.luminaires.iter();
    parts
        .map(|luminaire| {
            PI * luminaire.radiance[origin.channel] * luminaire.outline.form_factor(receiver)
        })
        .sum()
}

/// A surface with the light it sends out.
pub(super) struct Reflector {
    /// Where it is.
    pub(super) outline: Outline,
    /// Reflectance.
    pub(super) reflectance: f64,
    /// Radiance on its parts.
    pub(super) cells: Vec<Cell>,
}

/// Where a reflector's radiance comes from beyond its nodes.
pub(super) struct Origin<'a> {
    /// The rule of its cells.
    pub(super) rule: &'a Rule,
    /// The luminaires whose direct light it reflects.
    pub(super) luminaires: &'a [Luminaire],
    /// The channel.
    pub(super) channel: usize,
    /// Cells kept so far.
    pub(super) kept: &'a AtomicUsize,
}

impl Reflector {
    /// `∫ L dA` over the surface.
    pub(super) fn flux(&self) -> f64 {
        self.cells.iter().map(Cell::flux).sum()
    }

    /// Irradiance if the radiance were constant: sets the scale of tolerances.
    pub(super) fn rough(&self, receiver: &Receiver) -> f64 {
        let area: f64 = self.cells.iter().map(Cell::area).sum();
        PI * self.flux() / area.max(f64::MIN_POSITIVE) * self.outline.form_factor(receiver)
    }

    /// Irradiance at the receiver.
    pub(super) fn receive(&self, origin: &Origin<'_>, receiver: &Receiver, tolerance: f64) -> f64 {
        let Some(height) = self.outline.height(receiver) else {
            return 0.0;
        };
        with_field(&self.outline, self.reflectance, origin, |field| {
            let parts = self.cells.iter();
            parts
                .map(|cell| cell.receive(field, receiver, height, tolerance))
                .sum()
        })
    }
}

/// The field of directly lit radiance `ρ E / π` on a surface.
pub(super) fn with_field<T>(
    outline: &Outline,
    reflectance: f64,
    origin: &Origin<'_>,
    use_it: impl FnOnce(&Field<'_>) -> T,
) -> T {
    let radiances = origin.luminaires.iter().map(|l| l.radiance[origin.channel]);
    let brightest: f64 = radiances.sum();
    use_it(&Field {
        rule: origin.rule,
        normal: outline.normal,
        radiance: &|position| {
            let receiver = Receiver {
                position,
                normal: outline.normal,
            };
            reflectance / PI * direct(origin, &receiver)
        },
        noise: f64::EPSILON * brightest * reflectance,
        kept: origin.kept,
    })
}
