//! The moments of an emitter's part as a receiver sees it.
//!
//! In the emitter's coordinates x = O + a e_1 + b e_2, with e_1 ⟂ e_2 both of
//! length s, the kernel of the form factor is
//!
//! ```text
//! k(a, b) = (h/π) (n·x) / |x|⁴,     x relative to the receiver,
//! ```
//!
//! where h = −N·x, the receiver's height over the emitter's plane, is the same all
//! over: one division a node. The rules integrate polynomials of the third
//! degree over a parallelogram exactly (Gauss 2 × 2; seventh degree with 4 × 4
//! where the receiver is near), of the second degree over a triangle (three
//! nodes; fifth degree with Radon's seven). Any other convex polygon is a fan of
//! triangles. Nodes below the receiver's horizon count nothing.

use crate::form_factor::SeenPlane;

/// ∫ k dA and the place that is the centre of gravity under k.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Moments {
    /// ∫ k dA by the rule: the form factor, to the rule's error.
    pub factor: f32,
    /// ∫ a k dA and ∫ b k dA by the rule.
    pub first: [f32; 2],
}

impl Moments {
    /// (ā, b̄); `fallback` where the rule saw nothing.
    #[inline]
    pub fn place(&self, fallback: [f32; 2]) -> [f32; 2] {
        let [a, b] = self.first;
        if self.factor > 0.0 {
            let inverse = 1.0 / self.factor;
            let place = [a * inverse, b * inverse];
            if place.iter().all(|x| x.is_finite()) {
                return place;
            }
        }
        fallback
    }
}

/// An emitter's plane as a receiver sees it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// n·x = `height[0]` + `height[1]` a + `height[2]` b.
    height: [f32; 3],
    /// |x|² = `squared[0]` + 2 `squared[1]` a + 2 `squared[2]` b + `squared[3]` (a² + b²).
    squared: [f32; 4],
    /// h s²/π: what k is times n·x/|x|⁴, with the area of a unit of (a, b).
    scale: f32,
}

/// Squares of distances over squares of radii beyond which a rule of few nodes
/// is taken, and beyond which it stands for the form factor itself.
const NEAR: f32 = 9.0;
const FAR: f32 = 36.0;

impl View {
    /// An emitter's plane with coordinates whose axes are at right angles and of
    /// length `unit` in metres; `height` is the receiver's over it.
    #[inline]
    pub fn new(seen: &SeenPlane<f32>, unit: f32, height: f32) -> Self {
        let ([axis_a, axis_b], normal) = (seen.axes, seen.normal);
        let square = unit * unit;
        Self {
            height: [
                normal.dot(seen.origin),
                normal.dot(axis_a),
                normal.dot(axis_b),
            ],
            squared: [
                seen.origin.norm_squared(),
                seen.origin.dot(axis_a),
                seen.origin.dot(axis_b),
                square,
            ],
            scale: height * square * core::f32::consts::FRAC_1_PI,
        }
    }

    /// Whether the whole of an emitter, a² + b² ≤ 1, is above the horizon and so
    /// far that the rule of 2 × 2 nodes gives its form factor to within 1e-3 of
    /// itself.
    #[inline]
    pub fn is_far(&self) -> bool {
        let [center, along_a, along_b] = self.height;
        let swing = along_a * along_a + along_b * along_b;
        self.squared[0] > FAR * self.squared[3] && center > 0.0 && center * center > swing
    }

    /// The moments over a convex polygon with these corners, a² + b² ≤ 1.
    ///
    /// Error of the centre of gravity: below 1 % of the polygon's size from
    /// 3 radii on. Cost on a Cortex-M4F: about 25 instructions a node, 4 or 16 a
    /// parallelogram, 3 or 7 a triangle. Never panics, never NaN.
    pub fn moments(&self, corners: &[[f32; 2]]) -> Moments {
        let near = self.squared[0] <= NEAR * self.squared[3];
        let mut sum = Moments::default();
        if let &[p, q, r, s] = corners
            && is_parallelogram(corners)
        {
            let half =
                |to: [f32; 2], from: [f32; 2]| [(to[0] - from[0]) * 0.5, (to[1] - from[1]) * 0.5];
            let center = [(p[0] + r[0]) * 0.5, (p[1] + r[1]) * 0.5];
            let (along, across) = (half(q, p), half(s, p));
            let area = 4.0 * (along[0] * across[1] - along[1] * across[0]).abs();
            if near {
                self.gauss(&mut sum, center, [along, across], area, &GAUSS_4);
            } else {
                self.gauss(&mut sum, center, [along, across], area, &GAUSS_2);
            }
            return sum;
        }
        if let Some((&first, rest)) = corners.split_first() {
            for pair in rest.windows(2) {
                if let &[from, to] = pair {
                    self.triangle(&mut sum, [first, from, to], near);
                }
            }
        }
        sum
    }

