//! Form factors to judge a rung by: random cases of every kind that is hard
//! for one of them, with the answer of the f64 reference.
//!
//! The cases are generated, not stored: the same on every machine, because the
//! generator is of integers and the rest is exactly rounded arithmetic. Every
//! coordinate is rounded to `f32` before the reference sees it, so a rung is
//! judged by its arithmetic and not by the rounding of its input.

use crate::reference;
use glam::DVec3;

/// Cases of a class.
pub const CASES: usize = 200;

/// The kinds of cases, in the order of reports.
///
/// | class | a case |
/// | --- | --- |
/// | `ordinary` | a polygon of 3 to 8 vertices, 0.2 to 2 as wide as it is far |
/// | `near_plane` | the receiver 1e-7 to 1e-1 in front of the emitter's plane |
/// | `near_edge` | the receiver 1e-7 to 1e-1 from an edge |
/// | `near_vertex` | the receiver 1e-7 to 1e-1 from a vertex |
/// | `grazing` | the emitter within 1e-7 to 1e-1 rad of the horizon |
/// | `tiny` | F from about 1e-12 to 1e-3 |
/// | `huge` | a polygon up to 1e4 as wide as it is far, F up to 0.9999 |
/// | `sliver` | 1e-6 to 1e-1 as thick as long |
/// | `collinear` | ordinary, with vertices twice and in the middle of edges |
/// | `offset` | ordinary, 1e2 to 1e6 from the origin |
/// | `scale` | ordinary, 1e-6 to 1e6 in size |
/// | `nonconvex` | an L or a star |
/// | `backface` | the receiver behind the emitter: F = 0 |
///
/// The receiver faces any direction from which the emitter is above its
/// horizon at least in part, but for `tiny`, where it faces the emitter. In the
/// classes `near_…` and in half of `huge` the emitter's plane is across an axis:
/// rounding would bend a leaning polygon by more than the receiver is away.
pub const CLASSES: [&str; 13] = [
    "ordinary",
    "near_plane",
    "near_edge",
    "near_vertex",
    "grazing",
    "tiny",
    "huge",
    "sliver",
    "collinear",
    "offset",
    "scale",
    "nonconvex",
    "backface",
];

/// The class whose errors are the input's, not the rung's: single precision
/// holds the difference from a vertex to u |V − P|, which turns an edge at the
/// distance h by u L/h whatever is computed from it. Kept out of the totals.
pub const CONDITIONED: &str = "near_edge";

/// The class by which relative accuracy is judged.
pub const RELATIVE: &str = "tiny";

/// One receiver and one emitter.
#[derive(Clone, Debug)]
pub struct Case {
    /// Position of the receiver in metres.
    pub position: [f32; 3],
    /// Normal of the receiver.
    pub normal: [f32; 3],
    /// The emitter, counter-clockwise seen from its front.
    pub vertices: Vec<[f32; 3]>,
    /// The form factor by the reference.
    pub exact: f64,
}

/// The cases of a class in reports; none for a name that is no class.
#[must_use]
pub fn cases(class: &str) -> Vec<Case> {
    cases_of(class, 1)
}

/// Cases of a class, others for every seed; none for a name that is no class.
#[must_use]
pub fn cases_of(class: &str, seed: u64) -> Vec<Case> {
    let Some(number) = CLASSES.iter().position(|known| *known == class) else {
        return Vec::new();
    };
    let mut random = Random(seed.wrapping_mul(0x1000).wrapping_add(number as u64));
    let mut cases = Vec::with_capacity(CASES);
    // Cases that miss their class are few: the bound only ends what cannot be.
    for _ in 0..100 * CASES {
        if cases.len() == CASES {
            break;
        }
        let case = shape(class, &mut random).judged();
        let wanted = match class {
            "backface" => case.exact == 0.0,
            "tiny" => case.exact > 1e-13 && case.exact < 1e-3,
            _ => case.exact > 0.0,
        };
        if wanted {
            cases.push(case);
        }
    }
    cases
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    /// Uniform on [0, 1), 53 bits.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform in the exponent.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    fn whole(&mut self, low: usize, high: usize) -> usize {
        low + (self.unit() * (high - low + 1) as f64) as usize
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)));
            let length = v.length();
            if length > 0.1 && length <= 1.0 {
                return v / length;
            }
        }
    }
}

/// A case before it is placed in space: the emitter in the plane z = 0, its
/// front up.
struct Shape {
    corners: Vec<[f64; 2]>,
    receiver: DVec3,
    normal: DVec3,
    /// Metres a unit of the shape.
    size: f64,
    /// Where its origin comes to lie, in metres.
    offset: DVec3,
    frame: [DVec3; 3],
}

impl Shape {
    /// Turned, scaled, moved, rounded to single precision, and judged.
    fn judged(self) -> Case {
        let turn = |v: DVec3| self.frame[0] * v.x + self.frame[1] * v.y + self.frame[2] * v.z;
        let place = |v: DVec3| (turn(v) * self.size + self.offset).as_vec3().to_array();
        let position = place(self.receiver);
        let normal = turn(self.normal).as_vec3().to_array();
        let corners = self.corners.iter();
        let vertices: Vec<[f32; 3]> = corners
            .map(|&[x, y]| place(DVec3::new(x, y, 0.0)))
            .collect();
        let double = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let polygon: Vec<DVec3> = vertices.iter().map(|&v| double(v)).collect();
        let exact = reference::form_factor(double(position), double(normal), &polygon);
        Case {
            position,
            normal,
            vertices,
            exact,
        }
    }
}

