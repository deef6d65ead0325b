//! What looks, pieces and rules do, counted.

use super::number::{CountedRoot, KINDS, Kind, Number32, done, receiver};
use super::{Operation, count};
use isolux::geometry::Receiver;
use isolux::visibility::records::{Blocker, Occluders, Target};
use isolux::visibility::{Exact, Gathered, Piece, Sum, VertexRays, Visibility};

/// The host's workspace of [`Looking`](super::super::looking::Looking), in numbers that
/// count.
pub(super) type Workspace = Exact<32, 64, 256, 64, Number32>;

/// Adds what was done since it was last asked to operations, by kind.
pub(super) fn arithmetic(operations: [(Kind, Operation); KINDS - 1]) {
    let done = done();
    for (kind, operation) in operations {
        count(operation, done[kind as usize] as usize);
    }
}

const LOOK: [(Kind, Operation); KINDS - 1] = [
    (Kind::Read, Operation::LookRead),
    (Kind::Sum, Operation::LookSum),
    (Kind::Product, Operation::LookProduct),
    (Kind::Quotient, Operation::LookQuotient),
    (Kind::Comparison, Operation::LookComparison),
];

const SPLIT: [(Kind, Operation); KINDS - 1] = [
    (Kind::Sum, Operation::SplitSum),
    (Kind::Product, Operation::SplitProduct),
    (Kind::Quotient, Operation::SplitQuotient),
    (Kind::Comparison, Operation::SplitComparison),
    // There is none.
    (Kind::Root, Operation::SplitQuotient),
];

const PIECE: [(Kind, Operation); KINDS - 1] = [
    (Kind::Sum, Operation::PieceSum),
    (Kind::Product, Operation::PieceProduct),
    (Kind::Quotient, Operation::PieceQuotient),
    (Kind::Comparison, Operation::PieceComparison),
    (Kind::Root, Operation::PieceRoot),
];

/// Looks once more, and counts: what may hide, the cuts, the pieces; `is_linear` where
/// the centres of gravity of pieces are asked for.
pub(super) fn look(
    exact: &mut Workspace,
    from: &Receiver<f32>,
    target: &Target<'_>,
    occluders: &Occluders<'_>,
    blockers: &[Blocker],
    is_linear: bool,
) {
    let Some(receiver) = receiver(from) else {
        return;
    };
    count(Operation::Look, 1);
    count(Operation::Listed, blockers.len());
    let gathered = exact.gather(&receiver, target, occluders, blockers.iter().copied());
    arithmetic(LOOK);
    if gathered != Gathered::Partly {
        return;
    }
    let (kept, lines) = exact.kept();
    count(Operation::Kept, kept);
    count(Operation::Line, lines);
    exact.add_to(&mut Pieces {
        is_near: is_near(from, target.origin, target.radius),
        is_linear,
    });
    arithmetic(SPLIT);
}

/// Looks once more by rays, and counts.
pub(super) fn rays(
    from: &Receiver<f32>,
    target: &Target<'_>,
    occluders: &Occluders<'_>,
    blockers: &[Blocker],
) {
    let Some(receiver) = receiver(from) else {
        return;
    };
    count(Operation::Look, 1);
    count(Operation::Listed, blockers.len());
    // Rays cut nothing into pieces.
    let mut none = Pieces {
        is_near: false,
        is_linear: false,
    };
    let blockers = blockers.iter().copied();
    VertexRays.look(&receiver, target, occluders, blockers, &mut none);
    arithmetic(LOOK);
}

/// A sum over pieces, counted.
struct Pieces {
    is_near: bool,
    is_linear: bool,
}

impl Pieces {
    fn form_factor(&self, piece: &Piece<'_, Number32>) -> Number32 {
        arithmetic(SPLIT);
        let factor = piece.form_factor::<CountedRoot>();
        arithmetic(PIECE);
        count(Operation::Piece, 1);
        count(Operation::PieceCorner, piece.corners().len());
        factor
    }

    fn moments(&self, piece: &Piece<'_, Number32>) {
        if self.is_linear {
            let corners = piece.corners().iter();
            let corners: Vec<[f32; 2]> = corners.map(|corner| corner.map(|x| x.0)).collect();
            rule(&corners, 1.0, self.is_near);
        }
    }
}

impl Sum<Number32> for Pieces {
    fn visible(&mut self, piece: &Piece<'_, Number32>) {
        self.form_factor(piece);
        self.moments(piece);
    }

    fn unresolved(&mut self, piece: &Piece<'_, Number32>) {
        self.visible(piece);
    }

    fn difference(&mut self, piece: &Piece<'_, Number32>, hidden: &Piece<'_, Number32>) -> bool {
        let (all, part) = (self.form_factor(piece), self.form_factor(hidden));
        // As the kernel decides.
        let clear = part.0 < 0.75 * all.0;
        if clear {
            self.moments(piece);
            self.moments(hidden);
        }
        clear
    }
}

/// Whether a receiver is so near that a rule takes many nodes: as
/// [`View::moments`](isolux::luminance::View::moments) decides.
pub(super) fn is_near(receiver: &Receiver<f32>, origin: [f32; 3], radius: f32) -> bool {
    let axis = isolux::geometry::Vector::from(origin) - receiver.position();
    axis.norm_squared() <= 9.0 * (radius * radius)
}

/// A rule over a polygon in a frame of this length.
pub(super) fn rule<const N: usize>(corners: &[[f32; N]], length: f32, is_near: bool) {
    count(Operation::Rule, 1);
    let is_parallelogram = match corners {
        [p, q, r, s] => {
            (0..N).all(|axis| ((p[axis] - q[axis]) + (r[axis] - s[axis])).abs() <= 2e-6 * length)
        }
        _ => false,
    };
    match (is_parallelogram, is_near) {
        (true, true) => count(Operation::RuleNear, 1),
        (true, false) => count(Operation::RuleFar, 1),
        (false, true) => count(Operation::FanNear, corners.len().saturating_sub(2)),
        (false, false) => count(Operation::FanFar, corners.len().saturating_sub(2)),
    }
}