    /// A parallelogram by a product of Gauss rules on [−1, 1].
    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline)]
    fn gauss(
        &self,
        sum: &mut Moments,
        center: [f32; 2],
        [along, across]: [[f32; 2]; 2],
        area: f32,
        rule: &[[f32; 2]],
    ) {
        for &[x, of_x] in rule {
            let start = [center[0] + along[0] * x, center[1] + along[1] * x];
            for &[y, of_y] in rule {
                let node = [start[0] + across[0] * y, start[1] + across[1] * y];
                self.node(sum, node, area * (of_x * of_y));
            }
        }
    }

    /// A triangle by three nodes or by Radon's seven.
    #[inline]
    fn triangle(&self, sum: &mut Moments, [p, q, r]: [[f32; 2]; 3], near: bool) {
        let (along, across) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
        let area = 0.5 * (along[0] * across[1] - along[1] * across[0]).abs();
        let rule: &[[f32; 3]] = if near { &RADON } else { &THREE };
        for &[x, y, weight] in rule {
            let node = [
                p[0] + along[0] * x + across[0] * y,
                p[1] + along[1] * x + across[1] * y,
            ];
            self.node(sum, node, area * weight);
        }
    }

    #[cfg_attr(feature = "small", inline(never))]
    #[cfg_attr(not(feature = "small"), inline(always))]
    fn node(&self, sum: &mut Moments, [a, b]: [f32; 2], weight: f32) {
        let [height, height_a, height_b] = self.height;
        let [squared, along_a, along_b, unit] = self.squared;
        let height = height + height_a * a + height_b * b;
        let distance =
            squared + a * (along_a + along_a + unit * a) + b * (along_b + along_b + unit * b);
        if height > 0.0 && distance > 0.0 {
            // Twice by the distance and not once by its square, which could
            // leave the range of single precision.
            let inverse = 1.0 / distance;
            let part = (weight * self.scale * inverse) * (height * inverse);
            sum.factor += part;
            sum.first[0] += part * a;
            sum.first[1] += part * b;
        }
    }
}

/// Whether these are the corners p, q, r, s of a parallelogram: p + r = q + s to
/// the rounding of coordinates of magnitude 1.
#[inline]
pub(crate) fn is_parallelogram(corners: &[[f32; 2]]) -> bool {
    let off = |p: f32, q: f32, r: f32, s: f32| ((p - q) + (r - s)).abs() <= 1e-6;
    match *corners {
        [p, q, r, s] => off(p[0], q[0], r[0], s[0]) && off(p[1], q[1], r[1], s[1]),
        _ => false,
    }
}

/// Nodes and weights of Gauss rules on [−1, 1]; the weights' sum is 1.
const GAUSS_2: [[f32; 2]; 2] = [[-0.577_350_27, 0.5], [0.577_350_27, 0.5]];
const GAUSS_4: [[f32; 2]; 4] = [
    [-0.861_136_3, 0.173_927_42],
    [-0.339_981_05, 0.326_072_58],
    [0.339_981_05, 0.326_072_58],
    [0.861_136_3, 0.173_927_42],
];

/// Barycentric nodes and weights on a triangle: second degree, and Radon 1948,
/// fifth degree.
const THREE: [[f32; 3]; 3] = [
    [1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0],
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 3.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 3.0],
];
const RADON: [[f32; 3]; 7] = [
    [1.0 / 3.0, 1.0 / 3.0, 0.225],
    [0.101_286_51, 0.101_286_51, 0.125_939_18],
    [0.797_427, 0.101_286_51, 0.125_939_18],
    [0.101_286_51, 0.797_427, 0.125_939_18],
    [0.470_142_06, 0.470_142_06, 0.132_394_15],
    [0.059_715_87, 0.470_142_06, 0.132_394_15],
    [0.470_142_06, 0.059_715_87, 0.132_394_15],
];