fn shape(class: &str, random: &mut Random) -> Shape {
    let towards = random.direction();
    let other = random.direction();
    let side = towards
        .cross(other)
        .try_normalize()
        .unwrap_or(towards.any_orthonormal_vector());
    let mut shape = Shape {
        corners: convex(random),
        receiver: DVec3::new(
            random.between(-1.5, 1.5),
            random.between(-1.5, 1.5),
            random.between(0.5, 3.0),
        ),
        normal: DVec3::NEG_Z,
        size: 1.0,
        offset: DVec3::ZERO,
        frame: [side, towards.cross(side), towards],
    };
    if class.starts_with("near_") || (class == "huge" && random.unit() < 0.5) {
        // Rounding would bend a leaning polygon by more than it is away.
        shape.frame = [DVec3::Y, DVec3::Z, DVec3::X];
    }
    let close = random.decades(-7.0, -1.0);
    match class {
        "near_plane" => shape.receiver.z = close,
        "near_edge" => {
            let ([a, b], t) = (first_edge(&shape.corners), random.between(0.2, 0.8));
            shape.receiver = near(a.lerp(b, t), close, random);
        }
        "near_vertex" => {
            let [a, _] = first_edge(&shape.corners);
            shape.receiver = near(a, close, random);
        }
        "tiny" => shape.corners = scaled(&shape.corners, random.decades(-5.0, -1.5)),
        "huge" => {
            let round = random.unit() < 0.5;
            if round {
                shape.corners = regular(random.whole(3, 8));
            }
            shape.corners = scaled(&shape.corners, random.decades(0.0, 4.0));
            shape.receiver = DVec3::new(
                random.between(-0.05, 0.05),
                random.between(-0.05, 0.05),
                random.between(0.01, 1.0),
            );
        }
        "sliver" => {
            let thickness = random.decades(-6.0, -1.0);
            shape.corners = shape
                .corners
                .iter()
                .map(|&[x, y]| [x, y * thickness])
                .collect();
        }
        "collinear" => shape.corners = with_more_vertices(&shape.corners, random),
        "offset" => shape.offset = random.direction() * random.decades(2.0, 6.0),
        "scale" => shape.size = random.decades(-6.0, 6.0),
        "nonconvex" => shape.corners = nonconvex(random),
        "backface" => shape.receiver.z = -shape.receiver.z,
        _ => {}
    }
    let lean = random.direction();
    let to_middle = -shape.receiver.normalize_or(DVec3::Z);
    shape.normal = if class == "grazing" {
        // A normal across the direction to the emitter, leant a little to it.
        let across = to_middle.any_orthonormal_vector();
        let round = across * lean.x + to_middle.cross(across) * lean.y;
        round.try_normalize().unwrap_or(across) + to_middle * close
    } else if class == "tiny" || random.unit() < 0.5 {
        to_middle + lean * if class == "huge" { 0.1 } else { 0.95 }
    } else {
        lean
    };
    shape
}

fn first_edge(corners: &[[f64; 2]]) -> [DVec3; 2] {
    [corners[0], corners[1]].map(|[x, y]| DVec3::new(x, y, 0.0))
}

/// A place so far from another, in front of the emitter.
fn near(place: DVec3, distance: f64, random: &mut Random) -> DVec3 {
    let mut away = random.direction();
    away.z = away.z.abs() + 0.1;
    place + away * distance
}

fn regular(count: usize) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / count as f64;
        [angle.cos(), angle.sin()]
    };
    (0..count).map(corner).collect()
}

fn scaled(corners: &[[f64; 2]], by: f64) -> Vec<[f64; 2]> {
    corners
        .iter()
        .map(|corner| corner.map(|x| x * by))
        .collect()
}

/// 3 to 8 corners on an ellipse.
fn convex(random: &mut Random) -> Vec<[f64; 2]> {
    let count = random.whole(3, 8);
    let (a, b) = (random.between(0.2, 1.0), random.between(0.2, 1.0));
    let corner = |k: usize, jitter: f64| {
        let angle = std::f64::consts::TAU * (k as f64 + jitter) / count as f64;
        [a * angle.cos(), b * angle.sin()]
    };
    (0..count)
        .map(|k| corner(k, random.between(0.0, 0.7)))
        .collect()
}

/// The same polygon with some vertices repeated and others put inside of
/// edges.
fn with_more_vertices(corners: &[[f64; 2]], random: &mut Random) -> Vec<[f64; 2]> {
    let mut more = Vec::new();
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        more.push(a);
        if random.unit() < 0.3 {
            more.push(a);
        }
        if random.unit() < 0.4 {
            let t = random.unit();
            more.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    more
}

/// An L or a star of 5 to 8 points.
fn nonconvex(random: &mut Random) -> Vec<[f64; 2]> {
    let t = random.between(0.2, 0.8);
    if random.unit() < 0.5 {
        let l = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, t],
            [t, t],
            [t, 1.0],
            [0.0, 1.0],
        ];
        return l.map(|[x, y]| [x - 0.5, y - 0.5]).to_vec();
    }
    let corners = regular(2 * random.whole(5, 8));
    let pulled =
        |(k, corner): (usize, &[f64; 2])| corner.map(|x| if k % 2 == 0 { x } else { x * t });
    corners.iter().enumerate().map(pulled).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_is_full_and_what_it_says() {
        for class in CLASSES {
            let cases = cases(class);
            assert_eq!(cases.len(), CASES, "{class}");
            let (low, high) = cases.iter().fold((1.0_f64, 0.0_f64), |(low, high), case| {
                (low.min(case.exact), high.max(case.exact))
            });
            match class {
                "backface" => assert_eq!(high, 0.0),
                "huge" => assert!(high > 0.999, "{low} {high}"),
                "tiny" => assert!(low < 1e-10 && high < 1e-3, "{low} {high}"),
                _ => assert!(low > 0.0 && high < 1.0, "{class} {low} {high}"),
            }
        }
        assert!(cases("no such class").is_empty());
    }
}
