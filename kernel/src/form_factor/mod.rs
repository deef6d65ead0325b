//! The form factor of a polygon seen from a differential area.
//!
//! F = ∫ cos θ_r cos θ_e / (π r²) dA over the emitter is the fraction of the
//! power leaving the receiver's differential area that arrives at the emitter
//! (the configuration factor), and E = π L F the irradiance a Lambertian
//! emitter of radiance L causes. By Stokes' theorem it is a sum over the
//! emitter's edges (Lambert 1760; Eq. 3 of the paper):
//!
//! ```text
//! F = −1/(2π) Σ γ_i  n · unit(v_i × v_{i+1}),   i = 0 .. m−1, indices mod m
//! ```
//!
//! with v_i the vertices relative to the receiver, γ_i the angle between v_i
//! and v_{i+1}, and n the receiver's unit normal. The paper prints the factor
//! as 1/2 (the π of its own Eq. 2 is lost), lets the sum run over m + 1 terms,
//! and says that polygons with holes are excluded. In truth:
//!
//! * the minus sign belongs to vertices that run counter-clockwise seen from
//!   the emitting side;
//! * the polygon is to be clipped to the receiver's horizon n·v ≥ 0 first (the
//!   paper omits it; without the clip five of six polygons that cross the
//!   horizon come out wrong);
//! * a hole is a loop that runs the other way.
//!
//! A receiver on or behind the emitter's plane receives 0.
//!
//! # Rungs
//!
//! How a loop is summed is a type, a rung of the arithmetic ladder
//! ([`Arithmetic`]): [`Libm`] writes Eq. 3 down as it stands, [`Poly3`],
//! [`Poly5`] and [`Poly8`] trade accuracy for speed, [`Best`] is the default. Their errors and costs are with them.
//!
//! # Domain
//!
//! Coordinates relative to the receiver between 1e-8 and 1e8 in magnitude
//! (squares and fourth powers of distances must stay normal numbers of `f32`).

mod baked;
mod best;
mod clipped;
#[cfg(feature = "fixed")]
#[cfg_attr(docsrs, doc(cfg(feature = "fixed")))]
pub mod fixed_point;
#[cfg(feature = "micromath")]
mod micro;
mod narrow;
mod paper;
mod poly;
mod residual;
mod snell;
mod tally;

pub use baked::{Baked, Edge, of_baked_loops};
pub use best::Best;
pub use clipped::{SeenPlane, of_clipped};
#[cfg(feature = "micromath")]
#[cfg_attr(docsrs, doc(cfg(feature = "micromath")))]
pub use micro::Micromath;
pub use paper::Libm;
pub use poly::{Poly, Poly3, Poly5, Poly8};

use crate::clip::Place;
use crate::geometry::{Plane, Receiver, Vector};
use crate::number::{Number, Root};

/// A rung of the arithmetic ladder: how one loop of a polygon is summed.
pub trait Arithmetic<N: Number> {
    /// Where its square roots come from.
    type Root: Root<N> + Copy;

    /// Minus what one closed loop adds to the form factor: Σ γ_i n·unit(v_i ×
    /// v_{i+1}) over its part above the receiver's horizon, γ_i in turns, so that
    /// nothing is left to be multiplied.
    ///
    /// The loop lies in a plane with normal `facing` (any length), in front of
    /// which the receiver is. Fewer than 3 vertices give 0. Never panics.
    fn contour(receiver: &Receiver<N>, facing: Vector<N>, outline: &Outline<'_, N>) -> N;
}

/// A closed loop of a planar polygon.
#[derive(Clone, Copy, Debug)]
pub struct Outline<'a, N> {
    vertices: &'a [[N; 3]],
    reach_squared: N,
}

impl<'a, N: Number> Outline<'a, N> {
    /// The loop through these vertices, in metres.
    pub fn new(vertices: &'a [[N; 3]]) -> Self {
        let mut reach_squared = N::ZERO;
        if let Some((&first, rest)) = vertices.split_first() {
            let first = Vector::from(first);
            for &vertex in rest {
                let squared = (Vector::from(vertex) - first).norm_squared();
                if squared > reach_squared {
                    reach_squared = squared;
                }
            }
        }
        Self {
            vertices,
            reach_squared,
        }
    }

