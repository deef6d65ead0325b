//! How what a sample receives from an emitter is had.
//!
//! A rung is a type ([`Transfer`]). Every rung of
//! [`visibility`](crate::visibility) is one that computes: the emitter is clipped
//! against its occluders, which may move. [`Codes`] reads what the host found out
//! beforehand ([`Scene::code`]): no occluder is on the device, and no code for
//! one is linked; but samples are then the only places it can answer for.
//! [`Matrix`] reads the terms themselves ([`Scene::add_terms`]): a few multiplications a
//! pair. [`Vectors`] reads what every sample receives of every luminaire in the end
//! ([`Scene::response`]): nothing is left to be reflected, and a dimming costs one
//! multiplication a sample, but reflectances are what they were.

use crate::Error;
use crate::error::What;
use crate::form_factor::Arithmetic;
use crate::geometry::Receiver;
use crate::luminance::{Colour, Luminance};
use crate::scene::Scene;
use crate::visibility::Visibility;

/// An emitter and a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pair {
    /// Index of the emitter.
    pub emitter: usize,
    /// Index of the sample among all that receive from emitters of this kind:
    /// luminaires, or secondary ones.
    pub receiver: u32,
    /// Whether it looks past what occludes.
    pub unshadowed: bool,
}

/// A rung of the transfer ladder.
pub trait Transfer {
    /// Whether tables are what this rung reads, and within its capacities.
    ///
    /// # Errors
    /// [`Error::Capacity`] where they hold what it has no room for,
    /// [`Error::Unknown`] where they lack what it needs.
    fn fits(scene: &Scene<'_>) -> Result<(), Error>;

    /// The irradiance in W m⁻² at a sample from an emitter of this radiosity.
    /// Never panics.
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour;

    /// As [`received`](Self::received), from an emitter that is no point.
    #[inline(always)]
    fn of_polygon<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        self.received::<A, L>(scene, receiver, pair, radiosity)
    }

    /// Adds what samples that follow each other receive from a secondary emitter, where
    /// that is read and nothing of them need be known but which they are; whether it is.
    /// `first` is counted as [`Pair::receiver`] is.
    #[inline(always)]
    fn add<L: Luminance>(
        &self,
        _scene: &Scene<'_>,
        _emitter: usize,
        _first: u32,
        _radiosity: L,
        _values: &mut [L::Colour],
    ) -> bool {
        false
    }

    /// Whether emitters may be points, which nothing hides and which light many samples
    /// at once: [`received`](Self::received) gives the same, one by one.
    const POINTS: bool = false;

    /// Whether looking for the brightest emitter costs more than a shot, so that all
    /// shoot in turn.
    fn sweeps(_: &Scene<'_>) -> bool {
        false
    }

    /// Whether what it gives is what is received in the end, with all reflected
    /// light, so that a luminaire lights its own surface too.
    fn is_in_the_end(_: &Scene<'_>) -> bool {
        false
    }

    /// Sets every value of a slice to what `value` makes of it, given its index
    /// and a workspace.
    ///
    /// One after the other; a host may spread them over its cores, since no
    /// value depends on another one.
    fn each<C: Send>(&mut self, values: &mut [C], value: impl Fn(&mut Self, usize, &mut C) + Sync)
    where
        Self: Sized,
    {
        for (index, place) in values.iter_mut().enumerate() {
            value(self, index, place);
        }
    }
}

impl<V: Visibility> Transfer for V {
    const POINTS: bool = <V as Visibility>::POINTS;

    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        let (counts, needed, have) = (scene.counts(), scene.sight(), V::CAPACITIES);
        let occluders = if have.occluders { counts.occluders } else { 0 };
        // Tables with codes have lost their occluders.
        refuse(What::Codes, counts.codes)?;
        refuse(What::Fractions, counts.fractions)?;
        refuse(What::Terms, counts.terms)?;
        refuse(What::Responses, counts.responses)?;
        within(What::Occluders, counts.occluders, occluders)?;
        within(What::Corners, needed.vertices, have.vertices)?;
        within(What::Pieces, needed.pieces, have.pieces)?;
        within(What::Lines, needed.lines, have.lines)?;
        within(What::Blockers, needed.blockers, have.blockers)?;
        // A point lies at the centre of its shape.
        match <V as Visibility>::POINTS {
            true => Ok(()),
            false => refuse(What::Shapes, counts.shapes),
        }
    }

    #[inline(always)]
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        if <V as Visibility>::POINTS && scene.point_source(pair.emitter).is_some() {
            let seen = scene.received::<A, L, V>(receiver, pair.emitter, radiosity, self);
            return seen.middle();
        }
        self.of_polygon::<A, L>(scene, receiver, pair, radiosity)
    }

    #[inline(always)]
    fn of_polygon<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        let Pair {
            emitter,
            unshadowed,
            ..
        } = pair;
        let bracket =
            scene.received_past::<A, L, V>(receiver, emitter, radiosity, self, unshadowed);
        bracket.middle()
    }

    fn each<C: Send>(&mut self, values: &mut [C], value: impl Fn(&mut Self, usize, &mut C) + Sync) {
        Visibility::each(self, values, value);
    }
}

