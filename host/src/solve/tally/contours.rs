//! What loops take on every rung of arithmetic, counted.

use super::number::{self, CountedRoot, Kind, Number32, done};
use super::seen::arithmetic;
use super::{HostRoot, Operation, count};
use isolux::form_factor::{Arithmetic, Best, Libm, Micromath, Outline, Poly3, Poly5, Poly8};
use isolux::geometry::{Receiver, Vector};
use isolux::number::ArcCosine;
use std::marker::PhantomData;

/// A rung whose loops are counted.
pub(super) trait Known: Arithmetic<f32> {
    /// The same in numbers that count.
    type Counting: Arithmetic<Number32>;
    /// Whether small loops have a way of their own.
    const NARROW: bool;
    /// Roots of an edge that takes no more of them than others.
    const ROOTS: usize;
}

macro_rules! known {
    ($($rung:ty, $counting:ty, $narrow:literal, $roots:literal;)+) => {
        $(impl Known for $rung {
            type Counting = $counting;
            const NARROW: bool = $narrow;
            const ROOTS: usize = $roots;
        })+
    };
}

known! {
    Best<HostRoot>, Best<CountedRoot>, true, 1;
    Poly3<HostRoot>, Poly3<CountedRoot>, true, 1;
    Poly5<HostRoot>, Poly5<CountedRoot>, true, 1;
    Poly8<HostRoot>, Poly8<CountedRoot>, true, 1;
    Libm<HostRoot>, Libm<CountedRoot>, false, 3;
    // Its functions have numbers of one type; it walks as `libm` does.
    Micromath, Libm<CountedRoot>, false, 3;
}

/// Half of libm's arc cosines take a root, by which they are told apart.
impl ArcCosine for Number32 {
    fn acos(self) -> Self {
        if self.0.abs() >= 0.5 {
            number::count(Kind::Root);
        }
        Self(self.0.acos())
    }
}

/// A rung, counted.
pub(super) struct Counted<A>(PhantomData<A>);

impl<A: Known> Arithmetic<f32> for Counted<A> {
    type Root = A::Root;

    fn contour(receiver: &Receiver<f32>, facing: Vector<f32>, outline: &Outline<'_, f32>) -> f32 {
        contour::<A>(receiver, facing, outline);
        A::contour(receiver, facing, outline)
    }
}

/// Counts what a loop takes.
fn contour<A: Known>(from: &Receiver<f32>, facing: Vector<f32>, outline: &Outline<'_, f32>) {
    let relative = |&vertex: &[f32; 3]| Vector::from(vertex) - from.position();
    let vertices = outline.vertices();
    // As the rung decides: seen within 22.5° of the first vertex.
    let near = |first| outline.reach_squared() <= 0.1464 * relative(first).norm_squared();
    let small = A::NARROW && vertices.first().is_some_and(near);
    let above = { vertices.iter() }
        .filter(|vertex| from.normal().dot(relative(vertex)) >= 0.0)
        .count();
    let whole = above == vertices.len();
    if small && whole {
        count(Operation::SmallLoop, 1);
        count(Operation::SmallCorner, vertices.len());
        return;
    }
    let Some(receiver) = number::receiver(from) else {
        return;
    };
    let counted: Vec<[Number32; 3]> = vertices.iter().map(|v| v.map(Number32)).collect();
    let counted = Outline::new(&counted);
    done();
    A::Counting::contour(&receiver, number::vector(facing), &counted);
    if small {
        let quotients = done()[Kind::Quotient as usize] as usize;
        count(Operation::SmallCut, 1);
        count(Operation::SmallCutQuotient, quotients);
    } else if whole {
        let roots = done()[Kind::Root as usize] as usize;
        let usual = A::ROOTS * vertices.len();
        count(Operation::Loop, 1);
        count(Operation::Corner, vertices.len());
        count(Operation::Obtuse, roots.saturating_sub(usual));
    } else {
        count(Operation::CutLoop, 1);
        arithmetic([
            (Kind::Sum, Operation::CutSum),
            (Kind::Product, Operation::CutProduct),
            (Kind::Quotient, Operation::CutQuotient),
            (Kind::Comparison, Operation::CutComparison),
            (Kind::Root, Operation::CutRoot),
        ]);
    }
}
