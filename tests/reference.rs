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
