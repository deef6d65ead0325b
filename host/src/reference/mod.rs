//! The judge: irradiance in f64, converged.
//!
//! Shares no formula, clip or visibility code with the kernel that it
//! judges. Surfaces emit and reflect on their front and occlude from both
//! sides; a surface never occludes a point on its own plane, nor light from
//! it.
//!
//! * Direct light is analytic in any scene, `E = Σ π L F` over the visible
//!   parts of the luminaires ([`form_factor()`]).
//! * Light reflected once in a scene whose surfaces and named points nothing
//!   can come between: adaptive product Gauss rules, to 1e-9. A point asked
//!   for elsewhere, behind one of the surfaces, gets its direct light right,
//!   but reflected light as if the surface were not there.
//! * Everything else: Galerkin radiosity with exact visibility and a final
//!   gather, on meshes refined until two agree to 0.1 %.
//!
//! A point within rounding of a surface's plane, or behind it, receives
//! nothing from that surface.

mod cache;
mod cell;
mod convex;
mod exposed;
mod form_factor;
mod gather;
mod lookout;
mod luminaire;
mod open;
mod parallel;
mod partition;
mod patch;
mod polynomial;
mod probes;
mod refine;
mod request;
mod room;
mod rule;
mod surface;
mod transfer;
mod tree;
mod visible;

use std::fmt;
use std::path::Path;

use glam::DVec3;

use crate::scene::Scene;
use crate::scene::requires::requirements;
use open::Open;
use patch::Receiver;
use room::Room;

pub use form_factor::{form_factor, form_factor_signed};
pub use lookout::{Looked, Lookout};
pub use request::{Error, Reflections};

/// What is promised for direct light, and for light reflected at most once
/// where nothing occludes.
const PROMISED: f64 = 1e-9;

/// Agreement of two meshes at which the finer one is good enough.
const AGREEMENT: f64 = 1e-3;

/// Most generations before the light is said not to die out.
const MOST_GENERATIONS: usize = 10_000;

/// The converged irradiance of a scene.
pub struct Reference {
    room: Room,
    /// Light reflected once, for each channel, where nothing occludes.
    open: Vec<Open>,
    channels: usize,
    /// Whether the light asked for needs the room solved.
    needs_room: bool,
}

impl fmt::Debug for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reference")
            .field("channels", &self.channels)
            .field("reflections", &self.reflections())
            .field("accuracy", &self.accuracy())
            .finish_non_exhaustive()
    }
}

