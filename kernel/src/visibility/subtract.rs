//! Pieces of an emitter, cut along what hides them.

use super::line::Line;
use super::pieces::{Piece, Sum};
use super::polygon::{Full, Polygon, Side};
use crate::form_factor::SeenPlane;
use crate::number::Floating;
use core::mem::swap;

/// A piece that waits until those outside of it are done.
#[derive(Clone, Debug)]
pub(super) struct Waiting<N, const VERTICES: usize> {
    pub(super) piece: Polygon<N, VERTICES>,
    pub(super) at: Place,
}

/// How far a piece has come.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// The blocker to go on with: those before hide nothing of the piece.
    pub(super) blocker: usize,
    /// The line to go on with: the piece is inside of those before.
    pub(super) line: usize,
}

impl Place {
    pub(super) fn next_blocker(self) -> Self {
        Self {
            blocker: self.blocker.wrapping_add(1),
            line: 0,
        }
    }

    pub(super) fn next_line(self) -> Self {
        Self {
            blocker: self.blocker,
            line: self.line.wrapping_add(1),
        }
    }
}

/// What becomes of a piece.
pub(super) enum Step {
    /// It goes on.
    Same,
    /// It is split into both buffers, inside and outside of a line.
    Split,
    /// It is seen, hidden or given up.
    Done,
}

/// What a fold reads.
pub(super) struct Kept<'w, N> {
    pub(super) seen: &'w SeenPlane<N>,
    pub(super) lines: &'w [Line<N>],
    pub(super) ends: &'w [u16],
}

impl<'w, N: Floating> Kept<'w, N> {
    /// The lines of one blocker; `None` behind the last.
    #[inline(always)]
    pub(super) fn lines_of(&self, blocker: usize) -> Option<&'w [Line<N>]> {
        let end = usize::from(*self.ends.get(blocker)?);
        let start = match blocker.checked_sub(1) {
            Some(before) => usize::from(*self.ends.get(before)?),
            None => 0,
        };
        self.lines.get(start..end)
    }

    /// Takes a piece past one line or one blocker.
    #[inline]
    pub(super) fn step<const VERTICES: usize>(
        &self,
        at: &mut Place,
        piece: &Polygon<N, VERTICES>,
        [inner, outer]: [&mut Polygon<N, VERTICES>; 2],
        sum: &mut impl Sum<N>,
    ) -> Step {
        let Some(own) = self.lines_of(at.blocker) else {
            if !piece.is_thin() {
                sum.visible(&Piece::of(self.seen, piece));
            }
            return Step::Done;
        };
        if at.line == 0 {
            match overlap(own, piece, [&mut *inner, &mut *outer]) {
                Ok(Overlap::Apart) => {
                    *at = at.next_blocker();
                    return Step::Same;
                }
                Ok(Overlap::Covered) => return Step::Done,
                Ok(Overlap::Hidden(part)) => {
                    let last = at.next_blocker().blocker == self.ends.len();
                    let hidden = Piece::of(self.seen, part);
                    if last && sum.difference(&Piece::of(self.seen, piece), &hidden) {
                        return Step::Done;
                    }
                }
                Err(Full) => {
                    sum.unresolved(&Piece::of(self.seen, piece));
                    return Step::Done;
                }
            }
        }
        let Some(line) = own.get(at.line) else {
            return Step::Done; // inside of all lines: hidden
        };
        match piece.side(line) {
            Side::Inside => *at = at.next_line(),
            Side::Outside => *at = at.next_blocker(),
            Side::On => return Step::Done,
            Side::Both if piece.split(line, inner, outer).is_ok() => return Step::Split,
            Side::Both => {
                sum.unresolved(&Piece::of(self.seen, piece));
                return Step::Done;
            }
        }
        Step::Same
    }
}

/// How a piece lies to a blocker.
enum Overlap<'a, N, const VERTICES: usize> {
    Apart,
    /// Nothing of the piece is seen.
    Covered,
    /// This part of the piece is not seen.
    Hidden(&'a Polygon<N, VERTICES>),
}

/// How a piece lies to the inside of all lines.
#[inline]
fn overlap<'a, N: Floating, const VERTICES: usize>(
    lines: &[Line<N>],
    piece: &Polygon<N, VERTICES>,
    buffers: [&'a mut Polygon<N, VERTICES>; 2],
) -> Result<Overlap<'a, N, VERTICES>, Full> {
    // Which of the first 32 lines cut nothing off the piece, nor off a part.
    let (mut idle, mut bit) = (0_u32, 1_u32);
    for line in lines {
        match piece.side(line) {
            Side::Outside => return Ok(Overlap::Apart),
            // Within rounding of a line nothing is known: no light leaks
            // through pieces that no line can tell from itself.
            Side::On => return Ok(Overlap::Covered),
            Side::Inside => idle |= bit,
            Side::Both => {}
        }
        bit = bit.wrapping_shl(1);
    }
    let [mut common, mut spare] = buffers;
    let (mut cut, mut bit) = (false, 1_u32);
    for line in lines {
        if idle & bit == 0 {
            let from = if cut { &*common } else { piece };
            match from.clip(line, spare)? {
                Side::Inside => {}
                Side::Outside | Side::On => return Ok(Overlap::Apart),
                Side::Both => {
                    swap(&mut common, &mut spare);
                    cut = true;
                }
            }
        }
        bit = bit.wrapping_shl(1);
    }
    Ok(if cut {
        Overlap::Hidden(common)
    } else {
        Overlap::Covered
    })
}
