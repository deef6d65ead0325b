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
fn points_in_bulk_equal_points_one_by_one() {
    let [file, _] = simple_scenes();
    let judge = reference(&polygons_of(&file), Reflections::AtMost(1));
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
        assert!(value > before && judge.accuracy() <= 1e-4);
        before = value;
    }
    let fraction = 1e-3;
    let judge = reference(&scene, Reflections::UntilUnshot(fraction));
    println!(
        "{} reflections: accuracy {:.1e}",
        judge.reflections(),
        judge.accuracy()
    );
    assert!(judge.irradiance(place.0, place.1) > before && judge.accuracy() <= 1e-4);
    let emitted = std::f64::consts::PI * 10.0 * scene.surfaces[6].area;
    let mut absorbed = 0.0;
    for wall in &scene.surfaces[..6] {
        let share = 1.0 - wall.reflectance[0];
        absorbed +=
            share * over_polygon(&wall.vertices, 6, &mut |y| judge.irradiance(y, wall.normal));
    }
    let left = 1.0 - absorbed / emitted;
    println!("left: {left:.2e}");
    // The sum over the walls is itself good to about 1e-4.
    assert!(left > -1e-4 && left < fraction + 1e-4, "{left:e}");
}

/// Integrates over a triangle: collapsed product of `panels` panels of a
/// three-point rule in each direction.
fn over_triangle(corners: [DVec3; 3], panels: usize, f: &mut dyn FnMut(DVec3) -> f64) -> f64 {
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

fn over_polygon(polygon: &[DVec3], panels: usize, f: &mut dyn FnMut(DVec3) -> f64) -> f64 {
    polygon[1..]
        .windows(2)
        .map(|pair| over_triangle([polygon[0], pair[0], pair[1]], panels, f))
        .sum()
}

/// Mean form factor of A to B: the point factor integrated over A, in
/// triangles from its centre to its sides, with nodes drawn towards the sides
/// by t -> 10 t^3 - 15 t^4 + 6 t^5: there the factor is not smooth where B
/// shares an edge with A.
fn mean_factor(a: &Polygon, b: &Polygon) -> f64 {
    let normal = (a[1] - a[0]).cross(a[2] - a[0]);
    let area = over_polygon(a, 1, &mut |_| 1.0);
    let mut total = 0.0;
    let centre = a.iter().sum::<DVec3>() / a.len() as f64;
    for (index, &start) in a.iter().enumerate() {
        let end = a[(index + 1) % a.len()];
        let bend = |t: f64| {
            (
                t * t * t * (10.0 - 15.0 * t + 6.0 * t * t),
                30.0 * t * t * (1.0 - t) * (1.0 - t),
            )
        };
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        let doubled = (start - centre).cross(end - centre).length();
        total += over_polygon(&square, 48, &mut |t| {
            let ((along, dx), (out, dy)) = (bend(t.x), bend(t.y));
            let edge = start.lerp(end, along);
            form_factor(centre.lerp(edge, out), normal, b) * doubled * out * dx * dy
        });
    }
    total / area
}

#[test]
fn the_catalogue_of_area_factors_and_reciprocity_hold() {
    let file: Value =
        serde_json::from_str(include_str!("data/references/a_formfactors.json")).expect("a file");
    for pair in file["pairs"].as_array().expect("pairs") {
        let (a, b) = (vertices(&pair["A"]), vertices(&pair["B"]));
        let exact = number(&pair["F_AB"]);
        let there = mean_factor(&a, &b);
        println!("{} {:.1e}", pair["name"], there / exact - 1.0);
        assert!(
            (there / exact - 1.0).abs() <= 1e-9,
            "{} {there}",
            pair["name"]
        );
        let area = |polygon: &Polygon| over_polygon(polygon, 1, &mut |_| 1.0);
        let back = mean_factor(&b, &a) * area(&b) / area(&a);
        assert!(
            (back / exact - 1.0).abs() <= 1e-9,
            "{} {back}",
            pair["name"]
        );
    }
}

#[test]
fn the_contour_equals_the_double_integral_of_cosines() {
    let polygon = points_of(&[
        DVec3::new(-1.0, -0.5, 2.0),
        DVec3::new(-0.7, 1.2, 2.4),
        DVec3::new(1.1, 0.9, 2.1),
        DVec3::new(1.3, -0.6, 1.75),
    ]);
    let normal = DVec3::new(0.2, -0.3, 0.9).normalize();
    let position = DVec3::new(0.1, 0.05, -0.2);
    let parts = [[0, 1, 2], [0, 2, 3]].map(|triple| triple.map(|i: usize| polygon[i]));
    let by_area: f64 = parts
        .iter()
        .map(|corners| {
            let front = (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .normalize();
            over_triangle(*corners, 40, &mut |y| {
                let r = y - position;
                normal.dot(r) * -front.dot(r) / (std::f64::consts::PI * r.length_squared().powi(2))
            })
        })
        .sum();
    let by_contour = form_factor(position, normal, &polygon);
    assert!(
        (by_area - by_contour).abs() < 1e-11,
        "{by_area} {by_contour}"
    );
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
    let mut lit = polygons_of(&file);
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

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    #[test]
    fn a_closed_box_is_seen_whole(
        place in prop::array::uniform3(0.001..0.999_f64),
        normal in prop::array::uniform3(-1.0..1.0_f64),
        size in prop::array::uniform3(0.01..100.0_f64),
    ) {
        let (size, normal) = (DVec3::from(size), DVec3::from(normal));
        prop_assume!(normal.length() > 0.01);
        let sum: f64 = room(size)
            .iter()
            .map(|face| form_factor(DVec3::from(place) * size, normal, face))
            .sum();
        prop_assert!((sum - 1.0).abs() < 1e-13, "{sum}");
    }

    #[test]
    fn turning_moving_and_scaling_change_nothing(
        axis in prop::array::uniform3(-1.0..1.0_f64),
        angle in 0.0..std::f64::consts::TAU,
        shift in prop::array::uniform3(-5.0..5.0_f64),
        scale in 0.01..100.0_f64,
        normal in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let (axis, normal) = (DVec3::from(axis), DVec3::from(normal));
        prop_assume!(axis.length() > 0.01 && normal.length() > 0.01);
        let turn = glam::DQuat::from_axis_angle(axis.normalize(), angle);
        let polygon = &room(DVec3::new(2.0, 1.0, 1.0))[1];
        let position = DVec3::new(0.3, 0.8, 0.2);
        let before = form_factor(position, normal, polygon);
        let moved = |p: DVec3| (turn * p + DVec3::from(shift)) * scale;
        let turned: Polygon = polygon.iter().map(|vertex| moved(*vertex)).collect();
        let after = form_factor(moved(position), turn * normal, &turned);
        prop_assert!((before - after).abs() < 2e-14, "{before} {after}");
    }
}
