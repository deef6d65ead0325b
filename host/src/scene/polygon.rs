//! Planar polygons: normal and area, and whether they are fit to be surfaces.

use core::fmt;

use glam::{DVec2, DVec3};

/// Most vertices of a polygon: the checks for crossing edges cost their square.
pub const MAX_VERTICES: usize = 256;

/// Farthest a vertex may lie from the polygon's plane, as a part of the
/// polygon's diameter.
pub const PLANARITY: f64 = 1e-4;

/// Smallest diameter of a polygon in metres: below it the products of six
/// lengths that the kernel forms fall under the normal numbers of f32.
pub const MIN_DIAMETER: f64 = 1e-6;

/// Places nearer to each other than this part of the largest coordinate are
/// one place to the device: the spacing of f32 numbers, 2⁻²³.
const RESOLUTION: f64 = f32::EPSILON as f64;

/// What a sound polygon measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Unit normal of the side from which the vertices run counter-clockwise.
    pub normal: DVec3,
    /// Area in m².
    pub area: f64,
}

/// Why a polygon cannot be a surface. Vertices and edges count from 0; edge i
/// runs from vertex i to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flaw {
    /// Fewer than three vertices.
    TooFew(usize),
    /// More than [`MAX_VERTICES`].
    TooMany(usize),
    /// Smaller than [`MIN_DIAMETER`]: its diameter in metres.
    TooSmall(f64),
    /// This vertex and the next are one place to the device.
    Repeated(usize),
    /// The vertices lie on a line.
    NoArea,
    /// A vertex lies this many metres off the plane: which one, where one is
    /// clearly farther off than the others.
    NotPlanar(Option<usize>, f64),
    /// These two edges cross.
    Crossing(usize, usize),
    /// These two edges touch although they are not neighbours.
    Touching(usize, usize),
    /// The edges before and after this vertex lie on each other.
    Spike(usize),
}

impl Flaw {
    /// The vertex at which the flaw is best shown.
    pub fn vertex(&self) -> Option<usize> {
        match *self {
            Self::Repeated(vertex) | Self::Spike(vertex) => Some(vertex),
            Self::NotPlanar(vertex, _) => vertex,
            Self::Crossing(_, edge) | Self::Touching(_, edge) => Some(edge),
            _ => None,
        }
    }

    /// What to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::TooFew(_) => "give at least three vertices [x, y, z]",
            Self::TooMany(_) => "split the surface into several",
            Self::TooSmall(_) => "lengths are metres: scale the scene, or leave the surface out",
            Self::Repeated(_) => {
                "leave one of the two out; the last vertex joins the first by itself"
            }
            Self::NoArea => "move a vertex off the line through the others",
            Self::NotPlanar(..) => "correct the vertex, or split the surface into triangles",
            Self::Crossing(..) => {
                "list the vertices in order around the polygon, counter-clockwise seen from its front"
            }
            Self::Touching(..) => "split the surface where it touches itself",
            Self::Spike(_) => "leave the vertex at the tip out",
        }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooFew(count) => {
                write!(
                    formatter,
                    "a polygon needs at least 3 vertices, not {count}"
                )
            }
            Self::TooMany(count) => write!(
                formatter,
                "a polygon may have at most {MAX_VERTICES} vertices, not {count}"
            ),
            Self::TooSmall(diameter) => write!(
                formatter,
                "the polygon is only {diameter:.3e} m across, less than {MIN_DIAMETER:e} m"
            ),
            Self::Repeated(vertex) => write!(
                formatter,
                "vertex {} and the next are the same place to the device",
                vertex + 1
            ),
            Self::NoArea => write!(formatter, "the polygon has zero area"),
            Self::NotPlanar(vertex, distance) => {
                let which = vertex.map_or("a vertex".to_owned(), |v| format!("vertex {}", v + 1));
                write!(
                    formatter,
                    "the polygon is not planar: {which} lies {distance:.3e} m off its plane, more than {PLANARITY:e} of its diameter"
                )
            }
            Self::Crossing(a, b) => write!(
                formatter,
                "the polygon crosses itself: the edge after vertex {} crosses the edge after vertex {}",
                b + 1,
                a + 1
            ),
            Self::Touching(a, b) => write!(
                formatter,
                "the polygon touches itself: the edge after vertex {} touches the edge after vertex {}",
                b + 1,
                a + 1
            ),
            Self::Spike(vertex) => write!(
                formatter,
                "the polygon folds back on itself at vertex {}",
                vertex + 1
            ),
        }
    }
}

/// Twice the area times the unit normal (Newell): the sum of the cross
/// products of consecutive vertices, taken relative to the first.
pub fn doubled_area_vector(vertices: &[DVec3]) -> DVec3 {
    let Some((&origin, rest)) = vertices.split_first() else {
        return DVec3::ZERO;
    };
    rest.windows(2)
        .map(|pair| (pair[0] - origin).cross(pair[1] - origin))
        .sum()
}

/// The mean of the vertices.
pub fn center(vertices: &[DVec3]) -> DVec3 {
    // Relative to the first vertex, so that a far origin costs no digits.
    let origin = vertices.first().copied().unwrap_or(DVec3::ZERO);
    let sum: DVec3 = vertices.iter().map(|&vertex| vertex - origin).sum();
    origin + sum / vertices.len().max(1) as f64
}

