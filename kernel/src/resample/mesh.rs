//! Meshes: triangles whose corners' values are sums of samples.
//!
//! A node's value is c + Σ w_k x_k, the weights being the planner's; between nodes
//! values are linear. No triangle crosses a line that light has an edge at, so
//! nothing blurs across it: what a triangle on one side says does not depend on
//! samples beyond.

use crate::luminance::Colour;
use crate::scene::fields::{Fields, Mesh, Node, SHARE};
use core::ops::Range;

/// Fills `room` with the values of a mesh's nodes, made of the values of its
/// samples. Cost: a multiplication a share.
pub(super) fn values<C: Colour>(mesh: &Mesh, fields: Fields<'_>, samples: &[C], room: &mut [C]) {
    for (cell, node) in room.iter_mut().zip(fields.nodes(mesh)) {
        let mut sum = C::DARK;
        for share in fields.shares(node) {
            let sample = samples.get(usize::from(share.sample)).copied();
            let weight = f32::from(share.weight);
            sum = sum.plus(sample.unwrap_or(C::DARK).times(weight));
        }
        let constant = f32::from(node.constant);
        *cell = sum.map(|sum| (sum + constant) * SHARE);
    }
}

/// A mesh with the values of its nodes. Places on it are in 65 535ths of the surface's
/// width and height, as its nodes are: no length of the scene is too small for it.
#[derive(Clone, Copy)]
pub(super) struct Valued<'a, 't, C> {
    pub(super) nodes: &'t [Node],
    pub(super) triangles: &'t [[u16; 3]],
    pub(super) values: &'a [C],
}

/// The far ends of a surface, in the unit of nodes' places.
pub(super) const END: f32 = u16::MAX as f32;

/// A corner of a triangle.
#[derive(Clone, Copy)]
struct Corner<C> {
    place: [f32; 2],
    value: C,
}

/// Where a line of constant v enters or leaves a triangle.
#[derive(Clone, Copy)]
struct Crossing<C> {
    u: f32,
    value: C,
}

impl<C: Colour> Valued<'_, '_, C> {
    fn corner(&self, index: u16) -> Corner<C> {
        let node = self.nodes.get(usize::from(index));
        let [u, v] = node.map_or([0; 2], |node| node.place);
        let value = self.values.get(usize::from(index)).copied();
        Corner {
            place: [f32::from(u), f32::from(v)],
            value: value.unwrap_or(C::DARK),
        }
    }

    /// Calls `paint` with the columns whose centres lie in each triangle that the
    /// line at `v` crosses, the value at the first of them, and what it grows by
    /// from one to the next.
    ///
    /// Two triangles with a common edge never both have a column, and never leave
    /// one out: both find the edge's crossing by the same sum.
    pub(super) fn spans(&self, v: f32, columns: u32, mut paint: impl FnMut(Range<usize>, C, C)) {
        let step = END / columns as f32;
        for &[a, b, c] in self.triangles {
            let mut crossings = [self.crossing(a, b, v), self.crossing(b, c, v), None];
            if crossings[0].is_none() || crossings[1].is_none() {
                crossings[2] = self.crossing(c, a, v);
            }
            let mut found = crossings.into_iter().flatten();
            let (Some(one), Some(other)) = (found.next(), found.next()) else {
                continue;
            };
            let (left, right) = if one.u < other.u {
                (one, other)
            } else {
                (other, one)
            };
            let width = right.u - left.u;
            let first = column_from(left.u / step, columns);
            let end = column_from(right.u / step, columns);
            if first < end && width > 0.0 {
                let rise = right.value.zip(left.value, |r, l| r - l);
                let part = ((first as f32 + 0.5) * step - left.u) / width;
                let value = left.value.plus(rise.times(part));
                let slope = rise.times(step / width);
                paint(first as usize..end as usize, value, slope);
            }
        }
    }

    /// Where the edge between two nodes crosses the line at `v`; the lower index
    /// first, so that both triangles at it find the same.
    #[inline(always)]
    fn crossing(&self, a: u16, b: u16, v: f32) -> Option<Crossing<C>> {
        let (a, b) = if a < b { (a, b) } else { (b, a) };
        let (from, to) = (self.corner(a), self.corner(b));
        if (from.place[1] <= v) == (to.place[1] <= v) {
            return None;
        }
        let part = (v - from.place[1]) / (to.place[1] - from.place[1]);
        Some(Crossing {
            u: from.place[0] + part * (to.place[0] - from.place[0]),
            value: from.value.zip(to.value, |f, t| f + part * (t - f)),
        })
    }

    /// The value at a place, and whether it lies in a triangle, to within a
    /// thousandth of the triangle; else it is that of the nearest, at the nearest
    /// corner or edge of it. Dark where there are no triangles.
    ///
    /// Cost: about 60 instructions a triangle.
    pub(super) fn at(&self, place: [f32; 2]) -> (C, bool) {
        // A place beyond the surface, or none, counts as one on its outline.
        let [u, v] = place.map(|x| {
            if x > 0.0 {
                if x < END { x } else { END }
            } else {
                0.0
            }
        });
        let (mut nearest, mut most, mut value) = (f32::NEG_INFINITY, [0.0; 3], None);
        for &indices in self.triangles {
            let corners = indices.map(|index| self.corner(index));
            let [a, b, c] = corners.map(|corner| [corner.place[0] - u, corner.place[1] - v]);
            let cross = |p: [f32; 2], q: [f32; 2]| p[0] * q[1] - p[1] * q[0];
            let parts = [cross(b, c), cross(c, a), cross(a, b)];
            let area = parts[0] + parts[1] + parts[2];
            if area == 0.0 {
                continue;
            }
            let parts = parts.map(|part| part / area);
            let mut least = parts[0];
            for part in parts {
                least = if part < least { part } else { least };
            }
            if least > nearest {
                (nearest, most, value) = (least, parts, Some(corners));
            }
            if least >= 0.0 {
                break;
            }
        }
        let Some([a, b, c]) = value else {
            return (C::DARK, false);
        };
        // Not beyond the triangle: parts of less than nothing count as none.
        let held = most.map(|part| if part > 0.0 { part } else { 0.0 });
        let sum = held[0] + held[1] + held[2];
        let [x, y, z] = held.map(|part| if sum > 0.0 { part / sum } else { 0.0 });
        let value = a
            .value
            .times(x)
            .plus(b.value.times(y))
            .plus(c.value.times(z));
        (value, nearest >= -1e-3)
    }
}

/// The first column whose centre is not left of `u`, in columns.
#[inline(always)]
fn column_from(u: f32, columns: u32) -> u32 {
    let x = u - 0.5;
    let below = x as u32; // 0 for what is less, the largest for what is more
    let column = below.saturating_add(u32::from((below as f32) < x));
    if column < columns { column } else { columns }
}
