//! A polygon as convex quadrilaterals, none of which is crossed by a plane at
//! which the light on it has a kink.

use earcut::Earcut;
use glam::DVec3;

/// A part smaller than this share of its polygon is not cut off: what a kink
/// does inside it is below every tolerance here.
const NEGLIGIBLE: f64 = 1e-13;

/// A plane through a point, with a unit normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// A point of the plane.
    pub(super) point: DVec3,
    /// Unit normal.
    pub(super) normal: DVec3,
}

/// Splits a simple polygon with unit normal `normal` along `planes` and into
/// convex quadrilaterals. `None` if it cannot be triangulated, which means
/// that its outline crosses itself.
pub(super) fn quadrilaterals(
    polygon: &[DVec3],
    normal: DVec3,
    planes: &[Plane],
) -> Option<Vec<[DVec3; 4]>> {
    let whole = area(polygon, normal);
    let mut pieces = convex_pieces(polygon, normal)?;
    for plane in planes {
        let mut split = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let sides = [1.0, -1.0].map(|side| clip(&piece, plane, side));
            let divides = crosses(&piece, plane)
                && sides
                    .iter()
                    .all(|part| part.len() >= 3 && area(part, normal) > NEGLIGIBLE * whole);
            if divides {
                split.extend(sides);
            } else {
                split.push(piece);
            }
        }
        pieces = split;
    }
    Some(pieces.iter().flat_map(|piece| spread(piece)).collect())
}

fn area(polygon: &[DVec3], normal: DVec3) -> f64 {
    let anchor = polygon[0];
    let fan = polygon[1..].windows(2);
    0.5 * fan
        .map(|pair| (pair[0] - anchor).cross(pair[1] - anchor).dot(normal))
        .sum::<f64>()
}

/// The polygon itself where it is convex, its triangles otherwise.
pub(super) fn convex_pieces(polygon: &[DVec3], normal: DVec3) -> Option<Vec<Vec<DVec3>>> {
    let count = polygon.len();
    let turns_left = (0..count).all(|index| {
        let (a, b, c) = (
            polygon[index],
            polygon[(index + 1) % count],
            polygon[(index + 2) % count],
        );
        let (incoming, outgoing) = (b - a, c - b);
        incoming.cross(outgoing).dot(normal) >= -1e-12 * incoming.length() * outgoing.length()
    });
    if turns_left {
        return Some(vec![polygon.to_vec()]);
    }
    let (u, v) = normal.any_orthonormal_pair();
    // The pair is right-handed with the normal, so the order of turn stays.
    let flat = polygon.iter().map(|vertex| {
        let offset = *vertex - polygon[0];
        [offset.dot(u), offset.dot(v)]
    });
    let mut indices: Vec<usize> = Vec::new();
    Earcut::new().earcut(flat, &[] as &[usize], &mut indices);
    let triangles: Vec<Vec<DVec3>> = indices
        .chunks_exact(3)
        .map(|triple| {
            let mut corners: Vec<DVec3> = triple.iter().map(|index| polygon[*index]).collect();
            if area(&corners, normal) < 0.0 {
                corners.reverse();
            }
            corners
        })
        .collect();
    let whole = area(polygon, normal);
    let covered: f64 = triangles.iter().map(|corners| area(corners, normal)).sum();
    ((covered - whole).abs() <= 1e-9 * whole).then_some(triangles)
}

/// Whether the polygon has vertices on either side of the plane by more than
/// rounding; the plane of the polygon itself does not cross it.
fn crosses(polygon: &[DVec3], plane: &Plane) -> bool {
    let rounding = 1e-12 * (polygon[0] - plane.point).length()
        + 1e-12 * polygon.iter().map(|v| v.distance(polygon[0])).sum::<f64>();
    let height = |vertex: &DVec3| plane.normal.dot(*vertex - plane.point);
    polygon.iter().any(|vertex| height(vertex) > rounding)
        && polygon.iter().any(|vertex| height(vertex) < -rounding)
}

/// The part of a convex polygon on one side of a plane.
fn clip(polygon: &[DVec3], plane: &Plane, side: f64) -> Vec<DVec3> {
    let heights: Vec<f64> = polygon
        .iter()
        .map(|vertex| side * plane.normal.dot(*vertex - plane.point))
        .collect();
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (index, &vertex) in polygon.iter().enumerate() {
        let next = (index + 1) % polygon.len();
        let (here, there) = (heights[index], heights[next]);
        if here >= 0.0 {
            kept.push(vertex);
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push(vertex.lerp(polygon[next], here / (here - there)));
        }
    }
    kept
}

/// A convex polygon as quadrilaterals: a quadrilateral as it is, any other
/// from each corner over the midpoints of its sides to the centroid.
fn spread(polygon: &[DVec3]) -> Vec<[DVec3; 4]> {
    if let [a, b, c, d] = *polygon {
        return vec![[a, b, c, d]];
    }
    let count = polygon.len();
    let centroid = polygon.iter().sum::<DVec3>() / count as f64;
    (0..count)
        .map(|index| {
            let (before, corner, after) = (
                polygon[(index + count - 1) % count],
                polygon[index],
                polygon[(index + 1) % count],
            );
            [
                corner,
                corner.midpoint(after),
                centroid,
                before.midpoint(corner),
            ]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Plane, area, quadrilaterals};

    #[test]
    fn the_pieces_cover_a_concave_polygon_and_respect_the_planes() {
        let outline = [(0., 0.), (4., 0.), (4., 1.), (1., 1.), (1., 3.), (0., 3.)];
        let polygon: Vec<DVec3> = outline
            .iter()
            .map(|(x, y)| DVec3::new(*x, *y, 2.0))
            .collect();
        let plane = Plane {
            point: DVec3::new(2.2, 0.0, 0.0),
            normal: DVec3::new(0.8, 0.6, 0.0),
        };
        let own = Plane {
            point: polygon[3],
            normal: DVec3::Z,
        };
        let pieces = quadrilaterals(&polygon, DVec3::Z, &[plane, own]).expect("a simple polygon");
        let covered: f64 = pieces.iter().map(|piece| area(piece, DVec3::Z)).sum();
        assert!((covered - 6.0).abs() < 1e-12);
        for piece in pieces {
            let heights = piece.map(|corner| plane.normal.dot(corner - plane.point));
            assert!(heights.iter().all(|h| *h > -1e-12) || heights.iter().all(|h| *h < 1e-12));
        }
    }
}
