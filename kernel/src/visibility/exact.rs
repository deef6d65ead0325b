//! The visible part of an emitter, exactly.
//!
//! From a point, an occluder hides a convex part of the emitter's plane: the
//! inside of one line for every edge of its outline. The emitter starts as one
//! convex piece; from every piece the hidden parts are cut off, one occluder
//! after the other, depth first, and what remains of a piece behind the last
//! occluder is visible. The pieces of one occluder's outside are made by its
//! lines one after the other: outside of line 0; inside of line 0 and outside
//! of line 1; and so on, which is a partition, so that nothing is counted
//! twice.

use super::line::Line;
use super::pieces::{FormFactor, Piece, Seen, Sum};
use super::polygon::{Full, Polygon, Side};
use super::records::{Blocker, Occluders, Target};
use super::subtract::{Kept, Place, Step, Waiting};
use super::view::{Shadow, View, number};
use super::{Bracket, Capacities, Looked, Visibility};
use crate::form_factor::SeenPlane;
use crate::geometry::{Receiver, Vector};
use crate::number::{Floating, Root};
use core::marker::PhantomData;
use core::mem::swap;
use heapless::Vec;

/// The rung `exact`, with its workspace.
///
/// Capacities, all counted for one receiver and one emitter: `VERTICES` corners
/// of a piece (a cut adds at most one), `PIECES` pieces that wait (at most one
/// for each blocker kept), `LINES` lines and `BLOCKERS` blockers kept. Where
/// one of them does not suffice, the answer is a bracket that holds the truth.
///
/// The caller owns it; nothing is kept between two calls of
/// [`gather`](Self::gather), and it is never zero-filled. Its size is that of
/// the type: 8, 4, 24, 6 in `f32` holds every shipped scene.
#[derive(Clone, Debug)]
pub struct Exact<
    const VERTICES: usize,
    const PIECES: usize,
    const LINES: usize,
    const BLOCKERS: usize,
    N = f32,
> {
    seen: SeenPlane<N>,
    /// The target above the horizon.
    whole: Polygon<N, VERTICES>,
    lines: Vec<Line<N>, LINES>,
    /// Behind which line every blocker's lines end.
    ends: Vec<u16, BLOCKERS>,
    /// Blockers that did not fit.
    left_out: u32,
    waiting: Vec<Waiting<N, VERTICES>, PIECES>,
    scratch: [Polygon<N, VERTICES>; 3],
}

/// What [`Exact::gather`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Gathered {
    /// F = 0: the receiver is on or behind the target's plane, the target below
    /// its horizon, or all of it hidden.
    Dark,
    /// Nothing hides any of the target: F is the unoccluded form factor.
    Whole,
    /// Something may hide a part of it: fold.
    Partly,
    /// The target has more corners than `VERTICES` holds: nothing is known but
    /// 0 ≤ F ≤ the unoccluded form factor.
    Overflow,
}

impl<
    const VERTICES: usize,
    const PIECES: usize,
    const LINES: usize,
    const BLOCKERS: usize,
    N: Floating,
