//! What the camera sees larger counts more.

use crate::scene::Scene;
use crate::scene::camera::{Caster, View};
use glam::DVec3;

/// How much the error of a place counts: 1 on average over the surfaces that reflect.
pub type Importance<'a> = dyn Fn(DVec3, DVec3) -> f64 + Sync + 'a;

/// What a place that the camera does not see still counts: its light reaches others.
const UNSEEN: f64 = 0.02;

/// Rows of the picture in which pixels are counted.
const ROWS: u32 = 64;

/// The pixels that a square metre at a place fills, and a little for what is not seen;
/// `None` where the scene has no camera, or this sees nothing.
///
/// A m² at the place p with normal n has the solid angle n·(e − p)/r³ from the eye e, r
/// away, and at depth z a solid angle has (r/z)³ pixels in proportion: n·(e − p)/z³.
pub fn importance(scene: &Scene) -> Option<impl Fn(DVec3, DVec3) -> f64 + Sync + '_> {
    let camera = scene.camera.as_ref()?;
    let view = View::new(camera, ROWS, ROWS);
    let reflects = |hit: &crate::scene::camera::Hit| scene.surfaces[hit.surface].reflects();
    let hits = view.hits(scene);
    let seen = hits
        .iter()
        .flatten()
        .filter(|hit| hit.front && reflects(hit))
        .count();
    if seen == 0 {
        return None;
    }
    let area: f64 = (scene
        .surfaces
        .iter()
        .filter(|s| s.reflects())
        .map(|s| s.area))
    .sum();
    let forward = view.direction(0.5 * f64::from(ROWS), 0.5 * f64::from(ROWS));
    let caster = Caster::new(scene);
    let tolerance = 10.0 * scene.plane_tolerance();
    // Pixels at unit depth on a unit area that faces the camera.
    let pixels = (f64::from(ROWS) / (2.0 * (0.5 * camera.fov.to_radians()).tan())).powi(2);
    let scale = pixels * area / seen as f64;
    Some(move |place: DVec3, normal: DVec3| {
        let ray = place - view.eye();
        let (depth, facing) = (ray.dot(forward), -normal.dot(ray));
        let inside = |(x, y): (f64, f64)| {
            (0.0..=f64::from(ROWS)).contains(&x) && (0.0..=f64::from(ROWS)).contains(&y)
        };
        if facing <= 0.0 || !view.project(place).is_some_and(inside) {
            return UNSEEN;
        }
        let distance = ray.length();
        let first = caster.nearest(view.eye(), ray / distance);
        match first {
            Some(hit) if view.eye().distance(hit.position) < distance - tolerance => UNSEEN,
            _ => UNSEEN + (1.0 - UNSEEN) * scale * facing / depth.powi(3),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{file, shipped};

    /// The mean over what reflects is what it is said to be.
    #[test]
    fn what_is_seen_counts_one_on_average() {
        let scene = file::parse("scene.toml", shipped::CORNELL).expect("a scene");
        let importance = importance(&scene).expect("a camera");
        let (mut sum, mut whole) = (0.0, 0.0);
        for surface in scene.surfaces.iter().filter(|surface| surface.reflects()) {
            let frame = crate::scene::frame::Frame::new(surface);
            let inside: Vec<(f64, f64)> = (0..60 * 60)
                .map(|k| frame.cell_center(k % 60, k / 60, 60, 60))
                .filter(|&(u, v)| frame.contains(u, v))
                .collect();
            for &(u, v) in &inside {
                let counts = importance(frame.to_world(u, v), frame.normal);
                assert!(counts >= UNSEEN && counts.is_finite());
                sum += counts * surface.area / inside.len() as f64;
            }
            whole += surface.area;
        }
        let mean = sum / whole;
        assert!((mean - 1.0).abs() < 0.05, "{mean}");
    }
}
