//! The visible pieces of an emitter, and what is added up over them.

use super::polygon::Polygon;
use crate::form_factor::{SeenPlane, of_clipped};
use crate::number::{Floating, Root};
use core::marker::PhantomData;

/// A convex visible piece of a target.
#[derive(Clone, Copy, Debug)]
pub struct Piece<'a, N> {
    seen: &'a SeenPlane<N>,
    corners: &'a [[N; 2]],
    horizon: Option<usize>,
    whole: bool,
}

impl<'a, N: Floating> Piece<'a, N> {
    pub(super) fn of<const VERTICES: usize>(
        seen: &'a SeenPlane<N>,
        polygon: &'a Polygon<N, VERTICES>,
    ) -> Self {
        Self {
            seen,
            corners: polygon.corners(),
            horizon: polygon.horizon(),
            whole: polygon.is_uncut(),
        }
    }

    /// Its corners (a, b) in the target's frame, counter-clockwise seen from
    /// the emitting side.
    pub fn corners(&self) -> &'a [[N; 2]] {
        self.corners
    }

    /// The corner at which the edge along the receiver's horizon begins.
    pub fn horizon(&self) -> Option<usize> {
        self.horizon
    }

    /// Whether it is all of the target that is above the horizon.
    pub fn is_whole(&self) -> bool {
        self.whole
    }

    /// The target's plane as the receiver sees it.
    pub fn plane(&self) -> &'a SeenPlane<N> {
        self.seen
    }

    /// Its form factor, F ≥ 0.
    pub fn form_factor<R: Root<N> + Copy>(&self) -> N {
        of_clipped::<N, R>(self.seen, self.corners, self.horizon)
    }
}

/// What a fold over the visible pieces adds up.
pub trait Sum<N> {
    /// A piece that is seen.
    fn visible(&mut self, piece: &Piece<'_, N>);

    /// A piece of which it is not known whether it is seen: a bound was met.
    fn unresolved(&mut self, piece: &Piece<'_, N>);

    /// `piece` without its part `hidden` is seen: adds the difference and says
    /// `true`, or says `false` and gets it in pieces.
    ///
    /// One difference costs less than the pieces, but cancels where little is
    /// left.
    fn difference(&mut self, piece: &Piece<'_, N>, hidden: &Piece<'_, N>) -> bool {
        let _ = (piece, hidden);
        false
    }
}

/// What a fold found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen<S> {
    /// The sum over the pieces that are seen.
    pub visible: S,
    /// The sum over the pieces of which it is not known.
    pub unresolved: S,
    /// How many pieces that are.
    pub pieces: u32,
    /// How many blockers did not fit: what they hide is counted as seen.
    pub left_out: u32,
}

impl<S> Seen<S> {
    /// Whether all is known.
    pub fn is_complete(&self) -> bool {
        self.pieces == 0 && self.left_out == 0
    }
}

/// The sum of form factors.
pub(super) struct FormFactor<N, R> {
    /// That of the whole target, where it is known.
    pub(super) whole: Option<N>,
    pub(super) visible: N,
    pub(super) unresolved: N,
    pub(super) root: PhantomData<R>,
}

impl<N: Floating, R: Root<N> + Copy> Sum<N> for FormFactor<N, R> {
    fn visible(&mut self, piece: &Piece<'_, N>) {
        self.visible = self.visible + piece.form_factor::<R>();
    }

    fn unresolved(&mut self, piece: &Piece<'_, N>) {
        self.unresolved = self.unresolved + piece.form_factor::<R>();
    }

    fn difference(&mut self, piece: &Piece<'_, N>, hidden: &Piece<'_, N>) -> bool {
        let all = match self.whole {
            Some(whole) if piece.is_whole() => whole,
            _ => piece.form_factor::<R>(),
        };
        let part = hidden.form_factor::<R>();
        let clear = part < all * N::of(0.75);
        if clear {
            self.visible = self.visible + (all - part);
        }
        clear
    }
}
