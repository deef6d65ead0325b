//! What of a polygon a point can see.
//!
//! From a point, a convex occluder hides what lies in the pyramid over it and
//! beyond its plane. The visible part of a convex polygon is what is left of
//! it after all these truncated pyramids are cut away: a list of convex
//! fragments, exact for any number of occluders. All coordinates here are
//! relative to the point, so that every plane of a pyramid passes through the
//! origin.

use glam::DVec3;
use smallvec::SmallVec;

use super::Error;
use super::convex::{self, Loop};
use super::partition;
use super::patch::Receiver;
use crate::scene::{PLANE_TOLERANCE, Scene};

/// Rounding of a distance, as a share of the scene's largest coordinate.
const ROUNDING: f64 = 1e-14;

/// Everything that can come between, as convex polygons.
pub(super) struct Occluders {
    parts: Vec<Occluder>,
    /// A point closer to a plane than this lies on it.
    tolerance: f64,
    /// A distance below this is rounding.
    rounding: f64,
}

struct Occluder {
    vertices: Vec<DVec3>,
    normal: DVec3,
}

/// Numbers of shadows that matter to a polygon.
pub(super) type Blockers = SmallVec<[u32; 12]>;

/// The world as one receiver sees it.
pub(super) struct Sight {
    /// The receiver.
    pub(super) receiver: Receiver,
    shadows: Vec<Shadow>,
    tolerance: f64,
    rounding: f64,
}

/// What one occluder hides from the receiver.
struct Shadow {
    /// Inward unit normals of the pyramid's sides.
    sides: SmallVec<[DVec3; 4]>,
    /// Unit normal of the occluder's plane, away from the receiver.
    away: DVec3,
    /// Distance of that plane.
    distance: f64,
    /// The occluder's vertices.
    vertices: Loop,
}

/// How a shadow lies on a polygon.
#[derive(PartialEq)]
enum Cover {
    None,
    Part,
    Whole,
}

impl Occluders {
    /// Every surface of the scene; concave ones in convex parts.
    pub(super) fn new(scene: &Scene) -> Result<Self, Error> {
        let mut parts = Vec::new();
        for surface in &scene.surfaces {
            let pieces = partition::convex_pieces(&surface.vertices, surface.normal);
            let pieces = pieces.ok_or_else(|| Error::Outline {
                surface: surface.name.clone(),
            })?;
            parts.extend(pieces.into_iter().map(|vertices| Occluder {
                vertices,
                normal: surface.normal,
            }));
        }
        let scale = scene.largest_coordinate();
        Ok(Self {
            parts,
            tolerance: PLANE_TOLERANCE * scale,
            rounding: ROUNDING * scale,
        })
    }

    /// What `receiver` has before it. An occluder on whose plane it lies
    /// hides nothing from it.
    pub(super) fn seen_from(&self, receiver: Receiver) -> Sight {
        let shadows = self
            .parts
            .iter()
            .filter_map(|part| self.shadow(part, &receiver));
        Sight {
            receiver,
            shadows: shadows.collect(),
            tolerance: self.tolerance,
            rounding: self.rounding,
        }
    }

    fn shadow(&self, part: &Occluder, receiver: &Receiver) -> Option<Shadow> {
        let height = part.normal.dot(part.vertices[0] - receiver.position);
        if height.abs() <= self.tolerance {
            return None;
        }
        let vertices: Loop = part
            .vertices
            .iter()
            .map(|vertex| *vertex - receiver.position)
            .collect();
        let horizon = receiver.normal;
        if vertices.iter().all(|vertex| horizon.dot(*vertex) <= 0.0) {
            return None;
        }
        // Counter-clockwise as the receiver sees it where it is in front (the
        // plane then lies in the direction -normal), else clockwise.
        let turn = if height < 0.0 { -1.0 } else { 1.0 };
        let sides = (0..vertices.len()).map(|index| {
            let (a, b) = (vertices[index], vertices[(index + 1) % vertices.len()]);
            let near = if a.length_squared() < b.length_squared() {
                a
            } else {
                b
            };
            (near.cross(b - a) * turn).normalize_or_zero()
        });
        Some(Shadow {
            sides: sides.collect(),
            away: part.normal * turn,
            distance: height.abs(),
            vertices,
        })
    }
}

