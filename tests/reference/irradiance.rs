//! Irradiance of whole scenes.

use glam::{DQuat, DVec3};
use isolux_host::reference::{Error, Reference, Reflections};
use isolux_host::scene::{Scene, Surface};
use serde_json::Value;

use crate::fixtures::{
    Polygon, file_scene, number, over_polygon, reference, room, scene, surface, vector,
};

fn simple_scenes() -> [Value; 2] {
    [
        include_str!("../data/references/b_simple_3x3.json"),
        include_str!("../data/references/b_simple_4.4497x2.0226.json"),
    ]
    .map(|text| serde_json::from_str(text).expect("a file"))
}

#[test]
fn the_simple_scenes_are_met_within_1e_9() {
    for file in simple_scenes() {
        let scene = file_scene(&file);
        let direct = reference(&scene, Reflections::AtMost(0));
        let once = reference(&scene, Reflections::AtMost(1));
        let mut worst = [0.0_f64; 2];
        for point in file["points"].as_array().expect("points") {
            let (position, normal) = (vector(&point["p"]), vector(&point["n"]));
            let exact = number(&point["E"]);
            let on_a = point["surface"] == "A";
            let judge = if on_a { &direct } else { &once };
            let error = (judge.irradiance(position, normal) - exact).abs() / exact;
            worst[usize::from(!on_a)] = worst[usize::from(!on_a)].max(error);
        }
        println!("{}: A {:.1e}, B {:.1e}", file["name"], worst[0], worst[1]);
        assert!(worst[0] <= 1e-13 && worst[1] <= 1e-9, "{worst:?}");
        assert!(once.accuracy() <= 1e-9);
    }
}

#[test]
fn points_in_bulk_equal_points_one_by_one() {
    let [file, _] = simple_scenes();
    let judge = reference(&file_scene(&file), Reflections::AtMost(1));
    let points: Vec<(DVec3, DVec3)> = (0..40_000)
        .map(|index| {
            let (i, j) = (index % 200, index / 200);
            let place = DVec3::new(
                3.7 + (i as f64 + 0.5) / 40.0,
                (j as f64 + 0.5) / 40.0 - 2.5,
                2.2,
            );
            (place, -DVec3::Z)
        })
        .collect();
    let start = std::time::Instant::now();
    let bulk = judge.irradiance_at(&points);
    println!("40 000 points on B in {:.2?}", start.elapsed());
    for (point, value) in points.iter().zip(&bulk).step_by(97) {
        assert_eq!(
            judge.irradiance(point.0, point.1).to_bits(),
            value.to_bits()
        );
    }
    let on_a: Vec<(DVec3, DVec3)> = points
        .iter()
        .map(|(place, _)| (DVec3::new(place.x - 6.2, place.y, 0.0), DVec3::Z))
        .collect();
    let start = std::time::Instant::now();
    assert!(judge.irradiance_at(&on_a).iter().all(|value| *value > 0.0));
    println!("40 000 points on A in {:.2?}", start.elapsed());
}

/// After N reflections in a closed room whose every surface has radiance L
/// and reflectance rho, E = pi L (1 - rho^(N+1)) / (1 - rho) everywhere.
#[test]
fn a_closed_room_that_glows_evenly_is_lit_evenly() {
    let (radiance, rho) = (2.0, 0.5);
    let faces = room(DVec3::new(3.0, 2.0, 1.0));
    let scene = scene(
        faces
            .iter()
            .enumerate()
            .map(|(index, face)| surface(&index.to_string(), face.clone(), rho, radiance))
            .collect(),
    );
    for count in [0, 1, 2, 5, 20] {
        let start = std::time::Instant::now();
        let judge = reference(&scene, Reflections::AtMost(count));
        let ready = start.elapsed();
        let expected =
            std::f64::consts::PI * radiance * (1.0 - rho_power(rho, count + 1)) / (1.0 - rho);
        let mut worst = 0.0_f64;
        for face in &faces {
            let normal = (face[1] - face[0]).cross(face[2] - face[0]);
            for (u, v) in [(0.5, 0.5), (0.013, 0.77), (0.99, 0.002), (0.3, 1e-6)] {
                let place = face[0] + (face[1] - face[0]) * u + (face[3] - face[0]) * v;
                let error = judge.irradiance(place, normal) / expected - 1.0;
                worst = worst.max(error.abs());
            }
        }
        let inside = judge.irradiance(DVec3::new(1.0, 0.4, 0.3), DVec3::new(0.3, -0.5, 0.8));
        worst = worst.max((inside / expected - 1.0).abs());
        println!(
            "{count} reflections: {worst:.1e}, ready in {ready:.1?}, {:.1?}",
            start.elapsed()
        );
        assert!(
            worst <= if count <= 1 { 1e-9 } else { 1e-6 },
            "{count} {worst:e}"
        );
        assert!(judge.accuracy() <= 1e-6);
    }
}

