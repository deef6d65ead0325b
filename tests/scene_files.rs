//! Scene files and what is made of them before any light is computed: what is
//! read, what is refused and how the refusal reads; frames, the camera, and
//! what a scene requires.

use std::fs;
use std::path::PathBuf;

use glam::{DQuat, DVec3};
use isolux_host::scene::Scene;
use isolux_host::scene::file::parse;
use proptest::prelude::*;

#[path = "scene_files/frame_and_camera.rs"]
mod frame_and_camera;
#[path = "scene_files/reading.rs"]
mod reading;
#[path = "scene_files/refusals.rs"]
mod refusals;
#[path = "scene_files/requirements.rs"]
mod requirements;

const HEAD: &str = "isolux = 1\nname = \"t\"\nquantity = \"radiometric\"\n";
const SQUARE: &str = "[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]";

/// A scene of one surface, its polygon on line 6.
fn with_vertices(vertices: &str) -> String {
    format!("{HEAD}[[surface]]\nname = \"A\"\nvertices = {vertices}\n")
}

/// A sound scene with `extra` from line 7 on; the first lines of `extra`
/// belong to its surface.
fn with_extra(extra: &str) -> String {
    format!("{}{extra}\n", with_vertices(SQUARE))
}

/// A unit cube on z = 0, without the named faces, as surfaces and a body. The
/// body's list of surfaces is on the last line.
fn cube_without(missing: &[&str]) -> String {
    let faces = [
        ("bottom", "[[0,0,0],[0,1,0],[1,1,0],[1,0,0]]"),
        ("top", "[[0,0,1],[1,0,1],[1,1,1],[0,1,1]]"),
        ("south", "[[0,0,0],[1,0,0],[1,0,1],[0,0,1]]"),
        ("north", "[[0,1,0],[0,1,1],[1,1,1],[1,1,0]]"),
        ("west", "[[0,0,0],[0,0,1],[0,1,1],[0,1,0]]"),
        ("east", "[[1,0,0],[1,1,0],[1,1,1],[1,0,1]]"),
    ];
    let kept: Vec<(&str, &str)> = faces
        .into_iter()
        .filter(|(name, _)| !missing.contains(name))
        .collect();
    body_of(&kept)
}

fn body_of(faces: &[(&str, &str)]) -> String {
    let mut text = HEAD.to_owned();
    for (name, vertices) in faces {
        text += &format!("[[surface]]\nname = \"{name}\"\nvertices = {vertices}\n");
    }
    let names: Vec<&str> = faces.iter().map(|(name, _)| *name).collect();
    text + &format!("[[body]]\nname = \"cube\"\nsurfaces = {names:?}\n")
}

fn accepted(source: &str) -> Scene {
    parse("room.toml", source).unwrap_or_else(|diagnostic| panic!("{diagnostic}\n{source}"))
}

/// The text of a reference file of tests/data/references/.
fn reference_text(name: &str) -> String {
    let mut path = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    path.push(format!("tests/data/references/{name}.json"));
    fs::read_to_string(&path).expect("the reference")
}

/// A polygon: name, vertices, reflectance, radiance.
type Polygon = (String, Vec<DVec3>, f64, f64);

/// A scene of grey polygons: name, vertices, reflectance, radiance.
fn scene_of(polygons: &[Polygon], more: &str) -> Scene {
    let mut text = "isolux = 1\nname = \"t\"\nquantity = \"radiometric\"\n".to_owned();
    for (name, vertices, reflectance, radiance) in polygons {
        let vertices: Vec<[f64; 3]> = vertices.iter().map(|v| v.to_array()).collect();
        text += &format!(
            "[[surface]]\nname = \"{name}\"\nvertices = {vertices:?}\nreflectance = {reflectance:?}\nradiance = {radiance:?}\n"
        );
    }
    parse("test", &(text + more)).unwrap_or_else(|diagnostic| panic!("{diagnostic}"))
}

/// A box from `low` to `high`, its fronts inwards (a room) or outwards.
fn faces(name: &str, low: DVec3, high: DVec3, inwards: bool, turn: DQuat) -> Vec<Polygon> {
    let corner = |i: usize| {
        let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
        turn * DVec3::new(
            pick(1, low.x, high.x),
            pick(2, low.y, high.y),
            pick(4, low.z, high.z),
        )
    };
    [
        ("z0", [0, 1, 3, 2]),
        ("z1", [4, 6, 7, 5]),
        ("y0", [0, 4, 5, 1]),
        ("y1", [2, 3, 7, 6]),
        ("x0", [0, 2, 6, 4]),
        ("x1", [1, 5, 7, 3]),
    ]
    .into_iter()
    .map(|(side, mut order)| {
        if !inwards {
            order.reverse();
        }
        let radiance = if side == "z1" && inwards { 1.0 } else { 0.0 };
        (
            format!("{name}-{side}"),
            order.map(corner).to_vec(),
            0.5,
            radiance,
        )
    })
    .collect()
}

fn turn() -> impl Strategy<Value = DQuat> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a rotation", |q| {
            q.iter().map(|x| x * x).sum::<f64>() > 0.01
        })
        .prop_map(|[x, y, z, w]| DQuat::from_xyzw(x, y, z, w).normalize())
}

fn place(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
}

/// A star-shaped polygon, mostly concave, somewhere in space: its corners lie
/// at these distances from its middle.
fn star() -> impl Strategy<Value = Vec<DVec3>> {
    (
        prop::collection::vec(0.3..2.0_f64, 3..9),
        turn(),
        place(10.0),
    )
        .prop_map(|(radii, turn, middle)| {
            let count = radii.len() as f64;
            let corner = |(i, radius): (usize, &f64)| {
                let angle = std::f64::consts::TAU * i as f64 / count;
                middle + turn * DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
            };
            radii.iter().enumerate().map(corner).collect()
        })
}
