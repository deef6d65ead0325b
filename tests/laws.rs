//! Laws that hold for every polygon and every receiver, whatever the numbers:
//! bounds, symmetries, exchange of energy, the horizon and the clip.
//!
//! Shapes have corners on a lattice of 1/64 m, so that every one of them is
//! exactly planar and exactly the same in `f32` and in `f64`. Tolerances are
//! derived, with u half an ulp of 1, L the largest distance from the receiver
//! to a vertex, h its distance to the nearest edge, m the number of edges:
//!
//! * a rung's own error is [`own_error`];
//! * moving every vertex and the receiver by up to d changes F by at most
//!   m d/h, since an edge that moves by d sweeps at most
//!   d ∫ ds / (π (h² + s²)) = d/h;
//! * turning the receiver by e changes F by at most 2 e, since cos θ changes by
//!   at most e over at most a hemisphere, divided by π.

#[path = "laws/clipping.rs"]
mod clipping;
#[path = "laws/exchange.rs"]
mod exchange;
#[path = "laws/extremes.rs"]
mod extremes;
#[path = "laws/judged.rs"]
mod judged;
#[path = "laws/ladder.rs"]
mod ladder;
#[path = "laws/narrow.rs"]
mod narrow;
#[path = "laws/shapes.rs"]
mod shapes;
#[path = "laws/symmetry.rs"]
mod symmetry;

use isolux::form_factor::{Arithmetic, Best, Libm, form_factor};
use isolux::geometry::Receiver;
use isolux::number::{ArcCosine, Number, Root, SoftRoot};

/// What rounding does to an edge at distance h, in u L/h. V - P is rounded by
/// u L and moves the edge: the strip swept has a cosine of at most h/r on its
/// own side, and ∫ h d / (π (h² + s²)^3/2) ds = 2/π d/h. The cross product of
/// its ends is rounded by √2 u |a||b| and its direction, which up to π/2π of F
/// hangs on, by that over h |e|.
const NEAREST_EDGE: f64 = std::f64::consts::FRAC_2_PI + std::f64::consts::FRAC_1_SQRT_2;

/// The numbers a law is held to, with what the tests need beside arithmetic.
trait Real: ArcCosine + Into<f64> + 'static
where
    SoftRoot: Root<Self>,
{
    /// Half an ulp of 1.
    const U: f64;
    /// The number as bits, for equality without tolerance.
    fn bits(self) -> u64;
}

impl Real for f32 {
    const U: f64 = f32::EPSILON as f64 / 2.0;
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

impl Real for f64 {
    const U: f64 = f64::EPSILON / 2.0;
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

/// A rung as the laws see it.
trait Rung<N: Number>: Arithmetic<N> {
    /// What it may err by on a polygon of `edges` edges, at L/h.
    fn own_error(edges: usize, conditioning: f64) -> f64;
}

impl Rung<f32> for Best {
    /// 2.5e-7 for its fits and its sum, and what happens next to an edge.
    fn own_error(_: usize, conditioning: f64) -> f64 {
        2.5e-7 + NEAREST_EDGE * f32::U * conditioning
    }
}

impl Rung<f64> for Best {
    /// The fits: 1.5e-8 of the angles, documented as 2e-8 of F.
    fn own_error(_: usize, _: f64) -> f64 {
        2e-8
    }
}

impl<N: Real> Rung<N> for Libm
where
    SoftRoot: Root<N>,
{
    /// The cosine of an edge's angle has 3 roundings, so its arc cosine errs by
    /// √(6u) where the angle is 0 or π, and by less elsewhere; next
    /// to an edge it is as every rung.
    fn own_error(edges: usize, conditioning: f64) -> f64 {
        let arc = (6.0 * N::U).sqrt() / std::f64::consts::TAU;
        edges as f64 * arc + NEAREST_EDGE * N::U * conditioning
    }
}

/// Coordinates in a number type.
fn of<N: Number>(v: [f64; 3]) -> [N; 3] {
    v.map(N::of)
}

fn all_of<N: Number>(vertices: &[[f64; 3]]) -> Vec<[N; 3]> {
    vertices.iter().map(|&v| of(v)).collect()
}

/// The kernel's answer for coordinates given in f64.
fn factor<A: Arithmetic<N>, N: Real>(p: [f64; 3], n: [f64; 3], vertices: &[[f64; 3]]) -> N
where
    SoftRoot: Root<N>,
{
    let receiver = Receiver::new::<SoftRoot>(of(p), of(n)).expect("a receiver");
    form_factor::<A, N>(&receiver, &all_of::<N>(vertices))
}
