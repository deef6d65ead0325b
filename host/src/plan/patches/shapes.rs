//! Polygons in a plane: areas, moments, hulls, convex pieces.

use earcut::Earcut;
use glam::DVec2;

/// Corners in order.
pub(crate) type Ring = Vec<[f64; 2]>;

/// Convex pieces, counter-clockwise, of polygons with holes: of each the first
/// ring is its outline.
pub(crate) fn convex_pieces(parts: &[Vec<Ring>]) -> Vec<Ring> {
    parts.iter().flat_map(|part| convex(part)).collect()
}

/// The convex hull, counter-clockwise (Andrew 1979).
pub(crate) fn hull(points: Vec<[f64; 2]>) -> Ring {
    let mut points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., before, last] = chain[..] {
                if (last - before).perp_dot(point - last) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let lower = half(&mut points.iter().copied());
    let upper = half(&mut points.iter().rev().copied());
    lower.into_iter().chain(upper).map(Into::into).collect()
}

/// Convex pieces of a polygon with holes: itself where it is convex, else
/// triangles.
fn convex(rings: &[Ring]) -> Vec<Ring> {
    if let [ring] = rings
        && is_convex(ring)
    {
        return vec![ring.clone()];
    }
    let mut starts = Vec::new();
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for (number, ring) in rings.iter().enumerate() {
        if number > 0 {
            starts.push(corners.len());
        }
        corners.extend(ring);
    }
    let mut indices: Vec<usize> = Vec::new();
    Earcut::new().earcut(corners.iter().copied(), &starts, &mut indices);
    indices
        .chunks_exact(3)
        .map(|triangle| {
            let mut ring: Ring = triangle.iter().map(|&index| corners[index]).collect();
            if signed_area(&ring) < 0.0 {
                ring.reverse();
            }
            ring
        })
        .collect()
}

pub(super) fn edges(ring: &[[f64; 2]]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let next = ring.iter().cycle().skip(1);
    ring.iter()
        .zip(next)
        .map(|(&from, &to)| (from.into(), to.into()))
}

pub(crate) fn is_convex(ring: &[[f64; 2]]) -> bool {
    let sides: Vec<DVec2> = edges(ring).map(|(from, to)| to - from).collect();
    let next = sides.iter().cycle().skip(1);
    sides
        .iter()
        .zip(next)
        .all(|(side, next)| side.perp_dot(*next) >= -1e-9 * side.length() * next.length())
}

pub(crate) fn signed_area(ring: &[[f64; 2]]) -> f64 {
    edges(ring).map(|(from, to)| 0.5 * from.perp_dot(to)).sum()
}

/// ∫ x dA.
pub(crate) fn first_moment(ring: &[[f64; 2]]) -> DVec2 {
    let base = DVec2::from(ring[0]);
    let triangles = edges(ring).map(|(from, to)| {
        let area = 0.5 * (from - base).perp_dot(to - base);
        (base + from + to) / 3.0 * area
    });
    triangles.sum()
}

/// Centroid in the surface's frame and unit of length of the own coordinates of what
/// these pieces make up: no corner is farther than 1.
pub(crate) fn own_frame(pieces: &[Vec<[f64; 2]>]) -> ([f64; 2], f64) {
    let (moment, area) = pieces.iter().fold((DVec2::ZERO, 0.0), |sum, piece| {
        (sum.0 + first_moment(piece), sum.1 + signed_area(piece))
    });
    let center = moment / area;
    let corners = pieces.iter().flatten();
    let farthest = corners.map(|&corner| DVec2::from(corner).distance(center));
    (center.into(), farthest.fold(0.0, f64::max))
}

pub(super) fn bounds(pieces: &[Ring]) -> [[f64; 2]; 2] {
    let corners = || pieces.iter().flatten().map(|&corner| DVec2::from(corner));
    let low = corners().fold(DVec2::INFINITY, DVec2::min);
    let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max);
    [low.into(), high.into()]
}
