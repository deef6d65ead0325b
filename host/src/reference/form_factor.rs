//! The form factor of a differential area to a polygon, in f64.
//!
//! Three ways, each where it is well conditioned: the contour integral with
//! `atan2` angles for polygons of ordinary size, a product Gauss rule over a
//! fan of triangles for small or far ones, and an error-bounded test of the
//! side on which the receiver lies.

use std::sync::LazyLock;

use gauss_quad::legendre::GaussLegendre;
use glam::DVec3;

/// A polygon whose vertices all lie within this fraction of the distance from
/// its first vertex is integrated by quadrature. The contour form loses
/// `u / s` relative digits at angular size `s` (7e-15 here); the 4 x 4 rule
/// errs by about `(s/2)^8`, which is below rounding.
const SMALL: f64 = 0.02;

/// Nodes in one direction of the rule for small triangles.
const SMALL_ORDER: usize = 4;

/// Squared sine of the angle between an edge and its distance vector below
/// which the cross product is formed with exactly rounded products.
const NEARLY_PARALLEL: f64 = 1e-4;

/// Gauss-Legendre nodes and weights on `[0, 1]` for small triangles.
static SMALL_RULE: LazyLock<[(f64, f64); SMALL_ORDER]> = LazyLock::new(|| {
    let order = std::num::NonZeroUsize::new(SMALL_ORDER).unwrap_or(std::num::NonZeroUsize::MIN);
    let rule = GaussLegendre::new(order);
    let mut pairs = [(0.0, 0.0); SMALL_ORDER];
    for (pair, &(node, weight)) in pairs.iter_mut().zip(rule.iter()) {
        *pair = (0.5 * (node + 1.0), 0.5 * weight);
    }
    pairs
});

/// The form factor F of a differential area at `position` facing `normal` to
/// the polygon: the fraction of the light leaving the area diffusely that
/// would reach the polygon's front, and by reciprocity E = π L F for a
/// polygon of radiance L.
///
/// The vertices run counter-clockwise seen from the emitting side and may
/// form any simple polygon, concave too. The polygon is clipped to the
/// receiver's horizon; `normal` need not be of unit length. A point on the
/// polygon's plane (closer than the rounding of its coordinates can tell) or
/// behind it gets 0, as does a zero normal and a polygon of fewer than three
/// vertices.
///
/// Source: Lambert's contour formula, `F = -1/(2π) Σ θᵢ n·(vᵢ × vᵢ₊₁)/|vᵢ × vᵢ₊₁|`
/// with `v` relative to the receiver and `θᵢ = atan2(|vᵢ × eᵢ|, vᵢ·vᵢ₊₁)`, edges
/// `eᵢ` taken between original vertices. For polygons of angular size below
/// 0.02 the double integral `∫ cos cos / (π r²) dA` itself, by a product
/// Gauss rule.
///
/// Error: about 2e-15 absolute; for small unclipped polygons 1e-12 relative,
/// unless they are seen so obliquely that rounding of the coordinates alone
/// exceeds that. Cost: one square root and one arc tangent an edge, or 16
/// points a triangle.
#[must_use]
pub fn form_factor(position: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    if polygon.len() < 3 || !lies_in_front(position, polygon) {
        return 0.0;
    }
    form_factor_signed(position, normal, polygon).clamp(0.0, 1.0)
}

/// The two-sided form factor: as [`form_factor`] in front of the polygon,
/// and its negative counterpart behind it (the factor to the back, with the
/// sign reversed). On the polygon's plane the value is the limit from
/// whichever side rounding takes.
#[must_use]
pub fn form_factor_signed(position: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let Some(normal) = normal.try_normalize() else {
        return 0.0;
    };
    if polygon.len() < 3 {
        return 0.0;
    }
    let anchor = polygon[0];
    let reach = polygon
        .iter()
        .map(|vertex| (*vertex - anchor).length_squared())
        .fold(0.0, f64::max);
    if reach <= SMALL * SMALL * (anchor - position).length_squared() {
        small_polygon(position, normal, polygon)
    } else {
        contour(position, normal, polygon)
    }
}

/// Whether `position` lies in front of the polygon's plane by more than the
/// rounding of `m · (position - first vertex)`, m the sum of the fan's cross
/// products (Newell's normal). A wrong sign here would be an error of order 1
/// right above the polygon, so doubt counts as lying on the plane.
fn lies_in_front(position: DVec3, polygon: &[DVec3]) -> bool {
    let anchor = polygon[0];
    let mut area = DVec3::ZERO;
    let mut magnitude = 0.0;
    for pair in polygon[1..].windows(2) {
        let (a, b) = (pair[0] - anchor, pair[1] - anchor);
        area += exact_cross(a, b);
        magnitude += (a.abs().max_element() * b.abs().max_element()).abs();
    }
    let away = position - anchor;
    let height = area.dot(away);
    let rounding = 4.0
        * f64::EPSILON
        * (area.abs().dot(away.abs()) + f64::EPSILON * magnitude * away.abs().max_element());
    height > rounding
}

/// `a × b` with each component correct to two units in the last place
/// (Kahan's difference of products).
fn exact_cross(a: DVec3, b: DVec3) -> DVec3 {
    let difference = |p: f64, q: f64, r: f64, s: f64| {
        let second = r * s;
        let slip = (-r).mul_add(s, second);
        p.mul_add(q, -second) + slip
    };
    DVec3::new(
        difference(a.y, b.z, a.z, b.y),
        difference(a.z, b.x, a.x, b.z),
        difference(a.x, b.y, a.y, b.x),
    )
}

