//! The reference against results of other systems, laws and extremes.

use std::collections::BTreeMap;

use glam::DVec3;
use isolux_host::reference::{Error, Reference, Reflections, form_factor, form_factor_signed};
use isolux_host::scene::{Budget, Quantity, Rungs, Scene, Surface};
use proptest::prelude::*;
use serde_json::Value;

type Polygon = Vec<DVec3>;

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

fn vertices(value: &Value) -> Polygon {
    value
        .as_array()
        .expect("a list")
        .iter()
        .map(vector)
        .collect()
}

fn surface(name: &str, vertices: Polygon, reflectance: f64, radiance: f64) -> Surface {
    let anchor = vertices[0];
    let fan = vertices[1..].windows(2);
    let doubled: DVec3 = fan
        .map(|pair| (pair[0] - anchor).cross(pair[1] - anchor))
        .sum();
    Surface {
        name: name.to_owned(),
        normal: doubled.normalize(),
        area: 0.5 * doubled.length(),
        vertices,
        reflectance: [reflectance; 3],
        radiance: [radiance; 3],
    }
}

fn scene(surfaces: Vec<Surface>) -> Scene {
    Scene {
        name: "test".to_owned(),
        quantity: Quantity::Radiometric,
        surfaces,
        bodies: Vec::new(),
        points: Vec::new(),
        rungs: Rungs::default(),
        camera: None,
        budget: Budget::default(),
    }
}

fn reference(scene: &Scene, reflections: Reflections) -> Reference {
    Reference::new(scene, reflections, &mut |_| {}).expect("a reference")
}

fn points_of(polygons: &[DVec3]) -> Polygon {
    polygons.to_vec()
}

/// The six inward faces of the box from the origin to `size`: floor, ceiling,
/// then the walls.
fn room(size: DVec3) -> [Polygon; 6] {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * size;
    let face = |corners: [[f64; 3]; 4]| points_of(&corners.map(|[x, y, z]| corner(x, y, z)));
    [
        face([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]),
        face([[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]]),
        face([[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]]),
        face([[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]]),
        face([[0., 0., 0.], [0., 0., 1.], [1., 0., 1.], [1., 0., 0.]]),
        face([[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]]),
    ]
}

/// Absolute and relative bounds per class. The contour form in f64 rounds a
/// handful of angles of size 1: 1e-15. Near an edge (h >= 1.4e-7 at size 1)
/// the horizon meets the edge within rounding / h of its place: 1e-11. Tiny
/// polygons are integrated by a rule that errs below rounding: 1e-13.
fn bounds(class: &str) -> (f64, f64) {
    match class {
        "backface" => (0.0, 0.0),
        "near_edge" => (1e-11, f64::INFINITY),
        "tiny" => (1e-15, 1e-13),
        "ordinary" | "scale" | "offset" | "collinear" => (1e-15, 1e-13),
        _ => (1e-15, f64::INFINITY),
    }
}

#[test]
fn the_suite_of_cases_is_met_class_by_class() {
    let mut worst: BTreeMap<String, (usize, f64, f64)> = BTreeMap::new();
    for line in include_str!("data/form-factor.jsonl").lines() {
        let case: Value = serde_json::from_str(line).expect("a case");
        let class = case["cls"].as_str().expect("a class");
        let polygon = vertices(&case["v"]);
        let (position, normal) = (vector(&case["p"]), vector(&case["n"]));
        let digits = |key: &str| -> f64 {
            let text = case[key].as_str().expect("digits");
            text.parse().expect("a number")
        };
        let exact = digits("F");
        let error = (form_factor(position, normal, &polygon) - exact).abs();
        let entry = worst.entry(class.to_owned()).or_default();
        entry.0 += 1;
        entry.1 = entry.1.max(error);
        if exact > 0.0 {
            entry.2 = entry.2.max(error / exact);
        }
        if class != "onplane" {
            let signed = form_factor_signed(position, normal, &polygon);
            let bound = bounds(class).0.max(1e-15);
            assert!(
                (signed - digits("Fs")).abs() <= bound,
                "signed {}",
                case["id"]
            );
        }
    }
    println!("class        count  max abs   max rel");
    for (class, (count, absolute, relative)) in &worst {
        println!("{class:<12} {count:>5}  {absolute:8.1e}  {relative:8.1e}");
    }
    for (class, (_, absolute, relative)) in &worst {
        if class != "onplane" {
            let (most_absolute, most_relative) = bounds(class);
            assert!(*absolute <= most_absolute, "{class} {absolute:e}");
            assert!(*relative <= most_relative, "{class} {relative:e}");
        }
    }
}