/// The largest distance between two vertices in metres.
pub fn diameter(vertices: &[DVec3]) -> f64 {
    let mut largest = 0.0_f64;
    for (i, a) in vertices.iter().enumerate() {
        for b in &vertices[i + 1..] {
            largest = largest.max(a.distance_squared(*b));
        }
    }
    largest.sqrt()
}

/// Normal and area of a sound polygon, or the first flaw found.
///
/// Sound is every simple polygon, concave ones too: planar within
/// [`PLANARITY`], no two of its edges crossing or touching except neighbours
/// at their common vertex. Distances that the device's single precision
/// cannot resolve count as zero. Coordinates must be finite. Costs the square
/// of the number of vertices.
pub fn measure(vertices: &[DVec3]) -> Result<Measured, Flaw> {
    let count = vertices.len();
    if count < 3 {
        return Err(Flaw::TooFew(count));
    }
    if count > MAX_VERTICES {
        return Err(Flaw::TooMany(count));
    }
    let diameter = diameter(vertices);
    if diameter < MIN_DIAMETER {
        return Err(Flaw::TooSmall(diameter));
    }
    let largest = vertices
        .iter()
        .fold(0.0_f64, |largest, v| largest.max(v.abs().max_element()));
    let touch = RESOLUTION * largest;
    for i in 0..count {
        if vertices[i].distance(vertices[(i + 1) % count]) <= touch {
            return Err(Flaw::Repeated(i));
        }
    }
    let normal = plane_normal(vertices, touch, diameter).ok_or(Flaw::NoArea)?;
    check_planar(vertices, normal, diameter)?;
    check_simple(vertices, normal, touch)?;
    let doubled = doubled_area_vector(vertices).length();
    if doubled <= 2.0 * touch * diameter {
        return Err(Flaw::NoArea);
    }
    Ok(Measured {
        normal,
        area: 0.5 * doubled,
    })
}

/// The normal by Newell's sum; where that vanishes although the vertices span
/// a plane (the loops of an 8 cancel), the normal of a large triangle.
fn plane_normal(vertices: &[DVec3], touch: f64, diameter: f64) -> Option<DVec3> {
    let newell = doubled_area_vector(vertices);
    if newell.length() > 2.0 * touch * diameter {
        // Division, not the reciprocal: an axis gives exactly 1.
        return Some(newell / newell.length());
    }
    let first = vertices[0];
    let far = farthest(vertices, |v| v.distance(first))?;
    let along = (far - first) / (far - first).length();
    let off_line = |v: DVec3| (v - first).cross(along).length();
    let apex = farthest(vertices, off_line)?;
    if off_line(apex) <= touch {
        return None;
    }
    let cross = along.cross(apex - first);
    Some(cross / cross.length())
}

fn farthest(vertices: &[DVec3], distance: impl Fn(DVec3) -> f64) -> Option<DVec3> {
    vertices
        .iter()
        .copied()
        .max_by(|&a, &b| distance(a).total_cmp(&distance(b)))
}

fn check_planar(vertices: &[DVec3], normal: DVec3, diameter: f64) -> Result<(), Flaw> {
    let center = center(vertices);
    let mut off_plane: Vec<(f64, usize)> = vertices
        .iter()
        .enumerate()
        .map(|(index, &vertex)| ((vertex - center).dot(normal).abs(), index))
        .collect();
    off_plane.sort_by(|a, b| b.0.total_cmp(&a.0));
    let [(distance, worst), (second, _), ..] = off_plane[..] else {
        return Ok(());
    };
    if distance <= PLANARITY * diameter {
        return Ok(());
    }
    // All four corners of a twisted quadrilateral are equally far off.
    let clear = distance > 1.01 * second;
    Err(Flaw::NotPlanar(clear.then_some(worst), distance))
}

fn check_simple(vertices: &[DVec3], normal: DVec3, touch: f64) -> Result<(), Flaw> {
    let count = vertices.len();
    let (u, v) = normal.any_orthonormal_pair();
    let flat: Vec<DVec2> = vertices
        .iter()
        .map(|&vertex| vertex - vertices[0])
        .map(|vertex| DVec2::new(vertex.dot(u), vertex.dot(v)))
        .collect();
    let edge = |i: usize| (flat[i], flat[(i + 1) % count]);
    for i in 0..count {
        let (start, tip) = edge(i);
        let (_, end) = edge((i + 1) % count);
        let back = point_to_segment(end, start, tip) <= touch
            || point_to_segment(start, tip, end) <= touch;
        if back {
            return Err(Flaw::Spike((i + 1) % count));
        }
    }
    for i in 0..count {
        for j in i + 2..count {
            if i == 0 && j == count - 1 {
                continue; // neighbours around the end of the list
            }
            let ((a, b), (c, d)) = (edge(i), edge(j));
            if cross(a, b, c, d) {
                return Err(Flaw::Crossing(i, j));
            }
            let nearest = point_to_segment(a, c, d)
                .min(point_to_segment(b, c, d))
                .min(point_to_segment(c, a, b))
                .min(point_to_segment(d, a, b));
            if nearest <= touch {
                return Err(Flaw::Touching(i, j));
            }
        }
    }
    Ok(())
}

/// Whether the interiors of the segments a b and c d cross.
fn cross(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Distance from `point` to the segment from `a` to `b`.
pub(crate) fn point_to_segment(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let length_squared = along.length_squared();
    if length_squared == 0.0 {
        return point.distance(a);
    }
    let t = ((point - a).dot(along) / length_squared).clamp(0.0, 1.0);
    point.distance(a + along * t)
}
