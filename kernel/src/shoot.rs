//! Light on its way: from luminaires to samples, from sample to sample, until
//! little enough is left.
//!
//! The state is one irradiance per sample and two radiosities per emitter, what it
//! has shot and what it is to have shot.
//! An emitter's radiosity is B = M + ρ mean(E) over the samples at its
//! vertices (the paper's reconstruction for light transfer), or linear in place
//! with a mean and two gradients, each a weighted sum of its samples'
//! irradiances; what it has not yet shot is B less what it has. Shooting adds
//! ΔB F to the irradiance of every sample, by Eq. 2 and 3 of the paper; E = B F is
//! the same as π L F.
//! (The paper's Eq. 4 with the sum of Eq. 3 written out, its Eq. 5, lacks a
//! factor 1/2 and the normalisation of the cross product, and has the light's
//! normal in place of the receiver's; here the second bounce is Eq. 3 again,
//! with a polygon of constant radiosity as its emitter.)
//!
//! All of it is linear, so that a scene need not be lit anew where a luminaire is
//! dimmed: what changed is a difference ΔB, below 0 where there is less of it, and
//! is shot as any other ([`Light::set_radiance`], [`Light::update`]). Emitters are
//! compared, and the end is told, by magnitudes.
//!
//! Two orders are offered: [`Light::shoot`] takes the emitter with the most
//! unshot power (progressive shooting; [`Light::solve`] lets it shoot ahead of
//! light that is still to come, where that pays), [`Light::reflect`] lets all emitters
//! shoot what arrived in the last generation (a Neumann sum, so that "light
//! reflected at most N times" is exact).

mod change;
mod stop;
mod unshot;

pub(crate) use stop::{Shooting, onwards, until};
pub use stop::{Solved, Stop};

use crate::Error;
use crate::error::What;
use crate::form_factor::Arithmetic;
use crate::geometry::Receiver;
use crate::luminance::{Colour, Constant, Luminance};
use crate::scene::Scene;
use crate::transfer::{Pair, Transfer, within};
use crate::visibility::{Bracket, Unoccluded, Visibility};
use core::marker::PhantomData;
use heapless::Vec;
use unshot::difference;

/// The light in a scene, for at most `SAMPLES` samples and `EMITTERS` emitters.
///
/// `A` is the arithmetic rung, `L` how radiosity varies over an emitter and how
/// many channels it has, `V` the rung of visibility with its workspace, or
/// another [`Transfer`]; all must be what the tables were baked for. `SURFACES` is
/// how many surfaces there are where reflectances may change
/// ([`set_reflectance`](Light::set_reflectance)), 0 where they stay as they were
/// baked.
/// RAM: [`budget::light_bytes`](crate::budget::light_bytes), and with `SURFACES`
/// [`budget::reflectance_bytes`](crate::budget::reflectance_bytes).
#[derive(Clone, Debug)]
pub struct Light<
    't,
    A,
    const SAMPLES: usize,
    const EMITTERS: usize,
    L = Constant<f32>,
    V = Unoccluded,
    const SURFACES: usize = 0,
> where
    L: Luminance,
{
    /// `None` is nothing but zeros: a `static` of an empty light takes no flash.
    scene: Option<Scene<'t>>,
    /// Irradiance of every sample, W m⁻².
    irradiance: Vec<L::Colour, SAMPLES>,
    emitters: Vec<Shot<L>, EMITTERS>,
    /// The reflectances of the surfaces, where they may change.
    reflectances: [L::Colour; SURFACES],
    /// Form factors evaluated since the scene was dark, or by the last update.
    form_factors: u32,
    sight: V,
    rung: PhantomData<A>,
}

/// What one emitter has done.
#[derive(Clone, Copy, Debug)]
struct Shot<L> {
    /// Radiosity shot so far, W m⁻².
    shot: L,
    /// Radiosity that it is to have shot when the present generation ends, W m⁻²;
    /// of a luminaire always what it emits.
    due: L,
}

