//! A receiver, a luminaire and what is between, in the receiver's coordinates.
//!
//! Everything is (u, v, h): u and v those of the receiver's frame, h the height
//! over its plane. A height within the scene's plane tolerance is 0 exactly, so
//! that what stands on the receiver touches it.

use glam::DVec3;

use crate::occlusion::{Occlusion, Shape, TooLarge, faces_of};
use crate::scene::Scene;
use crate::scene::frame::Frame;

/// What is between, and the luminaire.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub(super) light: Light,
    pub(super) occluders: Vec<Occluder>,
    /// A length that counts as nothing: 1e-9 of the extent of it all.
    pub(super) nothing: f64,
    /// A length that counts as far away: 1e4 times the extent.
    pub(super) far: f64,
}

/// The part of the luminaire above the receiver's plane.
#[derive(Clone, Debug)]
pub(super) struct Light {
    /// The vertices of that part, in order.
    pub(super) points: Vec<DVec3>,
    /// Vertices strictly above the receiver's plane.
    pub(super) apexes: Vec<DVec3>,
    /// Its edges, without those in the receiver's plane.
    pub(super) edges: Vec<[DVec3; 2]>,
    /// Unit normal of its front.
    pub(super) normal: DVec3,
    /// normal · x = offset on its plane.
    pub(super) offset: f64,
}

/// The part of a convex occluder above the receiver's plane and in front of
/// the luminaire's.
#[derive(Clone, Debug)]
pub(super) struct Occluder {
    /// Which occluder of the scene, in the order of [`Occlusion`].
    pub(super) index: usize,
    /// The faces' parts.
    pub(super) faces: Vec<Vec<DVec3>>,
    /// All vertices, each once.
    pub(super) points: Vec<DVec3>,
    /// Vertices of the occluder itself that are strictly between.
    pub(super) apexes: Vec<DVec3>,
    /// Parts of its edges, without those in one of the two planes.
    pub(super) edges: Vec<[DVec3; 2]>,
}

impl Light {
    /// Height of a place over the luminaire's plane.
    pub(super) fn height(&self, place: DVec3) -> f64 {
        self.normal.dot(place) - self.offset
    }
}

impl Setting {
    pub(super) fn new(scene: &Scene, frame: &Frame, luminaire: usize) -> Result<Self, TooLarge> {
        let flat = scene.plane_tolerance();
        let surface = &scene.surfaces[luminaire];
        let vertices: Vec<DVec3> = surface
            .vertices
            .iter()
            .map(|&vertex| local(frame, flat, vertex))
            .collect();
        let turned = |v: DVec3| DVec3::new(v.dot(frame.u), v.dot(frame.v), v.dot(frame.normal));
        let centre = turned(surface.center() - frame.origin);
        let light = light(&vertices, turned(surface.normal), centre);
        let shapes = local_shapes(scene, frame)?;
        let occluders = shapes
            .iter()
            .enumerate()
            .filter_map(|(index, shape)| between(shape, &light, flat, index));
        let extent = scene.largest_coordinate() * 2.0;
        Ok(Self {
            occluders: occluders.collect(),
            light,
            nothing: 1e-9 * extent,
            far: 1e4 * extent,
        })
    }
}

/// A place in the receiver's coordinates.
fn local(frame: &Frame, flat: f64, place: DVec3) -> DVec3 {
    let (u, v) = frame.to_local(place);
    let height = (place - frame.origin).dot(frame.normal);
    DVec3::new(u, v, if height.abs() <= flat { 0.0 } else { height })
}

/// All occluders of a scene in the receiver's coordinates. Of their faces the
/// edges alone are true to these.
pub(super) fn local_shapes(scene: &Scene, frame: &Frame) -> Result<Vec<Shape>, TooLarge> {
    let flat = scene.plane_tolerance();
    let mut shapes = Occlusion::of(scene)?.shapes().to_vec();
    for vertex in shapes.iter_mut().flat_map(|shape| &mut shape.vertices) {
        *vertex = local(frame, flat, *vertex);
    }
    Ok(shapes)
}

