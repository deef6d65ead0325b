//! Scenes, files and plain sums that the tests share.

use glam::DVec3;
use isolux_host::reference::{Reference, Reflections};
use isolux_host::scene::{Budget, Quantity, Rungs, Scene, Surface};
use serde_json::Value;

/// Vertices of a polygon.
pub(crate) type Polygon = Vec<DVec3>;

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

pub(crate) fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

pub(crate) fn vertices(value: &Value) -> Polygon {
    value
        .as_array()
        .expect("a list")
        .iter()
        .map(vector)
        .collect()
}

/// A number or three of them as three channels.
pub(crate) fn triple(value: &Value) -> [f64; 3] {
    match value.as_f64() {
        Some(grey) => [grey; 3],
        None => vector(value).to_array(),
    }
}

/// The scene of a file of references.
pub(crate) fn file_scene(file: &Value) -> Scene {
    let polygons = file["polygons"].as_array().expect("polygons");
    let surfaces = polygons.iter().map(|polygon| Surface {
        reflectance: triple(&polygon["reflectance"]),
        radiance: triple(&polygon["emission"]),
        ..surface(
            polygon["name"].as_str().expect("a name"),
            vertices(&polygon["vertices"]),
            0.0,
            0.0,
        )
    });
    scene(surfaces.collect())
}

pub(crate) fn surface(name: &str, vertices: Polygon, reflectance: f64, radiance: f64) -> Surface {
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

pub(crate) fn scene(surfaces: Vec<Surface>) -> Scene {
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

pub(crate) fn reference(scene: &Scene, reflections: Reflections) -> Reference {
    Reference::new(scene, reflections, &mut |_| {}).expect("a reference")
}

/// The six inward faces of the box from the origin to `size`: floor, ceiling,
/// then the walls.
pub(crate) fn room(size: DVec3) -> [Polygon; 6] {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * size;
    let face = |corners: [[f64; 3]; 4]| corners.map(|[x, y, z]| corner(x, y, z)).to_vec();
    [
        face([[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]),
        face([[0., 0., 1.], [0., 1., 1.], [1., 1., 1.], [1., 0., 1.]]),
        face([[0., 0., 0.], [0., 1., 0.], [0., 1., 1.], [0., 0., 1.]]),
        face([[1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]]),
        face([[0., 0., 0.], [0., 0., 1.], [1., 0., 1.], [1., 0., 0.]]),
        face([[0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]]),
    ]
}

/// Integrates over a triangle: collapsed product of `panels` panels of a
/// three-point rule in each direction.
pub(crate) fn over_triangle(
    corners: [DVec3; 3],
    panels: usize,
    f: &mut dyn FnMut(DVec3) -> f64,
) -> f64 {
    let offset = 0.6_f64.sqrt();
    let nodes = [
        (-offset, 5.0 / 18.0),
        (0.0, 8.0 / 18.0),
        (offset, 5.0 / 18.0),
    ];
    let width = 1.0 / panels as f64;
    let line: Vec<(f64, f64)> = (0..panels)
        .flat_map(|i| nodes.map(|(x, w)| ((i as f64 + 0.5 + 0.5 * x) * width, w * width)))
        .collect();
    let (side, across) = (corners[1] - corners[0], corners[2] - corners[1]);
    let doubled = side.cross(corners[2] - corners[0]).length();
    let mut sum = 0.0;
    for (u, wu) in &line {
        for (v, wv) in &line {
            sum += wu * wv * u * f(corners[0] + (side + across * *v) * *u);
        }
    }
    sum * doubled
}

pub(crate) fn over_polygon(
    polygon: &[DVec3],
    panels: usize,
    f: &mut dyn FnMut(DVec3) -> f64,
) -> f64 {
    polygon[1..]
        .windows(2)
        .map(|pair| over_triangle([polygon[0], pair[0], pair[1]], panels, f))
        .sum()
}
