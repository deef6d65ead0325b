//! Emitters that do not move: the residual form with what depends on the
//! emitter alone taken from a table.
//!
//! Of every edge the table holds D = V_i − V_0, e = V_{i+1} − V_i, C = D_i ×
//! D_{i+1}, |D|² and |e|², 44 bytes, computed in `f64` and rounded once. All
//! receivers share it. With v_0 = V_0 − P, r_0 = |v_0| and w_0 = n × v_0, what is
//! left per receiver is
//!
//! ```text
//! δ_i = 2 v_0·D_i + |D_i|²                     = r_i² − r_0²
//! p   = (δ_{i+1} − δ_i − |e|²)/2               = v_i·e
//! d   = r_0² + (δ_i + p)                       = v_i·v_{i+1}
//! l   = (r_0² + δ_i)|e|² − p²                  = |v_i × v_{i+1}|²
//! w   = l/d² = tan² γ,   η = −(δ_i + p + r_0² w k(w))/d
//! −2π F r_0² = n·Σ C_i + Σ η_i (w_0·e_i + n·C_i)
//! ```
//!
//! which is the formula of the rung [`Best`](super::Best) for small emitters but
//! for one step; k and the domain are the same. One division an edge and no root:
//! no edge is seen under more than 45°, so tan² γ comes from squares.

use super::{Outline, TURN, residual, seen, snell};
use crate::geometry::{Plane, Receiver, Vector};
use crate::number::{Root, residual_arctangent};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout};

/// What of an edge depends on the emitter alone, in metres and m²: a record of
/// 44 bytes without padding, readable in place.
#[derive(Clone, Copy, Debug, Default, PartialEq, FromBytes, Immutable, IntoBytes, KnownLayout)]
#[repr(C)]
pub struct Edge {
    offset: [f32; 3],
    along: [f32; 3],
    cross: [f32; 3],
    offset_squared: f32,
    length_squared: f32,
}

const _: () = assert!(size_of::<Edge>() == 44 && align_of::<Edge>() == 4);

impl Edge {
    /// The edge between two vertices of a loop that begins at `first`.
    ///
    /// In `f64`, rounded once: on a device it belongs into a `const`. Never
    /// panics.
    pub const fn new(first: [f32; 3], from: [f32; 3], to: [f32; 3]) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (difference(from, first), difference(to, first));
        let [x, y, z] = difference(to, from);
        Self {
            offset: [ax as f32, ay as f32, az as f32],
            along: [x as f32, y as f32, z as f32],
            cross: [
                (ay * bz - az * by) as f32,
                (az * bx - ax * bz) as f32,
                (ax * by - ay * bx) as f32,
            ],
            offset_squared: (ax * ax + ay * ay + az * az) as f32,
            length_squared: (x * x + y * y + z * z) as f32,
        }
    }

    /// The edges of a loop, in order: the table of an [`Baked`] outline.
    pub fn of_loop(vertices: &[[f32; 3]]) -> impl Iterator<Item = Self> + '_ {
        let after = vertices.iter().skip(1).chain(vertices.first());
        let first = vertices.first().copied().unwrap_or_default();
        vertices
            .iter()
            .zip(after)
            .map(move |(&from, &to)| Self::new(first, from, to))
    }
}

/// a − b, exact for numbers of `f32` within 2²⁹ of each other.
const fn difference([ax, ay, az]: [f32; 3], [bx, by, bz]: [f32; 3]) -> [f64; 3] {
    [
        ax as f64 - bx as f64,
        ay as f64 - by as f64,
        az as f64 - bz as f64,
    ]
}

/// A closed loop of a planar polygon with the table of its edges.
#[derive(Clone, Copy, Debug)]
pub struct Baked<'a> {
    outline: Outline<'a, f32>,
    edges: &'a [Edge],
}

impl<'a> Baked<'a> {
    /// A loop and the edges that [`Edge::of_loop`] gives for it; `None` where
    /// there are more or fewer edges than vertices.
    ///
    /// Edges of another loop are not noticed: F is then meaningless, in [0, 1]
    /// all the same.
    pub fn new(outline: Outline<'a, f32>, edges: &'a [Edge]) -> Option<Self> {
        (outline.vertices().len() == edges.len()).then_some(Self { outline, edges })
    }

    /// The loop.
    pub fn outline(&self) -> Outline<'a, f32> {
        self.outline
    }
}

/// The form factor of a planar polygon of several loops that do not move,
/// 0 ≤ F ≤ 1: [`of_loops`](super::of_loops) on the rung [`Best`](super::Best), for
/// small loops above the horizon from their tables.
///
/// Errors as on [`Best`](super::Best), but relative ones on small emitters: 6 u over
/// both cosines and the emitter's slenderness (its area over its longest edge's
/// square, at most 1); 4.4e-6 at the most in 80000 with cosines above 0.2. Terms of
/// the size of the angles cancel here, which `Best` takes apart at the price of 33
/// cycles an edge. About half of its instructions there, the same elsewhere.
/// Never panics, never NaN (a NaN in the input gives 0).
#[inline]
pub fn of_baked_loops<'a, R: Root<f32> + Copy>(
    receiver: &Receiver<f32>,
    plane: &Plane<f32>,
    loops: impl Iterator<Item = Baked<'a>>,
) -> f32 {
    let sums = loops.map(|baked| contour::<R>(receiver, plane.normal, &baked));
    seen(receiver, plane, sums)
}

#[inline]
fn contour<R: Root<f32> + Copy>(
    receiver: &Receiver<f32>,
    facing: Vector<f32>,
    baked: &Baked<'_>,
) -> f32 {
    if !super::is_small(receiver, &baked.outline) {
        return snell::contour::<6, f32, R>(receiver, facing, &baked.outline);
    }
    match whole(receiver, baked) {
        Some(sum) => sum,
        None => residual::contour(receiver, &baked.outline),
    }
}

/// Σ γ_i n·unit(v_i × v_{i+1}) in turns over a small loop; `None` where a part of it is
/// below the horizon.
#[inline(always)]
fn whole(receiver: &Receiver<f32>, baked: &Baked<'_>) -> Option<f32> {
    let Some(&origin) = baked.outline.vertices().first() else {
        return Some(0.0);
    };
    let normal = receiver.normal();
    let first = Vector::from(origin) - receiver.position();
    let height = normal.dot(first);
    let (twice_first, squared) = (first + first, first.norm_squared());
    let across_first = normal.cross(first);
    let (mut area, mut sum) = (0.0, 0.0);
    let mut rest = baked.edges.iter();
    let mut edge = rest.next()?;
    // D and δ of the first vertex are 0.
    let mut excess = 0.0;
    if height < 0.0 {
        return None;
    }
    loop {
        let next = rest.next();
        let next_excess = match next {
            Some(next) => {
                let offset = Vector::from(next.offset);
                if height + normal.dot(offset) < 0.0 {
                    return None;
                }
                twice_first.dot(offset) + next.offset_squared
            }
            None => 0.0,
        };
        let along = (next_excess - excess - edge.length_squared) * 0.5;
        let step = excess + along;
        let inverse = 1.0 / (squared + step);
        let l = (squared + excess) * edge.length_squared - along * along;
        let w = l * inverse * inverse;
        let eta = (step + squared * w * residual_arctangent(w)) * inverse;
        let cross = normal.dot(edge.cross.into());
        area += cross;
        sum += eta * (across_first.dot(edge.along.into()) + cross);
        match next {
            Some(next) => (edge, excess) = (next, next_excess),
            None => return Some((area - sum) / squared * TURN as f32),
        }
    }
}
