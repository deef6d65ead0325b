//! Shadows on the receiver's plane: projections of convex sets from convex sets.

use glam::{DVec2, DVec3};

use super::setting::{Light, Occluder, Setting};
use crate::plan::patches::shapes::{Ring, hull, signed_area};

/// The regions of one convex occluder before one luminaire, on the receiver's
/// bounding rectangle: convex, counter-clockwise, empty where there is none.
#[derive(Clone, Debug, Default)]
pub struct Shadow {
    /// Which occluder of the scene.
    pub occluder: usize,
    /// Where something of the luminaire is hidden: the outer penumbra outline.
    pub outer: Ring,
    /// Where all of it is hidden.
    pub umbra: Ring,
    /// Where the occluder is seen wholly within the luminaire.
    pub antumbra: Ring,
}

impl Shadow {
    /// Whether both hide something from some place.
    pub(super) fn meets(&self, other: &Self) -> bool {
        !common(self.outer.clone(), &other.outer).is_empty()
    }

    /// With S the vertices of the luminaire and O those of the occluder: outer
    /// = the places whose view of something of S meets O, umbra = the
    /// intersection of the shadows from each vertex of S, antumbra = that of
    /// the places which see S through each vertex of O. `None` where the
    /// bounding rectangle has no part of the first.
    pub(super) fn new(setting: &Setting, occluder: &Occluder, bounds: [DVec2; 2]) -> Option<Self> {
        let light = &setting.light;
        let cast = |from: &[DVec3], over: &[DVec3]| shadow(setting, from, over);
        let outer = within(cast(&light.points, &occluder.points), bounds);
        if outer.is_empty() {
            return None;
        }
        let umbra = light.points.iter().map(|&s| cast(&[s], &occluder.points));
        let antumbra = occluder.points.iter().map(|&o| cast(&light.points, &[o]));
        Some(Self {
            occluder: occluder.index,
            umbra: intersection(umbra, bounds),
            antumbra: intersection(antumbra, bounds),
            outer,
        })
    }
}

/// The places p of the receiver's plane from which some segment to the hull of
/// `from` meets the hull of `over`: the plane's section of
/// `over` + cone(`over` − `from`).
///
/// Convex. Its corners are projections of vertices through vertices. Where
/// something of `over` is as high as something of `from` it has no end, and
/// reaches to [`Setting::far`].
fn shadow(setting: &Setting, from: &[DVec3], over: &[DVec3]) -> Ring {
    let level = setting.nothing;
    let mut corners: Vec<[f64; 2]> = Vec::new();
    let mut directions: Vec<DVec2> = Vec::new();
    let (mut down, mut up) = (Vec::new(), Vec::new());
    for &o in over {
        if o.z == 0.0 {
            corners.push(o.truncate().into());
        }
        for &s in from {
            let ray = o - s;
            if ray.z > level {
                up.push(ray);
            } else if ray.z < -level {
                down.push(ray);
                let reach = o.z / -ray.z;
                if ray.truncate().length() * reach > setting.far {
                    directions.push(ray.truncate());
                } else if o.z > 0.0 {
                    corners.push((o + ray * reach).truncate().into());
                }
            } else {
                directions.push(ray.truncate());
            }
        }
    }
    for d in &down {
        let level_ray = |u: &DVec3| (*d * u.z - *u * d.z).truncate();
        directions.extend(up.iter().map(level_ray));
    }
    let corners = hull(corners);
    if corners.is_empty() || directions.is_empty() {
        return corners;
    }
    let ends = extremes(&directions);
    let away = |corner: &[f64; 2]| {
        let corner = DVec2::from(*corner);
        let ends = ends.iter();
        ends.map(move |&end| (corner + end * setting.far).into())
            .collect::<Vec<[f64; 2]>>()
    };
    let far: Vec<[f64; 2]> = corners.iter().flat_map(away).collect();
    hull([corners, far].concat())
}

/// The two directions that bound a cone of less than a half-turn, else all.
fn extremes(directions: &[DVec2]) -> Vec<DVec2> {
    let units: Vec<DVec2> = directions
        .iter()
        .filter_map(|direction| direction.try_normalize())
        .collect();
    let mut ends: Vec<[f64; 2]> = units.iter().map(|&unit| unit.into()).collect();
    ends.push([0.0; 2]);
    let ring = hull(ends);
    match ring.iter().position(|place| *place == [0.0; 2]) {
        Some(at) if ring.len() > 2 => {
            let around = [at + ring.len() - 1, at + 1];
            around.map(|i| ring[i % ring.len()].into()).to_vec()
        }
        _ => units,
    }
}

/// A convex ring cut to a rectangle; empty where no area is left.
fn within(ring: Ring, [low, high]: [DVec2; 2]) -> Ring {
    let rectangle = [
        low,
        DVec2::new(high.x, low.y),
        high,
        DVec2::new(low.x, high.y),
    ];
    common(ring, &rectangle.map(Into::into))
}

/// The intersection of convex rings within a rectangle.
fn intersection(rings: impl Iterator<Item = Ring>, [low, high]: [DVec2; 2]) -> Ring {
    let rectangle = [
        low,
        DVec2::new(high.x, low.y),
        high,
        DVec2::new(low.x, high.y),
    ];
    let mut left: Ring = rectangle.map(Into::into).to_vec();
    for ring in rings {
        if left.is_empty() || ring.len() < 3 {
            return Ring::new();
        }
        left = common(left, &ring);
    }
    left
}

/// The intersection of two convex rings, counter-clockwise.
fn common(mut ring: Ring, other: &[[f64; 2]]) -> Ring {
    let all = signed_area(&ring).abs().min(signed_area(other).abs());
    for i in 0..other.len() {
        let from = DVec2::from(other[i]);
        let along = DVec2::from(other[(i + 1) % other.len()]) - from;
        let height = |place: &[f64; 2]| along.perp_dot(DVec2::from(*place) - from);
        let mut kept = Ring::with_capacity(ring.len() + 1);
        for (k, place) in ring.iter().enumerate() {
            let next = &ring[(k + 1) % ring.len()];
            let (a, b) = (height(place), height(next));
            if a >= 0.0 {
                kept.push(*place);
            }
            if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
                let (start, end) = (DVec2::from(*place), DVec2::from(*next));
                kept.push(start.lerp(end, a / (a - b)).into());
            }
        }
        ring = kept;
    }
    if ring.len() < 3 || signed_area(&ring) <= 1e-12 * all {
        return Ring::new();
    }
    ring
}

/// The line in which the luminaire's plane cuts the receiver's, far to both
/// sides.
pub(super) fn horizon(light: &Light, middle: DVec2, far: f64) -> Option<[DVec2; 2]> {
    let across = light.normal.truncate();
    let steep = across.length();
    if steep < 1e-9 {
        return None;
    }
    let across = across / steep;
    let foot = middle + across * (light.offset / steep - across.dot(middle));
    let along = across.perp() * far;
    (foot.distance(middle) < far).then_some([foot - along, foot + along])
}
