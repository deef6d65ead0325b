//! The point-to-polygon form factor.

use std::collections::BTreeMap;

use glam::DVec3;
use isolux_host::reference::{form_factor, form_factor_signed};
use proptest::prelude::*;
use serde_json::Value;

use crate::fixtures::{Polygon, number, over_polygon, over_triangle, room, vector, vertices};

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
    for line in include_str!("../data/form-factor.jsonl").lines() {
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
    let square = room(DVec3::ONE)[0].clone();
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
    let file: Value = serde_json::from_str(include_str!("../data/references/a_formfactors.json"))
        .expect("a file");
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
    let polygon = [
        DVec3::new(-1.0, -0.5, 2.0),
        DVec3::new(-0.7, 1.2, 2.4),
        DVec3::new(1.1, 0.9, 2.1),
        DVec3::new(1.3, -0.6, 1.75),
    ]
    .to_vec();
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
