//! Exchange between polygons: the catalogue's view factors, reciprocity, and
//! rooms from which nothing escapes. The kernel's point factor is integrated
//! here; nothing else is.

use crate::{Real, Rung, factor};
use glam::{DMat3, DVec3};
use isolux::form_factor::{Best, Libm};
use isolux::number::{Root, SoftRoot};
use proptest::prelude::*;
use serde::Deserialize;

/// Nodes and weights of a rule over a convex polygon: a fan of triangles, each
/// a collapsed product of `panels` panels of three Gauss points a side. Panels
/// shrink towards all sides with the square of the distance, because a factor
/// changes fastest next to an edge that two polygons share.
fn rule(polygon: &[DVec3], panels: usize) -> Vec<(DVec3, f64)> {
    let offset = 0.6_f64.sqrt();
    let gauss = [
        (-offset, 5.0 / 18.0),
        (0.0, 8.0 / 18.0),
        (offset, 5.0 / 18.0),
    ];
    let width = 1.0 / panels as f64;
    let line: Vec<(f64, f64)> = (0..panels)
        .flat_map(|i| gauss.map(|(x, w)| ((i as f64 + 0.5 + 0.5 * x) * width, w * width)))
        .map(|(t, w)| (t * t * (3.0 - 2.0 * t), w * 6.0 * t * (1.0 - t)))
        .collect();
    let mut nodes = Vec::new();
    for pair in polygon[1..].windows(2) {
        let (side, across) = (pair[0] - polygon[0], pair[1] - pair[0]);
        let doubled = side.cross(pair[1] - polygon[0]).length();
        for (u, wu) in &line {
            for (v, wv) in &line {
                let place = polygon[0] + (side + across * *v) * *u;
                nodes.push((place, doubled * wu * wv * u));
            }
        }
    }
    nodes
}

pub(crate) fn facing(polygon: &[DVec3]) -> DVec3 {
    (polygon[1] - polygon[0])
        .cross(polygon[2] - polygon[0])
        .normalize()
}

/// A_from F_from,to: the kernel's point factor integrated over `from`.
fn exchanged<A: Rung<N>, N: Real>(from: &[DVec3], to: &[DVec3], panels: usize) -> f64
where
    SoftRoot: Root<N>,
{
    let to: Vec<[f64; 3]> = to.iter().map(|v| v.to_array()).collect();
    let normal = facing(from).to_array();
    let value = |place: DVec3| -> f64 { factor::<A, N>(place.to_array(), normal, &to).into() };
    rule(from, panels)
        .into_iter()
        .map(|(place, weight)| weight * value(place))
        .sum()
}

fn area(polygon: &[DVec3]) -> f64 {
    let fan = polygon[1..].windows(2);
    fan.map(|pair| 0.5 * (pair[0] - polygon[0]).cross(pair[1] - polygon[0]).length())
        .sum()
}

#[derive(Deserialize)]
struct Catalogue {
    pairs: Vec<Pair>,
}

#[derive(Deserialize)]
struct Pair {
    name: String,
    #[serde(rename = "A")]
    a: Vec<DVec3Like>,
    #[serde(rename = "B")]
    b: Vec<DVec3Like>,
    #[serde(rename = "F_AB")]
    factor: f64,
}

type DVec3Like = [f64; 3];

fn polygon(corners: &[DVec3Like]) -> Vec<DVec3> {
    corners.iter().map(|&corner| corner.into()).collect()
}

#[test]
fn the_catalogues_view_factors_come_out() {
    let text = include_str!("../data/references/a_formfactors.json");
    let catalogue: Catalogue = serde_json::from_str(text).expect("the catalogue");
    assert!(catalogue.pairs.len() >= 6);
    for pair in &catalogue.pairs {
        let (a, b) = (polygon(&pair.a), polygon(&pair.b));
        let mean = |exchanged: f64| exchanged / area(&a);
        let best = mean(exchanged::<Best, f32>(&a, &b, 16));
        let double = mean(exchanged::<Best, f64>(&a, &b, 16));
        let libm = mean(exchanged::<Libm, f64>(&a, &b, 16));
        let off = [best, double, libm].map(|f| f - pair.factor);
        println!("{:45} {:.3e} off by {off:?}", pair.name, pair.factor);
        // The mean of a point factor errs no more than the point factor does;
        // beside a shared edge the rule itself is good to 1e-8.
        assert!(
            off[0].abs() <= 2.5e-7 + 1e-8,
            "{}: best f32 {best}",
            pair.name
        );
        assert!(
            off[1].abs() <= 2e-8 + 1e-8,
            "{}: best f64 {double}",
            pair.name
        );
        assert!(off[2].abs() <= 1e-8, "{}: libm f64 {libm}", pair.name);
    }
}

