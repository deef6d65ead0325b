//! The rooms of tests/data/references, and their direct light by other
//! systems.

use crate::lit::{scene, surface};
use glam::DVec3;
use isolux_host::scene::Scene;
use serde_json::Value;

/// Names and contents.
pub(crate) const FILES: [(&str, &str); 6] = [
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

/// A place with its direct irradiance.
pub(crate) struct Point {
    pub(crate) place: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) direct: f64,
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// A file's scene and points, moved.
pub(crate) fn read(text: &str, place: impl Fn(DVec3) -> DVec3) -> (Scene, Vec<Point>) {
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
