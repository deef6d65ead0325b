//! Receivers and planar polygons with corners on a lattice.

use glam::{DVec3, I64Vec3};
use proptest::prelude::*;

/// The lattice's step in metres: a power of two, so that coordinates up to
/// 2¹⁷ m are exact in `f32`.
pub(crate) const STEP: f64 = 1.0 / 64.0;

/// A receiver in front of a polygon.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) p: [f64; 3],
    pub(crate) n: [f64; 3],
    pub(crate) v: Vec<[f64; 3]>,
}

impl View {
    /// L/h: the largest distance to a vertex over the one to the nearest edge.
    pub(crate) fn conditioning(&self) -> f64 {
        let p = DVec3::from(self.p);
        let corner = |i: usize| DVec3::from(self.v[i % self.v.len()]);
        let (mut far, mut near) = (0.0_f64, f64::INFINITY);
        for i in 0..self.v.len() {
            let (a, along) = (corner(i), corner(i + 1) - corner(i));
            let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            far = far.max(a.distance(p));
            near = near.min(p.distance(a + along * t));
        }
        far / near
    }

    /// The largest distance of the polygon's corners from the receiver over its
    /// height above the polygon's plane.
    pub(crate) fn flatness(&self) -> f64 {
        let p = DVec3::from(self.p);
        let far = self.v.iter().map(|&v| p.distance(v.into()));
        far.fold(0.0, f64::max) / (normal(&self.v).normalize().dot(p - DVec3::from(self.v[0])))
    }

    /// The same polygon seen from its back.
    pub(crate) fn reversed(&self) -> Self {
        let mut reversed = self.clone();
        reversed.v.reverse();
        reversed
    }
}

/// Newell's normal; exact for lattice polygons of moderate size.
pub(crate) fn normal(v: &[[f64; 3]]) -> DVec3 {
    let first = DVec3::from(v[0]);
    v.windows(2)
        .map(|pair| (DVec3::from(pair[0]) - first).cross(DVec3::from(pair[1]) - first))
        .sum()
}

fn whole(range: i64) -> impl Strategy<Value = I64Vec3> {
    prop::array::uniform3(-range..=range).prop_map(I64Vec3::from)
}

/// Two directions that span a plane.
fn axes() -> impl Strategy<Value = (I64Vec3, I64Vec3)> {
    (whole(3), whole(3)).prop_filter("a plane", |(a, b)| a.cross(*b) != I64Vec3::ZERO)
}

/// Corners of a star-shaped polygon round (0, 0) in lattice steps: mostly
/// concave. A radius of at least 20 steps keeps the corners of up to 12 apart
/// after rounding, so the polygon is simple.
fn star(most: usize) -> impl Strategy<Value = Vec<(i64, i64)>> {
    (
        prop::collection::vec(20.0..160.0_f64, 3..=most),
        0.0..std::f64::consts::TAU,
    )
        .prop_map(|(radii, turn)| {
            let count = radii.len() as f64;
            let corner = |(i, radius): (usize, &f64)| {
                let angle = turn + std::f64::consts::TAU * i as f64 / count;
                let (sine, cosine) = angle.sin_cos();
                (
                    (radius * cosine).round() as i64,
                    (radius * sine).round() as i64,
                )
            };
            radii.iter().enumerate().map(corner).collect()
        })
}

/// A convex polygon: corners of an ellipse in lattice steps.
fn convex(most: usize) -> impl Strategy<Value = Vec<(i64, i64)>> {
    (3..=most, 200.0..800.0_f64, 200.0..800.0_f64, 0.0..1.0_f64).prop_map(|(count, a, b, turn)| {
        let corner = |i: usize| {
            let angle = std::f64::consts::TAU * (i as f64 + turn) / count as f64;
            (
                (a * angle.cos()).round() as i64,
                (b * angle.sin()).round() as i64,
            )
        };
        (0..count).map(corner).collect()
    })
}

/// Puts a plane figure into space and a receiver in front of it.
fn seen(figure: impl Strategy<Value = Vec<(i64, i64)>>) -> impl Strategy<Value = View> {
    (figure, axes(), whole(256), whole(512), whole(8))
        .prop_filter("a direction", |(.., n)| *n != I64Vec3::ZERO)
        .prop_filter_map("off the plane", |(figure, (a, b), origin, p, n)| {
            let place = |v: I64Vec3| (v.as_dvec3() * STEP).to_array();
            let side = a.cross(b).dot(p - origin);
            let mut v: Vec<[f64; 3]> = figure
                .into_iter()
                .map(|(x, y)| place(origin + a * x + b * y))
                .collect();
            if side < 0 {
                v.reverse();
            }
            (side != 0).then(|| View {
                p: place(p),
                n: n.as_dvec3().to_array(),
                v,
            })
        })
}

/// A receiver in front of a simple polygon of up to 12 corners.
pub(crate) fn view() -> impl Strategy<Value = View> {
    seen(star(12))
}

/// A polygon in a plane across an axis, where the plane of a polygon is exact
/// in every number.
pub(crate) fn upright_view() -> impl Strategy<Value = View> {
    (view(), 0..3_usize, -256..=256_i32).prop_map(|(view, axis, level)| {
        let level = f64::from(level) * STEP;
        let flat = |x: &f64| (x * 8.0).round() / 8.0;
        let count = view.v.len() as f64;
        let corner = |k: usize| {
            let radius = 1.0 + view.v[k][0].abs();
            let (y, x) = (std::f64::consts::TAU * k as f64 / count).sin_cos();
            let mut corner = [flat(&(radius * x)), flat(&(radius * y)), 0.0];
            corner.rotate_right(axis);
            corner[(axis + 2) % 3] = level;
            corner
        };
        View {
            v: (0..view.v.len()).map(corner).collect(),
            ..view
        }
    })
}

/// A receiver in front of a simple polygon of up to 32 corners.
pub(crate) fn many_cornered_view() -> impl Strategy<Value = View> {
    seen(star(32))
}

/// A receiver in front of a convex polygon of up to 8 corners.
pub(crate) fn convex_view() -> impl Strategy<Value = View> {
    seen(convex(8))
}
