//! Direct light with something in between.

use glam::{DQuat, DVec3};
use isolux_host::reference::Reflections;
use isolux_host::scene::{Scene, Surface};
use proptest::prelude::*;
use serde_json::Value;

use crate::brute_force::{self, Depth};
use crate::fixtures::{Polygon, file_scene, reference, scene, surface, triple, vector};

fn files() -> Vec<Value> {
    [
        include_str!("../data/references/d_penumbra_h0.5.json"),
        include_str!("../data/references/d_penumbra_h1.json"),
        include_str!("../data/references/d_penumbra_h1.5.json"),
        include_str!("../data/references/d_penumbra_h2.json"),
        include_str!("../data/references/c_cornell_grey.json"),
        include_str!("../data/references/c_cornell_rgb.json"),
        include_str!("../data/references/e_office.json"),
    ]
    .iter()
    .map(|text| serde_json::from_str(text).expect("a file"))
    .collect()
}

fn places(file: &Value) -> Vec<(DVec3, DVec3)> {
    let points = file["points"].as_array().expect("points");
    points
        .iter()
        .map(|point| (vector(&point["p"]), vector(&point["n"])))
        .collect()
}

fn direct(file: &Value) -> Vec<[f64; 3]> {
    let points = file["points"].as_array().expect("points");
    points
        .iter()
        .map(|point| triple(point.get("E").unwrap_or(&point["E_direct"])))
        .collect()
}

fn brightest(values: &[[f64; 3]]) -> f64 {
    values.iter().flatten().copied().fold(0.0, f64::max)
}

fn worst(values: &[[f64; 3]], expected: &[[f64; 3]]) -> f64 {
    let pairs = values.as_flattened().iter().zip(expected.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / brightest(expected)
}

/// The files state 1e-9 of rounding for Cornell and the office.
#[test]
fn direct_light_is_that_of_the_published_scenes() {
    for file in files() {
        let judge = reference(&file_scene(&file), Reflections::AtMost(0));
        let (values, expected) = (judge.light_at(&places(&file)), direct(&file));
        println!("{}: {:.1e}", file["name"], worst(&values, &expected));
        let plain = file["name"].as_str().expect("a name").starts_with('d');
        assert!(worst(&values, &expected) <= if plain { 1e-14 } else { 1e-9 });
        for (value, expected) in values.iter().zip(&expected) {
            if *expected == [0.0; 3] {
                assert_eq!(*value, [0.0; 3]);
            }
        }
    }
}

fn moved(scene: &Scene, place: impl Fn(DVec3) -> DVec3, turn: DQuat) -> Scene {
    let mut moved = scene.clone();
    for surface in &mut moved.surfaces {
        surface.vertices = surface.vertices.iter().map(|v| place(*v)).collect();
        surface.normal = turn * surface.normal;
    }
    moved
}

#[test]
fn turned_and_scaled_copies_have_the_same_direct_light() {
    let turn = DQuat::from_axis_angle(DVec3::new(0.2, 0.9, -0.4).normalize(), 0.83);
    for file in files() {
        let scene = file_scene(&file);
        let expected = direct(&file);
        for scale in [1e-3, 1.0, 250.0] {
            let place = |v: DVec3| turn * v * scale + DVec3::new(3.0, -1.0, 2.0) * scale;
            let judge = reference(&moved(&scene, place, turn), Reflections::AtMost(0));
            let points: Vec<(DVec3, DVec3)> = places(&file)
                .iter()
                .map(|(p, n)| (place(*p), turn * *n))
                .collect();
            let error = worst(&judge.light_at(&points), &expected);
            assert!(error <= 1e-9, "{} {scale}: {error:e}", file["name"]);
        }
    }
}

fn square(x: f64, y: f64, z: f64, half: f64) -> Polygon {
    [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)]
        .map(|(u, v)| DVec3::new(x + half * u, y + half * v, z))
        .to_vec()
}

fn facing_down(mut polygon: Polygon) -> Polygon {
    polygon.reverse();
    polygon
}

/// A light of 2 x 2 at height 3 over a floor, and what else is given.
fn under_a_light(more: Vec<Surface>) -> Scene {
    let mut surfaces = vec![
        surface("floor", square(0., 0., 0., 4.), 0.5, 0.0),
        surface("light", facing_down(square(0., 0., 3., 1.)), 0.0, 10.0),
    ];
    surfaces.extend(more);
    scene(surfaces)
}

