//! Light on its way, in integers: the state and the orders of
//! [`shoot`](crate::shoot), which see.

use super::radiosity::Radiosity;
use super::scene::Scene;
use super::tables::LARGEST_SHIFT;
use super::transfer::{Computed, Transfer, part, saturated};
use crate::Error;
use crate::error::What;
use crate::form_factor::fixed_point::{Format, Receiver};
use crate::scene::records::Counts;
use crate::shoot::{Shooting, Solved, Stop, until};
use core::marker::PhantomData;
use heapless::Vec;

/// The light in a scene, for at most `SAMPLES` samples and `EMITTERS` emitters.
///
/// `F` is the rung of arithmetic, [`Q29`](super::Q29) or [`Q24`](super::Q24), the tables
/// are the same for both; `T` that of transfer, which the tables must be baked for.
/// RAM: [`light_bytes`].
#[derive(Clone, Debug)]
pub struct Light<'t, F, const SAMPLES: usize, const EMITTERS: usize, T: Transfer = Computed> {
    /// `None` is nothing but zeros: a `static` of an empty light takes no flash.
    scene: Option<Scene<'t>>,
    /// Irradiance of every sample.
    pub(super) irradiance: Vec<i32, SAMPLES>,
    pub(super) emitters: Vec<Shot<T::Radiosity>, EMITTERS>,
    /// Form factors evaluated since the scene was dark, or by the last update.
    pub(super) form_factors: u32,
    format: PhantomData<F>,
}

/// What one emitter has done, in the unit of its own radiosity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shot<R> {
    /// Radiosity shot so far.
    pub(super) shot: R,
    /// Radiosity that it is to have shot when the present generation ends; of a
    /// luminaire always what it emits.
    pub(super) due: R,
}

impl<R: Radiosity> Shot<R> {
    const NOTHING: Self = Self {
        shot: R::DARK,
        due: R::DARK,
    };
}

/// Bytes of RAM that [`Light`] takes on a 32-bit part: 4 a sample, 8 a coefficient of
/// every emitter, and 112 for the borrowed tables and the counts.
///
/// Exact on thumb targets: the firmware does not compile where `size_of` differs.
pub const fn light_bytes(counts: &Counts) -> usize {
    let coefficients = counts.emitters as usize * counts.coefficients as usize;
    4 * counts.samples as usize + 8 * coefficients + 112
}

