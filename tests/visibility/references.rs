//! Direct light of tests/data/references, made by other systems.

use crate::lit::{Lit, Roomy, Small, scene, surface};
use glam::{DMat3, DVec3};
use isolux_host::scene::Scene;
use serde_json::Value;

const FILES: [(&str, &str); 6] = [
    (
        "d_penumbra_h0.5",
        include_str!("../data/references/d_penumbra_h0.5.json"),
    ),
    (
        "d_penumbra_h1",
        include_str!("../data/references/d_penumbra_h1.json"),
    ),
    (
        "d_penumbra_h1.5",
        include_str!("../data/references/d_penumbra_h1.5.json"),
    ),
    (
        "d_penumbra_h2",
        include_str!("../data/references/d_penumbra_h2.json"),
    ),
    (
        "c_cornell_grey",
        include_str!("../data/references/c_cornell_grey.json"),
    ),
    ("e_office", include_str!("../data/references/e_office.json")),
];

struct Point {
    place: DVec3,
    normal: DVec3,
    direct: f64,
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

fn read(text: &str, place: impl Fn(DVec3) -> DVec3) -> (Scene, Vec<Point>) {
    let document: Value = serde_json::from_str(text).expect("JSON");
    let polygon = |polygon: &Value| {
        let vertices = polygon["vertices"].as_array().expect("a list");
        let vertices = vertices.iter().map(|v| place(vector(v))).collect();
        surface(vertices, number(&polygon["emission"]))
    };
    let point = |point: &Value| Point {
        place: place(vector(&point["p"])),
        normal: place(vector(&point["n"])) - place(DVec3::ZERO),
        direct: number(point.get("E_direct").unwrap_or(&point["E"])),
    };
    let polygons = document["polygons"].as_array().expect("a list");
    let points = document["points"].as_array().expect("a list");
    (
        scene(polygons.iter().map(polygon).collect()),
        points.iter().map(point).collect(),
    )
}

/// Relative errors, sorted, where the light is more than 1e-3 of the largest;
/// and the largest light where there should be none, as a part of it.
fn errors(lit: &Lit, points: &[Point]) -> (Vec<f64>, f64) {
    let mut workspace = Roomy::<f32>::new();
    let largest = points.iter().fold(0.0, |l: f64, p| l.max(p.direct));
    let (mut relative, mut dark) = (Vec::new(), 0.0_f64);
    for point in points {
        let e = lit.irradiance(&mut workspace, point.place, point.normal);
        if point.direct > 1e-3 * largest {
            relative.push((e / point.direct - 1.0).abs());
        } else if point.direct == 0.0 {
            dark = dark.max(e / largest);
        } else {
            assert!((e - point.direct).abs() < 1e-6 * largest);
        }
    }
    relative.sort_by(f64::total_cmp);
    (relative, dark)
}

fn judge(name: &str, lit: &Lit, points: &[Point]) {
    let (relative, dark) = errors(lit, points);
    let worst = relative[relative.len() - 1];
    let p95 = relative[(relative.len() * 95).div_ceil(100) - 1];
    println!(
        "{name:20} {} points: p95 {p95:.1e}, max {worst:.1e}, dark {dark:.1e}",
        relative.len()
    );
    assert!(p95 <= 1e-5 && worst <= 1e-3 && dark <= 1e-6, "{name}");
}

#[test]
fn direct_light_is_that_of_other_systems() {
    for (name, text) in FILES {
        let (scene, points) = read(text, |v| v);
        judge(name, &Lit::new(&scene), &points);
    }
}

#[test]
fn direct_light_is_the_same_in_rotated_and_shifted_scenes() {
    for seed in 1..=8_u32 {
        let angle = f64::from(seed);
        let turn = DMat3::from_axis_angle(DVec3::new(0.3, angle.sin(), 0.7).normalize(), angle);
        let shift = DVec3::new(-3.0, 1.7, angle.cos());
        for (name, text) in FILES {
            let (scene, points) = read(text, |v| turn * v + shift);
            judge(&format!("{name} {seed}"), &Lit::new(&scene), &points);
        }
    }
}

#[test]
fn the_planned_capacities_hold_every_reference_scene() {
    let mut workspace = Small::<f32>::new();
    for (_, text) in FILES {
        let (scene, points) = read(text, |v| v);
        let lit = Lit::new(&scene);
        for point in &points {
            lit.irradiance(&mut workspace, point.place, point.normal); // asserts that it is exact
        }
    }
}
