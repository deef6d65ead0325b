//! A surface that receives: its outline, what covers it, what stands on it.

use glam::{DVec2, DVec3};

use super::setting::{local_shapes, touch};
use super::{Error, Kind, Line};
use crate::plan::patches::shapes::{Ring, hull, signed_area};
use crate::scene::frame::Frame;
use crate::scene::polygon::point_to_segment;
use crate::scene::{Scene, Surface};

/// Lengths below this part of the surface's longer side are nothing.
const RESOLUTION: f64 = 1e-6;

/// How near to the foot of something a place is at it, as a part of the surface's size, the
/// root of the area of its outline.
const AT_FOOT: f64 = 0.05;

/// A receiving surface in its own coordinates.
#[derive(Clone, Debug)]
pub struct Floor {
    /// The coordinates.
    pub frame: Frame,
    /// What covers parts of it so that these carry no light, counter-clockwise:
    /// the feet of bodies that stand on it or pass through it, polygons back to
    /// back with it, luminaires set into it.
    pub covers: Vec<Ring>,
    /// Lines within it on which something touches it, the outlines of the
    /// covers among them: light jumps there, or a body stands in the way.
    pub contacts: Vec<Line>,
    outline: Ring,
}

impl Floor {
    /// Surface `receiver` of a scene.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where there are too many vertices.
    pub fn of(scene: &Scene, receiver: usize) -> Result<Self, Error> {
        let frame = Frame::new(&scene.surfaces[receiver]);
        let mut floor = Self {
            covers: flush(scene, receiver, &frame),
            contacts: Vec::new(),
            outline: frame.vertices.iter().map(|&(u, v)| [u, v]).collect(),
            frame,
        };
        let mut outlines = floor.covers.clone();
        let shapes = local_shapes(scene, &floor.frame).map_err(Error::TooLarge)?;
        for shape in &shapes {
            let foot = hull(touch(shape));
            let is_cover = !shape.is_polygon() && signed_area(&foot) > floor.resolution().powi(2);
            outlines.push(foot.clone());
            if is_cover {
                floor.covers.push(foot);
            }
        }
        floor.contacts = outlines
            .iter()
            .flat_map(|outline| floor.contacts_of(outline))
            .collect();
        Ok(floor)
    }

    /// The sides of a ring, or the one segment that it is, within the surface.
    fn contacts_of(&self, ring: &Ring) -> Vec<Line> {
        let sides = match ring.len() {
            0 | 1 => 0,
            2 => 1,
            corners => corners,
        };
        let ends = (0..sides).map(|i| [ring[i], ring[(i + 1) % ring.len()]].map(DVec2::from));
        let lines = ends.flat_map(|[a, b]| {
            let parts = self.within([a, b]).into_iter();
            parts.map(move |part| Line {
                kind: Kind::Contact,
                ends: part.map(|t| a.lerp(b, t).into()),
                strength: 0.0,
            })
        });
        lines.collect()
    }

    /// Whether a place is on the surface and nothing covers it.
    pub fn is_exposed(&self, place: DVec2) -> bool {
        encloses(&self.outline, place) && !self.covers.iter().any(|cover| encloses(cover, place))
    }

    /// Whether a place is near the line where something touches the surface: within a
    /// twentieth of the root of the surface's area.
    pub fn is_at_foot(&self, place: DVec2) -> bool {
        let near = AT_FOOT * signed_area(&self.outline).abs().sqrt();
        let distance = |line: &Line| {
            let [a, b] = line.ends.map(DVec2::from);
            point_to_segment(place, a, b)
        };
        self.contacts.iter().any(|line| distance(line) <= near)
    }

    /// The length below which places are one place.
    pub(super) fn resolution(&self) -> f64 {
        RESOLUTION * self.frame.size_u.max(self.frame.size_v)
    }

    /// The distance from a place to the outline or the nearest contact line.
    pub(super) fn clearance(&self, place: DVec2) -> f64 {
        let contacts = self.contacts.iter().map(|line| line.ends.map(DVec2::from));
        let all = self.sides().chain(contacts);
        all.map(|[a, b]| point_to_segment(place, a, b))
            .fold(f64::INFINITY, f64::min)
    }

    /// The sides of the outline.
    pub(super) fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> + '_ {
        let corners = &self.frame.vertices;
        let corner = |i: usize| DVec2::from(corners[i % corners.len()]);
        (0..corners.len()).map(move |i| [corner(i), corner(i + 1)])
    }

    /// The parts of a segment within the surface, as parameters from its first
    /// to its second end. What runs along the surface's outline is not within.
    pub(super) fn within(&self, [a, b]: [DVec2; 2]) -> Vec<[f64; 2]> {
        let mut cuts = vec![0.0, 1.0];
        for [from, to] in self.sides() {
            let (along, side) = (b - a, to - from);
            let turn = along.perp_dot(side);
            if turn != 0.0 {
                let t = (from - a).perp_dot(side) / turn;
                let s = (from - a).perp_dot(along) / turn;
                if (0.0..=1.0).contains(&t) && (-1e-9..=1.0 + 1e-9).contains(&s) {
                    cuts.push(t);
                }
            }
        }
        cuts.sort_by(f64::total_cmp);
        let inside = |part: &[f64; 2]| {
            let middle = a.lerp(b, (part[0] + part[1]) / 2.0);
            let apart = |[from, to]: [DVec2; 2]| {
                point_to_segment(middle, from, to) > self.resolution() / 2.0
            };
            self.frame.contains(middle.x, middle.y) && self.sides().all(apart)
        };
        let mut parts: Vec<[f64; 2]> = Vec::new();
        for pair in cuts.windows(2) {
            let part = [pair[0], pair[1]];
            if part[1] <= part[0] || !inside(&part) {
                continue;
            }
            match parts.last_mut() {
                Some(last) if last[1] == part[0] => last[1] = part[1],
                _ => parts.push(part),
            }
        }
        parts
    }
}

/// Polygons in the surface's plane that cover it: back to back with it, or
/// luminaires set into it.
fn flush(scene: &Scene, index: usize, frame: &Frame) -> Vec<Ring> {
    let flat = scene.plane_tolerance();
    let on_plane = |place: &DVec3| (*place - frame.origin).dot(frame.normal).abs() <= flat;
    let covers = |other: &Surface| {
        let back_to_back = other.normal.dot(frame.normal) < 0.0;
        (back_to_back || other.emits()) && other.vertices.iter().all(on_plane)
    };
    let others = scene.surfaces.iter().enumerate();
    others
        .filter(|&(other, surface)| other != index && covers(surface))
        .map(|(_, surface)| {
            let corners = surface.vertices.iter().map(|&v| frame.to_local(v).into());
            let mut ring: Ring = corners.collect();
            if signed_area(&ring) < 0.0 {
                ring.reverse();
            }
            ring
        })
        .collect()
}

/// Whether a simple polygon contains a place that is not on its outline.
fn encloses(ring: &[[f64; 2]], place: DVec2) -> bool {
    let crosses = |i: usize| {
        let offset = |k: usize| DVec2::from(ring[k % ring.len()]) - place;
        let (from, to) = (offset(i), offset(i + 1));
        let (low, high) = if from.y > to.y {
            (to, from)
        } else {
            (from, to)
        };
        (low.y > 0.0) != (high.y > 0.0) && low.perp_dot(high) > 0.0
    };
    (0..ring.len()).filter(|&i| crosses(i)).count() % 2 == 1
}