impl<'t, F: Format, const SAMPLES: usize, const EMITTERS: usize, T: Transfer>
    Light<'t, F, SAMPLES, EMITTERS, T>
{
    /// A dark scene, ready to be lit.
    ///
    /// # Errors
    /// [`Error::Capacity`] where the scene has more samples or emitters than the type
    /// holds, or other coefficients of radiosity; and what [`Transfer::fits`] says.
    pub fn new(scene: Scene<'t>) -> Result<Self, Error> {
        let mut light = Self::empty();
        light.enter(scene)?;
        Ok(light)
    }

    /// The state of no scene at all, all zeros, to be made in a `static`, so that however
    /// large it is it passes no stack and takes no flash; [`enter`](Self::enter) gives it
    /// a scene.
    pub const fn empty() -> Self {
        Self {
            scene: None,
            irradiance: Vec::new(),
            emitters: Vec::new(),
            form_factors: 0,
            format: PhantomData,
        }
    }

    /// Takes a scene in place of the one before: dark, ready to be lit, with the radiances
    /// that it was baked with.
    ///
    /// # Errors
    /// As [`new`](Self::new); it then has no scene.
    pub fn enter(&mut self, scene: Scene<'t>) -> Result<(), Error> {
        self.scene = None;
        self.irradiance.clear();
        self.emitters.clear();
        self.form_factors = 0;
        let counts = scene.counts();
        for (what, needed, have) in [
            (What::Samples, counts.samples, SAMPLES as u32),
            (What::Emitters, counts.emitters, EMITTERS as u32),
        ] {
            if needed > have {
                return Err(Error::Capacity { what, needed, have });
            }
        }
        let (needed, have) = (counts.coefficients, T::Radiosity::COEFFICIENTS);
        if needed != have {
            let what = What::Coefficients;
            return Err(Error::Capacity { what, needed, have });
        }
        T::fits(&scene)?;
        // Both fit: that has just been asked.
        let samples = self.irradiance.resize(counts.samples as usize, 0);
        let emitters = self
            .emitters
            .resize(counts.emitters as usize, Shot::NOTHING);
        if samples.is_ok() && emitters.is_ok() {
            self.scene = Some(scene);
        }
        self.restore();
        Ok(())
    }

    /// The scene; that of nothing where none was entered.
    pub fn scene(&self) -> Scene<'t> {
        *self.tables()
    }

    /// The scene in place.
    #[inline(always)]
    pub(super) fn tables(&self) -> &Scene<'t> {
        self.scene.as_ref().unwrap_or(&Scene::EMPTY)
    }

    /// Irradiance of every sample in the tables' unit, in their order. Where radiosities
    /// are linear it may be a little below 0, where they fall to darkness.
    pub fn irradiance(&self) -> &[i32] {
        &self.irradiance
    }

    /// The irradiance at a named point of the scene file in the tables' unit, by its index
    /// there: a sample that is kept beside the surfaces', so that it takes no time. Not
    /// below 0.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such point.
    pub fn point(&self, index: usize) -> Result<i32, Error> {
        let points = self.tables().points();
        let sample = points.get(index).map(|point| point.first_sample as usize);
        let found = sample.and_then(|sample| self.irradiance.get(sample));
        let lit = |&value: &i32| if value > 0 { value } else { 0 };
        found.map(lit).ok_or(Error::Unknown {
            what: What::Points,
            asked: index as u32,
            have: points.len() as u32,
        })
    }

    /// Takes all light away. Luminaires keep their radiances: they have not shot.
    pub fn darken(&mut self) {
        self.irradiance.fill(0);
        for emitter in &mut self.emitters {
            emitter.shot = T::Radiosity::DARK;
        }
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
            self.settle(index);
        }
        let mut shots = 0_u32;
        for index in 0..self.emitters.len() {
            shots = shots.saturating_add(u32::from(self.send(index)));
        }
        shots
    }

    /// Lets the emitter with the largest unshot power shoot. Returns its index,
    /// or `None` where nothing is left.
    pub fn shoot(&mut self) -> Option<usize> {
        let index = self.left().brightest?;
        self.settle(index);
        self.send(index);
        Some(index)
    }

    /// Darkens the scene and lights it until `stop`, with the radiances that it has now.
    ///
    /// Cost: one form factor per shot and sample; at most as many shots as
    /// `stop` allows, `EMITTERS` for each reflection.
    pub fn solve(&mut self, stop: Stop) -> Solved {
        let shots = until(stop, self);
        self.solved(shots)
    }

    pub(super) fn solved(&self, shots: u32) -> Solved {
        Solved {
            shots,
            form_factors: self.form_factors,
            unshot: self.unshot_fraction(),
        }
    }

    /// The mean radiosity that an emitter has shot so far, in the unit of irradiance
    /// (a luminaire: of exitance); 0 where there is no such emitter.
    pub fn radiosity(&self, emitter: usize) -> i32 {
        self.coefficients(emitter).mean()
    }

    /// All coefficients of the same.
    pub fn coefficients(&self, emitter: usize) -> T::Radiosity {
        let state = self.emitters.get(emitter);
        state.map_or(T::Radiosity::DARK, |state| state.shot)
    }

    /// By how many powers of two the unit of an emitter's radiosity is larger
    /// than that of irradiance.
    pub(super) fn shift(&self, emitter: usize) -> u32 {
        match self.tables().is_luminaire(emitter) {
            true => self.tables().header().shift,
            false => 0,
        }
    }

    /// Lets an emitter shoot what it has not of what it is to have shot; whether that was
    /// anything.
    pub(super) fn send(&mut self, index: usize) -> bool {
        let Some(scene) = self.scene else {
            return false;
        };
        let shift = self.shift(index);
        let (Some(emitter), Some(state)) =
            (scene.emitters().get(index), self.emitters.get_mut(index))
        else {
            return false;
        };
        let radiosity = state.due.zip(state.shot, i32::saturating_sub);
        if radiosity.strength() == 0 {
            return false;
        }
        state.shot = state.shot.zip(radiosity, i32::saturating_add);
        let is_luminaire = scene.is_luminaire(index);
        let mut next = 0_u32;
        for (number, surface) in (0_u32..).zip(scene.receiving()) {
            let samples = scene.receivers(surface, is_luminaire);
            let first = next;
            next = next.saturating_add(samples.len() as u32);
            if number == emitter.surface {
                continue; // a planar polygon does not light its own plane
            }
            self.form_factors = self.form_factors.saturating_add(samples.len() as u32);
            let places = scene.samples().get(samples.clone()).unwrap_or(&[]);
            let values = self.irradiance.get_mut(samples).unwrap_or_default();
            if !is_luminaire && T::add(&scene, index, first, radiosity, values) {
                continue;
            }
            let Ok(facing) = Receiver::<F>::new(surface.origin, surface.normal) else {
                continue; // checked tables have no normal of length 0
            };
            let Some(front) = scene.front(emitter) else {
                continue;
            };
            let mut fractions = T::fractions(&scene, index, first).iter();
            for (value, &place) in values.iter_mut().zip(places) {
                let seen = fractions.next().copied().unwrap_or(u16::MAX);
                if seen == 0 {
                    continue;
                }
                let receiver = facing.moved_to(surface.place(place));
                let factor = scene.form_factor_before(&receiver, &front, emitter);
                let more = arriving(radiosity.mean(), part(factor, seen), shift);
                *value = saturated(i64::from(*value).wrapping_add(more));
            }
        }
        true
    }
}