    /// The loop with its reach known beforehand, as the tables hold it.
    #[inline(always)]
    pub(crate) fn with_reach(vertices: &'a [[N; 3]], reach_squared: N) -> Self {
        Self {
            vertices,
            reach_squared,
        }
    }

    /// The vertices, in metres.
    #[inline(always)]
    pub fn vertices(&self) -> &'a [[N; 3]] {
        self.vertices
    }

    /// The squared distance in m² from the first vertex to the one farthest
    /// from it: what tells a small emitter from a large one.
    #[inline(always)]
    pub fn reach_squared(&self) -> N {
        self.reach_squared
    }
}

/// The form factor of a polygon seen from a receiver, 0 ≤ F ≤ 1.
///
/// `vertices` of a planar simple polygon, convex or not, in metres,
/// counter-clockwise seen from its emitting side. 0 where the receiver is on
/// or behind the polygon's plane, where the polygon is below its horizon, and
/// where there are fewer than 3 vertices. Error bound and cost: those of the
/// rung `A`. Never panics, never NaN (a NaN in the input gives 0).
pub fn form_factor<A: Arithmetic<N>, N: Number>(receiver: &Receiver<N>, vertices: &[[N; 3]]) -> N {
    let plane = Plane::of_polygon(vertices);
    of_loops::<A, N>(receiver, &plane, core::iter::once(Outline::new(vertices)))
}

/// The form factor of a planar polygon of several loops, 0 ≤ F ≤ 1: pieces
/// counter-clockwise seen from the front of `plane`, holes clockwise.
///
/// As [`form_factor`] otherwise.
#[inline]
pub fn of_loops<'a, A: Arithmetic<N>, N: Number + 'a>(
    receiver: &Receiver<N>,
    plane: &Plane<N>,
    outlines: impl Iterator<Item = Outline<'a, N>>,
) -> N {
    let sums = outlines.map(|outline| A::contour(receiver, plane.normal, &outline));
    seen(receiver, plane, sums)
}

/// F from the sums over the loops of a polygon; none is asked for where the
/// receiver is on or behind the polygon's plane.
#[inline]
fn seen<N: Number>(receiver: &Receiver<N>, plane: &Plane<N>, sums: impl Iterator<Item = N>) -> N {
    if plane.height(receiver.position()) <= N::ZERO {
        return N::ZERO;
    }
    let mut total = N::ZERO;
    for sum in sums {
        total = total + sum;
    }
    fraction(-total)
}

/// The vertices of a loop relative to a receiver, with their heights above its
/// horizon.
#[inline(always)]
fn places<'a, N: Number>(
    receiver: &'a Receiver<N>,
    outline: &Outline<'a, N>,
) -> impl Iterator<Item = Place<N>> + 'a {
    outline.vertices().iter().map(|&vertex| {
        let position = Vector::from(vertex) - receiver.position();
        Place {
            position,
            height: receiver.normal().dot(position),
        }
    })
}

/// Turns a radian: 1/(2π).
const TURN: f64 = 0.5 / core::f64::consts::PI;

/// Clamps to [0, 1]; NaN becomes 0. Written with comparisons because
/// `f32::min` and `f32::max` differ between targets on −0.
#[inline(always)]
fn fraction<N: Number>(f: N) -> N {
    if f > N::ZERO {
        if f < N::ONE { f } else { N::ONE }
    } else {
        N::ZERO
    }
}

/// sin² 22.5°, rounded down.
const REACH: f64 = 0.1464;

/// Whether every vertex of the loop is seen within 22.5° of the first one.
#[inline(always)]
fn is_small<N: Number>(receiver: &Receiver<N>, outline: &Outline<'_, N>) -> bool {
    match outline.vertices().first() {
        Some(&first) => {
            let distance_squared = (Vector::from(first) - receiver.position()).norm_squared();
            is_within_reach(outline.reach_squared(), distance_squared)
        }
        None => false,
    }
}

/// Whether a reach is seen within 22.5° from a distance, both squared.
#[inline(always)]
fn is_within_reach<N: Number>(reach_squared: N, distance_squared: N) -> bool {
    reach_squared <= N::of(REACH) * distance_squared
}