impl Sight {
    /// A polygon relative to the receiver.
    pub(super) fn relative(&self, polygon: &[DVec3]) -> Loop {
        let origin = self.receiver.position;
        polygon.iter().map(|vertex| *vertex - origin).collect()
    }

    /// The part of a relative polygon above the receiver's horizon.
    pub(super) fn above(&self, polygon: &[DVec3]) -> Loop {
        convex::cut(polygon, self.receiver.normal, 0.0, self.rounding).0
    }

    /// All shadows.
    pub(super) fn everything(&self) -> Blockers {
        (0..self.shadows.len() as u32).collect()
    }

    /// Which of `among` hide something of a relative convex polygon with unit
    /// normal `normal` that faces the receiver; `None` where one of them hides
    /// all of it.
    pub(super) fn blockers(
        &self,
        among: &[u32],
        polygon: &[DVec3],
        normal: DVec3,
    ) -> Option<Blockers> {
        let mut found = Blockers::new();
        for &index in among {
            match self.cover(&self.shadows[index as usize], polygon, normal) {
                Cover::None => {}
                Cover::Part => found.push(index),
                Cover::Whole => return None,
            }
        }
        Some(found)
    }

    fn cover(&self, shadow: &Shadow, polygon: &[DVec3], normal: DVec3) -> Cover {
        let beyond = |vertex: &DVec3| shadow.away.dot(*vertex) - shadow.distance;
        if polygon.iter().all(|v| beyond(v) <= self.tolerance) {
            return Cover::None;
        }
        let mut whole = polygon.iter().all(|v| beyond(v) >= -self.tolerance);
        for side in &shadow.sides {
            let (low, high) = convex::extent(polygon, *side);
            if high <= self.rounding {
                return Cover::None;
            }
            whole &= low >= -self.rounding;
        }
        let plane = normal.dot(polygon[0]) + self.tolerance;
        if shadow.vertices.iter().all(|v| normal.dot(*v) <= plane) {
            return Cover::None;
        }
        if whole {
            return Cover::Whole;
        }
        let apart = (0..polygon.len()).any(|index| {
            let (a, b) = (polygon[index], polygon[(index + 1) % polygon.len()]);
            // Counter-clockwise about a normal that faces the receiver: inward.
            let side = b.cross(a);
            let rounding = self.rounding * side.length();
            shadow.vertices.iter().all(|v| side.dot(*v) <= rounding)
        });
        if apart { Cover::None } else { Cover::Part }
    }

    /// The fragments of a relative polygon that none of `among` hides.
    pub(super) fn fragments(&self, polygon: Loop, among: &[u32]) -> Vec<Loop> {
        let mut pieces = vec![polygon];
        for &index in among {
            let shadow = &self.shadows[index as usize];
            let mut left = Vec::with_capacity(pieces.len() + 2);
            for piece in pieces {
                self.cut_away(shadow, piece, &mut left);
            }
            pieces = left;
        }
        pieces
    }

    /// Adds to `left` what the shadow leaves of the piece, which stays whole
    /// where the shadow misses it.
    fn cut_away(&self, shadow: &Shadow, piece: Loop, left: &mut Vec<Loop>) {
        let start = left.len();
        let (mut rest, before) = convex::cut(&piece, shadow.away, shadow.distance, self.tolerance);
        if !before.is_empty() && !rest.is_empty() {
            left.push(before);
        }
        for side in &shadow.sides {
            if rest.len() < 3 {
                break;
            }
            let (inside, outside) = convex::cut(&rest, *side, 0.0, self.rounding);
            if outside.len() >= 3 {
                left.push(outside);
            }
            rest = inside;
        }
        if rest.len() < 3 {
            left.truncate(start);
            left.push(piece);
        }
    }
}