fn rho_power(rho: f64, exponent: usize) -> f64 {
    (0..exponent).map(|_| rho).product()
}

/// A room lit by a panel below its ceiling, every wall of its own colour.
fn lit_room() -> Scene {
    let faces = room(DVec3::new(4.0, 3.0, 2.5));
    let mut surfaces: Vec<Surface> = faces
        .iter()
        .enumerate()
        .map(|(index, face)| {
            surface(
                &index.to_string(),
                face.clone(),
                0.3 + 0.1 * index as f64,
                0.0,
            )
        })
        .collect();
    let panel =
        [[1.0, 1.0], [1.0, 2.0], [2.5, 2.0], [2.5, 1.0]].map(|[x, y]| DVec3::new(x, y, 2.5));
    surfaces.push(surface("panel", panel.to_vec(), 0.0, 10.0));
    scene(surfaces)
}

/// A speck that hides a millionth makes the meshes do what quadrature did.
#[test]
fn a_speck_of_dust_changes_nothing() {
    let clean = lit_room();
    let mut dusty = clean.clone();
    let speck = [[2.0, 1.5], [2.001, 1.5], [2.001, 1.501], [2.0, 1.501]];
    let speck = speck.map(|[x, y]| DVec3::new(x, y, 1.2)).to_vec();
    dusty.surfaces.push(surface("speck", speck, 0.0, 0.0));
    let expected = reference(&clean, Reflections::AtMost(1));
    let judge = reference(&dusty, Reflections::AtMost(1));
    for wall in &clean.surfaces[..6] {
        let corner = wall.vertices[0];
        for (u, v) in [(0.5, 0.5), (0.1, 0.8), (0.3, 0.2), (0.97, 0.04)] {
            let (along, across) = (wall.vertices[1] - corner, wall.vertices[3] - corner);
            let place = corner + along * u + across * v;
            let (value, expected) = (
                judge.irradiance(place, wall.normal),
                expected.irradiance(place, wall.normal),
            );
            assert!(
                (value / expected - 1.0).abs() < 1e-3,
                "{place} {value} {expected}"
            );
        }
    }
}

/// The second generation of light is the first, as the adaptive quadrature has
/// it, gathered by a plain sum. The ceiling reflects nothing where the panel
/// covers it.
#[test]
fn light_reflected_twice_is_light_reflected_once_gathered() {
    let scene = lit_room();
    let direct = reference(&scene, Reflections::AtMost(0));
    let once = reference(&scene, Reflections::AtMost(1));
    let twice = reference(&scene, Reflections::AtMost(2));
    for (position, normal) in [
        (DVec3::new(0.0, 1.575, 1.3125), DVec3::X),
        (DVec3::new(2.0, 1.3, 0.0), DVec3::Z),
        (DVec3::new(1.1, 2.2, 1.6), DVec3::new(0.6, 0.0, -0.8)),
    ] {
        let mut sum = once.irradiance(position, normal);
        let mut parts: Vec<(&Surface, &Polygon, f64)> = scene.surfaces[..6]
            .iter()
            .map(|wall| (wall, &wall.vertices, 1.0))
            .collect();
        parts.push((&scene.surfaces[1], &scene.surfaces[6].vertices, -1.0));
        for (wall, outline, sign) in parts {
            let height = wall.normal.dot(position - wall.vertices[0]);
            let shown = sign * wall.reflectance[0] / std::f64::consts::PI * height;
            sum += over_polygon(outline, 5, &mut |y| {
                let r = y - position;
                let first = once.irradiance(y, wall.normal) - direct.irradiance(y, wall.normal);
                shown * first * normal.dot(r).max(0.0) / r.length_squared().powi(2)
            });
        }
        let value = twice.irradiance(position, normal);
        println!("{value} {sum} {:.1e}", value / sum - 1.0);
        assert!((value / sum - 1.0).abs() < 5e-4, "{value} {sum}");
    }
}

