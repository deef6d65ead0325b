//! What an emitter sends: how many channels, and how it varies over a polygon.
//!
//! Both are types. A scene that is grey has one channel ([`f32`]), one with
//! colour three ([`Rgb`]); geometry is evaluated once for all of them. An
//! emitter is of one radiosity all over ([`Constant`]: a luminaire, a band
//! between two isolux outlines; [`Increment`]: what is inside of an outline, by
//! which it is brighter than what is outside), or its radiosity is linear in
//! place ([`Linear`]: a patch of a wall), which needs a tenth of the emitters for
//! the same error in a room.
//!
//! A linear radiosity is B(a, b) = m + g_a a + g_b b in the emitter's own
//! coordinates ([`records::Shape`](crate::scene::records::Shape)), whose origin is
//! the centroid: m is the mean. The irradiance it causes is exact with two more
//! numbers than the form factor,
//!
//! ```text
//! E = ∫ B k dA = F B(ā, b̄),      (ā, b̄) = ∫ (a, b) k dA / F,
//! ```
//!
//! k being the kernel cos θ_r cos θ_e / (π r²): the radiosity at the place where
//! the emitter, as the receiver sees it, has its centre of gravity. It is found
//! by a rule of a few nodes ([`View::moments`]), and F by Eq. 3: the rule's own error
//! then turns up only in how far the place is off.

mod moments;

pub(crate) use moments::is_parallelogram;
pub use moments::{Moments, View};

use core::fmt::Debug;

/// Values that light has, one for each channel.
pub trait Colour: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// How many channels.
    const CHANNELS: usize;
    /// No light.
    const DARK: Self;

    /// The values at the front of a slice; 0 where it is too short.
    fn read(values: &[f32]) -> Self;

    /// A function of every channel.
    fn map(self, f: impl Fn(f32) -> f32) -> Self;

    /// A function of two colours, channel by channel.
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self;

    /// The sum of the channels: what powers are compared by.
    fn total(self) -> f32;

    /// Whether every channel is so.
    #[inline(always)]
    fn all(self, is: impl Fn(f32) -> bool) -> bool {
        let failing = self.map(|a| f32::from(u8::from(!is(a))));
        failing.total() == 0.0
    }

    /// The sum of two.
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    /// Every channel times a number.
    #[inline(always)]
    fn times(self, factor: f32) -> Self {
        self.map(|a| a * factor)
    }
}

impl Colour for f32 {
    const CHANNELS: usize = 1;
    const DARK: Self = 0.0;

    #[inline(always)]
    fn read(values: &[f32]) -> Self {
        values.first().copied().unwrap_or(0.0)
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        f(self)
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        f(self, other)
    }

    #[inline(always)]
    fn total(self) -> f32 {
        self
    }
}

/// Red, green and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rgb(
    /// The channels.
    pub [f32; 3],
);

impl Colour for Rgb {
    const CHANNELS: usize = 3;
    const DARK: Self = Self([0.0; 3]);

    #[inline(always)]
    fn read(values: &[f32]) -> Self {
        match *values {
            [r, g, b, ..] => Self([r, g, b]),
            _ => Self::DARK,
        }
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let ([r, g, b], [s, h, c]) = (self.0, other.0);
        Self([f(r, s), f(g, h), f(b, c)])
    }

    #[inline(always)]
    fn total(self) -> f32 {
        let [r, g, b] = self.0;
        r + g + b
    }
}

#[inline(always)]
fn magnitude(value: f32) -> f32 {
    if value < 0.0 { -value } else { value }
}

/// Radiosity in W m⁻² over an emitter.
pub trait Luminance: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Its channels.
    type Colour: Colour;
    /// Coefficients a channel.
    const COEFFICIENTS: usize;
    /// Whether every member has as many weights, which may be negative; else it is
    /// the members' plain mean.
    const WEIGHTED: bool;
    /// No light.
    const DARK: Self;

    /// Whether an emitter may shoot ahead of light that is still to come: not by
    /// itself where radiosities are sums of bands or layers.
    const AHEAD: bool = false;

    /// The same radiosity all over.
    fn uniform(colour: Self::Colour) -> Self;

    /// The mean radiosity.
    fn mean(self) -> Self::Colour;

    /// What emitters are compared by, about the mean of |B| over the emitter: the sum of
    /// the channels' magnitudes, since light that is to be taken away is left as well.
    #[inline(always)]
    fn strength(self) -> f32 {
        self.mean().map(magnitude).total()
    }

    /// A function of two, coefficient by coefficient.
    fn zip(
        self,
        other: Self,
        f: impl Fn(Self::Colour, Self::Colour) -> Self::Colour + Copy,
    ) -> Self;

    /// Adds the irradiance at one member of an emitter; `weights` are the
    /// member's, none where it counts as much as any other.
    fn gather(self, irradiance: Self::Colour, weights: &[f32]) -> Self;

    /// What `count` gathered members make.
    fn gathered(self, count: usize) -> Self;

    /// The irradiance from a part of the emitter with this form factor;
    /// `place` gives (ā, b̄) where it is needed.
    fn received(self, factor: f32, place: impl FnOnce() -> [f32; 2]) -> Self::Colour;
}

