//! What has not been shot yet.

use super::Light;
use crate::form_factor::Arithmetic;
use crate::luminance::{Colour, Luminance};
use crate::scene::BRIGHTEST;
use crate::transfer::Transfer;

/// What has not been shot.
pub(super) struct Left {
    /// Its power as a fraction of the emitted power.
    pub(super) fraction: f32,
    /// The emitter that has most of it; `None` where nothing is left.
    pub(super) brightest: Option<usize>,
}

impl<A, const SAMPLES: usize, const EMITTERS: usize, L, V> Light<'_, A, SAMPLES, EMITTERS, L, V>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    /// Power not yet shot as a fraction of the emitted power; 0 in a dark
    /// scene.
    pub fn unshot_fraction(&self) -> f32 {
        self.left().fraction
    }

    /// What has not been shot.
    pub(super) fn left(&self) -> Left {
        // A power of two that changes no digit of the fraction keeps the
        // largest powers finite: 1e21 W m⁻² from 1e17 m² of 65 536 emitters.
        const SCALE: f32 = 1.0 / (1 << 24) as f32;
        let (mut unshot, mut emitted, mut most) = (0.0, 0.0, 0.0);
        let mut brightest = None;
        for (index, emitter) in self.tables().emitters().iter().enumerate() {
            let radiosity = L::strength(self.unshot_mean(index));
            unshot += if radiosity > 0.0 { radiosity } else { 0.0 } * SCALE * emitter.area;
            // Not scaled: the smallest powers must be told apart.
            let power = radiosity * emitter.area;
            if power > most {
                (brightest, most) = (Some(index), power);
            }
            let exitance = self.tables().exitance::<L::Colour>(index).total();
            emitted += exitance * SCALE * emitter.area;
        }
        Left {
            fraction: if emitted > 0.0 { unshot / emitted } else { 0.0 },
            brightest,
        }
    }

    /// Radiosity of an emitter that it has not yet shot.
    ///
    /// In tables of an impossible scene more may arrive than was sent, and
    /// grow: it is held where every sum of it is finite. A constant radiosity is
    /// not below 0, which only rounding makes it; a linear one may be in a
    /// channel where its samples' fit is.
    pub(super) fn unshot(&self, index: usize) -> L {
        let Some(state) = self.emitters.get(index) else {
            return L::DARK;
        };
        let exitance = L::uniform(self.tables().exitance(index));
        exitance
            .zip(self.reflected(index), Colour::plus)
            .zip(state.shot, |all, shot| all.zip(shot, Self::held))
    }

    /// The mean of [`unshot`](Self::unshot), to the bit, for a third of its cost.
    fn unshot_mean(&self, index: usize) -> L::Colour {
        let (Some(state), Some(emitter)) = (
            self.emitters.get(index),
            self.tables().emitters().get(index),
        ) else {
            return L::Colour::DARK;
        };
        let exitance = self.tables().exitance::<L::Colour>(index);
        let mut mean = L::Colour::DARK;
        if emitter.members > 0 {
            for (sample, weights) in self.tables().members_of(emitter) {
                let irradiance = self.irradiance.get(sample).copied();
                let irradiance = irradiance.unwrap_or(L::Colour::DARK);
                mean = mean.plus(match weights.first() {
                    Some(&weight) => irradiance.times(weight),
                    None => irradiance,
                });
            }
            if !L::WEIGHTED {
                mean = mean.map(|sum| sum / emitter.members as f32);
            }
            let reflectance = self
                .tables()
                .reflectance::<L::Colour>(emitter.surface as usize);
            mean = mean.zip(reflectance, |e, rho| rho * e);
        }
        let all = exitance.plus(mean);
        all.zip(state.shot.mean(), Self::held)
    }

    /// `all` less `shot`, held.
    fn held(all: f32, shot: f32) -> f32 {
        let lowest = if L::WEIGHTED { -BRIGHTEST } else { 0.0 };
        let value = all - shot;
        if value > BRIGHTEST {
            BRIGHTEST
        } else if value > lowest {
            value
        } else {
            lowest
        }
    }

    /// ρ times the irradiance of the emitter's members: their mean, or what
    /// their weights make of it.
    fn reflected(&self, index: usize) -> L {
        let Some(emitter) = self.tables().emitters().get(index) else {
            return L::DARK;
        };
        if emitter.members == 0 {
            return L::DARK;
        }
        let mut sum = L::DARK;
        for (sample, weights) in self.tables().members_of(emitter) {
            let irradiance = self.irradiance.get(sample).copied();
            sum = sum.gather(irradiance.unwrap_or(L::Colour::DARK), weights);
        }
        let reflectance = self
            .tables()
            .reflectance::<L::Colour>(emitter.surface as usize);
        sum.gathered(emitter.members as usize)
            .zip(L::DARK, |all, _| all.zip(reflectance, |e, rho| rho * e))
    }
}