impl<L: Luminance> Shot<L> {
    const NOTHING: Self = Self {
        shot: L::DARK,
        due: L::DARK,
    };
}

impl<'t, A, const SAMPLES: usize, const EMITTERS: usize, L, V, const SURFACES: usize>
    Light<'t, A, SAMPLES, EMITTERS, L, V, SURFACES>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    /// A dark scene, ready to be lit.
    ///
    /// # Errors
    /// [`Error::Capacity`] where the scene has more samples or emitters than
    /// the type holds, or other channels, coefficients or weights; and what
    /// [`Transfer::fits`] says.
    pub fn new(scene: Scene<'t>) -> Result<Self, Error>
    where
        V: Default,
    {
        Self::with_sight(scene, V::default())
    }

    /// As [`new`](Self::new), with the caller's workspace.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_sight(scene: Scene<'t>, sight: V) -> Result<Self, Error> {
        let mut light = Self::empty(sight);
        light.enter(scene)?;
        Ok(light)
    }

    /// The state of no scene at all, all zeros, to be made in a `static`, so that
    /// however large it is it passes no stack and takes no flash; [`enter`](Self::enter) gives it a scene.
    pub const fn empty(sight: V) -> Self {
        Self {
            scene: None,
            irradiance: Vec::new(),
            emitters: Vec::new(),
            reflectances: [const { L::Colour::DARK }; SURFACES],
            form_factors: 0,
            sight,
            rung: PhantomData,
        }
    }

    /// Takes a scene in place of the one before: dark, ready to be lit, with the
    /// radiances and reflectances that it was baked with.
    ///
    /// # Errors
    /// As [`new`](Self::new); it then has no scene.
    pub fn enter(&mut self, scene: Scene<'t>) -> Result<(), Error> {
        self.scene = None;
        self.irradiance.clear();
        self.emitters.clear();
        self.form_factors = 0;
        let counts = scene.counts();
        let surfaces = if SURFACES > 0 { counts.surfaces } else { 0 };
        within(What::Samples, counts.samples, SAMPLES as u32)?;
        within(What::Emitters, counts.emitters, EMITTERS as u32)?;
        within(What::Surfaces, surfaces, SURFACES as u32)?;
        let (channels, coefficients) = (L::Colour::CHANNELS as u32, L::COEFFICIENTS as u32);
        let weights = if L::WEIGHTED {
            counts.members.saturating_mul(coefficients)
        } else {
            0
        };
        for (what, needed, have) in [
            (What::Channels, counts.channels, channels),
            (What::Coefficients, counts.coefficients, coefficients),
            (What::Weights, counts.weights, weights),
        ] {
            if needed != have {
                return Err(Error::Capacity { what, needed, have });
            }
        }
        V::fits(&scene)?;
        // Both fit: that has just been asked.
        let samples = self
            .irradiance
            .resize(counts.samples as usize, L::Colour::DARK);
        let emitters = self
            .emitters
            .resize(counts.emitters as usize, Shot::NOTHING);
        if samples.is_ok() && emitters.is_ok() {
            self.scene = Some(scene);
        }
        self.restore();
        Ok(())
    }

    /// The workspace it looks with.
    pub fn sight(&self) -> &V {
        &self.sight
    }

    /// The scene.
    pub fn scene(&self) -> Scene<'t> {
        *self.tables()
    }

    /// The scene in place; that of nothing where none was entered.
    #[inline(always)]
    fn tables(&self) -> &Scene<'t> {
        self.scene.as_ref().unwrap_or(&Scene::EMPTY)
    }

    /// Irradiance of every sample in W m⁻², in the order of the tables.
    pub fn irradiance(&self) -> &[L::Colour] {
        &self.irradiance
    }

    /// The irradiance at a named point of the scene file in W m⁻², by its index there:
    /// a sample that is kept beside the surfaces', so that it takes no time. Not
    /// below 0.
    ///
    /// # Errors
    /// [`Error::Unknown`] where there is no such point.
    pub fn point(&self, index: usize) -> Result<L::Colour, Error> {
        let points = self.tables().points();
        let sample = points.get(index).map(|point| point.first_sample as usize);
        let found = sample.and_then(|sample| self.irradiance.get(sample));
        let lit = |value: f32| if value > 0.0 { value } else { 0.0 };
        found.map(|value| value.map(lit)).ok_or(Error::Unknown {
            what: What::Points,
            asked: index as u32,
            have: points.len() as u32,
        })
    }

    /// Takes all light away. Luminaires keep their radiances: they have not shot.
    pub fn darken(&mut self) {
        self.irradiance.fill(L::Colour::DARK);
        for emitter in &mut self.emitters {
            emitter.shot = L::DARK;
        }
        self.form_factors = 0;
    }

    /// Darkens the scene and lets every luminaire shoot: direct light,
    /// E = π L F.
    ///
    /// Cost: one form factor per luminaire and sample. Exact up to the rung's
    /// error. Returns the number of shots.
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
        let index = self.left(L::Colour::DARK).brightest?;
        self.settle(index);
        self.send(index);
        Some(index)
    }

    /// Lets the emitter with the largest unshot power shoot, if all unshot power is
    /// above this fraction of the emitted power. It counts as unshot, and is sent, what
    /// it is to reflect of the irradiance `ahead` as well, which becomes what was found
    /// by this look.
    fn shoot_above(&mut self, fraction: f32, ahead: &mut L::Colour) -> bool {
        // One look over the emitters for all: with codes it costs as much as a
        // shot.
        let left = self.left(*ahead);
        let Some(index) = left.brightest.filter(|_| left.fraction > fraction) else {
            return false;
        };
        self.settle(index);
        if L::AHEAD {
            self.anticipate(index, *ahead);
            *ahead = left.ahead;
        }
        self.send(index)
    }

    /// Darkens the scene and lights it until `stop`, with the radiances and
    /// reflectances that it has now.
    ///
    /// In a room that holds its light together ([`Header::ahead`]) an emitter whose
    /// radiosity is linear in place sends a part of what it is to reflect of all light
    /// on its way as well, were that spread evenly (overshooting; Feda and Purgathofer
    /// 1992); what was too much it takes back. The shipped rooms take half as many
    /// shots by it, and end as close.
    ///
    /// [`Header::ahead`]: crate::scene::records::Header::ahead
    ///
    /// Cost: one form factor per shot and sample; at most as many shots as
    /// `stop` allows, `EMITTERS` for each reflection.
    pub fn solve(&mut self, stop: Stop) -> Solved {
        let shots = until(stop, self);
        self.solved(shots)
    }

    fn solved(&self, shots: u32) -> Solved {
        Solved {
            shots,
            form_factors: self.form_factors,
            unshot: self.unshot_fraction(),
        }
    }

    /// The radiosity in W m⁻² that an emitter has shot so far; dark where there
    /// is no such emitter.
    pub fn radiosity(&self, emitter: usize) -> L {
        self.emitters
            .get(emitter)
            .map_or(L::DARK, |emitter| emitter.shot)
    }

    /// The irradiance at any place in W m⁻², from everything that has been
    /// shot: no resampling. Not below 0, where a linear radiosity that falls to
    /// darkness would be.
    ///
    /// Cost: [`Scene::received`] for every emitter. The answer depends on the
    /// receiver alone, not on which others were asked. Not for [`Codes`], which
    /// knows samples alone.
    ///
    /// [`Codes`]: crate::transfer::Codes
    pub fn at(&self, receiver: &Receiver<f32>) -> L::Colour
    where
        V: Visibility + Default,
    {
        self.at_with(receiver, &mut V::default()).middle()
    }

    /// As [`at`](Self::at), with the caller's workspace in place of one on the
    /// stack; both bounds where it is too small for a place nobody planned for.
    pub fn at_with(&self, receiver: &Receiver<f32>, sight: &mut V) -> Bracket<L::Colour>
    where
        V: Visibility,
    {
        self.at_among(self.tables(), receiver, sight)
    }

    /// As [`at_with`](Self::at_with), looking in another scene with the same
    /// emitters: the one with its occluders, where the light's own has codes in
    /// place of them.
    pub fn at_among<W: Visibility>(
        &self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        sight: &mut W,
    ) -> Bracket<L::Colour> {
        let mut sum = Bracket::exactly(L::Colour::DARK);
        for (index, state) in self.emitters.iter().enumerate() {
            if state.shot != L::DARK {
                sum = sum.plus(scene.received::<A, L, W>(receiver, index, state.shot, sight));
            }
        }
        let lit = |value: f32| if value > 0.0 { value } else { 0.0 };
        Bracket {
            low: sum.low.map(lit),
            high: sum.high.map(lit),
        }
    }

    /// Lets an emitter shoot what it has not of what it is to have shot; whether
    /// that was anything.
    fn send(&mut self, index: usize) -> bool {
        let Some(scene) = self.scene else {
            return false;
        };
        let (Some(emitter), Some(state)) =
            (scene.emitters().get(index), self.emitters.get_mut(index))
        else {
            return false;
        };
        let radiosity = difference(state.due, state.shot);
        if radiosity.strength() <= 0.0 {
            return false;
        }
        state.shot = state.shot.zip(radiosity, Colour::plus);
        let is_luminaire = scene.is_luminaire(index);
        let point = if V::POINTS {
            scene.point_source(index)
        } else {
            None
        };
        let mut next = 0_u32;
        for (number, surface) in (0_u32..).zip(scene.receiving()) {
            let samples = scene.receivers(surface, is_luminaire);
            let first = next;
            next = next.saturating_add(samples.len() as u32);
            if number == emitter.surface && !V::is_in_the_end(&scene) {
                continue; // a planar polygon does not light its own plane
            }
            self.form_factors = self.form_factors.saturating_add(samples.len() as u32);
            let places = scene.samples().get(samples.clone()).unwrap_or(&[]);
            let values = self.irradiance.get_mut(samples).unwrap_or_default();
            if !is_luminaire && self.sight.add(&scene, index, first, radiosity, values) {
                continue;
            }
            if let Some(point) = &point {
                point.add(surface, places, radiosity, values);
                continue;
            }
            self.sight.each(values, |sight, number, value| {
                let Some(&place) = places.get(number) else {
                    return;
                };
                let receiver = Receiver::of_unit(surface.place(place), surface.normal.into());
                let pair = Pair {
                    emitter: index,
                    receiver: first.wrapping_add(number as u32),
                    unshadowed: is_luminaire && (number as u32) < surface.unshadowed,
                };
                let more = sight.of_polygon::<A, L>(&scene, &receiver, pair, radiosity);
                *value = value.plus(more);
            });
        }
        true
    }
}

impl<A, const SAMPLES: usize, const EMITTERS: usize, L, V, const SURFACES: usize> Shooting
    for Light<'_, A, SAMPLES, EMITTERS, L, V, SURFACES>
where
    A: Arithmetic<f32>,
    L: Luminance,
    V: Transfer,
{
    type Ahead = L::Colour;
    const NOTHING: L::Colour = L::Colour::DARK;

    fn direct(&mut self) -> u32 {
        Light::direct(self)
    }

    fn reflect(&mut self) -> u32 {
        Light::reflect(self)
    }

    fn shoot(&mut self) -> bool {
        Light::shoot(self).is_some()
    }

    fn shoot_some(&mut self, fraction: f32, most: u32, ahead: &mut L::Colour) -> u32 {
        match (V::sweeps(self.tables()), most) {
            (_, 0) => 0,
            (true, _) => self.sweep(fraction, most),
            (false, _) => u32::from(self.shoot_above(fraction, ahead)),
        }
    }

    /// Two for each emitter: a room is lit to 0.1 % by then.
    fn most_ahead(&self) -> u32 {
        if L::AHEAD && self.tables().ahead() > 0.0 {
            (self.emitters.len() as u32).saturating_mul(2)
        } else {
            0
        }
    }
}
