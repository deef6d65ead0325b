//! What has not been shot yet, in integers.

use super::fraction::{of_all, ratio, single, threshold};
use super::light::Light;
use super::radiosity::Radiosity;
use super::scene::Scene;
use super::tables::Emitter;
use super::transfer::{Transfer, saturated};
use crate::form_factor::fixed_point::Format;

/// Powers have 64 bits; so many of them must have a sum.
const FEWER: u32 = 16;

/// What has not been shot.
pub(super) struct Left {
    /// Its power and the emitted power, without the last [`FEWER`] bits.
    unshot: u64,
    emitted: u64,
    /// The emitter that has most of it; `None` where nothing is left.
    pub(super) brightest: Option<usize>,
}

impl Left {
    /// As a fraction of the emitted power in 2⁻³¹; 1 where nothing emits any more and
    /// light is still about.
    fn ratio(&self) -> u32 {
        match (self.emitted, self.unshot) {
            (0, 0) => 0,
            (0, _) => 1 << 31,
            _ => ratio(self.unshot, self.emitted),
        }
    }

    fn is_above(&self, fraction: f32) -> bool {
        i64::from(self.ratio()) > threshold(fraction)
    }
}

impl<F: Format, const SAMPLES: usize, const EMITTERS: usize, T: Transfer>
    Light<'_, F, SAMPLES, EMITTERS, T>
{
    /// Power not yet shot as a fraction of the emitted power, in steps of 2⁻³¹; 0 in a
    /// dark scene, 1 where nothing emits any more and light is still about. Made of bits,
    /// without a floating-point operation.
    pub fn unshot_fraction(&self) -> f32 {
        single(self.unshot_ratio())
    }

    /// [`unshot_fraction`](Self::unshot_fraction) in units of 2⁻³¹, saturated
    /// below 2.
    pub fn unshot_ratio(&self) -> u32 {
        self.left().ratio()
    }

    /// What has not been shot.
    pub(super) fn left(&self) -> Left {
        let mut left = Left {
            unshot: 0,
            emitted: 0,
            brightest: None,
        };
        let mut most = 0;
        for (index, emitter) in self.tables().emitters().iter().enumerate() {
            let radiosity = self.unshot(index, emitter);
            let power = self.power(index, emitter, radiosity.strength());
            if power > most {
                (left.brightest, most) = (Some(index), power);
            }
            left.unshot = left.unshot.saturating_add(power >> FEWER);
            let emitted = self.power(index, emitter, self.exitance(index).unsigned_abs());
            left.emitted = left.emitted.saturating_add(emitted >> FEWER);
        }
        left
    }

    /// One shot of the emitter with the largest unshot power, if all of it is above this
    /// fraction of the emitted power.
    pub(super) fn shoot_if_above(&mut self, fraction: f32) -> bool {
        let left = self.left();
        let Some(index) = left.brightest.filter(|_| left.is_above(fraction)) else {
            return false;
        };
        self.settle(index);
        self.send(index)
    }

    /// Lets every emitter shoot in turn, as that of floating point does: those whose part
    /// in what is unshot may stay do not. The number of shots, at most `most`; 0 once it
    /// is below the fraction.
    pub(super) fn sweep(&mut self, fraction: f32, most: u32) -> u32 {
        let left = self.left();
        if !left.is_above(fraction) {
            return 0;
        }
        let least = of_all(left.emitted, threshold(fraction), self.emitters.len());
        let mut shots = 0_u32;
        for index in 0..self.emitters.len() {
            if shots >= most {
                break;
            }
            self.settle(index);
            let (Some(state), Some(emitter)) = (
                self.emitters.get(index),
                self.tables().emitters().get(index),
            ) else {
                break;
            };
            let pending = state.due.zip(state.shot, i32::saturating_sub);
            if self.power(index, emitter, pending.strength()) >> FEWER > least {
                shots = shots.saturating_add(u32::from(self.send(index)));
            }
        }
        shots
    }

    /// What an emitter is to have shot becomes what its samples receive now makes it
    /// reflect. A luminaire emits what it was set to.
    pub(super) fn settle(&mut self, index: usize) {
        let scene = self.scene();
        let Some(emitter) = scene.emitters().get(index) else {
            return;
        };
        if scene.is_luminaire(index) {
            return;
        }
        let due = self.all_reflected(emitter);
        if let Some(state) = self.emitters.get_mut(index) {
            state.due = due;
        }
    }

    /// What an emitter has not yet shot, below 0 where it has shot too much.
    fn unshot(&self, index: usize, emitter: &Emitter) -> T::Radiosity {
        let Some(state) = self.emitters.get(index) else {
            return T::Radiosity::DARK;
        };
        let all = match self.tables().is_luminaire(index) {
            true => state.due,
            false => self.all_reflected(emitter),
        };
        all.zip(state.shot, i32::saturating_sub)
    }

    fn all_reflected(&self, emitter: &Emitter) -> T::Radiosity {
        T::Radiosity::of(|k| self.reflected(self.tables(), emitter, k))
    }

    /// A radiosity of an emitter times its area, in units of exitance and area.
    fn power(&self, index: usize, emitter: &Emitter, radiosity: u32) -> u64 {
        let down = self.tables().header().shift;
        let down = down.wrapping_sub(self.shift(index)) & 63;
        u64::from(radiosity).wrapping_mul(emitter.area.into()) >> down
    }

    /// ρ times a coefficient of what the emitter's members receive, by their weights, or
    /// ρ times their mean; each rounded to nearest.
    #[inline(never)]
    fn reflected(&self, scene: &Scene<'_>, emitter: &Emitter, coefficient: usize) -> i32 {
        let irradiance = |&sample: &u16| {
            let irradiance = self.irradiance.get(usize::from(sample));
            i64::from(irradiance.copied().unwrap_or(0))
        };
        let members = scene.members_of(emitter).iter().map(irradiance);
        let mean = if T::Radiosity::COEFFICIENTS == 1 {
            let count = i64::from(emitter.members);
            let sum = members.fold(0, i64::wrapping_add);
            let rounded = sum.wrapping_add(count >> 1).checked_div_euclid(count);
            saturated(rounded.unwrap_or(0))
        } else {
            // Below 2^62: that was checked.
            let weighted = members.zip(scene.weights_of(emitter));
            let sum = weighted.fold(1 << 23, |sum: i64, (irradiance, weights)| {
                let weight = weights.get(coefficient).copied().unwrap_or(0);
                sum.wrapping_add(irradiance.wrapping_mul(weight.into()))
            });
            saturated(sum >> 24)
        };
        let reflectance = i64::from(scene.reflectance(emitter.surface as usize));
        // A word times a word: its upper one.
        (i64::from(mean)
            .wrapping_mul(reflectance)
            .wrapping_add(1 << 31)
            >> 32) as i32
    }
}
