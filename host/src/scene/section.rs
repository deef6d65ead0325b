//! Whether a polygon reaches into the convex hull of some places.

use glam::{DVec2, DVec3};

use super::Surface;

/// Whether `surface` has area inside the convex hull of `places`.
///
/// The hull's section with the surface's plane is the convex hull of the
/// places on the plane and of the crossings of all segments between a place
/// above and one below; the polygon, concave ones too, is clipped by it.
/// `flat` in metres is the distance within which a place is on the plane; a
/// strip of that width along the polygon's edges does not count as area.
/// A hull that only touches the plane has no inside there.
pub(crate) fn section_overlap(places: &[DVec3], surface: &Surface, flat: f64) -> bool {
    let center = surface.center();
    let (u, v) = surface.normal.any_orthonormal_pair();
    let flatten = |place: DVec3| DVec2::new((place - center).dot(u), (place - center).dot(v));
    let heights: Vec<f64> = places
        .iter()
        .map(|&place| (place - center).dot(surface.normal))
        .collect();
    let above = heights.iter().any(|&height| height > flat);
    let below = heights.iter().any(|&height| height < -flat);
    if !(above && below) {
        return false;
    }
    let mut section = Vec::new();
    for (i, (&a, &high)) in places.iter().zip(&heights).enumerate() {
        if high.abs() <= flat {
            section.push(flatten(a));
            continue;
        }
        for (&b, &low) in places[i + 1..].iter().zip(&heights[i + 1..]) {
            if low.abs() > flat && (high > 0.0) != (low > 0.0) {
                section.push(flatten(a + (b - a) * (high / (high - low))));
            }
        }
    }
    let hull = convex_hull(section);
    if hull.len() < 3 {
        return false;
    }
    let polygon: Vec<DVec2> = surface
        .vertices
        .iter()
        .map(|&vertex| flatten(vertex))
        .collect();
    let negligible = flat * perimeter(&polygon);
    let mut clipped = polygon;
    for (i, &from) in hull.iter().enumerate() {
        let along = hull[(i + 1) % hull.len()] - from;
        clipped = clip_left(&clipped, from, along);
    }
    area(&clipped).abs() > negligible
}

/// The convex hull, counter-clockwise (Andrew's monotone chain).
fn convex_hull(mut places: Vec<DVec2>) -> Vec<DVec2> {
    places.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    places.dedup();
    if places.len() < 3 {
        return places;
    }
    let half = |ordered: &mut dyn Iterator<Item = &DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for &place in ordered {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(place - b) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(place);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut places.iter());
    hull.extend(half(&mut places.iter().rev()));
    hull
}

/// The part of a polygon left of a line (Sutherland and Hodgman). Parts of a
/// concave polygon stay joined by pieces of the line that add no area.
fn clip_left(polygon: &[DVec2], origin: DVec2, along: DVec2) -> Vec<DVec2> {
    let side = |place: DVec2| along.perp_dot(place - origin);
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (i, &from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let (a, b) = (side(from), side(to));
        if a >= 0.0 {
            kept.push(from);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            kept.push(from + (to - from) * (a / (a - b)));
        }
    }
    kept
}

fn area(polygon: &[DVec2]) -> f64 {
    let count = polygon.len();
    let doubled: f64 = (0..count)
        .map(|i| polygon[i].perp_dot(polygon[(i + 1) % count]))
        .sum();
    0.5 * doubled
}

fn perimeter(polygon: &[DVec2]) -> f64 {
    let count = polygon.len();
    (0..count)
        .map(|i| polygon[i].distance(polygon[(i + 1) % count]))
        .sum()
}
