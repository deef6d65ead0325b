//! What of an emitter is seen from a point, with occluders in between.
//!
//! A rung is a type ([`Visibility`]): [`Unoccluded`] links nothing,
//! [`VertexRays`] is the paper's, [`Exact`] evaluates the form factor of the
//! visible part. Occluders are convex polygons, which block from both sides,
//! and closed convex bodies, each of which is one silhouette; the host makes
//! both out of whatever a scene holds ([`records`]).
//!
//! # How
//!
//! All work happens in the emitter's plane, in coordinates of its own frame,
//! where a plane through the receiver is a line and a piece of the emitter a
//! few pairs of numbers. Nothing is projected and nothing is divided but to
//! find a crossing. See [`Exact`] for the cuts, which decide with a tolerance:
//! a corner within rounding of a line is on it and belongs to both parts, so
//! that no light leaks between occluders that share an edge or meet in a
//! T-junction.
//!
//! # Contact
//!
//! A polygon hides nothing from a receiver on its plane, within
//! [`Occluders::flat`](records::Occluders::flat): a receiver's own surface and
//! its coplanar neighbours need no names. This is a jump, not an error: at
//! twice that distance the polygon does block. A receiver inside of a body
//! sees nothing.
//!
//! # Error
//!
//! In `f32`, |ΔF| ≤ 1e-6 of the unoccluded form factor and the unoccluded
//! kernel's own error; another occluder, or another order of them, changes F by
//! at most that much where it should not. 0 ≤ F_visible ≤ F exactly. Where a
//! capacity is met the answer is a [`Bracket`] that holds the truth, never an
//! error.

mod exact;
mod line;
mod pieces;
mod polygon;
mod rays;
pub mod records;
mod subtract;
mod view;

pub use exact::{Exact, Gathered};
pub use pieces::{Piece, Seen, Sum};
pub use rays::VertexRays;

use crate::geometry::Receiver;
use crate::luminance::Colour;
use crate::number::{Floating, Number, Root};
use records::{Blocker, Occluders, Target};

/// A rung of the visibility ladder, with the workspace it needs.
pub trait Visibility<N: Floating = f32> {
    /// The form factor of the part of `target` that is seen from `receiver`,
    /// 0 ≤ F ≤ `unoccluded()`.
    ///
    /// `blockers` is the target's list, in the order of the tables;
    /// `unoccluded` the form factor of the whole target, by whatever rung of the
    /// arithmetic ladder: it is the answer where nothing hides any of it, and is
    /// asked for at most once. Never panics, never NaN where `unoccluded` is
    /// not.
    fn form_factor<R: Root<N> + Copy>(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> N,
    ) -> Bracket<N>;

    /// What of `target` is seen from `receiver`; where it is some parts only,
    /// `parts` is told which.
    ///
    /// [`form_factor`](Self::form_factor) for light that varies over the target:
    /// the pieces themselves, not only their sum. Never panics.
    fn look(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        parts: &mut impl Sum<N>,
    ) -> Looked<N>;

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

    /// What the type holds; a scene that needs more is refused on load.
    const CAPACITIES: Capacities;

    /// Whether emitters may be points, which nothing hides; where they may not, nothing
    /// for them is linked, and a scene whose emitters have shapes is refused.
    const POINTS: bool = true;
}

/// What a workspace holds, for one receiver and one emitter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Capacities {
    /// Whether occluders count at all.
    pub occluders: bool,
    /// Corners of a piece.
    pub vertices: u32,
    /// Pieces that wait.
    pub pieces: u32,
    /// Lines kept.
    pub lines: u32,
    /// Blockers kept.
    pub blockers: u32,
}

/// What a look found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Looked<N> {
    /// Nothing is seen.
    Dark,
    /// All of the target is seen.
    Whole,
    /// This fraction of its form factor is taken as seen.
    Fraction(N),
    /// Those parts are seen that were told.
    Parts,
    /// At most those parts are seen that were told: blockers had to be left out.
    AtMost,
    /// Nothing is known: anything between nothing and all of it.
    Unknown,
}

/// An answer between two bounds, equal where it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Bracket<N> {
    /// The truth is not below this.
    pub low: N,
    /// The truth is not above this.
    pub high: N,
}

impl<N: Copy + PartialEq> Bracket<N> {
    /// A known answer.
    pub fn exactly(value: N) -> Self {
        Self {
            low: value,
            high: value,
        }
    }

    /// Whether the answer is known.
    pub fn is_exact(&self) -> bool {
        self.low == self.high
    }
}

impl<C: Colour> Bracket<C> {
    /// The sums of both bounds.
    #[inline]
    pub fn plus(self, other: Self) -> Self {
        Self {
            low: self.low.plus(other.low),
            high: self.high.plus(other.high),
        }
    }

    /// The value itself where it is known, else the middle of the two.
    #[inline]
    pub fn middle(self) -> C {
        if self.low == self.high {
            self.low
        } else {
            self.low.zip(self.high, |low, high| 0.5 * low + 0.5 * high)
        }
    }
}

impl<N: Number> Bracket<N> {
    /// Both bounds lowered to `ceiling`, where they are above it.
    pub fn at_most(self, ceiling: N) -> Self {
        let lower = |x: N| if x < ceiling { x } else { ceiling };
        Self {
            low: lower(self.low),
            high: lower(self.high),
        }
    }
}

/// The rung `none`: nothing hides anything, and nothing is linked.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unoccluded;

impl<N: Floating> Visibility<N> for Unoccluded {
    #[inline(always)]
    fn form_factor<R: Root<N> + Copy>(
        &mut self,
        _: &Receiver<N>,
        _: &Target<'_>,
        _: &Occluders<'_>,
        _: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> N,
    ) -> Bracket<N> {
        Bracket::exactly(unoccluded())
    }

    #[inline(always)]
    fn look(
        &mut self,
        _: &Receiver<N>,
        _: &Target<'_>,
        _: &Occluders<'_>,
        _: impl Iterator<Item = Blocker>,
        _: &mut impl Sum<N>,
    ) -> Looked<N> {
        Looked::Whole
    }

    const CAPACITIES: Capacities = Capacities {
        occluders: false,
        vertices: 0,
        pieces: 0,
        lines: 0,
        blockers: 0,
    };
}

/// The rung `none` where no emitter is a point, since none has a shape: nothing is linked
/// for these either.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Polygons;

impl<N: Floating> Visibility<N> for Polygons {
    #[inline(always)]
    fn form_factor<R: Root<N> + Copy>(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> N,
    ) -> Bracket<N> {
        Unoccluded.form_factor::<R>(receiver, target, occluders, blockers, unoccluded)
    }

    #[inline(always)]
    fn look(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        parts: &mut impl Sum<N>,
    ) -> Looked<N> {
        Unoccluded.look(receiver, target, occluders, blockers, parts)
    }

    const CAPACITIES: Capacities = <Unoccluded as Visibility<N>>::CAPACITIES;
    const POINTS: bool = false;
}