/// The same radiosity all over.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Constant<C>(
    /// The radiosity in W m⁻².
    pub C,
);

impl<C: Colour> Luminance for Constant<C> {
    type Colour = C;
    const COEFFICIENTS: usize = 1;
    const WEIGHTED: bool = false;
    const DARK: Self = Self(C::DARK);

    #[inline(always)]
    fn uniform(colour: C) -> Self {
        Self(colour)
    }

    #[inline(always)]
    fn mean(self) -> C {
        self.0
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(C, C) -> C + Copy) -> Self {
        Self(f(self.0, other.0))
    }

    #[inline(always)]
    fn gather(self, irradiance: C, _: &[f32]) -> Self {
        Self(self.0.plus(irradiance))
    }

    #[inline(always)]
    fn gathered(self, count: usize) -> Self {
        Self(self.0.map(|sum| sum / count as f32))
    }

    #[inline(always)]
    fn received(self, factor: f32, _: impl FnOnce() -> [f32; 2]) -> C {
        self.0.times(factor)
    }
}

/// What an outline adds to the radiosity of everything inside of it; below 0 where
/// the inside is darker.
///
/// A radiosity that falls off in steps, B(x) = Σ_k ΔB_k [x inside outline k], is
/// that of nested emitters, each of one increment all over: of what an outline
/// encloses no inner loop is left out. The members' weights give the increment.
/// The power unshot is Σ |ΔB_k| A_k, not less than that of the sum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Increment<C>(
    /// The increment in W m⁻².
    pub C,
);

impl<C: Colour> Luminance for Increment<C> {
    type Colour = C;
    const COEFFICIENTS: usize = 1;
    const WEIGHTED: bool = true;
    const DARK: Self = Self(C::DARK);

    #[inline(always)]
    fn uniform(colour: C) -> Self {
        Self(colour)
    }

    #[inline(always)]
    fn mean(self) -> C {
        self.0
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(C, C) -> C + Copy) -> Self {
        Self(f(self.0, other.0))
    }

    #[inline(always)]
    fn gather(self, irradiance: C, weights: &[f32]) -> Self {
        let weight = weights.first().copied().unwrap_or(0.0);
        Self(self.0.plus(irradiance.times(weight)))
    }

    #[inline(always)]
    fn gathered(self, _: usize) -> Self {
        self
    }

    #[inline(always)]
    fn received(self, factor: f32, _: impl FnOnce() -> [f32; 2]) -> C {
        self.0.times(factor)
    }
}

/// A radiosity that is linear in the emitter's own coordinates (a, b).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Linear<C> {
    /// The mean in W m⁻², which the centroid has.
    pub mean: C,
    /// What it grows by for 1 of a, and for 1 of b.
    pub gradient: [C; 2],
}

impl<C: Colour> Luminance for Linear<C> {
    type Colour = C;
    const COEFFICIENTS: usize = 3;
    const WEIGHTED: bool = true;
    const AHEAD: bool = true;
    const DARK: Self = Self {
        mean: C::DARK,
        gradient: [C::DARK; 2],
    };

    #[inline(always)]
    fn uniform(colour: C) -> Self {
        Self {
            mean: colour,
            gradient: [C::DARK; 2],
        }
    }

    #[inline(always)]
    fn mean(self) -> C {
        self.mean
    }

    /// The mean's magnitude, or a third of the gradient's where that is more: what is
    /// positive here and negative there is light as well, though its mean is none. (Over
    /// a square the mean of |a| is 0.35.)
    #[inline(always)]
    fn strength(self) -> f32 {
        let [a, b] = self.gradient;
        let steep = a.zip(b, |a, b| (magnitude(a) + magnitude(b)) / 3.0);
        let mean = self.mean.map(magnitude);
        mean.zip(steep, |m, s| if s > m { s } else { m }).total()
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(C, C) -> C + Copy) -> Self {
        let ([a, b], [c, d]) = (self.gradient, other.gradient);
        Self {
            mean: f(self.mean, other.mean),
            gradient: [f(a, c), f(b, d)],
        }
    }

    #[inline(always)]
    fn gather(self, irradiance: C, weights: &[f32]) -> Self {
        let [mean, a, b] = match *weights {
            [mean, a, b, ..] => [mean, a, b],
            _ => [0.0; 3],
        };
        let [along_a, along_b] = self.gradient;
        Self {
            mean: self.mean.plus(irradiance.times(mean)),
            gradient: [
                along_a.plus(irradiance.times(a)),
                along_b.plus(irradiance.times(b)),
            ],
        }
    }

    #[inline(always)]
    fn gathered(self, _: usize) -> Self {
        self
    }

    #[inline(always)]
    fn received(self, factor: f32, place: impl FnOnce() -> [f32; 2]) -> C {
        let [a, b] = place();
        let [along_a, along_b] = self.gradient;
        let there = self.mean.plus(along_a.times(a)).plus(along_b.times(b));
        there.times(factor)
    }
}