/// The rung `codes`: four bits for each sample and secondary emitter, a fraction
/// for each sample and luminaire.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Codes;

impl Transfer for Codes {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        let counts = scene.counts();
        refuse(What::Terms, counts.terms)?;
        refuse(What::Responses, counts.responses)?;
        require(scene, What::Codes, counts.is_coded())
    }

    #[inline(always)]
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        // That a sample looks past what occludes is in its fractions.
        let (emitter, number) = (pair.emitter, pair.receiver);
        if scene.is_luminaire(emitter) {
            let fraction = scene.fraction(emitter, number);
            scene.received_in_part::<A, L>(receiver, emitter, radiosity, fraction)
        } else {
            scene.coded::<A, L>(receiver, emitter, radiosity, scene.code(emitter, number))
        }
    }
}

/// The rung `matrix`: a term for each sample and secondary emitter, with a factor of
/// `BITS` bits, 4, 6 or 8; a fraction for each sample and luminaire.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Matrix<const BITS: u32>;

impl<const BITS: u32> Transfer for Matrix<BITS> {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        let counts = scene.counts();
        refuse(What::Codes, counts.codes)?;
        refuse(What::Responses, counts.responses)?;
        require(scene, What::Terms, counts.terms > 0)?;
        if counts.terms > 0 && counts.bits != BITS {
            return Err(Error::Capacity {
                what: What::Bits,
                needed: counts.bits,
                have: BITS,
            });
        }
        Ok(())
    }

    fn sweeps(_: &Scene<'_>) -> bool {
        true
    }

    #[inline(always)]
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        let (emitter, number) = (pair.emitter, pair.receiver);
        if scene.is_luminaire(emitter) {
            let fraction = scene.fraction(emitter, number);
            return scene.received_in_part::<A, L>(receiver, emitter, radiosity, fraction);
        }
        let mut value = [L::Colour::DARK];
        scene.add_terms(BITS, emitter, number, radiosity, &mut value);
        let [value] = value;
        value
    }

    #[inline(always)]
    fn add<L: Luminance>(
        &self,
        scene: &Scene<'_>,
        emitter: usize,
        first: u32,
        radiosity: L,
        values: &mut [L::Colour],
    ) -> bool {
        scene.add_terms(BITS, emitter, first, radiosity, values);
        true
    }
}

/// The rung `vectors`: for each sample and luminaire what it receives in the end.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Vectors;

impl Transfer for Vectors {
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        let counts = scene.counts();
        // Codes, terms and what reflects are not beside responses: that is checked
        // on load.
        match counts.responses > 0 || counts.samples == 0 {
            true => Ok(()),
            false => Err(Error::Unknown {
                what: What::Responses,
                asked: counts.samples,
                have: 0,
            }),
        }
    }

    fn is_in_the_end(_: &Scene<'_>) -> bool {
        true
    }

    #[inline(always)]
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        _: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        let response = scene.response::<L::Colour>(pair.emitter, pair.receiver);
        radiosity.mean().zip(response, |m, r| m * r)
    }
}

/// Refuses what tables hold and a rung does not read.
fn refuse(what: What, needed: u32) -> Result<(), Error> {
    within(what, needed, 0)
}

/// Refuses tables with more than a type holds.
pub(crate) fn within(what: What, needed: u32, have: u32) -> Result<(), Error> {
    match needed <= have {
        true => Ok(()),
        false => Err(Error::Capacity { what, needed, have }),
    }
}

/// Refuses tables that reflect without what a rung reads.
fn require(scene: &Scene<'_>, what: What, there: bool) -> Result<(), Error> {
    let counts = scene.counts();
    let asked = counts.emitters.saturating_sub(counts.luminaires);
    match there || asked == 0 {
        true => Ok(()),
        false => Err(Error::Unknown {
            what,
            asked,
            have: 0,
        }),
    }
}
