//! Light that changes while the device runs, in integers: a luminaire is dimmed.
//!
//! As in floating point ([`shoot`](crate::shoot)) what differs from what was shot is
//! unshot, with its sign. The light is then that of the scene as if it had been baked so,
//! but for what the stop rule leaves, and half a unit of irradiance a shot.

use super::fraction::{exitance, radiance};
use super::light::Light;
use super::radiosity::Radiosity;
use super::transfer::Transfer;
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::Format;
use crate::shoot::{Solved, Stop, onwards};

impl<F: Format, const SAMPLES: usize, const EMITTERS: usize, T: Transfer>
    Light<'_, F, SAMPLES, EMITTERS, T>
{
    /// Sets the radiance L of a luminaire in W m⁻² sr⁻¹ (cd m⁻² in a photometric scene),
    /// read by its bits: no floating-point operation.
    ///
    /// Luminaires are the first emitters of the tables, the surfaces that emit in the order
    /// of the scene file. No light changes before [`update`](Self::update) or
    /// [`solve`](Self::solve). The unit of irradiance was chosen for the radiances that
    /// were baked, with room for twice as much: bake a scene at its brightest.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such luminaire; [`Error::Number`] where the
    /// radiance is not finite, below 0, or above twice the one that was baked. The
    /// radiance is then what it was.
    pub fn set_radiance(&mut self, luminaire: usize, radiance: f32) -> Result<(), Error> {
        let scene = self.scene();
        let unknown = Error::Unknown {
            what: What::Luminaires,
            asked: luminaire as u32,
            have: scene.counts().luminaires,
        };
        let found = self.emitters.get_mut(luminaire);
        let emitter = found.filter(|_| scene.is_luminaire(luminaire));
        let emitter = emitter.ok_or(unknown)?;
        let baked = scene.exitance(luminaire).unsigned_abs();
        // Twice as much, and what rounding to single precision adds.
        let most = baked.saturating_mul(2).saturating_add(baked >> 20);
        let set = exitance(radiance, scene.header().exitance());
        match set.and_then(|set| i32::try_from(set).ok()) {
            Some(set) if set.unsigned_abs() <= most => {
                emitter.due = uniform(set);
                Ok(())
            }
            _ => Err(Error::Number {
                what: What::Luminaires,
                record: luminaire as u32,
            }),
        }
    }

    /// The radiance L of a luminaire in W m⁻² sr⁻¹ as it is set now, rounded to single
    /// precision; 0 where there is no such luminaire. Made of bits, without a
    /// floating-point operation.
    pub fn radiance(&self, luminaire: usize) -> f32 {
        let unit = self.tables().header().exitance();
        radiance(self.exitance(luminaire).unsigned_abs(), unit)
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
        let mut direct = 0_u32;
        for index in 0..self.tables().counts().luminaires as usize {
            direct = direct.saturating_add(u32::from(self.send(index)));
        }
        let shots = onwards(stop, direct, self);
        self.solved(shots)
    }

    /// Whether any luminaire is on.
    fn emits(&self) -> bool {
        let mut luminaires = 0..self.tables().counts().luminaires as usize;
        luminaires.any(|index| self.exitance(index) > 0)
    }

    /// The emitted radiosity of an emitter as it is set now; 0 for one that only
    /// reflects.
    pub(super) fn exitance(&self, index: usize) -> i32 {
        match self.emitters.get(index) {
            Some(emitter) if self.tables().is_luminaire(index) => emitter.due.mean(),
            _ => 0,
        }
    }

    /// Sets radiances to what they were baked as.
    pub(super) fn restore(&mut self) {
        let scene = self.scene();
        let luminaires = scene.counts().luminaires as usize;
        for (index, emitter) in self.emitters.iter_mut().take(luminaires).enumerate() {
            emitter.due = uniform(scene.exitance(index));
        }
    }
}

/// The same everywhere on an emitter.
fn uniform<R: Radiosity>(mean: i32) -> R {
    R::of(|coefficient| if coefficient == 0 { mean } else { 0 })
}