fn floor() -> Vec<(DVec3, DVec3)> {
    let place = |k: u32| {
        DVec3::new(
            f64::from(k % 17) * 0.4 - 3.1,
            f64::from(k / 17) * 0.4 - 3.3,
            0.0,
        )
    };
    (0..17 * 17).map(|k| (place(k), DVec3::Z)).collect()
}

#[test]
fn what_cannot_come_between_changes_no_bit() {
    let expected =
        reference(&under_a_light(vec![]), Reflections::AtMost(0)).irradiance_at(&floor());
    let aside = [
        square(0., 0., -0.5, 3.),
        facing_down(square(0.2, 0., 3.5, 3.)),
        facing_down(square(1.5, 0., 3.0, 0.5)),
        square(1.0, 1.0, 0.0, 1.0),
        square(20.0, 0., 1.0, 0.5),
    ];
    for polygon in aside {
        let scene = under_a_light(vec![surface("aside", polygon, 0.0, 0.0)]);
        let values = reference(&scene, Reflections::AtMost(0)).irradiance_at(&floor());
        assert_eq!(values, expected);
    }
}

/// The pieces meet in a T and one of them is turned round.
#[test]
fn an_occluder_in_pieces_hides_as_much_as_the_whole() {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.5);
    let whole = square(0., 0., 0.5, 1.2);
    let (a, b) = (1.2, 0.1);
    let pieces = [
        vec![corner(-a, -a), corner(b, -a), corner(b, a), corner(-a, a)],
        vec![corner(b, -a), corner(a, -a), corner(a, 0.3), corner(b, 0.3)],
        vec![corner(b, a), corner(a, a), corner(a, 0.3), corner(b, 0.3)],
    ];
    let one = under_a_light(vec![surface("whole", whole, 0.0, 0.0)]);
    let parts = pieces
        .into_iter()
        .map(|piece| surface("piece", piece, 0.0, 0.0));
    let many = under_a_light(parts.collect());
    let expected = reference(&one, Reflections::AtMost(0)).irradiance_at(&floor());
    let values = reference(&many, Reflections::AtMost(0)).irradiance_at(&floor());
    let mut dark = 0;
    for (value, expected) in values.iter().zip(&expected) {
        assert!((value - expected).abs() <= 1e-12, "{value} {expected}");
        dark += usize::from(*expected == 0.0);
    }
    assert!(dark > 10, "an umbra of {dark} points");
}

#[test]
fn an_occluder_does_not_hide_anything_from_its_own_faces() {
    let free = reference(&under_a_light(vec![]), Reflections::AtMost(0));
    let plate = under_a_light(vec![surface("plate", square(0., 0., 1., 1.), 0.0, 0.0)]);
    let judge = reference(&plate, Reflections::AtMost(0));
    for x in [0.0, 0.5, 1.0, 2.0] {
        let place = DVec3::new(x, 0.3, 1.0);
        assert_eq!(
            judge.irradiance(place, DVec3::Z),
            free.irradiance(place, DVec3::Z)
        );
        assert_eq!(judge.irradiance(place, -DVec3::Z), 0.0);
    }
    let below = DVec3::new(0.0, 0.0, 1.0 - 1e-4);
    assert_eq!(judge.irradiance(below, DVec3::Z), 0.0);
}

/// An L-shaped light behind a U-shaped occluder.
#[test]
fn concave_lights_and_occluders_are_met() {
    let flat = |outline: &[(f64, f64)], z: f64| -> Polygon {
        outline.iter().map(|(x, y)| DVec3::new(*x, *y, z)).collect()
    };
    let l = [
        (-1., -1.),
        (1., -1.),
        (1., 0.),
        (0., 0.),
        (0., 1.),
        (-1., 1.),
    ];
    let u = [
        (-0.8, -0.7),
        (0.8, -0.7),
        (0.8, 0.7),
        (0.4, 0.7),
        (0.4, -0.2),
        (-0.3, -0.2),
        (-0.3, 0.7),
        (-0.8, 0.7),
    ];
    let lit = scene(vec![
        surface("light", facing_down(flat(&l, 3.0)), 0.0, 10.0),
        surface("occluder", flat(&u, 1.3), 0.0, 0.0),
    ]);
    let judge = reference(&lit, Reflections::AtMost(0));
    for (position, normal) in floor().into_iter().step_by(23) {
        let expected = brute(&lit, position, normal);
        let value = judge.irradiance(position, normal);
        assert!(
            (value - expected).abs() <= 1e-3 * 6.0,
            "{position} {value} {expected}"
        );
    }
}