/// What the walls absorb, and the little that is unshot, is what the panel
/// emits.
#[test]
fn a_room_of_many_reflections_converges_and_keeps_its_energy() {
    let scene = lit_room();
    let place = (DVec3::new(0.0, 1.575, 1.3125), DVec3::X);
    let mut before = 0.0;
    for count in [1, 2] {
        let judge = reference(&scene, Reflections::AtMost(count));
        let value = judge.irradiance(place.0, place.1);
        println!(
            "{count} reflections: {value}, accuracy {:.1e}",
            judge.accuracy()
        );
        assert!(value > before && judge.accuracy() <= 1e-3);
        before = value;
    }
    let fraction = 1e-3;
    let judge = reference(&scene, Reflections::UntilUnshot(fraction));
    println!(
        "{} reflections: accuracy {:.1e}",
        judge.reflections(),
        judge.accuracy()
    );
    assert!(judge.irradiance(place.0, place.1) > before && judge.accuracy() <= 1e-3);
    let emitted = std::f64::consts::PI * 10.0 * scene.surfaces[6].area;
    let mut absorbed = 0.0;
    for wall in &scene.surfaces[..6] {
        let share = 1.0 - wall.reflectance[0];
        absorbed +=
            share * over_polygon(&wall.vertices, 6, &mut |y| judge.irradiance(y, wall.normal));
    }
    // Where the black panel covers the ceiling, it absorbs the rest as well.
    let (ceiling, panel) = (&scene.surfaces[1], &scene.surfaces[6]);
    absorbed += ceiling.reflectance[0]
        * over_polygon(&panel.vertices, 6, &mut |y| {
            judge.irradiance(y, panel.normal)
        });
    let left = 1.0 - absorbed / emitted;
    println!("left: {left:.2e}");
    // The sum over the walls is itself good to about 1e-4, the light to 1e-3.
    assert!(left > -1e-3 && left < fraction + 1e-3, "{left:e}");
}

/// An L-shaped floor below a lamp whose plane cuts the floor, seen by tilted
/// receivers whose horizons cut it too: against a plain fine sum.
#[test]
fn kinks_horizons_and_concave_reflectors_are_met() {
    let outline = [
        [0., 0.],
        [3., 0.],
        [3., 1.],
        [1.2, 1.],
        [1.2, 2.5],
        [0., 2.5],
    ];
    let floor: Polygon = outline
        .iter()
        .map(|[x, y]| DVec3::new(*x, *y, 0.0))
        .collect();
    let lamp = [
        [0.9, 0.2, 1.0],
        [0.9, 1.4, 1.0],
        [1.5, 1.4, 1.9],
        [1.5, 0.2, 1.9],
    ]
    .map(DVec3::from);
    let (rho, radiance) = (0.7, 3.0);
    let lit = scene(vec![
        surface("floor", floor, rho, 0.0),
        surface("lamp", lamp.to_vec(), 0.0, radiance),
    ]);
    let direct = reference(&lit, Reflections::AtMost(0));
    let once = reference(&lit, Reflections::AtMost(1));
    let boxes = [[0., 0., 3., 1.], [0., 1., 1.2, 2.5]];
    for (position, normal) in [
        (DVec3::new(2.0, 2.0, 1.0), DVec3::new(-0.6, -0.8, 0.0)),
        (DVec3::new(0.4, 0.6, 0.7), DVec3::new(0.9, 0.1, -0.3)),
        (DVec3::new(1.0, 0.8, 0.5), DVec3::new(0.1, 0.7, 0.4)),
    ] {
        let normal = normal.normalize();
        let mut sum = 0.0;
        for [x0, y0, x1, y1] in boxes {
            let corners =
                [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| DVec3::new(x, y, 0.0));
            sum += over_polygon(&corners, 150, &mut |y| {
                let r = y - position;
                let kernel = normal.dot(r).max(0.0) * position.z / r.length_squared().powi(2);
                rho / std::f64::consts::PI * direct.irradiance(y, DVec3::Z) * kernel
            });
        }
        let expected = direct.irradiance(position, normal) + sum;
        let value = once.irradiance(position, normal);
        println!("{value} {:.1e}", value / expected - 1.0);
        assert!((value / expected - 1.0).abs() < 2e-6, "{value} {expected}");
    }
}

