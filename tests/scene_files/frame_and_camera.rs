//! The local frame of a surface, rays and the camera.

use glam::{DMat3, DVec3};
use isolux_host::scene::camera::{Caster, View};
use isolux_host::scene::frame::Frame;
use isolux_host::scene::{Scene, shipped};
use proptest::prelude::*;

use crate::{SQUARE, accepted, faces, place, scene_of, star, turn, with_vertices};

fn alone(vertices: Vec<DVec3>) -> Scene {
    scene_of(&[("star".to_owned(), vertices, 0.5, 0.0)], "")
}

#[test]
fn frame_of_a_rectangle_is_the_rectangle() {
    let scene = accepted(shipped::PAPER);
    let frame = Frame::new(&scene.surfaces[0]);
    assert_eq!(frame.origin.to_array(), [-2.5, -2.5, 0.0]);
    assert_eq!((frame.u, frame.v), (DVec3::X, DVec3::Y));
    assert_eq!((frame.size_u, frame.size_v), (5.0, 5.0));
    assert_eq!(
        frame.vertices,
        [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 5.0)]
    );
    assert_eq!(frame.cell_center(0, 199, 200, 200), (0.0125, 4.9875));
    // B looks down: seen from its front, u x v still points to its front.
    let frame = Frame::new(&scene.surfaces[2]);
    assert_eq!(frame.origin.to_array(), [3.7, 2.5, 2.2]);
    assert_eq!(frame.u.cross(frame.v).to_array(), [0.0, 0.0, -1.0]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn frame_maps_the_plane_to_the_least_rectangle(vertices in star(), s in 0.0..1.0_f64, t in 0.0..1.0_f64) {
        let scene = alone(vertices);
        let surface = &scene.surfaces[0];
        let frame = Frame::new(surface);
        let axes = DMat3::from_cols(frame.u, frame.v, frame.normal);
        prop_assert!((axes * axes.transpose() - DMat3::IDENTITY).to_cols_array().iter().all(|x| x.abs() < 1e-14));
        prop_assert!((axes.determinant() - 1.0).abs() < 1e-14);
        let (u, v) = frame.to_local(frame.to_world(s, t));
        prop_assert!((u - s).abs() < 1e-13 && (v - t).abs() < 1e-13);
        let (mut low, mut high) = ((9.0_f64, 9.0_f64), (-9.0_f64, -9.0_f64));
        for (vertex, &(u, v)) in surface.vertices.iter().zip(&frame.vertices) {
            prop_assert!(frame.to_world(u, v).distance(*vertex) < 1e-13);
            prop_assert!(frame.contains(u, v));
            low = (low.0.min(u), low.1.min(v));
            high = (high.0.max(u), high.1.max(v));
        }
        prop_assert!(low.0.abs() < 1e-13 && low.1.abs() < 1e-13);
        prop_assert!((high.0 - frame.size_u).abs() < 1e-13 && (high.1 - frame.size_v).abs() < 1e-13);
        // No rectangle along another edge is smaller.
        let count = surface.vertices.len();
        for i in 0..count {
            let u = (surface.vertices[(i + 1) % count] - surface.vertices[i]).normalize();
            let v = surface.normal.cross(u);
            let extent = |axis: DVec3| {
                let along: Vec<f64> = surface.vertices.iter().map(|p| p.dot(axis)).collect();
                along.iter().copied().fold(f64::MIN, f64::max) - along.iter().copied().fold(f64::MAX, f64::min)
            };
            prop_assert!(frame.size_u * frame.size_v <= extent(u) * extent(v) * (1.0 + 1e-8));
        }
    }

    /// The cells inside the polygon have its area, and the ray through a cell
    /// meets the surface just where the frame says it is.
    #[test]
    fn frame_and_rays_agree_on_the_inside(vertices in star()) {
        let scene = alone(vertices);
        let surface = &scene.surfaces[0];
        let frame = Frame::new(surface);
        let caster = Caster::new(&scene);
        let mut inside = 0;
        for row in 0..60 {
            for column in 0..60 {
                let (u, v) = frame.cell_center(column, row, 60, 60);
                let contained = frame.contains(u, v);
                inside += usize::from(contained);
                let place = frame.to_world(u, v);
                let eye = surface.center() + surface.normal * 3.0 + frame.u * 0.7;
                let hit = caster.nearest(eye, (place - eye).normalize());
                prop_assert_eq!(hit.is_some(), contained);
                if let Some(hit) = hit {
                    prop_assert!(hit.front && hit.position.distance(place) < 1e-12);
                    let behind = place * 2.0 - eye;
                    let back = caster.nearest(behind, (place - behind).normalize());
                    prop_assert!(back.is_some_and(|hit| !hit.front));
                }
            }
        }
        let cells = inside as f64 / 3600.0 * frame.size_u * frame.size_v;
        let perimeter: f64 = (0..surface.vertices.len())
            .map(|i| surface.vertices[i].distance(surface.vertices[(i + 1) % surface.vertices.len()]))
            .sum();
        prop_assert!((cells - surface.area).abs() < 0.5 * perimeter * frame.size_u.max(frame.size_v) / 60.0);
        prop_assert!(!frame.contains(-1e-6, 0.5 * frame.size_v));
    }

    /// From inside of a closed room, its walls split into triangles, every ray
    /// meets the front of the nearest wall: none slips through a seam.
    #[test]
    fn rooms_are_tight(turn in turn(), eye in place(0.9), direction in place(1.0)) {
        let walls = faces("room", -DVec3::ONE, DVec3::ONE, true, turn);
        let mut triangles = Vec::new();
        for (name, corners, rho, radiance) in &walls {
            for half in [[0, 1, 2], [0, 2, 3]] {
                let corners = half.map(|i| corners[i]).to_vec();
                triangles.push((format!("{name}{}", half[1]), corners, *rho, *radiance));
            }
        }
        let scene = scene_of(&triangles, "");
        let caster = Caster::new(&scene);
        let eye = turn * eye;
        // Straight at corners, diagonals and edges too.
        let mut targets: Vec<DVec3> = walls.iter().flat_map(|(_, corners, _, _)| {
            [corners[0], (corners[0] + corners[2]) * 0.5, (corners[0] + corners[1]) * 0.5]
        }).collect();
        targets.push(eye + direction);
        for target in targets {
            let hit = caster.nearest(eye, (target - eye).normalize());
            let hit = hit.expect("a wall");
            prop_assert!(hit.front);
            let reach = (turn.inverse() * hit.position).abs().max_element();
            prop_assert!((reach - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn projection_inverts_the_rays(eye in place(5.0), target in place(5.0), x in 0.0..320.0_f64, y in 0.0..200.0_f64, fov in 5.0..150.0_f64) {
        prop_assume!(eye.distance(target) > 0.1);
        prop_assume!((target - eye).normalize().cross(DVec3::Z).length() > 0.01);
        let [ex, ey, ez] = eye.to_array();
        let [tx, ty, tz] = target.to_array();
        let camera = format!("[camera]\neye = [{ex:?}, {ey:?}, {ez:?}]\ntarget = [{tx:?}, {ty:?}, {tz:?}]\nup = [0, 0, 1]\nfov = {fov:?}\n");
        let scene = accepted(&(with_vertices(SQUARE) + &camera));
        let view = View::new(&scene.camera.expect("a camera"), 320, 200);
        let direction = view.direction(x, y);
        let (px, py) = view.project(view.eye() + direction * 7.0).expect("in front");
        prop_assert!((px - x).abs() < 1e-9 && (py - y).abs() < 1e-9);
        prop_assert!(view.project(view.eye() - direction).is_none());
        let (cx, cy) = view.project(target).expect("in front");
        prop_assert!((cx - 160.0).abs() < 1e-9 && (cy - 100.0).abs() < 1e-9);
        // Up is up: rows count downwards. Top and bottom span the field of view.
        prop_assert!(view.direction(160.0, 0.0).z > view.direction(160.0, 200.0).z || fov > 90.0);
        let angle = view.direction(160.0, 0.0).angle_between(view.direction(160.0, 200.0));
        prop_assert!((angle.to_degrees() - fov).abs() < 1e-9);
    }
}

/// Every shipped room has a camera that sees fronts nearly everywhere.
#[test]
fn the_cameras_of_rooms_see_the_rooms() {
    for (text, fronts, seen) in [
        (
            shipped::PENUMBRA,
            0.2,
            &["receiver", "light", "occluder"][..],
        ),
        (
            shipped::CORNELL,
            0.65,
            &["floor", "light", "right", "left0", "short_top"],
        ),
        (
            shipped::CORNELL_RGB,
            0.65,
            &["floor", "light", "right", "left0", "short_top"],
        ),
        (
            shipped::OFFICE,
            0.99,
            &["floor", "desk_top", "wall_x0", "lum01"],
        ),
    ] {
        let scene = accepted(text);
        let view = View::new(&scene.camera.expect("a camera"), 160, 120);
        let hits: Vec<_> = view.hits(&scene).into_iter().flatten().collect();
        let front = hits.iter().filter(|hit| hit.front).count() as f64 / (160.0 * 120.0);
        assert!(front > fronts, "{}: {front}", scene.name);
        for surface in seen {
            let index = scene.surface_named(surface);
            let count = hits.iter().filter(|hit| Some(hit.surface) == index).count();
            assert!(count > 20, "{}: {surface} {count}", scene.name);
        }
    }
}

#[test]
fn the_paper_camera_sees_both_fronts() {
    for (name, text) in [
        ("paper", shipped::PAPER),
        ("paper-aspect", shipped::PAPER_ASPECT),
    ] {
        let scene = accepted(text);
        let view = View::new(&scene.camera.expect("a camera"), 200, 200);
        let hits = view.hits(&scene);
        assert_eq!(hits.len(), 200 * 200);
        let share = |surface: &str| {
            let index = scene.surface_named(surface).expect("a surface");
            let seen = hits
                .iter()
                .flatten()
                .filter(|hit| hit.surface == index && hit.front);
            seen.count() as f64 / hits.len() as f64
        };
        assert!(share("A") > 0.08, "{name}: {}", share("A"));
        assert!(share("B") > 0.05, "{name}: {}", share("B"));
        assert!(share("LS") > 0.03, "{name}: {}", share("LS"));
        for (index, hit) in hits.iter().enumerate() {
            let Some(hit) = hit else { continue };
            assert!(hit.front);
            let (x, y) = view.project(hit.position).expect("in front");
            assert!((x - ((index % 200) as f64 + 0.5)).abs() < 1e-9);
            assert!((y - ((index / 200) as f64 + 0.5)).abs() < 1e-9);
        }
    }
}