> Exact<VERTICES, PIECES, LINES, BLOCKERS, N>
{
    /// An empty workspace.
    pub const fn new() -> Self {
        Self {
            seen: SeenPlane {
                origin: Vector::ZERO,
                axes: [Vector::ZERO; 2],
                facing: Vector::ZERO,
                normal: Vector::ZERO,
            },
            whole: Polygon::new(),
            lines: Vec::new(),
            ends: Vec::new(),
            left_out: 0,
            waiting: Vec::new(),
            scratch: [Polygon::new(), Polygon::new(), Polygon::new()],
        }
    }

    /// Finds what may hide a target from a receiver: all that
    /// [`fold`](Self::fold) needs.
    ///
    /// Cost on a Cortex-M4F: 40 to 80 instructions for a blocker that cannot
    /// hide anything, about 500 for one that nearly does. Never panics.
    pub fn gather(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
    ) -> Gathered {
        self.lines.clear();
        self.ends.clear();
        self.left_out = 0;
        let Some(view) = View::new(receiver, target, occluders.flat) else {
            return Gathered::Dark;
        };
        self.seen = view.seen;
        match self.above_horizon(&view, target) {
            Ok(Side::Outside | Side::On) => return Gathered::Dark,
            Ok(_) => {}
            Err(Full) => return Gathered::Overflow,
        }
        for blocker in blockers {
            if self.keep(&view, occluders, &blocker) {
                return Gathered::Dark;
            }
        }
        if self.ends.is_empty() && self.left_out == 0 {
            Gathered::Whole
        } else {
            Gathered::Partly
        }
    }

    /// How many blockers the last [`gather`](Self::gather) kept, and how many
    /// lines: what the capacities are planned from.
    pub fn kept(&self) -> (usize, usize) {
        (self.ends.len(), self.lines.len())
    }

    /// The target clipped to the receiver's horizon.
    fn above_horizon(&mut self, view: &View<N>, target: &Target<'_>) -> Result<Side, Full> {
        let [unclipped, ..] = &mut self.scratch;
        unclipped.set(target.corners.iter().map(|corner| corner.map(number)))?;
        let side = unclipped.clip_to_horizon(&view.horizon(), &mut self.whole)?;
        if side == Side::Inside {
            self.whole.copy_from(unclipped);
        }
        Ok(side)
    }

    /// Keeps the lines of a blocker that may hide some of the target; `true`
    /// where it hides all of it.
    #[inline]
    fn keep(&mut self, view: &View<N>, occluders: &Occluders<'_>, blocker: &Blocker) -> bool {
        let Self {
            whole,
            lines,
            ends,
            left_out,
            ..
        } = self;
        let first = lines.len();
        let (mut asked, mut apart, mut cuts, mut full) = (false, false, false, false);
        let shadow = view.shadow(occluders, blocker, |line| {
            asked = true;
            match whole.side(line) {
                // A line that has all of the target inside cuts nothing off.
                Side::Inside => {}
                Side::Outside | Side::On => apart = true,
                Side::Both => {
                    cuts = true;
                    full |= lines.push(*line).is_err();
                }
            }
            !apart
        });
        match shadow {
            Shadow::All => return true,
            Shadow::Lines if asked && !apart && !cuts => return true,
            Shadow::Lines if asked && !apart => {
                let end = u16::try_from(lines.len());
                full = full || !end.is_ok_and(|end| ends.push(end).is_ok());
                if full {
                    lines.truncate(first);
                    *left_out = left_out.saturating_add(1);
                }
            }
            Shadow::Lines | Shadow::None => lines.truncate(first),
        }
        false
    }

    /// Folds over the visible pieces of what was gathered.
    ///
    /// The pieces do not overlap and come in an order that the tables fix.
    /// Cost: at most 1 + L + L(L − 1)/2 pieces for L lines kept; in practice
    /// few more than blockers. Never panics.
    pub fn fold<S: Clone>(&mut self, sum: S, add: impl FnMut(&mut S, &Piece<'_, N>)) -> Seen<S> {
        struct Fold<S, A> {
            visible: S,
            unresolved: S,
            pieces: u32,
            add: A,
        }
        impl<N, S, A: FnMut(&mut S, &Piece<'_, N>)> Sum<N> for Fold<S, A> {
            fn visible(&mut self, piece: &Piece<'_, N>) {
                (self.add)(&mut self.visible, piece);
            }
            fn unresolved(&mut self, piece: &Piece<'_, N>) {
                self.pieces = self.pieces.saturating_add(1);
                (self.add)(&mut self.unresolved, piece);
            }
        }
        let mut fold = Fold {
            visible: sum.clone(),
            unresolved: sum,
            pieces: 0,
            add,
        };
        self.add_to(&mut fold);
        Seen {
            visible: fold.visible,
            unresolved: fold.unresolved,
            pieces: fold.pieces,
            left_out: self.left_out,
        }
    }

    /// As [`fold`](Self::fold), for a sum that can also take differences.
    pub fn add_to(&mut self, sum: &mut impl Sum<N>) {
        let kept = Kept {
            seen: &self.seen,
            lines: &self.lines,
            ends: &self.ends,
        };
        let [piece, outer, inner] = &mut self.scratch;
        let (mut piece, mut outer) = (piece, outer);
        self.waiting.clear();
        piece.copy_from(&self.whole);
        let mut at = Place::default();
        loop {
            match kept.step(&mut at, piece, [&mut *inner, &mut *outer], sum) {
                Step::Same => {}
                Step::Split => {
                    if at.line.wrapping_add(1) < kept.lines_of(at.blocker).map_or(0, <[_]>::len) {
                        let waiting = Waiting {
                            piece: inner.clone(),
                            at: at.next_line(),
                        };
                        if self.waiting.push(waiting).is_err() {
                            sum.unresolved(&Piece::of(kept.seen, inner));
                        }
                    }
                    swap(&mut piece, &mut outer);
                    at = at.next_blocker();
                }
                Step::Done => {
                    let Some(next) = self.waiting.pop() else {
                        return;
                    };
                    piece.copy_from(&next.piece);
                    at = next.at;
                }
            }
        }
    }

    /// The form factor of the visible part of what was gathered, as a bracket.
    ///
    /// Error: that of [`Best`](crate::form_factor::Best) on the whole target,
    /// and 1e-6 of its form factor.
    pub fn form_factor<R: Root<N> + Copy>(&mut self) -> Bracket<N> {
        self.bracket::<R>(None)
    }

    /// The same, with the form factor of the whole target where it is known.
    fn bracket<R: Root<N> + Copy>(&mut self, whole: Option<N>) -> Bracket<N> {
        let mut sum = FormFactor::<N, R> {
            whole,
            visible: N::ZERO,
            unresolved: N::ZERO,
            root: PhantomData,
        };
        self.add_to(&mut sum);
        let high = sum.visible + sum.unresolved;
        let low = if self.left_out == 0 {
            sum.visible
        } else {
            N::ZERO
        };
        Bracket { low, high }
    }
}

impl<
    const VERTICES: usize,
    const PIECES: usize,
    const LINES: usize,
    const BLOCKERS: usize,
    N: Floating,
> Default for Exact<VERTICES, PIECES, LINES, BLOCKERS, N>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<
    const VERTICES: usize,
    const PIECES: usize,
    const LINES: usize,
    const BLOCKERS: usize,
    N: Floating,
> Visibility<N> for Exact<VERTICES, PIECES, LINES, BLOCKERS, N>
{
    fn form_factor<R: Root<N> + Copy>(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        unoccluded: impl FnOnce() -> N,
    ) -> Bracket<N> {
        match self.gather(receiver, target, occluders, blockers) {
            Gathered::Dark => Bracket::exactly(N::ZERO),
            Gathered::Whole => Bracket::exactly(unoccluded()),
            Gathered::Partly => {
                let whole = unoccluded();
                self.bracket::<R>(Some(whole)).at_most(whole)
            }
            Gathered::Overflow => Bracket {
                low: N::ZERO,
                high: unoccluded(),
            },
        }
    }

    // Its polygons are then not on the stack while a form factor of the whole is
    // computed.
    #[inline(never)]
    fn look(
        &mut self,
        receiver: &Receiver<N>,
        target: &Target<'_>,
        occluders: &Occluders<'_>,
        blockers: impl Iterator<Item = Blocker>,
        parts: &mut impl Sum<N>,
    ) -> Looked<N> {
        match self.gather(receiver, target, occluders, blockers) {
            Gathered::Dark => Looked::Dark,
            Gathered::Whole => Looked::Whole,
            Gathered::Partly => {
                self.add_to(parts);
                if self.left_out > 0 {
                    Looked::AtMost
                } else {
                    Looked::Parts
                }
            }
            Gathered::Overflow => Looked::Unknown,
        }
    }

    const CAPACITIES: Capacities = Capacities {
        occluders: true,
        vertices: VERTICES as u32,
        pieces: PIECES as u32,
        lines: LINES as u32,
        blockers: BLOCKERS as u32,
    };
}
