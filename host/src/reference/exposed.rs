//! Surfaces in convex parts whose borders follow whatever stands on them.

use glam::DVec3;

use super::Error;
use super::convex::{self, Loop};
use super::partition;
use crate::scene::{PLANE_TOLERANCE, Scene, Surface};

/// A reflecting surface in parts.
pub(super) struct Exposed {
    /// Index of the surface in the scene.
    pub(super) surface: usize,
    /// Perpendicular unit directions on its plane, the first along its longest edge.
    pub(super) axes: [DVec3; 2],
    /// Convex parts.
    pub(super) parts: Vec<Loop>,
}

/// The reflecting surfaces of a scene. They are split along the edges of other
/// surfaces that lie on them (light and shadow jump there: the foot of a
/// block, the rim of a panel), and left out below a smaller surface that lies
/// on them facing the same way. What a body covers needs no such care: its
/// faces hide it.
pub(super) fn exposed(scene: &Scene) -> Result<Vec<Exposed>, Error> {
    let tolerance = PLANE_TOLERANCE * scene.largest_coordinate();
    let reflecting = (0..scene.surfaces.len()).filter(|index| scene.surfaces[*index].reflects());
    reflecting
        .map(|index| {
            let surface = &scene.surfaces[index];
            let axes = axes(surface);
            let pieces = partition::convex_pieces(&surface.vertices, surface.normal);
            let pieces = pieces.ok_or_else(|| Error::Outline {
                surface: surface.name.clone(),
            })?;
            let mut parts: Vec<Loop> = pieces.into_iter().map(Loop::from_vec).collect();
            for (other, neighbour) in scene.surfaces.iter().enumerate() {
                if other != index {
                    split(&mut parts, surface, neighbour, tolerance);
                }
            }
            let covers = |other: usize| covers(scene, other, index, tolerance);
            let above: Vec<usize> = (0..scene.surfaces.len()).filter(|o| covers(*o)).collect();
            parts.retain(|part| {
                let (centre, _) = convex::ball(part);
                let inside = |other: &usize| contains(&scene.surfaces[*other], centre);
                !above.iter().any(inside)
            });
            Ok(Exposed {
                surface: index,
                axes,
                parts,
            })
        })
        .collect()
}

fn axes(surface: &Surface) -> [DVec3; 2] {
    let count = surface.vertices.len();
    let edge = |index: usize| surface.vertices[(index + 1) % count] - surface.vertices[index];
    let longest =
        (0..count).map(edge).fold(
            DVec3::ZERO,
            |a, b| if b.length() > a.length() { b } else { a },
        );
    let first = longest.normalize_or_zero();
    [first, surface.normal.cross(first)]
}

/// Whether `other` lies on `index`, faces the same way and is the smaller of
/// the two (of two alike the later one counts as smaller).
fn covers(scene: &Scene, other: usize, index: usize, tolerance: f64) -> bool {
    let (above, below) = (&scene.surfaces[other], &scene.surfaces[index]);
    let smaller = match above.area.total_cmp(&below.area) {
        std::cmp::Ordering::Equal => other > index,
        order => order.is_lt(),
    };
    let on = |vertex: &DVec3| height(below, *vertex).abs() <= tolerance;
    smaller && above.normal.dot(below.normal) > 0.0 && above.vertices.iter().all(on)
}

fn height(surface: &Surface, place: DVec3) -> f64 {
    surface.normal.dot(place - surface.vertices[0])
}

/// Whether a place on a surface's plane lies inside its outline.
fn contains(surface: &Surface, place: DVec3) -> bool {
    let (u, v) = surface.normal.any_orthonormal_pair();
    let count = surface.vertices.len();
    let flat = |index: usize| {
        let offset = surface.vertices[index % count] - place;
        (offset.dot(u), offset.dot(v))
    };
    let crossings = (0..count).filter(|&index| {
        let ((ax, ay), (bx, by)) = (flat(index), flat(index + 1));
        (ay > 0.0) != (by > 0.0) && ax + (bx - ax) * ay / (ay - by) > 0.0
    });
    crossings.count() % 2 == 1
}

/// Splits the parts of a surface along those edges of a neighbour that lie on
/// its plane and pass through the inside of a part.
fn split(parts: &mut Vec<Loop>, surface: &Surface, neighbour: &Surface, tolerance: f64) {
    let count = neighbour.vertices.len();
    for index in 0..count {
        let ends = [index, (index + 1) % count].map(|i| neighbour.vertices[i]);
        if ends
            .iter()
            .any(|end| height(surface, *end).abs() > tolerance)
        {
            continue;
        }
        let across = surface.normal.cross(ends[1] - ends[0]).normalize_or_zero();
        let mut split = Vec::with_capacity(parts.len() + 1);
        for part in parts.drain(..) {
            let (inside, outside) = convex::cut(&part, across, across.dot(ends[0]), tolerance);
            let divides =
                inside.len() >= 3 && outside.len() >= 3 && meets(&part, ends, surface, tolerance);
            if divides {
                split.push(inside);
                split.push(outside);
            } else {
                split.push(part);
            }
        }
        *parts = split;
    }
}

/// Whether some of the segment lies inside the convex part.
fn meets(part: &Loop, ends: [DVec3; 2], surface: &Surface, tolerance: f64) -> bool {
    let (mut from, mut to) = (0.0, 1.0);
    for index in 0..part.len() {
        let (a, b) = (part[index], part[(index + 1) % part.len()]);
        let inward = surface.normal.cross(b - a).normalize_or_zero();
        let [start, end] = ends.map(|end| inward.dot(end - a) - tolerance);
        if start <= 0.0 && end <= 0.0 {
            return false;
        }
        if start < 0.0 {
            from = f64::max(from, start / (start - end));
        } else if end < 0.0 {
            to = f64::min(to, start / (start - end));
        }
    }
    from < to
}
