//! What hides what: the occluders of a scene as the kernel reads them.
//!
//! Every surface occludes, luminaires as well. Surfaces that close become
//! bodies, with one silhouette instead of many faces; concave ones are split;
//! and every emitter gets a list of what can come between it and anything,
//! from the emitter outwards. All of it is decided in double precision and
//! rounded once; vertices that are one place to the device get the same bits.

mod bodies;
mod convex;
mod shape;
mod solids;

use std::collections::HashMap;
use std::fmt;

use glam::DVec3;
use isolux::visibility::records::{Blocker, Edge, Face, Occluder, Occluders, Target};

use crate::scene::{PLANE_TOLERANCE, Scene, Surface};
use shape::Plane;
pub(crate) use shape::Shape;
pub use solids::Solids;

/// More than the tables can index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLarge;

impl fmt::Display for TooLarge {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("the occluders have more vertices than the tables can index (65536)")
    }
}

impl std::error::Error for TooLarge {}

/// The occluders of a scene.
#[derive(Clone, Debug)]
pub struct Occlusion {
    shapes: Vec<Shape>,
    /// Where receivers are, as far as that is known.
    receivers: Option<Vec<DVec3>>,
    flat: f64,
    occluders: Vec<Occluder>,
    faces: Vec<Face>,
    edges: Vec<Edge>,
    vertices: Vec<[f32; 3]>,
    /// Vertices by cell of a grid, for welding.
    grid: HashMap<[i64; 3], Vec<u16>>,
    weld: f64,
}

/// A convex part of an emitter, and what can hide it.
#[derive(Clone, Debug)]
pub struct Emitter {
    origin: [f32; 3],
    axes: [[f32; 3]; 2],
    normal: [f32; 3],
    radius: f32,
    corners: Vec<[f32; 2]>,
    blockers: Vec<Blocker>,
}

impl Emitter {
    /// The part as the kernel takes it.
    pub fn target(&self) -> Target<'_> {
        Target {
            origin: self.origin,
            axes: self.axes,
            normal: self.normal,
            radius: self.radius,
            corners: &self.corners,
        }
    }

    /// What can come between it and anything, nearest to it first.
    pub fn blockers(&self) -> &[Blocker] {
        &self.blockers
    }
}

