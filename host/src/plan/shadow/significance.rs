//! Whether a line matters: how V behaves across it.

use glam::DVec2;

use super::ShadowMap;

/// Where on a segment V is looked at.
const PLACES: [f64; 5] = [0.5, 0.1, 0.9, 0.3, 0.7];

/// How far from a line V is looked at, as a part of the surface's longer side,
/// where neither the surface's outline nor a contact line is nearer.
const STEP: f64 = 1e-3;

/// A departure of V below this, within two steps of the line, is nothing.
const NOTHING: f64 = 1e-9;

/// The largest departure of V from a smooth function across a segment, at one
/// of five places; `None` where it is less than 1e-9, or vanishes with the
/// step as that of a smooth function does.
///
/// With f(k) = V at k steps to the left, f(1) − 2 f(0) + f(−1) halves with the
/// step where the slope jumps and is quartered where it does not;
/// f(2) − 2 f(1) + 2 f(−1) − f(−2) is quartered where the curvature jumps, and
/// falls to an eighth where it does not.
pub(super) fn of(map: &ShadowMap, [a, b]: [DVec2; 2]) -> Option<f64> {
    let frame = &map.floor.frame;
    let step = STEP * frame.size_u.max(frame.size_v);
    let across = (b - a).normalize_or_zero().perp();
    let departures = PLACES.iter().filter_map(|&t| {
        let place = a.lerp(b, t);
        // V jumps on contact lines and means nothing beyond the outline.
        let across = across * step.min(map.floor.clearance(place) / 3.0);
        let value = |steps: f64| {
            let p = place + across * steps;
            map.fraction(p.x, p.y)
        };
        let [before, after] = [-2.0, 2.0].map(value);
        // Where one side has no V, the line is as the other side sees it.
        let (Some(before), Some(after)) = (before, after) else {
            return Some(NOTHING);
        };
        let [first, second, half, half_back, here] = [1.0, -1.0, 0.5, -0.5, 0.0].map(value);
        let (first, second) = (first?, second?);
        let (half, half_back, here) = (half?, half_back?, here?);
        let slope = (first - 2.0 * here + second).abs();
        let finer_slope = (half - 2.0 * here + half_back).abs();
        let curve = (after - 2.0 * first + 2.0 * second - before).abs();
        let finer_curve = (first - 2.0 * half + 2.0 * half_back - second).abs();
        let bent = slope > NOTHING && slope < 3.0 * finer_slope;
        let curved = curve > NOTHING && curve < 6.0 * finer_curve;
        let departure = if bent { slope } else { 0.0_f64 };
        let departure = if curved {
            departure.max(curve)
        } else {
            departure
        };
        (departure > 0.0).then_some(departure)
    });
    departures.reduce(f64::max)
}
