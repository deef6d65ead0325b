//! Light on its way, in integers: the state and the orders of
//! [`shoot`](crate::shoot), which see.

use super::fraction::{ratio, single, threshold};
use super::scene::Scene;
use super::tables::LARGEST_SHIFT;
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::{Format, Receiver};
use crate::scene::records::Counts;
use crate::shoot::{Shooting, Solved, Stop, until};
use core::marker::PhantomData;
use heapless::Vec;

/// The light in a scene, for at most `SAMPLES` samples and `EMITTERS` emitters.
///
/// `F` is the rung, [`Q29`](super::Q29) or [`Q24`](super::Q24); the tables are
/// the same for both. RAM: [`light_bytes`].
#[derive(Clone, Debug)]
pub struct Light<'t, F, const SAMPLES: usize, const EMITTERS: usize> {
    scene: Scene<'t>,
    /// Irradiance of every sample.
    irradiance: Vec<u32, SAMPLES>,
    emitters: Vec<Shot, EMITTERS>,
    /// Form factors evaluated since the scene was dark.
    form_factors: u32,
    format: PhantomData<F>,
}

/// What one emitter has done, in the unit of its own radiosity.
#[derive(Clone, Copy, Debug)]
struct Shot {
    /// Radiosity shot so far.
    shot: u32,
    /// Radiosity to be shot in the present generation.
    pending: u32,
}

impl Shot {
    const NOTHING: Self = Self {
        shot: 0,
        pending: 0,
    };
}

/// Bytes of RAM that [`Light`] takes on a 32-bit part: 4 a sample, 8 an emitter,
/// and 80 for the borrowed tables and the counts.
///
/// Exact on thumb targets: the firmware does not compile where `size_of` differs.
pub const fn light_bytes(counts: &Counts) -> usize {
    4 * counts.samples as usize + 8 * counts.emitters as usize + 80
}

impl<'t, F: Format, const SAMPLES: usize, const EMITTERS: usize> Light<'t, F, SAMPLES, EMITTERS> {
    /// A dark scene, ready to be lit.
    ///
    /// # Errors
    /// [`Error::Capacity`] where the scene has more samples or emitters than
    /// the type holds.
    pub fn new(scene: Scene<'t>) -> Result<Self, Error> {
        let mut light = Self::empty();
        light.enter(scene)?;
        Ok(light)
    }

    /// The state of no scene at all, to be made in a `static`, so that however
    /// large it is it passes no stack; [`enter`](Self::enter) gives it a scene.
    pub const fn empty() -> Self {
        Self {
            scene: Scene::EMPTY,
            irradiance: Vec::new(),
            emitters: Vec::new(),
            form_factors: 0,
            format: PhantomData,
        }
    }

    /// Takes a scene in place of the one before: dark, ready to be lit.
    ///
    /// # Errors
    /// As [`new`](Self::new); it then has no scene.
    pub fn enter(&mut self, scene: Scene<'t>) -> Result<(), Error> {
        let full = |what, needed: usize, have: usize| Error::Capacity {
            what,
            needed: needed as u32,
            have: have as u32,
        };
        self.scene = Scene::EMPTY;
        self.irradiance.clear();
        self.emitters.clear();
        self.form_factors = 0;
        let (samples, emitters) = (scene.samples().len(), scene.emitters().len());
        if samples > SAMPLES {
            return Err(full(What::Samples, samples, SAMPLES));
        }
        if emitters > EMITTERS {
            return Err(full(What::Emitters, emitters, EMITTERS));
        }
        let filled = self.irradiance.resize(samples, 0).is_ok()
            && self.emitters.resize(emitters, Shot::NOTHING).is_ok();
        if filled {
            self.scene = scene;
        }
        Ok(())
    }