fn triangle(centre: [f64; 3]) -> impl Strategy<Value = Vec<DVec3>> {
    prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64))
        .prop_map(move |corners| {
            let corners = corners.map(|corner| DVec3::from(corner.map(|x| x + 0.0)));
            corners.map(|corner| corner + DVec3::from(centre)).to_vec()
        })
        .prop_filter("an area", |corners| area(corners) > 0.1)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Two triangles at least 2 m apart: the rule converges to 1e-9 on them,
    /// but for the kinks where the plane of one crosses the other.
    #[test]
    fn what_a_sends_to_b_is_what_b_sends_to_a(a in triangle([0.0; 3]), b in triangle([0.5, 0.3, 4.0])) {
        let crosses = |of: &[DVec3], other: &[DVec3]| {
            let heights = other.iter().map(|&v| facing(of).dot(v - of[0]));
            heights.clone().any(|h| h > 0.0) && heights.clone().any(|h| h <= 0.0)
        };
        prop_assume!(!crosses(&a, &b) && !crosses(&b, &a));
        let (ab, ba) = (exchanged::<Best, f32>(&a, &b, 8), exchanged::<Best, f32>(&b, &a, 8));
        let single = 2.5e-7 * (area(&a) + area(&b)) + 1e-9;
        prop_assert!((ab - ba).abs() <= single, "{ab} {ba}");
        let (ab, ba) = (exchanged::<Best, f64>(&a, &b, 8), exchanged::<Best, f64>(&b, &a, 8));
        prop_assert!((ab - ba).abs() <= 2e-8 * (area(&a) + area(&b)) + 1e-9, "{ab} {ba}");
        let (ab, ba) = (exchanged::<Libm, f64>(&a, &b, 8), exchanged::<Libm, f64>(&b, &a, 8));
        prop_assert!((ab - ba).abs() <= 1e-8 * (area(&a) + area(&b)) + 1e-9, "{ab} {ba}");
    }
}

/// The six inward faces of a box from the origin.
pub(crate) fn room(size: DVec3) -> [Vec<DVec3>; 6] {
    let corner = |i: usize| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * size;
    [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ]
    .map(|face| face.map(corner).to_vec())
}

/// The sum over the faces, and what it may be off by.
fn enclosed<A: Rung<N>, N: Real>(faces: &[Vec<DVec3>], p: DVec3, n: DVec3) -> (f64, f64)
where
    SoftRoot: Root<N>,
{
    let (mut sum, mut allowed) = (0.0, 0.0);
    for face in faces {
        let view = crate::shapes::View {
            p: p.to_array(),
            n: n.to_array(),
            v: face.iter().map(|v| v.to_array()).collect(),
        };
        let f: f64 = factor::<A, N>(view.p, view.n, &view.v).into();
        sum += f;
        // Its own face sends it nothing, exactly.
        if face.iter().any(|&v| facing(face).dot(p - v) > 0.0) {
            allowed += A::own_error(4, view.conditioning());
        }
    }
    (sum, allowed)
}

fn one<A: Rung<N>, N: Real>(faces: &[Vec<DVec3>], p: DVec3, n: DVec3) -> Result<(), TestCaseError>
where
    SoftRoot: Root<N>,
{
    let (sum, allowed) = enclosed::<A, N>(faces, p, n);
    prop_assert!(
        (sum - 1.0).abs() <= allowed,
        "{sum}, {allowed:e} allowed, at {p} facing {n}"
    );
    Ok(())
}

/// A place in a unit box on a lattice, so that faces hold it exactly.
pub(crate) fn inside() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(1..256_i32).prop_map(|x| DVec3::from(x.map(f64::from)) / 256.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn from_inside_a_room_everything_is_wall(
        at in inside(),
        size in prop::array::uniform3(1..=64_i32),
        n in prop::array::uniform3(-8..=8_i32),
    ) {
        prop_assume!(n != [0; 3]);
        let size = DVec3::from(size.map(f64::from)) / 8.0;
        let (faces, n) = (room(size), DVec3::from(n.map(f64::from)));
        one::<Best, f32>(&faces, at * size, n)?;
        one::<Best, f64>(&faces, at * size, n)?;
        one::<Libm, f32>(&faces, at * size, n)?;
        one::<Libm, f64>(&faces, at * size, n)?;
    }

    #[test]
    fn from_a_wall_of_a_room_everything_is_wall(
        at in inside(),
        size in prop::array::uniform3(1..=64_i32),
        side in 0..6_usize,
    ) {
        let size = DVec3::from(size.map(f64::from)) / 8.0;
        let faces = room(size);
        let n = facing(&faces[side]);
        // Onto the wall, along its normal.
        let p = at * size;
        let p = p - n * n.dot(p - faces[side][0]);
        one::<Best, f32>(&faces, p, n)?;
        one::<Best, f64>(&faces, p, n)?;
        one::<Libm, f32>(&faces, p, n)?;
        one::<Libm, f64>(&faces, p, n)?;
    }

    #[test]
    fn turned_rooms_are_rooms(at in inside(), angles in prop::array::uniform3(-3.0..3.0_f64)) {
        let [a, b, c] = angles;
        let turn = DMat3::from_rotation_z(a) * DMat3::from_rotation_x(b) * DMat3::from_rotation_y(c);
        let faces = room(DVec3::new(4.0, 5.0, 3.0)).map(|face| face.iter().map(|&v| turn * v).collect::<Vec<_>>());
        let p = turn * (at * DVec3::new(4.0, 5.0, 3.0));
        let (sum, allowed) = enclosed::<Best, f64>(&faces, p, turn * DVec3::new(0.6, 0.0, 0.8));
        prop_assert!((sum - 1.0).abs() <= allowed + 1e-12, "{sum}");
    }
}