fn light(vertices: &[DVec3], normal: DVec3, centre: DVec3) -> Light {
    let upward = |v: &DVec3| v.z;
    let points = clipped(vertices, upward);
    let sides = (0..vertices.len()).map(|i| [vertices[i], vertices[(i + 1) % vertices.len()]]);
    Light {
        apexes: points.iter().copied().filter(|v| v.z > 0.0).collect(),
        edges: sides
            .filter_map(|side| clipped_edge(side, upward))
            .filter(|ends| ends.iter().any(|end| end.z > 0.0))
            .collect(),
        points,
        normal,
        offset: normal.dot(centre),
    }
}

/// The places at which a shape that reaches above the receiver's plane meets
/// it: their hull is its foot.
pub(super) fn touch(shape: &Shape) -> Vec<[f64; 2]> {
    if shape.vertices.iter().all(|vertex| vertex.z <= 0.0) {
        return Vec::new();
    }
    let on_plane = |face: Shape| clipped(&face.vertices, |v| v.z).into_iter();
    faces_of(shape)
        .into_iter()
        .flat_map(on_plane)
        .filter(|place| place.z == 0.0)
        .map(|place| place.truncate().into())
        .collect()
}

/// The part of a shape that can hide light from the receiver.
fn between(shape: &Shape, light: &Light, flat: f64, index: usize) -> Option<Occluder> {
    let in_front = |v: &DVec3| {
        let height = light.height(*v);
        if height.abs() <= flat { 0.0 } else { height }
    };
    let upward = |v: &DVec3| v.z;
    let faces: Vec<Vec<DVec3>> = faces_of(shape)
        .iter()
        .map(|face| clipped(&clipped(&face.vertices, upward), in_front))
        .filter(|face| face.len() >= 3)
        .collect();
    let mut points: Vec<DVec3> = Vec::new();
    for &point in faces.iter().flatten() {
        if points.iter().all(|p| p.distance(point) > 1e-3 * flat) {
            points.push(point);
        }
    }
    let matters = points.iter().any(|p| p.z > 0.0) && points.iter().any(|p| in_front(p) > 0.0);
    if !matters {
        return None;
    }
    let off = |ends: &[DVec3; 2]| {
        ends.iter().any(|end| end.z > 0.0) && ends.iter().any(|end| in_front(end) > 0.0)
    };
    let edges = shape
        .edges
        .iter()
        .map(|edge| edge.ends.map(|end| shape.vertices[end]))
        .filter_map(|ends| clipped_edge(ends, upward))
        .filter_map(|ends| clipped_edge(ends, in_front))
        .filter(off);
    let strictly = |v: &&DVec3| v.z > 0.0 && in_front(v) > 0.0;
    let apexes = shape.vertices.iter().filter(strictly);
    Some(Occluder {
        index,
        faces,
        points,
        apexes: apexes.copied().collect(),
        edges: edges.collect(),
    })
}

/// The part of a polygon where a linear height is not negative; it must be
/// exactly 0 where a vertex counts as on the plane. Of a polygon that is not
/// convex the parts hang together along the plane.
fn clipped(polygon: &[DVec3], height: impl Fn(&DVec3) -> f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let (a, b) = (height(&from), height(&to));
        if a >= 0.0 {
            kept.push(from);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            kept.push(crossing([from, to], [a, b]));
        }
    }
    kept
}

/// The same of an edge; `None` where less than a length is left.
fn clipped_edge([from, to]: [DVec3; 2], height: impl Fn(&DVec3) -> f64) -> Option<[DVec3; 2]> {
    let heights = [height(&from), height(&to)];
    let cut = || crossing([from, to], heights);
    match heights.map(|h| h > 0.0) {
        [true, true] => Some([from, to]),
        [true, false] if heights[1] < 0.0 => Some([from, cut()]),
        [false, true] if heights[0] < 0.0 => Some([cut(), to]),
        [false, false] if heights != [0.0; 2] => None,
        _ => Some([from, to]),
    }
}

/// Where an edge crosses a plane, from the end in front of it, so that all
/// that share the edge share the crossing. On the receiver's plane the height
/// is 0 exactly.
fn crossing(ends: [DVec3; 2], heights: [f64; 2]) -> DVec3 {
    let (front, behind) = if heights[0] > 0.0 { (0, 1) } else { (1, 0) };
    let t = heights[front] / (heights[front] - heights[behind]);
    let mut place = ends[front] + (ends[behind] - ends[front]) * t;
    if heights[front] == ends[front].z && heights[behind] == ends[behind].z {
        place.z = 0.0;
    }
    place
}