    /// The scene.
    pub fn scene(&self) -> Scene<'t> {
        self.scene
    }

    /// Irradiance of every sample in the tables' unit, in their order.
    pub fn irradiance(&self) -> &[u32] {
        &self.irradiance
    }

    /// Takes all light away.
    pub fn darken(&mut self) {
        self.irradiance.fill(0);
        self.emitters.fill(Shot::NOTHING);
        self.form_factors = 0;
    }

    /// Darkens the scene and lets every luminaire shoot. Returns the number of
    /// shots. Cost: one form factor per luminaire and sample.
    pub fn direct(&mut self) -> u32 {
        self.darken();
        self.reflect()
    }

    /// Lets every emitter shoot what reached it since it last shot: one more
    /// reflection of all light. Returns the number of shots.
    pub fn reflect(&mut self) -> u32 {
        for index in 0..self.emitters.len() {
            let pending = self.unshot(index);
            if let Some(emitter) = self.emitters.get_mut(index) {
                emitter.pending = pending;
            }
        }
        let mut shots = 0_u32;
        for index in 0..self.emitters.len() {
            let pending = self.emitters.get(index).map_or(0, |state| state.pending);
            if pending > 0 {
                self.send(index, pending);
                shots = shots.saturating_add(1);
            }
        }
        shots
    }

    /// Lets the emitter with the largest unshot power shoot. Returns its index,
    /// or `None` where nothing is left.
    pub fn shoot(&mut self) -> Option<usize> {
        let mut best = None;
        let mut largest = 0;
        for index in 0..self.emitters.len() {
            let power = self.power(index, self.unshot(index));
            if power > largest {
                (best, largest) = (Some(index), power);
            }
        }
        let index = best?;
        let radiosity = self.unshot(index);
        self.send(index, radiosity);
        Some(index)
    }

    /// Darkens the scene and lights it until `stop`.
    ///
    /// Cost: one form factor per shot and sample; at most as many shots as
    /// `stop` allows, `EMITTERS` for each reflection.
    pub fn solve(&mut self, stop: Stop) -> Solved {
        let shots = until(stop, self);
        Solved {
            shots,
            form_factors: self.form_factors,
            unshot: self.unshot_fraction(),
        }
    }

    /// Power not yet shot as a fraction of the emitted power, in steps of 2⁻³¹;
    /// 0 in a dark scene. Made of bits, without a floating-point operation.
    pub fn unshot_fraction(&self) -> f32 {
        single(self.unshot_ratio())
    }

    /// [`unshot_fraction`](Self::unshot_fraction) in units of 2⁻³¹, saturated
    /// below 2.
    pub fn unshot_ratio(&self) -> u32 {
        /// Powers have 64 bits; so many of them must have a sum.
        const FEWER: u32 = 16;
        let (mut unshot, mut emitted) = (0_u64, 0_u64);
        for index in 0..self.emitters.len() {
            let power = |radiosity| self.power(index, radiosity) >> FEWER;
            unshot = unshot.saturating_add(power(self.unshot(index)));
            emitted = emitted.saturating_add(power(self.scene.exitance(index)));
        }
        ratio(unshot, emitted)
    }

    /// The radiosity that an emitter has shot so far, in the unit of irradiance
    /// (a luminaire: of exitance); 0 where there is no such emitter.
    pub fn radiosity(&self, emitter: usize) -> u32 {
        self.emitters.get(emitter).map_or(0, |state| state.shot)
    }

    /// The irradiance at any place in the tables' unit, from everything that has
    /// been shot. It may exceed a word: no sample need be as bright.
    ///
    /// Cost: one form factor per emitter that has shot. The answer depends on
    /// the receiver alone. Never panics.
    pub fn at(&self, receiver: &Receiver<F>) -> u64 {
        let mut sum = 0_u64;
        let emitters = self.scene.emitters();
        for (index, (emitter, state)) in emitters.iter().zip(&self.emitters).enumerate() {
            if state.shot > 0 {
                let factor = self.scene.form_factor(receiver, emitter);
                sum = sum.saturating_add(arriving(state.shot, factor, self.shift(index)));
            }
        }
        sum
    }

    /// By how many powers of two the unit of an emitter's radiosity is larger
    /// than that of irradiance.
    fn shift(&self, emitter: usize) -> u32 {
        match self.scene.is_luminaire(emitter) {
            true => self.scene.header().shift,
            false => 0,
        }
    }

    /// A radiosity of an emitter times its area, in units of exitance and area.
    fn power(&self, emitter: usize, radiosity: u32) -> u64 {
        let area = self.scene.emitters().get(emitter).map_or(0, |e| e.area);
        let down = self.scene.header().shift.wrapping_sub(self.shift(emitter));
        u64::from(radiosity).wrapping_mul(area.into()) >> (down & 63)
    }

    /// Radiosity of an emitter that it has not yet shot. Rounding may have let
    /// it shoot more than it has; that is none.
    fn unshot(&self, index: usize) -> u32 {
        let all = match self.scene.is_luminaire(index) {
            true => self.scene.exitance(index),
            false => self.reflected(index),
        };
        all.saturating_sub(self.radiosity(index))
    }

    /// ρ times the mean irradiance of the emitter's members, each rounded to
    /// nearest.
    fn reflected(&self, index: usize) -> u32 {
        let Some(emitter) = self.scene.emitters().get(index) else {
            return 0;
        };
        let members = self.scene.members_of(emitter);
        let mut sum = 0_u64;
        for &sample in members {
            let irradiance = self.irradiance.get(usize::from(sample));
            sum = sum.wrapping_add(irradiance.copied().unwrap_or(0).into());
        }
        let count = members.len() as u64;
        let mean = sum.wrapping_add(count >> 1).checked_div(count).unwrap_or(0);
        let reflectance = u64::from(self.scene.reflectance(emitter.surface as usize));
        // The mean of words is a word, so this is below 2^64 − 2^32.
        (mean.wrapping_mul(reflectance).wrapping_add(1 << 31) >> 32) as u32
    }

    /// Adds what every sample receives from this much radiosity.
    fn send(&mut self, index: usize, radiosity: u32) {
        let (scene, shift) = (self.scene, self.shift(index));
        let Some((emitter, front)) = scene
            .emitters()
            .get(index)
            .and_then(|emitter| Some((emitter, scene.front(emitter)?)))
        else {
            return;
        };
        for (number, surface) in (0_u32..).zip(scene.surfaces()) {
            if number == emitter.surface {
                continue; // a planar polygon does not light its own plane
            }
            let (first, places) = scene.samples_of(surface);
            let Ok(facing) = Receiver::<F>::new(surface.origin, surface.normal) else {
                continue; // checked tables have no normal of length 0
            };
            self.form_factors = self.form_factors.saturating_add(places.len() as u32);
            let values = self.irradiance.get_mut(first..).unwrap_or_default();
            for (value, &place) in values.iter_mut().zip(places) {
                let receiver = facing.moved_to(surface.place(place));
                let factor = scene.form_factor_before(&receiver, &front, emitter);
                let more = arriving(radiosity, factor, shift);
                *value = value.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
            }
        }
        if let Some(state) = self.emitters.get_mut(index) {
            state.shot = state.shot.saturating_add(radiosity);
        }
    }
}

impl<F: Format, const SAMPLES: usize, const EMITTERS: usize> Shooting
    for Light<'_, F, SAMPLES, EMITTERS>
{
    fn direct(&mut self) -> u32 {
        Light::direct(self)
    }

    fn reflect(&mut self) -> u32 {
        Light::reflect(self)
    }

    fn shoot(&mut self) -> bool {
        Light::shoot(self).is_some()
    }

    fn shoot_above(&mut self, fraction: f32) -> bool {
        i64::from(self.unshot_ratio()) > threshold(fraction) && Shooting::shoot(self)
    }
}

/// Radiosity times form factor, 2^`shift` times as many units of irradiance,
/// rounded to nearest: less than 2^48.
#[inline]
fn arriving<F: Format>(radiosity: u32, factor: F, shift: u32) -> u64 {
    // At least 2^−24 is the factor's unit, at most 2^16 the shift.
    const { assert!(LARGEST_SHIFT < 24) };
    let down = F::FRACTION.wrapping_sub(shift) & 63;
    let product = u64::from(radiosity).wrapping_mul(factor.to_bits() as u64);
    (product >> (down.wrapping_sub(1) & 63)).wrapping_add(1) >> 1
}