fn single(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn double(v: [f32; 3]) -> DVec3 {
    DVec3::from(v.map(f64::from))
}

/// A radius that holds what it held before rounding, and before the centre was
/// rounded by less than `slack`.
fn rounded_up(radius: f64, slack: f64) -> f32 {
    ((radius + slack) as f32).next_up()
}

impl Occlusion {
    /// All occluders of a scene, for receivers anywhere.
    ///
    /// # Errors
    /// [`TooLarge`] where there are too many vertices.
    pub fn of(scene: &Scene) -> Result<Self, TooLarge> {
        Self::new(scene, None)
    }

    /// As [`of`](Self::of), for receivers within the convex hull of `places`:
    /// what cannot come between these and an emitter, such as the walls of a
    /// convex room, is on no list.
    ///
    /// # Errors
    /// [`TooLarge`] where there are too many vertices.
    pub fn for_receivers_within(
        scene: &Scene,
        places: impl IntoIterator<Item = DVec3>,
    ) -> Result<Self, TooLarge> {
        Self::new(scene, Some(places.into_iter().collect()))
    }

    fn new(scene: &Scene, receivers: Option<Vec<DVec3>>) -> Result<Self, TooLarge> {
        let largest = scene.largest_coordinate();
        let (flat, weld) = (PLANE_TOLERANCE * largest, f64::from(f32::EPSILON) * largest);
        let mut occlusion = Self {
            shapes: Vec::new(),
            receivers,
            flat,
            occluders: Vec::new(),
            faces: Vec::new(),
            edges: Vec::new(),
            vertices: Vec::new(),
            grid: HashMap::new(),
            weld,
        };
        let mut in_body = vec![false; scene.surfaces.len()];
        for body in bodies::bodies(scene, flat) {
            let faces: Vec<&Surface> = body.iter().map(|&i| &scene.surfaces[i]).collect();
            if let Some(shape) = Shape::body(&faces, flat) {
                occlusion.shapes.push(shape);
                body.iter().for_each(|&i| in_body[i] = true);
            }
        }
        for (surface, in_body) in scene.surfaces.iter().zip(in_body) {
            if !in_body {
                for part in convex::parts(&surface.vertices, surface.normal) {
                    occlusion.shapes.push(Shape::polygon(surface.normal, part));
                }
            }
        }
        for index in 0..occlusion.shapes.len() {
            let shape = occlusion.shapes[index].clone();
            occlusion.record(&shape)?;
        }
        Ok(occlusion)
    }

    /// The convex polygons and closed convex bodies, in double precision.
    pub(crate) fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The tables' sections.
    pub fn records(&self) -> Occluders<'_> {
        Occluders {
            occluders: &self.occluders,
            faces: &self.faces,
            edges: &self.edges,
            vertices: &self.vertices,
            flat: self.flat as f32,
        }
    }

    /// The convex parts of an emitter: a simple planar polygon,
    /// counter-clockwise seen from the side of its unit normal.
    ///
    /// Occluders that reach behind its plane are cut there, which adds
    /// occluders to the [`records`](Self::records): ask for these when all
    /// emitters are known.
    ///
    /// # Errors
    /// [`TooLarge`] where there are too many vertices.
    pub fn emitter(&mut self, vertices: &[DVec3], normal: DVec3) -> Result<Vec<Emitter>, TooLarge> {
        convex::parts(vertices, normal)
            .iter()
            .map(|part| self.part(part, normal))
            .collect()
    }

    fn part(&mut self, vertices: &[DVec3], normal: DVec3) -> Result<Emitter, TooLarge> {
        let mut emitter = framed(vertices, normal, self.flat);
        let plane = Plane::of(normal, vertices);
        let mut found: Vec<(f64, Blocker)> = Vec::new();
        for index in 0..self.shapes.len() {
            let (lowest, highest) = plane.range(&self.shapes[index].vertices);
            if highest <= self.flat {
                continue;
            }
            if lowest >= -self.flat {
                self.list(&mut found, index, &self.shapes[index], vertices);
                continue;
            }
            for face in faces_of(&self.shapes[index]) {
                if let Some(cut) = face.in_front_of(&plane, self.flat) {
                    let index = self.record(&cut)?;
                    self.list(&mut found, index, &cut, vertices);
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        emitter.blockers = found.into_iter().map(|(_, blocker)| blocker).collect();
        Ok(emitter)
    }

    /// Lists an occluder in front of an emitter, unless nothing can be behind
    /// it.
    fn list(
        &self,
        found: &mut Vec<(f64, Blocker)>,
        index: usize,
        shape: &Shape,
        emitter: &[DVec3],
    ) {
        let record = &self.occluders[index];
        let faces = &self.faces[record.first_face as usize..][..shape.faces.len()];
        let range = |face: &Face, places: &[DVec3]| {
            let plane = Plane {
                normal: double(face.normal),
                offset: f64::from(face.offset),
            };
            plane.range(places)
        };
        let mut clear = 0;
        for (bit, face) in faces.iter().enumerate() {
            let (lowest, highest) = range(face, emitter);
            if shape.is_polygon() {
                clear |= if lowest >= -self.flat {
                    Blocker::FRONT
                } else {
                    0
                };
                clear |= if highest <= self.flat {
                    Blocker::BACK
                } else {
                    0
                };
            } else if lowest >= -self.flat {
                clear |= 1 << bit;
            }
        }
        if let ([face], Some(receivers)) = (faces, &self.receivers) {
            let (lowest, highest) = range(face, receivers);
            let no_front = highest <= self.flat || clear & Blocker::FRONT != 0;
            let no_back = lowest >= -self.flat || clear & Blocker::BACK != 0;
            if no_front && no_back {
                return;
            }
        }
        let (centre, radius) = shape.sphere();
        let (middle, _) = shape::sphere(emitter);
        let blocker = Blocker {
            occluder: index as u32,
            clear,
        };
        found.push((centre.distance(middle) - radius, blocker));
    }

    /// Writes an occluder to the sections and says where.
    fn record(&mut self, shape: &Shape) -> Result<usize, TooLarge> {
        let (centre, radius) = shape.sphere();
        self.occluders.push(Occluder {
            centre: single(centre),
            radius: rounded_up(radius, self.flat),
            first_face: self.faces.len() as u32,
            faces: shape.faces.len() as u32,
            first_edge: self.edges.len() as u32,
            edges: shape.edges.len() as u32,
        });
        self.faces.extend(shape.faces.iter().map(|plane| Face {
            normal: single(plane.normal),
            offset: plane.offset as f32,
        }));
        let vertices: Vec<u16> = shape
            .vertices
            .iter()
            .map(|&vertex| self.vertex(vertex))
            .collect::<Result<_, _>>()?;
        self.edges.extend(shape.edges.iter().map(|edge| Edge {
            a: vertices[edge.ends[0]],
            b: vertices[edge.ends[1]],
            left: edge.left as u16,
            right: edge.right as u16,
        }));
        Ok(self.occluders.len() - 1)
    }

    /// The index of a vertex: of one that is the same place to the device, if
    /// there is one.
    fn vertex(&mut self, place: DVec3) -> Result<u16, TooLarge> {
        let cell = |x: f64| (x / (4.0 * self.weld)).floor() as i64;
        let near = |x: f64| cell(x - self.weld)..=cell(x + self.weld);
        for x in near(place.x) {
            for y in near(place.y) {
                for z in near(place.z) {
                    let found = self.grid.get(&[x, y, z]).into_iter().flatten();
                    for &index in found {
                        let vertex = double(self.vertices[usize::from(index)]);
                        if vertex.distance(place) <= self.weld {
                            return Ok(index);
                        }
                    }
                }
            }
        }
        let index = u16::try_from(self.vertices.len()).map_err(|_| TooLarge)?;
        let vertex = single(place);
        let cell = double(vertex).to_array().map(cell);
        self.vertices.push(vertex);
        self.grid.entry(cell).or_default().push(index);
        Ok(index)
    }
}

/// The faces of a shape as polygons.
pub(crate) fn faces_of(shape: &Shape) -> Vec<Shape> {
    if shape.is_polygon() {
        return vec![shape.clone()];
    }
    let polygon = |(face, plane): (usize, &Plane)| {
        let after = |vertex: usize| {
            shape.edges.iter().find_map(|edge| match edge.ends {
                [from, to] if edge.left == face && from == vertex => Some(to),
                [to, from] if edge.right == face && from == vertex => Some(to),
                _ => None,
            })
        };
        let first = shape.edges.iter().find_map(|edge| match edge.ends {
            [from, _] if edge.left == face => Some(from),
            [_, from] if edge.right == face => Some(from),
            _ => None,
        })?;
        let mut corners = vec![first];
        while let Some(next) = after(*corners.last()?) {
            if next == first || corners.len() > shape.vertices.len() {
                break;
            }
            corners.push(next);
        }
        let vertices = corners.into_iter().map(|i| shape.vertices[i]).collect();
        Some(Shape::polygon(plane.normal, vertices))
    };
    shape.faces.iter().enumerate().filter_map(polygon).collect()
}

/// A convex polygon in a frame of its own: the middle of its bounding
/// rectangle along its longest side, and that rectangle's half extents.
fn framed(vertices: &[DVec3], normal: DVec3, flat: f64) -> Emitter {
    let count = vertices.len();
    let longest = (0..count)
        .map(|i| vertices[(i + 1) % count] - vertices[i])
        .reduce(|a, b| if b.length() > a.length() { b } else { a })
        .unwrap_or(DVec3::X);
    let u = (longest - normal * longest.dot(normal)).normalize();
    let v = normal.cross(u);
    let extent = |axis: DVec3| {
        let along = vertices.iter().map(|vertex| vertex.dot(axis));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    };
    let ((u0, u1), (v0, v1)) = (extent(u), extent(v));
    let (half_u, half_v) = ((u1 - u0) / 2.0, (v1 - v0) / 2.0);
    let height = Plane::of(normal, vertices).offset;
    let origin = u * ((u0 + u1) / 2.0) + v * ((v0 + v1) / 2.0) + normal * height;
    let corner = |vertex: &DVec3| {
        let offset = *vertex - origin;
        let unit = |x: f64| (x as f32).clamp(-1.0, 1.0);
        [unit(offset.dot(u) / half_u), unit(offset.dot(v) / half_v)]
    };
    let radius = vertices.iter().fold(0.0_f64, |radius, vertex| {
        radius.max(vertex.distance(origin))
    });
    Emitter {
        origin: single(origin),
        axes: [single(u * half_u), single(v * half_v)],
        normal: single(normal),
        radius: rounded_up(radius, flat),
        corners: vertices.iter().map(corner).collect(),
        blockers: Vec::new(),
    }
}
