//! Which surfaces of a scene make closed convex bodies.

use std::collections::HashMap;

use glam::DVec3;

use super::shape::Plane;
use crate::scene::body::{check, free_edges, weld_corners};
use crate::scene::{Scene, Surface};

/// The surfaces of every body: those that the scene names, and loose ones that
/// close, or stand with their open side on another surface.
pub(super) fn bodies(scene: &Scene, flat: f64) -> Vec<Vec<usize>> {
    let mut bodies: Vec<Vec<usize>> = scene
        .bodies
        .iter()
        .map(|body| body.surfaces.clone())
        .collect();
    let named: Vec<usize> = bodies.iter().flatten().copied().collect();
    let loose: Vec<usize> = (0..scene.surfaces.len())
        .filter(|index| !named.contains(index))
        .collect();
    for group in groups(scene, &loose, flat) {
        let faces: Vec<&Surface> = group.iter().map(|&i| &scene.surfaces[i]).collect();
        if check(&faces, flat).is_ok()
            && is_shut(scene, &group, &faces, flat)
            && is_empty(scene, &group, &faces, flat)
        {
            bodies.push(group);
        }
    }
    bodies
}

/// Surfaces that hang together by edges which one runs along the one way and
/// another the other way.
fn groups(scene: &Scene, loose: &[usize], flat: f64) -> Vec<Vec<usize>> {
    let faces: Vec<&Surface> = loose.iter().map(|&i| &scene.surfaces[i]).collect();
    let corners = weld_corners(&faces, flat);
    let corner = |place: DVec3| corners.iter().position(|c| c.distance(place) <= flat);
    let mut owner = HashMap::new();
    for (face, surface) in faces.iter().enumerate() {
        for ends in sides(surface) {
            owner.insert(ends.map(corner), face);
        }
    }
    let mut group: Vec<usize> = (0..faces.len()).collect();
    for (face, surface) in faces.iter().enumerate() {
        for [from, to] in sides(surface) {
            if let Some(&other) = owner.get(&[corner(to), corner(from)]) {
                let (kept, gone) = (group[face], group[other]);
                group
                    .iter_mut()
                    .filter(|g| **g == gone)
                    .for_each(|g| *g = kept);
            }
        }
    }
    let mut found: Vec<Vec<usize>> = vec![Vec::new(); faces.len()];
    for (face, &group) in group.iter().enumerate() {
        found[group].push(loose[face]);
    }
    found.retain(|group| group.len() >= 3);
    found
}

fn sides(surface: &Surface) -> impl Iterator<Item = [DVec3; 2]> + '_ {
    let count = surface.vertices.len();
    (0..count).map(move |i| [surface.vertices[i], surface.vertices[(i + 1) % count]])
}

/// Whether a body has no open side, or another surface lies across it: the
/// inside of an open box is not dark.
fn is_shut(scene: &Scene, group: &[usize], faces: &[&Surface], flat: f64) -> bool {
    let corners = weld_corners(faces, flat);
    let Ok(free) = free_edges(faces, &corners, flat) else {
        return false;
    };
    let rim: Vec<DVec3> = free.iter().map(|edge| corners[edge.from]).collect();
    rim.is_empty()
        || scene.surfaces.iter().enumerate().any(|(index, surface)| {
            !group.contains(&index) && rim.iter().all(|&place| lies_on(surface, place, flat))
        })
}

/// Whether no luminaire lies inside of a body, which would then not be dark.
fn is_empty(scene: &Scene, group: &[usize], faces: &[&Surface], flat: f64) -> bool {
    let others = scene.surfaces.iter().enumerate();
    let mut places = others
        .filter(|(index, surface)| surface.emits() && !group.contains(index))
        .flat_map(|(_, surface)| &surface.vertices);
    let planes: Vec<Plane> = faces
        .iter()
        .map(|face| Plane::of(face.normal, &face.vertices))
        .collect();
    !places.any(|&place| planes.iter().all(|plane| plane.height(place) < -flat))
}

/// Whether a place lies on a convex surface. (A concave one closes nothing.)
fn lies_on(surface: &Surface, place: DVec3, flat: f64) -> bool {
    let plane = Plane::of(surface.normal, &surface.vertices);
    plane.height(place).abs() <= flat
        && sides(surface).all(|[from, to]| {
            let along = to - from;
            surface.normal.cross(along).dot(place - from) >= -flat * along.length()
        })
}
