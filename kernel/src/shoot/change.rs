//! Light that changes while the device runs: luminaires are dimmed, a wall is
//! painted.
//!
//! Only what is to have been shot changes; what differs from what was shot is
//! unshot, with its sign, and [`Light::update`] shoots it. The light is then that of
//! the scene as if it had been baked so, but for
//!
//! * what the stop rule leaves, which is a part of what is emitted *now*; and
//! * rounding: every shot, of a difference too, rounds the irradiance that it adds
//!   to, by 2⁻²⁴ of the brightest that the sample has been since the scene was dark.
//!   After the first solution and n updates of k shots it errs by up to (n + 1) k
//!   2⁻²⁴ of that, and being random by about the root of it. [`Light::solve`]
//!   begins anew, without any.

use super::onwards;
use super::{Light, Solved, Stop};
use crate::Error;
use crate::error::What;
use crate::form_factor::Arithmetic;
use crate::luminance::{Colour, Luminance};
use crate::scene::{BRIGHTEST, Scene};
use crate::transfer::Transfer;
use core::f32::consts::{FRAC_1_PI, PI};

impl<'t, A, const SAMPLES: usize, const EMITTERS: usize, L, V, const SURFACES: usize>
    Light<'t, A, SAMPLES, EMITTERS, L, V, SURFACES>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    /// Sets the radiance L of a luminaire in W m⁻² sr⁻¹ (cd m⁻² in a photometric
    /// scene), one value a channel.
    ///
    /// Luminaires are the first emitters of the tables, the surfaces that emit in
    /// the order of the scene file. No light changes before [`update`](Self::update)
    /// or [`solve`](Self::solve). Takes no time to speak of.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such luminaire; [`Error::Number`] where
    /// a channel is not finite, below 0, or π L above 1e21 W m⁻², the brightest that
    /// tables may hold. The radiance is then what it was.
    pub fn set_radiance(&mut self, luminaire: usize, radiance: L::Colour) -> Result<(), Error> {
        let have = self.tables().counts().luminaires;
        let found = self.emitters.get_mut(luminaire);
        let Some(emitter) = found.filter(|_| luminaire < have as usize) else {
            return Err(Error::Unknown {
                what: What::Luminaires,
                asked: luminaire as u32,
                have,
            });
        };
        let exitance = radiance.times(PI);
        if !exitance.all(|m| (0.0..=BRIGHTEST).contains(&m)) {
            return Err(Error::Number {
                what: What::Luminaires,
                record: luminaire as u32,
            });
        }
        emitter.due = L::uniform(exitance);
        Ok(())
    }

    /// The radiance L of a luminaire in W m⁻² sr⁻¹ as it is set now, to within a
    /// rounding; dark where there is no such luminaire.
    pub fn radiance(&self, luminaire: usize) -> L::Colour {
        self.exitance(luminaire).times(FRAC_1_PI)
    }

    /// Sets the diffuse reflectance of a surface, one value a channel.
    ///
    /// No light changes before [`update`](Self::update) or [`solve`](Self::solve).
    /// What surfaces receive does not depend on their reflectances, so every
    /// transfer rung that computes what is reflected holds for the new ones. A
    /// surface that was baked with a reflectance of 0 has no patches to reflect
    /// with, and stays black.
    ///
    /// # Errors
    /// [`Error::Capacity`] where this type keeps the reflectances that were baked;
    /// [`Error::Unknown`] for [`Vectors`](crate::transfer::Vectors), which hold for
    /// these alone, and where there is no such surface; [`Error::Number`] unless
    /// 0 ≤ ρ < 1 in every channel. The reflectance is then what it was.
    pub fn set_reflectance(&mut self, surface: usize, reflectance: L::Colour) -> Result<(), Error> {
        let (asked, have) = (surface as u32, self.tables().counts().surfaces);
        let what = What::Surfaces;
        if SURFACES == 0 {
            let needed = have;
            return Err(Error::Capacity {
                what,
                needed,
                have: 0,
            });
        }
        if V::is_in_the_end(self.tables()) {
            return Err(Error::Unknown {
                what: What::Reflectances,
                asked,
                have: 0,
            });
        }
        let found = self.reflectances.get_mut(surface);
        let Some(place) = found.filter(|_| asked < have) else {
            return Err(Error::Unknown { what, asked, have });
        };
        if !reflectance.all(|rho| (0.0..1.0).contains(&rho)) {
            return Err(Error::Number {
                what: What::Reflectances,
                record: asked,
            });
        }
        *place = reflectance;
        Ok(())
    }

    /// The diffuse reflectance of a surface as it is now; dark where there is no
    /// such surface.
    #[inline(always)]
    pub fn reflectance(&self, surface: usize) -> L::Colour {
        if SURFACES == 0 {
            return self.tables().reflectance(surface);
        }
        let found = self.reflectances.get(surface).copied();
        found.unwrap_or(L::Colour::DARK)
    }

    /// Shoots what has changed, on top of the light there is, until `stop`: below a
    /// fraction of what is emitted now, after so many shots more, or after all of it
    /// was reflected so many times more.
    ///
    /// Begins with the direct light of the luminaires that changed. Where nothing
    /// emits any more the scene is dark, exactly. Cost: one form factor per shot and
    /// sample, and fewer shots than [`solve`](Self::solve) takes, the less there is
    /// that changed. The counts are those of this update.
    pub fn update(&mut self, stop: Stop) -> Solved {
        if !self.emits() {
            self.darken();
        }
        self.form_factors = 0;
        let direct = self.relight();
        let shots = onwards(stop, direct, self);
        self.solved(shots)
    }

    /// Lets the luminaires alone shoot what they have not; the number of shots.
    ///
    /// By itself: what a shot takes on the stack is not kept while others are shot.
    #[inline(never)]
    fn relight(&mut self) -> u32 {
        let mut shots = 0_u32;
        for index in 0..self.tables().counts().luminaires as usize {
            shots = shots.saturating_add(u32::from(self.send(index)));
        }
        shots
    }

    /// Whether any luminaire is on.
    fn emits(&self) -> bool {
        let mut luminaires = 0..self.tables().counts().luminaires as usize;
        luminaires.any(|index| self.exitance(index).total() > 0.0)
    }

    /// The emitted radiosity π L of an emitter; dark for one that only reflects.
    pub(super) fn exitance(&self, index: usize) -> L::Colour {
        match self.emitters.get(index) {
            Some(emitter) if self.tables().is_luminaire(index) => emitter.due.mean(),
            _ => L::Colour::DARK,
        }
    }

    /// Sets radiances and reflectances to what they were baked as.
    pub(super) fn restore(&mut self) {
        // In place: what is not borrowed as a whole may change meanwhile.
        let scene = self.scene.as_ref().unwrap_or(&Scene::EMPTY);
        let luminaires = scene.counts().luminaires as usize;
        for (index, emitter) in self.emitters.iter_mut().take(luminaires).enumerate() {
            emitter.due = L::uniform(scene.exitance(index));
        }
        for (surface, reflectance) in self.reflectances.iter_mut().enumerate() {
            *reflectance = scene.reflectance(surface);
        }
    }
}
