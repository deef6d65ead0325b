//! Convex polygons: cutting, halving, and places to integrate over them.

use glam::DVec3;
use smallvec::SmallVec;

use super::rule::Rule;

/// Vertices of a convex polygon in order.
pub(super) type Loop = SmallVec<[DVec3; 8]>;

/// The two parts of a convex polygon: where `normal · v >= offset`, and the
/// rest. Vertices within `rounding` of the plane belong to both; a part that
/// does not reach beyond `rounding` is empty.
pub(super) fn cut(polygon: &[DVec3], normal: DVec3, offset: f64, rounding: f64) -> (Loop, Loop) {
    let heights: SmallVec<[f64; 8]> = polygon.iter().map(|v| normal.dot(*v) - offset).collect();
    if heights.iter().all(|height| *height <= rounding) {
        return (Loop::new(), polygon.into());
    }
    if heights.iter().all(|height| *height >= -rounding) {
        return (polygon.into(), Loop::new());
    }
    let (mut inside, mut outside) = (Loop::new(), Loop::new());
    for (index, &vertex) in polygon.iter().enumerate() {
        let next = (index + 1) % polygon.len();
        let (here, there) = (heights[index], heights[next]);
        if here >= -rounding {
            inside.push(vertex);
        }
        if here <= rounding {
            outside.push(vertex);
        }
        if (here > rounding && there < -rounding) || (here < -rounding && there > rounding) {
            let crossing = vertex.lerp(polygon[next], here / (here - there));
            inside.push(crossing);
            outside.push(crossing);
        }
    }
    (inside, outside)
}

/// Area of a planar polygon with this unit normal, negative where it runs clockwise.
pub(super) fn area(polygon: &[DVec3], normal: DVec3) -> f64 {
    let Some((&anchor, rest)) = polygon.split_first() else {
        return 0.0;
    };
    let fan = rest.windows(2);
    0.5 * fan
        .map(|pair| (pair[0] - anchor).cross(pair[1] - anchor).dot(normal))
        .sum::<f64>()
}

/// The mean of the vertices and the largest distance of one from it.
pub(super) fn ball(polygon: &[DVec3]) -> (DVec3, f64) {
    let centre = polygon.iter().sum::<DVec3>() / polygon.len().max(1) as f64;
    let farthest = polygon
        .iter()
        .map(|vertex| vertex.distance_squared(centre))
        .fold(0.0, f64::max);
    (centre, farthest.sqrt())
}

/// The extent of a polygon along a direction: lowest and highest.
pub(super) fn extent(polygon: &[DVec3], along: DVec3) -> (f64, f64) {
    polygon
        .iter()
        .map(|vertex| along.dot(*vertex))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
            (low.min(place), high.max(place))
        })
}

/// Two halves of a polygon, cut across the longer of its extents along `axes`
/// in the middle.
pub(super) fn halves(polygon: &[DVec3], axes: [DVec3; 2]) -> [Loop; 2] {
    let [first, second] = axes.map(|axis| extent(polygon, axis));
    let along_first = first.1 - first.0 >= second.1 - second.0;
    let (axis, (low, high)) = if along_first {
        (axes[0], first)
    } else {
        (axes[1], second)
    };
    let rounding = 1e-9 * (high - low);
    let (inside, outside) = cut(polygon, axis, 0.5 * (low + high), rounding);
    [outside, inside]
}

/// Calls `at` with the nodes and weights (areas) of the product rule over each
/// quadrilateral of the fan from the first vertex; a triangle counts as a
/// quadrilateral with two corners in one place.
pub(super) fn nodes(polygon: &[DVec3], rule: &Rule, mut at: impl FnMut(DVec3, f64)) {
    let Some((&a, rest)) = polygon.split_first() else {
        return;
    };
    let mut first = 0;
    while first + 1 < rest.len() {
        let (b, c) = (rest[first], rest[first + 1]);
        let d = rest.get(first + 2).copied().unwrap_or(a);
        first += 2;
        for (v, v_weight) in rule.nodes.iter().zip(&rule.weights) {
            let along_u = (b - a) * (1.0 - v) + (c - d) * *v;
            let (start, end) = (a.lerp(d, *v), b.lerp(c, *v));
            for (u, u_weight) in rule.nodes.iter().zip(&rule.weights) {
                let along_v = (d - a) * (1.0 - u) + (c - b) * *u;
                let stretch = along_u.cross(along_v).length();
                at(start.lerp(end, *u), u_weight * v_weight * stretch);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{area, cut, halves, nodes};
    use crate::reference::rule::Rule;

    #[test]
    fn nodes_integrate_polynomials_over_every_polygon() {
        let hexagon: Vec<DVec3> = (0..7)
            .map(|k| {
                let angle = f64::from(k) * std::f64::consts::TAU / 7.0;
                DVec3::new(2.0 * angle.cos(), angle.sin(), 0.5)
            })
            .collect();
        let f = |v: DVec3| 1.0 + v.x * v.x - 0.3 * v.y * v.x + v.y;
        let integral = |polygon: &[DVec3], order: usize| {
            let mut sum = 0.0;
            nodes(polygon, &Rule::new(order), |y, weight| sum += weight * f(y));
            sum
        };
        let whole = integral(&hexagon, 3);
        assert!((whole - integral(&hexagon, 7)).abs() < 1e-12);
        let parts = halves(&hexagon, [DVec3::X, DVec3::Y]);
        let sum: f64 = parts.iter().map(|part| integral(part, 3)).sum();
        assert!((whole - sum).abs() < 1e-12);
        let (inside, outside) = cut(&hexagon, DVec3::new(0.6, 0.8, 0.0), 0.3, 1e-12);
        let both = area(&inside, DVec3::Z) + area(&outside, DVec3::Z);
        assert!((both - area(&hexagon, DVec3::Z)).abs() < 1e-12);
    }
}
