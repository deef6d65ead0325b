//! Numbers that count what is done with them: the kernel's looks and loops are generic in
//! their number, so that what they do on every path is had from one more call with these.

use super::super::HostRoot;
use isolux::geometry::{Receiver, Vector};
use isolux::number::{Floating, Number, Root};
use std::cell::Cell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A kind of arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A number of the tables taken in, or a constant.
    Read,
    /// A sum, a difference, a sign.
    Sum,
    Product,
    Quotient,
    Comparison,
    Root,
}

/// How many kinds there are.
pub(super) const KINDS: usize = 6;

thread_local! {
    static DONE: [Cell<u64>; KINDS] = const { [const { Cell::new(0) }; KINDS] };
}

/// What was done since it was last asked, by kind; it then counts from 0 again.
pub(super) fn done() -> [u64; KINDS] {
    DONE.with(|done| std::array::from_fn(|kind| done[kind].replace(0)))
}

#[inline(always)]
pub(super) fn count(kind: Kind) {
    DONE.with(|done| {
        let done = &done[kind as usize];
        done.set(done.get() + 1);
    });
}

/// An `f32`, and its bits, counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Number32(pub(super) f32);

impl PartialOrd for Number32 {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        count(Kind::Comparison);
        self.0.partial_cmp(&other.0)
    }
}

impl Add for Number32 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        count(Kind::Sum);
        Self(self.0 + other.0)
    }
}

impl Sub for Number32 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        count(Kind::Sum);
        Self(self.0 - other.0)
    }
}

impl Mul for Number32 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        count(Kind::Product);
        Self(self.0 * other.0)
    }
}

impl Div for Number32 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        count(Kind::Quotient);
        Self(self.0 / other.0)
    }
}

impl Neg for Number32 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        count(Kind::Sum);
        Self(-self.0)
    }
}

impl Number for Number32 {
    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const PI: Self = Self(<f32 as Number>::PI);

    #[inline(always)]
    fn of(constant: f64) -> Self {
        count(Kind::Read);
        Self(constant as f32)
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    #[inline(always)]
    fn abs(self) -> Self {
        count(Kind::Sum);
        Self(self.0.abs())
    }
}

impl Floating for Number32 {
    const SPLITTER: Self = Self(<f32 as Floating>::SPLITTER);
}

/// The host's root, counted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CountedRoot;

impl Root<Number32> for CountedRoot {
    #[inline(always)]
    fn sqrt(x: Number32) -> Number32 {
        count(Kind::Root);
        Number32(HostRoot::sqrt(x.0))
    }
}

/// The same in counted numbers.
pub(super) fn vector(from: Vector<f32>) -> Vector<Number32> {
    Vector {
        x: Number32(from.x),
        y: Number32(from.y),
        z: Number32(from.z),
    }
}

/// The same in counted numbers; what this itself does is not counted.
pub(super) fn receiver(from: &Receiver<f32>) -> Option<Receiver<Number32>> {
    let words = |v: Vector<f32>| [v.x, v.y, v.z].map(Number32);
    let receiver = Receiver::new::<CountedRoot>(words(from.position()), words(from.normal()));
    done();
    receiver.ok()
}
