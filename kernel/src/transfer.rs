//! How what a sample receives from an emitter is had.
//!
//! A rung is a type ([`Transfer`]). Every rung of
//! [`visibility`](crate::visibility) is one that computes: the emitter is clipped
//! against its occluders, which may move. [`Codes`] reads what the host found out
//! beforehand ([`Scene::code`]): no occluder is on the device, and no code for
//! one is linked; but samples are then the only places it can answer for.

use crate::Error;
use crate::error::What;
use crate::form_factor::Arithmetic;
use crate::geometry::Receiver;
use crate::luminance::Luminance;
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
    fn fits(scene: &Scene<'_>) -> Result<(), Error> {
        let (counts, needed, have) = (scene.counts(), scene.sight(), V::CAPACITIES);
        let occluders = if have.occluders { counts.occluders } else { 0 };
        for (what, needed, have) in [
            // Tables with codes have lost their occluders.
            (What::Codes, counts.codes, 0),
            (What::Fractions, counts.fractions, 0),
            (What::Occluders, counts.occluders, occluders),
            (What::Corners, needed.vertices, have.vertices),
            (What::Pieces, needed.pieces, have.pieces),
            (What::Lines, needed.lines, have.lines),
            (What::Blockers, needed.blockers, have.blockers),
        ] {
            if needed > have {
                return Err(Error::Capacity { what, needed, have });
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn received<A: Arithmetic<f32>, L: Luminance>(
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
        if !counts.is_coded() && counts.emitters > counts.luminaires {
            return Err(Error::Unknown {
                what: What::Codes,
                asked: counts.emitters.saturating_sub(counts.luminaires),
                have: 0,
            });
        }
        Ok(())
    }

    #[inline(always)]
    fn received<A: Arithmetic<f32>, L: Luminance>(
        &mut self,
        scene: &Scene<'_>,
        receiver: &Receiver<f32>,
        pair: Pair,
        radiosity: L,
    ) -> L::Colour {
        let Pair {
            emitter,
            receiver: number,
            // The fractions of such samples say so.
            unshadowed: _,
        } = pair;
        if scene.is_luminaire(emitter) {
            let fraction = scene.fraction(emitter, number);
            scene.received_in_part::<A, L>(receiver, emitter, radiosity, fraction)
        } else {
            scene.coded::<A, L>(receiver, emitter, radiosity, scene.code(emitter, number))
        }
    }
}