/// `a × e = b × e` for the edge `e` from `a` to `b`, from the endpoint nearer to
/// the receiver, whose rounding is smaller; carefully where the two are
/// nearly parallel: there the receiver lies almost on the line of an edge and
/// the direction of the product weighs an angle near 0 or π.
fn cross(a: DVec3, b: DVec3, e: DVec3) -> DVec3 {
    let near = if a.length_squared() < b.length_squared() {
        a
    } else {
        b
    };
    let product = near.cross(e);
    if product.length_squared() < NEARLY_PARALLEL * near.length_squared() * e.length_squared() {
        exact_cross(near, e)
    } else {
        product
    }
}

/// Lambert's contour formula over the loop clipped to `n · v >= 0`.
fn contour(position: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let mut sum = 0.0;
    let mut entered: Option<DVec3> = None;
    let mut left: Option<DVec3> = None;
    for (index, &start) in polygon.iter().enumerate() {
        let end = polygon[(index + 1) % polygon.len()];
        let (a, b, e) = (start - position, end - position, end - start);
        let (above_a, above_b) = (normal.dot(a), normal.dot(b));
        match (above_a >= 0.0, above_b >= 0.0) {
            (true, true) => sum += edge_term(normal, a, b, cross(a, b, e), 1.0),
            (true, false) => {
                let (crossing, share) = horizon_crossing(a, b, e, above_a, above_b);
                sum += edge_term(normal, a, crossing, cross(a, b, e), share);
                left = Some(crossing);
            }
            (false, true) => {
                let (crossing, share) = horizon_crossing(b, a, -e, above_b, above_a);
                sum += edge_term(normal, crossing, b, cross(a, b, e), share);
                match left.take() {
                    Some(from) => sum += horizon_term(normal, from, crossing),
                    None => entered = Some(crossing),
                }
            }
            (false, false) => {}
        }
    }
    if let (Some(from), Some(to)) = (left, entered) {
        sum += horizon_term(normal, from, to);
    }
    -sum / std::f64::consts::TAU
}

/// Where the edge from `a` to `b` meets the horizon, computed from the
/// endpoint nearer to it, and the share of the edge between `a` and that point.
fn horizon_crossing(a: DVec3, b: DVec3, e: DVec3, above_a: f64, above_b: f64) -> (DVec3, f64) {
    let share = above_a / (above_a - above_b);
    let crossing = if above_a.abs() <= above_b.abs() {
        a + e * share
    } else {
        b + e * (above_b / (above_a - above_b))
    };
    (crossing, share)
}

/// `θ n·ĉ` of the edge from `a` to `b`, where `whole = a × e` belongs to the
/// unclipped edge and `share` of that edge remains: clipping does not change
/// the direction of the product.
fn edge_term(normal: DVec3, a: DVec3, b: DVec3, whole: DVec3, share: f64) -> f64 {
    let length = whole.length();
    if length == 0.0 {
        return 0.0;
    }
    (length * share).atan2(a.dot(b)) * (normal.dot(whole) / length)
}

/// The term of an edge that lies in the horizon plane: its direction is the
/// normal's, up to sign.
fn horizon_term(normal: DVec3, a: DVec3, b: DVec3) -> f64 {
    let product = exact_cross(a, b);
    let angle = product.length().atan2(a.dot(b));
    if normal.dot(product) < 0.0 {
        -angle
    } else {
        angle
    }
}

/// `∫ cos cos / (π r²)` over the fan of triangles from the first vertex,
/// signed so that concave polygons come out right, each clipped to the
/// horizon. Offsets from the first vertex come from original coordinates.
fn small_polygon(position: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let anchor = polygon[0];
    let towards = anchor - position;
    polygon[1..]
        .windows(2)
        .map(|pair| {
            let corners = [DVec3::ZERO, pair[0] - anchor, pair[1] - anchor];
            clipped_triangle(towards, normal, corners)
        })
        .sum::<f64>()
        / std::f64::consts::PI
}

/// The part above the horizon of one triangle, given by offsets from a point
/// at `towards` from the receiver.
fn clipped_triangle(towards: DVec3, normal: DVec3, corners: [DVec3; 3]) -> f64 {
    let base = normal.dot(towards);
    let above = corners.map(|corner| base + normal.dot(corner));
    if above.iter().all(|height| *height >= 0.0) {
        return triangle_integral(towards, normal, corners);
    }
    let mut kept = [DVec3::ZERO; 4];
    let mut count = 0;
    for index in 0..3 {
        let next = (index + 1) % 3;
        if above[index] >= 0.0 {
            kept[count] = corners[index];
            count += 1;
        }
        if (above[index] >= 0.0) != (above[next] >= 0.0) {
            let share = above[index] / (above[index] - above[next]);
            kept[count] = corners[index] + (corners[next] - corners[index]) * share;
            count += 1;
        }
    }
    (2..count)
        .map(|last| triangle_integral(towards, normal, [kept[0], kept[last - 1], kept[last]]))
        .sum()
}

/// `∫ (n·r)(-m·r)/r⁴ dA` over a triangle wholly above the horizon, by the
/// product rule collapsed at the first corner.
fn triangle_integral(towards: DVec3, normal: DVec3, corners: [DVec3; 3]) -> f64 {
    let (side, across) = (corners[1] - corners[0], corners[2] - corners[1]);
    let doubled_area = exact_cross(side, corners[2] - corners[0]);
    let facing = -doubled_area.dot(towards + corners[0]);
    let mut sum = 0.0;
    for &(u, u_weight) in SMALL_RULE.iter() {
        for &(v, v_weight) in SMALL_RULE.iter() {
            let r = towards + (corners[0] + (side + across * v) * u);
            let square = r.length_squared();
            sum += u_weight * v_weight * u * normal.dot(r) / (square * square);
        }
    }
    facing * sum
}