impl<F: Format, const SAMPLES: usize, const EMITTERS: usize>
    Light<'_, F, SAMPLES, EMITTERS, Computed>
{
    /// The irradiance at any place in the tables' unit, from everything that has
    /// been shot. It may exceed a word: no sample need be as bright. Not below 0.
    ///
    /// Cost: one form factor per emitter that has shot. The answer depends on
    /// the receiver alone. Never panics. Not for [`Matrix`](super::Matrix), which knows
    /// samples alone.
    pub fn at(&self, receiver: &Receiver<F>) -> u64 {
        let mut sum = 0_i64;
        let emitters = self.tables().emitters();
        for (index, (emitter, state)) in emitters.iter().zip(&self.emitters).enumerate() {
            let shot = state.shot.mean();
            if shot != 0 {
                let factor = self.tables().form_factor(receiver, emitter);
                sum = sum.saturating_add(arriving(shot, factor, self.shift(index)));
            }
        }
        u64::try_from(sum).unwrap_or(0)
    }
}

impl<F: Format, const SAMPLES: usize, const EMITTERS: usize, T: Transfer> Shooting
    for Light<'_, F, SAMPLES, EMITTERS, T>
{
    type Ahead = ();
    const NOTHING: () = ();

    fn direct(&mut self) -> u32 {
        Light::direct(self)
    }

    fn reflect(&mut self) -> u32 {
        Light::reflect(self)
    }

    fn shoot(&mut self) -> bool {
        Light::shoot(self).is_some()
    }

    fn shoot_some(&mut self, fraction: f32, most: u32, _: &mut ()) -> u32 {
        match (T::SWEEPS, most) {
            (_, 0) => 0,
            (true, _) => self.sweep(fraction, most),
            (false, _) => u32::from(self.shoot_if_above(fraction)),
        }
    }
}

/// Radiosity times form factor, 2^`shift` times as many units of irradiance,
/// rounded to nearest: less than 2^48.
#[inline]
fn arriving<F: Format>(radiosity: i32, factor: F, shift: u32) -> i64 {
    // At least 2^−24 is the factor's unit, at most 2^16 the shift.
    const { assert!(LARGEST_SHIFT < 24) };
    let down = F::FRACTION.wrapping_sub(shift) & 63;
    let product = i64::from(radiosity).wrapping_mul(factor.to_bits().into());
    (product >> (down.wrapping_sub(1) & 63)).wrapping_add(1) >> 1
}