/// Points that come within 1e-9 of an edge at which a lit floor meets the
/// wall: the limit of a wall's foot is half of what leaves the floor there.
#[test]
fn the_foot_of_a_wall_converges() {
    let [file, _] = simple_scenes();
    let mut lit = file_scene(&file);
    lit.surfaces.truncate(2);
    let judge = reference(&lit, Reflections::AtMost(1));
    let direct = reference(&lit, Reflections::AtMost(0));
    let foot = DVec3::new(-2.5, 0.4, 0.0);
    let limit = 0.5 * lit.surfaces[0].reflectance[0] * direct.irradiance(foot, DVec3::Z);
    for height in [1e-3, 1e-6, 1e-9] {
        let place = foot + DVec3::Z * height;
        let indirect = judge.irradiance(place, DVec3::X) - direct.irradiance(place, DVec3::X);
        let slope = (indirect / limit - 1.0).abs();
        println!("{height:e}: {slope:.1e}");
        assert!(slope <= 20.0 * height + 1e-9, "{height:e} {slope:e}");
    }
}

#[test]
fn what_makes_no_sense_is_refused() {
    let scene = lit_room();
    let refuse =
        |reflections| Reference::new(&scene, reflections, &mut |_| {}).expect_err("refused");
    assert_eq!(refuse(Reflections::UntilUnshot(0.0)), Error::Fraction(0.0));
    let unclear = refuse(Reflections::UntilUnshot(f64::NAN));
    assert!(unclear.to_string().contains("must be a number above 0"));
    let judge = reference(&scene, Reflections::AtMost(1));
    assert_eq!(judge.irradiance(DVec3::ONE, DVec3::ZERO), 0.0);
}

/// Rounding moves the points of a turned room off their walls and the
/// coplanar panel off its ceiling, by turns to either side.
#[test]
fn a_turned_room_gives_the_same_light() {
    let straight = lit_room();
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, -0.7, 0.5).normalize(), 1.1);
    let moved = |p: DVec3| turn * p + DVec3::new(10.0, -3.0, 7.0);
    let mut turned = straight.clone();
    for surface in &mut turned.surfaces {
        surface.vertices = surface.vertices.iter().map(|p| moved(*p)).collect();
        surface.normal = turn * surface.normal;
    }
    let one = reference(&straight, Reflections::AtMost(1));
    let other = reference(&turned, Reflections::AtMost(1));
    for wall in &straight.surfaces[..6] {
        let corner = wall.vertices[0];
        let (along_u, along_v) = (wall.vertices[1] - corner, wall.vertices[3] - corner);
        for k in 0..60 {
            let (u, v) = (
                f64::from(k) / 60.0 + 0.005,
                f64::from(k * 17 % 60) / 60.0 + 0.003,
            );
            let place = corner + along_u * u + along_v * v;
            let expected = one.irradiance(place, wall.normal);
            let value = other.irradiance(moved(place), turn * wall.normal);
            assert!(
                (value / expected - 1.0).abs() < 1e-9,
                "{place} {value} {expected}"
            );
        }
    }
}
