//! Scenes in which nothing comes in between, light reflected once: one channel,
//! adaptive quadrature.
//!
//! `E(x) = Σ ρ/π ∫ E_direct(y) cos cos / r² dA` over the reflecting surfaces, by
//! product Gauss rules: surfaces are split where the plane of a luminaire
//! crosses them (there direct light has a kink), into convex quadrilaterals,
//! and those into quarters until each is far enough from x for its rule and
//! its own quarters agree with it. What the quadtree learns about direct light
//! serves all later points.

use std::f64::consts::PI;
use std::sync::atomic::AtomicUsize;

use super::Error;
use super::cell::Cell;
use super::luminaire::{self, Luminaire};
use super::partition::{self, Plane};
use super::patch::Receiver;
use super::rule::Rule;
use super::surface::{self, Origin, Outline, Reflector};
use crate::scene::Scene;

/// Nodes in a direction of a cell of directly lit radiance.
const ORDER: usize = 10;

/// Error allowed to one cell, relative to a rough value of the irradiance.
const TOLERANCE: f64 = 1e-11;

/// The surfaces under direct light.
pub(super) struct Open {
    luminaires: Vec<Luminaire>,
    /// The channel.
    pub(super) channel: usize,
    rule: Rule,
    reflectors: Vec<Reflector>,
    kept: AtomicUsize,
}

impl Open {
    /// The reflecting surfaces of a scene, lit in one channel.
    pub(super) fn new(scene: &Scene, channel: usize) -> Result<Self, Error> {
        let mut open = Self {
            luminaires: luminaire::luminaires(scene)?,
            channel,
            rule: Rule::new(ORDER),
            reflectors: Vec::new(),
            kept: AtomicUsize::new(0),
        };
        let emitting = scene.surfaces.iter().filter(|s| s.radiance[channel] > 0.0);
        let planes: Vec<Plane> = emitting
            .map(|surface| Plane {
                point: surface.vertices[0],
                normal: surface.normal,
            })
            .collect();
        let reflecting = scene
            .surfaces
            .iter()
            .filter(|s| s.reflectance[channel] > 0.0);
        let reflectors: Result<Vec<Reflector>, Error> = reflecting
            .map(|surface| {
                let parts = partition::quadrilaterals(&surface.vertices, surface.normal, &planes);
                let parts = parts.ok_or_else(|| Error::Outline {
                    surface: surface.name.clone(),
                })?;
                let outline = Outline::new(scene, surface);
                let reflectance = surface.reflectance[channel];
                let origin = open.origin();
                let cells = surface::with_field(&outline, reflectance, &origin, |field| {
                    let cells = parts.iter();
                    cells
                        .map(|corners| Cell::evaluate(*corners, field))
                        .collect()
                });
                Ok(Reflector {
                    outline,
                    reflectance,
                    cells,
                })
            })
            .collect();
        open.reflectors = reflectors?;
        Ok(open)
    }

    fn origin(&self) -> Origin<'_> {
        Origin {
            rule: &self.rule,
            luminaires: &self.luminaires,
            channel: self.channel,
            kept: &self.kept,
        }
    }

    /// `Σ ρ ∫ E_direct dA`.
    pub(super) fn unshot(&self) -> f64 {
        PI * self.reflectors.iter().map(Reflector::flux).sum::<f64>()
    }

    /// Irradiance by light reflected exactly once.
    pub(super) fn reflected(&self, receiver: &Receiver) -> f64 {
        let rough: f64 = self.reflectors.iter().map(|r| r.rough(receiver)).sum();
        if rough <= 0.0 {
            return 0.0;
        }
        let origin = self.origin();
        let parts = self.reflectors.iter();
        parts
            .map(|reflector| reflector.receive(&origin, receiver, TOLERANCE * rough))
            .sum()
    }
}