impl Reference {
    /// Prepares the reference for a scene. Every surface of positive radiance
    /// emits, every one of positive reflectance reflects, every one occludes.
    ///
    /// `progress` is told the done share, 0 to 1. Direct light is ready at
    /// once; reflected light takes up to a minute and a matrix of up to 576 MB
    /// where something occludes or light is reflected more than once. Such a
    /// solution is kept in the user's cache directory, or in the one that
    /// the environment variable `ISOLUX_CACHE` names, and found there the
    /// next time.
    ///
    /// # Errors
    ///
    /// [`Error`] where a fraction makes no sense, a polygon crosses itself,
    /// there are too many surfaces, or the light does not die out.
    pub fn new(
        scene: &Scene,
        reflections: Reflections,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, Error> {
        match cache::directory() {
            Some(directory) => Self::kept_in(&directory, scene, reflections, progress),
            None => Self::to_within(scene, reflections, AGREEMENT, progress),
        }
    }

    /// As [`Reference::new`] with the solution kept in `directory`, which is made
    /// if need be. The same bits, found or solved.
    ///
    /// # Errors
    ///
    /// As [`Reference::new`]; a directory that cannot be used is none.
    pub fn kept_in(
        directory: &Path,
        scene: &Scene,
        reflections: Reflections,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, Error> {
        let mut reference = Self::begin(scene, reflections, progress)?;
        if reference.needs_room {
            let key = cache::Key::new(scene, reflections);
            if !cache::load(directory, &key, &mut reference.room) {
                // Of a file that does not fit something may have been put in.
                reference.room = Room::new(scene, reference.channels)?;
                reference.room.solve(reflections, AGREEMENT, progress)?;
                cache::store(directory, key, &reference.room);
            }
        }
        progress(1.0);
        Ok(reference)
    }

    /// As [`Reference::new`], refining until two meshes agree to within
    /// `agreement` (relative, root of the mean square over points spread over
    /// the scene) instead of 0.1 %, and kept nowhere. A large one is quick and
    /// rough; light that needs no mesh is exact whatever it is.
    ///
    /// # Errors
    ///
    /// As [`Reference::new`].
    pub fn to_within(
        scene: &Scene,
        reflections: Reflections,
        agreement: f64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, Error> {
        let mut reference = Self::begin(scene, reflections, progress)?;
        if reference.needs_room {
            reference.room.solve(reflections, agreement, progress)?;
        }
        progress(1.0);
        Ok(reference)
    }

    /// All that takes no time.
    fn begin(
        scene: &Scene,
        reflections: Reflections,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, Error> {
        if let Reflections::UntilUnshot(fraction) = reflections
            && (fraction.is_nan() || fraction <= 0.0)
        {
            return Err(Error::Fraction(fraction));
        }
        progress(0.0);
        let needs = requirements(scene);
        let mut reference = Self {
            room: Room::new(scene, needs.channels)?,
            open: Vec::new(),
            channels: needs.channels,
            needs_room: false,
        };
        match reflections {
            Reflections::AtMost(0) => {}
            Reflections::AtMost(1) if needs.visibility.is_none() => {
                let channels = 0..needs.channels;
                let open: Result<Vec<Open>, Error> =
                    channels.map(|channel| Open::new(scene, channel)).collect();
                reference.open = open?;
                reference.open.retain(|open| open.unshot() > 0.0);
            }
            _ => reference.needs_room = true,
        }
        Ok(reference)
    }

    /// Irradiance (W m⁻², or lx in a photometric scene) in the first channel of
    /// a differential area at `position` (metres) facing `normal` (any length
    /// but 0). The whole answer where a scene is grey; see [`Reference::light`]
    /// for one that is not.
    ///
    /// To within [`Reference::accuracy`]. Cost: a few microseconds for direct
    /// light; with reflections some tens where nothing occludes and up to
    /// milliseconds in a room.
    #[must_use]
    pub fn irradiance(&self, position: DVec3, normal: DVec3) -> f64 {
        self.light(position, normal)[0]
    }

    /// Irradiance in all three channels, which are equal where the scene is
    /// grey; otherwise as [`Reference::irradiance`].
    #[must_use]
    pub fn light(&self, position: DVec3, normal: DVec3) -> [f64; 3] {
        let Some(normal) = normal.try_normalize() else {
            return [0.0; 3];
        };
        let receiver = Receiver { position, normal };
        let mut light = if self.open.is_empty() {
            self.room.light(&receiver)
        } else {
            self.room.direct(&receiver)
        };
        for open in &self.open {
            light[open.channel] += open.reflected(&receiver);
        }
        if self.channels == 1 {
            [light[0]; 3]
        } else {
            light
        }
    }

    /// [`Reference::irradiance`] at many points (position, normal), on all
    /// processors: the same bits in the same order as one by one.
    #[must_use]
    pub fn irradiance_at(&self, points: &[(DVec3, DVec3)]) -> Vec<f64> {
        self.light_at(points).iter().map(|light| light[0]).collect()
    }

    /// [`Reference::light`] at many points (position, normal), on all
    /// processors: the same bits in the same order as one by one.
    #[must_use]
    pub fn light_at(&self, points: &[(DVec3, DVec3)]) -> Vec<[f64; 3]> {
        let mut values = vec![[0.0; 3]; points.len()];
        parallel::rows(values.as_flattened_mut(), 3, |index, value| {
            let (position, normal) = points[index];
            value.copy_from_slice(&self.light(position, normal));
        });
        values
    }

    /// How often the counted light is reflected at most.
    #[must_use]
    pub fn reflections(&self) -> usize {
        if self.open.is_empty() {
            self.room.reflections
        } else {
            1
        }
    }

    /// The relative error of an irradiance.
    ///
    /// For direct light, and for light reflected at most once where nothing
    /// occludes, 1e-9 is promised (of the surfaces' mean effect on the point,
    /// where the point sees only what is much darker than the mean). Otherwise
    /// it is what was measured: how much the two finest meshes differ, as the
    /// root of the mean square over points spread over the reflecting surfaces.
    #[must_use]
    pub fn accuracy(&self) -> f64 {
        self.room.accuracy
    }
}