fn brute(scene: &Scene, position: DVec3, normal: DVec3) -> f64 {
    let polygon = |surface: &Surface| brute_force::Polygon {
        vertices: surface.vertices.clone(),
        radiance: surface.radiance[0],
    };
    let polygons: Vec<_> = scene.surfaces.iter().map(polygon).collect();
    brute_force::direct(&polygons, position, normal, Depth { least: 4, most: 9 })
}

fn point(reach: f64) -> impl Strategy<Value = DVec3> {
    [-reach..reach, -reach..reach, -reach..reach].prop_map(DVec3::from)
}

/// A triangle or a parallelogram of moderate shape.
fn polygon(reach: f64, size: f64) -> impl Strategy<Value = Polygon> {
    (point(reach), point(size), point(size), any::<bool>()).prop_filter_map(
        "a sliver",
        |(anchor, side, other, triangle)| {
            let area = side.cross(other).length();
            (area > 0.2 * side.length() * other.length() && area > 0.01).then(|| {
                let mut polygon =
                    vec![anchor, anchor + side, anchor + side + other, anchor + other];
                if triangle {
                    polygon.remove(2);
                }
                polygon
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_scenes_agree_with_brute_force(
        light in polygon(2.0, 2.0),
        occluders in prop::collection::vec(polygon(2.0, 1.5), 1..7),
        position in point(2.0),
        tilt in point(1.0).prop_filter("a direction", |t| t.length() > 0.1),
    ) {
        let plane = surface("light", light.clone(), 0.0, 1.0);
        prop_assume!(plane.normal.dot(position - plane.vertices[0]).abs() > 0.05);
        let [value, expected, whole] = against_brute_force(light, occluders, position, tilt);
        prop_assert!((value - expected).abs() <= 4e-3 * whole + 1e-9, "{value} {expected} of {whole}");
    }
}

/// Irradiance from a light that is turned towards the receiver, itself facing
/// between `tilt` and the light: the reference, brute force, and the reference
/// without occluders.
fn against_brute_force(
    light: Polygon,
    occluders: Vec<Polygon>,
    position: DVec3,
    tilt: DVec3,
) -> [f64; 3] {
    let mut surfaces = vec![surface("light", light, 0.0, 1.0)];
    surfaces.extend(
        occluders
            .into_iter()
            .map(|o| surface("occluder", o, 0.0, 0.0)),
    );
    if surfaces[0].normal.dot(position - surfaces[0].vertices[0]) < 0.0 {
        surfaces[0].vertices.reverse();
        surfaces[0].normal = -surfaces[0].normal;
    }
    let lit = scene(surfaces);
    let towards = lit.surfaces[0].vertices[0] - position;
    let normal = (tilt.normalize() + towards.normalize()).normalize_or(DVec3::Z);
    let open = reference(
        &scene(vec![lit.surfaces[0].clone()]),
        Reflections::AtMost(0),
    );
    let judge = reference(&lit, Reflections::AtMost(0));
    [
        judge.irradiance(position, normal),
        brute(&lit, position, normal),
        open.irradiance(position, normal),
    ]
}

/// The receiver is so near to the light that triangles a quarter of its
/// distance wide carry the integral.
#[test]
fn a_large_light_that_is_near_agrees_with_brute_force() {
    let light = vec![
        DVec3::new(1.237756105967494, 0.47451043104850404, 0.0),
        DVec3::new(-0.6782918442437249, -0.436759909209322, 0.0),
        DVec3::new(0.769398611160409, 1.4964982287264057, 0.8932875735384647),
        DVec3::new(2.685446561371628, 2.4077685689842316, 0.8932875735384647),
    ];
    let [bottom, top, side] = [0.0, 1.109083923218505, -0.5695591969909543];
    let occluder = vec![
        DVec3::new(0.0, 0.0, bottom),
        DVec3::new(0.0, 0.0, top),
        DVec3::new(side, 0.0, top),
        DVec3::new(side, 0.0, bottom),
    ];
    let position = DVec3::new(1.714406705847236, 1.3837141523175855, 0.39886397301658877);
    let [value, expected, whole] = against_brute_force(light, vec![occluder], position, DVec3::Z);
    assert!(
        (value - expected).abs() <= 4e-3 * whole,
        "{value} {expected} of {whole}"
    );
}
