//! What a receiver gets from an emitter by the code that a host wrote.
//!
//! A planner that knows the room writes for every pair how little work will do,
//! and which fraction of the emitter is seen: the device then neither clips
//! against occluders nor decides anything. Four bits a pair,
//!
//! ```text
//! E = V k(B),
//! ```
//!
//! where k is one of the [`Method`]s, cheapest first, and V the fraction, in
//! steps that are finer the more the method costs. Which code a pair has is the
//! host's to answer for; what it may err by is stated where codes are planned.

use super::Scene;
use super::received::middle;
use super::records::Counts;
use crate::form_factor::Arithmetic;
use crate::geometry::Receiver;
use crate::luminance::{Colour, Luminance};

/// How a coded term is computed, cheapest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Method {
    /// Not at all: it is too small to count, or nothing is seen.
    Skip,
    /// All of the emitter in its centroid: B F with F = A cos θ_r cos θ_e / (π r²)
    /// and the mean radiosity. About 60 instructions on a Cortex-M4F.
    Point,
    /// The rule of few nodes for both form factor and centre of gravity
    /// ([`luminance`](crate::luminance)). About 250 instructions.
    Rule,
    /// The form factor by the scene's rung of arithmetic, the centre of gravity
    /// by the rule. About 800 instructions.
    Contour,
}

impl Method {
    /// All of them, cheapest first.
    pub const ALL: [Self; 4] = [Self::Skip, Self::Point, Self::Rule, Self::Contour];
}

/// Four bits: a method and a visible fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Code(u8);

/// Methods and fractions in the order of the codes.
const MEANINGS: [(Method, f32); 16] = [
    (Method::Skip, 0.0),
    (Method::Point, 1.0 / 3.0),
    (Method::Point, 2.0 / 3.0),
    (Method::Point, 1.0),
    (Method::Rule, 0.2),
    (Method::Rule, 0.4),
    (Method::Rule, 0.6),
    (Method::Rule, 0.8),
    (Method::Rule, 1.0),
    (Method::Contour, 1.0 / 7.0),
    (Method::Contour, 2.0 / 7.0),
    (Method::Contour, 3.0 / 7.0),
    (Method::Contour, 4.0 / 7.0),
    (Method::Contour, 5.0 / 7.0),
    (Method::Contour, 6.0 / 7.0),
    (Method::Contour, 1.0),
];

/// Bytes of the codes of tables with these counts.
pub(super) const fn bytes(counts: &Counts) -> u64 {
    counts.codes.div_ceil(8) as u64 * 4
}

impl Code {
    /// All codes, cheapest method first, and of one method by rising fraction.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..MEANINGS.len() as u8).map(Self)
    }

    /// Nothing is received.
    pub const SKIP: Self = Self(0);

    /// The code of a method with all of the emitter seen.
    pub fn whole(method: Method) -> Self {
        let wanted = |code: &Self| code.meaning().0 == method;
        Self::all().filter(wanted).last().unwrap_or(Self::SKIP)
    }

    /// Its four bits.
    pub fn bits(self) -> u32 {
        u32::from(self.0)
    }

    /// The method and the visible fraction that it stands for.
    #[inline(always)]
    pub fn meaning(self) -> (Method, f32) {
        let skip = (Method::Skip, 0.0);
        MEANINGS.get(usize::from(self.0)).copied().unwrap_or(skip)
    }
}

impl Scene<'_> {
    /// The code of an emitter for a receiver, counted among all samples that
    /// receive reflected light; [`Method::Skip`] where there is none.
    #[inline(always)]
    pub fn code(&self, emitter: usize, receiver: u32) -> Code {
        let counts = &self.header.counts;
        let secondary = (emitter as u32).wrapping_sub(counts.luminaires);
        let all = counts.emitters.wrapping_sub(counts.luminaires).max(1);
        let pair = (counts.codes / all)
            .wrapping_mul(secondary)
            .wrapping_add(receiver);
        let both = self.codes.get((pair >> 1) as usize).copied();
        Code(both.unwrap_or(0) >> (4 * (pair & 1)) & 0xf)
    }

    /// The part of a luminaire's form factor that is seen from a receiver,
    /// counted among all samples that receive direct light: 0 ≤ V ≤ 1 in steps of
    /// 1/65 535.
    #[inline(always)]
    pub fn fraction(&self, luminaire: usize, receiver: u32) -> f32 {
        let counts = &self.header.counts;
        if counts.fractions == 0 {
            return 1.0;
        }
        let receivers = counts.fractions / counts.luminaires.max(1);
        let pair = receivers
            .wrapping_mul(luminaire as u32)
            .wrapping_add(receiver);
        let fraction = self.fractions.get(pair as usize);
        f32::from(fraction.copied().unwrap_or(0)) / f32::from(u16::MAX)
    }

    /// The irradiance in W m⁻² at a receiver from a luminaire of which this
    /// fraction is seen. Cost: [`Scene::form_factor`], nothing for a fraction of
    /// 0. Never panics.
    #[inline]
    pub fn received_in_part<A: Arithmetic<f32>, L: Luminance>(
        &self,
        receiver: &Receiver<f32>,
        luminaire: usize,
        radiosity: L,
        fraction: f32,
    ) -> L::Colour {
        match self.emitters.get(luminaire) {
            Some(emitter) if fraction > 0.0 => {
                let factor = self.form_factor::<A>(receiver, emitter);
                radiosity.received(factor * fraction, || [0.0; 2])
            }
            _ => L::Colour::DARK,
        }
    }

    /// The irradiance in W m⁻² at a receiver from an emitter, by a code.
    ///
    /// Dark where the tables have no shapes. Cost: see [`Method`]. Never panics,
    /// never NaN where the radiosity is finite.
    #[inline]
    pub fn coded<A: Arithmetic<f32>, L: Luminance>(
        &self,
        receiver: &Receiver<f32>,
        index: usize,
        radiosity: L,
        code: Code,
    ) -> L::Colour {
        let (method, fraction) = code.meaning();
        if method == Method::Skip {
            return L::Colour::DARK;
        }
        let (Some(emitter), Some(shape)) = (self.emitters.get(index), self.shapes.get(index))
        else {
            return L::Colour::DARK;
        };
        let Some(facing) = self.facing(receiver, emitter) else {
            return L::Colour::DARK;
        };
        if method == Method::Point {
            let factor = facing.point(receiver, shape, emitter.area * fraction);
            return radiosity.received(factor, || [0.0; 2]);
        }
        let whole = facing.whole(receiver, shape, false);
        let mut total = L::Colour::DARK;
        for (outline, corners) in self.loops_of(emitter).zip(self.corners_of(emitter)) {
            let moments = whole.view.moments(corners);
            let factor = match method {
                Method::Contour => whole.form_factor::<A>(outline),
                _ => moments.factor,
            };
            let value = radiosity.received(factor * fraction, || moments.place(middle(corners)));
            total = total.plus(value);
        }
        total
    }
}