#[test]
fn a_point_on_the_plane_receives_nothing_and_one_just_off_it_does() {
    let square = points_of(&room(DVec3::ONE)[0]);
    let inside = DVec3::new(0.3, 0.6, 0.0);
    assert_eq!(form_factor(inside, -DVec3::Z, &square), 0.0);
    let lifted = inside + DVec3::Z * 1e-9;
    assert!((form_factor(lifted, -DVec3::Z, &square) - 1.0).abs() < 1e-8);
    assert_eq!(
        form_factor(inside - DVec3::Z * 1e-9, -DVec3::Z, &square),
        0.0
    );
    assert_eq!(form_factor(lifted, DVec3::Z, &square), 0.0);
    assert_eq!(form_factor(lifted, DVec3::ZERO, &square), 0.0);
    assert_eq!(form_factor(lifted, -DVec3::Z, &square[..2]), 0.0);
}

fn polygons_of(file: &Value) -> Scene {
    let polygons = file["polygons"].as_array().expect("polygons");
    scene(
        polygons
            .iter()
            .map(|polygon| {
                surface(
                    polygon["name"].as_str().expect("a name"),
                    vertices(&polygon["vertices"]),
                    number(&polygon["reflectance"]),
                    number(&polygon["emission"]),
                )
            })
            .collect(),
    )
}

fn simple_scenes() -> [Value; 2] {
    [
        include_str!("data/references/b_simple_3x3.json"),
        include_str!("data/references/b_simple_4.4497x2.0226.json"),
    ]
    .map(|text| serde_json::from_str(text).expect("a file"))
}

#[test]
fn the_simple_scenes_are_met_within_1e_9() {
    for file in simple_scenes() {
        let scene = polygons_of(&file);
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
fn unlike_points_in_bulk_equal_points_one_by_one() {
    let [file, _] = simple_scenes();
    let judge = reference(&polygons_of(&file), Reflections::AtMost(1));
    let points: Vec<(DVec3, DVec3)> = (0..40_000)
        .map(|index| {
            let (i, j) = (index % 200, index / 200);
            let place = DVec3::new(3.7 + (i as f64 + 0.5) / 40.0, (j as f64 + 0.5) / 40.0 - 2.5, 2.2);
            (place, -DVec3::Z)
        })
        .collect();
    let start = std::time::Instant::now();
    let bulk = judge.irradiance_at(&points);
    println!("40 000 points on B in {:.2?}", start.elapsed());
    for (point, value) in points.iter().zip(&bulk).step_by(97) {
        assert_eq!(judge.irradiance(point.0, point.1).to_bits(), value.to_bits());
    }
    let on_a: Vec<(DVec3, DVec3)> = points
        .iter()
        .map(|(place, _)| (DVec3::new(place.x - 6.2, place.y, 0.0), DVec3::Z))
        .collect();
    let start = std::time::Instant::now();
    judge.irradiance_at(&on_a);
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
        let expected = std::f64::consts::PI * radiance * (1.0 - rho_power(rho, count + 1)) / (1.0 - rho);
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
        println!("{count} reflections: {worst:.1e}, ready in {ready:.1?}, {:.1?}", start.elapsed());
        assert!(worst <= if count <= 1 { 1e-9 } else { 1e-6 }, "{count} {worst:e}");
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
        .map(|(index, face)| surface(&index.to_string(), face.clone(), 0.3 + 0.1 * index as f64, 0.0))
        .collect();
    let panel = [[1.0, 1.0], [1.0, 2.0], [2.5, 2.0], [2.5, 1.0]].map(|[x, y]| DVec3::new(x, y, 2.5));
    surfaces.push(surface("panel", panel.to_vec(), 0.0, 10.0));
    scene(surfaces)
}

#[test]
fn a_room_of_many_reflections_converges() {
    let scene = lit_room();
    for reflections in [Reflections::AtMost(1), Reflections::AtMost(2), Reflections::UntilUnshot(1e-3)] {
        let start = std::time::Instant::now();
        let judge = reference(&scene, reflections);
        let ready = start.elapsed();
        let points: Vec<(DVec3, DVec3)> = (0..400)
            .map(|i| {
                let place = DVec3::new(0.0, 3.0 * ((i % 20) as f64 + 0.5) / 20.0, 2.5 * ((i / 20) as f64 + 0.5) / 20.0);
                (place, DVec3::X)
            })
            .collect();
        let start = std::time::Instant::now();
        let values = judge.irradiance_at(&points);
        println!(
            "{reflections:?}: {} reflections, accuracy {:.1e}, ready in {ready:.1?}, {:.1?} a point, {}",
            judge.reflections(), judge.accuracy(), start.elapsed() / 400, values[210]
        );
    }
}
